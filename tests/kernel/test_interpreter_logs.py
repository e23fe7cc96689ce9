"""The two logs of interpreter mode."""

from __future__ import annotations

from io import BytesIO

import pytest

from elitescript.devices.memory import MemoryEnvironment, MemoryFiles
from elitescript.kernel.interpreter_logs import (
    DELAY_TICKS,
    EXECUTION_NAME,
    OLD_SUFFIX,
    RECEIVED_NAME,
    SIZE_MAX,
    InterpreterLogs,
)
from elitescript.messages.events import Warned
from elitescript.messages.inputs import Interpret, InterpreterWord
from elitescript.messages.machine import StopTask
from tests.kernel.machine import READY, Session


class Talk(Session):
    """A session in interpreter mode with a task folder."""

    def __init__(self, files: dict[str, bytes] | None = None) -> None:
        self.world = MemoryEnvironment(files or {})
        super().__init__(READY, self.world)
        self.start("interpreter_mode()")

    def say(self, *lines: str) -> None:
        self.send(*(Interpret(f"interpreter#1/{number}", line) for number, line in enumerate(lines)))

    def settle(self) -> None:
        for _ in range(DELAY_TICKS + 1):
            self.tick()

    def lines(self, name: str) -> list[str]:
        return self.world.files.contents.get(name, b"").decode().splitlines()


def test_one_says_what_was_received_and_the_other_what_was_executed() -> None:
    talk = Talk()
    talk.say("g = 2", "1 +", "sleep(1)", "g = 3")
    talk.send(InterpreterWord("interpreter#2/1", "skipbuffer"), InterpreterWord("interpreter#2/2", "state"))
    talk.say("1 / 0")
    talk.run(1.2)
    received = talk.lines(RECEIVED_NAME)
    assert received[0] == "     0.004 s  interpreter#1  ack: 1: g = 2"
    assert received[1].startswith("     0.004 s  interpreter#1  discard: Compile error:line 1, ")
    assert received[2:] == [
        "     0.004 s  interpreter#1  ack: 2: sleep(1)",
        "     0.004 s  interpreter#1  ack: 3: g = 3",
        "     0.008 s  interpreter#2  skipbuffer",
        "     0.008 s  interpreter#2  state: 0: running: state",
        "     0.012 s  interpreter#1  ack: 4: 1 / 0",
    ]
    assert talk.lines(EXECUTION_NAME) == [
        "     0.004 s  begun: 1: g = 2",
        "     0.004 s  done: 1: g = 2",
        "     0.004 s  begun: 2: sleep(1)",
        "     0.008 s  skipped: 3: g = 3",
        "     1.004 s  done: 2: sleep(1)",
        "     1.004 s  begun: 4: 1 / 0",
        "     1.004 s  failed: 4: ZeroDivisionError: division by zero",
    ]


def test_a_statement_that_is_stopped_is_in_the_log() -> None:
    talk = Talk()
    talk.say("sleep(9)")
    talk.do(StopTask())
    talk.settle()
    assert talk.lines(EXECUTION_NAME)[-1].endswith(" s  stopped: 1: sleep(9)")


def test_they_go_on_where_the_last_session_ended() -> None:
    talk = Talk({RECEIVED_NAME: b"before\n"})
    talk.say("g = 2")
    talk.settle()
    assert talk.lines(RECEIVED_NAME) == ["before", "     0.004 s  interpreter#1  ack: 1: g = 2"]


def test_a_long_one_becomes_the_old_one() -> None:
    talk = Talk({RECEIVED_NAME: b"x" * SIZE_MAX, RECEIVED_NAME + OLD_SUFFIX: b"older"})
    talk.say("g = 2")
    talk.settle()
    assert talk.world.files.contents[RECEIVED_NAME + OLD_SUFFIX] == b"x" * SIZE_MAX
    assert talk.lines(RECEIVED_NAME) == ["     0.004 s  interpreter#1  ack: 1: g = 2"]


def test_without_statements_there_are_none() -> None:
    talk = Talk()
    talk.settle()
    assert talk.world.files.contents == {}


def test_without_a_task_folder_there_are_none() -> None:
    session = Session(READY)
    session.start("interpreter_mode()")
    session.send(Interpret("a/1", "g = 2"))
    session.run(0.2)
    assert session.of(Warned) == []


def test_one_that_cannot_be_written_is_told_once(monkeypatch: pytest.MonkeyPatch) -> None:
    talk = Talk()

    def full(self: MemoryFiles, name: str, *_: object) -> BytesIO:
        raise OSError(28, "No space left on device", name)

    monkeypatch.setattr(MemoryFiles, "open", full)
    for _ in range(3):
        talk.say("g = 2")
        talk.settle()
    assert [event.text for event in talk.of(Warned)] == [
        "a log of interpreter mode cannot be written: No space left on device"
    ]
    assert talk.replies[-1] == "ack: 3: g = 2"


def test_two_that_fail_for_different_reasons_are_told_once_each() -> None:
    class Failing(MemoryFiles):
        def kind(self, name: str) -> str:
            raise OSError(28 if "received" in name else 13, f"cannot write {name}")

    logs, told = InterpreterLogs(Failing({})), []
    for tick in range(20 * DELAY_TICKS):
        logs.begin_tick(tick)
        logs.received.add("a")
        logs.execution.add("b")
        told.append(logs.end_tick())
    assert len([text for text in told if text]) == 2
