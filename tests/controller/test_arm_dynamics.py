"""Torques that a controller reports, at rest and on the way."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import pytest

from elitescript.controller.arm.dynamics import ArmDynamics
from elitescript.controller.controller import Controller
from elitescript.kinematics.dynamics import RigidBody, joint_torques
from elitescript.kinematics.transforms import pose_from_transform
from elitescript.messages.machine import SetGravity, SetPayload, SetSpeedScale
from elitescript.messages.motion import MoveJ, MoveL, Six
from elitescript.messages.state import Payload
from elitescript.messages.timing import PERIOD_S
from elitescript.models.model import load_model

MODEL = load_model("CS66")
LINKS = tuple(RigidBody(link.mass, link.com, link.inertia) for link in MODEL.links)
TARGET: Six = (0.5, -1.2, -1.8, -1.4, 1.5, 0.3)
RATED = SetPayload(6.0, (0.0, 0.0, 0.0))
PART = SetPayload(2.0, (0.03, -0.02, 0.08), (0.004, 0.005, 0.006, 0.0003, -0.0002, 0.0001))
UP = (0.0, 0.0, 9.82)
REST: Six = (0.0,) * 6


def machine(*requests: Any) -> Controller:
    controller = Controller(MODEL, epoch_s=0.0, on_event=lambda event: None)
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


def share_of(load: SetPayload, q: Six, qd: Six, qdd: Six, gravity: tuple[float, float, float] = UP) -> list[float]:
    body = RigidBody(load.mass_kg, load.cog, load.inertia)
    bare, loaded = (joint_torques(MODEL.arm, LINKS, q, qd, qdd, gravity, payload) for payload in (None, body))
    return [b - a for a, b in zip(bare, loaded, strict=True)]


def moving(kind: str, controller: Controller) -> None:
    if kind == "joint":
        controller.request_motion(MoveJ(TARGET, 3.0, 1.5), 3, "main")
    else:
        x, y, z, rx, ry, rz = pose_from_transform(MODEL.arm.forward(MODEL.home))
        controller.request_motion(MoveL((x + 0.15, y + 0.2, z - 0.05, rx, ry, rz + 0.4), 1.2, 0.4), 3, "main")


def test_without_a_payload_nothing_remains() -> None:
    controller = machine()
    moving("line", controller)
    for _ in range(40):
        assert controller.joint_torques() == REST
        run(controller, 7)


def test_at_rest_the_weight_of_the_payload_remains() -> None:
    torques = machine(RATED).joint_torques()
    # The tool points down: what the arm holds with 6 kg less what it holds without.
    assert torques[1:4] == pytest.approx((49.91 - 21.22, 49.91 - 21.22, 7.42 - 1.74), abs=0.011)


def test_the_mounting_turns_the_weight() -> None:
    floor, ceiling, wall = (
        machine(RATED, SetGravity(up)).joint_torques() for up in (UP, (0.0, 0.0, -9.82), (9.82, 0.0, 0.0))
    )
    assert ceiling == pytest.approx([-torque for torque in floor], abs=1e-12)
    assert wall == pytest.approx(share_of(RATED, MODEL.home, REST, REST, (9.82, 0.0, 0.0)), abs=1e-12)
    assert max(abs(a - b) for a, b in zip(wall, floor, strict=True)) > 1.0


@pytest.mark.parametrize("scale", [1.0, 0.4])
@pytest.mark.parametrize("kind", ["joint", "line"])
def test_on_the_way_the_inertia_of_the_payload_counts(kind: str, scale: float) -> None:
    controller = machine(PART, SetSpeedScale(scale))
    run(controller, 100)
    moving(kind, controller)
    seen = []
    while controller.is_moving:
        q, qd = controller.joints().q_target, controller.joints().qd_target
        seen.append((q, qd, controller.joint_torques()))
        run(controller, 1)
    checked = moved = 0
    for before, here, after in zip(seen, seen[1:], seen[2:], strict=False):
        left, right = (
            [(b - a) / PERIOD_S for a, b in zip(one[1], other[1], strict=True)]
            for one, other in pairwise((before, here, after))
        )
        if max(abs(a - b) for a, b in zip(left, right, strict=True)) > 0.1 * scale * scale:
            # A corner of the time law.
            continue
        qdd = tuple(0.5 * (a + b) for a, b in zip(left, right, strict=True))
        assert here[2] == pytest.approx(share_of(PART, here[0], here[1], qdd), abs=0.02)  # type: ignore[arg-type]
        still = share_of(PART, here[0], REST, REST)
        moved += max(abs(a - b) for a, b in zip(here[2], still, strict=True)) > 0.1
        checked += 1
    assert checked > 0.9 * len(seen) > 50
    assert moved > 10


def test_the_first_instant_of_a_move_has_its_full_acceleration() -> None:
    controller = machine(PART)
    controller.request_motion(MoveJ((1.0, *MODEL.home[1:]), 2.0, 1.0), 3, "main")
    qdd: Six = (2.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    assert controller.joint_torques() == pytest.approx(share_of(PART, MODEL.home, REST, qdd), abs=1e-6)


def test_a_new_speed_percentage_accelerates_with_its_ramp() -> None:
    controller = machine(PART)
    controller.request_motion(MoveJ((2.0, *MODEL.home[1:]), 5.0, 1.0), 3, "main")
    run(controller, 100)
    controller.request(SetSpeedScale(0.5))
    run(controller, 10)
    q, qd = controller.joints().q_target, controller.joints().qd_target
    # From 1 to 0.5 rad/s in 0.2 s.
    qdd: Six = (-2.5, 0.0, 0.0, 0.0, 0.0, 0.0)
    assert controller.joint_torques() == pytest.approx(share_of(PART, q, qd, qdd), abs=1e-6)


@pytest.mark.parametrize("kind", ["joint", "line"])
def test_leaping_to_a_tick_gives_the_torques_of_stepping_there(kind: str) -> None:
    for ticks in (1, 30, 77, 150, 400):
        found = []
        for leap in (False, True):
            controller = machine(PART)
            moving(kind, controller)
            run(controller, ticks, leap=leap)
            found.append(controller.joint_torques())
        assert found[0] == found[1]


def test_after_a_move_only_weight_remains() -> None:
    controller = machine(PART)
    moving("joint", controller)
    run(controller, 1000)
    assert not controller.is_moving
    assert controller.joint_torques() == pytest.approx(share_of(PART, TARGET, REST, REST), abs=1e-12)


def test_own_and_remaining_torques_add_up_to_the_measured() -> None:
    dynamics = ArmDynamics(MODEL)
    state = TARGET, (0.3, -0.2, 0.5, 1.0, -1.0, 0.4), (2.0, 1.0, -3.0, 0.5, 4.0, -2.0)
    payload = Payload(PART.mass_kg, PART.cog, PART.inertia)
    own = dynamics.measured_torques(*state, UP, Payload())
    parts = zip(own, dynamics.remaining_torques(*state, UP, payload), strict=True)
    assert dynamics.measured_torques(*state, UP, payload) == pytest.approx([a + b for a, b in parts], abs=1e-12)
    assert own == joint_torques(MODEL.arm, LINKS, *state, UP)
