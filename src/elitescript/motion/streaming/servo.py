"""Follows a stream of joint targets: `servoj`, one control period at a time.

The law, *assumed* in all its parts (the manual says: mean filter and splines within the look-ahead time):

1. The stream goes in a straight line to each new target within that target's control time, and then holds.
2. The arm follows the mean of the stream over the look-ahead time.
3. A joint that is e behind it goes there at the speed w e, where w is a tenth of the gain, 1/s; far away at the
   speed from which it can still stop there. Behind a steady stream the arm is late by half the look-ahead time
   and 1 / w.
4. No joint exceeds its speed limit or its acceleration limit. Where the stream takes over from another motion, the
   first period uses half of the acceleration, so that it holds across the change too.
5. A pause brings the speed of rule 3 to zero; afterwards it comes back in even steps within 0.2 s.

Without further targets the arm comes to rest at the last one. The speed percentage does not apply.
"""

from __future__ import annotations

from itertools import repeat
from math import exp, sqrt
from operator import sub
from typing import Final

from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX
from elitescript.messages.timing import PERIOD_S
from elitescript.motion.limits import MotionLimits
from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.speed import Obstacle, obstacle_at, range_obstacle
from elitescript.records import NamedTuple

GAIN_PER_S: Final = 10.0
"""Gain for 1/s."""

APPROACH_SHARE: Final = 0.7
"""Share of the acceleration limits with which a far target is approached; the rest is for the stream's own bends."""

EASE_TICKS: Final = 50.0
"""Time, 0.2 s, in which the arm resumes the stream after a pause."""

ARRIVED_RAD: Final = 1e-7
"""Distance at which a joint has reached the end of the stream."""


class ServoState(NamedTuple):
    """State of the arm and of the stream."""

    q: Six
    """rad"""
    qd: Six
    """rad/s"""
    stream: tuple[Six, ...]
    """The stream within the look-ahead time, the newest place last, rad."""
    left: int
    """Ticks until the stream is at its target."""
    is_limited: bool
    """Whether a joint could not follow in this period."""
    ease: float = 0.0
    """Ticks until the arm follows at full gain after a pause."""
    is_taken_over: bool = False
    """Whether another motion lasted until this period."""

    def is_at(self, q_target: Six) -> bool:
        """Return whether stream and arm have arrived."""
        return (
            self.left == 0
            # The oldest place comes there last.
            and self.stream[0] == q_target
            and all(place == q_target for place in self.stream)
            and all(
                abs(q - end) <= ARRIVED_RAD and abs(w) * PERIOD_S <= ARRIVED_RAD
                for q, w, end in zip(self.q, self.qd, q_target, strict=True)
            )
        )


def begun(start: Setpoint) -> ServoState:
    """Return the state from which following begins: the stream is at rest at the position of the arm."""
    return ServoState(start.q, start.qd, (start.q,), 0, False, is_taken_over=start.qd != ZERO_SIX)


