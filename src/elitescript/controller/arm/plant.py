"""Computes actual joints from target joints: drives with lag and friction.

Each joint is a critically damped second-order system that follows its target r,

    x'' = w^2 (r - x) - 2 w x' - f,    w = 2 / lag

The deceleration f is that of Coulomb and viscous friction; the drive compensates neither. At a constant speed v the
joint is behind by lag * v + f / w^2, at rest it is at the target, and it never overshoots a target that does not turn
back. Over one period the target is taken as a straight line; then the solution is a
closed form that holds for any lag.

Friction holds a standing joint as long as the drive pulls less than its Coulomb part. When the target stands too, the
integral part of the drive takes the rest of the way (*assumed*): the Coulomb part counts only while the target moves.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import copysign, exp
from typing import Final

from elitescript.messages.motion import Six
from elitescript.messages.plant import PlantConfig
from elitescript.messages.state import JointState
from elitescript.messages.timing import PERIOD_S
from elitescript.motion.segment import Setpoint

SETTLED_RAD: Final = 1e-8
SETTLED_RAD_PER_S: Final = 1e-6
"""Limits within which a joint has arrived at a resting target: far below the resolution of an encoder."""


class LaggingJoints:
    """The joints of one arm with lag and friction.

    Args:
        config: with `lag_s` above 0.
        qd_max: largest speed of each joint, rad/s.
    """

    __slots__ = ("_coulomb", "_decay", "_omega", "_per_q", "_per_qd", "_viscous", "is_settled")

    def __init__(self, config: PlantConfig, qd_max: Sequence[float]) -> None:
        self._omega = omega = 2.0 / config.lag_s
        self._decay = decay = exp(-omega * PERIOD_S)
        # What a constant deceleration of 1 rad/s^2 takes from speed and position within a period.
        self._per_qd = PERIOD_S * decay
        self._per_q = (1.0 - (1.0 + omega * PERIOD_S) * decay) / (omega * omega)
        self._coulomb = config.coulomb_friction * config.rated_acceleration
        self._viscous = tuple([config.viscous_friction * config.rated_acceleration / speed for speed in qd_max])
        self.is_settled = True
        """Whether the joints are where the target is and rest there."""

    def peek(self, tick: int, target: Setpoint, now: JointState) -> Setpoint:
        """Return actual positions and speeds of a tick, one after the present one: rad, rad/s."""
        omega, decay, coulomb, per_q, per_qd = self._omega, self._decay, self._coulomb, self._per_q, self._per_qd
        places, speeds = [], []
        for r_now, r_next, rd_next, x, xd, viscous in zip(
            now.q_target, target.q, target.qd, now.q_actual, now.qd_actual, self._viscous, strict=True
        ):
            slope = (r_next - r_now) / PERIOD_S
            stands = slope == 0.0 and rd_next == 0.0
            behind = 2.0 * slope / omega
            start = r_now - x - behind
            rate = slope - xd + omega * start
            left = start + rate * PERIOD_S
            x_next = r_next - behind - left * decay
            xd_next = slope - (rate - omega * left) * decay
            if coulomb > 0.0 and not stands:
                stopping = xd_next / per_qd
                if abs(stopping) <= coulomb:
                    places.append(x if xd == 0.0 else x_next - stopping * per_q)
                    speeds.append(0.0)
                    continue
                friction = copysign(coulomb, stopping)
                x_next -= friction * per_q
                xd_next -= friction * per_qd
            if viscous > 0.0:
                xd_next /= 1.0 + viscous * per_qd
                x_next -= viscous * xd_next * per_q
            if stands and abs(r_next - x_next) < SETTLED_RAD and abs(xd_next) < SETTLED_RAD_PER_S:
                x_next, xd_next = r_next, 0.0
            places.append(x_next)
            speeds.append(xd_next)
        q1, q2, q3, q4, q5, q6 = places
        w1, w2, w3, w4, w5, w6 = speeds
        return Setpoint((q1, q2, q3, q4, q5, q6), (w1, w2, w3, w4, w5, w6))

    def commit(self, tick: int, target: Setpoint, now: JointState) -> None:
        """Advance to that tick."""
        self.is_settled = target.q == now.q_target and not any(target.qd) and self.peek(tick, target, now) == target


def friction_torques(config: PlantConfig, qd: Six, qd_max: Sequence[float], effort_max: Sequence[float]) -> Six:
    """Return the torques that friction asks of the joints, N m, in the direction of their motion; zero at rest."""
    a, b, c, d, e, f = [
        rated * (config.viscous_friction * speed / largest + (copysign(config.coulomb_friction, speed) if speed else 0))
        for speed, largest, rated in zip(qd, qd_max, effort_max, strict=True)
    ]
    return (a, b, c, d, e, f)
