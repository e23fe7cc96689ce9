"""What is hardly meant in a tree: rules on nodes, where the text of the script cannot show it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import asin, dist, sqrt
from typing import Final

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.transforms import Transform, position_of, rotation_of, transform_from_pose
from elitescript.program_tree import nodes
from elitescript.program_tree.cells import is_taught
from elitescript.program_tree.configuration import Configuration
from elitescript.program_tree.nodes import Move, Node, Position, Waypoint
from elitescript.program_tree.rows import Row
from elitescript.program_tree.script.writing import Problem
from elitescript.said import said

APART_M: Final = 1e-3
"""How far a pose may be from where its joint positions lead."""
APART_RAD: Final = 1e-3

POSE_AND_JOINTS: Final = "W226"
EMPTY: Final = "N227"
OTHER_FILE: Final = "W228"

_BRANCHES: Final = (
    nodes.If,
    nodes.ElseIf,
    nodes.Else,
    nodes.Loop,
    nodes.Case,
    nodes.Event,
    nodes.Thread,
    nodes.SubTask,
)
_NOTHING: Final = (nodes.Placeholder, nodes.Comment)


def tree_doubts(
    rows: tuple[Row, ...], configuration: Configuration | None, arm: Arm | None, read: Callable[[str], str | None]
) -> Iterator[Problem]:
    """Yield what is hardly meant in a task, in the order of its rows.

    Args:
        rows: of the task.
        configuration: of its installation; None: there is none.
        arm: that it was made for; None: it is not known.
        read: returns the text of a file by the path that a script node has, None if there is none.
    """
    places = _Places(configuration, arm)
    for row in rows:
        node = row.node
        if node.is_suppressed:
            continue
        if isinstance(node, Waypoint):
            if arm is not None and row.parent:
                yield from places.doubts(row, _move_around(rows, row))
        elif isinstance(node, nodes.ScriptFile):
            yield from _other_file(row, node, read)
        elif isinstance(node, _BRANCHES) and _is_empty(row):
            yield Problem(row.number, said("nothing stands in it"), is_error=False, code=EMPTY)


def _is_empty(row: Row) -> bool:
    """Return whether nothing runs in a branch; what a switch does with other values may be nothing."""
    node = row.node
    if isinstance(node, nodes.Case) and not node.name.rstrip()[-1:].isdigit():
        return False
    return all(
        child.node.is_suppressed or isinstance(child.node, (*_NOTHING, nodes.ElseIf, nodes.Else))
        for child in row.inside
    )


def _move_around(rows: tuple[Row, ...], row: Row) -> Node:
    """Return the move of a waypoint, which may stand in a circle."""
    around = rows[row.parent - 1]
    while around.parent and not isinstance(around.node, Move):
        around = rows[around.parent - 1]
    return around.node


# ---------------------------------------------------------------- poses and joint positions


class _Places:
    """Compares poses of waypoints with the places to which their joint positions lead."""

    __slots__ = ("_active", "_arm", "_configuration", "_tcps")

    def __init__(self, configuration: Configuration | None, arm: Arm | None) -> None:
        self._configuration = configuration
        self._arm = arm
        active = None if configuration is None else configuration.tool(configuration.active_tool)
        self._active = transform_from_pose((0.0,) * 6 if active is None or active.tcp is None else active.tcp)
        self._tcps: dict[str, Transform | None] = {}

    def doubts(self, row: Row, move: Node) -> Iterator[Problem]:
        """Yield the places of a waypoint whose pose and joint positions disagree."""
        node = row.node
        assert isinstance(node, Waypoint)
        if node.position == "variable":
            return
        tcp = self._tcp_of(move)
        if tcp is None:
            return
        for position in (node.start, node.target) if node.position == "relative" else (node.target,):
            if (problem := self._doubt(row, position, tcp)) is not None:
                yield problem

    def _tcp_of(self, move: Node) -> Transform | None:
        """Return the TCP of the waypoints of a move in the flange frame; None: the configuration does not have it."""
        name = move.tcp.strip() if isinstance(move, Move) and move.tcp is not None else ""
        if not name:
            return self._active
        if name not in self._tcps:
            tool = None if self._configuration is None else self._configuration.tool(name)
            self._tcps[name] = None if tool is None or tool.tcp is None else transform_from_pose(tool.tcp)
        return self._tcps[name]

    def _doubt(self, row: Row, position: Position, tcp: Transform) -> Problem | None:
        if position.pose is None or not is_taught(position.joints):
            return None
        assert self._arm is not None
        reached = self._arm.forward_tcp(position.joints, tcp)
        stored = transform_from_pose(position.pose)
        apart = dist(position_of(reached), position_of(stored))
        turned = _angle(reached, stored)
        if apart <= APART_M and turned <= APART_RAD:
            return None
        text = said(
            "its pose and its joint positions disagree: they are {apart:.1f} mm and {turned:.4f} rad apart",
            apart=apart * 1000.0,
            turned=turned,
        )
        hint = said("Teach the waypoint again, or look whether it was made for another arm or tool.")
        if self._configuration is None:
            hint = said("The tool is not known without the configuration of the installation: put it beside the task.")
        return Problem(row.number, text, is_error=False, hint=hint, code=POSE_AND_JOINTS)


def _angle(T_1: Transform, T_2: Transform) -> float:
    """Return the angle between two orientations, rad."""
    # The Frobenius norm of the difference of two rotations is 2 sqrt(2) sin(angle / 2).
    return 2.0 * asin(min(1.0, dist(rotation_of(T_1), rotation_of(T_2)) / sqrt(8.0)))


# ---------------------------------------------------------------- files


def _other_file(row: Row, node: nodes.ScriptFile, read: Callable[[str], str | None]) -> Iterator[Problem]:
    if not node.text.strip() or not node.path.strip():
        return
    text = read(node.path.strip())
    if text is None or _lines(text) == _lines(node.text):
        return
    yield Problem(
        row.number,
        said("the text in the node is not that of its file {path}", path=node.path.strip()),
        is_error=False,
        hint=said("The text in the node runs, as on the pendant; open the node there to take the file over."),
        code=OTHER_FILE,
    )


def _lines(text: str) -> list[str]:
    """Return a text as its lines; how they end does not count."""
    return text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n").rstrip("\n").split("\n")
