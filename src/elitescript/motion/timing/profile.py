"""Time laws: the path position s as a function of time.

A profile ends at rest and is made of pieces of constant acceleration. It starts at rest too, or, for
a path that is entered by a blend, at a position and with a speed. The trapezoid (accelerate, keep the
speed, brake) has three pieces, or two when the path is too short to reach the speed; a path that has
to be slowed down in places has more.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Hashable, Iterable, Sequence
from math import inf, sqrt
from typing import Final

from elitescript.errors import InternalError
from elitescript.motion.course import rounded
from elitescript.records import NamedTuple

RAMP_SHARE: Final = 1.0 / 3.0
"""Share of a prescribed duration of each of the two ramps (*assumed*: the manual only says that
speed and acceleration are then ignored). With a third the peak speed is 1.5 L/t and the
acceleration 4.5 L/t^2."""


class Law(NamedTuple):
    """Limits of a time law, in the unit of its path per s and s^2."""

    v: float
    """Speed."""
    a: float
    """Acceleration."""
    brake: float
    """Deceleration; less than `a` where a blend is to follow."""


class TimeLaw:
    """s(t) from `start` to `length` in `duration_s`, at rest at the end; immutable.

    `length` is in the path's own unit (m or rad), speeds and accelerations in that unit per s
    and s^2.
    """

    __slots__ = ("_acceleration", "_position", "_speed", "_start_s", "duration_s", "length", "peak_speed", "start")

    def __init__(
        self,
        length: float,
        duration_s: float,
        start_s: Sequence[float],
        position: Sequence[float],
        speed: Sequence[float],
        acceleration: Sequence[float],
    ) -> None:
        """Take the pieces: time, position and speed at the start of each, and its acceleration."""
        self.length = length
        self.duration_s = duration_s
        self.start = position[0]
        self.peak_speed = max(speed)
        self._start_s = tuple(start_s)
        self._position = tuple(position)
        self._speed = tuple(speed)
        self._acceleration = tuple(acceleration)

    @property
    def course(self) -> Hashable:
        """What positions and speeds follow from, but for rounding."""
        pieces = (*self._start_s, *self._position, *self._speed, *self._acceleration)
        return rounded((self.length, self.duration_s, *pieces))

    def at(self, t_s: float) -> tuple[float, float]:
        """Return (position, speed) at a time; before the start those of the start, after the end those at rest."""
        if t_s <= 0.0:
            return self._position[0], self._speed[0]
        if t_s >= self.duration_s:
            return self.length, 0.0
        piece = bisect_right(self._start_s, t_s) - 1
        elapsed_s = t_s - self._start_s[piece]
        gained = self._acceleration[piece] * elapsed_s
        speed = self._speed[piece]
        position = self._position[piece] + elapsed_s * (speed + 0.5 * gained)
        # Rounding in the last piece must not overshoot or reverse.
        return (position if position < self.length else self.length), (speed + gained if speed + gained > 0.0 else 0.0)

    def at_times(self, times_s: Iterable[float]) -> list[tuple[float, float]]:
        """Return what `at` returns, for many times; quickest when they rise."""
        found: list[tuple[float, float]] = []
        length, begin_s, end_s = self.length, inf, inf
        first = speed = acceleration = 0.0
        for t_s in times_s:
            if not begin_s < t_s < end_s:
                if t_s <= 0.0 or t_s >= self.duration_s:
                    found.append(self.at(t_s))
                    continue
                piece = bisect_right(self._start_s, t_s) - 1
                begin_s = self._start_s[piece]
                end_s = min([*self._start_s[piece + 1 : piece + 2], self.duration_s])
                first, speed, acceleration = self._position[piece], self._speed[piece], self._acceleration[piece]
            elapsed_s = t_s - begin_s
            gained = acceleration * elapsed_s
            position, ahead = first + elapsed_s * (speed + 0.5 * gained), speed + gained
            found.append((position if position < length else length, ahead if ahead > 0.0 else 0.0))
        return found

    def acceleration(self, t_s: float) -> float:
        """Return the acceleration at a time; at a corner that of the piece that begins, 0 at rest."""
        if t_s < 0.0 or t_s >= self.duration_s:
            return 0.0
        return self._acceleration[bisect_right(self._start_s, t_s) - 1]

    def speed_at_position(self, position: float) -> float:
        """Return the speed with which a position is passed; 0 outside the path."""
        if not self.start <= position <= self.length:
            return 0.0
        piece = bisect_right(self._position, position) - 1
        speed = self._speed[piece]
        return sqrt(max(0.0, speed * speed + 2.0 * self._acceleration[piece] * (position - self._position[piece])))

    def time_at(self, position: float) -> float:
        """Return the time at which a position is passed; that of the nearer end outside the path."""
        if position <= self.start:
            return 0.0
        if position >= self.length:
            return self.duration_s
        piece = bisect_right(self._position, position) - 1
        way = position - self._position[piece]
        speed = self._speed[piece]
        # In the form that does not cancel.
        speed_there = sqrt(max(0.0, speed * speed + 2.0 * self._acceleration[piece] * way))
        return min(self._start_s[piece] + (2.0 * way / (speed + speed_there) if way else 0.0), self.duration_s)

    @property
    def last_brake_s(self) -> float:
        """Time from which on it only brakes."""
        for piece in range(len(self._acceleration) - 1, -1, -1):
            if self._acceleration[piece] >= 0.0:
                return self._start_s[piece + 1] if piece + 1 < len(self._start_s) else self.duration_s
        return 0.0

    @property
    def corners(self) -> tuple[float, ...]:
        """Positions at which the acceleration changes, without start and end."""
        return self._position[1:]

    def followed_by(self, other: TimeLaw) -> TimeLaw:
        """Return this motion followed, from rest, by another one, whose positions continue from its end."""
        return TimeLaw(
            self.length + other.length,
            self.duration_s + other.duration_s,
            [*self._start_s, *(self.duration_s + start for start in other._start_s)],
            [*self._position, *(self.length + position for position in other._position)],
            [*self._speed, *other._speed],
            [*self._acceleration, *other._acceleration],
        )

    def stretched(self, duration_s: float) -> TimeLaw:
        """Return the same motion, slower throughout, in a longer time."""
        if duration_s < self.duration_s:
            raise InternalError(f"a profile of {self.duration_s} s cannot be stretched to {duration_s} s")
        if self.duration_s == 0.0:
            return self
        rate = self.duration_s / duration_s
        return TimeLaw(
            self.length,
            duration_s,
            [start / rate for start in self._start_s],
            self._position,
            [speed * rate for speed in self._speed],
            [acceleration * rate * rate for acceleration in self._acceleration],
        )


def resting(duration_s: float = 0.0) -> TimeLaw:
    """Return the profile of a path without length."""
    return TimeLaw(0.0, duration_s, (0.0,), (0.0,), (0.0,), (0.0,))


def trapezoid(length: float, v: float, a: float) -> TimeLaw:
    """Return the quickest profile for a length under a speed v and an acceleration a.

    The duration is `length / v + v / a` when the speed is reached, else `2 sqrt(length / a)`.
    """
    if length == 0.0:
        return resting()
    ramp = 0.5 * v * v / a
    if 2.0 * ramp >= length:
        half_s = sqrt(length / a)
        return TimeLaw(length, 2.0 * half_s, (0.0, half_s), (0.0, 0.5 * length), (0.0, a * half_s), (a, -a))
    ramp_s = v / a
    cruise_s = length / v - ramp_s
    return TimeLaw(
        length,
        2.0 * ramp_s + cruise_s,
        (0.0, ramp_s, ramp_s + cruise_s),
        (0.0, ramp, length - ramp),
        (0.0, v, v),
        (a, 0.0, -a),
    )


def trapezoid_of(length: float, law: Law, start: float = 0.0, v_start: float = 0.0) -> TimeLaw:
    """Return the quickest profile under a law whose ramps may differ, from a position and a speed on.

    A start faster than `law.v` brakes to it first.

    Raises:
        InternalError: the rest of the path is too short to brake from the start.
    """
    if length == start:
        return resting() if length == 0.0 else TimeLaw(length, 0.0, (0.0,), (length,), (0.0,), (0.0,))
    if law.a == law.brake and v_start == start == 0.0:
        return trapezoid(length, law.v, law.a)
    v, a, brake = law
    way, x_start = length - start, v_start * v_start
    stopping = 0.5 * x_start / brake
    if stopping > way * (1.0 + _ROUNDING):
        raise InternalError(f"{v_start} at {start} is too fast to stop at {length} with {brake}")
    if v_start > v:
        v_top, first_a, first = v, -brake, min(0.5 * (x_start - v * v) / brake, way)
    else:
        v_top = max(v_start, min(v, sqrt((way + 0.5 * x_start / a) / (0.5 / a + 0.5 / brake))))
        first_a, first = a, min(0.5 * (v_top * v_top - x_start) / a, way)
    last = min(0.5 * v_top * v_top / brake, way - first)
    cruise = way - first - last
    start_s, position, speed, acceleration = [], [], [], []
    t_s, s = 0.0, start
    for ramp, v_here, v_ahead, u in (
        (first, v_start, v_top, first_a),
        (cruise, v_top, v_top, 0.0),
        (last, v_top, 0.0, -brake),
    ):
        if ramp > _ROUNDING * way:
            start_s.append(t_s)
            position.append(s)
            speed.append(v_here)
            acceleration.append(u)
            t_s += 2.0 * ramp / (v_here + v_ahead)
            s += ramp
    return TimeLaw(length, t_s, start_s, position, speed, acceleration)


def trapezoid_of_duration(length: float, law: Law, duration_s: float, start: float, v_start: float) -> TimeLaw | None:
    """Return a profile of a duration from a position and a speed on, or None when the law does not allow it.

    It has the ramps of the law; the speed between them is lowered.
    """
    quickest = trapezoid_of(length, law, start, v_start)
    if quickest.duration_s > duration_s:
        return None
    low, high = 0.0, law.v
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if trapezoid_of(length, law._replace(v=middle), start, v_start).duration_s > duration_s:
            low = middle
        else:
            high = middle
    slowest = trapezoid_of(length, law._replace(v=high), start, v_start)
    # A profile that brakes all the way from its start cannot take longer.
    return slowest if slowest.duration_s >= duration_s * (1.0 - _SAME_DURATION) else None


_ROUNDING: Final = 1e-12
"""Share of the path below which two lengths differ by rounding."""

_SAME_DURATION: Final = 1e-6

_HALVINGS: Final = 50


def trapezoid_lasting(length: float, duration_s: float, v_max: float, a_max: float) -> TimeLaw | None:
    """Return a trapezoid of exactly this duration, or None when the limits do not allow it.

    Each ramp takes `RAMP_SHARE` of the time. Where that would pass the speed limit the ramps get
    shorter, where it would pass the acceleration limit they get longer.
    """
    if length == 0.0:
        return resting(duration_s)
    mean = length / duration_s
    # Ramps of a share f each give the speed mean / (1 - f) and the acceleration mean / (duration f (1 - f)).
    least_product = mean / (duration_s * a_max)
    longest_share = 1.0 - mean / v_max
    if least_product > 0.25 or longest_share <= 0.0:
        return None
    shortest_share = 0.5 - sqrt(0.25 - least_product)
    share = min(max(RAMP_SHARE, shortest_share), longest_share)
    if share < shortest_share:
        return None
    v = mean / (1.0 - share)
    ramp_s = share * duration_s
    ramp = 0.5 * v * ramp_s
    a = v / ramp_s
    return TimeLaw(
        length,
        duration_s,
        (0.0, ramp_s, duration_s - ramp_s),
        (0.0, ramp, length - ramp),
        (0.0, v, v),
        (a, 0.0, -a),
    )
