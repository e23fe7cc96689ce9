"""Scales planned time: speed percentage, pause, resume, stop.

A segment is a function of its own time, the *path time*. A `TimeScale` gives path time as a
function of real time; its derivative, the *rate*, is the speed percentage as a fraction: 1 runs
the move as planned, 0 stands still on the path. The rate changes along linear ramps, so that the
target positions stay on the planned path and never jump, and their speeds (rate times planned
speed) are continuous. Pause and stop are ramps to 0, resume is a ramp up again.

That the percentage acts by scaling time along the path is *assumed*, as is the linear ramp.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import inf, isfinite, sqrt
from typing import Final

from elitescript.errors import UsageError
from elitescript.messages.motion import Six
from elitescript.motion.segment import Segment
from elitescript.records import record


@record
class TimeScale:
    """Path time from real time `t_start_s` on: a ramp of `ramp_s` to `rate_target`, then constant.

    Immutable; `with_target` returns the scale from a later time on. A scale is not defined before its start.
    """

    t_start_s: float
    s_start_s: float
    """Path time at `t_start_s`."""
    rate_start: float
    rate_target: float
    ramp_s: float

    @classmethod
    def start(cls, t_start_s: float, rate: float, s_start_s: float = 0.0) -> TimeScale:
        """Return a scale of constant rate that begins at a path time.

        Raises:
            UsageError: a rate that is negative or not finite.
        """
        _check_rate(rate)
        return cls(t_start_s, s_start_s, rate, rate, 0.0)

    def with_target(self, t_s: float, rate: float, ramp_s: float) -> TimeScale:
        """Return the scale that from t_s on ramps to another rate within ramp_s.

        A ramp of 0 s changes the rate at once, which is smooth only at standstill.

        Raises:
            UsageError: a time before this scale began, a rate or a ramp that is negative or not finite.
        """
        _check_rate(rate)
        if not (isfinite(ramp_s) and ramp_s >= 0.0):
            raise UsageError(f"a ramp of {ramp_s} s makes no sense; it has to be 0 or more")
        return TimeScale(t_s, self.path_time(t_s), self.rate(t_s), rate, ramp_s)

    def rebased(self, t_s: float) -> TimeScale:
        """Return the scale that goes on from t_s for another segment, whose path time begins with 0 there.

        Raises:
            UsageError: a time before this scale began.
        """
        return TimeScale(t_s, 0.0, self.rate(t_s), self.rate_target, max(0.0, self.settled_s - t_s))

    def rate(self, t_s: float) -> float:
        """Return the fraction at which path time passes at a real time.

        Raises:
            UsageError: a time before this scale began.
        """
        elapsed_s = self._elapsed_s(t_s)
        if t_s >= self.settled_s:
            return self.rate_target
        return self.rate_start + (self.rate_target - self.rate_start) * (elapsed_s / self.ramp_s)

    def path_time(self, t_s: float) -> float:
        """Return the path time, s, at a real time.

        Raises:
            UsageError: a time before this scale began.
        """
        elapsed_s = self._elapsed_s(t_s)
        if t_s >= self.settled_s:
            return self.s_start_s + self._ramp_gain_s + self.rate_target * (t_s - self.settled_s)
        gained = 0.5 * (self.rate_target - self.rate_start) * (elapsed_s / self.ramp_s)
        return self.s_start_s + elapsed_s * (self.rate_start + gained)

    def settled_path_times(self, times_s: Iterable[float]) -> list[float]:
        """Return the path times, s, at real times that are not before `settled_s`."""
        path_time_s, rate, settled_s = self.s_start_s + self._ramp_gain_s, self.rate_target, self.settled_s
        return [path_time_s + rate * (t_s - settled_s) for t_s in times_s]

    def time_of(self, path_time_s: float) -> float:
        """Return the real time at which a path time is reached, inf when it never is.

        A path time that was reached before this scale began gives `t_start_s`. The result is
        exact up to rounding: `path_time(time_of(s))` may differ from s in the last digits.
        """
        way_s = path_time_s - self.s_start_s
        if way_s <= 0.0:
            return self.t_start_s
        rest_s = way_s - self._ramp_gain_s
        if self.rate_target == 0.0 and path_time_s > self.s_start_s + self._ramp_gain_s:
            return inf
        if rest_s >= 0.0:
            return self.settled_s + (rest_s / self.rate_target if self.rate_target else 0.0)
        # Inside the ramp: rate_start t + slope t^2 / 2 = way, in the form that does not cancel.
        slope = (self.rate_target - self.rate_start) / self.ramp_s
        root = sqrt(max(0.0, self.rate_start * self.rate_start + 2.0 * slope * way_s))
        return self.t_start_s + min(self.ramp_s, 2.0 * way_s / (self.rate_start + root))

    @property
    def settled_s(self) -> float:
        """Real time from which the rate is constant."""
        return self.t_start_s + self.ramp_s

    @property
    def _ramp_gain_s(self) -> float:
        """Path time that passes during the ramp."""
        return 0.5 * (self.rate_start + self.rate_target) * self.ramp_s

    def _elapsed_s(self, t_s: float) -> float:
        elapsed_s = t_s - self.t_start_s
        # Written so that a time that is not a number is refused too.
        if not elapsed_s >= 0.0:
            raise UsageError(f"the time {t_s} s is before this time scale began, at {self.t_start_s} s")
        return elapsed_s


def stop_ramp(segment: Segment, path_time_s: float, rate: float, deceleration: float) -> float:
    """Return the ramp, s, that brings a running segment to rest with a joint deceleration, rad/s^2.

    For `stopj`, pause and stop. No joint brakes harder than requested while the rate goes from
    `rate` to 0. The braking that is planned in the segment counts: only the rest of the
    deceleration is used. Where that is so little that the arm would take more than twice as long to rest
    as with the deceleration alone, more is used, up to half of the deceleration on top of the planned one.
    A segment that ends sooner than the ramp brings the arm to rest at its end.

    Args:
        segment: the move under way.
        path_time_s: path time at which the ramp begins.
        rate: rate at that time.
        deceleration: rad/s^2, more than 0.

    Raises:
        UsageError: a deceleration that is not a positive number.
    """
    return _braking_ramp(segment.sample_speed, segment.duration_s, path_time_s, rate, deceleration)


def stop_ramp_tool(segment: Segment, path_time_s: float, rate: float, deceleration: float) -> float:
    """Return the ramp, s, that brings a running segment to rest with a tool deceleration.

    For `stopl`. The deceleration holds for the TCP in m/s^2 and for the rotation of the tool in
    rad/s^2 (*assumed*, after the rule of `speedl` for its angular acceleration). Otherwise as
    `stop_ramp`.
    """
    return _braking_ramp(segment.tool_speed, segment.duration_s, path_time_s, rate, deceleration)


def change_ramp(
    segment: Segment, path_time_s: float, rate: float, rate_target: float, least_s: float, qdd_max: Six
) -> float:
    """Return the ramp, s, in which a running segment changes to another rate; longer where joints have no room.

    A change of rate accelerates the joints in addition to the plan. Where both together would exceed a limit the ramp
    is made longer; where the plan itself uses nearly all of the limit, a twentieth is added.

    Args:
        segment: the move under way.
        path_time_s: path time at which the ramp begins.
        rate: rate at that time.
        rate_target: rate at its end.
        least_s: wanted ramp.
        qdd_max: acceleration limits of the joints, rad/s^2.
    """
    _check_rate(rate)
    change = rate_target - rate
    ramp_s = least_s
    for _ in range(_BRAKING_ROUNDS if change else 0):
        full_window_s = 0.5 * (rate + rate_target) * ramp_s
        window_s = min(full_window_s, max(0.0, segment.duration_s - path_time_s))
        needed_s = least_s
        for point in range(_BRAKING_POINTS if window_s else 1):
            ahead_s = window_s * point / (_BRAKING_POINTS - 1)
            speeds = segment.sample_speed(path_time_s + ahead_s)
            later = segment.sample_speed(path_time_s + ahead_s + _DIFFERENCE_S)
            # On a linear ramp the rate squared goes linearly with the path time.
            share = ahead_s / full_window_s if full_window_s else 0.0
            rate_squared = rate * rate + (rate_target * rate_target - rate * rate) * share
            for speed, speed_later, limit in zip(speeds, later, qdd_max, strict=True):
                planned = rate_squared * (speed_later - speed) / _DIFFERENCE_S
                room = limit - abs(planned) if planned * change * speed > 0.0 else limit
                needed_s = max(needed_s, abs(change * speed) / max(room, _LEAST_ROOM * limit))
        if needed_s <= ramp_s * (1.0 + _RAMP_TOLERANCE):
            break
        ramp_s = needed_s
    return ramp_s


_LEAST_ROOM: Final = 0.05
"""Share of a limit that a change of rate may use in any case."""

_BRAKING_POINTS: Final = 12
"""Points of the braking distance at which the deceleration is computed."""

_BRAKING_ROUNDS: Final = 12
"""Limit of iterations: a longer ramp reaches further ahead, where speeds may be higher."""

_RAMP_TOLERANCE: Final = 1e-3
"""Relative accuracy of a ramp."""

_GENTLEST: Final = 1e-9
"""Deceleration below which a braking outlasts every move, rad/s^2 or m/s^2."""

_LEAST_BRAKING: Final = (0.02, 0.1, 0.25, 0.5)
"""Shares of the deceleration that a stop may use on top of the planned braking; tried in turn."""

_LONGEST_STOP: Final = 2.0
"""Longest stop that keeps to the deceleration, as a multiple of one with the deceleration alone."""

_DIFFERENCE_S: Final = 1e-4
"""Step of the difference that gives the planned deceleration, s of path time."""


def _braking_ramp(
    speeds_at: Callable[[float], tuple[float, ...]],
    duration_s: float,
    path_time_s: float,
    rate: float,
    deceleration: float,
) -> float:
    if not (isfinite(deceleration) and deceleration > 0.0):
        raise UsageError(f"a deceleration of {deceleration} makes no sense; it has to be more than 0")
    _check_rate(rate)
    longest_s = _LONGEST_STOP * rate * max(map(abs, speeds_at(path_time_s))) / deceleration
    ramp_s = 0.0
    for least in _LEAST_BRAKING:
        ramp_s = _ramp_leaving(speeds_at, duration_s, path_time_s, rate, deceleration, least)
        left_s = max(0.0, duration_s - path_time_s)
        # The time at which the ramp reaches the end of the segment: rate t (1 - t / (2 ramp)) = left.
        share = 2.0 * left_s / (rate * ramp_s) if ramp_s else 0.0
        rests_after_s = ramp_s * (1.0 - sqrt(1.0 - share)) if share < 1.0 else ramp_s
        if rests_after_s <= longest_s:
            break
    return ramp_s


def _ramp_leaving(
    speeds_at: Callable[[float], tuple[float, ...]],
    duration_s: float,
    path_time_s: float,
    rate: float,
    deceleration: float,
    least: float,
) -> float:
    """Return the ramp that uses the deceleration without the planned braking, but at least a share of it."""
    ramp_s = 0.0
    for _ in range(_BRAKING_ROUNDS):
        full_window_s = 0.5 * rate * ramp_s
        window_s = min(full_window_s, max(0.0, duration_s - path_time_s))
        needed_s = 0.0
        for point in range(_BRAKING_POINTS if window_s else 1):
            ahead_s = window_s * point / (_BRAKING_POINTS - 1)
            speeds = speeds_at(path_time_s + ahead_s)
            later = speeds_at(path_time_s + ahead_s + _DIFFERENCE_S)
            # On a linear ramp the rate squared falls linearly with the path time.
            rate_squared = rate * rate * (1.0 - ahead_s / full_window_s) if full_window_s else rate * rate
            for speed, speed_later in zip(map(abs, speeds), map(abs, later), strict=True):
                planned = max(0.0, rate_squared * (speed - speed_later) / _DIFFERENCE_S)
                needed_s = max(needed_s, rate * speed / max(deceleration - planned, least * deceleration, _GENTLEST))
        if needed_s <= ramp_s * (1.0 + _RAMP_TOLERANCE):
            break
        ramp_s = needed_s
    return ramp_s


def _check_rate(rate: float) -> None:
    if not (isfinite(rate) and rate >= 0.0):
        raise UsageError(f"a speed fraction of {rate} makes no sense; it has to be 0 or more")
