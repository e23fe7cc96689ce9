"""The query port, 40011: one function call a line, its value in the reply.

`req ID STATEMENT` is answered by `ID success : VALUE` or `ID failure : WHY`. The statement follows the rules of
secondary programs; the robot evaluates it and makes the reply with the functions here.

A robot that is started anew in between answers nothing that it was asked before: those requests fail.

Evidence: the forms are *documented* (the vendor's article on the port); that the blank behind the id may be missing is
*observed* in one of its samples. Line end and limits are *assumed*, and so is that a request too many fails to execute.
"""

from __future__ import annotations

from typing import Final

from elitescript.messages.events import Alarm
from elitescript.messages.inputs import Input, Query
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot import RobotDescription
from elitescript.protocol.connection import Connection
from elitescript.protocol.lines import PacedLines, TextLine, one_line

LINE_LIMIT: Final = 16384
"""Bytes of a request."""
WAITING_LIMIT: Final = 256
"""Requests of a client that wait for their answer."""
LINES_PER_TICK: Final = 20
"""Of one client; the rest waits for the next tick."""
RESTARTED: Final = "R132"
"""Code of the alarm that tells of a new robot in the place of the old one."""
ID_DIGITS: Final = 18
"""Digits of an id."""
UNREADABLE_ID: Final = "-1"
"""Id in the answer to a request whose own cannot be read."""


def succeeded(ident: str, value: str) -> str:
    """Reply with the value of a statement, as `repr` writes it."""
    return f"{ident} success : {value}"


def not_parsed(ident: str) -> str:
    """Reply to a statement that does not compile."""
    return f"{ident} failure : parse failed"


def not_executed(ident: str) -> str:
    """Reply to a statement that raised an exception, is not allowed or took too long."""
    return f"{ident} failure : execute failed"


class QueryConnection(Connection):
    """One client of the query port.

    Each request goes to the robot under an origin of its own, `query#2/7` for the seventh of `query#2`, so that no
    answer is taken for that of another request.
    """

    __slots__ = ("_count", "_due", "_lines", "_waiting")

    def __init__(self, origin: str, description: RobotDescription) -> None:
        super().__init__(origin, description)
        self._lines = PacedLines(LINE_LIMIT, LINES_PER_TICK)
        self._due: list[Input] = []
        self._count = 0
        self._waiting: dict[str, str] = {}

    def receive(self, data: bytes, output: Output) -> list[Input]:
        """See `Connection.receive`."""
        self._lines.feed(data)
        return self._inputs(self._lines.take(output.tick))

    def _inputs(self, lines: list[TextLine]) -> list[Input]:
        inputs: list[Input] = []
        for line in lines:
            if not line.text.strip() and not line.problem:
                continue
            ident, statement = read_request(line)
            if not statement:
                self._say(not_parsed(ident))
            elif len(self._waiting) >= WAITING_LIMIT:
                self._say(not_executed(ident))
            else:
                self._count += 1
                origin = f"{self.origin}/{self._count}"
                self._waiting[origin] = ident
                inputs.append(Query(origin, ident, statement))
        return inputs

    @property
    def is_busy(self) -> bool:
        """See `Connection.is_busy`."""
        return self._lines.is_waiting

    @property
    def is_expecting(self) -> bool:
        """See `Connection.is_expecting`."""
        return bool(self._waiting) or self._lines.is_waiting

    def publish(self, output: Output) -> None:
        """See `Connection.publish`."""
        for reply in output.replies:
            if self._waiting.pop(reply.origin, None) is not None:
                self._say(reply.text)
        if self._waiting and any(isinstance(event, Alarm) and event.code == RESTARTED for event in output.events):
            for ident in self._waiting.values():
                self._say(not_executed(ident))
            self._waiting.clear()
        self._due += self._inputs(self._lines.take(output.tick))

    def due(self) -> list[Input]:
        """See `Connection.due`."""
        due, self._due = self._due, []
        return due

    def _say(self, text: str) -> None:
        self.send(one_line(text).encode() + b"\n")


def read_request(line: TextLine) -> tuple[str, str]:
    """Return the Id and statement of a request; -1 if the Id cannot be read, no statement if there is none."""
    word, _, rest = line.text.strip().partition(" ")
    rest = rest.lstrip()
    digits = next((index for index, char in enumerate(rest) if char not in "0123456789"), len(rest))
    behind = rest[digits : digits + 1]
    if word != "req" or not 0 < digits <= ID_DIGITS or not (behind.isspace() or behind.isidentifier() or not behind):
        return UNREADABLE_ID, ""
    return rest[:digits], "" if line.problem else rest[digits:].strip()
