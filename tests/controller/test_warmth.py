"""Temperatures: closed form, bounds, and that nobody sees how time went."""

from __future__ import annotations

from dataclasses import replace
from math import exp

import pytest

from elitescript.controller.arm.dynamics import ArmDynamics
from elitescript.controller.arm.thermal_model import LOOK_TICKS, PENDING_MAX, ThermalLoad, ThermalModel
from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX, Payload
from elitescript.messages.timing import TICKS_PER_S
from elitescript.models.model import load_model

MODEL = load_model("CS66")
DYNAMICS = ArmDynamics(MODEL)
UP = (0.0, 0.0, 9.82)
STRETCHED: Six = (0.0, 0.0, 0.0, 0.0, 1.5707963, 0.0)
HOUR = 3600 * TICKS_PER_S


def load(q: Six = MODEL.home, speed: float = 0.0, mass: float = 0.0) -> ThermalLoad:
    return ThermalLoad(q, (speed, 0.0, 0.0, 0.0, 0.0, 0.0), ZERO_SIX, UP, Payload(mass))


def warmth() -> ThermalModel:
    return ThermalModel(MODEL, DYNAMICS)


def test_it_begins_without_load() -> None:
    assert warmth().temperatures(0) == (MODEL.joint_temperatures, MODEL.controller_temperature)


def test_a_load_that_lasts_warms_up_exponentially() -> None:
    box = warmth()
    box.look(load(STRETCHED), HOUR)
    torque = DYNAMICS.measured_torques(STRETCHED, ZERO_SIX, ZERO_SIX, UP, Payload())[1]
    rise = MODEL.thermal.joint_rise_torque * (torque / MODEL.joints[1].effort_max) ** 2
    for tick in (0, 1000, HOUR // 3, HOUR):
        expected = 30.0 + rise * (1.0 - exp(-tick / TICKS_PER_S / MODEL.thermal.time_constant_s))
        assert box.temperatures(tick)[0][1] == pytest.approx(expected, abs=1e-9)


def test_windings_and_gear_both_warm_a_joint() -> None:
    ends = []
    for each in (load(), load(mass=6.0), load(speed=1.0), load(speed=-1.0)):
        box = warmth()
        box.look(each, HOUR)
        ends.append(box.temperatures(HOUR))
    still, heavy, turning, back = ends
    assert heavy[0][1] > still[0][1] + 1.0
    assert turning[0][0] > still[0][0] + 1.0
    assert back[0][0] == pytest.approx(turning[0][0], abs=0.01)
    assert min(heavy[1], turning[1]) > still[1]


def test_no_load_that_lasts_is_beyond_what_joints_endure() -> None:
    thermal = MODEL.thermal
    assert 60.0 < max(MODEL.joint_temperatures) + thermal.joint_rise_torque + thermal.joint_rise_speed < 80.0
    box = warmth()
    box.look(load(STRETCHED, 2.0, MODEL.payload_max_kg), 24 * HOUR)
    joints, cabinet = box.temperatures(24 * HOUR)
    assert all(idle <= joint < 80.0 for idle, joint in zip(MODEL.joint_temperatures, joints, strict=True))
    assert MODEL.controller_temperature < cabinet < MODEL.controller_temperature + thermal.controller_rise


def test_without_load_it_cools_down_again() -> None:
    box = warmth()
    box.look(load(STRETCHED, mass=6.0), HOUR)
    hot = box.temperatures(box.next_look)[0][1]
    begin = box.next_look
    weightless = load(STRETCHED)._replace(gravity=(0.0, 0.0, 0.0))
    box.look(weightless, begin + 10 * HOUR)
    assert box.temperatures(begin)[0][1] == hot
    assert box.temperatures(begin + 10 * HOUR)[0][1] == pytest.approx(30.0, abs=1e-6)


def test_many_looks_at_the_same_load_are_one() -> None:
    leaping, stepping = warmth(), warmth()
    leaping.look(load(STRETCHED), HOUR)
    while stepping.next_look < HOUR:
        stepping.look(load(STRETCHED), stepping.next_look + 1)
    assert leaping.next_look == stepping.next_look
    assert leaping.next_look - LOOK_TICKS < HOUR <= leaping.next_look
    assert leaping.temperatures(HOUR) == stepping.temperatures(HOUR)


def test_asking_does_not_change_the_answer() -> None:
    asked, left_alone = warmth(), warmth()
    for number in range(PENDING_MAX + 40):
        each = load(speed=0.001 * number)
        for box in (asked, left_alone):
            box.look(each, box.next_look + 1)
        if number % 7 == 0:
            asked.temperatures(asked.next_look)
    assert asked.temperatures(asked.next_look) == left_alone.temperatures(asked.next_look)


def test_a_slower_arm_is_another_model() -> None:
    slow = replace(MODEL, thermal=replace(MODEL.thermal, time_constant_s=12000.0))
    box, other = ThermalModel(slow, DYNAMICS), warmth()
    for each in (box, other):
        each.look(load(STRETCHED), HOUR)
    assert 30.0 < box.temperatures(HOUR)[0][1] < other.temperatures(HOUR)[0][1]
