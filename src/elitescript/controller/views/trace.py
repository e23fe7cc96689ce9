"""Records the trace of a run: one row for each step of one or more ticks.

The row of a tick shows the state after that tick's motion. Rows are sampled between two ticks that are due, so
recording does not change which ticks are run. Nothing but the arm changes there, so that the rows of such a span share
line, state and signals, and their joints are computed in one pass. Poses of the TCP follow from the joints, and are
computed when they are read.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import repeat
from math import inf
from typing import Final

from elitescript.controller.controller import Controller
from elitescript.controller.views.trace_signals import NO_SIGNALS, TraceSignals
from elitescript.errors import UsageError
from elitescript.kinematics.tcp import TcpKinematics
from elitescript.messages.enums import TaskState
from elitescript.messages.motion import Six
from elitescript.messages.signals import Value
from elitescript.messages.timing import LONGEST_S, PERIOD_S, TICKS_PER_S, seconds, ticks_for
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


def window_ticks(window_s: tuple[float, float] | None) -> tuple[int, int]:
    """Return the first tick of a window of time and the one after its last.

    Args:
        window_s: begin and end, s, both included; all time if None.

    Raises:
        UsageError: not two numbers, a begin of at least 0 s and an end that is not before it.
    """
    try:
        begin_s, end_s = (0.0, inf) if window_s is None else map(float, window_s)
    except (TypeError, ValueError):
        raise UsageError(f"the window of a trace is two times in s, begin and end, got {window_s!r}") from None
    if not 0.0 <= begin_s <= end_s or begin_s == inf:
        raise UsageError(f"the window of a trace must begin at >= 0 s and not end before, got {begin_s:g} to {end_s:g}")
    return ticks_for(begin_s), int(min(end_s, LONGEST_S) * TICKS_PER_S + _ROUNDING_TICKS) + 1


_SAME_STEP: Final = 1e-9

_ROUNDING_TICKS: Final = 1e-6
"""A tick that is this little after the end of a window is at its end: the rest is rounding."""


class TraceSpan:
    """Rows between two ticks that are due. Of an arm at rest target, pose and measured joints are given once.

    Args:
        ticks: of the rows.
        is_at_rest: whether the rows differ in their time only.
        line: of the main thread.
        targets: target joints and their speeds, rad and rad/s.
        tcp: gives the poses of the TCP.
        state: of the task.
        q_actual: measured joints, rad; None where actual equals target.
        signals: see `TraceRow`.

    Attributes:
        posed: poses of the TCP if they have been read, m and rad, base frame; else None.
    """

    __slots__ = ("is_at_rest", "line", "posed", "q_actual", "signals", "state", "targets", "tcp", "ticks")

    def __init__(
        self,
        ticks: range,
        is_at_rest: bool,
        line: int,
        targets: Sequence[tuple[Six, Six]],
        tcp: TcpKinematics,
        state: str,
        q_actual: Sequence[Six] | None,
        signals: Mapping[str, Value],
    ) -> None:
        self.ticks = ticks
        self.is_at_rest = is_at_rest
        self.line = line
        self.targets = targets
        self.tcp = tcp
        self.state = state
        self.q_actual = q_actual
        self.signals = signals
        self.posed: Sequence[Six] | None = None

    @property
    def tcp_poses(self) -> Sequence[Six]:
        """Poses of the TCP, m and rad, base frame; computed when they are read first."""
        if self.posed is None:
            self.posed = self.tcp.poses([q for q, _ in self.targets])
        return self.posed

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
        window_s: begin and end of the rows, s, in the time of the robot; only rows in it are sampled. All if None.

    Raises:
        UsageError: an invalid `step_s` or `window_s`.
    """

    __slots__ = (
        "_begin_tick",
        "_end_tick",
        "_next_tick",
        "_rows_max",
        "_signals",
        "_sink",
        "_step_ticks",
        "_tcp",
    )

    def __init__(
        self,
        sink: Callable[[TraceRow], None],
        step_s: float | None = None,
        signals: TraceSignals | None = None,
        window_s: tuple[float, float] | None = None,
    ) -> None:
        self._sink = sink
        self._signals = signals
        self._step_ticks = step_ticks(step_s)
        self._begin_tick, self._end_tick = window_ticks(window_s)
        self._next_tick = self._begin_tick
        self._rows_max = SPAN_ROWS_MAX
        """Rows of the next span at most."""
        self._tcp: TcpKinematics | None = None

    def record(self, controller: Controller, until_tick: int) -> None:
        """Record the ticks from the controller's present one up to, not including, `until_tick`."""
        tick, until_tick = max(self._next_tick, controller.tick), min(until_tick, self._end_tick)
        while tick < until_tick:
            end_tick = min(until_tick, tick + self._rows_max * self._step_ticks)
            ticks = range(tick, end_tick, self._step_ticks)
            self._take(self._span(controller, ticks))
            tick = ticks[-1] + self._step_ticks
        self._next_tick = tick

    def finish(self, controller: Controller) -> None:
        """Record the row of the present tick, the last one."""
        self._next_tick = max(controller.tick, self._begin_tick)
        self.record(controller, controller.tick + 1)

    def _take(self, span: TraceSpan) -> None:
        for row in span.rows():
            self._sink(row)

    def _span(self, controller: Controller, ticks: range) -> TraceSpan:
        """Sample the rows of ticks from the present one up to the next that is due."""
        is_at_rest, is_ideal = controller.is_resting, controller.is_plant_ideal
        q_actual: Sequence[Six] | None = None
        targets: Sequence[tuple[Six, Six]]
        if is_at_rest or len(ticks) == 1:
            joints = controller.joints_at(ticks[0] + 1)
            targets = ((joints.q_target, joints.qd_target),)
            q_actual = None if is_ideal else (joints.q_actual,)
        else:
            if is_ideal:
                targets = controller.arm_state.targets(range(ticks[0] + 1, ticks[-1] + 2, ticks.step))
            else:
                states = [controller.joints_at(tick + 1) for tick in ticks]
                targets = [(joints.q_target, joints.qd_target) for joints in states]
                q_actual = [joints.q_actual for joints in states]
        T_flange_tcp, tcp = controller.setup.T_flange_tcp, self._tcp
        if tcp is None or tcp.T_flange_tcp is not T_flange_tcp or tcp.arm is not controller.arm:
            tcp = self._tcp = TcpKinematics(controller.arm, T_flange_tcp)
        return TraceSpan(
            ticks,
            is_at_rest,
            controller.line,
            targets,
            tcp,
            _STATES[controller.task_state],
            q_actual,
            NO_SIGNALS if self._signals is None else self._signals.of(controller.signals.image),
        )


_STATES: Final = {state: state.name.lower() for state in TaskState}
