"""Payload and TCP offset over time: what a recording shows, what the simulated robot has, and where both differ.

RTSI has the payload in every row. The TCP offset comes from the primary port alone, which sends it ten times a second,
so a change is known a little late.
"""

from __future__ import annotations

import re
from array import array
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from math import inf, isfinite
from operator import ne
from typing import Final

from elitescript.kinematics.transforms import transform_from_pose
from elitescript.messages.motion import Six
from elitescript.messages.timing import PERIOD_S
from elitescript.recorder.facts import CARTESIAN
from elitescript.recorder.recording import Recording
from elitescript.records import NamedTuple
from elitescript.robot import VirtualRobot

TCP_LATE_S: Final = 0.4
"""Time within which the primary port shows a TCP offset, s; it sends ten times a second (rest: *assumed*)."""

MASS_KG: Final = 1e-3
CENTRE_M: Final = 1e-5
TCP_OFFSET: Final = 1e-5
"""Differences that do not count; of the TCP offset in m, and in the elements of its rotation matrix (*assumed*)."""

PAYLOAD: Final = ("payload_mass", "payload_cog.0", "payload_cog.1", "payload_cog.2")

Numbers = tuple[float, ...]


class Kind(NamedTuple):
    """What is compared."""

    name: str
    unit: str
    command: str
    """Which sets it."""
    cause: str
    late_s: float = 0.0
    """Within which a recording shows it."""


MASS: Final = Kind("payload", "kg", "set_payload", "payload")
CENTRE: Final = Kind("centre of the payload", "m", "set_payload", "payload centre")
TCP: Final = Kind("TCP offset", "m, rad", "set_tcp", "tcp", TCP_LATE_S)


class Timeline:
    """Values, each from its time on until the next.

    Attributes:
        times: s since the program's begin; the first value holds before it too.
        values: as many.
    """

    __slots__ = ("times", "values")

    def __init__(self) -> None:
        self.times: list[float] = []
        self.values: list[Numbers] = []

    def add(self, t: float, value: Numbers) -> None:
        """Add a value, unless it is the one before."""
        if not self.values or self.values[-1] != value:
            self.times.append(t)
            self.values.append(value)

    def index(self, t: float) -> int:
        """Return the place of the value at a time."""
        return max(bisect_right(self.times, t) - 1, 0)

    def during(self, begin: float, end: float) -> list[Numbers]:
        """Return the values between two times."""
        return self.values[self.index(begin) : self.index(end) + 1]

    def lasts_s(self, index: int) -> float:
        """Return how long a value lasts; of the first and the last one it is not known, and infinite."""
        is_inner = 0 < index < len(self.times) - 1
        return self.times[index + 1] - self.times[index] if is_inner else inf


class SettingPair(NamedTuple):
    """One setting in both runs."""

    kind: Kind
    recorded: Timeline
    simulated: Timeline


class SettingDifference(NamedTuple):
    """Values that differ where marks belong together."""

    t: float
    """When the later one was set, s since the begin of the recorded run; not behind the mark."""
    what: str
    values: tuple[Numbers, Numbers]
    """Of the recording and of the simulated run."""


def difference_at(pair: SettingPair, t: float, its_t: float, slack_s: float, end_s: float) -> SettingDifference | None:
    """Return how a setting differs where both runs are at the same mark; None if it does not, or cannot be known.

    Args:
        pair: the setting.
        t: of the mark in the recorded run, s since its begin.
        its_t: in the simulated one.
        slack_s: by which either may show a change earlier or later than its mark.
        end_s: of the recording.
    """
    kind, recorded, simulated = pair
    late_s = kind.late_s
    index, its_index = recorded.index(t + slack_s + late_s), simulated.index(its_t + slack_s)
    if late_s and (simulated.lasts_s(its_index) < late_s or t + late_s > end_s):
        # The recording may never show it, or only behind its end.
        return None
    there = simulated.during(its_t - slack_s, its_t + slack_s)
    if any(_is_same(kind, a, b) for a in recorded.during(t - slack_s, t + slack_s + late_s) for b in there):
        return None
    since = 0.0
    if its_index:
        since = simulated.times[its_index] + t - its_t
    if index and not (late_s and its_index):
        since = max(since, recorded.times[index])
    found, value = recorded.values[index], simulated.values[its_index]
    what = f"{kind.name} {_text(found)} {kind.unit}, simulated {_text(value)} {kind.unit}"
    return SettingDifference(min(max(since, 0.0), t), what, (found, value))


