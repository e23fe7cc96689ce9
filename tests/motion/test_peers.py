"""Time laws against Ruckig, which finds the quickest motion between two states.

Without a jerk limit its motion is the trapezoid or triangle, so that durations have to agree; positions in between
agree too, since the quickest motion of one joint is unique. The same holds for changes of speed, and for braking. What
is not meant to be the quickest motion, such as following a stream, must not be quicker than it.
"""

from __future__ import annotations

import random
from importlib.metadata import version
from math import inf
from typing import Any

import pytest

from elitescript.messages.motion import MoveJ, Six
from elitescript.messages.timing import PERIOD_S
from elitescript.motion.planner import plan_movej
from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.servo import begun, followed
from elitescript.motion.streaming.speed import accelerated, braked_apart, obstacle_time
from elitescript.motion.timing.profile import trapezoid
from elitescript.motion.timing.pursuit import CatchUp
from elitescript.motion.timing.timescale import TimeScale, stop_ramp
from tests.findings import Finding
from tests.motion.moves import ARM, LIMITS, limits_of, six

ruckig = pytest.importorskip("ruckig")
pytestmark = pytest.mark.peers

CASES = 200
PEER = f"Ruckig {version('ruckig')}"
RANGELESS = limits_of("CS66", q_min=(-1e3,) * 6, q_max=(1e3,) * 6)


def quickest(start: list[float], end: list[float], v: list[float], a: list[float]) -> Any:
    """Ruckig's trajectory from rest to rest."""
    joints = len(start)
    problem = ruckig.InputParameter(joints)
    problem.current_position, problem.target_position = start, end
    problem.max_velocity, problem.max_acceleration, problem.max_jerk = v, a, [inf] * joints
    trajectory = ruckig.Trajectory(joints)
    ruckig.Ruckig(joints).calculate(problem, trajectory)
    return trajectory


def change_of_speed(start: Setpoint, qd_end: Six, a: list[float]) -> Any:
    """Ruckig's trajectory to given speeds, the joints in phase."""
    problem = ruckig.InputParameter(6)
    problem.control_interface = ruckig.ControlInterface.Velocity
    problem.synchronization = ruckig.Synchronization.Phase
    problem.current_position, problem.current_velocity = list(start.q), list(start.qd)
    problem.target_velocity = list(qd_end)
    problem.max_acceleration, problem.max_jerk = a, [inf] * 6
    trajectory = ruckig.Trajectory(6)
    ruckig.Ruckig(6).calculate(problem, trajectory)
    return trajectory


def random_state(rng: random.Random) -> Setpoint:
    q = six(rng.uniform(-2, 2) for _ in range(6))
    return Setpoint(q, six(rng.uniform(-1, 1) * top for top in LIMITS.qd_max))


def test_trapezoid_is_the_quickest_motion(finding: Finding) -> None:
    rng = random.Random(4)
    duration = places = 0.0
    for _ in range(CASES):
        length, v, a = 10 ** rng.uniform(-3, 1), 10 ** rng.uniform(-2, 1), 10 ** rng.uniform(-1, 1.5)
        ours, theirs = trapezoid(length, v, a), quickest([0.0], [length], [v], [a])
        duration = max(duration, abs(ours.duration_s / theirs.duration - 1.0))
        for share in (0.1, 0.4, 0.7, 0.95):
            position, speed, _ = theirs.at_time(share * theirs.duration)
            position_ours, speed_ours = ours.at(share * ours.duration_s)
            places = max(places, abs(position_ours - position[0]), abs(speed_ours - speed[0]))
    assert duration < 1e-9
    assert places < 1e-8
    finding("duration of a trapezoid", f"{PEER}, {CASES} lengths and limits", f"{duration:.1e} of it")
    finding("place and speed within a trapezoid", f"{PEER}, {CASES} lengths and limits", f"{places:.1e}")


