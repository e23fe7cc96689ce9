"""The moves of a recording: where each begins and ends, its cruise and its ramp."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, isnan, sqrt
from typing import Final

from elitescript.audit.fit.least_squares import student_quantile
from elitescript.recorder.recording import Recording
from elitescript.records import NamedTuple, record

MOVING: Final = 1e-4
"""Speed, rad/s, above which a joint's target moves."""
CRUISE_SHARE: Final = 1e-4
"""Share of the largest speed within which it counts as kept."""
CRUISE_ROWS: Final = 5
"""Fewest rows at the largest speed for it to be a cruise and not a peak."""
RAMP_ROWS: Final = 10
"""Fewest rows of a ramp for its shape."""
RESOLUTION: Final = 1e-6
"""Relative half width below which no interval goes: numbers of the controller are not better defined than that."""


class Estimate(NamedTuple):
    """A number with the half width of its 95 % interval."""

    value: float
    half: float


@record
class RecordedMove:
    """One stretch in which the target moves, while the program is in one line.

    Attributes:
        first: index of its first row.
        last: of its last one.
        line: of the program; 0 if the recording has none.
        joint: index of the leading joint, the one that moves furthest.
        shares: way of each joint, with sign, as a share of that of the leading joint.
        scaling: speed scaling of the controller, constant in the move; None if it changes.
        cruise: speed of the leading joint while it is constant, rad/s, at full scaling; None if it never is.
        ramp: acceleration of the leading joint at the begin, rad/s^2, at full scaling; None if it is too short.
        bend: rms of the ramp beside a straight line, as a share of the cruise or largest speed; None without a ramp.
        tool_cruise: the same for the TCP, m/s.
        tool_ramp: the same for the TCP, m/s^2.
        cruise_rows: index of the first row of the cruise and of the one behind its last.
    """

    first: int
    last: int
    line: int
    joint: int
    shares: tuple[float, ...]
    scaling: float | None
    cruise: Estimate | None
    ramp: Estimate | None
    bend: float | None
    tool_cruise: Estimate | None
    tool_ramp: Estimate | None
    cruise_rows: tuple[int, int] | None


def recorded_moves(recording: Recording) -> list[RecordedMove]:
    """Return the moves of a recording in order.

    A stretch ends where the target stands, the line changes, or the time of the controller begins anew; missing rows
    within it do no harm, since every row has its time.
    """
    qd = six_columns(recording, "target_joint_speeds")
    q = six_columns(recording, "target_joint_positions")
    if qd is None or q is None:
        return []
    count = len(recording.t)
    lines = recording.columns.get("script_control_line")
    restarts = set(recording.restarts)
    moves = []
    first: int | None = None
    for index in range(count + 1):
        is_moving = index < count and any(abs(column[index]) > MOVING for column in qd)
        if first is not None and (
            not is_moving or index in restarts or (lines is not None and lines[index] != lines[first])
        ):
            moves.append(_move(recording, q, qd, first, index - 1))
            first = None
        if is_moving and first is None:
            first = index
    return moves


def six_columns(recording: Recording, name: str) -> list[Sequence[float]] | None:
    """Return the columns of a variable with six elements; None if the recording does not have all of them."""
    columns = [recording.columns.get(f"{name}.{index}") for index in range(6)]
    found = [column for column in columns if column is not None]
    return None if len(found) < 6 else list(found)


