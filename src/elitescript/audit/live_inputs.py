"""Inputs of a run that goes on: the rows in which something from outside changes, read as those of a recording."""

from __future__ import annotations

from array import array
from collections import ChainMap
from collections.abc import Collection, Mapping
from typing import Any, Final

from elitescript.audit.inputs import RELEASES, SAFETY, SAFETY_ROWS, Arrival, Inputs, inputs_of
from elitescript.audit.series import LINE, SCALING, SLIDER, STATE, TARGETS, recorded
from elitescript.client.rtsi_signals import POINTS
from elitescript.messages.enums import SafetyMode, TaskState
from elitescript.protocol.binary import WireValue
from elitescript.recorder.recording import Recording

_INPUTS: Final = tuple(
    name for name, points in POINTS.items() if "output" not in name and any(points) and name != "tool_analog_output"
)
_WATCHED: Final = (STATE, SLIDER, *SAFETY, *_INPUTS)
"""Variables of which a change is an input."""
_KEPT: Final = (LINE, SCALING, "target_joint_positions", "payload_mass", "payload_cog", "analog_io_types", *POINTS)
_STEADY: Final = (SafetyMode.NORMAL, SafetyMode.REDUCED)

Values = ChainMap[str, WireValue]
"""Of a row; see `LiveRow`."""


class LiveInputs:
    """Finds what comes from outside while rows come.

    Args:
        driven: inputs that devices of the simulated cell set, which are left to them.
        facts: of the controller.
    """

    __slots__ = (
        "_before",
        "_driven",
        "_facts",
        "_given",
        "_kept",
        "_of_rows",
        "_other_before",
        "_other_values",
        "_others",
        "_since",
        "_t0",
        "_times",
    )

    def __init__(self, driven: Collection[str], facts: Mapping[str, Any]) -> None:
        self._driven = driven
        self._facts = facts
        self._t0 = 0.0
        self._times: list[float] = []
        self._kept: list[Values] = []
        """Rows from the last one on in which nothing was under way: those in which something changes, and a few behind
        each."""
        self._of_rows: tuple[str, ...] = ()
        self._others: tuple[str, ...] = ()
        """Watched variables that are in the rows, and those that are not."""
        self._before: tuple[Any, ...] = ()
        self._other_before: tuple[Any, ...] = ()
        self._other_values: Mapping[str, WireValue] = {}
        self._since = 0
        """Rows since the last change."""
        self._given = 0
        """Arrivals of these rows that were returned."""

    def begin(self, t: float, values: Values) -> Inputs:
        """Take the first row of a run, in time of the controller; return how the robot stands."""
        self._t0, self._times, self._kept = t, [t], [values]
        self._of_rows = tuple(name for name in _WATCHED if name in values.maps[0])
        self._others = tuple(name for name in _WATCHED if name not in values.maps[0])
        self._is_changed(values)
        self._since = SAFETY_ROWS + 1
        return self._inputs()

    def take(self, t: float, values: Values) -> list[Arrival]:
        """Take the next row; return what is known by now to have come, times since the program's begin."""
        if self._is_changed(values):
            self._since = 0
        elif self._since > SAFETY_ROWS:
            return []
        self._since += 1
        self._times.append(t)
        self._kept.append(values)
        if self._since <= SAFETY_ROWS:
            # What a pause comes from shows within a few rows.
            return []
        return self._ready(values)

    def end(self) -> list[Arrival]:
        """Return what is left when the program is over: nothing shows any more what it comes from."""
        return self._ready(self._kept[-1])

    def _ready(self, values: Values) -> list[Arrival]:
        shift = self._times[0] - self._t0
        found = [arrival for arrival in self._inputs().arrivals if arrival.row > 0]
        is_paused = values.get(STATE) == TaskState.PAUSED
        ready = []
        for arrival in found[self._given :]:
            if is_paused and arrival.request in RELEASES:
                # A stop is over for the simulated robot when the program goes on.
                break
            ready.append(arrival._replace(t=arrival.t + shift))
        self._given += len(ready)
        if not is_paused and self._given >= len(found) and _mode(values) in _STEADY:
            self._times, self._kept, self._given = self._times[-1:], [values], 0
        return ready

    def _is_changed(self, values: Values) -> bool:
        now = tuple(map(values.maps[0].get, self._of_rows))
        is_changed, self._before = now != self._before, now
        if values.maps[1] is not self._other_values:
            self._other_values = values.maps[1]
            now = tuple(map(self._other_values.get, self._others))
            is_changed, self._other_before = is_changed or now != self._other_before, now
        return is_changed

    def _inputs(self) -> Inputs:
        rows = self._kept
        columns: dict[str, array[float]] = {}
        for name in (*_WATCHED, *_KEPT):
            first = rows[0].get(name)
            if isinstance(first, tuple):
                for place in range(len(first)):
                    columns[f"{name}.{place}"] = array("d", [row[name][place] for row in rows])  # type: ignore[index]
            elif first is not None:
                columns[name] = array("d", [float(row.get(name, first)) for row in rows])  # type: ignore[arg-type]
        recording = Recording(array("d", self._times), array("d", self._times), columns, 250.0, facts=self._facts)
        assert TARGETS[0] in columns
        whole = range(len(rows))
        return inputs_of(recording, whole, recorded(recording, whole), self._driven)


def _mode(values: Values) -> SafetyMode:
    number = next((values[name] for name in SAFETY if name in values), SafetyMode.NORMAL)
    return SafetyMode(int(number)) if number in set(SafetyMode) else SafetyMode.UNDEFINED
