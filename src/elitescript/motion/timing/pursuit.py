"""Catching up with a target that moves at constant speed, and coming to rest, on one coordinate.

The target is `lag` ahead, which grows by `rate`. The lag is brought to exactly zero, at equal speeds, in the least time
that an acceleration and a greatest rate of the lag allow: up to three pieces of constant acceleration, in closed form
(the time-optimal law of the double integrator with a bounded speed, as in textbooks of optimal control). When the
target changes its speed or jumps, a new law begins with the present lag and rate, so that place and speed of the
follower are continuous.
"""

from __future__ import annotations

from math import copysign, sqrt
from typing import Final

from elitescript.records import NamedTuple


class Piece(NamedTuple):
    """A stretch of constant acceleration: state at its beginning."""

    start_s: float
    lag: float
    rate: float
    acceleration: float


class CatchUp:
    """Lag as a function of the time since the law began; immutable.

    Args:
        lag: distance to the target, in the unit of the coordinate; may have either sign.
        rate: its growth per second.
        acceleration: bound of the change of the rate, > 0.
        rate_max: bound of the rate while catching up, > 0; a start above it is brought below it.
    """

    __slots__ = ("_end_acceleration", "_pieces", "duration_s")

    def __init__(self, lag: float, rate: float, acceleration: float, rate_max: float) -> None:
        # The lag at rest, if its rate is braked from now on, gives the sign of the acceleration.
        rest = lag + rate * abs(rate) / (2.0 * acceleration)
        side = copysign(1.0, rest)
        x, w = side * lag, side * rate
        if w >= -rate_max:
            peak = min(sqrt(max(0.0, acceleration * x + 0.5 * w * w)), rate_max)
            push = -acceleration
            swept = (w * w - peak * peak) / (2.0 * acceleration)
        else:
            peak, push = rate_max, acceleration
            swept = (peak * peak - w * w) / (2.0 * acceleration)
        push_s = (w + peak) / -push
        braking = peak * peak / (2.0 * acceleration)
        cruise_s = max(0.0, (x + swept - braking) / peak) if peak else 0.0
        braking_s = peak / acceleration
        self._end_acceleration = side * acceleration
        cruise_at_s, brake_at_s = push_s, push_s + cruise_s
        self._pieces = (
            Piece(0.0, lag, rate, side * push),
            Piece(cruise_at_s, side * (x + swept), -side * peak, 0.0),
            Piece(brake_at_s, side * braking, -side * peak, side * acceleration),
        )
        self.duration_s = brake_at_s + braking_s

    def at(self, t_s: float) -> tuple[float, float]:
        """Return (lag, rate) at a time from 0 on; exactly zero from `duration_s` on."""
        if t_s >= self.duration_s:
            return 0.0, 0.0
        push, cruise, brake = self._pieces
        if t_s >= brake.start_s:
            # Counted from the end, so that it is exactly zero there.
            left_s = self.duration_s - t_s
            return 0.5 * self._end_acceleration * left_s * left_s, -self._end_acceleration * left_s
        piece = push if t_s < cruise.start_s else cruise
        elapsed_s = t_s - piece.start_s
        gained = piece.acceleration * elapsed_s
        return piece.lag + elapsed_s * (piece.rate + 0.5 * gained), piece.rate + gained


def caught_up(lag: float, rate: float, acceleration: float, rate_max: float, gentle_s: float) -> CatchUp:
    """Return the law that catches up in the least time, or with less acceleration within `gentle_s`.

    The first arguments are those of `CatchUp`. A lag of rounding is not made gentler.
    """
    law = CatchUp(lag, rate, acceleration, rate_max)
    if not _SHORTEST * gentle_s < law.duration_s < gentle_s:
        return law
    low, high = acceleration * (law.duration_s / gentle_s) ** 2, acceleration
    for _ in range(_HALVINGS):
        middle = sqrt(low) * sqrt(high)
        gentler = CatchUp(lag, rate, middle, rate_max)
        if gentler.duration_s <= gentle_s:
            law, high = gentler, middle
        else:
            low = middle
    return law


_SHORTEST: Final = 1e-6
"""Share of `gentle_s` below which a lag is rounding."""

_HALVINGS: Final = 12
"""Bisections of the logarithm of the acceleration, for an accuracy better than 1 %."""


class Coast(NamedTuple):
    """Coming to rest with constant deceleration."""

    place: float
    speed: float
    ramp_s: float
    """Time until standstill."""

    def at(self, t_s: float) -> tuple[float, float]:
        """Return (place, speed) at a time from 0 on."""
        if t_s >= self.ramp_s:
            return self.place + 0.5 * self.speed * self.ramp_s, 0.0
        return self.place + self.speed * t_s * (1.0 - 0.5 * t_s / self.ramp_s), self.speed * (1.0 - t_s / self.ramp_s)
