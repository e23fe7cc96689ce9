"""What a misspelt name was meant to be."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.lint.program import KNOWN, Program, Use

MOST_SUGGESTIONS: Final = 20
"""Names of one program that are looked up; a text with more unknown names is no program for this robot."""

_LEAST_LIKENESS: Final = 0.8
_SHORTEST: Final = 3


def nearest(name: str, candidates: Iterable[str]) -> str:
    """The candidate that a name is most probably a slip of; empty if none is near enough."""
    if len(name) < _SHORTEST:
        return ""
    folded = name.lower()
    possible = [other for other in candidates if abs(len(other) - len(name)) <= 2 + len(name) // 4]
    for other in possible:
        if other.lower() == folded:
            return other
    from difflib import get_close_matches

    # Of several that are equally near, the order of the candidates must not decide.
    found = get_close_matches(name, sorted(possible), 1, _LEAST_LIKENESS)
    return found[0] if found else ""


def available_commands(program: Program) -> list[str]:
    """Names of the commands that the firmware has."""
    return [name for name in CATALOGUE.names() if program.is_available(CATALOGUE.get(name))]  # type: ignore[arg-type]


def visible_names(use: Use, program: Program) -> set[str]:
    """Names that would mean something where `use` stands."""
    names = set(program.symbols.global_names)
    scope = use.scope
    names.update(scope.bindings)
    while scope.parent is not None:
        scope = scope.parent
        if scope.kind != "class":
            names.update(scope.bindings)
    names.update(name for name in KNOWN if name[0] not in "_@")
    names.update(available_commands(program))
    names.discard(use.name)
    return names
