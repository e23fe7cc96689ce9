"""Defines what a lint rule is, and lists all of them.

A rule is one decorated function in a file of its own under `rules`. It takes an `AnalysedProgram` and yields
findings; its code is written there and nowhere else but in the table of `errors`.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Final

from elitescript.commands.definition.docstring import docstring_of
from elitescript.errors import CODES, InternalError
from elitescript.language.diagnostics import Fix
from elitescript.records import NamedTuple

if TYPE_CHECKING:
    from elitescript.lint.program import AnalysedProgram, Span


class Finding(NamedTuple):
    """Holds what a rule yields; the engine adds the code.

    Attributes:
        where: the node, or the range of the text, that is wrong.
        text: what is wrong, with value, limit and unit.
        hint: what to do about it; may be empty.
        fix: a repair that a tool can make.
    """

    where: ast.AST | Span
    text: str
    hint: str = ""
    fix: Fix | None = None


Check = Callable[["AnalysedProgram"], Iterable[Finding]]


class Rule(NamedTuple):
    """Describes a rule; see `rule` for the fields."""

    code: str
    since: str
    check: Check
    instead_of: tuple[str, ...]
    needs_all_lines: bool

    @property
    def explanation(self) -> str:
        """What it finds, why, and an example."""
        return docstring_of(import_module(self.check.__module__))


_RULES: Final[dict[str, Rule]] = {}


def rule(
    *, code: str, since: str, instead_of: tuple[str, ...] = (), needs_all_lines: bool = False
) -> Callable[[Check], Check]:
    """Register the decorated function as a rule.

    Args:
        code: its row of `errors.CODES`.
        since: release of elitescript that brought it.
        instead_of: codes that are less specific; their findings at the same place are dropped.
        needs_all_lines: skip it if a line could not be read, as that line may hold what it misses.
    """

    def register(check: Check) -> Check:
        if code in _RULES or code not in CODES:
            raise InternalError(f"{check.__module__}: {code} is another rule's, or no code")
        _RULES[code] = Rule(code, since, check, instead_of, needs_all_lines)
        return check

    return register


def doubt_findings(program: AnalysedProgram, code: str) -> Iterator[Finding]:
    """Yield the doubts about values with a code as findings of its rule."""
    for doubted in program.doubts:
        doubt = doubted.doubt
        if doubt.code == code:
            from elitescript.lint.unit_fixes import unit_fix

            yield Finding(doubted.node, doubt.text, doubt.hint, unit_fix(program, doubted))


@cache
def all_rules() -> tuple[Rule, ...]:
    """Return every rule, by code."""
    from elitescript.lint import rules

    # `pkgutil` would import `inspect`, which takes longer than a third of the rules.
    for folder in rules.__path__:
        for path in sorted(Path(folder).iterdir()):
            if path.suffix == ".py" and not path.stem.startswith("_"):
                import_module(f"{rules.__name__}.{path.stem}")
    return tuple(_RULES[code] for code in sorted(_RULES))