def _move(
    recording: Recording, q: list[Sequence[float]], qd: list[Sequence[float]], first: int, last: int
) -> RecordedMove:
    ways = [column[last] - column[first] for column in q]
    # A move of two or three rows has hardly a way; then the speeds say which joint leads.
    if max(map(abs, ways)) < 1e-9:
        ways = [max((column[i] for i in range(first, last + 1)), key=abs) for column in qd]
    joint = max(range(6), key=lambda index: abs(ways[index]))
    largest = ways[joint] or 1.0
    times = recording.t[first : last + 1]
    speeds = [abs(value) for value in qd[joint][first : last + 1]]
    scaling = _constant(recording.columns.get("speed_scaling"), first, last)
    line = recording.columns.get("script_control_line")
    tool = _tool_speeds(recording, first, last)
    cruise, where = _cruise(speeds)
    ramp, bend = _ramp(times, speeds)
    tool_cruise = _cruise(tool)[0] if tool else None
    tool_ramp = _ramp(times, tool)[0] if tool else None
    return RecordedMove(
        first=first,
        last=last,
        line=int(line[first]) if line is not None and not isnan(line[first]) else 0,
        joint=joint,
        shares=tuple(way / largest for way in ways),
        scaling=scaling,
        cruise=_at_full(cruise, scaling, 1),
        ramp=_at_full(ramp, scaling, 2),
        bend=bend,
        tool_cruise=_at_full(tool_cruise, scaling, 1),
        tool_ramp=_at_full(tool_ramp, scaling, 2),
        cruise_rows=None if where is None else (first + where[0], first + where[1]),
    )


def _constant(column: Sequence[float] | None, first: int, last: int) -> float | None:
    """Return the value of a column in a stretch if it is one; 1 without the column."""
    if column is None:
        return 1.0
    values = column[first : last + 1]
    low, high = min(values), max(values)
    return low if high - low <= 1e-9 and low > 0.0 else None


def _at_full(estimate: Estimate | None, scaling: float | None, power: int) -> Estimate | None:
    if estimate is None or scaling is None:
        return None
    factor = scaling**power
    return Estimate(estimate.value / factor, estimate.half / factor)


def _tool_speeds(recording: Recording, first: int, last: int) -> list[float]:
    columns = [recording.columns.get(f"target_TCP_speed.{index}") for index in range(3)]
    x, y, z = columns
    if x is None or y is None or z is None:
        return []
    return [hypot(x[i], y[i], z[i]) for i in range(first, last + 1)]


def _cruise(speeds: Sequence[float]) -> tuple[Estimate | None, tuple[int, int] | None]:
    """Return the speed that is kept, and the rows; noise of the speeds widens what counts as kept."""
    peak = max(speeds)
    at = [index for index, speed in enumerate(speeds) if speed >= peak * (1.0 - CRUISE_SHARE)]
    begin, end = at[0], at[-1] + 1
    if len(at) < CRUISE_ROWS or peak <= 0.0 or len(at) < 0.9 * (end - begin):
        return None, None
    kept = [speeds[index] for index in at]
    mean = sum(kept) / len(kept)
    spread = sqrt(sum((speed - mean) ** 2 for speed in kept) / (len(kept) - 1))
    half = student_quantile(len(kept) - 1) * spread / sqrt(len(kept))
    return Estimate(mean, max(half, RESOLUTION * mean)), (begin, end)


def _ramp(times: Sequence[float], speeds: Sequence[float]) -> tuple[Estimate | None, float | None]:
    """Return the slope of the begin of a move, and how far it bends."""
    peak = max(speeds)
    rising = []
    for t, speed in zip(times, speeds, strict=True):
        if speed >= 0.95 * peak:
            break
        if speed > 0.05 * peak:
            rising.append((t, speed))
    count = len(rising)
    if count < RAMP_ROWS:
        return None, None
    t_mean = sum(t for t, _ in rising) / count
    v_mean = sum(v for _, v in rising) / count
    square = sum((t - t_mean) ** 2 for t, _ in rising)
    slope = sum((t - t_mean) * (v - v_mean) for t, v in rising) / square
    rest = sum((v - v_mean - slope * (t - t_mean)) ** 2 for t, v in rising)
    half = student_quantile(count - 2) * sqrt(rest / (count - 2) / square)
    return Estimate(slope, max(half, RESOLUTION * slope)), sqrt(rest / count) / peak
