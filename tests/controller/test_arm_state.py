"""Nominal setpoint, corrections and plant in one pipeline."""

from __future__ import annotations

import pytest

from elitescript.controller.arm.model_limits import motion_limits
from elitescript.controller.arm.state import ArmState
from elitescript.controller.motion.control import MotionControl
from elitescript.kinematics.transforms import IDENTITY
from elitescript.messages.motion import MoveJ, Six
from elitescript.messages.state import ZERO_SIX, JointState
from elitescript.models.model import load_model
from elitescript.motion.segment import Setpoint

MODEL = load_model("CS66")


class Drift:
    """A correction that turns the base by 0.01 rad a tick for some ticks."""

    def __init__(self, ticks: int) -> None:
        self.left = ticks
        self.gone = 0
        self.peeks = 0
        self.heard: list[str] = []

    @property
    def is_active(self) -> bool:
        return self.left > 0

    def peek(self, tick: int, nominal: Setpoint, now: JointState) -> Setpoint:
        self.peeks += 1
        return Setpoint((nominal.q[0] + 0.01 * (self.gone + 1), *nominal.q[1:]), nominal.qd)

    def commit(self, tick: int, nominal: Setpoint, now: JointState, is_resting: bool) -> None:
        self.gone += 1
        self.left -= self.left > 1 or is_resting

    def pause(self, tick: int) -> None:
        self.heard.append("pause")

    def resume(self, tick: int) -> None:
        self.heard.append("resume")

    def stop(self, tick: int) -> None:
        self.heard.append("stop")
        self.left = min(self.left, 1)


class Halfway:
    """A plant that goes half of what is left in every tick."""

    is_settled = False

    def peek(self, tick: int, target: Setpoint, now: JointState) -> Setpoint:
        a, b, c, d, e, f = [0.5 * (x + y) for x, y in zip(target.q, now.q_actual, strict=True)]
        return Setpoint((a, b, c, d, e, f), ZERO_SIX)

    def commit(self, tick: int, target: Setpoint, now: JointState) -> None:
        self.is_settled = abs(target.q[0] - now.q_actual[0]) < 1e-3


def motion() -> MotionControl:
    return MotionControl(
        MODEL.arm, motion_limits(MODEL), MODEL.home, 8.0, 0.2, lambda event: None, lambda move, is_complete: None
    )


def near(q: Six, base: float) -> None:
    assert q == pytest.approx((base, *MODEL.home[1:]))


def test_without_corrections_target_and_actual_are_nominal_at_any_tick() -> None:
    control = motion()
    arm = ArmState(control)
    control.request(MoveJ((1.0, *MODEL.home[1:]), 1.0, 1.0), 0, IDENTITY, 1, "main")
    assert arm.joints(57).q_target == control.setpoint(57).q == arm.joints(57).q_actual
    assert arm.next_tick == control.next_tick


def test_an_active_correction_makes_every_tick_due_and_looking_ahead_changes_nothing() -> None:
    drift = Drift(3)
    arm = ArmState(motion(), (drift,))
    assert arm.next_tick == 1
    first, again = arm.joints(1), arm.joints(1)
    assert first == again
    arm.settle(1)
    assert arm.joints(1) == first
    near(arm.joints(1).q_target, MODEL.home[0] + 0.01)


def test_the_arm_stays_where_a_correction_has_left_it() -> None:
    arm = ArmState(motion(), (Drift(3),))
    for tick in (1, 2, 3):
        arm.settle(tick)
    assert arm.next_tick is None
    near(arm.joints(500).q_target, MODEL.home[0] + 0.03)


def test_a_correction_ends_only_when_the_nominal_motion_rests() -> None:
    control = motion()
    arm = ArmState(control, (Drift(1),))
    control.request(MoveJ((MODEL.home[0] + 0.1, *MODEL.home[1:]), 8.0, 2.0), 0, IDENTITY, 1, "main")
    tick = 0
    while arm.is_moving:
        tick += 1
        assert arm.next_tick == tick
        arm.settle(tick)
    near(arm.joints(tick).q_target, MODEL.home[0] + 0.1 + 0.01 * tick)


def test_a_correction_that_ends_leaves_the_ones_after_it_where_they_are() -> None:
    arm = ArmState(motion(), (Drift(2), Drift(4)))
    places = []
    for tick in range(1, 8):
        arm.settle(tick)
        places.append(arm.joints(tick).q_target[0] - MODEL.home[0])
    assert places == pytest.approx([0.02, 0.04, 0.05, 0.06, 0.06, 0.06, 0.06])


def test_a_correction_does_not_end_before_those_on_which_it_stands() -> None:
    arm = ArmState(motion(), (Drift(4), Drift(2)))
    places = []
    for tick in range(1, 8):
        arm.settle(tick)
        places.append(arm.joints(tick).q_target[0] - MODEL.home[0])
    assert places == pytest.approx([0.02, 0.04, 0.06, 0.08, 0.08, 0.08, 0.08])


def test_corrections_hear_of_pauses_and_stops_when_they_are_idle() -> None:
    drift = Drift(0)
    arm = ArmState(motion(), (drift,))
    arm.pause(0)
    arm.resume(0)
    arm.stop(0)
    assert drift.heard == ["pause", "resume", "stop"]


def test_an_arm_stands_though_every_tick_is_due_until_something_moves() -> None:
    control = motion()
    arm = ArmState(control, (Drift(10_000),))
    arm.settle(1)
    assert arm.next_tick == 2
    assert arm.is_standing
    control.request(MoveJ((MODEL.home[0] + 0.1, *MODEL.home[1:]), 8.0, 2.0), 1, IDENTITY, 1, "main")
    assert not arm.is_standing


def test_a_plant_lags_behind_until_it_has_settled() -> None:
    control = motion()
    arm = ArmState(control, plant=Halfway())
    control.request(MoveJ((MODEL.home[0] + 0.1, *MODEL.home[1:]), 8.0, 2.0), 0, IDENTITY, 1, "main")
    arm.settle(1)
    arm.settle(2)
    joints = arm.joints(2)
    assert joints.q_actual[0] < joints.q_target[0]
    tick = 2
    while arm.next_tick is not None:
        tick = arm.next_tick
        arm.settle(tick)
    assert arm.joints(tick).q_actual == pytest.approx(arm.joints(tick).q_target, abs=1e-3)
