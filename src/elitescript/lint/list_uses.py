"""Lists the commands that get one list of six numbers as joint positions, and those that get it as a pose.

A list is known by the place that makes it, so that it is followed through variables, arguments and results.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.commands.definition.registry import Command, Param
from elitescript.lint.program import AnalysedProgram
from elitescript.records import NamedTuple

JOINTS: Final = "joints"
POSE: Final = "pose"
_TRANSFORM: Final = "m, rad"
"""Unit of poses and transforms."""


class Use(NamedTuple):
    """An argument."""

    command: Command
    param: Param
    node: ast.expr


class ListUses:
    """The arguments that are joint positions or poses, by the list that they are.

    Args:
        program: the program.
    """

    __slots__ = ("_by_site", "_moved")

    def __init__(self, program: AnalysedProgram) -> None:
        self._by_site: dict[int, dict[str, list[Use]]] = {}
        self._moved: dict[int, set[int]] = {}
        """Lists that transforms compute, by the list that they are computed from."""
        for called, arguments in zip(program.command_calls, program.arguments, strict=True):
            for param, node in arguments.given:
                meaning = param.quantity.meaning
                if not meaning and param.quantity.unit == _TRANSFORM and not isinstance(node, ast.List):
                    made = program.values.of(called.call).sites
                    for site in program.values.of(node).sites:
                        self._moved.setdefault(site, set()).update(made)
                if meaning not in (JOINTS, POSE) or isinstance(node, (ast.List, ast.Tuple, ast.Constant)):
                    continue
                sites = program.values.of(node).sites
                if len(sites) == 1 and (site := min(sites)) >= 0:
                    uses = self._by_site.setdefault(site, {JOINTS: [], POSE: []})
                    uses[meaning].append(Use(called.command, param, node))

    def as_both(self) -> Iterator[tuple[Use, Use]]:
        """Yield the arguments that are a list of the other kind everywhere else, each with one of the others.

        Where a list is as often one as the other, these are the later ones.
        """
        for uses in self._by_site.values():
            joints, poses = uses[JOINTS], uses[POSE]
            if not joints or not poses:
                continue
            sides = sorted((joints, poses), key=lambda side: (len(side), -side[0].node.lineno))
            for use in sides[0]:
                yield use, sides[1][0]

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
