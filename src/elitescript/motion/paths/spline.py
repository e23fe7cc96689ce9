"""A smooth curve through joint positions at a constant interval of time.

Each joint follows a cubic spline: a cubic in every interval, with continuous speed and acceleration, through every
point at its time. The second derivatives M at the points solve

    M_(k-1) + 4 M_k + M_(k+1) = 6 (q_(k-1) - 2 q_k + q_(k+1)) / h^2

with prescribed speeds at both ends (de Boor, A Practical Guide to Splines, chapter IV). Inside an interval the
acceleration is linear, so it is largest at a point, and the speed is a parabola: the largest speed and acceleration of
a joint are known exactly.
"""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from operator import sub
from typing import Final

from elitescript.messages.motion import Six

REST_SPEED: Final = 1e-3
"""Speed, rad/s, below which a joint begins or ends at rest: the resolution of six decimals every 2 ms."""

REST_SHARE: Final = 0.25
"""Share of the speed in the first interval below which the speed extrapolated to the end is rest, also if reversed."""


class JointSpline:
    """Joint positions over the time of a file, which begins at 0; immutable.

    Args:
        columns: positions of each of the six joints, rad, at least two.
        interval_s: time between two of them.

    Attributes:
        is_start_at_rest: whether the points begin at rest.
        is_end_at_rest: whether they end at rest.
        duration_s: time of the last point.
    """

    __slots__ = (
        "_largest_steps",
        "columns",
        "duration_s",
        "interval_s",
        "is_end_at_rest",
        "is_start_at_rest",
        "largest_accelerations",
        "seconds",
    )

    def __init__(self, columns: Sequence[Sequence[float]], interval_s: float) -> None:
        self.interval_s = interval_s
        self.duration_s = (len(columns[0]) - 1) * interval_s
        speeds_start, self.is_start_at_rest = _end_speeds([column[:3] for column in columns], interval_s)
        speeds_end, self.is_end_at_rest = _end_speeds([column[:-4:-1] for column in columns], interval_s)
        self.columns = tuple([array("d", column) for column in columns])
        """Positions of each joint at the points, rad."""
        shares = _shares(self.intervals)
        seconds: list[array[float]] = []
        self._largest_steps: list[float] = []
        self.largest_accelerations: list[float] = []
        """The largest acceleration of each joint at a point, by size, rad/s^2."""
        for column, start, end in zip(columns, speeds_start, speeds_end, strict=True):
            steps = list(map(sub, column[1:], column))
            m = _second_derivatives(steps, interval_s, start, -end, shares)
            self._largest_steps.append(max(max(steps), -min(steps)))
            self.largest_accelerations.append(max(max(m), -min(m)))
            seconds.append(array("d", m))
        self.seconds = tuple(seconds)
        """Accelerations of each joint at the points, rad/s^2."""

    @property
    def intervals(self) -> int:
        """How many intervals there are."""
        return len(self.columns[0]) - 1

    def point(self, index: int) -> Six:
        """Return the joint positions of a point, from 0, or from the end with a negative index, rad."""
        q1, q2, q3, q4, q5, q6 = [column[index] for column in self.columns]
        return q1, q2, q3, q4, q5, q6

    def q_and_speed(self, t_s: float) -> tuple[Six, Six]:
        """Return joint positions, rad, and their derivatives by the time of the file, rad/s."""
        h = self.interval_s
        interval = min(max(int(t_s / h), 0), self.intervals - 1)
        b = (t_s - interval * h) / h
        a = 1.0 - b
        bow_a, bow_b = (a * a - 1.0) * a * h * h / 6.0, (b * b - 1.0) * b * h * h / 6.0
        rise_a, rise_b = (1.0 - 3.0 * a * a) * h / 6.0, (3.0 * b * b - 1.0) * h / 6.0
        ahead = interval + 1
        q: list[float] = []
        speed: list[float] = []
        for column, m in zip(self.columns, self.seconds, strict=True):
            qa, qb, ma, mb = column[interval], column[ahead], m[interval], m[ahead]
            q.append(a * qa + b * qb + bow_a * ma + bow_b * mb)
            speed.append((qb - qa) / h + rise_a * ma + rise_b * mb)
        q1, q2, q3, q4, q5, q6 = q
        w1, w2, w3, w4, w5, w6 = speed
        return (q1, q2, q3, q4, q5, q6), (w1, w2, w3, w4, w5, w6)

    def largest(self, joint: int, interval: int) -> tuple[float, float]:
        """Return the largest |speed|, rad/s, and |acceleration|, rad/s^2, of a joint in an interval."""
        h = self.interval_s
        column, m = self.columns[joint], self.seconds[joint]
        ma, mb = m[interval], m[interval + 1]
        mean = (column[interval + 1] - column[interval]) / h
        return _top_speed(mean, ma, mb, h), max(abs(ma), abs(mb))

    def excess(self, speed_max: Six, acceleration_max: Six) -> dict[int, tuple[int, float, float]]:
        """Return the intervals in which joints exceed limits.

        Returns:
            For each such interval the worst joint, and the ratios of its speed and of its acceleration to their limits,
            of which one may be below 1.
        """
        h = self.interval_s
        found: dict[int, tuple[int, float, float]] = {}
        for joint in range(6):
            column, m = self.columns[joint], self.seconds[joint]
            top, a_top = speed_max[joint], acceleration_max[joint]
            # The cheap tests first: they are enough for most files.
            largest = self.largest_accelerations[joint]
            room = h * (top - 0.75 * h * largest)
            if largest <= a_top and self._largest_steps[joint] < room:
                continue
            q_a, m_a = column[0], m[0]
            interval = -1
            for q_b, m_b in zip(column[1:], m[1:], strict=True):
                interval += 1
                if largest > a_top or not -room < q_b - q_a < room:
                    speed = _top_speed((q_b - q_a) / h, m_a, m_b, h) / top
                    acceleration = max(m_a, -m_a, m_b, -m_b) / a_top
                    worst = max(speed * speed, acceleration)
                    if worst > 1.0:
                        known = found.get(interval)
                        if known is None or max(known[1] * known[1], known[2]) < worst:
                            found[interval] = (joint, speed, acceleration)
                q_a, m_a = q_b, m_b
        return found

    def extremes(self, joint: int, interval: int) -> tuple[float, float]:
        """Return the lowest and the highest position of a joint in an interval, rad."""
        h = self.interval_s
        column, m = self.columns[joint], self.seconds[joint]
        ma, mb, qa, qb = m[interval], m[interval + 1], column[interval], column[interval + 1]
        start = (qb - qa) / h - h * (2.0 * ma + mb) / 6.0
        # start + ma t + (mb - ma) t^2 / (2 h) = 0, in the form that does not cancel.
        found = [qa, qb]
        curve = 0.5 * (mb - ma) / h
        inside = ma * ma - 4.0 * curve * start
        if inside >= 0.0:
            larger = -0.5 * (ma + (inside**0.5 if ma >= 0.0 else -(inside**0.5)))
            for above, below in ((larger, curve), (start, larger)):
                t_s = above / below if below else -1.0
                if 0.0 < t_s < h:
                    found.append(qa + t_s * (start + t_s * (0.5 * ma + t_s * curve / 3.0)))
        return min(found), max(found)


