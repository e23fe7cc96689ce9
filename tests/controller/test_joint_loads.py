"""Torques, currents and temperatures of a machine whose joints lag and rub."""

from __future__ import annotations

from typing import Any

import pytest

from elitescript.controller.arm.dynamics import ArmDynamics
from elitescript.controller.controller import Controller
from elitescript.messages.machine import SetPayload
from elitescript.messages.motion import MoveJ, Six, SpeedJ
from elitescript.messages.plant import PlantConfig
from elitescript.messages.state import ZERO_SIX, Payload
from elitescript.models.model import load_model, model_names

MODEL = load_model("CS66")
TARGET: Six = (0.6, -1.2, -1.8, -1.4, 1.5, 0.3)
RUBBING = PlantConfig(viscous_friction=0.2, coulomb_friction=0.1)
PART = SetPayload(2.0, (0.03, -0.02, 0.08))


def machine(plant: PlantConfig | None = None, *requests: Any) -> Controller:
    controller = Controller(MODEL, epoch_s=0.0, on_event=lambda event: None, plant=plant)
    controller.power_up()
    for request in requests:
        controller.request(request)
    return controller


def run(controller: Controller, ticks: int, *, leap: bool = False) -> None:
    end = controller.tick + ticks
    while controller.tick < end:
        controller.run_tick()
        due = controller.next_tick()
        controller.leap((end if due is None else min(due, end)) if leap else controller.tick + 1)
    controller.run_tick()


def turning(plant: PlantConfig | None, speed: float) -> Controller:
    controller = machine(plant, PART)
    controller.request_motion(SpeedJ((speed, 0.0, 0.0, 0.0, 0.0, 0.0), 5.0, 60.0), 1, "main")
    run(controller, 300)
    return controller


@pytest.mark.parametrize("name", model_names())
def test_the_rated_torque_takes_a_current_that_drives_have(name: str) -> None:
    model = load_model(name)
    a, b, c, d, e, f = (joint.effort_max for joint in model.joints)
    assert all(1.0 < current < 35.0 for current in ArmDynamics(model).currents((a, b, c, d, e, f)))


def test_at_rest_currents_hold_the_weight() -> None:
    currents = machine(None, PART).loads.measured(0)[1]
    torques = ArmDynamics(MODEL).measured_torques(
        MODEL.home, ZERO_SIX, ZERO_SIX, MODEL.gravity, Payload(PART.mass_kg, PART.cog)
    )
    assert [c * joint.torque_constant for c, joint in zip(currents, MODEL.joints, strict=True)] == pytest.approx(
        torques
    )
    assert currents == machine(RUBBING, PART).loads.measured(0)[1]


@pytest.mark.parametrize("speed", [1.0, -1.0])
def test_friction_costs_current_in_the_direction_of_motion(speed: float) -> None:
    ideal, rubbing = turning(None, speed), turning(RUBBING, speed)
    base, tick = MODEL.joints[0], ideal.tick
    share = 0.1 + 0.2 * abs(speed) / base.qd_max
    extra = [a - b for a, b in zip(rubbing.loads.measured(tick)[1], ideal.loads.measured(tick)[1], strict=True)]
    expected = speed * share * base.effort_max / base.torque_constant
    assert extra == pytest.approx([expected, 0.0, 0.0, 0.0, 0.0, 0.0], abs=1e-9)


def test_reported_torques_are_corrected_for_friction() -> None:
    ideal, rubbing = turning(None, 1.0), turning(RUBBING, 1.0)
    assert rubbing.joint_torques() == ideal.joint_torques()
    bare = machine(RUBBING)
    bare.request_motion(MoveJ(TARGET, 3.0, 1.5), 1, "main")
    run(bare, 50)
    assert bare.joint_torques() == ZERO_SIX


def test_torques_follow_the_motion_that_happens() -> None:
    ideal, lagging = machine(None, PART), machine(PlantConfig(lag_s=0.05), PART)
    for controller in (ideal, lagging):
        controller.request_motion(MoveJ((1.0, *MODEL.home[1:]), 2.0, 1.0), 1, "main")
    # The target has its full acceleration at once; the joint does not.
    assert abs(ideal.joint_torques()[0]) > 0.1
    assert abs(lagging.joint_torques()[0]) < 0.2 * abs(ideal.joint_torques()[0])
    run(ideal, 600)
    run(lagging, 600)
    assert lagging.joint_torques() == ideal.joint_torques()


@pytest.mark.parametrize("plant", [None, PlantConfig(lag_s=0.02, noise_rad=1e-5, coulomb_friction=0.1)])
def test_stepping_and_leaping_warm_the_joints_alike(plant: PlantConfig | None) -> None:
    found = []
    for leap in (False, True):
        controller = machine(plant, PART)
        controller.request_motion(MoveJ(TARGET, 3.0, 1.5), 1, "main")
        run(controller, 3000, leap=leap)
        controller.request_motion(MoveJ(MODEL.home, 0.5, 0.1), 1, "main")
        run(controller, 7000, leap=leap)
        found.append(
            (controller.joint_temperatures, controller.controller_temperature, controller.loads.measured(10000)[1])
        )
    assert found[0] == found[1]
    assert found[0][0][1] > MODEL.joint_temperatures[1]


def test_an_hour_of_rest_is_one_look() -> None:
    controller = machine()
    run(controller, 900_000, leap=True)
    assert controller.tick == 900_000
    assert controller.joint_temperatures[1] > 30.5
