"""Programs on an arm that lags, rubs and is measured with noise."""

from __future__ import annotations

import gc
from itertools import pairwise
from typing import Any

import pytest

from elitescript import PlantConfig, VirtualRobot
from elitescript.messages.events import LineMarked

REAL = PlantConfig(lag_s=0.02, noise_rad=1e-5, viscous_friction=0.1, coulomb_friction=0.05, seed=4)
PROGRAM = """
global seen
seen = []
def look():
  seen.append([get_actual_joint_positions(), get_actual_joint_speeds(), get_actual_tcp_pose(), get_actual_tcp_speed(),
    get_joint_torques(), get_joint_temperatures(), get_target_joint_positions()])
end
def job():
  set_payload(2, [0.01, 0, 0.05])
  movej([0.4, -1.4, -1.7, -1.6, 1.57, 0], a=3, v=1.5)
  look()
  sleep(0.02)
  look()
  sleep(3)
  look()
  speedj([0.5, 0, 0, 0, 0, 0.5], a=3, t=0.4)
  look()
  stopj(4)
  look()
  speedl([0, 0.1, 0, 0, 0, 0], a=1, t=0.3)
  stopl(1)
  sleep(1.5)
  look()
end
job()
"""


def played(plant: PlantConfig | None, *, steps: bool = False, trace: bool = True) -> Any:
    robot = VirtualRobot("CS66", plant=plant)
    if steps:
        # With a pace, every tick is run.
        return robot.run(PROGRAM, trace=trace, pace=lambda tick: None).check()
    return robot.run(PROGRAM, trace=trace).check()


def test_without_a_plant_actual_is_target_bit_for_bit() -> None:
    for plant in (None, PlantConfig(), PlantConfig(coulomb_friction=0.2, seed=3)):
        run = played(plant)
        assert all(row.q_actual is None for row in run.trace)
        assert all(look[0] == look[6] for look in run.globals["seen"])
    assert played(PlantConfig()).trace == played(None).trace


def test_the_target_does_not_depend_on_the_plant() -> None:
    assert [row[:6] for row in played(REAL).trace] == [row[:6] for row in played(None).trace]


def test_actual_lags_on_the_way_and_arrives() -> None:
    run = played(PlantConfig(lag_s=0.02))
    errors = [max(abs(a - b) for a, b in zip(row.q, row.q_actual, strict=True)) for row in run.trace]
    fastest = max(abs(speed) for row in run.trace for speed in row.qd)
    assert max(errors) == pytest.approx(fastest * 0.02, rel=0.05)
    arrived, soon, later = run.globals["seen"][:3]
    assert arrived[0] != arrived[6]
    assert soon[0] != soon[6]
    assert later[0] == later[6]
    assert later[1] == [0.0] * 6


def test_the_same_seed_gives_the_same_run_whoever_looks() -> None:
    run = played(REAL)
    assert played(REAL).trace == run.trace
    assert played(REAL, trace=False).globals == run.globals
    assert played(PlantConfig(noise_rad=1e-5, seed=5)).trace != played(PlantConfig(noise_rad=1e-5, seed=6)).trace


@pytest.mark.parametrize("plant", [None, REAL, PlantConfig(noise_rad=1e-5), PlantConfig(lag_s=0.1)])
def test_leaping_and_stepping_are_the_same(plant: PlantConfig | None) -> None:
    leapt, stepped = played(plant), played(plant, steps=True)
    assert len(leapt.globals["seen"]) == 6
    assert leapt.trace == stepped.trace
    assert leapt.globals == stepped.globals


def test_it_leaps_again_when_the_joints_have_arrived() -> None:
    robot = VirtualRobot("CS66", plant=REAL)
    ticks = []
    program = "movej([0.4, -1.4, -1.7, -1.6, 1.57, 0], a=3, v=1.5)\nsleep(3600)\n"
    robot.run(program, watch=lambda watched: ticks.append(watched.tick)).check()
    assert ticks[-1] > 900_000
    assert len(ticks) < 400


def test_running_the_same_tick_twice_leaves_the_joints_where_they_are() -> None:
    robot = VirtualRobot("CS66", plant=PlantConfig(lag_s=0.1))
    robot.run("movej([0.4, -1.4, -1.7, -1.6, 1.57, 0], a=3, v=1.5)\n", until_s=0.2)
    here = robot.state.q_actual
    assert here != robot.state.q_target
    robot.controller.run_tick()
    assert robot.state.q_actual == here


def test_a_program_that_starts_while_joints_still_swing_goes_on_with_them() -> None:
    robot = VirtualRobot("CS66", plant=PlantConfig(lag_s=0.1))
    robot.run("movej([0.4, -1.4, -1.7, -1.6, 1.57, 0], a=3, v=1.5)\n").check()
    here = robot.state.q_actual
    run = robot.run("global q\nq = get_actual_joint_positions()\n").check()
    assert tuple(run.globals["q"]) == here != robot.state.q_target


def test_pause_and_resume_with_a_plant_keep_speeds_continuous() -> None:
    robot = VirtualRobot("CS66", plant=PlantConfig(lag_s=0.03))
    robot.start("movej([0.8, -1.4, -1.7, -1.6, 1.57, 0], a=3, v=1.5)\n")
    speeds = []
    for tick in range(500):
        if tick == 60:
            robot.pause()
        if tick == 200:
            robot.resume()
        robot.advance(0.004)
        speeds.append(robot.state.qd_actual)
    steps = [abs(b - a) for one, other in pairwise(speeds) for a, b in zip(one, other, strict=True)]
    assert max(steps) < 10.0 * 0.004
    assert robot.state.q_actual == robot.state.q_target


def test_hours_of_work_leave_nothing_behind() -> None:
    robot = VirtualRobot("CS66", plant=PlantConfig(noise_rad=1e-6))
    robot.start(
        "while True:\n  movej([0.4, -1.4, -1.7, -1.6, 1.57, 0])\n  movej([0, -1.4, -1.7, -1.6, 1.57, 0])\n"
        "  sleep(5)\nend\n"
    )

    def grown() -> int:
        robot.advance(200)
        robot.current.events = [event for event in robot.current.events if isinstance(event, LineMarked)]
        gc.collect()
        return len(gc.get_objects())

    grown()
    first = grown()
    for _ in range(3):
        last = grown()
    assert last - first < 1000


@pytest.mark.parametrize("plant", [None, PlantConfig(lag_s=0.02)])
def test_a_run_that_another_follows_while_the_arm_brakes_has_rows_up_to_the_tick_before(plant):
    robot = VirtualRobot("CS66", plant=plant)
    first = robot.start("def p():\n  movej([-0.4, -1.4, -1.6, -1.4, 1.3, 0.2], a=0.6)\nend\n", trace=True)
    robot.advance(0.2)
    robot.stop()
    robot.advance(0.004)
    assert any(robot.state.qd_target)
    second = robot.start("def q():\n  sleep(0.02)\nend\n", trace=True)
    robot.advance(0.2)
    rows = [*first.trace, *second.trace]
    assert [round(row.t / 0.004) for row in rows] == list(range(len(rows)))
    for row, later in pairwise(rows):
        for q, qd, q_later, qd_later in zip(row.q, row.qd, later.q, later.qd, strict=True):
            assert q_later - q == pytest.approx(0.002 * (qd + qd_later), abs=1e-4)
