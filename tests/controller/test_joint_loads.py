"""Torques, currents and temperatures of a machine whose joints lag and rub."""

from __future__ import annotations

from random import Random
from typing import Any

import pytest

from elitescript.controller.arm.dynamics import ArmDynamics
from elitescript.controller.controller import Controller
from elitescript.kinematics.dynamics import RigidBody, joint_torques
from elitescript.messages.machine import SetPayload
from elitescript.messages.motion import MoveJ, Six, SpeedJ
from elitescript.messages.plant import PlantConfig
from elitescript.messages.state import ZERO_SIX, Payload
from elitescript.messages.timing import PERIOD_S
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


def test_currents_and_torques_are_to_the_bit_those_of_each_joint_by_itself() -> None:
    numbers = Random(12)
    dynamics = ArmDynamics(MODEL)
    payloads = [Payload(), Payload(2.0, (0.03, -0.02, 0.08)), Payload(4.5, (0.0, 0.1, 0.05))]
    links = [RigidBody(link.mass, link.com, link.inertia) for link in MODEL.links]
    for _ in range(200):
        q, qd, qdd = (six_numbers(numbers) for _ in range(3))
        payload = numbers.choice(payloads)
        carried = RigidBody(payload.mass_kg, payload.cog, payload.inertia)
        torques = dynamics.measured_torques(q, qd, qdd, (0.0, 0.0, 9.82), payload)
        assert repr(torques) == repr(joint_torques(MODEL.arm, links, q, qd, qdd, (0.0, 0.0, 9.82), carried))
        alone = [torque / joint.torque_constant for torque, joint in zip(torques, MODEL.joints, strict=True)]
        assert repr(list(dynamics.currents(torques))) == repr(alone)


def test_accelerations_of_a_lagging_arm_are_to_the_bit_the_differences_of_its_speeds() -> None:
    controller = machine(PlantConfig(lag_s=0.02), PART)
    arm = controller.arm_state
    controller.request_motion(MoveJ(TARGET, 1.4, 1.05), 1, "main")
    for _ in range(200):
        run(controller, 1)
        now, later = arm.joints(controller.tick), arm.joints(controller.tick + 1)
        for found, before, after in (
            (arm.target_acceleration(), now.qd_target, later.qd_target),
            (arm.actual_acceleration(), now.qd_actual, later.qd_actual),
        ):
            assert repr(list(found)) == repr([(b - a) / PERIOD_S for a, b in zip(before, after, strict=True)])


def six_numbers(numbers: Random) -> Six:
    a, b, c, d, e, f = (numbers.choice((0.0, -0.0, numbers.uniform(-3.0, 3.0))) for _ in range(6))
    return (a, b, c, d, e, f)


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
