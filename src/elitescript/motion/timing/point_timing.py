"""Time law of a file, s(t), for a path of joint positions over its own time s.

The rate s' is 1 wherever the joints can follow, so that the points are played at their interval. It is lower in
three cases, and never higher:

- where the path begins or ends with a speed, from and to 0 there;
- in intervals in which a joint would turn faster than it can, so low that it does not;
- in intervals in which a joint would be accelerated harder than it can, likewise.

With x = s'^2 a joint has the speed q' sqrt(x) and the acceleration q' s'' + q'' x. In each interval x has a ceiling
from the bounds of |q'| and |q''| in it; the rest of the acceleration limit is for changes of x. A pass
backwards and a pass forwards then connect the intervals, as in `retiming`; because every bound holds for the whole of
an interval, no limit is passed between the points either.
"""

from __future__ import annotations

from math import sqrt
from typing import Final

from elitescript.motion.limits import MotionLimits
from elitescript.motion.paths.spline import JointSpline
from elitescript.motion.timing.profile import TimeLaw
from elitescript.records import NamedTuple

CURVATURE_SHARE: Final = 0.9
"""Share of a joint's acceleration limit that the points themselves may use (*assumed*). The rest is for slowing down
before places that use it up."""

NOTEWORTHY: Final = 0.01
"""Fall of the rate up to which it needs no note."""

_CHANGE_MAX: Final = 1e6
"""Largest change of the rate, 1/s, while the joints stand still."""

_NO_WAY: Final = 1e-12
"""Share of its interval below which a piece is rounding."""


class TooFast(NamedTuple):
    """The interval that is slowed down most."""

    interval: int
    """From 0; it begins at the point of that number, counted from 0."""
    joint: int
    rate: float
    """Rate at which it is played."""
    is_speed: bool
    """Whether the speed of the joint is too high, not its acceleration."""


class PointTiming(NamedTuple):
    """The time law of a file."""

    profile: TimeLaw
    too_fast: TooFast | None


def paced(spline: JointSpline, limits: MotionLimits) -> PointTiming:
    """Return the fastest time law that does not overtake the file and keeps the joint limits."""
    count = spline.intervals
    share = [CURVATURE_SHARE * limit for limit in limits.qdd_max]
    excess = spline.excess(limits.qd_max, (share[0], share[1], share[2], share[3], share[4], share[5]))
    ceiling = [1.0] * count
    for interval, (_, speed, acceleration) in excess.items():
        ceiling[interval] = min(1.0 / max(1.0, speed * speed), 1.0 / max(1.0, acceleration))
    x = [1.0] * (count + 1)
    x[0] = ceiling[0] if spline.is_start_at_rest else 0.0
    x[count] = ceiling[-1] if spline.is_end_at_rest else 0.0
    for interval, top in enumerate(ceiling):
        if top < 1.0:
            x[interval] = min(x[interval], top)
            x[interval + 1] = min(x[interval + 1], top)
    way = 2.0 * spline.interval_s
    changes: dict[int, float] = {}

    def change(interval: int) -> float:
        """Return the largest |s''| in an interval, 1/s."""
        found = changes.get(interval)
        if found is None:
            found = changes[interval] = _change(spline, limits, interval, ceiling[interval])
        return found

    for interval in range(count - 1, -1, -1):
        if x[interval] > x[interval + 1]:
            x[interval] = min(x[interval], x[interval + 1] + way * change(interval))
    for interval in range(count):
        if x[interval + 1] > x[interval]:
            x[interval + 1] = min(x[interval + 1], x[interval] + way * change(interval))
    pieces = _Pieces()
    even = 0
    for interval, (x_a, top, x_b) in enumerate(zip(x, ceiling, x[1:], strict=False)):
        if x_a == top == x_b:
            even += 1
            continue
        s_a, s_b = interval * spline.interval_s, (interval + 1) * spline.interval_s
        if even:
            pieces.add((interval - even) * spline.interval_s, s_a, x_a, x_a, 0.0)
            even = 0
        u = change(interval)
        peak = min(top, 0.5 * (x_a + x_b) + u * spline.interval_s)
        rise, fall = 0.5 * (peak - x_a) / u, 0.5 * (peak - x_b) / u
        least = _NO_WAY * spline.interval_s
        if rise > least:
            pieces.add(s_a, s_a + rise, x_a, peak, u)
        if s_b - fall - s_a - rise > least:
            pieces.add(s_a + rise, s_b - fall, peak, peak, 0.0)
        if fall > least:
            pieces.add(s_b - fall, s_b, peak, x_b, -u)
    if even:
        pieces.add((count - even) * spline.interval_s, count * spline.interval_s, x[count], x[count], 0.0)
    return PointTiming(pieces.profile(spline.duration_s), _too_fast(excess, ceiling))


def _change(spline: JointSpline, limits: MotionLimits, interval: int, ceiling: float) -> float:
    least = _CHANGE_MAX
    for joint, limit in enumerate(limits.qdd_max):
        speed, acceleration = spline.largest(joint, interval)
        if speed > 0.0:
            least = min(least, (limit - acceleration * ceiling) / speed)
    return least


def _too_fast(excess: dict[int, tuple[int, float, float]], ceiling: list[float]) -> TooFast | None:
    if not excess:
        return None
    interval = min(excess, key=lambda found: (ceiling[found], found))
    rate = sqrt(ceiling[interval])
    if rate > 1.0 - NOTEWORTHY:
        return None
    joint, speed, acceleration = excess[interval]
    return TooFast(interval, joint, rate, speed * speed >= acceleration)


class _Pieces:
    """Collects the pieces of a profile; consecutive ones of the same constant rate become one."""

    def __init__(self) -> None:
        self._start_s: list[float] = []
        self._position: list[float] = []
        self._speed: list[float] = []
        self._acceleration: list[float] = []
        self._t_s = 0.0

    def add(self, s_a: float, s_b: float, x_a: float, x_b: float, u: float) -> None:
        speed = sqrt(x_a)
        if not (u == 0.0 and self._acceleration and self._acceleration[-1] == 0.0 and self._speed[-1] == speed):
            self._start_s.append(self._t_s)
            self._position.append(s_a)
            self._speed.append(speed)
            self._acceleration.append(u)
        # From the start of the piece, so that rounding does not accumulate over its intervals.
        self._t_s = self._start_s[-1] + 2.0 * (s_b - self._position[-1]) / (speed + sqrt(x_b))

    def profile(self, length: float) -> TimeLaw:
        return TimeLaw(length, self._t_s, self._start_s, self._position, self._speed, self._acceleration)
