"""Thins curves.

A screen shows some thousand columns, a run has a row every 4 ms. A curve is thinned to the samples between which
straight lines stay within a tolerance; a curve with too many of them keeps the lowest and the highest sample of each of
many short stretches. Either way the lowest and the highest value of the whole curve, its first and its last sample
survive.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import inf


def decimated(times: Sequence[float], values: Sequence[float], *, tolerance: float, points_max: int) -> list[int]:
    """Return indices of the samples that draw the curve, ascending.

    Args:
        times: strictly increasing.
        values: one for each time.
        tolerance: what a dropped sample may lie off the line between its kept neighbours, in the unit of the values;
            a curve that has too many points then may miss it by up to four times as much.
        points_max: upper bound of the number of indices, at least 8.
    """
    for factor in (1.0, 2.0, 4.0):
        indices = within_tolerance(times, values, factor * tolerance, points_max)
        if len(indices) <= points_max:
            return indices
    return extremes(times, values, points_max)


def within_tolerance(
    times: Sequence[float], values: Sequence[float], tolerance: float, enough: int | None = None
) -> list[int]:
    """Return indices of samples between which straight lines pass every other sample within a tolerance.

    With `enough` the rest of the curve is skipped once there are more indices than that, so that a tolerance that is
    too small for a long curve is rejected early.
    """
    count = len(values)
    if count <= 2:
        return list(range(count))
    low, high = min(values), max(values)
    stops = sorted({0, values.index(low), values.index(high), count - 1})
    kept = [0]
    for start, stop in pairwise(stops):
        _walk(times, values, tolerance, start, stop, kept, count if enough is None else enough)
        kept.append(stop)
        if enough is not None and len(kept) > enough:
            break
    return kept


def extremes(times: Sequence[float], values: Sequence[float], points_max: int) -> list[int]:
    """Return indices of the lowest and the highest sample of each of many stretches of equal time, and of both ends."""
    count = len(values)
    if count <= points_max:
        return list(range(count))
    stretches = max(1, (points_max - 2) // 2)
    start_s = times[0]
    scale = stretches / (times[-1] - start_s)
    kept = {0, count - 1}
    current, lowest, highest = 0, 0, 0
    for index, value in enumerate(values):
        stretch = min(stretches - 1, int((times[index] - start_s) * scale))
        if stretch != current:
            kept.update((lowest, highest))
            current, lowest, highest = stretch, index, index
        elif value < values[lowest]:
            lowest = index
        elif value > values[highest]:
            highest = index
    kept.update((lowest, highest))
    return sorted(kept)


def _walk(
    times: Sequence[float],
    values: Sequence[float],
    tolerance: float,
    start: int,
    stop: int,
    kept: list[int],
    enough: int,
) -> None:
    """Append the indices that are needed strictly between two samples; stop after more than `enough`.

    From an anchor, the slopes of all lines that pass the samples so far within the tolerance form an interval. The
    first sample that is seen outside of it ends the line at the sample before.
    """
    t0, v0 = times[start], values[start]
    slope_min, slope_max = -inf, inf
    for index in range(start + 1, stop + 1):
        dt = times[index] - t0
        dv = values[index] - v0
        slope = dv / dt
        if not slope_min <= slope <= slope_max:
            kept.append(index - 1)
            if len(kept) > enough:
                return
            t0, v0 = times[index - 1], values[index - 1]
            dt = times[index] - t0
            dv = values[index] - v0
            slope_min, slope_max = (dv - tolerance) / dt, (dv + tolerance) / dt
            continue
        lower, upper = (dv - tolerance) / dt, (dv + tolerance) / dt
        if lower > slope_min:
            slope_min = lower
        if upper < slope_max:
            slope_max = upper
