"""The path round a corner, which leaves one path while joining the next.

Over the parameter f from 0 to 1 the last stretch d1 of the first path and the first stretch d2 of the second are
superposed,

    X(f) = A(L - d1 (1 - f)^2) + B(d2 f^2) - W

where W is the waypoint, the end of A and the start of B. For two lines this is a parabola, which touches the first
line d1 before the waypoint and the second d2 behind it. When f grows evenly over the time T, A is braked evenly from
the speed 2 d1 / T to standstill while B is accelerated evenly from standstill to 2 d2 / T: position and speed go on
without a jump at both ends.

In Cartesian space positions of the TCP are added. Orientations are chained as R_A R_W^T R_B, all in the base frame:
what is left of the rotation of A, undone, after what has been done of the rotation of B; two rotations about the same
axis become one at the sum of their rates. When a joint move takes part, joint angles are added.

Source: the superposition of two point-to-point motions is textbook (Siciliano et al., Robotics, 4.2.1); that the
controller does it this way is *assumed*.
"""

from __future__ import annotations

from collections.abc import Hashable
from math import hypot

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.jacobian import tcp_twist
from elitescript.kinematics.rotations import Rotation, Vector3, multiply, rotate, transpose
from elitescript.kinematics.transforms import Transform, apply, compose, rotation_of
from elitescript.messages.motion import Six
from elitescript.motion.course import rounded
from elitescript.motion.paths.cartesian import CartesianPath
from elitescript.motion.segment import JointPath, added


class Corner:
    """The corner of two Cartesian paths as poses of the flange; immutable. A `FlangePath`.

    Args:
        first: ends at the waypoint.
        second: begins there.
        d1: length of the first that is replaced, in its own unit.
        d2: the same of the second.
        length: path position at the end of the corner; f is the share of it.
        unit: unit of that: `s` for a blend that takes a time, `m` for a corner of a chain.
        T_flange_tcp: TCP offset.
    """

    __slots__ = (
        "_T_flange_tcp",
        "_d1",
        "_d2",
        "_first",
        "_is_turning",
        "_offset",
        "_second",
        "_to_waypoint",
        "_waypoint",
        "length",
        "unit",
    )

    kind = "blend"

    def __init__(
        self,
        first: CartesianPath,
        second: CartesianPath,
        d1: float,
        d2: float,
        length: float,
        unit: str,
        T_flange_tcp: Transform,
    ) -> None:
        self._first = first
        self._second = second
        self._d1 = d1
        self._d2 = d2
        self.length = length
        self.unit = unit
        self._T_flange_tcp = T_flange_tcp
        self._is_turning = first.turn > 0.0 or second.turn > 0.0
        self._offset: Vector3 = T_flange_tcp[9:12] if self._is_turning else (0.0, 0.0, 0.0)
        T_base_flange = second.flange(0.0)
        self._to_waypoint: Rotation = transpose(rotation_of(T_base_flange))
        self._waypoint: Vector3 = apply(T_base_flange, self._offset)

    @property
    def way(self) -> float:
        """Way of the TCP, m, at most."""
        return self._d1 * self._first.tool_rates[0] + self._d2 * self._second.tool_rates[0]

    @property
    def turn(self) -> float:
        """Angle by which the tool turns, rad, at most."""
        return self._d1 * self._first.tool_rates[1] + self._d2 * self._second.tool_rates[1]

    @property
    def sweep(self) -> float:
        return self.turn

    @property
    def T_base_tcp_end(self) -> Transform:
        return compose(self.flange(self.length), self._T_flange_tcp)

    @property
    def tool_rates(self) -> tuple[float, float]:
        """Bounds of way (m) and rotation (rad) of the tool per unit of path position."""
        one, other = self._first.tool_rates, self._second.tool_rates
        begin, end = 2.0 * self._d1 / self.length, 2.0 * self._d2 / self.length
        return max(begin * one[0], end * other[0]), max(begin * one[1], end * other[1])

    def place(self, s: float) -> str:
        return "in the blend from the start of the move on"

    def flange(self, s: float) -> Transform:
        f = s / self.length
        first, left = self._first, 1.0 - f
        T_first, T_second = first.flange(first.length - self._d1 * left * left), self._second.flange(self._d2 * f * f)
        return self._joined(T_first, T_second)

    def flange_and_slope(self, s: float) -> tuple[Transform, Six]:
        f = s / self.length
        first, left = self._first, 1.0 - f
        rate_first = 2.0 * self._d1 * left / self.length
        rate_second = 2.0 * self._d2 * f / self.length
        T_first, T_second = first.flange(first.length - self._d1 * left * left), self._second.flange(self._d2 * f * f)
        vx, vy, vz, ax, ay, az = first.flange_slope(first.length - self._d1 * left**2, T_first)
        ux, uy, uz, bx, by, bz = self._second.flange_slope(self._d2 * f * f, T_second)
        T_base_flange = self._joined(T_first, T_second)
        if not self._is_turning:
            return T_base_flange, (
                vx * rate_first + ux * rate_second,
                vy * rate_first + uy * rate_second,
                vz * rate_first + uz * rate_second,
                0.0,
                0.0,
                0.0,
            )
        # From the flange to the TCP on either path, and on their sum.
        px, py, pz = rotate(rotation_of(T_first), self._offset)
        ex, ey, ez = rotate(rotation_of(T_second), self._offset)
        rx, ry, rz = rotate(rotation_of(T_base_flange), self._offset)
        undone = multiply(rotation_of(T_first), self._to_waypoint)
        ox, oy, oz = rotate(undone, (bx, by, bz))
        wx, wy, wz = (
            ax * rate_first + ox * rate_second,
            ay * rate_first + oy * rate_second,
            az * rate_first + oz * rate_second,
        )
        return T_base_flange, (
            (vx + ay * pz - az * py) * rate_first + (ux + by * ez - bz * ey) * rate_second - wy * rz + wz * ry,
            (vy + az * px - ax * pz) * rate_first + (uy + bz * ex - bx * ez) * rate_second - wz * rx + wx * rz,
            (vz + ax * py - ay * px) * rate_first + (uz + bx * ey - by * ex) * rate_second - wx * ry + wy * rx,
            wx,
            wy,
            wz,
        )

    def point(self, s: float) -> Vector3:
        """Return the TCP at a path position, base frame, m."""
        return apply(self.flange(s), self._T_flange_tcp[9:12])

    def velocity(self, s: float) -> Vector3:
        """Return the derivative of the TCP by the path position, base frame."""
        T_base_flange, (vx, vy, vz, wx, wy, wz) = self.flange_and_slope(s)
        x, y, z = rotate(rotation_of(T_base_flange), self._T_flange_tcp[9:12])
        return vx + wy * z - wz * y, vy + wz * x - wx * z, vz + wx * y - wy * x

    def _joined(self, T_first: Transform, T_second: Transform) -> Transform:
        x, y, z = self._waypoint
        if not self._is_turning:
            return (
                *rotation_of(T_second),
                T_first[9] + T_second[9] - x,
                T_first[10] + T_second[10] - y,
                T_first[11] + T_second[11] - z,
            )
        ax, ay, az = apply(T_first, self._offset)
        bx, by, bz = apply(T_second, self._offset)
        R = multiply(multiply(rotation_of(T_first), self._to_waypoint), rotation_of(T_second))
        ex, ey, ez = rotate(R, self._offset)
        return (*R, ax + bx - x - ex, ay + by - y - ey, az + bz - z - ez)


