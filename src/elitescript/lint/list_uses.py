"""Lists the commands that get one list of six numbers as joint positions, and those that get it as a pose.

A list is known by the place that makes it, so that it is followed through variables, arguments and results.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterable, Iterator
from typing import Final

from elitescript.commands.definition.registry import Command, Param
from elitescript.language.symbols import Symbols
from elitescript.records import NamedTuple
from elitescript.values.description import OUTSIDE
from elitescript.values.program import Values

JOINTS: Final = "joints"
POSE: Final = "pose"
_TRANSFORM: Final = "m, rad"
"""Unit of poses and transforms."""

_BUFFER_FROM: Final = 3
"""Elements that are set, from which on a list is taken for a buffer."""

Given = tuple[Command, ast.Call, tuple[tuple[Param, ast.expr], ...]]
"""A call of a command, with its arguments by parameter."""


class Use(NamedTuple):
    """An argument."""

    command: Command
    param: Param
    node: ast.expr


class ListUses:
    """The arguments that are joint positions or poses, by the list that they are.

    Args:
        calls: of commands.
        values: what their arguments are.
        symbols: of the program.
        elements: all that it reads and sets.
    """

    __slots__ = ("_by_site", "_filled", "_moved", "_symbols")

    def __init__(
        self, calls: Iterable[Given], values: Values, symbols: Symbols, elements: Iterable[ast.Subscript]
    ) -> None:
        self._symbols = symbols
        self._filled = self._buffers(elements)
        self._by_site: dict[int, dict[str, list[Use]]] = {}
        self._moved: dict[int, set[int]] = {}
        """Lists that transforms compute, by the list that they are computed from."""
        for command, call, given in calls:
            for param, node in given:
                meaning = param.quantity.meaning
                if isinstance(node, (ast.List, ast.Tuple, ast.Constant)):
                    continue
                if not meaning and param.quantity.unit == _TRANSFORM:
                    made = values.of(call).sites
                    for site in values.of(node).sites:
                        self._moved.setdefault(site, set()).update(made)
                if meaning not in (JOINTS, POSE):
                    continue
                value = values.of(node)
                # What a peer sends may be the one or the other, as it says itself.
                if len(value.sites) != 1 or value.may & OUTSIDE:
                    continue
                uses = self._by_site.setdefault(min(value.sites), {JOINTS: [], POSE: []})
                uses[meaning].append(Use(command, param, node))
        self._by_site.pop(-1, None)

    def as_both(self) -> Iterator[tuple[Use, Use]]:
        """Yield the arguments that are a list of the other kind everywhere else, each with one of the others.

        Where a list is as often one as the other, these are the later ones. A choice between two moves is none.
        """
        for uses in self._by_site.values():
            joints, poses = uses[JOINTS], uses[POSE]
            if not joints or not poses:
                continue
            few, many = sorted((joints, poses), key=lambda side: (len(side), -side[0].node.lineno))
            for use in few:
                if self._key(use.node) in self._filled:
                    continue
                other = next((other for other in many if not self._exclude_each_other(use.node, other.node)), None)
                if other is not None:
                    yield use, other

    def is_pose(self, sites: frozenset[int]) -> bool:
        """Return whether a list goes to a command as a pose, perhaps through further transforms."""
        seen: set[int] = set()
        open_sites = set(sites)
        while open_sites:
            site = open_sites.pop()
            if self._by_site.get(site, {}).get(POSE):
                return True
            seen.add(site)
            open_sites |= self._moved.get(site, set()) - seen
        return False

    def _buffers(self, elements: Iterable[ast.Subscript]) -> set[object]:
        """Return the variables whose lists are filled anew, by a loop or element by element: with anything."""
        stores: Counter[object] = Counter()
        for node in elements:
            if isinstance(node.ctx, ast.Store):
                stores[self._key(node.value)] += 1 if isinstance(node.slice, ast.Constant) else _BUFFER_FROM
        return {key for key, number in stores.items() if key is not None and number >= _BUFFER_FROM}

    def _key(self, node: ast.expr) -> object:
        """Return what identifies a variable; None for anything else."""
        if not isinstance(node, ast.Name):
            return None
        return self._symbols.scope_of(node).home(node.id), node.id

    def _exclude_each_other(self, one: ast.expr, other: ast.expr) -> bool:
        """Return whether two nodes stand in different branches of one `if`."""
        around = dict(self._branches(one))
        return any(above in around and around[above] != below for above, below in self._branches(other))

    def _branches(self, node: ast.AST) -> Iterator[tuple[ast.If, str]]:
        below = node
        for above in self._symbols.ancestors(node):
            if isinstance(above, ast.If):
                yield above, "else" if below in above.orelse else "if"
            below = above
