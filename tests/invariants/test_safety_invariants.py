"""Stops, safeguards, reduced mode and limits at random ticks of random programs: no jump, no limit of the arm exceeded,
nothing left undone, and leaping cannot be told from stepping.

`ELITESCRIPT_INVARIANTS` sets how many cases are tried, a third of that here (10 if unset).
"""

from itertools import pairwise
from random import Random

import pytest

from elitescript import VirtualRobot
from elitescript.controller.safety.limits import SafetyBounds, SafetyLimits, SafetyPlane, ToolDirection
from elitescript.messages.enums import RobotMode, SafetyMode, TaskState
from elitescript.messages.events import Alarm, SafetyModeChanged, TaskStateChanged
from elitescript.messages.machine import AskSafety
from elitescript.messages.plant import PlantConfig
from elitescript.models.model import load_model
from elitescript.runtime.environment import EmptyEnvironment
from tests.invariants.cases import CASES
from tests.invariants.random_programs import random_program

COUNT = CASES // 3
MODEL = load_model("CS66")
PERIOD_S = 0.004

SPEED_TOLERANCE = 5e-3
"""Relative; the limits of Cartesian moves are kept at grid points and almost kept between them."""
ACCELERATION_TOLERANCE = 0.10
"""Relative, for the same reason, and because a ramp of the speed percentage adds to that of the path."""

EMERGENCY = (SafetyMode.ROBOT_EMERGENCY_STOP, SafetyMode.SYSTEM_EMERGENCY_STOP)


def random_limits(chance):
    """Limits of which random programs exceed some."""
    bounds = SafetyBounds(
        qd_max=tuple(chance.uniform(0.3, 3.0) for _ in range(6)) if chance.random() < 0.3 else None,
        tcp_speed_max=chance.uniform(0.1, 1.5) if chance.random() < 0.3 else None,
    )
    planes = tuple(
        SafetyPlane(
            f"plane {number}",
            (chance.uniform(0.2, 0.8), chance.uniform(-0.6, 0.3), chance.uniform(0.1, 0.7)),
            tuple(chance.uniform(-1, 1) for _ in range(3)),
            -0.3,
            chance.choice(("always", "always", "normal", "reduced", "trigger_reduced")),
            chance.choice((None, None, 0, 3)),
        )
        for number in range(chance.randrange(0, 3))
    )
    cone = ToolDirection((0.0, 0.0, -1.0), chance.uniform(0.3, 1.0)) if chance.random() < 0.2 else None
    return SafetyLimits(bounds, SafetyBounds(tcp_speed_max=chance.uniform(0.05, 0.5)), planes, cone)


def outcome(seed, pace):
    chance = Random(f"safety {seed}")
    program = random_program(chance)
    limits = random_limits(chance) if chance.random() < 0.5 else None
    everything = []
    plant = PlantConfig(lag_s=0.03, noise_rad=1e-5, coulomb_friction=0.002) if chance.random() < 0.2 else None
    robot = VirtualRobot(
        "CS66", seed=seed, world=EmptyEnvironment(), safety=limits, plant=plant, on_event=everything.append
    )
    for name in ("safeguard_stop", "reduced_mode", "configurable_digital_in[0]", "configurable_digital_in[1]"):
        if chance.random() < 0.5:
            time_s = chance.uniform(0.0, 3.0)
            robot.at(time_s, name, True)
            robot.at(time_s + chance.uniform(0.0, 1.5), name, False)
    for name in ("emergency_stop", "system_emergency_stop"):
        if chance.random() < 0.3:
            time_s = chance.uniform(0.0, 5.0)
            robot.at(time_s, name, True)
            robot.at(time_s + chance.uniform(0.0, 1.0), name, False)
    if chance.random() < 0.2:
        action = chance.choice(("stop_protectively", "violate", "fail", "restart_safety"))
        robot.controller.put(chance.randrange(0, 1000), AskSafety(action, "by chance"))
    robot.set_speed(chance.choice((1.0, 1.0, 0.4)))
    run = robot.run(program, until_s=40.0, trace=True, pace=pace)
    robot.advance(2.0, pace=pace)
    state = robot.state
    return program, (run.state, run.time_s, run.events, run.trace, run.globals, run.joints, everything, state)


def modes_of(run_events):
    return [event.mode for event in run_events if isinstance(event, SafetyModeChanged)]


@pytest.mark.invariants
@pytest.mark.parametrize("seed", range(max(COUNT, 6)))
def test_stops_keep_continuity_and_limits_and_leaping_equals_stepping(seed):
    program, leaped = outcome(seed, None)
    _, stepped = outcome(seed, lambda tick: None)
    for mine, other in zip(leaped, stepped, strict=True):
        assert mine == other, program
    end, _, events, trace, _, _, everything, state = leaped
    check_motion(trace, program)
    alarms = [event for event in events if isinstance(event, Alarm)]
    assert (end == "alarm") == bool(alarms), program
    for alarm in alarms:
        if alarm.code == "R130":
            assert "the safeguard is open" in alarm.text
            continue
        assert alarm.code in ("R140", "R141", "R142"), (alarm, program)
        assert len(alarm.details["hints"]) == 3
        assert alarm.details["reason"]
    # Whatever happened, two seconds later the arm stands, and after an emergency stop it is without power.
    assert not state.is_moving
    if any(mode in EMERGENCY for mode in modes_of(everything)):
        assert state.robot_mode is RobotMode.POWER_OFF
    # The record goes on while the arm brakes after the end of the program, which such a stop does not change any more.
    ends = [
        at
        for at, event in enumerate(events)
        if isinstance(event, TaskStateChanged) and event.state is TaskState.STOPPED
    ]
    if any(mode in EMERGENCY for mode in modes_of(events[: ends[0]] if ends else events)):
        assert end == "alarm"


