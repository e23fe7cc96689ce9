"""Records the trace of a run: one row for each step of one or more ticks.

The row of a tick shows the state after that tick's motion. Rows are sampled between two ticks that are due, so
recording does not change which ticks are run. Nothing but the arm changes there, so that the rows of such a span share
line, state and signals, and their joints and poses are computed in one pass.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import repeat
from math import inf
from typing import Final

from elitescript.controller.controller import Controller
from elitescript.controller.views.trace_signals import NO_SIGNALS, TraceSignals
from elitescript.errors import UsageError
from elitescript.kinematics.tcp import tcp_poses
from elitescript.kinematics.transforms import IDENTITY, Transform
from elitescript.messages.enums import TaskState
from elitescript.messages.motion import Six
from elitescript.messages.signals import Value
from elitescript.messages.state import ZERO_SIX
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


class TraceSpan(NamedTuple):
    """Rows between two ticks that are due. Of an arm at rest target, pose and measured joints are given once."""

    ticks: range
    is_at_rest: bool
    """Whether the rows differ in their time only."""
    line: int
    targets: Sequence[tuple[Six, Six]]
    """Target joints and their speeds, rad and rad/s."""
    tcp_poses: Sequence[Six]
    state: str
    q_actual: Sequence[Six] | None
    signals: Mapping[str, Value]

    def rows(self) -> Iterator[TraceRow]:
        """Return the rows in the order of time."""
        line, state, signals = self.line, self.state, self.signals
        actual: Iterable[Six | None] = repeat(None) if self.q_actual is None else self.q_actual
        places = zip(self.targets, self.tcp_poses, actual, strict=False)
        for tick, ((q, qd), pose, measured) in zip(
            self.ticks, repeat(next(places)) if self.is_at_rest else places, strict=False
        ):
            yield TraceRow(seconds(tick), line, q, qd, pose, state, measured, signals)


SPAN_ROWS_MAX: Final = 256
"""Rows that are sampled together: so few that all intermediate results stay in the cache of a processor."""


class Trace:
    """Records rows and hands each to `sink`.

    Args:
        sink: receives the rows in order.
        step_s: time from one row to the next, a whole number of ticks; one tick if None.
        signals: signals of the rows; none if None.

    Raises:
        UsageError: an invalid `step_s`.
    """

    __slots__ = ("_T_flange_tcp", "_next_tick", "_pose_at_rest", "_q_at_rest", "_signals", "_sink", "_step_ticks")

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
        self._q_at_rest: Six | None = None
        self._T_flange_tcp: Transform = IDENTITY
        self._pose_at_rest = ZERO_SIX

    def record(self, controller: Controller, until_tick: int) -> None:
        """Record the ticks from the controller's present one up to, not including, `until_tick`."""
        tick = max(self._next_tick, controller.tick)
        while tick < until_tick:
            span = self._span(controller, range(tick, until_tick, self._step_ticks)[: self._rows_max])
            self._take(span)
            tick = span.ticks[-1] + self._step_ticks
        self._next_tick = tick

    def finish(self, controller: Controller) -> None:
        """Record the row of the present tick, the last one."""
        self._next_tick = controller.tick
        self.record(controller, controller.tick + 1)

    @property
    def _rows_max(self) -> int:
        """Rows of the next span at most."""
        return SPAN_ROWS_MAX

    def _take(self, span: TraceSpan) -> None:
        for row in span.rows():
            self._sink(row)

    def _span(self, controller: Controller, ticks: range) -> TraceSpan:
        """Sample the rows of ticks from the present one up to the next that is due."""
        is_at_rest, is_ideal = controller.is_resting, controller.is_plant_ideal
        after = range(ticks[0] + 1, ticks[-1] + 2, ticks.step)
        q_actual: list[Six] | None = None
        if is_ideal and not is_at_rest and len(after) > 1:
            targets = controller.arm_state.targets(after)
        else:
            states = [controller.joints_at(tick) for tick in (after[:1] if is_at_rest else after)]
            targets = [(joints.q_target, joints.qd_target) for joints in states]
            if not is_ideal:
                q_actual = [joints.q_actual for joints in states]
        if is_at_rest:
            poses = [self._pose(controller, targets[0][0])]
        else:
            poses = tcp_poses(controller.arm, [q for q, _ in targets], controller.setup.T_flange_tcp)
        return TraceSpan(
            ticks,
            is_at_rest,
            controller.line,
            targets,
            poses,
            _STATES[controller.task_state],
            q_actual,
            NO_SIGNALS if self._signals is None else self._signals.of(controller.signals.image),
        )

    def _pose(self, controller: Controller, q: Six) -> Six:
        """Return the pose of a resting arm, computed anew only for other joints or another TCP."""
        T_flange_tcp = controller.setup.T_flange_tcp
        if q is not self._q_at_rest or T_flange_tcp is not self._T_flange_tcp:
            self._q_at_rest, self._T_flange_tcp = q, T_flange_tcp
            self._pose_at_rest = controller.tcp_pose(q)
        return self._pose_at_rest


_STATES: Final = {state: state.name.lower() for state in TaskState}
