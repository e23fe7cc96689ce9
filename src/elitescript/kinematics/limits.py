"""Joint vectors, joint ranges, full turns, and the tolerances of the inverse kinematics."""

from __future__ import annotations

from math import ceil, pi, remainder
from typing import Final, TypeAlias

SixFloats: TypeAlias = tuple[float, float, float, float, float, float]
"""One number for each joint, or a twist."""

JointVector: TypeAlias = tuple[float, float, float, float, float, float]
"""Joint angles base, shoulder, elbow, wrist 1, wrist 2, wrist 3, rad."""

TURN: Final = 2.0 * pi
"""One full turn, rad."""

REACH_TOLERANCE_M: Final = 1e-6
"""A pose that misses the border of the workspace by no more than this is solved at the border.
Poses printed with six decimals of a stretched arm lie outside as often as inside."""

WRIST_SINGULAR_SINE: Final = 1e-6
"""With |sin q5| below it, joints 4 and 6 turn about one axis as far as printed poses can tell;
q6 is then chosen and q4 follows. The orientation is missed by at most this angle (rad)."""

RANGE_TOLERANCE_RAD: Final = 1e-9
"""A joint angle beyond its range by no more than this is rounding and is put on the border: at
two metres of reach it is two nanometres."""


def wrap_to_pi(angle: float) -> float:
    """Return the same direction in (-pi, pi], rad."""
    wrapped = remainder(angle, TURN)
    return pi if wrapped <= -pi else wrapped


def nearest_turn(angle: float, near: float, low: float, high: float) -> float | None:
    """Return the angle plus full turns that lies in [low, high] and nearest to `near`, rad.

    Returns None when no turn of the angle lies in the range. Halfway between two turns the one
    is taken that an even number of turns leads to, so that the angle itself wins over +-1 turn.
    """
    turns = round((near - angle) / TURN)
    candidate = angle + TURN * turns
    if candidate < low - RANGE_TOLERANCE_RAD:
        turns += ceil((low - RANGE_TOLERANCE_RAD - candidate) / TURN)
        candidate = angle + TURN * turns
    elif candidate > high + RANGE_TOLERANCE_RAD:
        turns -= ceil((candidate - high - RANGE_TOLERANCE_RAD) / TURN)
        candidate = angle + TURN * turns
    if low - RANGE_TOLERANCE_RAD <= candidate <= high + RANGE_TOLERANCE_RAD:
        return min(max(candidate, low), high)
    return None
