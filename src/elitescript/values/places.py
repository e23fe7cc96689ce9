"""The table of places: the names by which expressions read the robot and its signals.

Properties of runs, world files, watches and breakpoints of the debugger have these names in common. What a place means
in the moment is of each of them: levels over time, at the end of a run, or of now.
"""

from __future__ import annotations

import ast
from typing import Final

from elitescript.messages.signals import SIGNALS, Signal, parse_signal_name, signal_name
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


def signal_at(node: ast.AST) -> tuple[Signal, int] | None:
    """Return row and index of the signal that a part of an expression means; None if it names no family of signals.

    Raises:
        UsageError: it does, but has no such point.
    """
    name = node.value if isinstance(node, ast.Subscript) else node
    if not isinstance(name, ast.Name) or name.id not in SIGNALS:
        return None
    return parse_signal_name(ast.unparse(node))


def name_at(node: ast.AST) -> str | None:
    """Return the name of the signal that a part of an expression means; see `signal_at`."""
    found = signal_at(node)
    return None if found is None else signal_name(*found)
