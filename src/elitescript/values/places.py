"""The table of places: the names by which expressions read the robot and its signals.

Properties of runs, world files, watches and breakpoints of the debugger have these names in common. What a place means
in the moment is of each of them: levels over time, at the end of a run, or of now.
"""

from __future__ import annotations

import ast
from typing import Final

from elitescript.messages.signals import SIGNALS, Signal, parse_signal_name
from elitescript.records import NamedTuple

POSE: Final = ("x", "y", "z", "rx", "ry", "rz")
JOINTS: Final = ("base", "shoulder", "elbow", "wrist1", "wrist2", "wrist3")


class Place(NamedTuple):
    """Something of the robot that expressions read by a name."""

    summary: str
    elements: tuple[str, ...] = ()
    """Names of its elements, `tcp.z` for `tcp[2]`."""
    units: tuple[str, ...] = ()
    """Of it, or of its elements."""


PLACES: Final[dict[str, Place]] = {
    "t": Place("time since the start of the run, s", (), ("s",)),
    "q": Place("target joint positions, rad", JOINTS, ("rad",) * 6),
    "qd": Place("target joint speeds, rad/s", JOINTS, ("rad/s",) * 6),
    "tcp": Place("target pose of the TCP, m and rad", POSE, ("m",) * 3 + ("rad",) * 3),
    "tcp_speed": Place("target speed of the TCP, m/s", (), ("m/s",)),
    "line": Place("line of the main thread; 0 when no program runs"),
}
"""By name. Signals are places too: `standard_digital_in[3]`, `tool_analog_in`."""


def signal_at(node: ast.AST, *, has_lists: bool = True) -> tuple[Signal, int] | None:
    """Return row and index of the signal that a part of an expression means; None for anything else.

    Args:
        node: the part.
        has_lists: names with brackets may also be something else than signals.

    Raises:
        UsageError: it names a family of signals that has no such point.
    """
    name = node
    if isinstance(node, ast.Subscript) and (isinstance(node.slice, ast.Constant) or not has_lists):
        name = node.value
    if not isinstance(name, ast.Name) or (name.id not in SIGNALS and (has_lists or name is node)):
        return None
    return parse_signal_name(ast.unparse(node))
