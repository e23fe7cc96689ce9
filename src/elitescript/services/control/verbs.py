"""What `elitescript ctl` can ask of a served robot: one row for each verb.

A verb stands for an action beside the robot: it is not bound to remote control. The robot itself does it, or refuses
it with a reason; files, windows and control go the way of the same command of the dashboard.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Final

from elitescript.controller.signals.by_name import signal_write
from elitescript.errors import UsageError
from elitescript.messages.enums import TaskState
from elitescript.messages.inputs import AddFault, Debug, Do, EndFaults, Input, PlayTask
from elitescript.messages.machine import (
    AskSafety,
    MachineRequest,
    PauseTask,
    PowerOff,
    PowerOn,
    ReleaseBrakes,
    ResumeTask,
    SetSpeedScale,
    StopTask,
    WriteSignal,
)
from elitescript.messages.outcomes import Outcome
from elitescript.messages.outputs import Output
from elitescript.messages.signals import SIGNALS, Value, parse_signal_name, signal_name
from elitescript.messages.snapshot import RobotDescription, Snapshot
from elitescript.messages.snapshot_parts import JOINTS, POSES, TIME
from elitescript.protocol.dashboard.answers import Answer, Asked
from elitescript.protocol.dashboard.connection import find_row
from elitescript.protocol.outcomes import refusal_of, value_text
from elitescript.records import NamedTuple, replace

if TYPE_CHECKING:
    from elitescript.services.served_devices import ServedDevices


class VerbAction(NamedTuple):
    """What a verb does."""

    inputs: tuple[Input, ...] = ()
    text: str = ""
    """Shown when it is done."""
    failure: str = ""
    """If not empty the robot answers the input, and this begins the text of its refusal."""

    def answered(self, origin: str) -> tuple[VerbAction, tuple[str, ...]]:
        """Return the action with an origin for each request to the machine, and the origins that get a reply."""
        inputs: list[Input] = []
        awaited = [origin] if self.failure else []
        for number, item in enumerate(self.inputs, 1):
            if isinstance(item, Do):
                item = replace(item, origin=f"{origin}.{number}", is_answered=True)
                awaited.append(item.origin)
            inputs.append(item)
        return self._replace(inputs=tuple(inputs)), tuple(awaited)


class VerbRequest(NamedTuple):
    """What was asked, with the robot it is about."""

    origin: str
    arguments: tuple[str, ...]
    values: Mapping[str, Value]
    """Of `set`: values by name."""
    snapshot: Snapshot
    description: RobotDescription
    world: ServedDevices | None = None
    """The virtual devices beside the robot."""

    @property
    def connection(self) -> str:
        """Origin of all that one connection asks for."""
        return self.origin.partition("/")[0]


class Verb(NamedTuple):
    """One row."""

    name: str
    argument: str
    """As usage texts call it; empty for none, in brackets if it may be left out."""
    summary: str
    order: Callable[[VerbRequest], VerbAction] | None = None
    """None if it only reads, see `read`."""
    read: Callable[[VerbRequest, Output], dict[str, Any]] | None = None
    """Returns what it shows, from the output of a tick."""
    details: Callable[[], tuple[str, ...]] = tuple
    """Further lines of its help."""
    parts: int = 0
    """Of the snapshot that `read` reads, as bits; 0 for the discrete state."""

    @property
    def usage(self) -> str:
        """How it is written."""
        return f"{self.name} {self.argument}".strip()


def outcome_text(order: VerbAction, outcomes: Iterable[Outcome]) -> str:
    """Return the text for an action that the robot has answered.

    Args:
        order: what was asked for.
        outcomes: of its inputs, in their order.

    Raises:
        UsageError: the robot refuses one of them; with the first refusal.
    """
    text = order.text
    for outcome in outcomes:
        if (why_not := refusal_of(outcome)) is not None:
            raise UsageError(f"{order.failure}: {why_not}" if order.failure else why_not)
        text += value_text(outcome)
    return text


def _dashboard_order(line: str, request: VerbRequest) -> VerbAction:
    """Return what a dashboard command asks of the robot.

    Raises:
        UsageError: the command is refused: it asks nothing.
    """
    found = find_row(line)
    if isinstance(found, str):
        raise UsageError(found)
    row, argument = found
    if row.guard is not None and (refusal := row.guard._replace(is_remote_only=False).refusal(request.snapshot)):
        raise UsageError(refusal)
    answer: Answer = row.answer(Asked(request.origin, argument, request.snapshot, request.description))
    if not answer.inputs:
        raise UsageError(answer.text)
    return VerbAction(answer.inputs, answer.text, answer.failure)


def _set(request: VerbRequest) -> VerbAction:
    if not request.values:
        raise UsageError("set needs NAME=VALUE")
    writes = [signal_write(name, value) for name, value in request.values.items()]
    names = ", ".join(f"{name}={value}" for name, value in request.values.items())
    return VerbAction(tuple(Do(request.origin, write) for write in writes), names)


def _press(name: str, level: bool, text: str) -> Callable[[VerbRequest], VerbAction]:
    def order(request: VerbRequest) -> VerbAction:
        return VerbAction((Do(request.origin, WriteSignal(name, 0, level)),), text)

    return order


def _safeguard(request: VerbRequest) -> VerbAction:
    is_open = {"open": True, "closed": False, "": True}.get(" ".join(request.arguments))
    if is_open is None:
        raise UsageError("safeguard takes open or closed")
    text = "safeguard open" if is_open else "safeguard closed"
    return VerbAction((Do(request.origin, WriteSignal("safeguard_stop", 0, is_open)),), text)


def _ask(machine_request: MachineRequest, text: str) -> Callable[[VerbRequest], VerbAction]:
    def order(request: VerbRequest) -> VerbAction:
        return VerbAction((Do(request.origin, machine_request),), text)

    return order


def _safety(action: str, text: str) -> Callable[[VerbRequest], VerbAction]:
    def order(request: VerbRequest) -> VerbAction:
        reason = " ".join(request.arguments) or "asked for by ctl"
        return VerbAction((Do(request.origin, AskSafety(action, reason)),), text)

    return order


def _power(request: VerbRequest) -> VerbAction:
    word = " ".join(request.arguments)
    if word not in ("on", "off"):
        raise UsageError("power takes on or off")
    return VerbAction((Do(request.origin, PowerOn() if word == "on" else PowerOff()),), f"powering {word}")


def _stop(request: VerbRequest) -> VerbAction:
    """Stop the task; one whose program is on its way from a client does not start."""
    is_running = request.snapshot.robot.task_state is not TaskState.STOPPED
    return VerbAction(
        (Do(request.origin, StopTask()),), "task stopped" if is_running else "no task or program is running"
    )


def _play(request: VerbRequest) -> VerbAction:
    return VerbAction((PlayTask(request.origin),), "task started", "not started")


def _load(request: VerbRequest) -> VerbAction:
    return _dashboard_order(f"task -p {' '.join(request.arguments)}", request)


def _speed(request: VerbRequest) -> VerbAction:
    text = " ".join(request.arguments)
    try:
        fraction = float(text)
    except ValueError:
        raise UsageError(f"speed takes a fraction from 0 to 1, not {text!r}") from None
    if not 0.0 <= fraction <= 1.0:
        raise UsageError(f"speed takes a fraction from 0 to 1, not {fraction:g}")
    return VerbAction((Do(request.origin, SetSpeedScale(fraction)),), f"speed {fraction:g}")


def _popup(request: VerbRequest) -> VerbAction:
    if request.arguments not in (("confirm",), ()):
        raise UsageError("popup takes confirm")
    if not request.snapshot.popup:
        raise UsageError("no message window is open")
    return _dashboard_order("popup -c", request)


def _disturb(request: VerbRequest) -> VerbAction:
    """`disturb KIND on=PLACE NAME=VALUE...`, or `disturb end`."""
    from ast import literal_eval

    from elitescript.devices.channels.faults import DEVICE, fault_from, nowhere, place_of
    from elitescript.devices.channels.machine_faults import machine_fault

    if not request.arguments:
        raise UsageError("disturb takes KIND on=PLACE NAME=VALUE..., or end")
    kind, *words = request.arguments
    if kind == "end" and not words:
        return VerbAction((EndFaults(request.origin),), "nothing goes wrong any more", failure="disturb")
    settings: dict[str, Any] = {"kind": kind}
    for word in words:
        name, equals, text = word.partition("=")
        if not equals:
            raise UsageError(f"disturb takes KIND on=PLACE NAME=VALUE..., not {word!r}")
        try:
            settings[name] = literal_eval(text)
        except (ValueError, SyntaxError, MemoryError, RecursionError):
            settings[name] = text
    fault = fault_from(settings)
    if request.world is not None:
        fault = request.world.check_fault(fault)
    elif place_of(fault.on)[0] == DEVICE:
        raise nowhere(fault.on, ())
    return VerbAction((AddFault(request.origin, machine_fault(fault)),), str(fault), failure="disturb")


def _fault_kinds() -> tuple[str, ...]:
    """Return lines that `help` adds to `disturb`."""
    from elitescript.devices.channels.faults import TABLE

    channels = ", ".join(name for name, row in TABLE.items() if not row.is_of_inputs)
    inputs = ", ".join(name for name, row in TABLE.items() if row.is_of_inputs)
    return (
        "PLACE is a port, a serial line, an input such as standard_digital_in[3], or the name of a device;",
        f"KIND of a port or line: {channels};",
        f"KIND of an input: {inputs}",
    )


def _control(word: str) -> Callable[[VerbRequest], VerbAction]:
    return lambda request: _dashboard_order(f"remoteControl -{word}", request)


def _debug(request: VerbRequest) -> VerbAction:
    """`debug JSON`, or with the object as `values`."""
    text = " ".join(request.arguments) or json.dumps(dict(request.values))
    return VerbAction((Debug(request.origin, request.connection, text),), failure="debug")


def _debug_requests() -> tuple[str, ...]:
    """Return lines that `help` adds to `debug`."""
    return ("""JSON is an object such as {"do": "threads"} or {"do": "evaluate", "text": "get_actual_tcp_pose()"};""",)


def _values(request: VerbRequest, output: Output) -> dict[str, Any]:
    image = output.snapshot.signals
    if not request.arguments:
        return {
            signal_name(row, index): value
            for row in SIGNALS.values()
            for index, value in enumerate(image[row.name])
            if value != row.default
        }
    found: dict[str, Any] = {}
    for name in request.arguments:
        family = SIGNALS.get(name)
        if family is not None:
            found |= {signal_name(family, index): value for index, value in enumerate(image[family.name])}
        else:
            row, index = parse_signal_name(name)
            found[signal_name(row, index)] = image[row.name][index]
    return found


def _state(request: VerbRequest, output: Output) -> dict[str, Any]:
    snapshot, robot = output.snapshot, output.snapshot.robot
    is_under_way = robot.task_state is not TaskState.STOPPED
    return {
        "model": request.description.model,
        "tick": output.tick,
        "time_s": robot.time_s,
        "robot_mode": robot.robot_mode.name,
        "safety_mode": robot.safety_mode.name,
        "task_state": robot.task_state.name,
        "line": robot.line,
        "node": {"row": robot.node[0], "text": robot.node[1]} if is_under_way and robot.node[0] else None,
        "joints": robot.q_actual,
        "tcp_pose": robot.tcp_pose_actual,
        "is_moving": robot.is_moving,
        "speed": robot.speed_scale,
        "remote": snapshot.is_remote,
        "popup": snapshot.popup,
        "task": asdict(snapshot.task),
    }


_ROWS: Final = (
    Verb("state", "", "Modes, task, joints, late ticks.", read=_state, parts=TIME | JOINTS | POSES),
    Verb("get", "[NAME...]", "Values of signals; all that are not at their default.", read=_values),
    Verb("set", "NAME=VALUE...", "Set signals, inputs above all.", _set),
    Verb("estop", "", "Press the emergency stop.", _press("emergency_stop", True, "emergency stop pressed")),
    Verb("release", "", "Release the emergency stop.", _press("emergency_stop", False, "emergency stop released")),
    Verb("safeguard", "[open|closed]", "Open or close the safeguard.", _safeguard),
    Verb("protective", "[REASON]", "Stop protectively.", _safety("stop_protectively", "protective stop")),
    Verb("unlock", "", "End a protective stop.", _safety("unlock_protective_stop", "protective stop unlocked")),
    Verb("violation", "[REASON]", "Break a safety limit.", _safety("violate", "safety violation")),
    Verb("fault", "[REASON]", "Have the safety system fail.", _safety("fail", "safety fault")),
    Verb(
        "disturb",
        "KIND on=PLACE...|end",
        "Let something go wrong on a connection, a serial line or at an input.",
        _disturb,
        details=_fault_kinds,
    ),
    Verb(
        "restart",
        "",
        "Restart the safety system after a fault or a violation; the arm is off afterwards.",
        _safety("restart_safety", "safety system restarted"),
    ),
    Verb("power", "on|off", "Power of the arm.", _power),
    Verb(
        "brakes", "", "Release the brakes; power on first, if need be.", _ask(ReleaseBrakes(), "releasing the brakes")
    ),
    Verb("load", "TASK", "Load a task of the task folder, such as pick.task or pick.script.", _load),
    Verb("play", "", "Start the loaded task, or go on with a paused one; --wait returns when it has ended.", _play),
    Verb("pause", "", "Pause the task.", _ask(PauseTask(), "task paused")),
    Verb("resume", "", "Go on with a paused task or program.", _ask(ResumeTask(), "task resumed")),
    Verb("stop", "", "Stop the task or program.", _stop),
    Verb("popup", "confirm", "Confirm the message window that is open.", _popup),
    Verb("speed", "0..1", "Speed slider as a fraction.", _speed),
    Verb("remote", "", "Switch to remote control.", _control("on")),
    Verb("local", "", "Switch to local control: clients may only look.", _control("off")),
    Verb("ports", "", "Every port, and its clients."),
    Verb(
        "debug",
        "JSON",
        "Debug the program that runs, until this connection ends; see `elitescript dap`.",
        _debug,
        details=_debug_requests,
    ),
)

VERBS: Final[dict[str, Verb]] = {row.name: row for row in _ROWS}
"""All verbs by name, in the order in which they are shown."""
