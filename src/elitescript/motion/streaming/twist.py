"""Moves the TCP at a commanded velocity: `speedl`, one control period at a time.

The velocity of the TCP goes linearly to the wanted one, translation and rotation each with its own acceleration.
The joints follow through the inverse Jacobian at their place one period ahead; positions are the trapezoidal sums of
the speeds.

Where a joint would exceed its speed or its acceleration limit, the whole velocity is lowered in proportion, so that the
direction stays. Only where even that is not possible, close to a singularity, the joints keep their limits and the
direction changes. The arm brakes in time to stop in front of a singularity. All of this is *assumed*; the manual does
not mention singularities.
"""

from __future__ import annotations

from math import cos, hypot, sin
from typing import Final

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.jacobian import Singularity, joint_speeds, singularity, tcp_twist
from elitescript.kinematics.transforms import Transform
from elitescript.messages.motion import Six
from elitescript.messages.timing import PERIOD_S
from elitescript.motion.limits import MotionLimits
from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.speed import Obstacle, obstacle_at, range_obstacle
from elitescript.records import NamedTuple
from elitescript.said import said


class TwistState(NamedTuple):
    """State of the arm and target velocity of its TCP."""

    q: Six
    """rad"""
    qd: Six
    """rad/s"""
    twist: Six
    """m/s and rad/s, base frame"""
    is_slowed: bool
    """Whether a joint limit lowered the velocity in this period."""


class ToolMotion(NamedTuple):
    """Constants of a motion of the tool."""

    arm: Arm
    limits: MotionLimits
    T_flange_tcp: Transform
    deceleration: float
    """Of joints at the end of their ranges, rad/s^2."""

    def begin(self, start: Setpoint) -> TwistState:
        """Return the first state of a motion at a velocity."""
        return TwistState(*start, tcp_twist(self.arm, *start, self.T_flange_tcp), False)

    def within_limits(self, twist: Six) -> Six:
        """Return a twist, scaled down in proportion when it is above the tool's limits."""
        limits = self.limits
        linear, turn = hypot(*twist[:3]), hypot(*twist[3:])
        factor = 1.0
        if linear > limits.tool_speed_max:
            factor = limits.tool_speed_max / linear
        if turn * factor > limits.tool_turn_speed_max:
            factor = limits.tool_turn_speed_max / turn
        return twist if factor == 1.0 else _scaled(twist, factor)

    def next(self, state: TwistState, target: Six, a: float, a_rot: float) -> TwistState | Obstacle:
        """Return the state one period later, or the obstacle if none keeps all limits.

        Args:
            state: the present one.
            target: wanted twist.
            a: acceleration of the translation, m/s^2.
            a_rot: acceleration of the rotation, rad/s^2.
        """
        limits = self.limits
        twist = _towards(state.twist, target, a * PERIOD_S, a_rot * PERIOD_S)
        q_ahead = _moved(state.q, state.qd, PERIOD_S)
        blocked = singularity(self.arm, q_ahead).blocked
        wanted = None if blocked else joint_speeds(self.arm, q_ahead, twist, self.T_flange_tcp)
        if wanted is None:
            return singular_obstacle(self.arm, state.q, blocked or "wrist", "speedl")
        least, most = 0.0, 1.0
        for w, w_wanted, top, a_top in zip(state.qd, wanted, limits.qd_max, limits.qdd_max, strict=True):
            if w_wanted:
                change = a_top * PERIOD_S
                if w_wanted > 0.0:
                    along, size = w, w_wanted
                else:
                    along, size = -w, -w_wanted
                if top / size < most:
                    most = top / size
                if (along + change) / size < most:
                    most = (along + change) / size
                if (along - change) / size > least:
                    least = (along - change) / size
        is_slowed = most < 1.0
        if most >= 0.0 and least <= most:
            qd = wanted if most == 1.0 else _scaled(wanted, most)
            twist = twist if most == 1.0 else _scaled(twist, most)
        else:
            factor = min([1.0] + [top / abs(w) for w, top in zip(wanted, limits.qd_max, strict=True) if w])
            qd = _scaled(wanted, factor)
        share = self._share_of_change(state.qd, qd)
        if share < 1.0:
            w1, w2, w3, w4, w5, w6 = [w + share * (w_new - w) for w, w_new in zip(state.qd, qd, strict=True)]
            qd = (w1, w2, w3, w4, w5, w6)
            is_slowed = True
        w1, w2, w3, w4, w5, w6 = state.qd
        v1, v2, v3, v4, v5, v6 = qd
        mean = (0.5 * (w1 + v1), 0.5 * (w2 + v2), 0.5 * (w3 + v3), 0.5 * (w4 + v4), 0.5 * (w5 + v5), 0.5 * (w6 + v6))
        q = _moved(state.q, mean, PERIOD_S)
        joint = obstacle_at(q, qd, self.deceleration, limits)
        if joint is not None:
            return range_obstacle(limits, joint, state.q, "speedl")
        met = self.singularity_met(q, qd)
        if met is not None:
            return singular_obstacle(self.arm, state.q, met, "speedl")
        if share < 1.0:
            twist = tcp_twist(self.arm, q, qd, self.T_flange_tcp)
        return TwistState(q, qd, twist, is_slowed)

    def _share_of_change(self, before: Six, after: Six) -> float:
        """Return the share of a change of speed that keeps the acceleration limits of all joints."""
        share = 1.0
        for w, w_new, a_top in zip(before, after, self.limits.qdd_max, strict=True):
            change = abs(w_new - w)
            if change * share > a_top * PERIOD_S * _ROUNDING:
                share = a_top * PERIOD_S / change
        return share

    def singularity_met(self, q: Six, qd: Six) -> str | None:
        """Return the singularity between a place and the one at which the arm can stop from it, or None."""
        q_stop = _moved(q, qd, 0.5 * max(map(abs, qd)) / self.deceleration)
        here, there = self._distances(q), self._distances(q_stop)
        for name, distance, distance_stop in zip(Singularity._fields, here, there, strict=True):
            if distance * distance_stop <= 0.0 and distance != distance_stop:
                return name
        return Singularity(*map(abs, there)).blocked

    def _distances(self, q: Six) -> tuple[float, float, float]:
        """Return signed measures that are zero at wrist, elbow and shoulder singularity."""
        arm = self.arm
        _, q2, q3, q4, q5, _ = q
        return sin(q5), sin(q3), arm.a2 * cos(q2) + arm.a3 * cos(q2 + q3) + arm.d5 * sin(q2 + q3 + q4)


