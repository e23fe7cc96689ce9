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
from elitescript.records import NamedTuple
from elitescript.said import said

_ROUNDING: Final = 1.0 + 1e-9

TOO_QUICK: Final = "R118"
"""Code of an obstacle that less speed would avoid."""


class Passage(NamedTuple):
    """Constants of a correction."""

    tool: ToolMotion
    what: str
    """Name of the correction, for messages."""
    beside: str
    """Words for its way past a singularity that the nominal motion passes through."""
    jump_share: float = 0.25
    """Greatest difference between the way of a joint and the mean of its speeds, in accelerations times the squared
    period; 0.25 is what a change of the acceleration within a period makes, at most."""

    def obstacle(self, before: Setpoint, target: Setpoint) -> Obstacle | None:
        """Return the obstacle to a target one period after a state; None if there is none."""
        tool = self.tool
        limits = tool.limits
        for joint, (q, q_before, w, w_before) in enumerate(zip(target.q, before.q, target.qd, before.qd, strict=True)):
            top, a_top = limits.qd_max[joint], limits.qdd_max[joint]
            if abs(w) > top * _ROUNDING:
                return self._too_quick(joint, "turn with", abs(w), top, "rad/s")
            # No acceleration within the limit makes speeds and positions differ by more than this.
            jump = abs(q - q_before - 0.5 * (w + w_before) * PERIOD_S)
            if jump > self.jump_share * a_top * PERIOD_S * PERIOD_S * _ROUNDING:
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
            if a > a_top * _ROUNDING:
                return self._too_quick(joint, "accelerate with", a, a_top, "rad/s^2")
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
