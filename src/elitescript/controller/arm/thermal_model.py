"""Models the temperatures of joints and control box (*assumed* throughout).

A body with one time constant approaches the end temperature of the present load,

    T(t) = T_end + (T(t0) - T_end) exp(-(t - t0) / tau)
    T_end = T_idle + rise_torque (torque / rated torque)^2 + rise_speed |speed| / largest speed

for the losses of the windings, proportional to the square of the current, and of the gear. The load is sampled every
`LOOK_TICKS`, at fixed ticks, and holds until another one is found; so a leap gives the same as the ticks that it leaves
out. Temperatures are computed when they are read.
"""

from __future__ import annotations

from math import exp
from typing import Final

from elitescript.controller.arm.dynamics import ArmDynamics
from elitescript.controller.arm.state import ArmState
from elitescript.controller.tool_setup import Setup
from elitescript.messages.motion import Six
from elitescript.messages.state import Payload
from elitescript.messages.timing import PERIOD_S
from elitescript.models.model import RobotModel
from elitescript.records import NamedTuple

LOOK_TICKS: Final = 2503
"""About ten seconds; a prime number, so that a periodic program is not always sampled in the same place."""

PENDING_MAX: Final = 512
"""Loads that are kept before they are evaluated."""


class ThermalLoad(NamedTuple):
    """State and payload of the arm at one instant: rad, rad/s, rad/s^2, m/s^2."""

    q: Six
    qd: Six
    qdd: Six
    gravity: tuple[float, float, float]
    payload: Payload


class ThermalModel:
    """Temperatures of the six joints and of the control box.

    Args:
        model: the arm, with the assumptions about its heat.
        dynamics: the torques that the joints apply under a load.
    """

    __slots__ = ("_dynamics", "_end", "_load", "_model", "_pending", "_since_tick", "_start", "next_look")

    def __init__(self, model: RobotModel, dynamics: ArmDynamics) -> None:
        self._model = model
        self._dynamics = dynamics
        self._pending: list[tuple[int, ThermalLoad]] = []
        self._load: ThermalLoad | None = None
        self._start: tuple[float, ...] = (*model.joint_temperatures, model.controller_temperature)
        self._end: tuple[float, ...] = self._start
        self._since_tick = 0
        self.next_look = 0
        """Next tick whose load counts."""

    def go_on(self, arm_state: ArmState, setup: Setup, until_tick: int) -> None:
        """Sample the loads from `next_look` up to, not including, `until_tick`."""
        while (tick := self.next_look) < until_tick:
            here, after = arm_state.joints(tick), arm_state.joints(tick + 1)
            a, b, c, d, e, f = [
                (later - now) / PERIOD_S for now, later in zip(here.qd_actual, after.qd_actual, strict=True)
            ]
            load = ThermalLoad(here.q_actual, here.qd_actual, (a, b, c, d, e, f), setup.gravity, setup.payload)
            self.look(load, until_tick if arm_state.is_resting else tick + 1)

    def look(self, load: ThermalLoad, until_tick: int) -> None:
        """Take the load of `next_look`, which holds up to, not including, `until_tick`."""
        tick = self.next_look
        self.next_look += max(1, -((tick - until_tick) // LOOK_TICKS)) * LOOK_TICKS
        if load == self._load:
            return
        self._load = load
        self._pending.append((tick, load))
        if len(self._pending) > PENDING_MAX:
            self._work_out()

    def temperatures(self, tick: int) -> tuple[Six, float]:
        """Return the temperatures of the joints and of the control box at a tick, degC."""
        self._work_out()
        a, b, c, d, e, f, box = self._at(tick)
        return (a, b, c, d, e, f), box

    def _work_out(self) -> None:
        for tick, load in self._pending:
            self._start, self._since_tick = self._at(tick), tick
            self._end = self._end_temperatures(load)
        self._pending.clear()

    def _at(self, tick: int) -> tuple[float, ...]:
        left = exp((self._since_tick - tick) * PERIOD_S / self._model.thermal.time_constant_s)
        return tuple([end + (start - end) * left for start, end in zip(self._start, self._end, strict=True)])

    def _end_temperatures(self, load: ThermalLoad) -> tuple[float, ...]:
        model, thermal = self._model, self._model.thermal
        ends = []
        losses = 0.0
        for idle, joint, torque, speed in zip(
            model.joint_temperatures, model.joints, self._dynamics.measured_torques(*load), load.qd, strict=True
        ):
            windings = (torque / joint.effort_max) ** 2
            gear = abs(speed) / joint.qd_max
            ends.append(idle + thermal.joint_rise_torque * windings + thermal.joint_rise_speed * gear)
            losses += windings + gear
        return (*ends, model.controller_temperature + thermal.controller_rise * losses / 6.0)
