"""Answers of the dashboard shell, from a snapshot and the description of the robot, and their inputs to the robot.

One function for each row of `verbs`, whose summary describes it.
"""

from __future__ import annotations

from typing import Final

from elitescript.messages.enums import RobotMode, SafetyMode, TaskState
from elitescript.messages.inputs import (
    AddLog,
    ClosePopup,
    Do,
    GetVariable,
    Input,
    LoadConfiguration,
    LoadTask,
    PlayTask,
    Reboot,
    SetRemote,
    SetVariable,
    ShowPopup,
)
from elitescript.messages.machine import (
    AskSafety,
    MachineRequest,
    PauseTask,
    PowerDown,
    PowerOff,
    PowerOn,
    ReleaseBrakes,
    SetSpeedScale,
    StopTask,
)
from elitescript.messages.profile import version_text
from elitescript.messages.snapshot import RobotDescription, Snapshot
from elitescript.protocol.dashboard.guards import MAY_MOVE, safety_name
from elitescript.protocol.lines import shown
from elitescript.records import record

REPLY_LIMIT: Final = 512
"""Bytes of a reply of several lines that clients take in one read."""

_TASK_WORDS: Final = {TaskState.PLAYING: "running", TaskState.PAUSED: "paused"}


@record
class Asked:
    """A command and the data for its answer."""

    origin: str
    argument: str
    snapshot: Snapshot
    description: RobotDescription


@record
class Answer:
    """Effect of a command."""

    text: str
    """The reply, lines separated by CR LF, without the last end; with `failure`, the one after success."""
    inputs: tuple[Input, ...] = ()
    failure: str = ""
    """If not empty, the reply waits for that of the robot: this text and the reason if it refuses."""
    is_last: bool = False
    """Whether the connection ends."""


def _do(asked: Asked, request: MachineRequest) -> Do:
    return Do(asked.origin, request)


def power_on(asked: Asked) -> Answer:
    is_off = asked.snapshot.robot.robot_mode is RobotMode.POWER_OFF
    return Answer("Powering on", (_do(asked, PowerOn()),) if is_off else ())


def power_off(asked: Asked) -> Answer:
    return Answer("Powering off", (_do(asked, PowerOff()),))


def release_brakes(asked: Asked) -> Answer:
    if asked.snapshot.robot.robot_mode is RobotMode.RUNNING:
        return Answer("Brake is released...")
    return Answer("Brake Releasing...", (_do(asked, ReleaseBrakes()),))


def unlock(asked: Asked) -> Answer:
    """Request the end of a protective stop; the robot decides whether it may end."""
    text = "Protective stop unlocking..."
    if asked.snapshot.robot.safety_mode in (*MAY_MOVE, SafetyMode.RECOVERY):
        return Answer(text)
    request = Do(asked.origin, AskSafety("unlock_protective_stop", "asked for on the dashboard"), is_answered=True)
    return Answer(text, (request,), failure="Failed")


def restart_safety(asked: Asked) -> Answer:
    request = AskSafety("restart_safety", "asked for on the dashboard")
    return Answer("Restarting safety board", (_do(asked, request),))


def load_task(asked: Asked) -> Answer:
    """Load a task; the robot checks that the file exists."""
    failure = f"Failed to load task {shown(asked.argument)}"
    if why := _why_not_inside(asked.argument):
        return Answer(f"{failure}: {why}")
    return Answer(f"Loaded task: {asked.argument}", (LoadTask(asked.origin, asked.argument),), failure)


def load_configuration(asked: Asked) -> Answer:
    failure = f"Failed to load configuration {shown(asked.argument)}"
    if why := _why_not_inside(asked.argument):
        return Answer(f"{failure}: {why}")
    request = LoadConfiguration(asked.origin, asked.argument)
    return Answer(f"Loading Configuration :{asked.argument}", (request,), failure)


def _why_not_inside(path: str) -> str:
    if path.startswith(("/", "\\")) or ".." in path.replace("\\", "/").split("/") or "\0" in path:
        return "the path must lead into its folder"
    return ""


def play_task(asked: Asked) -> Answer:
    """Start or resume the task; the robot checks that it compiles."""
    snapshot = asked.snapshot
    failure = "Failed to start task"
    if snapshot.robot.task_state is TaskState.STOPPED and not snapshot.task.loaded:
        return Answer(f"{failure}: no task is loaded; load one with task -p PATH")
    return Answer("Starting task", (PlayTask(asked.origin),), failure)


def pause_task(asked: Asked) -> Answer:
    return Answer("Pausing task", (_do(asked, PauseTask()),))


def stop_task(asked: Asked) -> Answer:
    """Stop the program that runs, if any: one may have started since the snapshot was taken."""
    return Answer("Stopping task", (_do(asked, StopTask()),))


def set_speed(asked: Asked) -> Answer:
    text = asked.argument.strip()
    if not (text.isascii() and text.isdecimal() and len(text) <= 3 and int(text) <= 100):
        return Answer(f"Failed to set speed: {shown(text)} is not a whole number from 0 to 100 (percent)")
    return Answer(f"Speed is set to: {int(text)}", (_do(asked, SetSpeedScale(int(text) / 100)),))


def get_variable(asked: Asked) -> Answer:
    name = asked.argument.strip()
    failure = f"Can not find variable {shown(name)}"
    if not name.isidentifier():
        return Answer(f"{failure}: it is not a name")
    return Answer(f"{name}: ", (GetVariable(asked.origin, name),), failure)


