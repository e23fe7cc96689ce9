"""Records what editors show of a run: times of moves and calls, last values of names, shortened blends, alarms."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Mapping
from types import CodeType, FrameType
from typing import Any, Final

from elitescript.assist.last_run import LastRun, LineTime, RunAlarm, ShortenedBlend
from elitescript.language.compiler import CompiledUnit
from elitescript.messages.events import Alarm, Event, MotionEnded, MotionStarted, Warned
from elitescript.messages.motion import RADIUS_SHORTENED
from elitescript.messages.timing import seconds
from elitescript.plotting.packing import shown_text
from elitescript.records import NamedTuple
from elitescript.runtime.alarms import without_addresses

VALUE_MAX: Final = 120
"""Characters of a value."""
NAMES_MAX: Final = 500
"""Names of a scope whose values are kept."""

_BODY: Final = ""
"""Scope of the globals and of the body of the program."""

_SHORTENED: Final = re.compile(re.sub(r"\\\{[^}]*\}", r"(\\S+)", re.escape(RADIUS_SHORTENED)))


class _Function(NamedTuple):
    """A function of the text that runs: its scope, and the line of its `def`."""

    scope: str
    line: int


class RunRecorder:
    """Listens to one run.

    Args:
        unit: the program.
        tick: returns the present tick.
    """

    def __init__(self, unit: CompiledUnit, tick: Callable[[], int]) -> None:
        self._unit = unit
        self._tick = tick
        self._moves: dict[int, LineTime] = {}
        self._calls: dict[int, LineTime] = {}
        self._blends: dict[int, ShortenedBlend] = {}
        self._alarms: list[RunAlarm] = []
        self._under_way: MotionStarted | None = None
        self._functions: dict[CodeType, _Function | None] = {}
        self._begun: dict[FrameType, int] = {}
        """Tick at which each call that is under way began."""
        self._depths: dict[int, int] = {}
        """How many calls of the function in a line are under way: the time of those inside another counts once."""
        self._values: dict[str, dict[str, Any]] = {}

    # ---------------------------------------------------------------- events

    def event(self, event: Event) -> None:
        """Take an event of the robot."""
        if isinstance(event, MotionStarted):
            self._close_move(event.tick)
            self._under_way = event
        elif isinstance(event, MotionEnded):
            self._close_move(event.tick)
        elif isinstance(event, Warned):
            found = _SHORTENED.match(event.text)
            if found is not None:
                self._blends[event.line] = ShortenedBlend(float(found[1]), float(found[2]))
        elif isinstance(event, Alarm):
            self._alarms.append(RunAlarm(event.line, event.code, event.text))

    def _close_move(self, tick: int) -> None:
        move, self._under_way = self._under_way, None
        if move is not None:
            self._moves[move.line] = _added(self._moves.get(move.line), tick - move.tick)

    # ---------------------------------------------------------------- calls

    def __enter__(self) -> None:
        """Begin to listen to the calls of the program's functions."""
        sys.setprofile(self._called)

    def __exit__(self, *_: object) -> None:
        sys.setprofile(None)

    def _called(self, frame: FrameType, what: str, _: object) -> None:
        if what != "call" and what != "return":
            return
        code = frame.f_code
        try:
            function = self._functions[code]
        except KeyError:
            function = self._functions[code] = self._function(code)
        if function is None:
            return
        if what == "call":
            self._begun[frame] = self._tick()
            self._depths[function.line] = self._depths.get(function.line, 0) + 1
            return
        self._values[function.scope] = dict(frame.f_locals)
        begun = self._begun.pop(frame, None)
        if begun is not None:
            depth = self._depths[function.line] = self._depths[function.line] - 1
            ticks = self._tick() - begun if depth == 0 else 0
            self._calls[function.line] = _added(self._calls.get(function.line), ticks)

    def _function(self, code: CodeType) -> _Function | None:
        """Return what a code object is; None if it is no function of the text."""
        if code.co_filename != self._unit.source.name or code.co_name.startswith("<"):
            return None
        return _Function(code.co_name, code.co_firstlineno)

    # ---------------------------------------------------------------- the record

    def record(self, program_globals: Mapping[str, Any], duration_s: float) -> LastRun:
        """Return what was recorded.

        Args:
            program_globals: of the program, at its end.
            duration_s: of the run, in robot time.
        """
        self._close_move(self._tick())
        body = self._values.pop(self._unit.name, {}) | dict(program_globals)
        return LastRun(
            self._unit.source.text,
            duration_s,
            self._moves,
            self._calls,
            {scope: _shown(values) for scope, values in {_BODY: body, **self._values}.items()},
            self._blends,
            tuple(self._alarms),
        )


def _added(time: LineTime | None, ticks: int) -> LineTime:
    before = time or LineTime(0, 0.0)
    return LineTime(before[0] + 1, before.total_s + seconds(ticks))


def _shown(values: Mapping[str, Any]) -> dict[str, str]:
    """Return the values of names as text, without functions and modules."""
    found: dict[str, str] = {}
    for name, value in values.items():
        if len(found) >= NAMES_MAX:
            break
        if name.startswith("_") or callable(value) or type(value).__name__ == "module":
            continue
        try:
            found[name] = shown_text(without_addresses(repr(value)), VALUE_MAX)
        except Exception:
            # The repr of an object of the program is a function of the program.
            found[name] = f"<{type(value).__name__}>"
    return found
