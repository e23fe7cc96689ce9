"""The dashboard shell, 29999: lines, order, waiting, and every command in exact bytes."""

from __future__ import annotations

import random

import pytest

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
    PauseTask,
    PowerDown,
    PowerOff,
    PowerOn,
    ReleaseBrakes,
    SetSpeedScale,
    StopTask,
)
from elitescript.messages.outputs import Reply
from elitescript.protocol.connection import ProtocolError
from elitescript.protocol.dashboard.connection import (
    ANSWER_TICKS,
    LINE_LIMIT,
    LINES_PER_TICK,
    SETTLING_TICKS,
    WAITING_LIMIT,
    DashboardConnection,
    find_row,
)
from elitescript.protocol.dashboard.verbs import VERBS
from elitescript.protocol.outcomes import done, refused
from tests.protocol.line_peer import Peer

OWN = "peer#1/1"

AT_ONCE: list[tuple[str, str, list[Input]]] = [
    ("echo", "Hello ELITE ROBOTS.", []),
    ("version", "2.14.2.7", []),
    ("robot -t", "CS66", []),
    ("robot -s", "CS66-0001", []),
    ("robot -id", "robot-1", []),
    ("robotControl -on", "Powering on", []),
    ("robotControl -off", "Powering off", [Do(OWN, PowerOff())]),
    ("brakeRelease", "Brake is released...", []),
    ("robotMode", "robotMode: RUNNING", []),
    ("safety -s", "Safety status: NORMAL", []),
    ("safety -m", "Safety mode: NORMAL", []),
    (
        "safety -r",
        "Restarting safety board",
        [Do(OWN, AskSafety("restart_safety", "asked for on the dashboard"))],
    ),
    ("closeSafetyDialog", "closing safety dialog", []),
    ("unlockProtectiveStop", "Protective stop unlocking...", []),
    ("log -a Testing Log: a\\r\\nb", "Log has been added.", [AddLog(OWN, "Testing Log: a\\r\\nb")]),
    ("popup -sHello Robot", "Showing popup with text:Hello Robot", [ShowPopup(OWN, "Hello Robot")]),
    ("popup -s Hello Robot", "Showing popup with text:Hello Robot", [ShowPopup(OWN, "Hello Robot")]),
    ("popup -c", "Closing popup", [ClosePopup(OWN)]),
    ("speed", "Target Speed Fraction: 75", []),
    ("speed -v 37", "Speed is set to: 37", [Do(OWN, SetSpeedScale(0.37))]),
    ("speed -v 0", "Speed is set to: 0", [Do(OWN, SetSpeedScale(0.0))]),
    ("task", "Relative path:test.task", []),
    ("task -s", "Task is stopped", []),
    ("task -r", "Task is not running", []),
    ("task -ss", "Task is saved", []),
    ("stop", "Stopping task", [Do(OWN, StopTask())]),
    ("configuration", "configuration: Relative path:default.configuration", []),
    ("configuration -s", "Configuration is not modified", []),
    ("clear -a", "clear alarm", []),
    ("remoteControl -on", "Remote control is on", [SetRemote(OWN, True)]),
    ("remoteControl -off", "Remote control is off", [SetRemote(OWN, False)]),
    ("remoteControl -s", "Remote control is on", []),
    ("remoteControl -status", "Remote control is on", []),
    ("quit", "Bye.", []),
    ("reboot", "Rebooting", [Reboot(OWN)]),
    ("shutdown", "Shutting down", [Do(OWN, PowerDown())]),
    (
        "status",
        "RobotMode: RUNNING\r\nSafetyStatus: NORMAL\r\nRunningStatus: STOPPED\r\nTarget Speed Fraction: 75\r\n"
        "RemoteControl: on\r\nTask: test.task\r\nConfiguration: default.configuration",
        [],
    ),
    ("usage task", "usage: task | task -p PATH | task -s | task -r | task -ss", []),
    ("help echo", "echo: Ask whether the shell is there.", []),
    (
        "help popup nonsense",
        "popup -s TEXT: Open a message window; the blank before the text may be missing.\r\n"
        "popup -c: Close the message window.\r\nUnknown command: nonsense; help lists the commands",
        [],
    ),
]

