"""The query port, 40011: one function call a line, its value in the reply.

`req ID STATEMENT` is answered by `ID success : VALUE` or `ID failure : WHY`. The statement follows the rules of
secondary programs; the robot evaluates it and makes the reply with the functions here.

Evidence: the forms are *documented* (the vendor's article on the port); that the blank behind the id may be missing is
*observed* in one of its samples. Line end and limits are *assumed*, and so is that a request too many fails to execute.
"""

from __future__ import annotations

from typing import Final

from elitescript.messages.inputs import Input, Query
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot import RobotDescription
from elitescript.protocol.connection import Connection
from elitescript.protocol.lines import Line, LineSplitter, one_line

LINE_LIMIT: Final = 16384
"""Bytes of a request."""
WAITING_LIMIT: Final = 256
"""Requests of a client that wait for their answer."""
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
    """One client of the query port."""

    __slots__ = ("_splitter", "_waiting")

    def __init__(self, origin: str, description: RobotDescription) -> None:
        super().__init__(origin, description)
        self._splitter = LineSplitter(LINE_LIMIT)
        self._waiting = 0

    def receive(self, data: bytes, output: Output) -> list[Input]:
        """See `Connection.receive`."""
        inputs: list[Input] = []
        for line in self._splitter.feed(data):
            if not line.text.strip() and not line.problem:
                continue
            ident, statement = read_request(line)
            if not statement:
                self._say(not_parsed(ident))
            elif self._waiting >= WAITING_LIMIT:
                self._say(not_executed(ident))
            else:
                self._waiting += 1
                inputs.append(Query(self.origin, ident, statement))
        return inputs

    @property
    def is_expecting(self) -> bool:
        """See `Connection.is_expecting`."""
        return self._waiting > 0

    def publish(self, output: Output) -> None:
        """See `Connection.publish`."""
        for reply in output.replies:
            if reply.origin == self.origin:
                self._waiting -= 1
                self._say(reply.text)

    def _say(self, text: str) -> None:
        self.send(one_line(text).encode() + b"\n")


def read_request(line: Line) -> tuple[str, str]:
    """Id and statement of a request; -1 if the id cannot be read, no statement if there is none to evaluate."""
    word, _, rest = line.text.strip().partition(" ")
    rest = rest.lstrip()
    digits = next((index for index, char in enumerate(rest) if char not in "0123456789"), len(rest))
    behind = rest[digits : digits + 1]
    if word != "req" or not 0 < digits <= ID_DIGITS or not (behind.isspace() or behind.isidentifier() or not behind):
        return UNREADABLE_ID, ""
    return rest[:digits], "" if line.problem else rest[digits:].strip()