def test_movej_of_one_joint_at_its_limits_is_the_quickest() -> None:
    rng = random.Random(5)
    for _ in range(CASES):
        joint = rng.randrange(6)
        q_start = six(rng.uniform(-3, 3) for _ in range(6))
        q_end = six(q + (index == joint) * rng.uniform(-2, 2) for index, q in enumerate(q_start))
        ours = plan_movej(ARM, LIMITS, q_start, MoveJ(q_end, 1e3, 1e3)).segment
        theirs = quickest(list(q_start), list(q_end), list(LIMITS.qd_max), list(LIMITS.qdd_max))
        assert ours.duration_s == pytest.approx(theirs.duration, rel=1e-9)


def test_movej_of_all_joints_is_never_quicker_than_possible(finding: Finding) -> None:
    rng = random.Random(6)
    longest = 1.0
    for _ in range(CASES):
        q_start, q_end = (six(rng.uniform(-3, 3) for _ in range(6)) for _ in range(2))
        ours = plan_movej(ARM, LIMITS, q_start, MoveJ(q_end, 1e3, 1e3)).segment
        theirs = quickest(list(q_start), list(q_end), list(LIMITS.qd_max), list(LIMITS.qdd_max))
        assert theirs.duration * (1.0 - 1e-9) <= ours.duration_s <= 1.05 * theirs.duration
        longest = max(longest, ours.duration_s / theirs.duration)
    finding(
        "`movej` at the limits of all joints",
        f"{PEER}, {CASES} moves",
        f"never quicker than possible; at most {100 * (longest - 1):.1f} % longer, to stay on a straight line",
    )


def test_speedj_reaches_its_speeds_as_quickly_as_possible(finding: Finding) -> None:
    rng = random.Random(7)
    duration = places = 0.0
    for _ in range(CASES):
        start, qd_end = random_state(rng), random_state(rng).qd
        a = 10 ** rng.uniform(-0.5, 1.5)
        ours = accelerated(start, qd_end, a, LIMITS)
        theirs = change_of_speed(start, qd_end, [min(a, top) for top in LIMITS.qdd_max])
        duration = max(duration, abs(ours.duration_s - theirs.duration))
        for share in (0.2, 0.5, 0.9):
            q, qd, _ = theirs.at_time(share * theirs.duration)
            setpoint = ours.at(share * ours.duration_s)
            places = max(places, *(abs(x - y) for x, y in zip((*setpoint.q, *setpoint.qd), (*q, *qd), strict=True)))
    assert duration < 1e-9
    assert places < 1e-8
    finding(
        "`speedj` between random states", f"{PEER}, {CASES} changes of speed", f"{duration:.1e} s, {places:.1e} rad"
    )


def test_braking_apart_stops_each_joint_as_quickly_as_possible(finding: Finding) -> None:
    rng = random.Random(8)
    way = 0.0
    for _ in range(CASES):
        start, deceleration = random_state(rng), rng.uniform(1, 30)
        ours = braked_apart(start, deceleration, RANGELESS)
        for joint in range(6):
            alone = Setpoint(start.q, six(w * (index == joint) for index, w in enumerate(start.qd)))
            theirs = change_of_speed(alone, (0.0,) * 6, [deceleration] * 6)
            way = max(way, abs(ours.at(ours.duration_s).q[joint] - theirs.at_time(theirs.duration)[0][joint]))
            assert ours.ramps_s[joint] == pytest.approx(theirs.duration, abs=1e-9)
    assert way < 1e-9
    finding("where a braking joint comes to rest", f"{PEER}, {CASES} states", f"{way:.1e} rad")


def test_the_last_moment_to_brake_in_front_of_a_range_end_is_the_last_one() -> None:
    rng = random.Random(9)
    met = 0
    for _ in range(CASES):
        start, deceleration = random_state(rng), rng.uniform(2, 20)
        profile = accelerated(start, random_state(rng).qd, rng.uniform(1, 10), LIMITS)
        time_s, joint = obstacle_time(profile, deceleration, LIMITS)
        if not 0.0 < time_s < inf:
            continue
        met += 1
        state = profile.at(time_s)
        end = LIMITS.q_max[joint] if state.qd[joint] > 0.0 else LIMITS.q_min[joint]
        alone = Setpoint(state.q, six(w * (index == joint) for index, w in enumerate(state.qd)))
        theirs = change_of_speed(alone, (0.0,) * 6, [deceleration] * 6)
        assert theirs.at_time(theirs.duration)[0][joint] == pytest.approx(end, abs=1e-6)
    assert met > 0.5 * CASES


