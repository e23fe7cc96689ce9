"""Motion with a given part and a part that yields, one control period at a time: force control, hand guiding.

The given part (`bound`) is kept exactly: its pose is solved by Newton's method in every period, so that no error
accumulates. The part that yields changes its speed towards a wanted one, within the limits of joint speed and
acceleration. Where even the given part exceeds them, or where the joints of the given pose are further from those that
their speeds lead to than an acceleration explains, the joints keep their limits and the tool deviates.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.jacobian import joint_speeds, singularity, tcp_twist
from elitescript.kinematics.rotations import multiply, rotation_from_rotvec, rotvec_from_rotation, transpose
from elitescript.kinematics.transforms import Transform, position_of, rotation_of
from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX
from elitescript.messages.timing import PERIOD_S
from elitescript.motion.limits import RANGE_TOLERANCE_RAD, joint_outside
from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.speed import Obstacle, range_obstacle
from elitescript.motion.streaming.twist import ToolMotion, singular_obstacle
from elitescript.records import NamedTuple

_NEWTON_STEPS: Final = 3
"""The first guess is some 1e-6 m away, and each step squares what is left."""

_ROUNDING: Final = 1.0 + 1e-9


class Yielded(NamedTuple):
    """State of the arm after a period in which it yielded."""

    setpoint: Setpoint
    free: Six
    """Velocity of the part that yields, m/s and rad/s, base frame."""
    is_bound_kept: bool
    """Whether the joints could follow the given part."""


class Compliance(NamedTuple):
    """Constants of a yielding motion."""

    tool: ToolMotion
    what: str
    """Name of the command, for messages."""

    def next(
        self,
        now: Setpoint,
        bound: Six,
        bound_way: Six,
        free: Six,
        wanted: Six,
        *,
        deceleration: float | None = None,
        is_last_resort: bool = False,
    ) -> Yielded | Obstacle:
        """Return the state one period later, or the obstacle if the arm could not stop from any.

        Args:
            now: joints of the present tick.
            bound: given part of the twist at the next tick, base frame.
            bound_way: its way until then: translation, m, and rotation vector, rad, base frame.
            free: present velocity of the part that yields.
            wanted: velocity that it is to have.
            deceleration: of the joint that has to change most on the way there, rad/s^2; None for as quickly as the
                joints can.
            is_last_resort: leave out the check that the arm can still stop, because it brakes as hard as it can.
        """
        tool = self.tool
        arm, limits, T_flange_tcp = tool.arm, tool.limits, tool.T_flange_tcp
        q_ahead = _sum(now.q, now.qd, PERIOD_S)
        blocked = singularity(arm, q_ahead).blocked
        kept = None if blocked else joint_speeds(arm, q_ahead, _sum(bound, free), T_flange_tcp)
        if kept is None:
            return singular_obstacle(arm, now.q, blocked or "wrist", self.what)
        if deceleration is not None:
            wanted = self.nearer(q_ahead, free, wanted, deceleration)
        change = joint_speeds(arm, q_ahead, _sum(wanted, free, -1.0), T_flange_tcp)
        assert change is not None, "solved for the same joints above"
        share = self._share(now.qd, kept, change)
        is_kept, free_after = share is not None, free
        if share is None:
            q, qd = self._given_way(now, _sum(kept, change))
        else:
            qd = _sum(kept, change, share)
            free_after = wanted if share == 1.0 else _sum(free, _sum(wanted, free, -1.0), share)
            way = _sum(bound_way, _sum(free, free_after), 0.5 * PERIOD_S)
            if way == ZERO_SIX:
                q = now.q
            else:
                guess = _sum(now.q, _sum(now.qd, qd), 0.5 * PERIOD_S)
                q = solved_near(arm, T_flange_tcp, after_way(arm.forward_tcp(now.q, T_flange_tcp), way), guess)
                # Near a singularity a pose some 1e-6 m away can be milliradians away.
                if not self._is_reached(guess, q):
                    q, is_kept = guess, False
        if not is_kept:
            free_after = _sum(tcp_twist(arm, q, qd, T_flange_tcp), bound, -1.0)
        # A stop changes all joints in proportion, so this is the longest way to standstill.
        q_stop = q if is_last_resort else _sum(q, qd, 0.5 * max(map(abs, qd)) / tool.deceleration)
        joint = joint_outside(limits, q_stop)
        if joint is not None:
            return range_obstacle(limits, joint, now.q, self.what)
        met = None if is_last_resort else tool.singularity_met(q, qd)
        if met is not None:
            return singular_obstacle(arm, now.q, met, self.what)
        return Yielded(Setpoint(q, qd), free_after, is_kept)

    def halted(self, now: Setpoint) -> Setpoint:
        """Return the state one period later when every joint brakes by itself."""
        step = self.tool.deceleration * PERIOD_S
        limits = self.tool.limits
        speeds, places = [], []
        for q, w, low, high in zip(*now, limits.q_min, limits.q_max, strict=True):
            after = max(0.0, w - step) if w > 0.0 else min(0.0, w + step)
            place = q + 0.5 * PERIOD_S * (w + after)
            is_outside = not low - RANGE_TOLERANCE_RAD <= place <= high + RANGE_TOLERANCE_RAD
            speeds.append(0.0 if is_outside else after)
            places.append(q if is_outside else place)
        return Setpoint(_six(places), _six(speeds))

    def nearer(self, q: Six, free: Six, wanted: Six, deceleration: float) -> Six:
        """Return a velocity on the way to the wanted one; all joints arrive with the one that has to change most."""
        change = _sum(wanted, free, -1.0)
        qd = joint_speeds(self.tool.arm, q, change, self.tool.T_flange_tcp)
        top = 0.0 if qd is None else max(map(abs, qd))
        step = deceleration * PERIOD_S
        return wanted if top <= step else _sum(free, change, step / top)

    def _share(self, before: Six, kept: Six, change: Six) -> float | None:
        """Return the greatest share of a change that keeps the joints' limits; None when no share does."""
        limits = self.tool.limits
        least, most = 0.0, 1.0
        for w, w_kept, w_change, top, a_top in zip(before, kept, change, limits.qd_max, limits.qdd_max, strict=True):
            low = max(-top, w - a_top * PERIOD_S * _ROUNDING) - w_kept
            high = min(top, w + a_top * PERIOD_S * _ROUNDING) - w_kept
            if w_change > 0.0:
                least, most = max(least, low / w_change), min(most, high / w_change)
            elif w_change < 0.0:
                least, most = max(least, high / w_change), min(most, low / w_change)
            elif low > 0.0 or high < 0.0:
                return None
        return most if least <= most else None

    def _is_reached(self, guess: Six, q: Six) -> bool:
        """Return whether joints are where the speeds of a period lead to, but for what an acceleration explains."""
        tops = self.tool.limits.qdd_max
        return all(abs(b - a) <= 0.5 * top * PERIOD_S**2 for a, b, top in zip(guess, q, tops, strict=True))

    def _given_way(self, now: Setpoint, wanted: Six) -> Setpoint:
        limits = self.tool.limits
        speeds = []
        for w, w_wanted, top, a_top in zip(now.qd, wanted, limits.qd_max, limits.qdd_max, strict=True):
            low, high = max(-top, w - a_top * PERIOD_S), min(top, w + a_top * PERIOD_S)
            speeds.append(max(low, min(high, w_wanted)))
        qd = _six(speeds)
        return Setpoint(_sum(now.q, _sum(now.qd, qd), 0.5 * PERIOD_S), qd)


