"""A variable that gets a value and is never read, while another of nearly the same name is.

Python makes a new variable of a misspelt name, and the one that was meant keeps its value.

    def job():
      counter = 0
      while counter < 3:
        conuter = counter + 1    # W276: is `counter` meant?
        sleep(0.5)
      end
    end
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elitescript.language.diagnostics import Edit, Fix
from elitescript.language.options import SCRIPT
from elitescript.language.scopes import Scope
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule

_FOREIGN: Final = frozenset(("exec", "eval", "interpreter_mode", "globals", "locals", "vars"))
"""Functions through which other texts may read a variable."""
_SHORTEST: Final = 4


@rule(code="W276", since="0.3", needs_all_lines=True)
def misspelt_variable(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the first assignment of each such variable."""
    scopes = program.symbols.scopes
    if program.parsed.kind == SCRIPT or any(name in scope.reads for scope in scopes for name in _FOREIGN):
        return
    for scope in scopes:
        if scope.kind not in ("function", "body"):
            continue
        for name, bindings in scope.bindings.items():
            if len(name) < _SHORTEST or name.startswith("_") or name in program.symbols.global_names:
                continue
            if any(binding.kind != "assign" for binding in bindings) or not scope.has_local(name):
                continue
            if _is_read(name, scope):
                continue
            meant = _meant(name, scope, program)
            if meant:
                first = bindings[0]
                fix = Fix(f"write {meant}", (Edit(*program.name_span(first.node, name), meant),), safe=False)
                text = f"nothing reads the variable `{name}`, but there is one called `{meant}`"
                yield Finding(program.name_span(first.node, name), text, f"is `{meant}` meant?", fix)


def _is_read(name: str, home: Scope) -> bool:
    return any(name in inner.reads and inner.home(name) is home for inner in home.walk())


def _meant(name: str, scope: Scope, program: AnalysedProgram) -> str:
    """Return the variable that can be used here and whose name differs by a slip of a finger; empty for none."""
    known = set(program.symbols.global_names)
    outer: Scope | None = scope
    while outer is not None:
        known |= {other for other in outer.bindings if other != name and _is_read_anywhere(other, outer)}
        outer = outer.parent
    return next((other for other in sorted(known) if is_slip(name, other)), "")


def _is_read_anywhere(name: str, scope: Scope) -> bool:
    return any(name in inner.reads for inner in scope.walk())


def is_slip(one: str, other: str) -> bool:
    """Return whether two names differ by two letters in each other's place, a letter more or less, or by capitals."""
    if one == other:
        return False
    if one.lower() == other.lower():
        return True
    short, long = sorted((one, other), key=len)
    if len(long) - len(short) > 1:
        return False
    at = next((at for at, (a, b) in enumerate(zip(short, long, strict=False)) if a != b), len(short))
    if len(short) == len(long):
        # Another letter makes another word, `left` and `lift`; another digit another thing, `q1` and `q2`.
        return one[at : at + 2] == other[at : at + 2][::-1] and one[at + 2 :] == other[at + 2 :]
    return long[at].isalpha() and short[at:] == long[at + 1 :]