LATER: list[tuple[str, Input, str, str, str]] = [
    (
        "task -p a/b c.task",
        LoadTask(OWN, "a/b c.task"),
        "",
        "Loaded task: a/b c.task",
        "Failed to load task a/b c.task",
    ),
    (
        "configuration -p default.configuration",
        LoadConfiguration(OWN, "default.configuration"),
        "",
        "Loading Configuration :default.configuration",
        "Failed to load configuration default.configuration",
    ),
    ("play", PlayTask(OWN), "", "Starting task", "Failed to start task"),
    ("variable -get g", GetVariable(OWN, "g"), "[1, 'x']", "g: [1, 'x']", "Can not find variable g"),
    (
        "variable -set g  [1, 2]",
        SetVariable(OWN, "g", "[1, 2]"),
        "",
        "Variable is set: g",
        "Failed to set variable g",
    ),
]


def shell(**changes: object) -> Peer:
    return Peer(DashboardConnection, **changes)  # type: ignore[arg-type]


def wire(*texts: str) -> list[bytes]:
    return [text.encode() + b"\r\n" for text in texts]


def test_the_greeting_is_three_lines_in_one_send() -> None:
    [greeting] = shell().greeting
    lines = greeting.split(b"\r\n")
    assert lines[0] == b"EliRobot dashboard shell, version 2.14.2.7."
    assert (len(lines), lines[3]) == (4, b"")
    assert len(greeting) <= 512


@pytest.mark.parametrize(("line", "reply", "inputs"), AT_ONCE, ids=[row[0] for row in AT_ONCE])
def test_a_command_is_answered_at_once_in_one_send(line: str, reply: str, inputs: list[Input]) -> None:
    for end in (b"\n", b"\r\n"):
        whole, trickle = shell(), shell()
        assert whole.send(line.encode() + end) == wire(reply)
        assert whole.inputs == inputs
        sent = [message for byte in line.encode() + end for message in trickle.send(bytes([byte]))]
        assert (sent, trickle.inputs) == (wire(reply), inputs)


@pytest.mark.parametrize(("line", "asked", "detail", "reply", "failure"), LATER, ids=[row[0] for row in LATER])
def test_a_command_waits_for_the_robot(line: str, asked: Input, detail: str, reply: str, failure: str) -> None:
    for outcome, text in ((done(detail), reply), (refused("the reason\nis this"), f"{failure}: the reason is this")):
        peer = shell()
        assert peer.send(line.encode() + b"\n") == []
        assert peer.inputs == [asked]
        assert peer.tick() == []
        assert peer.tick(Reply("peer#1", outcome), Reply("peer#1/11", outcome)) == []
        assert peer.tick(Reply(OWN, outcome)) == wire(text)
        assert peer.tick(Reply(OWN, outcome)) == []


@pytest.mark.parametrize("line", [" echo", "echo ", "\techo\t", "echo  \r"])
def test_blanks_around_a_command_do_not_matter(line: str) -> None:
    assert shell().send(line.encode() + b"\n") == wire("Hello ELITE ROBOTS.")


def test_a_tab_is_a_blank() -> None:
    assert shell().send(b"task\t-s\n") == wire("Task is stopped")


def test_a_text_keeps_its_blanks() -> None:
    peer = shell()
    assert peer.send(b"popup -s  two  words \n") == wire("Showing popup with text: two  words ")
    assert peer.inputs == [ShowPopup(OWN, " two  words ")]


def test_every_command_is_tested() -> None:
    rows = [find_row(line) for line in (*(row[0] for row in AT_ONCE), *(row[0] for row in LATER), "pause", "help")]
    tested = {row[0] for row in rows if not isinstance(row, str)}
    assert {row.usage for rows in VERBS.values() for row in rows} == {row.usage for row in tested}


