"""Shows a run to watches while it goes on: a trace that keeps no rows.

What a watch is shown depends on what it needs: signals and lines are shown in the ticks that run, where alone they can
change; the arm in every tick while it moves; the time in every tick.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import sqrt
from typing import Final

from elitescript.controller.controller import Controller
from elitescript.controller.views.trace import Trace, TraceRow
from elitescript.kinematics.jacobian import tcp_twist
from elitescript.kinematics.tcp import tcp_poses
from elitescript.kinematics.transforms import Transform
from elitescript.messages.motion import Six
from elitescript.messages.signals import Value, parse_signal_name
from elitescript.messages.state import ZERO_SIX
from elitescript.messages.timing import TICKS_PER_S
from elitescript.properties.verdicts import Moment, Needs

_SPAN_ROWS: Final = 256
"""Rows that are computed together."""

See = Callable[[Moment], None]


class Monitor(Trace):
    """Shows one run to watches.

    Args:
        sees: what each watch needs, and its `see`.
        step_ticks: ticks from one row of a moving arm to the next.
    """

    __slots__ = (
        "_changes_of_time",
        "_families",
        "_image",
        "_is_due",
        "_moment",
        "_needs",
        "_row_tick",
        "_row_ticks",
        "_see_all",
        "_see_row",
        "_see_time",
        "_start_tick",
        "_tcp_offset",
        "end_tick",
    )

    def __init__(self, sees: Sequence[tuple[Needs, See]], step_ticks: int = 1) -> None:
        super().__init__(_no_row)
        self._row_ticks = step_ticks
        needs = Needs()
        for its, _ in sees:
            needs = needs.with_those_of(its)
        self._needs = needs
        self._see_all = [see for _, see in sees]
        self._see_row = [see for its, see in sees if its.rows]
        self._see_time = [see for its, see in sees if its.time and not its.rows]
        self._changes_of_time = [see for its, see in sees if its.time]
        """Of those that are shown every tick in which the arm rests."""
        self._families: dict[str, list[tuple[int, str]]] = {}
        """Index and name of the points that are needed, by family."""
        for name in sorted(needs.signals):
            row, index = parse_signal_name(name)
            self._families.setdefault(row.name, []).append((index, name))
        self._moment = Moment()
        self._image: Mapping[str, tuple[Value, ...]] = {}
        self._is_due = bool(sees)
        """Whether the present tick is to be shown, whatever has changed."""
        self._start_tick: int | None = None
        self._row_tick = 0
        """The next one of a row of a moving arm."""
        self._tcp_offset: Transform | None = None
        self.end_tick = 0

    def record(self, controller: Controller, until_tick: int) -> None:
        """Show the ticks from the present one up to, not including, `until_tick`."""
        tick, needs, moment = controller.tick, self._needs, self._moment
        if self._start_tick is None:
            self._start_tick = tick
        is_changed, self._is_due = self._is_due, False
        if self._families and self._take_levels(controller.signals.image):
            is_changed = True
        if needs.line and controller.line != moment.line:
            moment.line, is_changed = controller.line, True
        if not needs.rows:
            if is_changed:
                self._show(tick)
            if self._see_time:
                self._show_times(self._see_time, tick + is_changed, until_tick)
        elif controller.is_resting:
            if self._take_rest(controller, tick) or is_changed:
                is_changed = True
                self._show(tick)
            if self._changes_of_time:
                self._show_times(self._changes_of_time, tick + is_changed, until_tick)
        else:
            self._show_rows(controller, tick, until_tick, is_changed=is_changed)
            if self._see_time:
                self._show_times(self._see_time, tick + is_changed, until_tick)

    def finish(self, controller: Controller) -> None:
        """Show the present tick, the last one."""
        self._is_due = True
        self.record(controller, controller.tick + 1)
        self.end_tick = controller.tick

    def _take_levels(self, image: Mapping[str, tuple[Value, ...]]) -> bool:
        """Take in the signals; return whether one that is needed may have changed."""
        before = self._image
        if image is before:
            return False
        self._image, is_changed = image, False
        for family, points in self._families.items():
            values = image[family]
            if values is not before.get(family):
                is_changed = True
                for index, name in points:
                    self._moment.levels[name] = values[index]
        return is_changed

    def _take_rest(self, controller: Controller, tick: int) -> bool:
        """Take in an arm that stands; return whether it stands elsewhere than it was shown, or has another TCP."""
        offset, moment = controller.setup.T_flange_tcp, self._moment
        ((q, qd),) = targets = controller.arm_state.targets(range(tick + 1, tick + 2))
        if offset is self._tcp_offset and q == moment.q and qd == moment.qd:
            return False
        self._take_arm(controller, q, qd, self._poses(controller, targets)[0])
        return True

    def _show_rows(self, controller: Controller, tick: int, until_tick: int, *, is_changed: bool) -> None:
        """Show the ticks of an arm that moves."""
        step = self._row_ticks
        if is_changed:
            targets = controller.arm_state.targets(range(tick + 1, tick + 2))
            self._take_arm(controller, *targets[0], self._poses(controller, targets)[0])
            self._show(tick)
            self._row_tick = max(self._row_tick, tick + 1)
        tick = max(self._row_tick, tick)
        moment, start_tick, sees = self._moment, self._start_tick or 0, self._see_row
        while tick < until_tick:
            ticks = range(tick, min(until_tick, tick + _SPAN_ROWS * step), step)
            targets = controller.arm_state.targets(range(tick + 1, ticks[-1] + 2, step))
            for at, (q, qd), pose in zip(ticks, targets, self._poses(controller, targets), strict=True):
                self._take_arm(controller, q, qd, pose)
                moment.tick, moment.t = at, (at - start_tick) / TICKS_PER_S
                for see in sees:
                    see(moment)
            tick = ticks[-1] + step
        self._row_tick = tick

    def _poses(self, controller: Controller, targets: Sequence[tuple[Six, Six]]) -> Sequence[Six]:
        """Return the poses of the TCP, where they are needed."""
        if not self._needs.pose:
            return [ZERO_SIX] * len(targets)
        return tcp_poses(controller.arm, [q for q, _ in targets], controller.setup.T_flange_tcp)

    def _take_arm(self, controller: Controller, q: Six, qd: Six, pose: Six) -> None:
        """Take in the state of the arm at one tick."""
        moment, offset = self._moment, controller.setup.T_flange_tcp
        moment.q, moment.qd, moment.tcp = q, qd, pose
        self._tcp_offset = offset
        if self._needs.tcp_speed:
            x, y, z, *_ = tcp_twist(controller.arm, q, qd, offset)
            moment.tcp_speed = sqrt(x * x + y * y + z * z)

    def _show(self, tick: int) -> None:
        """Show a tick to every watch."""
        moment = self._moment
        moment.tick, moment.t = tick, (tick - (self._start_tick or 0)) / TICKS_PER_S
        for see in self._see_all:
            see(moment)

    def _show_times(self, sees: Sequence[See], tick: int, until_tick: int) -> None:
        """Show ticks in which nothing but the time changes."""
        moment, start_tick = self._moment, self._start_tick or 0
        for at in range(tick, until_tick):
            moment.tick, moment.t = at, (at - start_tick) / TICKS_PER_S
            for see in sees:
                see(moment)


def _no_row(row: TraceRow) -> None:
    """Take a row: none is made."""
