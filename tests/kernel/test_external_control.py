"""Tasks whose program comes from a client."""

from __future__ import annotations

import pytest

from elitescript.devices.memory import MemoryEnvironment
from elitescript.kernel.external_control import CONNECT_S, FETCH_TICKS, REQUEST, SILENCE_TICKS
from elitescript.messages.enums import TaskState
from elitescript.messages.inputs import ChannelClosed, ChannelData, ChannelOpened, Do, LoadTask, PlayTask, Reboot
from elitescript.messages.machine import PowerOff, StopTask, WriteSignal
from elitescript.messages.outputs import CloseChannel, CreditChannel, OpenChannel, Reply, SendChannel
from tests.kernel.machine import READY, Session, program

FILES = {
    "control.task": b"external_control 192.0.2.7 50012\n",
    "default.task": b"external_control pc\r\n<task/>",
    "wrong.task": b"external_control pc fifty\n",
    "plain.task": b"<task/>",
    "plain.script": b"textmsg('plain')\n",
}
PROGRAM = b"x = 1\ntextmsg('fetched')\nsleep(10)\n# NODE_CONTROL_LOOP_ENDS\n"
PLAY = PlayTask("dashboard#1/2")


@pytest.fixture
def session() -> Session:
    session = Session(READY, MemoryEnvironment(FILES))
    session.send(LoadTask("dashboard#1/1", "control.task"))
    return session


def begin(session: Session) -> int:
    """Play, and be connected; return the channel."""
    output = session.send(PLAY)
    (request,) = output.requests
    assert output.replies == ()
    opened = session.send(ChannelOpened(request.channel, True))
    assert opened.requests == (SendChannel(request.channel, REQUEST),)
    return request.channel


def test_the_program_is_fetched_and_runs(session):
    assert session.last.snapshot.task.loaded == "control.task"
    output = session.send(PLAY)
    assert output.requests == (OpenChannel(1, "tcp", "192.0.2.7", 50012, CONNECT_S),)
    session.send(ChannelOpened(1, True))
    half = session.send(ChannelData(1, PROGRAM[:20]))
    assert half.requests == (CreditChannel(1, 20),)
    assert half.snapshot.robot.task_state is TaskState.STOPPED
    whole = session.send(ChannelData(1, PROGRAM[20:]))
    assert whole.replies == (Reply(PLAY.origin, "done"),)
    assert CloseChannel(1) in whole.requests
    assert whole.snapshot.robot.task_state is TaskState.PLAYING
    assert whole.snapshot.task.running == "control"
    assert [event.text for event in whole.events if hasattr(event, "text")] == ["fetched"]


def test_the_port_of_the_client_is_50002_unless_the_task_says_otherwise(session):
    session.send(LoadTask("dashboard#1/1", "default.task"))
    (request,) = session.send(PLAY).requests
    assert (request.address, request.port) == ("pc", 50002)


@pytest.mark.parametrize("end", ["closed", "silent"])
def test_a_program_without_the_last_comment_ends_with_the_connection_or_a_silence(session, end):
    channel = begin(session)
    session.send(ChannelData(channel, b"sleep(10)\n"))
    if end == "closed":
        output = session.send(ChannelClosed(channel))
    else:
        for _ in range(SILENCE_TICKS):
            output = session.send()
    assert output.replies == (Reply(PLAY.origin, "done"),)


@pytest.mark.parametrize(
    ("what", "why"),
    [
        (
            lambda channel: ChannelOpened(channel, False, "Connection refused"),
            "Connection refused; is the client running?",
        ),
        (lambda channel: ChannelClosed(channel), "it has sent nothing"),
        (lambda channel: ChannelData(channel, b"x = 1 +\n# NODE_CONTROL_LOOP_ENDS\n"), "does not compile"),
        (lambda channel: Do("primary#1", StopTask()), "the task was stopped"),
    ],
)
def test_a_program_that_does_not_come_refuses_the_start(session, what, why):
    channel = session.send(PLAY).requests[0].channel
    (reply,) = session.send(what(channel)).replies
    assert reply.origin == PLAY.origin
    assert reply.text.startswith("refused: ")
    assert why in reply.text
    assert session.last.snapshot.robot.task_state is TaskState.STOPPED
    assert len(session.send(PLAY).requests) == 1, "it may be tried again"


def test_a_sender_that_says_nothing_is_not_waited_for_long(session):
    channel = begin(session)
    for _ in range(FETCH_TICKS):
        output = session.send()
        if output.replies:
            break
    assert "has not come within" in output.replies[0].text
    assert output.requests == (CloseChannel(channel),)


def test_it_cannot_be_played_twice_at_once(session):
    begin(session)
    (reply,) = session.send(PlayTask("dashboard#2/1")).replies
    assert reply == Reply("dashboard#2/1", "refused: the program of the task is on its way")


@pytest.mark.parametrize(
    ("what", "why"),
    [
        (Reboot("dashboard#1/3"), "the controller was started anew before its program had come"),
        (Do("primary#1", StopTask()), "the task was stopped before its program had come"),
        (LoadTask("dashboard#1/3", "plain.task"), "another task was loaded before its program had come"),
        (program("sleep(0.01)"), "another program has been started meanwhile"),
        (Do("ctl", WriteSignal("emergency_stop", 0, True)), "emergency stop"),
        (Do("ctl", PowerOff()), ""),
    ],
)
@pytest.mark.parametrize("is_connected", [True, False])
def test_nothing_starts_late(session, is_connected, what, why):
    channel = begin(session) if is_connected else session.send(PLAY).requests[0].channel
    output = session.send(what)
    assert CloseChannel(channel) in output.requests
    (refusal,) = [reply.text for reply in output.replies if reply.origin == PLAY.origin]
    assert refusal.startswith("refused: ")
    assert why in refusal
    session.send(ChannelOpened(channel, True))
    assert session.send(ChannelData(channel, PROGRAM)).replies == ()
    session.run(1.0)
    assert not any("fetched" in str(getattr(event, "text", "")) for event in session.events)
    assert session.last.requests == ()


def test_a_line_that_makes_no_sense_is_refused(session):
    (reply,) = session.send(LoadTask("dashboard#1/1", "wrong.task")).replies
    assert "external_control HOST [PORT]" in reply.text


def test_other_tasks_are_as_before(session):
    session.send(LoadTask("dashboard#1/1", "plain.task"))
    output = session.send(PLAY)
    assert output.requests == ()
    assert output.replies == (Reply(PLAY.origin, "done"),)
