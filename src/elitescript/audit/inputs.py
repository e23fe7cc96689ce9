"""What a recorded robot got from outside: how it stood when the program began, and what came while it ran.

Times are those of the recording. The simulated run gets each input where it belongs in the program: as long after the
last mark of the recording before it, a line or an edge of an output, as it came there. So an acknowledgement that came
0.3 s after the gripper's valve comes 0.3 s after it in the simulated run too, whatever the moves before it took.
"""

from __future__ import annotations

from array import array
from collections.abc import Collection, Iterator, Mapping, Sequence
from math import isfinite, nan
from typing import Final

from elitescript.audit.alignment import Follower
from elitescript.audit.series import SCALING, SLIDER, STATE, Change, Mark, Series
from elitescript.audit.settings import PAYLOAD, tcp_at_begin
from elitescript.controller.signals.by_name import signal_write
from elitescript.messages.enums import AnalogDomain, SafetyMode, TaskState
from elitescript.messages.machine import (
    AskSafety,
    MachineRequest,
    PauseTask,
    ResumeTask,
    SetAnalogDomain,
    SetPayload,
    SetSpeedScale,
    SetTcp,
)
from elitescript.messages.motion import Six
from elitescript.messages.signals import Value, parse_signal_name
from elitescript.messages.timing import PERIOD_S, TICKS_PER_S
from elitescript.recorder.recording import Recording
from elitescript.records import NamedTuple, record
from elitescript.robot import VirtualRobot

SAFETY: Final = ("safety_status", "safety_mode")
_DOMAINS: Final = "analog_io_types"

_STOPS: Final = {
    SafetyMode.SAFEGUARD_STOP: "safeguard_stop",
    SafetyMode.SYSTEM_EMERGENCY_STOP: "system_emergency_stop",
    SafetyMode.ROBOT_EMERGENCY_STOP: "emergency_stop",
    SafetyMode.REDUCED: "reduced_mode",
}
"""Signals that bring the safety system into a mode."""
SAFETY_ROWS: Final = 3
"""Rows after a pause within which the safety mode shows that it was the cause."""
RELEASES: Final = (signal_write("safeguard_stop", False),)
"""What ends a stop so that the simulated program goes on."""


class Arrival(NamedTuple):
    """Something that came from outside while the program ran."""

    t: float
    """s since the program's begin."""
    row: int
    """First row of the run that shows it."""
    request: MachineRequest
    """That does the same to a simulated robot."""
    text: str
    """For people."""


@record
class Inputs:
    """All of one run.

    Attributes:
        begin_s: of the program, s since the start of the controller.
        joints: at the start, rad.
        speed: slider at the start; None if it is not known.
        levels: of signals at the start, of inputs and outputs.
        requests: that bring TCP, payload and domains of analog channels to what they were.
        arrivals: in order.
        unknown: what cannot be given to a simulated robot, for people.
    """

    begin_s: float
    joints: Six
    speed: float | None
    levels: Mapping[str, Value]
    requests: tuple[MachineRequest, ...]
    arrivals: tuple[Arrival, ...]
    unknown: tuple[str, ...]


def inputs_of(recording: Recording, rows: range, series: Series, driven: Collection[str]) -> Inputs:
    """Return the inputs of one run.

    Args:
        recording: with the run.
        rows: of the run.
        series: the same run.
        driven: inputs that devices of the simulated cell set, which are left to them.
    """
    arrivals = [
        Arrival(series.t[change.row], change.row, signal_write(change.name, change.value), _said(change))
        for change in series.changes
        if parse_signal_name(change.name)[0].is_input and change.name not in driven
    ]
    unknown: list[str] = []
    slider, speed = _slider(recording, rows)
    if slider:
        arrivals += [
            Arrival(series.t[row], row, SetSpeedScale(value), f"speed slider {value:.0%}")
            for row, value in _changes(slider)
            if 0.0 <= value <= 1.0
        ]
    elif speed is None:
        unknown.append("the speed slider: the recording has neither it nor the speed scaling")
    safety, why = _safety(recording, rows, series)
    arrivals += _with_pauses(safety, recording, rows, series)
    unknown += why
    arrivals.sort(key=lambda arrival: arrival.row)
    levels = {name: level for name, level in series.levels.items() if name not in driven}
    return Inputs(
        recording.t[rows.start],
        series.joints(0),
        speed,
        levels,
        tuple(_requests(recording, rows)),
        tuple(arrivals),
        tuple(unknown),
    )


