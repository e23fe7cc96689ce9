"""Checks that the arm can reach the next target of a correction, and stop after it.

The nominal motion is planned so that it can; with a correction the joints may have to be faster, or the path may end.
"""

from __future__ import annotations

from typing import Final

from elitescript.messages.timing import PERIOD_S
from elitescript.motion.limits import JOINT_NAMES
from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.speed import Obstacle, obstacle_at, range_obstacle
from elitescript.motion.streaming.twist import ToolMotion, singular_obstacle
from elitescript.said import said

_ROUNDING: Final = 1.0 + 1e-9

TOO_QUICK: Final = "R118"
"""Code of an obstacle that less speed would avoid."""


class Passage:
    """Looks at the targets of one correction.

    Args:
        tool: the arm with its limits.
        what: name of the correction, for messages.
        beside: words for its way past a singularity that the nominal motion passes through.
        jump_share: greatest difference between the way of a joint and the mean of its speeds, in accelerations times
            the squared period; 0.25 is what a change of the acceleration within a period makes, at most.
    """

    __slots__ = ("_bounds", "_jump_share", "beside", "tool", "what")

    def __init__(self, tool: ToolMotion, what: str, beside: str, jump_share: float = 0.25) -> None:
        self.tool = tool
        self.what = what
        self.beside = beside
        self._jump_share = jump_share
        self._bounds: list[tuple[float, float, float]] = []
        """Greatest speed, jump and acceleration of each joint; empty before the first target."""

    def obstacle(self, before: Setpoint, target: Setpoint) -> Obstacle | None:
        """Return the obstacle to a target one period after a state; None if there is none."""
        tool = self.tool
        limits = tool.limits
        if not self._bounds:
            share = self._jump_share
            self._bounds = [
                (top * _ROUNDING, share * a_top * PERIOD_S * PERIOD_S * _ROUNDING, a_top * _ROUNDING)
                for top, a_top in zip(limits.qd_max, limits.qdd_max, strict=True)
            ]
        for joint, q, q_before, w, w_before, (w_max, jump_max, a_max) in zip(
            range(6), target.q, before.q, target.qd, before.qd, self._bounds, strict=True
        ):
            if abs(w) > w_max:
                return self._too_quick(joint, "turn with", abs(w), limits.qd_max[joint], "rad/s")
            # No acceleration within the limit makes speeds and positions differ by more than this.
            if abs(q - q_before - 0.5 * (w + w_before) * PERIOD_S) > jump_max:
                return Obstacle(
                    "R112",
                    said(
                        "the move passes through a singularity, and {beside} beside it: joint {joint} would jump "
                        "by {q:.4f} rad",
                        beside=self.beside,
                        joint=JOINT_NAMES[joint],
                        q=q - q_before,
                    ),
                    q - q_before,
                    "",
                    "rad",
                )
            a = abs(w - w_before) / PERIOD_S
            if a > a_max:
                return self._too_quick(joint, "accelerate with", a, limits.qdd_max[joint], "rad/s^2")
        outside = obstacle_at(*target, tool.deceleration, limits)
        if outside is not None:
            return range_obstacle(limits, outside, before.q, self.what)
        met = tool.singularity_met(*target)
        return None if met is None else singular_obstacle(tool.arm, before.q, met, self.what)

    def _too_quick(self, joint: int, does: str, value: float, limit: float, unit: str) -> Obstacle:
        return Obstacle(
            TOO_QUICK,
            said(
                "{what} would make joint {joint} {does} {value:.4g} {unit}, it can {limit:.4g} {unit}",
                what=self.what,
                joint=JOINT_NAMES[joint],
                does=does,
                value=value,
                unit=unit,
                limit=limit,
            ),
            value,
            f"<= {limit:.6g}",
            unit,
        )