def test_a_move_stopped_at_speed_brakes_as_quickly_as_possible() -> None:
    rng = random.Random(10)
    for _ in range(CASES):
        q_start = six(rng.uniform(-2, 2) for _ in range(6))
        q_end = six(q + rng.choice((-1, 1)) * rng.uniform(1, 3) for q in q_start)
        v, a, deceleration = rng.uniform(0.2, 0.9), rng.uniform(2, 5), rng.uniform(3, 8)
        segment = plan_movej(ARM, LIMITS, q_start, MoveJ(q_end, a, v)).segment
        # In the middle nothing is planned to brake before the arm has stopped.
        middle_s = 0.5 * segment.duration_s
        ramp_s = stop_ramp(segment, middle_s, 1.0, deceleration)
        scale = TimeScale.start(0.0, 1.0).with_target(middle_s, 0.0, ramp_s)
        theirs = change_of_speed(segment.setpoint(middle_s), (0.0,) * 6, [deceleration] * 6)
        assert ramp_s == pytest.approx(theirs.duration, rel=2e-3)
        ours = segment.sample(scale.path_time(middle_s + ramp_s))
        assert ours == pytest.approx(theirs.at_time(theirs.duration)[0], abs=2e-3)


def test_servoj_is_never_quicker_than_possible(finding: Finding) -> None:
    rng = random.Random(11)
    least = inf
    for _ in range(CASES // 4):
        start = Setpoint((0.0,) * 6, (0.0,) * 6)
        way = rng.choice((-1, 1)) * 10 ** rng.uniform(-2, 0.3)
        target = six((way, 0, 0, 0, 0, 0))
        window, gain = rng.randrange(8, 51), rng.uniform(100, 2000)
        state, ticks = begun(start)._replace(left=1), 0
        while not state.is_at(target):
            after = followed(state, target, window, gain, LIMITS)
            assert abs(after.q[0]) <= abs(way) + 1e-9
            state, ticks = after, ticks + 1
        theirs = quickest([0.0], [way], [LIMITS.qd_max[0]], [LIMITS.qdd_max[0]])
        least = min(least, ticks * PERIOD_S / theirs.duration)
    assert least >= 1.0
    finding(
        "time in which `servoj` makes a step",
        f"{PEER}, {CASES // 4} steps and settings",
        f"{least:.2f} of the shortest possible, or more; never beyond the target",
    )


def test_catching_up_with_a_conveyor_is_as_quick_as_possible(finding: Finding) -> None:
    rng = random.Random(12)
    duration = places = 0.0
    for _ in range(CASES):
        lag, rate = rng.gauss(0.0, 0.1), rng.gauss(0.0, 0.3)
        acceleration, rate_max = 10 ** rng.uniform(-0.5, 1), 10 ** rng.uniform(-1.5, 0.3)
        ours = CatchUp(lag, rate, acceleration, rate_max)
        problem = ruckig.InputParameter(1)
        problem.current_position, problem.current_velocity, problem.target_position = [lag], [rate], [0.0]
        problem.max_velocity, problem.max_acceleration, problem.max_jerk = [rate_max], [acceleration], [inf]
        theirs = ruckig.Trajectory(1)
        ruckig.Ruckig(1).calculate(problem, theirs)
        duration = max(duration, abs(ours.duration_s - theirs.duration))
        for share in (0.1, 0.4, 0.7, 0.95):
            place, speed, _ = theirs.at_time(share * theirs.duration)
            place_ours, speed_ours = ours.at(share * ours.duration_s)
            places = max(places, abs(place_ours - place[0]), abs(speed_ours - speed[0]))
    assert duration < 1e-9
    assert places < 1e-8
    finding("catching up with a conveyor", f"{PEER}, {CASES} lags and speeds", f"{duration:.1e} s, {places:.1e} m")
