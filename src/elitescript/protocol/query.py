"""The query port, 40011: one function call a line, its value in the reply.

`req ID STATEMENT` is answered by `[ID] [success] : [VALUE]` or `[ID] [failure] : [WHY]`, without exponents in numbers:
the form that clients parse which worked against robots, and of which one reads the digits before an exponent alone. The
form `plain` is that of the vendor's article: `ID success : VALUE`, `ID failure : WHY`, values as `repr` writes them.

The statement follows the rules of secondary programs; the robot evaluates it. Replies come in the order of the
requests, but one request too many fails at once. When the robot is restarted, requests without a reply fail.

Evidence: the bracketed form of a success is *observed*, of a failure *assumed*; the words `parse failed` and `execute
failed` are *documented* (the vendor's article on the port); that the blank behind the id may be missing is *observed*
in one of its samples. Line end and limits are *assumed*, and so are the order of replies and that a request too many
fails to execute.
"""

from __future__ import annotations

import re
from collections import deque
from typing import Final

from elitescript.messages.inputs import AddLog, Input, Query
from elitescript.messages.outcomes import Outcome, QueryFailed, ShownValue
from elitescript.messages.outputs import Output
from elitescript.messages.profile import BRACKETED, PLAIN
from elitescript.messages.snapshot import RobotDescription
from elitescript.protocol.bursts import BurstLimiter
from elitescript.protocol.connection import Connection, is_restarted
from elitescript.protocol.lines import PacedLines, TextLine, one_line, shown, text_bytes

LINE_LIMIT: Final = 16384
"""Limit of a request in bytes."""
WAITING_LIMIT: Final = 256
"""Limit of requests of a client that wait for their reply."""
LINES_PER_TICK: Final = 20
"""Of one client; further ones wait for the next tick."""
ID_DIGITS: Final = 18
"""Limit of the digits of an id."""
UNREADABLE_ID: Final = "-1"
"""Id in the answer to a request without a valid one."""

NOT_PARSED: Final = QueryFailed(is_compiled=False)
NOT_EXECUTED: Final = QueryFailed(is_compiled=True)


_EXPONENT: Final = r"""(?x)
    b?'(?:[^'\\]|\\.)*' | b?"(?:[^"\\]|\\.)*"   # a text or bytes, which stay
    | (?<![\w.]) (\d+ (?:\.\d+)? e[-+]?\d+)
"""


def reply_text(ident: str, outcome: Outcome, form: str = BRACKETED) -> str:
    """Return the reply to a request with that id, in a form of `QUERY_FORMS`."""
    match outcome:
        case ShownValue(text):
            word, content = "success", text if form == PLAIN else without_exponents(text)
        case QueryFailed(is_compiled=False):
            word, content = "failure", "parse failed"
        case _:
            word, content = "failure", "execute failed"
    return f"{ident} {word} : {content}" if form == PLAIN else f"[{ident}] [{word}] : [{content}]"


def without_exponents(text: str) -> str:
    """Return a value as `repr` writes it with every float in digits alone; texts in it stay as they are.

    The digits are those of the shortest form: 6.1e-17 is 0.000000000000000061.
    """

    def digits(found: re.Match[str]) -> str:
        number: str | None = found[1]
        if number is None:
            return found[0]
        from decimal import Decimal

        plain = f"{Decimal(number):f}"
        return plain if "." in plain else plain + ".0"

    return re.sub(_EXPONENT, digits, text) if "e" in text else text


class _Request:
    """A request that waits for its reply, or for those of earlier ones.

    Attributes:
        ident: its id.
        statement: empty if it cannot be read.
        outcome: None until there is one.
    """

    __slots__ = ("ident", "outcome", "statement")

    def __init__(self, ident: str, statement: str, outcome: Outcome | None) -> None:
        self.ident = ident
        self.statement = statement
        self.outcome = outcome


class QueryConnection(Connection):
    """One client of the query port.

    Each request has its own origin, `query#2/7` for the seventh of `query#2`, so that no reply is taken for that of
    another request.
    """

    __slots__ = ("_asked", "_failures", "_lines", "_waiting")

    def __init__(self, origin: str, description: RobotDescription) -> None:
        super().__init__(origin, description)
        self._lines = PacedLines(LINE_LIMIT, LINES_PER_TICK)
        self._waiting: deque[_Request] = deque()
        """Requests that are not answered."""
        self._asked: dict[str, _Request] = {}
        """Those of them that the robot has not answered, by origin."""
        self._failures = BurstLimiter(self._warn, "request", "that failed")

    def receive(self, data: bytes, output: Output) -> list[Input]:
        self._lines.feed(data)
        return self._inputs(self._lines.take(output.tick))

    def _inputs(self, lines: list[TextLine]) -> list[Input]:
        inputs: list[Input] = []
        for line in lines:
            if not line.text.strip() and not line.problem:
                continue
            ident, statement = read_request(line)
            if len(self._waiting) >= WAITING_LIMIT:
                self._send_reply(ident, NOT_EXECUTED if statement else NOT_PARSED)
                continue
            request = _Request(ident, statement, None if statement else NOT_PARSED)
            self._waiting.append(request)
            if statement:
                origin = self.next_origin()
                self._asked[origin] = request
                inputs.append(Query(origin, statement))
        self._answer()
        return inputs

    @property
    def is_busy(self) -> bool:
        return self._lines.is_waiting

    @property
    def is_expecting(self) -> bool:
        return bool(self._waiting) or self._lines.is_waiting

    def publish(self, output: Output) -> None:
        for reply in output.replies:
            if (request := self._asked.pop(reply.origin, None)) is not None:
                request.outcome = reply.outcome
                self._note_failure(request.statement, reply.outcome, output.tick)
        self._failures.go_on(output.tick)
        if self._asked and is_restarted(output):
            for request in self._asked.values():
                request.outcome = NOT_EXECUTED
            self._asked.clear()
        self._answer()
        self._due += self._inputs(self._lines.take(output.tick))

    def next_tick(self, tick: int) -> int | None:
        return tick + 1 if self._failures.is_counting else super().next_tick(tick)

    def _answer(self) -> None:
        """Answer the requests before the first one that has no outcome."""
        while self._waiting and (outcome := self._waiting[0].outcome) is not None:
            self._send_reply(self._waiting.popleft().ident, outcome)

    def _note_failure(self, statement: str, outcome: Outcome, tick: int) -> None:
        """Have the log say why a request failed, which the reply does not."""
        if isinstance(outcome, QueryFailed) and outcome.why and self._failures.is_reported(self.origin, tick):
            self._warn(f"{self.origin}: `{shown(statement)}` failed: {outcome.why}")

    def _warn(self, text: str) -> None:
        self._due.append(AddLog(self.origin, text, is_warning=True))

    def _send_reply(self, ident: str, outcome: Outcome) -> None:
        self.send(text_bytes(one_line(reply_text(ident, outcome, self.description.query_form))) + b"\n")


def read_request(line: TextLine) -> tuple[str, str]:
    """Return the id and statement of a request: id -1 if it is invalid, an empty statement if there is none."""
    word, _, rest = line.text.strip().partition(" ")
    rest = rest.lstrip()
    digits = next((index for index, char in enumerate(rest) if char not in "0123456789"), len(rest))
    behind = rest[digits : digits + 1]
    if word != "req" or not 0 < digits <= ID_DIGITS or not (behind.isspace() or behind.isidentifier() or not behind):
        return UNREADABLE_ID, ""
    return rest[:digits], "" if line.problem else rest[digits:].strip()