def followed(
    state: ServoState, q_target: Six, window: int, gain: float, limits: MotionLimits, *, may_meet: bool = True
) -> ServoState | Obstacle:
    """Return the state one period later, or the joint that cannot stop inside its range.

    Args:
        state: the present one.
        q_target: target of the stream, rad.
        window: look-ahead time in ticks, at least 1.
        gain: 100 to 2000.
        limits: limits of the arm.
        may_meet: False if `may_meet_obstacle` is: then no joint is looked at.
    """
    newest = state.stream[-1]
    if state.left:
        a, b, c, d, e, f = [place + (end - place) / state.left for place, end in zip(newest, q_target, strict=True)]
        newest = (a, b, c, d, e, f) if state.left > 1 else q_target
    before = state.stream
    if len(before) < window:
        before = (before[0],) * (window - len(before)) + before
    stream = (*before[len(before) - window + 1 :], newest)
    rate = (1.0 - exp(-gain / GAIN_PER_S * PERIOD_S)) / PERIOD_S
    square = rate * rate
    speeds = []
    is_limited = False
    # Half of the acceleration in the first period after another motion.
    share = 0.5 if state.is_taken_over else 1.0
    ease = max(0.0, state.ease - 1.0)
    gain_share = 1.0 - ease / EASE_TICKS
    for column, q, w, top, a_top in zip(
        zip(*stream, strict=True), state.q, state.qd, limits.qd_max, limits.qdd_max, strict=True
    ):
        first = column[0]
        if first == column[-1] and column.count(first) == window:
            # Of a joint that stands the sum is zero.
            way = first + 0.0 - q
        else:
            way = first + sum(map(sub, column, repeat(first))) / window - q
        deceleration = APPROACH_SHARE * a_top
        near = deceleration / square
        if -near <= way <= near:
            wanted = rate * way
        elif way > 0.0:
            wanted = sqrt(2.0 * deceleration * (way - 0.5 * near))
        else:
            wanted = -sqrt(2.0 * deceleration * (-way - 0.5 * near))
        if wanted > top:
            wanted = top
            is_limited = True
        elif wanted < -top:
            wanted = -top
            is_limited = True
        wanted *= gain_share
        change = share * a_top * PERIOD_S
        if w - change > wanted:
            wanted = w - change
        speeds.append(w + change if w + change < wanted else wanted)
    w1, w2, w3, w4, w5, w6 = speeds
    qd, left = (w1, w2, w3, w4, w5, w6), state.left - 1 if state.left else 0
    return _next(state, stream, left, qd, is_limited, ease, limits if may_meet else None)


def held(state: ServoState, deceleration: float, limits: MotionLimits) -> ServoState | Obstacle:
    """Return the state one period later while the arm brakes for a pause; the stream waits."""
    change = deceleration * PERIOD_S
    largest = max(map(abs, state.qd))
    if largest <= change:
        return _next(state, state.stream, state.left, ZERO_SIX, False, EASE_TICKS, limits)
    keep = 1.0 - change / largest
    w1, w2, w3, w4, w5, w6 = state.qd
    qd = (w1 * keep, w2 * keep, w3 * keep, w4 * keep, w5 * keep, w6 * keep)
    return _next(state, state.stream, state.left, qd, False, EASE_TICKS - (EASE_TICKS - state.ease) * keep, limits)


def may_meet_obstacle(state: ServoState, limits: MotionLimits) -> bool:
    """Return whether `followed` or `held` may find a joint that cannot stop inside its range.

    False is certain: no joint changes its speed by more than its acceleration limit allows.
    """
    deceleration = min(limits.qdd_max)
    for q, w, low, high, a_top in zip(state.q, state.qd, limits.q_min, limits.q_max, limits.qdd_max, strict=True):
        fastest = abs(w) + a_top * PERIOD_S
        way = fastest * (PERIOD_S + fastest / (2.0 * deceleration))
        if not (low <= q - way and q + way <= high):
            return True
    return False


def _next(
    state: ServoState,
    stream: tuple[Six, ...],
    left: int,
    qd: Six,
    is_limited: bool,
    ease: float,
    limits: MotionLimits | None,
) -> ServoState | Obstacle:
    """Return the state one period later with these speeds, or the obstacle; without limits it meets none."""
    q1, q2, q3, q4, q5, q6 = state.q
    w1, w2, w3, w4, w5, w6 = qd
    q = (
        q1 + w1 * PERIOD_S,
        q2 + w2 * PERIOD_S,
        q3 + w3 * PERIOD_S,
        q4 + w4 * PERIOD_S,
        q5 + w5 * PERIOD_S,
        q6 + w6 * PERIOD_S,
    )
    if limits is None:
        return ServoState(q, qd, stream, left, is_limited, ease)
    joint = obstacle_at(q, qd, min(limits.qdd_max), limits)
    if joint is not None:
        return range_obstacle(limits, joint, state.q, "servoj")
    return ServoState(q, qd, stream, left, is_limited, ease)