def test_unlocking_a_protective_stop_is_up_to_the_robot() -> None:
    peer = shell(safety_mode=SafetyMode.PROTECTIVE_STOP)
    assert peer.send(b"unlockProtectiveStop\n") == []
    assert peer.inputs == [Do(OWN, AskSafety("unlock_protective_stop", "asked for on the dashboard"), True)]
    assert peer.tick(Reply(OWN, done())) == wire("Protective stop unlocking...")
    peer.send(b"unlockProtectiveStop\n")
    reply = Reply("peer#1/2", refused("cannot unlock protective stop: too early"))
    assert peer.tick(reply) == wire("Failed: cannot unlock protective stop: too early")


@pytest.mark.parametrize("mode", [SafetyMode.ROBOT_EMERGENCY_STOP, SafetyMode.SAFEGUARD_STOP, SafetyMode.FAULT])
def test_unlocking_does_not_pretend_to_end_another_stop(mode: SafetyMode) -> None:
    peer = shell(safety_mode=mode)
    assert peer.send(b"unlockProtectiveStop\n") == []
    reply = Reply(OWN, refused("cannot unlock protective stop: there is none"))
    assert peer.tick(reply) == wire("Failed: cannot unlock protective stop: there is none")


@pytest.mark.parametrize("mode", [SafetyMode.NORMAL, SafetyMode.REDUCED, SafetyMode.RECOVERY])
def test_unlocking_an_arm_that_may_move_changes_nothing(mode: SafetyMode) -> None:
    peer = shell(safety_mode=mode)
    assert peer.send(b"unlockProtectiveStop\n") == wire("Protective stop unlocking...")
    assert not peer.inputs


def test_powering_on_and_releasing_brakes_follow_the_mode() -> None:
    peer = shell(robot_mode=RobotMode.POWER_OFF)
    assert peer.send(b"robotControl -on\n") == wire("Powering on")
    peer.tick(robot_mode=RobotMode.IDLE)
    assert peer.send(b"brakeRelease\n") == wire("Brake Releasing...")
    assert peer.inputs == [Do(OWN, PowerOn()), Do("peer#1/2", ReleaseBrakes())]


@pytest.mark.parametrize(
    ("state", "answers"),
    [
        (TaskState.PLAYING, ("running", "running", "RUNNING")),
        (TaskState.PAUSED, ("paused", "not running", "PAUSED")),
        (TaskState.STOPPED, ("stopped", "not running", "STOPPED")),
    ],
)
def test_the_task_state_shows(state: TaskState, answers: tuple[str, str, str]) -> None:
    peer = shell(task_state=state)
    assert peer.send(b"task -s\ntask -r\n") == wire(f"Task is {answers[0]}", f"Task is {answers[1]}")
    [status] = peer.send(b"status\n")
    assert f"RunningStatus: {answers[2]}\r\n".encode() in status


def test_pause_takes_effect_while_a_task_runs() -> None:
    peer = shell(task_state=TaskState.PLAYING)
    assert peer.send(b"pause\n") == wire("Pausing task")
    assert peer.inputs == [Do(OWN, PauseTask())]


def test_other_states_of_files_show() -> None:
    peer = shell(is_saved=False, is_configuration_modified=True, loaded="", speed_scale=0.555, is_remote=False)
    assert peer.send(b"task -ss\nconfiguration -s\ntask\nspeed\nremoteControl -s\n") == wire(
        "Task is not saved",
        "Configuration is modified",
        "Relative path:",
        "Target Speed Fraction: 56",
        "Remote control is off",
    )


@pytest.mark.parametrize("size", [60, 75, 150, 900])
def test_status_fits_into_one_read_of_a_client(size: int) -> None:
    longest = max((mode.name for mode in SafetyMode), key=len)
    peer = shell(loaded="ü" * size, configuration="c" * 2 * size, safety_mode=SafetyMode[longest])
    [status] = peer.send(b"status\n")
    assert len(status) <= 512
    assert status.endswith(b"\r\n")


