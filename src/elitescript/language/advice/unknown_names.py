"""Suggests what an undefined name was meant to be, for the checker and for the alarm at run time."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Callable, Collection, Container, Iterable, Mapping
from functools import cached_property
from typing import Final, Protocol

from elitescript.language.hooks import HOOKS
from elitescript.language.modules import AVAILABLE
from elitescript.language.options import PROGRAM, SECONDARY
from elitescript.language.scopes import Scope
from elitescript.language.symbols import Symbols
from elitescript.said import said

PRELOADED: Final = frozenset(("copy", "elicopy", "exit", "long", "quit", "unichr"))
"""Names that programs find besides commands and Python's own built-ins."""

KNOWN: Final = frozenset(dir(builtins)) | PRELOADED | frozenset(HOOKS)
"""Every name that needs no definition, except the commands."""

WORDS: Final = {
    "true": "True",
    "TRUE": "True",
    "false": "False",
    "FALSE": "False",
    "none": "None",
    "null": "None",
    "NULL": "None",
    "nil": "None",
}
"""Constants as other languages write them."""

OWN_PROGRAM: Final = (
    "each `def` at the start of a line that is sent is a program of its own: what it uses stands inside it"
)
"""Hint about a name that may stand beside a program in what a client has sent."""

_CLOSING: Final = frozenset(
    "done end_for end_if end_while enddef endfor endfunction endif endthread endwhile endproc fi next wend".split()  # noqa: SIM905
)
"""Words that close a block in other languages."""

_PLACEHOLDERS: Final = ("null", "unconfigured")
"""What the pendant's plug-ins write, as a line of its own, for something that is not set up (*observed*)."""

_LEAST_LIKENESS: Final = 0.8
_SHORTEST: Final = 3
_MOST_SEARCHES: Final = 20
"""Names of one program for which similar ones are searched: each search goes through all names."""


class Names(Protocol):
    """The names that the firmware gives to programs; see `commands.definition.vocabulary`."""

    @property
    def commands(self) -> Collection[str]:
        """Commands that the firmware has."""

    @property
    def foreign(self) -> Mapping[str, str]:
        """Names of other languages, and the command that does the same."""

    @property
    def reserved(self) -> Container[str]:
        """Names that no released command has."""


def advice(
    node: ast.Name, scope: Scope, symbols: Symbols, names: Names, *, is_searched: bool = True
) -> tuple[str, str]:
    """Return the name that is meant, if one can take its place, and the hint; both may be empty.

    Args:
        node: the use of a name that nothing defines.
        scope: where it stands.
        symbols: the names of the program.
        names: those of the firmware.
        is_searched: also search for a similar name, which takes time.
    """
    name = node.id
    parent = symbols.parent(node)
    is_sent = symbols.parsed.options.kind == PROGRAM
    if isinstance(parent, ast.Call) and parent.func is node:
        if name in names.foreign:
            return "", said("here the command is called {foreign}", foreign=names.foreign[name])
        if name in names.reserved:
            return "", "the name is reserved, but no released command has it; `elitescript commands` lists them all"
    else:
        if name in _PLACEHOLDERS and isinstance(parent, ast.Expr):
            return "", "the pendant writes this for something that is not set up"
        if name.lower() in _CLOSING and isinstance(parent, ast.Expr):
            return "", "`end` closes every kind of block"
        if isinstance(parent, ast.BinOp) and isinstance(parent.op, ast.FloorDiv) and parent.right is node:
            return "", "a comment begins with `#`; `//` divides"
        if name == "p" and isinstance(parent, ast.Subscript) and parent.value is node:
            return "", "`p[...]` is a pose of URScript: leave the `p` out, a pose is a list"
        if name in WORDS:
            return WORDS[name], said("write {words}", words=WORDS[name])
        if name in AVAILABLE:
            hint = said("write `import {name}` before it", name=name)
            return "", said(
                "{hint}, inside its `def`: {own_program}", hint=hint, own_program=OWN_PROGRAM
            ) if is_sent else hint
        owner = owner_of(name, symbols)
        if owner is not None:
            return "", said(
                "it is a local variable of `{owner}`; declare it `global` there to share it", owner=owner.name
            )
    if not is_searched:
        return "", ""
    is_shared = symbols.parsed.kind == SECONDARY
    meant = nearest(name, names.commands if is_shared else _visible(name, scope, symbols, names))
    hint = said("is `{meant}` meant?", meant=meant) if meant else ""
    if is_sent:
        hint = f"{OWN_PROGRAM} ({hint})" if hint else OWN_PROGRAM
    return meant, hint


def nearest(name: str, candidates: Iterable[str]) -> str:
    """Return the candidate of which a name is probably a misspelling; empty if none is near enough."""
    if len(name) < _SHORTEST:
        return ""
    folded = name.lower()
    possible = sorted(other for other in candidates if abs(len(other) - len(name)) <= 2 + len(name) // 4)
    for other in possible:
        if other.lower() == folded:
            return other
    from difflib import get_close_matches

    # Of several that are equally near, the order of the candidates must not decide.
    found = get_close_matches(name, possible, 1, _LEAST_LIKENESS)
    return found[0] if found else ""


def _visible(name: str, scope: Scope, symbols: Symbols, names: Names) -> set[str]:
    """Return names that would mean something in `scope`, other than `name` itself."""
    found = set(symbols.global_names)
    found.update(scope.bindings)
    while scope.parent is not None:
        scope = scope.parent
        if scope.kind != "class":
            found.update(scope.bindings)
    found.update(known for known in KNOWN if known[0] not in "_@")
    found.update(names.commands)
    found.discard(name)
    return found


def owner_of(name: str, symbols: Symbols) -> Scope | None:
    """Return a function that has a local variable of that name."""
    functions = (scope for scope in symbols.owners(name) if scope.kind == "function")
    return next((scope for scope in functions if name not in scope.parameters), None)


class Meant:
    """Finds similar names for the first few unknown ones of a program.

    Args:
        names: returns the names that there are; called at the first search.
    """

    __slots__ = ("__dict__", "_found", "_make")

    def __init__(self, names: Callable[[], Collection[str]]) -> None:
        self._make = names
        self._found: dict[str, str] = {}

    @cached_property
    def _names(self) -> Collection[str]:
        return self._make()

    def by(self, name: str) -> str:
        """Return the name that is meant; empty if none is like it, or if too many were searched."""
        found = self._found.get(name)
        if found is None:
            if len(self._found) >= _MOST_SEARCHES:
                return ""
            found = self._found[name] = nearest(name, self._names)
        return found
