"""Limits of an arm for the planner, and the names of the joints."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, isfinite, pi
from typing import Final

from elitescript.errors import MotionError, UsageError
from elitescript.kinematics.limits import TURN
from elitescript.messages.motion import Six
from elitescript.records import record
from elitescript.said import said

JOINT_NAMES: Final = ("base", "shoulder", "elbow", "wrist1", "wrist2", "wrist3")

RANGE_TOLERANCE_RAD: Final = 1e-9
"""Distance outside its range at which a joint is outside by rounding."""


@record
class MotionLimits:
    """Limits of one arm.

    Args:
        q_min: lower end of each joint's range, rad.
        q_max: upper end, rad.
        qd_max: highest speed of each joint, rad/s.
        qdd_max: highest acceleration of each joint, rad/s^2. *Assumed*: the maker publishes none.
        tool_speed_max: highest TCP speed of a Cartesian move, m/s. *Assumed.*
        tool_acceleration_max: highest TCP acceleration of a Cartesian move, m/s^2. *Assumed.*
        equivalent_radius_m: translation, m, that a radian of tool rotation counts for. *Assumed.*

    Raises:
        UsageError: a range without width, or a limit that is not a positive number.
    """

    q_min: Six
    q_max: Six
    qd_max: Six
    qdd_max: Six
    tool_speed_max: float
    tool_acceleration_max: float
    equivalent_radius_m: float

    def __post_init__(self) -> None:
        for joint, low, high in zip(JOINT_NAMES, self.q_min, self.q_max, strict=True):
            if not low < high:
                raise UsageError(f"the range of joint {joint} is empty: {low} to {high} rad")
        for name in ("qd_max", "qdd_max"):
            for joint, limit in zip(JOINT_NAMES, getattr(self, name), strict=True):
                _require_positive(f"{name} of joint {joint}", limit)
        for name in ("tool_speed_max", "tool_acceleration_max", "equivalent_radius_m"):
            _require_positive(name, getattr(self, name))

    @property
    def tool_turn_speed_max(self) -> float:
        """Highest angular speed of a pure tool rotation, rad/s: the tool speed at the equivalent radius."""
        return self.tool_speed_max / self.equivalent_radius_m

    @property
    def tool_turn_acceleration_max(self) -> float:
        """Highest angular acceleration of a pure tool rotation, rad/s^2."""
        return self.tool_acceleration_max / self.equivalent_radius_m


def unwrapped(q: Six, near: Six) -> Six:
    """Return q with each joint on the full turn that is nearest to `near`."""
    q1, q2, q3, q4, q5, q6 = q
    n1, n2, n3, n4, n5, n6 = near
    if (
        -pi < n1 - q1 < pi
        and -pi < n2 - q2 < pi
        and -pi < n3 - q3 < pi
        and -pi < n4 - q4 < pi
        and -pi < n5 - q5 < pi
        and -pi < n6 - q6 < pi
    ):
        # As a rule; zeros lose their sign, as by the sum below.
        return q1 + 0.0, q2 + 0.0, q3 + 0.0, q4 + 0.0, q5 + 0.0, q6 + 0.0
    q1, q2, q3, q4, q5, q6 = [
        angle + TURN * round((other - angle) / TURN) for angle, other in zip(q, near, strict=True)
    ]
    return q1, q2, q3, q4, q5, q6


def joint_outside(limits: MotionLimits, q: Sequence[float]) -> int | None:
    """Return the index of the first joint of q (rad) that is outside its range, or None."""
    for index, (angle, low, high) in enumerate(zip(q, limits.q_min, limits.q_max, strict=True)):
        # Written so that an angle that is not a number counts as outside.
        if not low - RANGE_TOLERANCE_RAD <= angle <= high + RANGE_TOLERANCE_RAD:
            return index
    return None


def joint_range_error(
    limits: MotionLimits, joint: int, angle: float, place: str, *, more: str = "", hint: str | None = None
) -> MotionError:
    """Return the R110 refusal for a joint (index) that would leave its range.

    Args:
        limits: limits of the arm.
        joint: index of the joint.
        angle: its position, rad.
        place: words for the place on the move.
        more: added at the end of the text.
        hint: of the error.
    """
    low, high = limits.q_min[joint], limits.q_max[joint]
    return MotionError(
        said(
            "{place}, joint {joint} would be at {angle:.4f} rad ({angle_deg:.1f} deg); its range is "
            "{low:.4f} to {high:.4f} rad ({low_deg:.1f} to {high_deg:.1f} deg){more}",
            place=place,
            joint=JOINT_NAMES[joint],
            angle=angle,
            angle_deg=degrees(angle),
            low=low,
            high=high,
            low_deg=degrees(low),
            high_deg=degrees(high),
            more=more,
        ),
        code="R110",
        value=angle,
        limit=f"[{low:.6g}, {high:.6g}]",
        unit="rad",
        hint=hint,
    )


def _require_positive(name: str, value: float) -> None:
    if not (isfinite(value) and value > 0.0):
        raise UsageError(f"{name} is {value}; it has to be a positive number")
