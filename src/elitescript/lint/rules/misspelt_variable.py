"""A variable that gets a value and is never read, while another of nearly the same name is.

Python makes a new variable of a misspelt name, and the one that was meant keeps its value.

    def job():
      counter = 0
      while counter < 3:
        conuter = counter + 1    # W223: is `counter` meant?
        sleep(0.5)
      end
    end
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

from elitescript.language.diagnostics import Edit, Fix
from elitescript.language.options import SCRIPT
from elitescript.language.scopes import Scope
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_FOREIGN: Final = frozenset(("exec", "eval", "interpreter_mode", "globals", "locals", "vars"))
"""Functions through which other texts may read a variable."""
_SHORTEST: Final = 4
_VARIABLES: Final = ("assign", "augmented", "annotated", "walrus", "for", "with", "parameter")


@rule(code="W223", since="0.3", needs_all_lines=True)
def misspelt_variable(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the first assignment of each such variable."""
    scopes = program.symbols.scopes
    if program.parsed.kind == SCRIPT or any(name in scope.reads for scope in scopes for name in _FOREIGN):
        return
    read = {(scope.home(name), name) for scope in scopes for name in scope.reads}
    known: dict[Scope | None, Spellings] = {}
    for scope in scopes:
        if scope.kind not in ("function", "body"):
            continue
        for name, bindings in scope.bindings.items():
            if len(name) < _SHORTEST or name.startswith("_") or name[-1].isdigit():
                continue
            if name in program.symbols.global_names:
                continue
            if (scope, name) in read or not scope.has_local(name):
                continue
            if any(binding.kind != "assign" for binding in bindings):
                continue
            meant = _meant(name, scope, read, known, program)
            if meant:
                span = program.name_span(bindings[0].node, name)
                text = said(
                    "nothing reads the variable `{name}`, but there is one called `{meant}`", name=name, meant=meant
                )
                fix = Fix(said("write {meant}", meant=meant), (Edit(*span, meant),), safe=False)
                yield Finding(span, text, said("is `{meant}` meant?", meant=meant), fix)


def _meant(
    name: str,
    scope: Scope,
    read: set[tuple[Scope | None, str]],
    known: dict[Scope | None, Spellings],
    program: AnalysedProgram,
) -> str:
    """Return the variable that can be used here and whose name differs by a slip of a finger; empty for none."""
    place: Scope | None = scope
    while True:
        if place not in known:
            names = program.symbols.global_names if place is None else place.bindings
            known[place] = Spellings(
                other for other in names if place is None or ((place, other) in read and _is_variable(other, place))
            )
        if meant := known[place].nearest(name):
            return meant
        if place is None:
            return ""
        place = place.parent


def _is_variable(name: str, scope: Scope) -> bool:
    """Return whether a name is no function, class or module: `part = Part()` is no slip."""
    return all(binding.kind in _VARIABLES for binding in scope.bindings[name])


class Spellings:
    """Finds the names that differ from another by a slip of a finger: two letters in each other's place, a letter more
    or less, capitals. Another letter makes another word, `left` and `lift`; another digit, or an end, another thing.

    Args:
        names: to find.
    """

    __slots__ = ("_by_letters", "_longer", "_names")

    def __init__(self, names: Iterable[str]) -> None:
        self._names = frozenset(names)
        self._by_letters = {name.lower(): name for name in self._names}
        self._longer = {short: name for name in self._names for short in _shorter(name)}

    def nearest(self, name: str) -> str:
        """Return one of the names; empty for none."""
        swapped = (name[:at] + name[at + 1] + name[at] + name[at + 2 :] for at in range(len(name) - 1))
        near = (self._by_letters.get(name.lower()), self._longer.get(name), *swapped, *_shorter(name))
        return next((other for other in near if other and other != name and other in self._names), "")


def _shorter(name: str) -> list[str]:
    """Return what is left of a name without a letter, but not without its last one: `parts` and `placed` are words."""
    if len(name) <= _SHORTEST:
        return []
    places = [at for at, sign in enumerate(name[:-1]) if sign.isalpha()]
    return [name[:at] + name[at + 1 :] for at in places]
