"""Interpreter mode, port 30020: a client sends statements line by line, each is acknowledged or discarded.

A line that is the header of a function and nothing else begins a *block*: it and the lines up to an `end` at the start
of a line are one statement, with one reply. One-line functions are *documented*; a sample of the vendor sends several
lines, and that they are one statement is *assumed*.

The texts of all replies are here; the robot, which numbers and queues the statements, makes them with these functions
and sends them as `Reply` to the origin of the statement or the word.

A robot that is started anew in between knows nothing of what it was sent before: lines that had no reply by then are
answered as if no program had run, and statements that were accepted are gone.

Evidence: words, reply forms and reasons are *documented* (manual 2.14, interpreter mode; the vendor's article on the
port). Line ends, `state: 0` for an unknown number, the limit of a line, and that every client gets the replies to its
own statements and no others, are *assumed*.
"""

from __future__ import annotations

import re
from typing import Final, NamedTuple

from elitescript.messages.events import Alarm
from elitescript.messages.inputs import Input, Interpret, InterpreterWord
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot import RobotDescription
from elitescript.protocol.connection import Connection
from elitescript.protocol.lines import PacedLines, TextLine, one_line, shown

LINE_LIMIT: Final = 65536
"""Bytes of a line; a function is written on one."""
BLOCK_HEADER: Final = re.compile(r"def\b.*:\s*(#.*)?")
BLOCK_END: Final = re.compile(r"end\s*;?\s*(#.*)?")
"""Whole lines that begin and close a block."""
LINES_PER_TICK: Final = 20
"""Of one client; the rest waits for the next tick (*assumed*)."""
QUEUE_LIMIT: Final = 8500
"""Statements that wait to be executed."""
RESTARTED: Final = "R132"
"""Code of the alarm that tells of a new robot in the place of the old one."""


class Word(NamedTuple):
    """A line that does not wait its turn."""

    name: str
    reply: str
    """Form of the reply; empty if there is none."""
    summary: str
    evidence: str


class Reason(NamedTuple):
    """Why a statement is discarded."""

    text: str
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
"""Every word that does not wait its turn."""

COMPILE_ERROR: Final = "Compile error"
INVALID_STATE: Final = "Task is in an invalid state"
TOO_MANY: Final = "Too many interpreted messages"
CLEARED_BEFORE: Final = "Cleaned up before interpretation"
CLEARED_AT_END: Final = "Cleaned up after end"
CLEARED: Final = "Cleaned up"

REASONS: Final = (
    Reason(COMPILE_ERROR, "It does not compile; the reason follows.", "documented"),
    Reason(INVALID_STATE, "No program runs.", "documented"),
    Reason(TOO_MANY, f"{QUEUE_LIMIT} statements wait already.", "documented"),
    Reason(CLEARED_BEFORE, "It waited when a session began that clears the queue.", "documented"),
    Reason(CLEARED_AT_END, "It waited when the session ended.", "documented"),
    Reason(CLEARED, "It waited when `clear_interpreter()` was executed.", "documented"),
)


def acknowledged(number: int, statement: str) -> str:
    """Reply to a statement that was accepted."""
    return f"ack: {number}: {statement}"


def discarded(reason: str, statement: str) -> str:
    """Reply to a statement that will not be executed, for one of `REASONS`."""
    return f"discard: {reason}: {statement}"


def not_compiled(trace: str, statement: str) -> str:
    """Reply to a statement that does not compile; no blank before the trace, one behind it."""
    return f"discard: {COMPILE_ERROR}:{trace} : {statement}"


def state_of(number: int, word: str) -> str:
    """Reply to a word that asks for a number."""
    return f"state: {number}: {word}"


def session_state(is_running: bool) -> str:
    """Reply to `state`."""
    return f"state: 0: {'running' if is_running else 'stopped'}: state"


class InterpreterConnection(Connection):
    """One client of interpreter mode.

    Each line goes to the robot under an origin of its own, `interpreter#2/7` for the seventh of `interpreter#2`, so
    that it is known which lines have no reply yet.
    """

    __slots__ = ("_block", "_block_size", "_count", "_due", "_given_up", "_lines", "_problem", "_start", "_unanswered")

    def __init__(self, origin: str, description: RobotDescription) -> None:
        super().__init__(origin, description)
        self._lines = PacedLines(LINE_LIMIT, LINES_PER_TICK)
        self._due: list[Input] = []
        self._block: list[str] = []
        """Lines of the block that is open."""
        self._block_size = 0
        """In bytes; lines beyond `LINE_LIMIT` are not kept."""
        self._problem = ""
        """Why the block cannot be a statement."""
        self._count = 0
        self._start = f"{origin}/"
        self._unanswered: dict[str, str] = {}
        """Lines by origin, and the reply if nobody is left who could give one."""
        self._given_up: set[str] = set()
        """Lines that have got that reply, for the case that the new robot gives another one."""

    def receive(self, data: bytes, output: Output) -> list[Input]:
        """See `Connection.receive`."""
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
                origin = self._origin()
                inputs.append(InterpreterWord(origin, text))
                if WORDS[text].reply:
                    self._unanswered[origin] = session_state(False) if text == "state" else state_of(0, text)
        return inputs

    def _in_block(self, line: TextLine) -> list[Input]:
        """Return one more line of a block; what it asks for once it is whole."""
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
        origin = self._origin()
        if problem:
            text = shown(one_line(text))
            self._unanswered[origin] = not_compiled(problem, text)
            return Interpret(origin, text, problem)
        self._unanswered[origin] = discarded(INVALID_STATE, text)
        return Interpret(origin, text)

    def _origin(self) -> str:
        self._count += 1
        return f"{self._start}{self._count}"

    @property
    def is_busy(self) -> bool:
        """See `Connection.is_busy`."""
        return self._lines.is_waiting

    @property
    def is_expecting(self) -> bool:
        """See `Connection.is_expecting`: also a statement that was accepted may be discarded later."""
        return True

    def publish(self, output: Output) -> None:
        """See `Connection.publish`."""
        for reply in output.replies:
            if not reply.origin.startswith(self._start):
                continue
            if reply.origin in self._given_up:
                self._given_up.discard(reply.origin)
                continue
            self._unanswered.pop(reply.origin, None)
            self._say(reply.text)
        if self._unanswered and any(isinstance(event, Alarm) and event.code == RESTARTED for event in output.events):
            for text in self._unanswered.values():
                self._say(text)
            self._given_up = set(self._unanswered)
            self._unanswered.clear()
        self._due += self._inputs(self._lines.take(output.tick))

    def due(self) -> list[Input]:
        """See `Connection.due`."""
        due, self._due = self._due, []
        return due

    def closed(self) -> list[Input]:
        """See `Connection.closed`: what the client has sent still counts; a function without its end is discarded."""
        inputs = self.due() + self._inputs(self._lines.rest())
        if self._block:
            self._problem = self._problem or "line 1, column 1, the function has no `end` at the start of a line"
            inputs.append(self._close_block())
        return inputs

    def _say(self, text: str) -> None:
        self.send(one_line(text).encode() + b"\n")
