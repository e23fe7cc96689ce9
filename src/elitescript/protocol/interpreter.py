"""Interpreter mode, port 30020: a client sends statements line by line, each is acknowledged or discarded.

A line that is the header of a function and nothing else begins a *block*: it and the lines up to an `end` at the start
of a line are one statement, with one reply. One-line functions are *documented*; a sample of the vendor sends several
lines, and that they are one statement is *assumed*.

The robot numbers and queues the statements; a `Reply` to the origin of a statement or a word has its outcome, from
which the text is made here. When the robot is restarted, lines without a reply are answered as if no program had run,
and accepted statements are lost.

Evidence: words, reply forms and reasons are *documented* (manual 2.14, interpreter mode; the vendor's article on the
port). Line ends, `state: 0` for an unknown number, the limit of a line, and that every client gets only the replies to
its own statements, are *assumed*.
"""

from __future__ import annotations

import re
from typing import Final

from elitescript.messages.enums import DiscardReason
from elitescript.messages.inputs import Input, Interpret, InterpreterWord
from elitescript.messages.outcomes import (
    InterpreterOutcome,
    SessionState,
    StatementAccepted,
    StatementDiscarded,
    StatementNumber,
)
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot import RobotDescription
from elitescript.protocol.connection import Connection, is_restarted
from elitescript.protocol.lines import PacedLines, TextLine, one_line, shown, text_bytes
from elitescript.records import NamedTuple

LINE_LIMIT: Final = 65536
"""Bytes of a line; a function is written on one."""
BLOCK_HEADER: Final = re.compile(r"def\b.*:\s*(#.*)?")
BLOCK_END: Final = re.compile(r"end\s*;?\s*(#.*)?")
"""Whole lines that begin and close a block."""
LINES_PER_TICK: Final = 20
"""Of one client; further ones wait for the next tick (*assumed*)."""
QUEUE_LIMIT: Final = 8500
"""Limit of statements that wait to be executed."""


class Word(NamedTuple):
    """A line that is handled at once, before queued statements."""

    name: str
    reply: str
    """Form of the reply; empty if there is none."""
    summary: str
    evidence: str


class Reason(NamedTuple):
    """One row: why a statement is discarded."""

    reason: DiscardReason
    text: str
    """In replies."""
    summary: str
    evidence: str


_WORDS: Final = (
    Word("skipbuffer", "", "Throw away every statement that has not begun, at once.", "documented"),
    Word("abort", "", "End the `movej` or `movel` that is going on.", "documented"),
    Word(
        "statelastexecuted",
        "state: ID: statelastexecuted",
        "Number of the statement that is being executed or was last.",
        "documented",
    ),
    Word(
        "statelastinterpreted",
        "state: ID: statelastinterpreted",
        "Number of the last statement that was accepted.",
        "documented",
    ),
    Word(
        "statelastcleared",
        "state: ID: statelastcleared",
        "Number of the last statement that was cleared: thrown away before it began, or its definitions forgotten.",
        "documented; the word in the reply and what counts as cleared assumed",
    ),
    Word(
        "stateunexecuted",
        "state: COUNT: stateunexecuted",
        "How many accepted statements have not begun; those that were skipped do not count.",
        "documented; without the skipped ones assumed, the texts disagree",
    ),
    Word("state", "state: 0: running: state", "Whether a session is `running` or `stopped`.", "documented"),
)
WORDS: Final[dict[str, Word]] = {word.name: word for word in _WORDS}
"""Every word that is handled at once."""

REASONS: Final = (
    Reason(DiscardReason.COMPILE_ERROR, "Compile error", "It does not compile; the reason follows.", "documented"),
    Reason(DiscardReason.INVALID_STATE, "Task is in an invalid state", "No program runs.", "documented"),
    Reason(
        DiscardReason.TOO_MANY,
        "Too many interpreted messages",
        f"{QUEUE_LIMIT} statements wait already.",
        "documented",
    ),
    Reason(
        DiscardReason.CLEARED_BEFORE,
        "Cleaned up before interpretation",
        "It waited when a session began that clears the queue.",
        "documented",
    ),
    Reason(DiscardReason.CLEARED_AT_END, "Cleaned up after end", "It waited when the session ended.", "documented"),
    Reason(DiscardReason.CLEARED, "Cleaned up", "It waited when `clear_interpreter()` was executed.", "documented"),
)
"""Why a statement is discarded."""
_REASON_TEXTS: Final = {row.reason: row.text for row in REASONS}