def recorded_payload(recording: Recording, rows: range) -> tuple[Timeline, Timeline] | None:
    """Return mass and centre of the payload in a run; None if the recording does not have them."""
    # A recorder leaves out what was 0 all the time.
    if "host" not in recording.facts and not all(name in recording.columns for name in PAYLOAD):
        return None
    mass, centre = Timeline(), Timeline()
    zeros = array("d", bytes(8 * len(rows)))
    columns = [
        recording.columns[name][rows.start : rows.stop] if name in recording.columns else zeros for name in PAYLOAD
    ]
    t0 = recording.t[rows.start]
    changed = {0}
    for column in columns:
        if column.tobytes() != column[:1].tobytes() * len(column):
            changed.update(row for row, differs in enumerate(map(ne, column, column[1:]), 1) if differs)
    for row in sorted(changed):
        m, x, y, z = (column[row] for column in columns)
        if all(map(isfinite, (m, x, y, z))):
            mass.add(recording.t[rows.start + row] - t0, (m,))
            centre.add(recording.t[rows.start + row] - t0, (x, y, z))
    return (mass, centre) if mass.values else None


def recorded_tcp(recording: Recording, rows: range) -> Timeline | None:
    """Return the TCP offset in a run; None if the recording does not show it, or lost the primary port."""
    found = Timeline()
    t0 = recording.t[rows.start]
    begins = [recording.arrived_s[row] for row in recording.restarts if row <= rows.start]
    ends = [recording.arrived_s[row] for row in recording.restarts if row > rows.start]
    for message in recording.messages:
        if ends and message.arrived_s >= ends[0]:
            break
        is_before = bool(begins) and message.arrived_s < begins[-1]
        t = -inf if is_before else message.t - t0
        data = message.data
        if data.get("type") == "lost" and data.get("port") == "primary" and t >= 0.0:
            return None
        offset = data.get("TCP offset")
        if data.get("type") == CARTESIAN and offset is not None and _is_pose(offset):
            found.add(t, tuple(map(float, offset)))
    if found.values:
        return found
    return None


def tcp_at_begin(recording: Recording, rows: range) -> Six | None:
    """Return the TCP offset with which a run has begun; None if it is not known."""
    shown = recorded_tcp(recording, rows)
    value = recording.facts.get("tcp_offset") if shown is None else shown.values[shown.index(0.0)]
    if value is None or not _is_pose(value):
        return None
    x, y, z, rx, ry, rz = map(float, value)
    return x, y, z, rx, ry, rz


class SettingsTrace:
    """Keeps payload and TCP offset of a simulated run: a watch of it."""

    __slots__ = ("_begin", "_last", "centre", "mass", "tcp")

    def __init__(self, robot: VirtualRobot) -> None:
        self.mass, self.centre, self.tcp = Timeline(), Timeline(), Timeline()
        self._begin = robot.tick
        self._last: object = None
        self.watch(robot)

    def watch(self, robot: VirtualRobot) -> None:
        """Take what holds in this control period."""
        setup = robot.controller.setup
        now = (setup.payload, setup.tcp_offset)
        if now != self._last:
            self._last = now
            t = (robot.tick - self._begin) * PERIOD_S
            payload, offset = now
            self.mass.add(t, (payload.mass_kg,))
            self.centre.add(t, tuple(payload.cog))
            self.tcp.add(t, tuple(offset))


def setting_pairs(recording: Recording, rows: range, trace: SettingsTrace) -> Iterator[SettingPair]:
    """Yield what can be compared of a run."""
    if (payload := recorded_payload(recording, rows)) is not None:
        yield SettingPair(MASS, payload[0], trace.mass)
        yield SettingPair(CENTRE, payload[1], trace.centre)
    if (tcp := recorded_tcp(recording, rows)) is not None:
        yield SettingPair(TCP, tcp, trace.tcp)


def setter_lines(text: str) -> dict[str, list[int]]:
    """Return the lines of a program that call the commands of settings, by command."""
    lines = text.splitlines()
    return {
        command: [number for number, line in enumerate(lines, 1) if re.search(rf"\b{command}\s*\(", line)]
        for command in {MASS.command, TCP.command}
    }


def setter_line(calls: Sequence[int], before: int, line: int) -> int:
    """Return the line that has set a value: the last call between two lines that the run has shown, else the second.

    Args:
        calls: lines that call the command.
        before: line of the row before the change.
        line: of the row that shows it.

    """
    # A command that takes no time is hardly ever the line that a controller shows.
    between = [call for call in calls if before < call <= line]
    return between[-1] if between else line


def _is_pose(value: Sequence[float | None]) -> bool:
    return len(value) == 6 and all(number is not None and isfinite(number) for number in value)


def _is_same(kind: Kind, a: Numbers, b: Numbers) -> bool:
    if kind is TCP:
        return a == b or _is_near(transform_from_pose(a), transform_from_pose(b), TCP_OFFSET)
    return _is_near(a, b, MASS_KG if kind is MASS else CENTRE_M)


def _is_near(a: Sequence[float], b: Sequence[float], least: float) -> bool:
    return all(abs(x - y) <= least for x, y in zip(a, b, strict=True))


def _text(value: Numbers) -> str:
    shown = [f"{round(number, 6) + 0.0:.6g}" for number in value]
    return shown[0] if len(shown) == 1 else f"[{', '.join(shown)}]"
