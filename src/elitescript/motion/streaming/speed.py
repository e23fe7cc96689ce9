"""Joint speeds in closed form: `speedj`, and every braking that is not bound to a path.

Each joint changes its speed linearly within its own ramp and then keeps it. A profile begins with the positions and
speeds of any state of the arm, so that neither jumps.

The ends of the joint ranges are kept by a rule without look-ahead: a joint at q with speed w stops at
q + w |w| / (2 d) when it brakes with the deceleration d from now on. As long as that place is inside the range,
the joint can stop inside it; `obstacle_time` is the time at which it would leave it. That an arm brakes in front of the
end of a range, and with which deceleration, is *assumed*.
"""

from __future__ import annotations

from collections.abc import Callable
from math import degrees, inf, sqrt
from typing import Final

from elitescript.errors import MotionError
from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX
from elitescript.motion.limits import JOINT_NAMES, MotionLimits
from elitescript.motion.segment import Setpoint
from elitescript.records import NamedTuple
from elitescript.said import said

RANGE_ROUNDING_RAD: Final = 1e-12
"""Distance outside the range at which a stopping place is outside by rounding."""


class Obstacle(NamedTuple):
    """Why a motion at a commanded speed cannot go on."""

    code: str
    text: str
    value: float
    limit: str
    unit: str
    joint: int = -1
    """Index of the joint at the end of its range; -1 for a singularity."""

    def error(self) -> MotionError:
        """Return the refusal of a motion with the obstacle at its begin."""
        return MotionError(
            self.text,
            code=self.code,
            value=self.value,
            limit=self.limit,
            unit=self.unit,
            hint="move the other way, or away from there with movej",
        )


class SpeedProfile:
    """Joint targets as a function of the time since its start; immutable.

    Args:
        start: state at its beginning.
        qd_end: speeds at the end of the ramps, rad/s, which are kept.
        ramps_s: time that each joint takes.
    """

    __slots__ = ("duration_s", "qd_end", "ramps_s", "start")

    def __init__(self, start: Setpoint, qd_end: Six, ramps_s: Six) -> None:
        self.start = start
        self.qd_end = qd_end
        self.ramps_s = ramps_s
        self.duration_s = max(ramps_s)

    def at(self, t_s: float) -> Setpoint:
        """Return joint angles, rad, and speeds, rad/s, at a time from 0 on."""
        q1, q2, q3, q4, q5, q6 = [
            q + (0.5 * (w + w_end) * ramp_s + w_end * (t_s - ramp_s))
            if t_s >= ramp_s
            else q + t_s * (w + 0.5 * (w_end - w) * (t_s / ramp_s))
            for q, w, w_end, ramp_s in zip(*self.start, self.qd_end, self.ramps_s, strict=True)
        ]
        w1, w2, w3, w4, w5, w6 = [
            w_end if t_s >= ramp_s else w + (w_end - w) * (t_s / ramp_s)
            for w, w_end, ramp_s in zip(self.start.qd, self.qd_end, self.ramps_s, strict=True)
        ]
        return Setpoint((q1, q2, q3, q4, q5, q6), (w1, w2, w3, w4, w5, w6))


def within_speed_limits(qd: Six, limits: MotionLimits) -> Six:
    """Return qd, rad/s, scaled down in proportion when a joint cannot turn so fast."""
    factor = min([1.0] + [top / abs(w) for w, top in zip(qd, limits.qd_max, strict=True) if w])
    if factor == 1.0:
        return qd
    a, b, c, d, e, f = qd
    return a * factor, b * factor, c * factor, d * factor, e * factor, f * factor


def accelerated(start: Setpoint, qd_target: Six, a: float, limits: MotionLimits) -> SpeedProfile:
    """Return the profile of `speedj`: all joints reach their speeds together.

    Args:
        start: any state.
        qd_target: speeds, rad/s, within the limits.
        a: acceleration of the joint whose speed changes most, rad/s^2; no joint exceeds its limit.
        limits: limits of the arm.
    """
    changes = [abs(b - a) for a, b in zip(start.qd, qd_target, strict=True)]
    ramp_s = max(change / min(a, top) for change, top in zip(changes, limits.qdd_max, strict=True))
    return SpeedProfile(start, qd_target, (ramp_s,) * 6)


def braked(start: Setpoint, ramp_s: float, limits: MotionLimits) -> SpeedProfile:
    """Return the profile that brings all joints to rest in proportion, within a time.

    A joint brakes sooner where it would leave its range, and later where it cannot brake so hard.
    """
    return _braked(start, lambda w: ramp_s, limits)


def braked_apart(start: Setpoint, deceleration: float, limits: MotionLimits) -> SpeedProfile:
    """Return the profile that brakes each joint by itself, rad/s^2; as far as possible none leaves its range."""
    return _braked(start, lambda w: abs(w) / deceleration, limits)