@pytest.mark.parametrize("line", ["help", *(f"{ask} {verb}" for ask in ("help", "usage") for verb in VERBS)])
def test_help_fits_into_one_read_of_a_client(line: str) -> None:
    [text] = shell().send(line.encode() + b"\n")
    assert len(text) <= 512
    assert text.endswith(b"\r\n")


def test_help_lists_every_command() -> None:
    [text] = shell().send(b"help\n")
    assert text.decode().split("\r\n")[0].split() == ["Commands:", *VERBS]


def test_commands_behind_one_that_waits_keep_their_order_and_see_what_it_did() -> None:
    peer = shell()
    assert peer.send(b"echo\nplay\ntask -s\nspeed -v 50\nvariable -get g\necho\n") == wire("Hello ELITE ROBOTS.")
    assert peer.inputs == [PlayTask("peer#1/2")]
    sent = peer.tick(Reply("peer#1/2", done()), task_state=TaskState.PLAYING)
    assert sent == wire("Starting task", "Task is running", "Speed is set to: 50")
    assert peer.inputs[1:] == [Do("peer#1/4", SetSpeedScale(0.5))]
    assert peer.tick(ticks=SETTLING_TICKS - 1) == []
    assert peer.tick(ticks=1) == []
    assert peer.inputs[2:] == [GetVariable("peer#1/5", "g")]
    assert peer.tick(Reply("peer#1/5", done("1"))) == wire("g: 1", "Hello ELITE ROBOTS.")


def test_a_command_sees_what_the_one_before_it_has_changed() -> None:
    peer = shell(robot_mode=RobotMode.RUNNING)
    assert peer.send(b"robotControl -off\nrobotControl -on\n") == wire("Powering off")
    assert [type(asked.request) for asked in peer.inputs] == [PowerOff]
    assert peer.tick(ticks=SETTLING_TICKS, robot_mode=RobotMode.POWER_OFF) == wire("Powering on")
    assert [type(asked.request) for asked in peer.inputs] == [PowerOff, PowerOn]


def test_a_robot_that_does_not_answer_is_given_up_and_its_late_answer_ignored() -> None:
    peer = shell()
    peer.send(b"play\nplay\n")
    assert peer.tick(ticks=ANSWER_TICKS - 1) == []
    assert peer.tick() == wire("Failed to start task: the controller has not answered for 4 s")
    assert peer.tick(Reply("peer#1/1", done())) == []
    assert peer.tick(Reply("peer#1/2", refused("no"))) == wire("Failed to start task: no")


def test_commands_are_read_a_few_in_a_tick() -> None:
    peer = Peer(DashboardConnection)
    assert len(peer.send(b"echo\n" * (LINES_PER_TICK + 1))) == LINES_PER_TICK
    assert peer.connection.is_busy
    assert peer.connection.is_expecting
    assert peer.tick() == [b"Hello ELITE ROBOTS.\r\n"]
    assert not peer.connection.is_busy
    assert not peer.connection.is_expecting


def test_commands_that_wait_are_bounded() -> None:
    peer = shell()
    peer.send(b"play\n" + b"echo\n" * WAITING_LIMIT)
    with pytest.raises(ProtocolError, match="more than 64 commands"):
        peer.send(b"echo\n")


def test_nothing_behind_the_last_command_is_done_though_it_waited() -> None:
    peer = shell()
    peer.send(b"play\nquit\nstop\n")
    assert peer.tick(Reply("peer#1/1", done())) == wire("Starting task", "Bye.")
    assert peer.inputs == [PlayTask("peer#1/1")]


@pytest.mark.parametrize("word", ["quit", "reboot", "shutdown"])
def test_the_connection_ends_after_its_last_reply(word: str) -> None:
    peer = shell()
    [_] = peer.send(f"{word}\necho\nrobotControl -off\n".encode())
    assert peer.connection.is_over
    assert peer.send(b"echo\n") == []
    assert not any(isinstance(item, Do) and isinstance(item.request, PowerOff) for item in peer.inputs)


