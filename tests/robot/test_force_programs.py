"""Programs with force control and hand guiding through the Python interface."""

from __future__ import annotations

from itertools import pairwise

import pytest

from elitescript import VirtualRobot
from elitescript.controller.force.contact import ContactConfig, Plane
from elitescript.messages.plant import PlantConfig

TABLE = ContactConfig((Plane((0.0, 0.0, 0.48), (0.0, 0.0, 1.0), 5e4, 50.0, 0.2),))

POLISH = """
def polish():
  force_mode_set_damping(0.2)
  force_mode([0, 0, 0, 0, 0, 0], [0, 0, 1, 0, 0, 0], [0, 0, -25, 0, 0, 0], 0, [0.1, 0.1, 0.05, 1, 1, 1])
  sleep(1)
  start = get_actual_tcp_pose()
  for n in range(3):
    movel(pose_add(start, [0.05, 0, 0, 0, 0, 0]), a=1, v=0.1)
    movel(start, a=1, v=0.1)
  end
  end_force_mode()
  freedrive_mode([0, 0, 1, 0, 0, 0])
  sleep(2)
  end_freedrive_mode()
  textmsg(get_tcp_force(True), get_actual_tcp_pose())
  movej([0, d2r(-90), d2r(-90), d2r(-90), d2r(90), 0], a=2, v=1)
end
"""


def polish(*, is_stepped: bool = False, plant: PlantConfig | None = None):
    robot = VirtualRobot(contact=TABLE, plant=plant)
    robot.at(4.5, "external_wrench[2]", 30.0)
    robot.at(5.0, "external_wrench[2]", 0.0)
    run = robot.run(POLISH, trace=True, pace=(lambda tick: None) if is_stepped else None)
    assert run.state == "finished"
    return run


@pytest.mark.parametrize("plant", [None, PlantConfig(lag_s=0.01, noise_rad=1e-5, seed=3)], ids=["ideal", "lagging"])
def test_leaping_is_stepping_and_a_second_run_is_the_first(plant):
    leapt, again, stepped = polish(plant=plant), polish(plant=plant), polish(plant=plant, is_stepped=True)
    assert leapt.trace == again.trace == stepped.trace
    assert leapt.events == again.events == stepped.events


def test_a_lagging_arm_presses_with_the_target_all_the_same():
    robot = VirtualRobot(contact=TABLE, plant=PlantConfig(lag_s=0.01))
    run = robot.run("""
def job():
  force_mode([0, 0, 0, 0, 0, 0], [0, 0, 1, 0, 0, 0], [0, 0, -25, 0, 0, 0], 0, [0.1, 0.1, 0.05, 1, 1, 1])
  sleep(3)
  textmsg(round(force(), 2))
end
""")
    assert run.log == ["25.0"]


def test_a_program_that_is_stopped_leaves_the_arm_at_rest():
    robot = VirtualRobot(contact=TABLE)
    robot.start(POLISH)
    robot.advance(1.3)
    robot.stop()
    robot.advance(1.0)
    place = robot.state.tcp_pose_target
    robot.signals["external_wrench[0]"] = 50.0
    robot.advance(1.0)
    assert robot.state.tcp_pose_target == place
    assert not robot.state.is_moving


def test_a_signal_that_is_set_between_two_steps_pushes_the_guided_arm():
    robot = VirtualRobot()
    robot.start("def job():\n  freedrive_mode()\n  sleep(100)\nend\n")
    robot.advance(10.0)
    x = robot.state.tcp_pose_target[0]
    robot.signals["external_wrench[0]"] = 20.0
    robot.advance(1.0)
    robot.signals["external_wrench[0]"] = 0.0
    robot.advance(2.0)
    assert robot.state.tcp_pose_target[0] - x == pytest.approx(0.2, abs=1e-3)
    assert not robot.state.is_moving


def test_a_loop_over_the_force_may_run_in_another_thread():
    robot = VirtualRobot(contact=TABLE)
    run = robot.run("""
def job():
  contact_at = 0
  def watch():
    nonlocal contact_at
    while force() < 5:
      sync()
    end
    contact_at = get_actual_tcp_pose()[2]
  end
  watcher = start_thread(watch, ())
  force_mode([0, 0, 0, 0, 0, 0], [0, 0, 1, 0, 0, 0], [0, 0, -25, 0, 0, 0], 0, [0.1, 0.1, 0.05, 1, 1, 1])
  join_thread(watcher)
  end_force_mode()
  textmsg(round(contact_at, 3))
end
""")
    assert run.log == ["0.48"]


@pytest.mark.parametrize("signal", ["emergency_stop", "safeguard_stop"])
def test_stops_of_the_safety_system_hold_an_arm_that_presses_or_is_guided(signal):
    for program in (POLISH, "def job():\n  freedrive_mode()\n  sleep(100)\nend\n"):
        robot = VirtualRobot(contact=TABLE)
        robot.at(0.1, "external_wrench[0]", 20.0)
        robot.start(program)
        robot.advance(1.3)
        robot.signals[signal] = True
        robot.advance(1.0)
        place = robot.state.tcp_pose_target
        robot.signals["external_wrench[0]"] = 60.0
        robot.advance(1.0)
        assert robot.state.tcp_pose_target == place


def test_an_input_does_not_guide_an_arm_that_may_not_move():
    robot = VirtualRobot()
    robot.run('def job():\n  set_standard_digital_input_action(0, "freedrive")\nend\n')
    robot.signals["external_wrench[0]"] = 20.0
    robot.signals["emergency_stop"] = True
    robot.signals["standard_digital_in[0]"] = True
    place = robot.state.tcp_pose_target
    robot.advance(1.0)
    assert robot.state.tcp_pose_target == place


@pytest.mark.parametrize(
    "change",
    [
        lambda robot: robot.signals.__setitem__("external_wrench[4]", -5.2),
        lambda robot: robot.pause(),
        lambda robot: robot.stop(),
        lambda robot: robot.protective_stop(),
    ],
    ids=["push", "pause", "stop", "protective stop"],
)
def test_what_comes_between_two_ticks_does_not_move_the_arm_in_that_moment(change):
    robot = VirtualRobot("CS66")
    run = robot.start(
        "def p():\n  force_mode([0, 0, 0, 0, 0, 0], [1, 1, 1, 1, 1, 1], [0, 0, 0, 0, 0, 0], 0, "
        "[0.1, 0.1, 0.1, 0.5, 0.5, 0.5])\n  sleep(1)\nend\n",
        trace=True,
    )
    robot.advance(0.02)
    robot.signals["external_wrench[4]"] = 5.2
    robot.advance(0.04)
    before = robot.state
    assert max(map(abs, before.qd_target)) > 0.1
    change(robot)
    after = robot.state
    assert (after.q_target, after.qd_target) == (before.q_target, before.qd_target)
    robot.advance(0.02)
    rows = list(run.trace)
    most = [0.5 * joint.qdd_max * 0.004**2 for joint in robot.model.joints]
    for row, later in pairwise(rows):
        for q, w, q_later, w_later, jump in zip(row.q, row.qd, later.q, later.qd, most, strict=True):
            assert abs(q_later - q - 0.002 * (w + w_later)) <= jump