def reply_text(outcome: InterpreterOutcome) -> str:
    """Return the reply to a statement or a word."""
    match outcome:
        case StatementAccepted(number, text):
            return f"ack: {number}: {text}"
        case StatementDiscarded(DiscardReason.COMPILE_ERROR as reason, text, trace):
            # There is no blank before the trace, but one behind it.
            return f"discard: {_REASON_TEXTS[reason]}:{trace} : {text}"
        case StatementDiscarded(reason, text):
            return f"discard: {_REASON_TEXTS[reason]}: {text}"
        case StatementNumber(word, number):
            return f"state: {number}: {word}"
        case SessionState(is_running):
            return f"state: 0: {'running' if is_running else 'stopped'}: state"


class InterpreterConnection(Connection):
    """One client of interpreter mode.

    Each line has its own origin, `interpreter#2/7` for the seventh of `interpreter#2`, so that it is known which lines
    have no reply yet.
    """

    __slots__ = ("_block", "_block_size", "_given_up", "_lines", "_problem", "_start", "_unanswered")

    def __init__(self, origin: str, description: RobotDescription) -> None:
        super().__init__(origin, description)
        self._lines = PacedLines(LINE_LIMIT, LINES_PER_TICK)
        self._block: list[str] = []
        """Lines of the block that is open."""
        self._block_size = 0
        """In bytes; lines beyond `LINE_LIMIT` are not kept."""
        self._problem = ""
        """Why the block cannot be a statement."""
        self._start = f"{origin}/"
        self._unanswered: dict[str, InterpreterOutcome] = {}
        """For each line by origin, the outcome if the robot ends before its reply."""
        self._given_up: set[str] = set()
        """Lines that got that reply; later replies to them are not sent."""

    def receive(self, data: bytes, output: Output) -> list[Input]:
        self._lines.feed(data)
        return self._inputs(self._lines.take(output.tick))

    def _inputs(self, lines: list[TextLine]) -> list[Input]:
        inputs: list[Input] = []
        for line in lines:
            if self._block or (not line.problem and BLOCK_HEADER.fullmatch(line.text)):
                inputs += self._in_block(line)
                continue
            text = line.text.strip()
            if not text and not line.problem:
                continue
            if line.problem or text not in WORDS:
                inputs.append(self._statement(text, line.problem))
            else:
                origin = self.next_origin()
                inputs.append(InterpreterWord(origin, text))
                if WORDS[text].reply:
                    self._unanswered[origin] = SessionState(False) if text == "state" else StatementNumber(text, 0)
        return inputs

    def _in_block(self, line: TextLine) -> list[Input]:
        """Add a line to the block; return the input of the block once it is complete."""
        self._block_size += len(line.text.encode()) + 1
        if line.problem:
            self._problem = self._problem or f"line {len(self._block) + 1}, column 1, {line.problem}"
        elif self._block_size > LINE_LIMIT:
            number = len(self._block) + 1
            self._problem = self._problem or f"line {number}, column 1, the function is longer than {LINE_LIMIT} bytes"
        if not self._problem:
            self._block.append(line.text.rstrip("\r"))
        return [self._close_block()] if BLOCK_END.fullmatch(line.text) else []

    def _close_block(self) -> Input:
        text, problem = "\n".join(self._block), self._problem
        self._block.clear()
        self._block_size, self._problem = 0, ""
        return self._statement(text, problem)

    def _statement(self, text: str, problem: str) -> Input:
        origin = self.next_origin()
        if problem:
            text = shown(one_line(text))
            self._unanswered[origin] = StatementDiscarded(DiscardReason.COMPILE_ERROR, text, problem)
            return Interpret(origin, text, problem)
        self._unanswered[origin] = StatementDiscarded(DiscardReason.INVALID_STATE, text)
        return Interpret(origin, text)

    @property
    def is_busy(self) -> bool:
        return self._lines.is_waiting

    @property
    def is_expecting(self) -> bool:
        """See `Connection.is_expecting`: an accepted statement may be discarded later."""
        return True

    def publish(self, output: Output) -> None:
        for reply in output.replies:
            if not reply.origin.startswith(self._start):
                continue
            if reply.origin in self._given_up:
                self._given_up.discard(reply.origin)
                continue
            if isinstance(reply.outcome, InterpreterOutcome):
                self._unanswered.pop(reply.origin, None)
                self._send_reply(reply.outcome)
        if self._unanswered and is_restarted(output):
            for outcome in self._unanswered.values():
                self._send_reply(outcome)
            self._given_up = set(self._unanswered)
            self._unanswered.clear()
        self._due += self._inputs(self._lines.take(output.tick))

    def closed(self) -> list[Input]:
        """See `Connection.closed`: received lines are still handled; a function without its end is discarded."""
        inputs = self.due() + self._inputs(self._lines.rest())
        if self._block:
            self._problem = self._problem or "line 1, column 1, the function has no `end` at the start of a line"
            inputs.append(self._close_block())
        return inputs

    def _send_reply(self, outcome: InterpreterOutcome) -> None:
        self.send(text_bytes(one_line(reply_text(outcome))) + b"\n")