@pytest.mark.parametrize(
    ("line", "reply"),
    [
        ("Echo", "Unknown command: Echo; help lists the commands"),
        ("power on", "Unknown command: power; help lists the commands"),
        ("\x00\x1b[A", "Unknown command: ??[A; help lists the commands"),
        ("x" * 100, f"Unknown command: {'x' * 60}...; help lists the commands"),
        ("echo there", "echo takes no argument, but there follows; usage: echo"),
        ("echo -x", "echo has no option -x; usage: echo"),
        ("robot", "robot needs an option; usage: robot -t | robot -s | robot -id"),
        ("robot -x", "robot has no option -x; usage: robot -t | robot -s | robot -id"),
        ("task -p", "task -p needs PATH; usage: task | task -p PATH | task -s | task -r | task -ss"),
        ("popup -s", "popup -s needs TEXT; usage: popup -s TEXT | popup -c"),
        ("usage", "usage needs NAME...; usage: usage NAME..."),
        ("speed -v 101", "Failed to set speed: 101 is not a whole number from 0 to 100 (percent)"),
        ("speed -v -1", "Failed to set speed: -1 is not a whole number from 0 to 100 (percent)"),
        ("speed -v 5.5", "Failed to set speed: 5.5 is not a whole number from 0 to 100 (percent)"),
        ("speed -v 0050", "Failed to set speed: 0050 is not a whole number from 0 to 100 (percent)"),
        ("speed -v \u0663", "Failed to set speed: \u0663 is not a whole number from 0 to 100 (percent)"),
        ("task -p a\x00b", "Failed to load task a?b: the path must lead into its folder"),
        ("task -p ../x.task", "Failed to load task ../x.task: the path must lead into its folder"),
        ("task -p a\\..\\..\\x", "Failed to load task a\\..\\..\\x: the path must lead into its folder"),
        (
            "configuration -p /etc/x",
            "Failed to load configuration /etc/x: the path must lead into its folder",
        ),
        ("variable -get 1x", "Can not find variable 1x: it is not a name"),
        (
            "variable -set g",
            "Failed to set variable g: there is no value; usage: variable -set NAME VALUE",
        ),
        ("variable -set 1 2", "Failed to set variable 1: it is not a name"),
    ],
)
def test_what_is_wrong_is_said_and_asks_for_nothing(line: str, reply: str) -> None:
    peer = shell()
    assert peer.send(line.encode() + b"\n") == wire(reply)
    assert peer.inputs == []


def test_lines_that_are_no_text_or_too_long_are_answered_and_the_next_is_read() -> None:
    peer = shell()
    assert peer.send(b"ech\xff\necho\n") == wire(
        "Command is not understood: the line is not UTF-8 at byte 3", "Hello ELITE ROBOTS."
    )
    assert peer.send(b"x" * (LINE_LIMIT + 2)) == wire(
        f"Command is not understood: the line is longer than {LINE_LIMIT} bytes"
    )
    assert peer.send(b"x" * 10_000 + b"\necho\n") == wire("Hello ELITE ROBOTS.")


def test_an_empty_line_and_a_line_without_its_end_are_not_acted_upon() -> None:
    peer = shell()
    assert peer.send(b"\n \r\n\nstop") == []
    assert peer.connection.closed() == []
    assert peer.inputs == []


def test_any_bytes_are_borne() -> None:
    words = [row.usage for rows in VERBS.values() for row in rows if row.verb not in ("quit", "reboot", "shutdown")]
    for seed in range(300):
        chance = random.Random(seed)
        peer = shell(robot_mode=chance.choice(list(RobotMode)), safety_mode=chance.choice(list(SafetyMode)))
        for _ in range(10):
            line = chance.choice(words).encode() + chance.choice([b"", b" -s", b" \xff", b"\t1", b"\x00"])
            noise = chance.randbytes(chance.randrange(20))
            data = chance.choice([line + b"\n", noise, noise + b"\n", b"\n" + line[: chance.randrange(9)]])
            messages = peer.send(data)
            messages += peer.tick(Reply(f"peer#1/{chance.randrange(12)}", chance.choice(["done", "refused: x", ""])))
            for message in messages:
                assert message.endswith(b"\r\n"), seed
                message.decode("utf-8")