def _said(change: Change) -> str:
    value = change.value
    return f"{change.name} {('off', 'on')[value] if isinstance(value, bool) else f'{value:g}'}"


def _slider(recording: Recording, rows: range) -> tuple[array[float], float | None]:
    """Return the values of the slider, and the first; where a recording has none, a constant speed scaling."""
    values = recording.columns.get(SLIDER, array("d"))[rows.start : rows.stop]
    if values and isfinite(values[0]):
        return values, min(max(values[0], 0.0), 1.0)
    scaling = recording.columns.get(SCALING, array("d"))[rows.start : rows.stop]
    known = [value for value in scaling if isfinite(value) and 0.0 < value <= 1.0]
    return array("d"), max(known) if known else None


def _changes(values: Sequence[float]) -> Iterator[tuple[int, float]]:
    """Yield row and value where a column changes; the first row is none, and neither are rows without a value."""
    known = nan
    for row, now in enumerate(values):
        if now != known and isfinite(now):
            if row:
                yield row, now
            known = now


def _with_pauses(safety: Sequence[Arrival], recording: Recording, rows: range, series: Series) -> list[Arrival]:
    """Return what came from the safety system, and the pauses that it does not explain.

    A stop of the safety system pauses the program by itself. The simulated one lets it go on when the stop is over, so
    it is over for it when the recorded program went on.
    """
    states = recording.columns.get(STATE, array("d"))[rows.start : rows.stop]
    modes = _modes(recording, rows)
    found = list(safety)
    is_paused_by_safety = False
    for row, state in _changes(states):
        if state == TaskState.PAUSED:
            near = modes[row : row + SAFETY_ROWS]
            is_paused_by_safety = any(mode not in (SafetyMode.NORMAL, SafetyMode.REDUCED) for mode in near)
            if not is_paused_by_safety:
                found.append(Arrival(series.t[row], row, PauseTask(), "paused"))
        elif state == TaskState.PLAYING and states[row - 1] == TaskState.PAUSED:
            if not is_paused_by_safety:
                found.append(Arrival(series.t[row], row, ResumeTask(), "resumed"))
                continue
            last = max((its.row for its in found if its.row <= row and its.request in RELEASES), default=None)
            found = [
                its._replace(row=row, t=series.t[row]) if its.row == last and its.request in RELEASES else its
                for its in found
            ]
    return found


def _modes(recording: Recording, rows: range) -> array[float]:
    """Return the safety mode of each row; empty if it is not recorded."""
    name = next((name for name in SAFETY if name in recording.columns), "")
    return recording.columns.get(name, array("d"))[rows.start : rows.stop]


def _safety(recording: Recording, rows: range, series: Series) -> tuple[list[Arrival], list[str]]:
    modes = _modes(recording, rows)
    found: list[Arrival] = []
    unknown: list[str] = []
    mode = SafetyMode.NORMAL
    for row, number in [*((0, first) for first in modes[:1] if isfinite(first)), *_changes(modes)]:
        before, mode = mode, SafetyMode(int(number)) if number in set(SafetyMode) else SafetyMode.UNDEFINED
        t = series.t[row]
        if before in _STOPS and mode is not before:
            found.append(Arrival(t, row, signal_write(_STOPS[before], False), f"{_STOPS[before]} off"))
        if before is SafetyMode.PROTECTIVE_STOP:
            found.append(Arrival(t, row, AskSafety("unlock_protective_stop"), "protective stop unlocked"))
        if mode in _STOPS:
            found.append(Arrival(t, row, signal_write(_STOPS[mode], True), f"{_STOPS[mode]} on"))
        elif mode is SafetyMode.PROTECTIVE_STOP:
            found.append(Arrival(t, row, AskSafety("stop_protectively", "as recorded"), "protective stop"))
        elif mode is not SafetyMode.NORMAL:
            unknown.append(f"safety mode {mode.name.lower().replace('_', ' ')} at {t:.3f} s: its cause is not recorded")
    return found, unknown


