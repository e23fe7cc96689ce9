"""Records the trace of a run: one row for each step of one or more ticks.

The row of a tick shows the state after that tick's motion. Rows are sampled between two ticks that are due, so
recording does not change which ticks are run.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import inf
from typing import Final

from elitescript.controller.controller import Controller
from elitescript.controller.views.trace_signals import NO_SIGNALS, TraceSignals
from elitescript.errors import UsageError
from elitescript.messages.enums import TaskState
from elitescript.messages.motion import Six
from elitescript.messages.signals import Value
from elitescript.messages.timing import PERIOD_S, seconds, ticks_for
from elitescript.records import NamedTuple


class TraceRow(NamedTuple):
    """One row; rad, rad/s, m, base frame."""

    t: float
    """Time of the tick, s."""
    line: int
    """Line of the main thread; 0 when no program runs."""
    q: Six
    qd: Six
    tcp_pose: Six
    state: str
    """`playing`, `paused` or `stopped`."""
    q_actual: Six | None = None
    """Measured joint positions where there is a plant; None where actual equals target."""
    signals: Mapping[str, Value] = NO_SIGNALS
    """Signals by name after the tick: the chosen ones, or those that are not at their default; then any other reads as
    its default. Rows between two changes share one mapping."""


TRACE_COLUMNS: Final = (
    "t",
    "line",
    *(f"q{joint}" for joint in range(1, 7)),
    *(f"qd{joint}" for joint in range(1, 7)),
    *("x", "y", "z", "rx", "ry", "rz"),
    "state",
)

ACTUAL_COLUMNS: Final = tuple(f"qa{joint}" for joint in range(1, 7))
"""Columns after `TRACE_COLUMNS` where actual may differ from target."""


def step_ticks(step_s: float | None) -> int:
    """Return ticks from one row to the next.

    Args:
        step_s: time from one row to the next; one tick if None.

    Raises:
        UsageError: not a positive whole number of ticks.
    """
    if step_s is None:
        return 1
    if not 0.0 < step_s < inf:
        raise UsageError(f"the trace step must be > 0 s, got {step_s:g}")
    ticks = max(1, ticks_for(step_s))
    if abs(step_s - ticks * PERIOD_S) > _SAME_STEP * step_s:
        near = f"{ticks * PERIOD_S:g} s" if ticks == 1 else f"{(ticks - 1) * PERIOD_S:g} or {ticks * PERIOD_S:g} s"
        raise UsageError(
            f"the trace step must be a whole number of control periods of {PERIOD_S:g} s, got {step_s:g} s: "
            f"choose {near}"
        )
    return ticks


_SAME_STEP: Final = 1e-9


class Trace:
    """Records rows and hands each to `sink`.

    Args:
        sink: receives the rows in order.
        step_s: time from one row to the next, a whole number of ticks; one tick if None.
        signals: signals of the rows; none if None.

    Raises:
        UsageError: an invalid `step_s`.
    """

    __slots__ = ("_next_tick", "_signals", "_sink", "_step_ticks")

    def __init__(
        self,
        sink: Callable[[TraceRow], None],
        step_s: float | None = None,
        signals: TraceSignals | None = None,
    ) -> None:
        self._sink = sink
        self._signals = signals
        self._step_ticks = step_ticks(step_s)
        self._next_tick = 0

    def record(self, controller: Controller, until_tick: int) -> None:
        """Record the ticks from the controller's present one up to, not including, `until_tick`."""
        tick = max(self._next_tick, controller.tick)
        resting: TraceRow | None = None
        while tick < until_tick:
            if resting is None:
                row = self._row(controller, tick)
                if controller.is_resting:
                    resting = row
            else:
                row = resting._replace(t=seconds(tick))
            self._sink(row)
            tick += self._step_ticks
        self._next_tick = tick

    def finish(self, controller: Controller) -> None:
        """Record the row of the present tick, the last one."""
        self._next_tick = controller.tick
        self.record(controller, controller.tick + 1)

    def _row(self, controller: Controller, tick: int) -> TraceRow:
        joints = controller.joints_at(tick + 1)
        q, qd = joints.q_target, joints.qd_target
        return TraceRow(
            seconds(tick),
            controller.line,
            q,
            qd,
            controller.tcp_pose(q),
            _STATES[controller.task_state],
            None if controller.is_plant_ideal else joints.q_actual,
            NO_SIGNALS if self._signals is None else self._signals.of(controller.signals.image),
        )


_STATES: Final = {state: state.name.lower() for state in TaskState}
