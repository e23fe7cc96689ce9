"""Examples with devices do their work whenever it is that something goes wrong."""

from __future__ import annotations

import re

import pytest

from elitescript import VirtualRobot
from elitescript.messages.events import Alarm
from tests.invariants.cases import first_of
from tools.record_golden import EXAMPLES

UNDISTURBED = {"parts": 4, "refused": 1}


def robot_with(name):
    return VirtualRobot("CS66", world=EXAMPLES / f"{name}.toml")


def finished(robot, name):
    run = robot.run(EXAMPLES / f"{name}.script", until_s=200)
    assert run.state == "finished"
    assert [event for event in run.events if isinstance(event, Alarm)] == []
    return run


@pytest.mark.parametrize("at_s", first_of([0.0, 1.7, 6.05, 13.02, 24.99, 1.0, 2.3, 5.9, 8.4, 12.15, 23.5, 31.11], 5))
def test_no_part_is_lost_or_made_twice_when_the_cable_of_the_plc_is_pulled(at_s):
    robot = robot_with("plc_handshake")
    robot.fault("disconnect", on=502, at_s=at_s, for_s=2.0)
    run = finished(robot, "plc_handshake")
    assert {name: run.globals[name] for name in UNDISTURBED} == UNDISTURBED
    results = [row.text for row in run.events if getattr(row, "device", "") == "PLC"]
    assert results == [
        f"part of kind {kind}: result {result}" for kind, result in [(1, 1), (3, 1), (7, 2), (2, 1), (1, 1)]
    ]


@pytest.mark.parametrize("at_s", first_of([0.0, 1.1, 13.3, 39.0, 1.02, 6.43, 26.0], 4))
def test_the_camera_may_go_at_any_time(at_s):
    robot = robot_with("camera_picking")
    robot.fault("disconnect", on=5000, at_s=at_s, for_s=3.0)
    assert finished(robot, "camera_picking").globals["picked"] >= 4


@pytest.mark.parametrize("kind", ["corrupt", "drop", "duplicate", "trickle"])
def test_no_wrong_weight_is_believed(kind):
    robot = robot_with("weighing_cell")
    robot.fault(kind, on="box", direction="to_robot", share=0.4)
    run = finished(robot, "weighing_cell")
    assert run.globals["good"] + run.globals["rejected"] + run.globals["unweighed"] == 8
    weights = set(re.findall(r"part \d: ([\d.]+) g", "\n".join(run.log)))
    assert weights
    assert weights <= {"125.1", "124.8", "125.3", "123.9", "124.9", "126.2", "125.0"}


def test_without_a_scale_nothing_is_weighed():
    robot = robot_with("weighing_cell")
    robot.fault("disconnect", on="box")
    run = finished(robot, "weighing_cell")
    assert run.globals["unweighed"] == 8


def test_the_program_gives_up_without_a_camera():
    robot = robot_with("camera_picking")
    robot.fault("refuse", on=5000)
    run = robot.run(EXAMPLES / "camera_picking.script", until_s=200)
    assert run.state == "stopped"
    assert run.time_s < 10


@pytest.mark.parametrize("kind", ["corrupt", "drop", "duplicate"])
def test_rings_are_counted_right_over_a_bad_line(kind):
    robot = robot_with("electric_gripper")
    robot.fault(kind, on="tool", share=0.15)
    run = finished(robot, "electric_gripper")
    assert (run.globals["rings"], run.globals["empty"], run.globals["lost"]) == (2, 1, 1)


@pytest.mark.parametrize("seed", range(8))
def test_parts_are_counted_once_whatever_the_contact_does(seed):
    robot = robot_with("part_counter")
    robot.fault("bouncing", on="switch", settle_s=0.035, bounces=4, seed=seed, at_s=4.0, for_s=4.0)
    robot.fault("noisy", on="standard_digital_in[3]", rate_hz=5, seed=seed)
    run = finished(robot, "part_counter")
    assert run.globals["parts"] == 5
    assert run.globals["edges"] > 70