def set_variable(asked: Asked) -> Answer:
    name, _, value = asked.argument.strip().partition(" ")
    value = value.strip()
    failure = f"Failed to set variable {shown(name)}"
    if not name.isidentifier():
        return Answer(f"{failure}: it is not a name")
    if not value:
        return Answer(f"{failure}: there is no value; usage: variable -set NAME VALUE")
    return Answer(f"Variable is set: {name}", (SetVariable(asked.origin, name, value),), failure)


def tell_remote(asked: Asked) -> Answer:
    return Answer(f"Remote control is {'on' if asked.snapshot.is_remote else 'off'}")


def tell_status(asked: Asked) -> Answer:
    """Return the overview, which fits into one read of a client."""
    robot, task = asked.snapshot.robot, asked.snapshot.task
    words = {TaskState.PLAYING: "RUNNING", TaskState.PAUSED: "PAUSED"}
    lines = [
        f"RobotMode: {robot.robot_mode.name}",
        f"SafetyStatus: {safety_name(robot.safety_mode)}",
        f"RunningStatus: {words.get(robot.task_state, 'STOPPED')}",
        f"Target Speed Fraction: {percent(robot.speed_scale)}",
        f"RemoteControl: {'on' if asked.snapshot.is_remote else 'off'}",
        f"Task: {_clipped(task.loaded)}",
        f"Configuration: {_clipped(task.configuration)}",
    ]
    return Answer("\r\n".join(lines))


def percent(fraction: float) -> int:
    """Return the speed slider as this port shows it."""
    return round(fraction * 100)


def _clipped(path: str) -> str:
    data = path.encode()
    return path if len(data) <= 120 else data[:117].decode("utf-8", "ignore") + "..."


def tell_saved(asked: Asked) -> Answer:
    return Answer("Task is saved" if asked.snapshot.task.is_saved else "Task is not saved")


def tell_modified(asked: Asked) -> Answer:
    is_modified = asked.snapshot.task.is_configuration_modified
    return Answer("Configuration is modified" if is_modified else "Configuration is not modified")


def tell_task_state(asked: Asked) -> Answer:
    return Answer(f"Task is {_TASK_WORDS.get(asked.snapshot.robot.task_state, 'stopped')}")


def tell_running(asked: Asked) -> Answer:
    is_running = asked.snapshot.robot.task_state is TaskState.PLAYING
    return Answer("Task is running" if is_running else "Task is not running")


def tell_version(asked: Asked) -> Answer:
    return Answer(version_text(asked.description.version))


def tell_model(asked: Asked) -> Answer:
    return Answer(asked.description.model.upper())


def tell_serial_number(asked: Asked) -> Answer:
    return Answer(asked.description.serial_number)


def tell_robot_id(asked: Asked) -> Answer:
    return Answer(asked.description.robot_id)


def tell_robot_mode(asked: Asked) -> Answer:
    return Answer(f"robotMode: {asked.snapshot.robot.robot_mode.name}")


def tell_safety_status(asked: Asked) -> Answer:
    return Answer(f"Safety status: {safety_name(asked.snapshot.robot.safety_mode)}")


def tell_safety_mode(asked: Asked) -> Answer:
    return Answer(f"Safety mode: {safety_name(asked.snapshot.robot.safety_mode)}")


def tell_speed(asked: Asked) -> Answer:
    return Answer(f"Target Speed Fraction: {percent(asked.snapshot.robot.speed_scale)}")


def tell_task(asked: Asked) -> Answer:
    return Answer(f"Relative path:{asked.snapshot.task.loaded}")


def tell_configuration(asked: Asked) -> Answer:
    return Answer(f"configuration: Relative path:{asked.snapshot.task.configuration}")


def say_hello(asked: Asked) -> Answer:
    return Answer("Hello ELITE ROBOTS.")


def close_safety_dialog(asked: Asked) -> Answer:
    """Reply that the dialog is closed; only the pendant has one, clients expect this also when none is open."""
    return Answer("closing safety dialog")


def clear_alarms(asked: Asked) -> Answer:
    """Reply that the alarms are cleared; only the pendant has a list of them."""
    return Answer("clear alarm")


def add_log(asked: Asked) -> Answer:
    return Answer("Log has been added.", (AddLog(asked.origin, asked.argument),))


def show_popup(asked: Asked) -> Answer:
    return Answer(f"Showing popup with text:{asked.argument}", (ShowPopup(asked.origin, asked.argument),))


def close_popup(asked: Asked) -> Answer:
    return Answer("Closing popup", (ClosePopup(asked.origin),))


def switch_remote_on(asked: Asked) -> Answer:
    """Switch to remote control, also under local control."""
    return Answer("Remote control is on", (SetRemote(asked.origin, True),))


def switch_remote_off(asked: Asked) -> Answer:
    return Answer("Remote control is off", (SetRemote(asked.origin, False),))


def end_connection(asked: Asked) -> Answer:
    return Answer("Bye.", is_last=True)


def reboot(asked: Asked) -> Answer:
    return Answer("Rebooting", (Reboot(asked.origin),), is_last=True)


def shut_down(asked: Asked) -> Answer:
    return Answer("Shutting down", (_do(asked, PowerDown()),), is_last=True)