class JointCorner:
    """The corner of two paths in joint space; immutable. A `JointPath` over the time of the blend."""

    __slots__ = ("_T_flange_tcp", "_arm", "_d1", "_d2", "_first", "_second", "length")

    kind = "joint"
    unit = "s"

    def __init__(
        self,
        arm: Arm,
        T_flange_tcp: Transform,
        first: JointPath,
        second: JointPath,
        d1: float,
        d2: float,
        duration_s: float,
    ) -> None:
        self._arm = arm
        self._T_flange_tcp = T_flange_tcp
        self._first = first
        self._second = second
        self._d1 = d1
        self._d2 = d2
        self.length = duration_s

    @property
    def q_start(self) -> Six:
        return self.q(0.0)

    @property
    def q_end(self) -> Six:
        return self.q(self.length)

    @property
    def T_base_tcp_end(self) -> Transform:
        return self._arm.forward_tcp(self.q_end, self._T_flange_tcp)

    def q(self, s: float) -> Six:
        f = s / self.length
        first, left = self._first, 1.0 - f
        q_first, q_second = first.q(first.length - self._d1 * left * left), self._second.q(self._d2 * f * f)
        q1, q2, q3, q4, q5, q6 = [a + (b - w) for a, b, w in zip(q_first, q_second, self._second.q_start, strict=True)]
        return q1, q2, q3, q4, q5, q6

    def q_and_slope(self, s: float) -> tuple[Six, Six]:
        f = s / self.length
        first, left = self._first, 1.0 - f
        q_first, slope_first = first.q_and_slope(first.length - self._d1 * left * left)
        q_second, slope_second = self._second.q_and_slope(self._d2 * f * f)
        rate_first, rate_second = 2.0 * self._d1 * left / self.length, 2.0 * self._d2 * f / self.length
        q1, q2, q3, q4, q5, q6 = [a + (b - w) for a, b, w in zip(q_first, q_second, self._second.q_start, strict=True)]
        w1, w2, w3, w4, w5, w6 = [
            a * rate_first + b * rate_second for a, b in zip(slope_first, slope_second, strict=True)
        ]
        return (q1, q2, q3, q4, q5, q6), (w1, w2, w3, w4, w5, w6)

    def turned(self, begin: float, end: float) -> Six | None:
        first, d1, d2 = self._first, self._d1, self._d2
        f, g = begin / self.length, end / self.length
        left = first.turned(first.length - d1 * (1.0 - f) ** 2, first.length - d1 * (1.0 - g) ** 2)
        joined = self._second.turned(d2 * f * f, d2 * g * g)
        return None if left is None or joined is None else added(left, joined)

    @property
    def course(self) -> Hashable | None:
        courses = (self._first.course, self._second.course)
        return None if None in courses else (courses, rounded((self._d1, self._d2, self.length)))

    def tool_rates(self, s: float) -> tuple[float, float]:
        q, qd = self.q_and_slope(s)
        vx, vy, vz, wx, wy, wz = tcp_twist(self._arm, q, qd, self._T_flange_tcp)
        return hypot(vx, vy, vz), hypot(wx, wy, wz)