def singular_obstacle(arm: Arm, q: Six, name: str, what: str) -> Obstacle:
    """Return the obstacle of a motion that comes too near to a singularity.

    Args:
        arm: geometry.
        q: joint angles, rad.
        name: field of `Singularity`.
        what: name of the command that moves them.
    """
    measure = "its distance from it is" if name == "shoulder" else "the sine of its angle is"
    value = getattr(singularity(arm, q), name)
    unit = "m" if name == "shoulder" else ""
    return Obstacle(
        "R112",
        said(
            "{what} leads into the {name} singularity, where joints would have to turn without "
            "limit; {measure} {value}",
            what=what,
            name=name,
            measure=measure,
            value=f"{value:.4f} {unit}".rstrip(),
        ),
        value,
        ">= 0.001",
        unit,
    )


_ROUNDING: Final = 1.0 + 1e-9


def _towards(twist: Six, target: Six, step: float, step_rot: float) -> Six:
    """Return the twist moved towards its target by at most a step of each part, in the end exactly the target."""
    vx, vy, vz = _vector_towards(twist[:3], target[:3], step)
    wx, wy, wz = _vector_towards(twist[3:], target[3:], step_rot)
    return vx, vy, vz, wx, wy, wz


def _vector_towards(
    vector: tuple[float, float, float], target: tuple[float, float, float], step: float
) -> tuple[float, float, float]:
    x, y, z = vector
    dx, dy, dz = target[0] - x, target[1] - y, target[2] - z
    distance = hypot(dx, dy, dz)
    if distance <= step:
        return target
    share = step / distance
    return x + share * dx, y + share * dy, z + share * dz


def _moved(q: Six, qd: Six, time_s: float) -> Six:
    q1, q2, q3, q4, q5, q6 = q
    w1, w2, w3, w4, w5, w6 = qd
    return (
        q1 + w1 * time_s,
        q2 + w2 * time_s,
        q3 + w3 * time_s,
        q4 + w4 * time_s,
        q5 + w5 * time_s,
        q6 + w6 * time_s,
    )


def _scaled(six: Six, factor: float) -> Six:
    a, b, c, d, e, f = six
    return a * factor, b * factor, c * factor, d * factor, e * factor, f * factor
