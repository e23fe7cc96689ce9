"""The table of the dashboard shell's commands: syntax, answer and states of each.

Evidence: the wording of replies marked *client* is what the vendor's client compares against; *documented* are commands
that the vendor describes and *observed* those that other clients use. All refusals, the help texts and the order of the
lines of `status` are *assumed*.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from elitescript.messages.enums import RobotMode, TaskState
from elitescript.protocol.dashboard import answers as to
from elitescript.protocol.dashboard.answers import Answer, Asked
from elitescript.protocol.dashboard.guards import HAS_ARM, MAY_MOVE, MAY_POWER, Guard
from elitescript.protocol.lines import shown
from elitescript.records import NamedTuple


class DashboardCommand(NamedTuple):
    """One command: a verb with one of its options."""

    verb: str
    option: str
    """With its dash; empty for the bare verb."""
    argument: str
    """Its argument in usage texts; empty for none. `TEXT` may follow its option without a blank."""
    summary: str
    reply: str
    """The reply as the reference shows it."""
    evidence: str
    answer: Callable[[Asked], Answer]
    guard: Guard | None = None

    @property
    def usage(self) -> str:
        """Syntax of the command."""
        return " ".join(part for part in (self.verb, self.option, self.argument) if part)


def _row(
    usage: str, summary: str, reply: str, evidence: str, answer: Callable[[Asked], Answer], guard: Guard | None = None
) -> DashboardCommand:
    """Return the row of a command from its syntax."""
    verb, _, rest = usage.partition(" ")
    option, _, argument = rest.partition(" ") if rest.startswith("-") else ("", "", rest)
    return DashboardCommand(verb, option, argument, summary, reply, evidence, answer, guard)


def _help(asked: Asked) -> Answer:
    names = asked.argument.split()
    return Answer(help_text(names) if names else _LIST)


def _usage(asked: Asked) -> Answer:
    return Answer(usage_text(asked.argument.split()))


_CLIENT: Final = "client"
_OWN_WORDS: Final = "client; wording assumed"
_ASSUMED: Final = "documented; wording assumed"
_OBSERVED: Final = "observed"

_STOPPED: Final = frozenset({TaskState.STOPPED})
_PAUSED: Final = frozenset({TaskState.PAUSED})
_PLAYING: Final = frozenset({TaskState.PLAYING})
_BOOTED: Final = frozenset({RobotMode.IDLE, RobotMode.RUNNING})
_RUNNING: Final = frozenset({RobotMode.RUNNING})

_POWER_ON: Final = Guard("Failed to power on", modes=HAS_ARM, safety=MAY_POWER)
_BRAKES: Final = Guard("Failed to release the brakes", modes=_BOOTED, safety=MAY_POWER)
_LOAD: Final = Guard("Failed to load task", tasks=_STOPPED)
_CONFIGURE: Final = Guard("Failed to load configuration", tasks=_STOPPED)
_PLAY: Final = Guard("Failed to start task", modes=_RUNNING, safety=MAY_MOVE, tasks=_STOPPED | _PAUSED)
_PAUSE: Final = Guard("Failed to pause task", tasks=_PLAYING)
_SET: Final = Guard("Failed to set variable", tasks=_STOPPED)

_ROWS: Final = (
    _row("echo", "Ask whether the shell is there.", "Hello ELITE ROBOTS.", _CLIENT, to.say_hello),
    _row("help [NAME...]", "List the commands, or explain some of them.", "text", "documented", _help),
    _row("usage NAME...", "Say how commands are written.", "text", _CLIENT, _usage),
    _row("version", "Version of the controller.", "A.B.C.D", _OWN_WORDS, to.tell_version),
    _row("robot -t", "Model of the arm.", "MODEL", _OWN_WORDS, to.tell_model),
    _row("robot -s", "Serial number.", "NUMBER", _OWN_WORDS, to.tell_serial_number),
    _row("robot -id", "Id of the robot.", "ID", _OWN_WORDS, to.tell_robot_id),
    _row(
        "robotControl -on",
        "Power the arm on; robotMode tells how far it is.",
        "Powering on",
        _CLIENT,
        to.power_on,
        _POWER_ON,
    ),
    _row(
        "robotControl -off",
        "Stop the task and power the arm off.",
        "Powering off",
        _CLIENT,
        to.power_off,
        Guard("Failed to power off"),
    ),
    _row(
        "brakeRelease",
        "Release the brakes of an arm that is powered on.",
        "Brake Releasing... / Brake is released...",
        _CLIENT,
        to.release_brakes,
        _BRAKES,
    ),
    _row("robotMode", "What power and brakes are doing.", "robotMode: NAME", _CLIENT, to.tell_robot_mode),
    _row("safety -s", "State of the safety system.", "Safety status: NAME", _CLIENT, to.tell_safety_status),
    _row("safety -m", "Mode of the safety system.", "Safety mode: NAME", _CLIENT, to.tell_safety_mode),
    _row(
        "safety -r",
        "Restart the safety board after a fault or a violation; the arm is off afterwards.",
        "Restarting safety board",
        _CLIENT,
        to.restart_safety,
        Guard("Failed to restart the safety system"),
    ),
    _row(
        "closeSafetyDialog",
        "Close the message of the safety system on the pendant.",
        "closing safety dialog",
        _CLIENT,
        to.close_safety_dialog,
    ),
    _row(
        "unlockProtectiveStop",
        "End a protective stop.",
        "Protective stop unlocking...",
        _CLIENT,
        to.unlock,
        Guard("Failed to unlock protective stop"),
    ),
    _row("log -a TEXT", "Add a line to the robot's log.", "Log has been added.", _CLIENT, to.add_log),
    _row(
        "popup -s TEXT",
        "Open a message window; the blank before the text may be missing.",
        "Showing popup with text:TEXT",
        _CLIENT,
        to.show_popup,
    ),
    _row("popup -c", "Close the message window.", "Closing popup", _CLIENT, to.close_popup),
    _row("status", "Modes, task and speed in several lines.", "several lines NAME: VALUE", _CLIENT, to.tell_status),
    _row("speed", "Position of the speed slider in percent.", "Target Speed Fraction: N", _OBSERVED, to.tell_speed),
    _row(
        "speed -v N",
        "Set the speed slider, 0 to 100 percent.",
        "Speed is set to: N",
        _OWN_WORDS,
        to.set_speed,
        Guard("Failed to set speed"),
    ),
    _row("task", "Path of the loaded task.", "Relative path:PATH", _CLIENT, to.tell_task),
    _row("task -p PATH", "Load a task of the task folder.", "Loaded task: PATH", _CLIENT, to.load_task, _LOAD),
    _row("task -s", "State of the task.", "Task is running / paused / stopped", _CLIENT, to.tell_task_state),
    _row("task -r", "Whether a task is running.", "Task is running / not running", _CLIENT, to.tell_running),
    _row("task -ss", "Whether the loaded task is saved.", "Task is saved / not saved", _CLIENT, to.tell_saved),
    _row("play", "Start the loaded task, or go on with a paused one.", "Starting task", _CLIENT, to.play_task, _PLAY),
    _row("pause", "Pause the task.", "Pausing task", _CLIENT, to.pause_task, _PAUSE),
    _row(
        "stop",
        "Stop the task, or a program that came from a port.",
        "Stopping task",
        _CLIENT,
        to.stop_task,
        Guard("Failed to stop task"),
    ),
    _row(
        "configuration",
        "Path of the loaded configuration.",
        "configuration: Relative path:PATH",
        _CLIENT,
        to.tell_configuration,
    ),
    _row(
        "configuration -p PATH",
        "Load a configuration of its folder.",
        "Loading Configuration :PATH",
        _CLIENT,
        to.load_configuration,
        _CONFIGURE,
    ),
    _row(
        "configuration -s",
        "Whether the configuration was changed since it was loaded.",
        "Configuration is modified / not modified",
        _CLIENT,
        to.tell_modified,
    ),
    _row("clear -a", "Clear the alarms that the pendant shows.", "clear alarm", _OBSERVED, to.clear_alarms),
    _row("remoteControl -on", "Switch to remote control.", "Remote control is on", _ASSUMED, to.switch_remote_on),
    _row("remoteControl -off", "Switch to local control.", "Remote control is off", _ASSUMED, to.switch_remote_off),
    _row("remoteControl -s", "Which control is on.", "Remote control is on / off", _ASSUMED, to.tell_remote),
    _row("remoteControl -status", "Which control is on.", "Remote control is on / off", _ASSUMED, to.tell_remote),
    _row(
        "variable -get NAME",
        "Value of a program variable.",
        "NAME: VALUE / Can not find variable NAME: ...",
        _ASSUMED,
        to.get_variable,
    ),
    _row(
        "variable -set NAME VALUE",
        "Give a program variable a value while no task runs.",
        "Variable is set: NAME",
        _ASSUMED,
        to.set_variable,
        _SET,
    ),
    _row("quit", "End this connection.", "Bye.", _OWN_WORDS, to.end_connection),
    _row("reboot", "Start the controller anew.", "Rebooting", _OWN_WORDS, to.reboot, Guard("Failed to reboot")),
    _row(
        "shutdown",
        "Switch arm and controller off.",
        "Shutting down",
        _OWN_WORDS,
        to.shut_down,
        Guard("Failed to shut down"),
    ),
)

VERBS: Final[dict[str, tuple[DashboardCommand, ...]]] = {
    name: tuple(row for row in _ROWS if row.verb == name) for name in dict.fromkeys(row.verb for row in _ROWS)
}
"""Every verb with its rows."""


def help_text(names: list[str]) -> str:
    """Return the explanation of some verbs, a line for each option."""
    return "\r\n".join(_explained(name) for name in names)


def usage_text(names: list[str]) -> str:
    """Return the syntax of some verbs, one line for each."""
    if not names:
        return "usage: usage NAME..."
    return "\r\n".join(_usage_of(name) for name in names)


def _usage_of(name: str) -> str:
    rows = VERBS.get(name)
    return f"usage: {' | '.join(row.usage for row in rows)}" if rows else unknown_text(name)


def _explained(name: str) -> str:
    rows = VERBS.get(name)
    return "\r\n".join(f"{row.usage}: {row.summary}" for row in rows) if rows else unknown_text(name)


def unknown_text(word: str) -> str:
    """Return the answer to an unknown verb."""
    return f"Unknown command: {shown(word)}; help lists the commands"


_LIST: Final = f"Commands: {' '.join(VERBS)}\r\nhelp NAME explains one, usage NAME shows how it is written."
