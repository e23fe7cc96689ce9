"""Keeps what the evaluation of each function has read and done, so that the next version of a text need not repeat it.

A record is the log of an evaluation: each question about what functions share, with its answer, and each change of it,
in their order. If all that a function reads in the next version has the same answers, its evaluation would make the
same changes, and its expressions are what they were: the log is played again instead. As soon as an answer differs the
function is evaluated. What was played until then is what the evaluation does as well, and changes nothing twice; but
what it has put into lists would be seen too early (`StartAgain`).

Nodes are the same as long as their piece of the text is; see `language.text.pieces`.
"""

from __future__ import annotations

import ast
from typing import Any, Final

from elitescript.language.scopes import Scope
from elitescript.records import NamedTuple
from elitescript.values.description import Value, same
from elitescript.values.store import SiteNumbers

BODY: Final = "body"
"""Stands for the node of the body of a text, which is made anew in each version."""

VariableKey = tuple[Any, str]
"""The node of the scope of a variable, `BODY`, or None for a global, and its name: the same in each version."""


class StartAgain(Exception):
    """What was kept of the version before is of no use for this one: all of it has to be evaluated."""


class Entry(NamedTuple):
    """One question or change of a log.

    Attributes:
        method: of `State`.
        arguments: of the call.
        depth: nesting around it.
        repeated: loops around it.
        answer: what it has returned.
    """

    method: str
    arguments: tuple[Any, ...]
    depth: int
    repeated: int
    answer: Any


class Record(NamedTuple):
    """One evaluation of a function.

    Attributes:
        situation: all but the log on which it depends: what its names mean, who may call it, how deep it is nested.
        statements: of the body of a text; the node of other functions says that they are the same.
        log: what it has asked and changed.
        values: what its expressions are.
        heads: the states at the heads of its loops.
    """

    situation: Any
    statements: tuple[ast.stmt, ...]
    log: list[Entry]
    values: dict[ast.AST, Value]
    heads: dict[ast.AST, dict[VariableKey, Value]]


class Memory:
    """Holds the records of the last version of a text.

    Attributes:
        numbers: of the places that make lists.
    """

    __slots__ = ("_circumstances", "_new", "_records", "numbers")

    def __init__(self) -> None:
        self.numbers = SiteNumbers()
        self._circumstances: Any = None
        self._records: dict[Any, list[Record]] = {}
        self._new: dict[Any, list[Record]] = {}

    def begin(self, circumstances: Any) -> None:
        """Begin to evaluate a version; nothing is known of versions in other circumstances."""
        if circumstances != self._circumstances:
            self._circumstances, self._records = circumstances, {}
        self._new = {}

    def end(self) -> None:
        """Keep what was found of a version that was evaluated to its end, and nothing else."""
        self._records = self._new
        self.numbers.keep_used()

    def forget(self) -> None:
        """Keep nothing."""
        self._records, self.numbers = {}, SiteNumbers()

    def known(self, scope: Scope, time: int, situation: Any) -> Record | None:
        """Return the record of an evaluation of a function.

        Args:
            scope: of the function.
            time: how many evaluations of it were before, in its version.
            situation: see `Record`.
        """
        records = self._records.get(_key(scope), [])
        record = records[time] if time < len(records) else None
        if record is None or record.situation != situation:
            return None
        # A function that is the same node has the same statements.
        statements = scope.statements if scope.kind == "body" else ()
        is_same = len(record.statements) == len(statements) and all(map(_is_same, record.statements, statements))
        return record if is_same else None

    def keep(self, scope: Scope, record: Record) -> None:
        """Keep the record of the next evaluation of a function."""
        self._new.setdefault(_key(scope), []).append(record)


def _key(scope: Scope) -> Any:
    return BODY if scope.kind == "body" else scope.node


def _is_same(one: object, other: object) -> bool:
    return one is other


def agree(answer: Any, now: Any) -> bool:
    """Return whether a question has the same answer as before."""
    if isinstance(answer, Value) and isinstance(now, Value):
        return same(answer, now)
    return bool(answer == now)
