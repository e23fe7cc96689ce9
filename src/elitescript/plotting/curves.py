"""Builds the curves of a trace: joints, their speeds and accelerations, and the TCP, thinned and packed for a page."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import dist
from typing import Any, Final

from elitescript.controller.views.trace import TraceRow
from elitescript.controller.views.trace_rows import TraceRows
from elitescript.models.model import RobotModel
from elitescript.plotting.decimation import decimated, within_tolerance
from elitescript.plotting.packing import deltas, milliseconds

POINTS_MAX: Final = 1500
"""Points of one curve: two for each of 750 stretches, which is about what a wide screen tells apart."""

PATH_POINTS_MAX: Final = 3000

RESOLUTION: Final = 1200.0
"""A curve is true to its range divided by this, or by a quarter of it: at most half a pixel of a chart."""

_STEPS: Final = 20_000
"""Integer steps from zero to the largest value of a packed curve."""

_PATH_TOLERANCE_M: Final = 0.0002
_PATH_STEP_M: Final = 0.0001


def joint_curves(rows: Sequence[TraceRow], model: RobotModel) -> list[dict[str, Any]]:
    """Return for each joint its name and the curves `q`, `qd`, `qdd` with their limits, rad and s.

    The acceleration of a row is the change of `qd` since the row before, divided by the time between them.
    """
    trace = TraceRows.of(rows)
    times = list(trace.times)
    joints = []
    for number, limit in enumerate(model.joints, 1):
        q, qd = list(trace.column(f"q{number}")), list(trace.column(f"qd{number}"))
        joints.append(
            {
                "name": limit.name,
                "q": _limited(times, q, limit.q_min, limit.q_max),
                "qd": _limited(times, qd, -limit.qd_max, limit.qd_max),
                "qdd": _limited(times, accelerations(times, qd), -limit.qdd_max, limit.qdd_max),
            }
        )
    return joints


def error_curves(rows: Sequence[TraceRow], model: RobotModel) -> list[dict[str, Any]]:
    """Return the tracking error of each joint, target less actual, and the limit that stops the arm, rad.

    Empty if the trace does not have it.
    """
    trace = TraceRows.of(rows)
    if not trace.has_actual:
        return []
    limit = model.safety.tracking_error_max
    errors = [
        [target - actual for target, actual in zip(trace.column(f"q{joint}"), trace.column(f"qa{joint}"), strict=True)]
        for joint in range(1, 7)
    ]
    return [_limited(list(trace.times), error, -limit, limit) for error in errors]


def accelerations(times: Sequence[float], qd: Sequence[float]) -> list[float]:
    """Return the mean acceleration over the time before each sample, rad/s^2; zero at the first."""
    steps = zip(pairwise(times), pairwise(qd), strict=True)
    return [0.0, *((v1 - v0) / (t1 - t0) for (t0, t1), (v0, v1) in steps)]


def tcp_speeds(rows: Sequence[TraceRow]) -> list[float]:
    """Return the mean speed of the TCP over the time before each row, m/s; zero at the first.

    A pose that changes while the joints stand is another TCP, not a motion.
    """
    trace = TraceRows.of(rows)
    places = zip(*map(trace.column, "xyz"), strict=True)
    steps = zip(joint_changes(trace), pairwise(places), pairwise(trace.times), strict=True)
    return [0.0, *(dist(place, later) / (t1 - t0) if moves else 0.0 for moves, (place, later), (t0, t1) in steps)]


def joint_changes(rows: Sequence[TraceRow]) -> list[bool]:
    """Return for each row but the first whether its joint positions differ from those before."""
    trace = TraceRows.of(rows)
    joints = zip(*[trace.column(f"q{joint}") for joint in range(1, 7)], strict=True)
    return [q != later for q, later in pairwise(joints)]


def speed_curve(rows: Sequence[TraceRow], speeds: Sequence[float], speed_max: float) -> dict[str, Any]:
    """Return the curve of the TCP speed with its limit, m/s."""
    return _limited(list(TraceRows.of(rows).times), speeds, 0.0, speed_max)


def tcp_path(rows: Sequence[TraceRow], speeds: Sequence[float]) -> dict[str, Any]:
    """Return the TCP path: times, positions and speeds of its corners, and where the TCP was replaced."""
    trace = TraceRows.of(rows)
    times = list(trace.times)
    columns = [list(trace.column(name)) for name in "xyz"]
    steps = zip(joint_changes(trace), pairwise(zip(*columns, strict=True)), strict=True)
    jumps = [index for index, (moves, (place, later)) in enumerate(steps, 1) if not moves and place != later]
    near_jumps = {index for jump in jumps[: PATH_POINTS_MAX // 8] for index in (jump - 1, jump)}
    bounds = [(speeds, 0.01 * max(speeds)), *((column, _PATH_TOLERANCE_M) for column in columns)]
    tolerance = 1.0
    while True:
        kept = near_jumps.copy()
        for values, allowed in bounds:
            kept.update(within_tolerance(times, values, tolerance * allowed, PATH_POINTS_MAX))
            if len(kept) > PATH_POINTS_MAX:
                break
        else:
            break
        tolerance *= 2.0
    indices = sorted(kept)
    place = {index: position for position, index in enumerate(indices)}
    return {
        "t": milliseconds([times[index] for index in indices]),
        "xyz": [deltas([round(column[index] / _PATH_STEP_M) for index in indices]) for column in columns],
        "step": _PATH_STEP_M,
        "v": [round(speeds[index], 3) for index in indices],
        "jumps": [place[jump] for jump in jumps if jump in place],
    }


def _limited(times: Sequence[float], values: Sequence[float], low: float, high: float) -> dict[str, Any]:
    bottom, top = min(values), max(values)
    indices = decimated(times, values, tolerance=(top - bottom) / RESOLUTION, points_max=POINTS_MAX)
    largest = max(abs(bottom), abs(top))
    step = largest / _STEPS if largest > 0.0 else 1.0
    return {
        "t": milliseconds([times[index] for index in indices]),
        "v": deltas([round(values[index] / step) for index in indices]),
        "step": step,
        "min": bottom,
        "max": top,
        "low": low,
        "high": high,
        "used": max(top / high if high > 0.0 else 0.0, bottom / low if low < 0.0 else 0.0),
    }
