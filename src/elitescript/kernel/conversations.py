"""Statements of interpreter mode and queries: begun a few in each tick, answered when they are done."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Final, Generic, TypeVar

from elitescript.errors import ProgramError, ScriptError
from elitescript.kernel.interpreter_logs import InterpreterLogs
from elitescript.messages.enums import DiscardReason
from elitescript.messages.inputs import Interpret, InterpreterWord, Query
from elitescript.messages.outcomes import (
    InterpreterOutcome,
    Outcome,
    QueryFailed,
    SessionState,
    ShownValue,
    StatementAccepted,
    StatementDiscarded,
    StatementNumber,
)
from elitescript.protocol.interpreter import QUEUE_LIMIT, reply_text
from elitescript.runtime.alarms import text_of
from elitescript.runtime.host import ScriptHost
from elitescript.runtime.queries import QUEUE_MAX

WORK_PER_TICK: Final = 8000
STATEMENT_WORK: Final = 400
QUERY_WORK: Final = 500
"""What is begun in one tick, about 2 ms of work: characters, of which each text counts for so many at least.

Measured: a short statement takes 0.1 ms, a query 0.14 ms, a secondary program 0.24 ms, a program
0.26 ms, most of it for the compiler.
"""

Reply = Callable[[str, Outcome], None]
"""Takes the origin of a request and what became of it."""


class Conversations:
    """Begins statements and queries in their order, and answers them; a `runtime.interpreter.StatementListener`.

    Args:
        host: runs statements and queries.
        reply: sends an answer.
        logs: of interpreter mode; none if None.
    """

    __slots__ = ("_host", "_logs", "_queries", "_reply", "_statements")

    def __init__(self, host: ScriptHost, reply: Reply, logs: InterpreterLogs | None = None) -> None:
        self._host = host
        self._reply = reply
        self._logs = logs
        self._statements: _Turns[Interpret | InterpreterWord] = _Turns(self._say, STATEMENT_WORK, QUEUE_LIMIT)
        self._queries: _Turns[Query] = _Turns(self._ask, QUERY_WORK, QUEUE_MAX)
        host.interpreter.answers = self

    def interpret(self, item: Interpret) -> None:
        """Take a statement of interpreter mode; the answer may come in a later tick."""
        if not self._statements.put(item, len(item.text)):
            self._tell(item.origin, StatementDiscarded(DiscardReason.TOO_MANY, item.text))

    def word(self, item: InterpreterWord) -> None:
        """Take a word that does not wait until statements are executed; `abort` not even until they are compiled."""
        if item.word == "abort":
            self._log(item.origin, item.word)
            self._host.abort_move()
        elif not self._statements.put(item, 0):
            self._tell(item.origin, StatementDiscarded(DiscardReason.TOO_MANY, item.word))

    def query(self, item: Query) -> None:
        """Take a query; the answer comes in this tick or a later one."""
        if not self._queries.put(item, len(item.text)):
            self._fail(item, f"{QUEUE_MAX} requests wait already")

    @property
    def is_waiting(self) -> bool:
        """Whether statements or queries wait for the next tick."""
        return self._statements.is_waiting or self._queries.is_waiting

    def go_on(self) -> None:
        """Begin a tick: what waits comes before the inputs of the tick."""
        self._statements.go_on()
        self._queries.go_on()

    def _say(self, item: Interpret | InterpreterWord) -> None:
        if isinstance(item, Interpret):
            self._host.interpreter.submit(item.origin, item.text, item.problem)
        else:
            self._obey(item)

    def _obey(self, item: InterpreterWord) -> None:
        statements = self._host.interpreter
        numbers = {
            "statelastexecuted": statements.last_executed,
            "statelastinterpreted": statements.last_accepted,
            "statelastcleared": statements.last_cleared,
            "stateunexecuted": statements.unexecuted,
        }
        if item.word == "skipbuffer":
            self._log(item.origin, item.word)
            statements.skip()
        elif item.word == "state":
            self._tell(item.origin, SessionState(statements.is_running))
        elif item.word in numbers:
            self._tell(item.origin, StatementNumber(item.word, numbers[item.word]))

    def accepted(self, origin: str, number: int, text: str) -> None:
        self._tell(origin, StatementAccepted(number, text))

    def discarded(self, origin: str, reason: DiscardReason, text: str, trace: str = "") -> None:
        self._tell(origin, StatementDiscarded(reason, text, trace))

    def executed(self, number: int, step: str, text: str) -> None:
        if self._logs is not None:
            self._logs.execution.add(f"{step}: {number}: {text}")

    def _tell(self, origin: str, outcome: InterpreterOutcome) -> None:
        if self._logs is not None:
            self._log(origin, reply_text(outcome))
        self._reply(origin, outcome)

    def _log(self, origin: str, text: str) -> None:
        if self._logs is not None:
            self._logs.received.add(f"{origin.partition('/')[0]}  {text}")

    def _ask(self, item: Query) -> None:
        def answer(value: str | None, why: str) -> None:
            if value is None:
                self._fail(item, why)
            else:
                self._reply(item.origin, ShownValue(value))

        try:
            self._host.query(item.text, answer)
        except (ProgramError, ScriptError) as error:
            self._fail(item, text_of(error), is_compiled=not isinstance(error, ProgramError))

    def _fail(self, item: Query, why: str, *, is_compiled: bool = True) -> None:
        self._reply(item.origin, QueryFailed(is_compiled=is_compiled, why=why))


Item = TypeVar("Item")


class _Turns(Generic[Item]):
    """Items in their order, as many in a tick as its share of work allows; the others wait.

    Args:
        carry_out: does what an item asks for.
        least_work: for which each item counts at least.
        limit: items that may wait.
    """

    __slots__ = ("_carry_out", "_least_work", "_left", "_limit", "_waiting")

    def __init__(self, carry_out: Callable[[Item], None], least_work: int, limit: int) -> None:
        self._carry_out = carry_out
        self._least_work = least_work
        self._limit = limit
        self._left = WORK_PER_TICK
        self._waiting: deque[tuple[Item, int]] = deque()

    @property
    def is_waiting(self) -> bool:
        """Whether items wait."""
        return bool(self._waiting)

    def put(self, item: Item, size: int) -> bool:
        """Take an item of so many characters; return whether there is room for it."""
        work = max(size, self._least_work)
        if not self._waiting and self._left > 0:
            self._do(item, work)
        elif len(self._waiting) < self._limit:
            self._waiting.append((item, work))
        else:
            return False
        return True

    def go_on(self) -> None:
        """Begin a tick, with a new share of work."""
        self._left = WORK_PER_TICK
        while self._waiting and self._left > 0:
            self._do(*self._waiting.popleft())

    def _do(self, item: Item, work: int) -> None:
        self._left -= work
        self._carry_out(item)