def _requests(recording: Recording, rows: range) -> Iterator[MachineRequest]:
    if (tcp := tcp_at_begin(recording, rows)) is not None:
        yield SetTcp(tcp)
    columns = recording.columns
    if PAYLOAD[0] in columns:
        # The first row of a run may have the payload that its program has set already.
        before = rows.start - (rows.start > 0 and rows.start not in recording.restarts)
        mass, x, y, z = (columns[name][before] if name in columns else 0.0 for name in PAYLOAD)
        if all(map(isfinite, (mass, x, y, z))):
            yield SetPayload(mass, (x, y, z))
    if _DOMAINS in columns and isfinite(word := columns[_DOMAINS][rows.start]):
        for index in range(2):
            yield SetAnalogDomain("standard_analog_in", index, AnalogDomain(int(word) >> index & 1))


class Schedule:
    """Gives a simulated robot the recorded inputs while its program runs, each where it belongs.

    Args:
        arrivals: in order.
        series: the recorded run.
        marks: of the recorded run.
        by_lines: whether lines are among them.
    """

    __slots__ = (
        "_anchor_t",
        "_anchor_tick",
        "_arrivals",
        "_by_lines",
        "_follower",
        "_image",
        "_line",
        "_marks",
        "_next",
        "_outputs",
        "_series",
        "_woken",
    )

    def __init__(self, arrivals: Sequence[Arrival], series: Series, marks: Sequence[Mark], *, by_lines: bool) -> None:
        self._arrivals = arrivals
        self._series = series
        self._marks = marks
        self._by_lines = by_lines
        self._follower = Follower([mark.key for mark in marks])
        families: dict[str, dict[int, str]] = {}
        for name in {mark.key[0] for mark in marks} - {"line", "moves"}:
            row, index = parse_signal_name(name)
            families.setdefault(row.name, {})[index] = name
        self._outputs = families
        self._image: Mapping[str, tuple[Value, ...]] = {}
        self._line = -1
        self._next = 0
        self._anchor_t = 0.0
        self._anchor_tick = 0
        self._woken = -1

    @property
    def end_s(self) -> float:
        """How long the simulated robot would run on to the end of the recording, s since its last mark."""
        return self._series.t[-1] - self._anchor_t

    def begin(self, robot: VirtualRobot) -> None:
        """Take the robot as it stands before its program begins."""
        self._anchor_tick = robot.tick
        self._image = robot.controller.signals.image
        self._plan(robot, robot.tick - 1)

    def is_over(self, robot: VirtualRobot, longer_s: float) -> bool:
        """Return whether the robot is where the recording ends, and so much later."""
        is_last = self._follower.place == len(self._marks) - 1
        return is_last and (robot.tick - self._anchor_tick) * PERIOD_S > self.end_s + longer_s

    def watch(self, robot: VirtualRobot) -> None:
        """Follow a tick that has run, and queue what comes before the next one that is due."""
        tick = robot.tick
        for key in self._news(robot):
            if self._follower.take(key):
                mark = self._marks[self._follower.place]
                self._anchor_t, self._anchor_tick = self._series.t[mark.row], tick
        self._plan(robot, tick)

    def _news(self, robot: VirtualRobot) -> Iterator[tuple[str, Value]]:
        image = robot.controller.signals.image
        if image is not self._image:
            edges = []
            for family, points in self._outputs.items():
                before, now = self._image[family], image[family]
                if before is not now:
                    edges += [(name, now[index]) for index, name in points.items() if before[index] != now[index]]
            self._image = image
            yield from sorted(edges)
        line = robot.controller.line
        if self._by_lines and line != self._line:
            self._line = line
            yield "line", line

    def _plan(self, robot: VirtualRobot, tick: int) -> None:
        """Queue every arrival that is due in the next tick, and a look at the schedule just before the one after it."""
        controller = robot.controller
        while self._next < len(self._arrivals):
            arrival = self._arrivals[self._next]
            due = self._anchor_tick + round((arrival.t - self._anchor_t) * TICKS_PER_S)
            if due > tick + 1:
                # Marks until then may move it, so the tick before it is run and looked at again.
                if self._woken != due - 1:
                    self._woken = due - 1
                    controller.put(due - 1, _nothing(robot), "schedule")
                return
            controller.put(tick + 1, arrival.request, "schedule")
            self._next += 1


def _nothing(robot: VirtualRobot) -> MachineRequest:
    """Return a request that changes nothing: a tick is run for it."""
    return signal_write("encoder_speed[0]", robot.signals["encoder_speed[0]"])
