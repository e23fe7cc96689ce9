"""Runs cases through ports: texts for the script port, conversations with interpreter mode and the query port."""

from __future__ import annotations

from typing import Final

from elitescript.kernel import Kernel, RobotOptions
from elitescript.language.text.source import SourceFile
from elitescript.language.text.units import DiscardedText, UnitSplitter
from elitescript.lint.engine import check_source
from elitescript.messages.enums import TaskState
from elitescript.messages.events import Alarm
from elitescript.messages.inputs import Input, RunUnit
from elitescript.messages.outputs import Output
from elitescript.messages.profile import DEFAULT_FIRMWARE, profile
from elitescript.messages.timing import ticks_for
from elitescript.protocol.connection import Connection
from elitescript.protocol.interpreter import InterpreterConnection
from elitescript.protocol.query import QueryConnection
from tests.specification.events import note_event
from tests.specification.pages import Case, CaseOutcome, Expectation

CLIENT: Final = "primary#1"
WATCHED_S: Final = 5.0
"""Virtual time of a case after the last text."""

HOST: Final = """def host():
  global g
  g = 1
  interpreter_mode(clearQueueOnEnter=True, clearOnEnd=True)
  textmsg("left ", g)
end
"""
"""The program of conversations with interpreter mode."""
ENDLESS: Final = """def endless():
  while True:
    sync()
  end
end
"""
"""The program of conversations with the query port."""


def run_session(case: Case, expectation: Expectation) -> CaseOutcome:
    """Run a case; return its outcome."""
    session = _Session(expectation.words.get("firmware", DEFAULT_FIRMWARE))
    text = case.texts[0]
    if "port" in text.words:
        session.stream(text.sent)
    elif "query" in text.words:
        session.stream(ENDLESS)
        session.converse(text.sent, QueryConnection("query#1", session.kernel.description))
    else:
        if "idle" not in text.words:
            session.stream(HOST)
        session.converse(text.sent, InterpreterConnection("interpreter#1", session.kernel.description))
    session.wait(float(expectation.words.get("until", WATCHED_S)))
    return session.outcome


class _Session:
    """A kernel and the outcome of its case."""

    def __init__(self, firmware: str) -> None:
        self.kernel = Kernel(RobotOptions(firmware=firmware, power_on=True))
        self.outcome = CaseOutcome()
        self._profile = profile(firmware)
        self._last = self._tick()

    def stream(self, text: str) -> None:
        """Send a text to the script port and close the connection."""
        for problem in check_source(SourceFile("<page>", text), self._profile, strict=False):
            word = "finding" if problem.is_error else "warn"
            self.outcome.findings.append(f"{word}: {problem.code} line {problem.line}")
        splitter = UnitSplitter()
        for part in [*splitter.receive(text.encode()), *splitter.close()]:
            if isinstance(part, DiscardedText):
                self.outcome.lists["error"] += [f"{problem.code} line {problem.line}" for problem in part.problems]
            else:
                self._tick(RunUnit(CLIENT, part.kind, part.text, part.first_line))

    def converse(self, text: str, connection: Connection) -> None:
        """Send lines with `>` and expect those with `<` next; `...` in them stands for any text."""
        received = b""
        for line in text.splitlines():
            mark, _, words = line.partition(" ")
            if mark == ">":
                self._tick(*connection.receive(words.encode() + b"\n", self._last))
            ticks = ticks_for(WATCHED_S)
            while mark == "<" and b"\n" not in received and ticks:
                received += b"".join(connection.take())
                if b"\n" not in received:
                    self._tick()
                    ticks -= 1
                    connection.publish(self._last)
            if mark == ">":
                connection.publish(self._last)
                received += b"".join(connection.take())
            else:
                reply, _, received = received.partition(b"\n")
                if not _is_like(reply.decode(), words):
                    self.outcome.wrong_replies.append(f"received {reply.decode()!r}, expected {words!r}")
        if received:
            self.outcome.wrong_replies.append(f"received {received.decode()!r} besides")

    def wait(self, duration_s: float) -> None:
        """Run until the program ends or that time has passed."""
        for _ in range(ticks_for(duration_s)):
            if self._last.snapshot.robot.task_state is TaskState.STOPPED:
                break
            self._tick()
        is_running = self._last.snapshot.robot.task_state is not TaskState.STOPPED
        self.outcome.state = "running" if is_running else ""

    def _tick(self, *inputs: Input) -> Output:
        self._last = output = self.kernel.tick_and_snapshot(inputs)
        for event in output.events:
            if isinstance(event, Alarm) and event.thread == CLIENT:
                key = "error" if event.code.startswith("E") else "refused"
                place = f"{event.code} line {event.line}" if key == "error" else event.class_name
                self.outcome.lists[key].append(place)
            else:
                note_event(self.outcome, event)
        return output


def _is_like(had: str, wanted: str) -> bool:
    before, dots, after = wanted.partition("...")
    if not dots:
        return had == wanted
    return had.startswith(before) and had.endswith(after) and len(had) >= len(before) + len(after)
