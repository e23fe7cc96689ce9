"""Queries: expressions that clients ask for the value of, by the rules of secondary programs (*documented*)."""

from __future__ import annotations

from collections.abc import Callable
from types import CodeType
from typing import Final, NamedTuple

from elitescript.language.compiler import compile_expression
from elitescript.language.source import SourceFile
from elitescript.messages.timing import TICKS_PER_S
from elitescript.runtime.alarms import without_addresses
from elitescript.runtime.program import Program
from elitescript.runtime.strand import is_stop

LIMIT_TICKS: Final = TICKS_PER_S // 10
"""Virtual time that a query may take (*assumed*: only quick functions are allowed)."""

QUEUE_MAX: Final = 1000
"""Queries that may wait."""

VALUE_MAX: Final = 65536
"""Characters of a value."""


class Query(NamedTuple):
    """An expression that waits for its turn."""

    code: CodeType
    answer: Callable[[str | None], None]
    """Gets the value as `repr` writes it; None if there is none."""


def read_query(text: str, answer: Callable[[str | None], None]) -> Query:
    """Compile a query.

    Raises:
        ProgramError: it is no expression.
    """
    return Query(compile_expression(SourceFile("<query>", text)), answer)


def body_of(query: Query, program: Program) -> Callable[[], None]:
    """What a strand runs: it works the value out and answers exactly once, also if it is stopped."""

    def body() -> None:
        value: str | None = None
        try:
            shown = without_addresses(repr(program.value_of(query.code)))
            value = shown if len(shown) <= VALUE_MAX else None
        except BaseException as error:
            if is_stop(error) or isinstance(error, KeyboardInterrupt):
                raise
        finally:
            query.answer(value)

    return body