def after_way(T_base_tcp: Transform, way: Six) -> Transform:
    """Return a pose moved by a translation, m, and turned by a rotation vector, rad, both of the base frame."""
    x, y, z = position_of(T_base_tcp)
    R = multiply(rotation_from_rotvec(way[3:]), rotation_of(T_base_tcp))
    return (*R, x + way[0], y + way[1], z + way[2])


def way_between(T_base_from: Transform, T_base_to: Transform) -> Six:
    """Return translation, m, and rotation vector, rad, base frame, that lead from one pose to another."""
    (ax, ay, az), (bx, by, bz) = position_of(T_base_from), position_of(T_base_to)
    turn = rotvec_from_rotation(multiply(rotation_of(T_base_to), transpose(rotation_of(T_base_from))))
    return (bx - ax, by - ay, bz - az, *turn)


def solved_near(arm: Arm, T_flange_tcp: Transform, T_base_tcp: Transform, q: Six) -> Six:
    """Return the joint angles of a pose very near to that of q, by Newton's method."""
    for _ in range(_NEWTON_STEPS):
        step = joint_speeds(arm, q, way_between(arm.forward_tcp(q, T_flange_tcp), T_base_tcp), T_flange_tcp)
        if step is None:
            return q
        q = _sum(q, step)
    return q


def _sum(one: Sequence[float], other: Sequence[float], factor: float = 1.0) -> Six:
    a, b, c, d, e, f = [x + factor * y for x, y in zip(one, other, strict=True)]
    return (a, b, c, d, e, f)


def _six(values: Sequence[float]) -> Six:
    a, b, c, d, e, f = values
    return (a, b, c, d, e, f)
