"""Evaluates expressions for clients, by the rules of secondary programs (*documented*)."""

from __future__ import annotations

from collections.abc import Callable
from types import CodeType
from typing import Final

from elitescript.language.compiler import compile_expression
from elitescript.language.text.source import SourceFile
from elitescript.messages.timing import TICKS_PER_S, seconds
from elitescript.records import NamedTuple
from elitescript.runtime.alarms import summary_of
from elitescript.runtime.environment import without_addresses
from elitescript.runtime.program import Program
from elitescript.runtime.secondary import Secondaries
from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.runtime.threads.strand import Strand, is_stop
from elitescript.said import said

LIMIT_TICKS: Final = TICKS_PER_S // 10
"""Virtual time that a query may take (*assumed*: only quick functions are allowed)."""

QUEUE_MAX: Final = 1000
"""Queries that may wait."""

VALUE_MAX: Final = 65536
"""Characters of a value."""


QueryAnswer = Callable[[str | None, str], None]
"""Takes the value as `repr` writes it, None if there is none, and why there is none."""


class WaitingQuery(NamedTuple):
    """A waiting expression."""

    code: CodeType
    answer: QueryAnswer


class Queries(Secondaries[WaitingQuery]):
    """The queries of a host, one after the other.

    Args:
        scheduler: runs them.
        namespace: gives the running program and None, or twice an empty one that is made for a query alone.
        spawn: starts a strand of a program.
    """

    __slots__ = ("_namespace", "_spawn")

    def __init__(
        self,
        scheduler: Scheduler,
        namespace: Callable[[], tuple[Program, Program | None]],
        spawn: Callable[..., Strand],
    ) -> None:
        super().__init__(
            scheduler, self._begin_query, lambda text, strand: None, limit_ticks=LIMIT_TICKS, queue_max=QUEUE_MAX
        )
        self._namespace = namespace
        self._spawn = spawn

    def ask(self, text: str, answer: QueryAnswer) -> None:
        """See `ScriptHost.query`."""
        self.put(WaitingQuery(compile_expression(SourceFile("<query>", text)), answer))

    def _begin_query(self, query: WaitingQuery) -> tuple[Strand, Program | None]:
        program, own = self._namespace()
        return self._spawn(program, "query", _body_of(query, program), is_secondary=True), own


def _body_of(query: WaitingQuery, program: Program) -> Callable[[], None]:
    """Return the body of a strand that evaluates a query and answers exactly once, also if it is stopped."""

    def body() -> None:
        value: str | None = None
        why = said(
            "it was stopped: it ended itself, or took more than {seconds:g} s of robot time",
            seconds=seconds(LIMIT_TICKS),
        )
        try:
            shown = without_addresses(repr(program.value_of(query.code)))
            if len(shown) <= VALUE_MAX:
                value, why = shown, ""
            else:
                why = said(
                    "the value has {count} characters, {value_max} are allowed", count=len(shown), value_max=VALUE_MAX
                )
        except BaseException as error:
            if is_stop(error) or isinstance(error, KeyboardInterrupt):
                raise
            why = summary_of(error)
        finally:
            query.answer(value, why)

    return body