def _top_speed(mean: float, m_a: float, m_b: float, h: float) -> float:
    """Return the largest |speed| in an interval: at one of its ends, or where the acceleration changes its sign."""
    start = mean - h * (2.0 * m_a + m_b) / 6.0
    end = mean + h * (m_a + 2.0 * m_b) / 6.0
    top = max(start, -start, end, -end)
    if m_a * m_b < 0.0:
        top = max(top, abs(start - 0.5 * h * m_a * m_a / (m_b - m_a)))
    return top


def _end_speeds(ends: Sequence[Sequence[float]], h: float) -> tuple[list[float], bool]:
    """Return the speeds, rad/s, with which joints leave the first of up to three positions, and whether all rest."""
    speeds: list[float] = []
    is_at_rest = True
    for end in ends:
        first = (end[1] - end[0]) / h
        speed = first if len(end) < 3 else 0.5 * (4.0 * end[1] - 3.0 * end[0] - end[2]) / h
        speeds.append(speed)
        if abs(speed) > REST_SPEED and speed * first > REST_SHARE * first * first:
            is_at_rest = False
    return ([0.0] * 6 if is_at_rest else speeds), is_at_rest


def _shares(intervals: int) -> list[float]:
    """Return the factors of the elimination, which depend on the number of intervals alone."""
    shares = [0.5]
    while len(shares) < intervals:
        share = 1.0 / (4.0 - shares[-1])
        # They converge within some twenty points.
        shares += [share] * (intervals - len(shares) if share == shares[-1] else 1)
    return shares


def _second_derivatives(
    steps: Sequence[float], h: float, speed_start: float, speed_end: float, shares: Sequence[float]
) -> list[float]:
    """Return M for the steps from point to point: one elimination forwards, one substitution backwards."""
    factor = 6.0 / h
    slopes = [step / h for step in steps]
    g = 0.5 * factor * (slopes[0] - speed_start)
    parts = [g]
    parts += [
        g := (factor * change - g) * share
        for change, share in zip(map(sub, slopes[1:], slopes), shares[1:], strict=True)
    ]
    m = (factor * (speed_end - slopes[-1]) - g) / (2.0 - shares[-1])
    result = [m]
    result += [m := part - share * m for share, part in zip(reversed(shares), reversed(parts), strict=True)]
    result.reverse()
    return result
