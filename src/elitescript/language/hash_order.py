"""Decides whether a program can show the order of a set, which differs from process to process.

Python mixes a random number into the hashes of texts, bytes and dates, unless `PYTHONHASHSEED` is set before the
interpreter starts. The order of sets follows from them; that of dicts, lists and all else does not. So a program whose
results shall be the same everywhere needs an interpreter that was started for it, if it

- has a set display or a set comprehension,
- names `set`, `frozenset` or `hash`, or what reaches them by names made at run time: `eval`, `exec`, `getattr`,
- has the attribute `__hash__`, or `keys` or `items` other than as what a loop goes over (`for k in d.keys()`), for the
  views that they return make sets: `d.keys() & e.keys()`; a class pattern has attributes too: `case dict(keys=k)`,
- imports a module that is not in `SAFE_MODULES`,
- or has syntax that is not known.

Any other program cannot make a set, nor get the hash of a text, unless it begins with a global that holds one
(`may_hold_set`). The rule looks at what is written alone, so it takes
some programs for one that can although they cannot; that costs them a second start.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable
from typing import Final

from elitescript.language.nodes import Census

UNSAFE_NAMES: Final = frozenset(("eval", "exec", "frozenset", "getattr", "hash", "set"))
"""Predefined names that give sets or hashes, or run what the tree does not show."""

SAFE_MODULES: Final = frozenset(
    """
    base64 binascii bisect cmath datetime decimal heapq itertools json math queue random re string struct textwrap
    threading time
    """.split()  # noqa: SIM905
)
"""Modules that programs can import and that return no sets and no hashes."""

_VIEWS: Final = ("items", "keys")

_PLAIN: Final = (type(None), bool, int, float, complex, str, bytes)


def shows_hash_order(census: Census) -> bool:
    """Return whether a program may show the order of a set or the hash of a text, from the nodes of its tree."""
    if census.unknown or census.by_kind[ast.Set] or census.by_kind[ast.SetComp]:
        return True
    if any(node.id in UNSAFE_NAMES for node in census.of(ast.Name)):
        return True
    if any(alias.name not in SAFE_MODULES for node in census.of(ast.Import) for alias in node.names):
        return True
    if any(node.level or node.module not in SAFE_MODULES for node in census.of(ast.ImportFrom)):
        return True
    iterated = [*[loop.iter for loop in census.of(ast.For)], *[loop.iter for loop in census.of(ast.comprehension)]]
    gone_over = {id(call.func) for call in iterated if isinstance(call, ast.Call)}
    if any(name == "__hash__" or name in _VIEWS for node in census.of(ast.MatchClass) for name in node.kwd_attrs):
        return True
    return any(
        node.attr == "__hash__" or (node.attr in _VIEWS and id(node) not in gone_over)
        for node in census.of(ast.Attribute)
    )


def may_hold_set(values: Iterable[object]) -> bool:
    """Return whether one of these values is not certainly free of sets: plain ones, and lists, tuples, dicts of them."""
    pending, seen = list(values), set()
    while pending:
        value = pending.pop()
        kind = type(value)
        if kind in _PLAIN or id(value) in seen:
            continue
        if kind is dict:
            pending += [*value, *value.values()]  # type: ignore[attr-defined]
        elif kind is list or kind is tuple:
            pending += value  # type: ignore[call-overload]
        else:
            return True
        seen.add(id(value))
    return False
