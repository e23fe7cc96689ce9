"""The states in which the dashboard's commands are refused, against tables written by hand."""

from __future__ import annotations

import re

import pytest

from elitescript.controller.modes import TRANSITIONS
from elitescript.controller.safety.states import MODES as MODES_OF_SAFETY
from elitescript.messages.enums import RobotMode, SafetyMode, TaskState
from elitescript.protocol.dashboard.connection import DashboardConnection
from elitescript.protocol.dashboard.verbs import VERBS
from tests.protocol.line_peer import Peer

MODES = {
    "robotControl -on": {"BOOTING", "POWER_OFF", "POWER_ON", "IDLE", "BACK_DRIVE", "RUNNING"},
    "brakeRelease": {"IDLE", "RUNNING"},
    "play": {"RUNNING"},
}
NOT_SAFE = {
    "robotControl -on": {"SYSTEM_EMERGENCY_STOP", "ROBOT_EMERGENCY_STOP", "VIOLATION", "FAULT"},
    "brakeRelease": {"SYSTEM_EMERGENCY_STOP", "ROBOT_EMERGENCY_STOP", "VIOLATION", "FAULT"},
    "play": {mode.name for mode in SafetyMode} - {"NORMAL", "REDUCED"},
}
TASKS = {
    "task -p PATH": {"STOPPED"},
    "configuration -p PATH": {"STOPPED"},
    "variable -set NAME VALUE": {"STOPPED"},
    "play": {"STOPPED", "PAUSED"},
    "pause": {"PLAYING"},
}
REMOTE_ONLY = {
    "robotControl -on",
    "robotControl -off",
    "brakeRelease",
    "safety -r",
    "unlockProtectiveStop",
    "speed -v N",
    "task -p PATH",
    "play",
    "pause",
    "stop",
    "configuration -p PATH",
    "variable -set NAME VALUE",
    "reboot",
    "shutdown",
}
"""Commands that local control refuses."""
TRANSITIONS_OF_POWER = {mode for mode, _ in TRANSITIONS}
ACCEPTED = (
    r"Brake (Releasing.*|is released).*|Powering o|Restarting safety board|Protective stop unlocking|Loaded task: .*"
    r"|Loading Configuration :.*|Starting task|Pausing task|Stopping task|Task is .*"
)
"""What the vendor's client takes for success, anywhere in a reply."""
LINES = [row.usage for rows in VERBS.values() for row in rows]


def answer(usage: str, **changes: object) -> tuple[list[bytes], bool]:
    """The reply, and whether the robot was asked for something."""
    state = {"task_state": TaskState.PLAYING if usage == "pause" else TaskState.STOPPED, **changes}
    peer = Peer(DashboardConnection, **state)
    line = usage.replace("NAME VALUE", "g 1").replace(" N", " 5").replace("[NAME...]", "").replace("NAME", "g")
    return peer.send(line.encode() + b"\n"), bool(peer.inputs)


def is_refused(usage: str, **changes: object) -> bool:
    replies, is_asked = answer(usage, **changes)
    refused = any(reply.startswith(b"Failed to ") for reply in replies)
    assert not (refused and is_asked)
    if refused:
        [reply] = replies
        assert not re.search(ACCEPTED, reply.decode())
    return refused


@pytest.mark.parametrize("usage", LINES)
@pytest.mark.parametrize("mode", list(RobotMode))
def test_robot_modes_refuse_what_the_table_says(usage: str, mode: RobotMode) -> None:
    assert is_refused(usage, robot_mode=mode) == (mode.name not in MODES.get(usage, set(RobotMode.__members__)))


@pytest.mark.parametrize("usage", LINES)
@pytest.mark.parametrize("mode", list(SafetyMode))
def test_safety_modes_refuse_what_the_table_says(usage: str, mode: SafetyMode) -> None:
    assert is_refused(usage, safety_mode=mode) == (mode.name in NOT_SAFE.get(usage, set()))


@pytest.mark.parametrize("usage", LINES)
@pytest.mark.parametrize("state", list(TaskState))
def test_task_states_refuse_what_the_table_says(usage: str, state: TaskState) -> None:
    assert is_refused(usage, task_state=state) == (state.name not in TASKS.get(usage, set(TaskState.__members__)))


@pytest.mark.parametrize("usage", LINES)
def test_local_control_refuses_what_changes_the_robot(usage: str) -> None:
    assert is_refused(usage, is_remote=False) == (usage in REMOTE_ONLY)


@pytest.mark.parametrize("usage", sorted(REMOTE_ONLY))
def test_what_is_taken_under_remote_control_is_no_refusal(usage: str) -> None:
    assert not is_refused(usage)


@pytest.mark.parametrize(
    ("usage", "changes", "reply"),
    [
        (
            "stop",
            {"is_remote": False},
            b"Failed to stop task: the robot is under local control; "
            b"switch it to remote control first (remoteControl -on)\r\n",
        ),
        (
            "brakeRelease",
            {"robot_mode": RobotMode.POWER_OFF},
            b"Failed to release the brakes: robotMode is POWER_OFF; power on first (robotControl -on)\r\n",
        ),
        (
            "play",
            {"safety_mode": SafetyMode.UNDEFINED},
            b"Failed to start task: safety status is UNDEFINED_SAFETY_MODE\r\n",
        ),
        ("play", {"task_state": TaskState.PLAYING}, b"Failed to start task: a task is running; stop it first\r\n"),
        ("task -p x", {"task_state": TaskState.PAUSED}, b"Failed to load task: a task is paused; stop it first\r\n"),
        ("pause", {"task_state": TaskState.STOPPED}, b"Failed to pause task: no task is running\r\n"),
        ("play", {"loaded": ""}, b"Failed to start task: no task is loaded; load one with task -p PATH\r\n"),
    ],
)
def test_a_refusal_says_why(usage: str, changes: dict[str, object], reply: bytes) -> None:
    assert answer(usage, **changes) == ([reply], False)


def test_every_state_that_can_be_left_has_its_remedy() -> None:
    for mode in set(MODES_OF_SAFETY) - {SafetyMode.NORMAL, SafetyMode.REDUCED}:
        ((reply,), _) = answer("play", safety_mode=mode)
        assert b"; " in reply
    for mode in TRANSITIONS_OF_POWER - {RobotMode.RUNNING}:
        ((reply,), _) = answer("play", robot_mode=mode)
        assert b"; " in reply


def test_a_paused_program_goes_on_without_a_loaded_task() -> None:
    assert answer("play", loaded="", task_state=TaskState.PAUSED) == ([], True)


@pytest.mark.parametrize("mode", list(RobotMode))
def test_robot_modes_have_their_documented_names(mode: RobotMode) -> None:
    assert answer("robotMode", robot_mode=mode) == ([f"robotMode: {mode.name}\r\n".encode()], False)


def test_safety_modes_have_their_documented_names() -> None:
    names = [answer("safety -s", safety_mode=mode)[0][0].decode() for mode in SafetyMode]
    assert [name.removeprefix("Safety status: ").strip() for name in names] == [
        "NORMAL",
        "REDUCED",
        "PROTECTIVE_STOP",
        "RECOVERY",
        "SAFEGUARD_STOP",
        "SYSTEM_EMERGENCY_STOP",
        "ROBOT_EMERGENCY_STOP",
        "VIOLATION",
        "FAULT",
        "VALIDATE_JOINT_ID",
        "UNDEFINED_SAFETY_MODE",
        "AUTOMATIC_MODE_SAFEGUARD_STOP",
        "SYSTEM_THREE_POSITION_ENABLING_STOP",
        "TP_THREE_POSITION_ENABLING_STOP",
    ]
