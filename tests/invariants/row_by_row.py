"""The plain way to record a trace: every row by itself, from the joints of its tick. The reference for spans."""

from __future__ import annotations

from elitescript.controller.controller import Controller
from elitescript.controller.views.trace import Trace, TraceRow
from elitescript.kinematics.transforms import pose_from_transform
from elitescript.messages.timing import seconds


class RowByRow(Trace):
    """A trace without spans."""

    def record(self, controller: Controller, until_tick: int) -> None:
        tick = max(self._next_tick, controller.tick)
        while tick < until_tick:
            joints = controller.joints_at(tick + 1)
            q = joints.q_target
            signals = {} if self._signals is None else self._signals.of(controller.signals.image)
            self._sink(
                TraceRow(
                    seconds(tick),
                    controller.line,
                    q,
                    joints.qd_target,
                    pose_from_transform(controller.arm.forward_tcp(q, controller.setup.T_flange_tcp)),
                    controller.task_state.name.lower(),
                    None if controller.is_plant_ideal else joints.q_actual,
                    signals,
                )
            )
            tick += self._step_ticks
        self._next_tick = tick
