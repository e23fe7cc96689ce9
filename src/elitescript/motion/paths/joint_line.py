"""The straight line in joint space."""

from __future__ import annotations

from collections.abc import Hashable
from math import hypot

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.jacobian import tcp_twist
from elitescript.kinematics.transforms import Transform
from elitescript.messages.motion import Six
from elitescript.motion.course import rounded


class JointLine:
    """All joints in proportion, measured by the leading joint; immutable. A `JointPath`.

    The leading joint is the first one with the largest displacement. The path position is the angle, rad, that it has
    covered.

    Attributes:
        slope: displacement of each joint against that of the leading joint, in [-1, 1].
    """

    __slots__ = ("_T_flange_tcp", "_arm", "length", "q_end", "q_start", "slope")

    kind = "joint"
    unit = "rad"

    def __init__(self, arm: Arm, T_flange_tcp: Transform, q_start: Six, q_end: Six) -> None:
        self._arm = arm
        self._T_flange_tcp = T_flange_tcp
        self.q_start = q_start
        self.q_end = q_end
        displacement = [end - start for start, end in zip(q_start, q_end, strict=True)]
        self.length = max(map(abs, displacement))
        d1, d2, d3, d4, d5, d6 = [d / self.length if self.length else 0.0 for d in displacement]
        self.slope: Six = (d1, d2, d3, d4, d5, d6)

    @property
    def T_base_tcp_end(self) -> Transform:
        return self._arm.forward_tcp(self.q_end, self._T_flange_tcp)

    def q(self, s: float) -> Six:
        if s <= 0.0:
            return self.q_start
        if s >= self.length:
            return self.q_end
        q1, q2, q3, q4, q5, q6 = self.q_start
        d1, d2, d3, d4, d5, d6 = self.slope
        return q1 + s * d1, q2 + s * d2, q3 + s * d3, q4 + s * d4, q5 + s * d5, q6 + s * d6

    def q_and_slope(self, s: float) -> tuple[Six, Six]:
        return self.q(s), self.slope

    def turned(self, begin: float, end: float) -> Six:
        way = max(min(end, self.length) - max(begin, 0.0), 0.0)
        a, b, c, d, e, f = self.slope
        return abs(a) * way, abs(b) * way, abs(c) * way, abs(d) * way, abs(e) * way, abs(f) * way

    @property
    def course(self) -> Hashable:
        return self.kind, rounded((*self.q_start, *self.q_end))

    def tool_rates(self, s: float) -> tuple[float, float]:
        vx, vy, vz, wx, wy, wz = tcp_twist(self._arm, self.q(s), self.slope, self._T_flange_tcp)
        return hypot(vx, vy, vz), hypot(wx, wy, wz)
