"""Computes target and actual joints: nominal motion, corrections, plant.

The nominal motion (`controller.motion.control`) is a function of time. *Corrections* (conveyor tracking, force
control) change it and the *plant* follows the target; both advance tick by tick. While one of them is active every
tick is due, and the next state is computed from the present one. While none is, target and actual are the nominal
setpoint at any tick.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from typing import Final, Protocol

from elitescript.controller.arm.plant import LaggingJoints
from elitescript.controller.motion.control import MotionControl
from elitescript.kinematics.rotations import Vector3
from elitescript.messages.motion import Six
from elitescript.messages.state import JointState
from elitescript.messages.timing import PERIOD_S
from elitescript.motion.segment import Setpoint

_INSTANT_S: Final = 1e-6
"""Time over which the acceleration is taken as constant. Rounding of the speeds makes up some 1e-8 rad/s^2 of the
difference, the bending of a path some 1e-5."""

STANDING_RAD_PER_S: Final = 1e-6
"""Slower joints stand: a law that approaches rest asymptotically never reaches it."""


class Correction(Protocol):
    """Changes the nominal setpoint from tick to tick.

    Pauses and stops are passed to it whether it is active or not.
    """

    @property
    def is_active(self) -> bool:
        """Whether it changes the setpoint; every tick is due then."""

    def peek(self, tick: int, nominal: Setpoint, now: JointState) -> Setpoint:
        """Return the target of a tick, one after the present one; changes nothing.

        Args:
            tick: present tick + 1.
            nominal: its setpoint, changed by the corrections that come before.
            now: joints of the present tick.
        """

    def commit(self, tick: int, nominal: Setpoint, now: JointState, is_resting: bool) -> None:
        """Advance to that tick: take the result of `peek` of the same arguments.

        Args:
            tick: present tick + 1.
            nominal: as for `peek`.
            now: as for `peek`.
            is_resting: whether the nominal motion stands still at that tick and no correction before this one is
                active; only then a correction may end with the arm away from its nominal place, which then becomes
                the place of the arm.
        """

    def pause(self, tick: int) -> None:
        """Come to rest until `resume`: the task is paused."""

    def resume(self, tick: int) -> None:
        """Go on after a pause."""

    def stop(self, tick: int) -> None:
        """Come to rest and end: the program is over."""


class ArmState:
    """Gives target and actual joints from the present tick to the next that is due.

    Args:
        motion: the nominal motion.
        corrections: in the order in which they change it.
        plant: None for joints that follow exactly.
    """

    __slots__ = ("_corrections", "_joints", "_joints_tick", "_motion", "_plant", "_tick")

    def __init__(
        self, motion: MotionControl, corrections: Iterable[Correction] = (), plant: LaggingJoints | None = None
    ) -> None:
        self._motion = motion
        self._corrections = tuple(corrections)
        self._plant = plant
        self._tick = 0
        self._joints_tick = -1
        q, qd = motion.setpoint(0)
        self._joints = JointState(q, qd, q, qd)

    @property
    def has_plant(self) -> bool:
        """Whether actual may differ from target."""
        return self._plant is not None

    @property
    def is_moving(self) -> bool:
        """Whether the target moves, or may move by itself."""
        return self._motion.is_moving or self._is_corrected

    @property
    def is_resting(self) -> bool:
        """Whether target and actual joints stand at the same place until the next request."""
        return not self.is_moving and not self._is_stepped

    @property
    def is_standing(self) -> bool:
        """Whether target and actual joints stand at the present tick, and no nominal motion is under way.

        Every tick may be due all the same: while a resting conveyor is tracked, in force mode, in a pause of an arm
        with a plant.
        """
        if self._motion.next_tick is not None:
            return False
        joints = self.joints(self._tick)
        return max(map(abs, (*joints.qd_target, *joints.qd_actual))) < STANDING_RAD_PER_S

    def turned(self, begin: int, end: int) -> Six | None:
        """Return how far each joint of the target turns between two ticks, rad; see `MotionControl.turned`."""
        return None if self._is_stepped else self._motion.turned(begin, end)

    def tool_way(self, begin: int, end: int) -> tuple[float, float, Vector3] | None:
        """Return how far the tool goes and turns between two ticks; see `MotionControl.tool_way`."""
        return None if self._is_stepped else self._motion.tool_way(begin, end)

    def course(self, begin: int, end: int) -> Hashable | None:
        """Return what the target joints between two ticks follow from; see `MotionControl.course`."""
        return None if self._is_stepped else self._motion.course(begin, end)

    @property
    def next_tick(self) -> int | None:
        """Next tick at which the motion changes by itself; None if it does not."""
        return self._tick + 1 if self._is_stepped else self._motion.next_tick

    def joints(self, tick: int) -> JointState:
        """Return the target and actual joints at a tick from the present one up to the next that is due."""
        if tick > self._tick and self._is_stepped:
            return self._ahead()
        if tick != self._joints_tick:
            q, qd = self._motion.setpoint(tick)
            joints = JointState(q, qd, q, qd)
            if tick != self._tick:
                return joints
            self._joints, self._joints_tick = joints, tick
        return self._joints

    def targets(self, ticks: range) -> list[tuple[Six, Six]]:
        """Return the target joints, rad, and their speeds, rad/s, at many ticks in rising order, as `joints`."""
        if self._is_stepped:
            return [(joints.q_target, joints.qd_target) for joints in map(self.joints, ticks)]
        return self._motion.setpoints(ticks)

    def target_acceleration(self, tick: int | None = None) -> Six:
        """Return the acceleration of the target after a tick, rad/s^2.

        It is the difference of the speeds of this instant and the next (of the next tick, for stepped motions), because
        path, profile and speed percentage all contribute. It uses nothing before the tick, so it does not depend on
        which ticks were run.

        Args:
            tick: the present one if None. Time may have leapt to a later one that has not run, at which a motion may
                have changed: what was before is not known any more then.
        """
        if self._is_stepped:
            ahead_s, before, after = PERIOD_S, self.joints(self._tick), self.joints(self._tick + 1).qd_target
        elif self._motion.is_stepped:
            ahead_s, before, after = PERIOD_S, self.joints(self._tick), self._motion.sample(self._tick + 1).qd
        else:
            tick = self._tick if tick is None else tick
            ahead_s, before = _INSTANT_S, self.joints(tick)
            after = self._motion.sample(tick + _INSTANT_S / PERIOD_S).qd
        return _change(before.qd_target, after, ahead_s)

    def actual_acceleration(self, tick: int | None = None) -> Six:
        """Return the acceleration of the actual joints after a tick, rad/s^2; see `target_acceleration`."""
        if self._plant is None or not self._is_stepped:
            return self.target_acceleration(tick)
        return _change(self.joints(self._tick).qd_actual, self.joints(self._tick + 1).qd_actual, PERIOD_S)

    def settle(self, tick: int) -> None:
        """Advance to a tick that is not later than the next one due, and emit what has ended by then."""
        q_left: Six | None = None
        if tick > self._tick and self._is_stepped:
            q_left = self._step(tick)
        elif tick > self._tick or not self._is_stepped:
            self._joints_tick = -1
        self._tick = tick
        self._motion.settle(tick)
        if q_left is not None:
            self._motion.rebase(q_left)

    def step_before_request(self, tick: int) -> None:
        """Advance to a tick that has not run yet, where the arm is stepped: what is asked now changes the next step.

        The joints of this tick were readable already, and a push or pause in it comes too late to change them.
        """
        if tick > self._tick and self._is_stepped:
            self.settle(tick)

    def pause(self, tick: int) -> None:
        """Come to rest until `resume`."""
        self._motion.pause(tick)
        for correction in self._corrections:
            correction.pause(tick)

    def resume(self, tick: int) -> None:
        """Go on after a pause."""
        self._motion.resume(tick)
        for correction in self._corrections:
            correction.resume(tick)

    def stop(self, tick: int, *, arrives: bool = False) -> None:
        """Come to rest: the program is over.

        Args:
            tick: the present one.
            arrives: whether a move whose call has returned may arrive at its target.
        """
        if arrives:
            self._motion.finish(tick)
        else:
            self._motion.stop(tick)
        for correction in self._corrections:
            correction.stop(tick)

    @property
    def _is_stepped(self) -> bool:
        plant = self._plant
        if plant is not None and not (plant.is_settled and not self.is_moving):
            return True
        return self._is_corrected

    @property
    def _is_corrected(self) -> bool:
        # Read several times in every tick; a generator would take twice as long.
        for correction in self._corrections:  # noqa: SIM110
            if correction.is_active:
                return True
        return False

    def _ahead(self) -> JointState:
        tick, now = self._tick + 1, self.joints(self._tick)
        target = self._motion.setpoint(tick)
        for correction in self._corrections:
            if correction.is_active:
                target = correction.peek(tick, target, now)
        actual = target if self._plant is None else self._plant.peek(tick, target, now)
        return JointState(*target, *actual)

    def _step(self, tick: int) -> Six | None:
        """Advance to the next tick; return the joints where a correction has ended away from the nominal place."""
        now = self.joints(self._tick)
        target = self._motion.setpoint(tick)
        q_left: Six | None = None
        is_resting = self._motion.rests_at(tick)
        for correction in self._corrections:
            if correction.is_active:
                corrected = correction.peek(tick, target, now)
                correction.commit(tick, target, now, is_resting)
                target = corrected
                if correction.is_active:
                    # The corrections after this one build on a target that moves or is away from its nominal place.
                    is_resting = False
                elif is_resting:
                    q_left = target.q
        actual = target
        if self._plant is not None:
            actual = self._plant.peek(tick, target, now)
            self._plant.commit(tick, target, now)
        self._joints, self._joints_tick = JointState(*target, *actual), tick
        return q_left


def _change(before: Six, after: Six, time_s: float) -> Six:
    """Return the mean rate of change over a time, per second."""
    a, b, c, d, e, f = before
    g, h, i, j, k, m = after
    return ((g - a) / time_s, (h - b) / time_s, (i - c) / time_s, (j - d) / time_s, (k - e) / time_s, (m - f) / time_s)