def halted(start: Setpoint, obstacle: Obstacle | None, deceleration: float, limits: MotionLimits) -> SpeedProfile:
    """Return the profile of a stop with a deceleration, rad/s^2: in front of an obstacle, or anywhere."""
    if obstacle is not None and obstacle.joint >= 0:
        return braked_apart(start, deceleration, limits)
    return braked(start, max(map(abs, start.qd)) / deceleration, limits)


def _braked(start: Setpoint, ramp_of: Callable[[float], float], limits: MotionLimits) -> SpeedProfile:
    ramps_s = []
    for q, w, low, high, top in zip(*start, limits.q_min, limits.q_max, limits.qdd_max, strict=True):
        if w == 0.0:
            ramps_s.append(0.0)
            continue
        room = high - q if w > 0.0 else q - low
        ramps_s.append(max(0.0, min(max(ramp_of(w), abs(w) / top), 2.0 * room / abs(w))))
    a, b, c, d, e, f = ramps_s
    return SpeedProfile(start, ZERO_SIX, (a, b, c, d, e, f))


def obstacle_at(q: Six, qd: Six, deceleration: float, limits: MotionLimits) -> int | None:
    """Return the first joint that can no more stop inside its range with a deceleration, or None."""
    twice = 2.0 * deceleration
    for joint, (angle, w, low, high) in enumerate(zip(q, qd, limits.q_min, limits.q_max, strict=True)):
        if w > 0.0:
            if angle + w * w / twice > high + RANGE_ROUNDING_RAD:
                return joint
        elif w < 0.0 and angle - w * w / twice < low - RANGE_ROUNDING_RAD:
            return joint
    return None


def obstacle_time(profile: SpeedProfile, deceleration: float, limits: MotionLimits) -> tuple[float, int]:
    """Return the time from which a joint can no more stop inside its range, inf if never, and the joint."""
    first_s, first = inf, -1
    rows = zip(*profile.start, profile.qd_end, profile.ramps_s, limits.q_min, limits.q_max, strict=True)
    for joint, (q, w, w_end, ramp_s, low, high) in enumerate(rows):
        time_s = min(
            _crossing(q - high, w, w_end, ramp_s, deceleration),
            _crossing(low - q, -w, -w_end, ramp_s, deceleration),
        )
        if time_s < first_s:
            first_s, first = time_s, joint
    return first_s, first


def range_obstacle(limits: MotionLimits, joint: int, q: Six, what: str) -> Obstacle:
    """Return the obstacle of a joint that reaches the end of its range.

    Args:
        limits: limits of the arm.
        joint: its index.
        q: joint angles, rad.
        what: name of the command that moves them.
    """
    low, high = limits.q_min[joint], limits.q_max[joint]
    angle = q[joint]
    return Obstacle(
        "R110",
        said(
            "{what} takes joint {joint}, at {angle:.4f} rad ({angle_deg:.1f} deg), to the end of its "
            "range of {low:.4f} to {high:.4f} rad ({low_deg:.1f} to {high_deg:.1f} deg)",
            what=what,
            joint=JOINT_NAMES[joint],
            angle=angle,
            angle_deg=degrees(angle),
            low=low,
            high=high,
            low_deg=degrees(low),
            high_deg=degrees(high),
        ),
        angle,
        f"[{low:.6g}, {high:.6g}]",
        "rad",
        joint,
    )


def _crossing(x: float, w: float, w_end: float, ramp_s: float, d: float) -> float:
    """Return the first time at which x + w^2 / (2 d) exceeds 0 while w > 0; x is negative inside the range."""
    if w <= 0.0 and w_end <= 0.0:
        return inf
    if ramp_s > 0.0:
        slope = (w_end - w) / ramp_s
        begin_s = -w / slope if w < 0.0 else 0.0
        end_s = -w / slope if w_end < 0.0 else ramp_s
        # x + w t + slope t^2 / 2 + (w + slope t)^2 / (2 d) as a quadratic in t
        a = 0.5 * slope + slope * slope / (2.0 * d)
        b = w + w * slope / d
        c = x + w * w / (2.0 * d)
        if c + begin_s * (b + a * begin_s) > RANGE_ROUNDING_RAD:
            return begin_s
        for root in _roots(a, b, c):
            if begin_s <= root <= end_s and 2.0 * a * root + b >= 0.0:
                return root
    if w_end <= 0.0:
        return inf
    room = -(x + 0.5 * (w + w_end) * ramp_s + w_end * w_end / (2.0 * d))
    return ramp_s + max(0.0, room / w_end)


def _roots(a: float, b: float, c: float) -> tuple[float, ...]:
    """Return the real roots of a t^2 + b t + c, the smaller first, in the form that does not cancel."""
    if a == 0.0:
        return (-c / b,) if b else ()
    discriminant = b * b - 4.0 * a * c
    if discriminant < 0.0:
        return ()
    half = -0.5 * (b + sqrt(discriminant)) if b >= 0.0 else -0.5 * (b - sqrt(discriminant))
    roots = (half / a, c / half) if half else (0.0,)
    return tuple(sorted(roots))