def check_motion(trace, program):
    joints = MODEL.joints
    for before, after in pairwise(trace):
        for joint, limit in enumerate(joints):
            q, qd = before.q[joint], before.qd[joint]
            q_next, qd_next = after.q[joint], after.qd[joint]
            where = (program, before.t, joint)
            assert limit.q_min - 1e-6 <= q_next <= limit.q_max + 1e-6, where
            assert abs(qd_next) <= limit.qd_max * (1.0 + SPEED_TOLERANCE), where
            change = limit.qdd_max * PERIOD_S * (1.0 + ACCELERATION_TOLERANCE) + 1e-9
            assert abs(qd_next - qd) <= change, where
            # No jump: the way of a tick is what the speeds at its ends account for.
            assert abs(q_next - q - 0.5 * (qd + qd_next) * PERIOD_S) <= change * PERIOD_S + 1e-9, where


MOTIONS = {
    "movej": "movej([0.9, -1.2, -1.9, -1.3, 1.2, 0.7], a=4, v=2)",
    "movel": "p[0] -= 0.1\n  p[1] += 0.3\n  movel(p, a=2, v=0.6)",
    "movec": "a = pose_trans(p, [0.1, 0.1, 0, 0, 0, 0])\n  movec(a, pose_trans(p, [0.2, 0, 0, 0, 0, 0]), a=1, v=0.3)",
    "speedj": "speedj([0.9, -0.4, 0.3, 0.5, 0.2, -1.5], 5)\n  sleep(0.7)\n  stopj(4)",
    "speedl": "speedl([-0.1, 0.2, 0.05, 0.2, 0, 0.3], 1.5)\n  sleep(0.7)\n  stopl(1.5)",
    "servoj": "q = get_target_joint_positions()\n  for i in range(200):\n    q[0] += 0.003\n    q[4] -= 0.002\n"
    "    servoj(q, t=0.004)\n  end",
    "braking": "speedj([2, 0, 0, 0, 0, 1], 20)\n  stopj(2)",
}
STOPS = ("emergency_stop", "system_emergency_stop", "safeguard_stop", "stop_protectively", "restart_safety")


@pytest.mark.invariants
@pytest.mark.parametrize("stop", STOPS)
@pytest.mark.parametrize("kind", MOTIONS)
def test_each_stop_in_each_kind_of_motion_brakes_without_a_jump_and_the_way_back_works(kind, stop):
    chance = Random(f"{kind} {stop}")
    program = f"def p():\n  p = get_target_tcp_pose()\n  {MOTIONS[kind]}\n  sleep(0.2)\nend\n"
    plain = VirtualRobot("CS66").run(program)
    assert plain.state == "finished", plain.alarms
    for _ in range(max(3, COUNT // 25)):
        tick = chance.randrange(1, int(plain.time_s / PERIOD_S) - 45)
        robot = VirtualRobot("CS66", speed=chance.choice((1.0, 1.0, 0.3)))
        if stop in ("stop_protectively", "restart_safety"):
            robot.controller.put(tick, AskSafety(stop, "by chance"))
        else:
            robot.at(tick * PERIOD_S, stop, True)
            robot.at(tick * PERIOD_S + 1.0, stop, False)
        run = robot.run(program, trace=True)
        check_motion(run.trace, program)
        if len(run.trace) <= tick:
            # With a low speed percentage the arm is at its end sooner, or it has not moved.
            continue
        # The arm stands soon: with 8 rad/s^2, where the ramp of a planned move and that of the stop do not add up, and
        # where no stopj or stopl is under way that was asked for a softer one.
        fastest = max(abs(speed) for row in run.trace[tick - 1 : tick + 100] for speed in row.qd)
        later = run.trace[tick + int(fastest / 2.0 / PERIOD_S) + 25 : tick + 249]
        assert all(speed == 0.0 for row in later for speed in row.qd), tick
        assert run.state == ("finished" if stop == "safeguard_stop" else "alarm")
        robot.advance(5.1)
        if stop == "stop_protectively":
            robot.unlock_protective_stop()
        assert robot.state.safety_mode is SafetyMode.NORMAL
        assert robot.run("def b():\n  movej([0, -1.5708, -1.5708, -1.5708, 1.5708, 0])\nend\n").state == "finished"


@pytest.mark.invariants
@pytest.mark.parametrize("seed", range(max(COUNT, 6)))
def test_reduced_mode_keeps_its_speeds_after_the_grace(seed):
    """Planned moves, speedj and speedl; a stream may be stopped protectively instead."""
    chance = Random(f"reduced {seed}")
    limit = chance.uniform(0.05, 0.4)
    robot = VirtualRobot(
        "CS66", seed=seed, world=EmptyEnvironment(), safety=SafetyLimits(reduced=SafetyBounds(tcp_speed_max=limit))
    )
    begin_s = chance.uniform(0.0, 2.0)
    robot.at(begin_s, "reduced_mode", True)
    run = robot.run(random_program(chance), until_s=60.0, trace=True)
    for before, after in pairwise(run.trace):
        if before.t > begin_s + 0.5 and run.state == "finished":
            way = sum((b - a) ** 2 for a, b in zip(before.tcp_pose[:3], after.tcp_pose[:3], strict=True)) ** 0.5
            assert way / PERIOD_S <= limit * 1.021, before
