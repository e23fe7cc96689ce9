"""Chains of lines that grow while the arm moves: speed kept, limits kept, always able to stop."""

from __future__ import annotations

import random
from math import cos, dist, hypot, pi, radians, sin

import pytest

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.jacobian import Singularity, tcp_twist
from elitescript.kinematics.transforms import Transform, position_of
from elitescript.messages.motion import MoveL, Six
from elitescript.messages.timing import PERIOD_S
from elitescript.motion.blending import blended
from elitescript.motion.paths import track
from elitescript.motion.paths.polyline import DEVIATION_M, LINKS_MAX, Chained, ChainLine, begun, extended
from elitescript.motion.paths.track import JointTrack
from elitescript.motion.planner import plan_movel
from tests.motion.moves import ARM, LIMITS, Q_NEAR_WRIST, Q_WORK, T_FLANGE_TCP, largest_difference, line_by, tcp_pose

A = 1.2


def link(q: Six, pose: Six, v: float, r: float = 0.0) -> ChainLine:
    plan = plan_movel(ARM, LIMITS, q, T_FLANGE_TCP, MoveL(pose, A, v), is_entered=True)
    track = plan.segment.path
    assert isinstance(track, JointTrack)
    return ChainLine(track, plan.law, r)


class Ride:
    """A program that feeds lines as it is asked to, and what the arm does, period by period."""

    def __init__(self, poses: list[Six], v: float, r: float = 0.0) -> None:
        self.setpoints: list[tuple[Six, Six]] = []
        self.positions: list[float] = []
        chain: Chained = begun(link(Q_WORK, poses[0], v, r))
        t_s = 0.0
        fed = 1
        while True:
            while fed < len(poses) and t_s >= chain.feed_s:
                position, speed = chain.segment.profile.at(t_s)
                before = chain.segment.setpoint(t_s)
                chain = extended(
                    ARM, LIMITS, chain.path, position, speed, link(chain.path.q_end, poses[fed], v, r), T_FLANGE_TCP
                )
                t_s = 0.0
                fed += 1
                after = chain.segment.setpoint(0.0)
                assert largest_difference(before.q, after.q) < 1e-12
                assert largest_difference(before.qd, after.qd) < 1e-9
                assert len(chain.path.links) <= LINKS_MAX
            self.setpoints.append(chain.segment.setpoint(t_s))
            self.positions.append(chain.segment.profile.at(t_s)[0])
            if t_s >= chain.segment.duration_s:
                break
            t_s += PERIOD_S
        assert fed == len(poses)
        self.chain = chain
        self.duration_s = (len(self.setpoints) - 1) * PERIOD_S

    def velocities(self) -> list[tuple[float, ...]]:
        return [tcp_twist(ARM, q, qd, T_FLANGE_TCP)[:3] for q, qd in self.setpoints]

    def tcp(self) -> list[tuple[float, ...]]:
        return [position_of(ARM.forward_tcp(q, T_FLANGE_TCP)) for q, _ in self.setpoints]

    def check(self) -> None:
        for (q, qd), (q_next, qd_next) in zip(self.setpoints, self.setpoints[1:], strict=False):
            for joint in range(6):
                a_top = LIMITS.qdd_max[joint]
                assert abs(qd[joint]) <= LIMITS.qd_max[joint] * 1.001
                assert abs(qd_next[joint] - qd[joint]) <= a_top * PERIOD_S * 1.02
                mean = 0.5 * (qd[joint] + qd_next[joint]) * PERIOD_S
                assert abs(q_next[joint] - q[joint] - mean) <= 0.5 * a_top * PERIOD_S**2
        changes = [
            dist(one, other) / PERIOD_S for one, other in zip(self.velocities(), self.velocities()[1:], strict=False)
        ]
        assert max(changes) <= A * 1.001
        assert self.setpoints[-1] == (self.chain.path.q_end, (0.0,) * 6)


def curve(count: int, step: float, bend: float, turn: float = 0.0) -> list[Six]:
    """Steps that each go on at an angle to the one before."""
    x, y, z, rx, ry, rz = tcp_pose(Q_WORK)
    poses = []
    heading = 0.0
    for _ in range(count):
        x, y, rz = x + step * sin(heading), y - step * cos(heading), rz + turn
        poses.append((x, y, z, rx, ry, rz))
        heading += bend
    return poses


@pytest.mark.parametrize("v", [0.006, 0.05, 0.25])
@pytest.mark.parametrize("turn", [0.0, 0.002], ids=["fixed", "turning"])
def test_two_hundred_steps_of_a_straight_seam_keep_the_speed(v: float, turn: float) -> None:
    ride = Ride(curve(200, 0.0015, 0.0, turn), v)
    ride.check()
    # One trapezoid over the whole way, to a period.
    assert ride.duration_s == pytest.approx(0.3 / v + v / A, abs=2.0 * PERIOD_S)
    x = tcp_pose(Q_WORK)[0]
    assert all(abs(place[0] - x) < 1e-9 for place in ride.tcp())


@pytest.mark.parametrize(
    ("v", "bend", "r"), [(0.006, 0.03, 0.0), (0.006, 0.5, 0.0), (0.25, 0.005, 0.0), (0.1, 0.02, 0.0005)]
)
def test_a_curved_seam_keeps_its_mean_speed_within_a_percent(v: float, bend: float, r: float) -> None:
    ride = Ride(curve(200, 0.0015, bend), v, r)
    ride.check()
    # The bending takes some of the acceleration; the ramps are a little longer for it.
    assert 0.3 / v + v / A - 2.0 * PERIOD_S <= ride.duration_s <= 0.3 / v + 1.15 * v / A + 2.0 * PERIOD_S
    ramp = round(1.25 * v / A / PERIOD_S) + 2
    speeds = [hypot(*velocity) for velocity in ride.velocities()[ramp:-ramp]]
    assert sum(speeds) / len(speeds) == pytest.approx(v, rel=0.01)


def test_a_seam_that_bends_too_much_for_its_speed_is_slowed_down_and_not_stopped() -> None:
    ride = Ride(curve(200, 0.0015, 0.1), 0.25)
    ride.check()
    speeds = [hypot(*velocity) for velocity in ride.velocities()]
    middle = speeds[len(speeds) // 4 : -len(speeds) // 4]
    assert 0.05 < min(middle) <= max(middle) < 0.25


@pytest.mark.parametrize("degrees", [10, 45, 90, 135, 170])
def test_a_corner_without_a_radius_is_passed_within_the_deviation(degrees: int) -> None:
    x, y, z, rx, ry, rz = tcp_pose(Q_WORK)
    angle = radians(degrees)
    waypoint = (x, y - 0.05, z, rx, ry, rz)
    end = (x + 0.05 * sin(angle), y - 0.05 - 0.05 * cos(angle), z, rx, ry, rz)
    ride = Ride([waypoint, end], 0.2)
    ride.check()
    path = ride.chain.path
    nearest = min(
        dist(position_of(ARM.forward_tcp(path.q(s), T_FLANGE_TCP)), waypoint[:3])
        for s in [0.045 + 0.00001 * k for k in range(1000)]
    )
    assert nearest <= DEVIATION_M * 1.001


def test_a_radius_rounds_the_corner_from_there_on() -> None:
    x, y, z, rx, ry, rz = tcp_pose(Q_WORK)
    ride = Ride([(x, y - 0.05, z, rx, ry, rz), (x + 0.05, y - 0.05, z, rx, ry, rz)], 0.1, 0.01)
    ride.check()
    outside = [place for place in ride.tcp() if dist(place, (x, y - 0.05, z)) > 0.01]
    assert all(abs(place[0] - x) < 1e-9 or abs(place[1] - y + 0.05) < 1e-9 for place in outside)
    assert min(hypot(*velocity) for velocity in ride.velocities()[20:-40]) > 0.05


def test_a_rotation_on_the_spot_is_a_stop_between_lines() -> None:
    x, y, z, rx, ry, rz = tcp_pose(Q_WORK)
    ride = Ride(
        [(x, y - 0.02, z, rx, ry, rz), (x, y - 0.02, z, rx, ry, rz + 0.2), (x, y - 0.04, z, rx, ry, rz + 0.2)], 0.1
    )
    assert ride.setpoints[-1] == (ride.chain.path.q_end, (0.0,) * 6)
    still = [k for k, place in enumerate(ride.tcp()) if dist(place, (x, y - 0.02, z)) < 1e-9]
    assert len(still) > 20


def test_what_is_known_is_always_enough_to_stop() -> None:
    poses = curve(30, 0.0015, 0.05)
    chain = begun(link(Q_WORK, poses[0], 0.25))
    for pose in poses[1:]:
        # As late as a program can be: the arm is about to stand.
        t_s = 0.9 * chain.segment.duration_s
        position, speed = chain.segment.profile.at(t_s)
        chain = extended(ARM, LIMITS, chain.path, position, speed, link(chain.path.q_end, pose, 0.25), T_FLANGE_TCP)
        assert chain.segment.profile.at(0.0) == (position, speed)
        assert chain.segment.profile.at(chain.segment.duration_s) == (chain.path.length, 0.0)


def test_lines_far_shorter_than_a_period_do_not_stop_the_arm_and_are_known_in_bounded_number() -> None:
    ride = Ride(curve(1500, 0.00003, 0.001), 0.25)
    ride.check()
    # 500 lines ahead are 15 mm, in which an arm can brake from 0.19 m/s.
    speeds = [hypot(*velocity) for velocity in ride.velocities()]
    assert 0.1 < max(speeds) <= 0.25
    assert ride.duration_s < 0.6


def test_random_chains_keep_the_limits() -> None:
    rng = random.Random("chains")
    for _ in range(25):
        x, y, z, rx, ry, rz = tcp_pose(Q_WORK)
        poses = []
        heading, rise = rng.uniform(-pi, pi), 0.0
        for _ in range(rng.randrange(1, 40)):
            step = 10 ** rng.uniform(-4, -2)
            x, y, z = x + step * cos(heading), y + step * sin(heading), z + step * rise
            heading += rng.gauss(0.0, rng.choice((0.0, 0.05, 1.0)))
            rise = rng.uniform(-0.5, 0.5)
            rx, rz = rx + rng.choice((0.0, 0.02)) * rng.random(), rz + rng.choice((0.0, 0.03)) * rng.random()
            poses.append((x, y, z, rx, ry, rz))
        Ride(poses, 10 ** rng.uniform(-2.5, 0), rng.choice((0.0, 0.0005, 0.01))).check()


class Calls:
    """Counts calls of functions, and keeps the arguments that are compared."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.poses: list[Transform] = []
        self.speeds: list[Six] = []
        self.distances = 0
        solve_branch, joint_speeds, singularity = track.solve_branch, track.joint_speeds, track.singularity

        def solve(arm: Arm, T_base_flange: Transform, branch: int, q6_near: float = 0.0) -> Six | None:
            self.poses.append(T_base_flange)
            return solve_branch(arm, T_base_flange, branch, q6_near)

        def speeds(arm: Arm, q: Six, twist: Six, **options: bool) -> Six | None:
            self.speeds.append(twist)
            return joint_speeds(arm, q, twist, **options)

        def distance(arm: Arm, q: Six) -> Singularity:
            self.distances += 1
            return singularity(arm, q)

        monkeypatch.setattr(track, "solve_branch", solve)
        monkeypatch.setattr(track, "joint_speeds", speeds)
        monkeypatch.setattr(track, "singularity", distance)


@pytest.mark.parametrize("turn", [0.0, 0.002], ids=["fixed", "turning"])
def test_a_line_of_a_chain_takes_five_inverse_solutions_and_none_twice(
    turn: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its middle and end; begin, middle and end of its corner."""
    lines = 50
    calls = Calls(monkeypatch)
    poses = curve(lines, 0.0015, 0.01, turn)
    chain = begun(link(Q_WORK, poses[0], 0.05))
    for pose in poses[1:]:
        new = link(chain.path.q_end, pose, 0.05)
        position, speed = chain.segment.profile.at(max(0.0, chain.feed_s))
        chain = extended(ARM, LIMITS, chain.path, position, speed, new, T_FLANGE_TCP)
    assert len(calls.poses) == 2 + 5 * (lines - 1)
    assert len(set(calls.poses)) == len(calls.poses)
    # The same, and the begin of line and corner, whose joints are known.
    assert len(calls.speeds) == 3 + 6 * (lines - 1)
    assert calls.distances == 0


def test_a_blended_line_takes_five_inverse_solutions_and_none_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = Calls(monkeypatch)
    place, pose = curve(2, 0.0015, 0.01)
    first = plan_movel(ARM, LIMITS, Q_WORK, T_FLANGE_TCP, MoveL(place, A, 0.02, 0.0, 0.0005), is_entered=True)
    calls.poses.clear()
    calls.speeds.clear()
    assert first.zone is not None
    request = MoveL(pose, A, 0.02, 0.0, 0.0005)
    second = plan_movel(ARM, LIMITS, first.segment.q_end, T_FLANGE_TCP, request, is_entered=True)
    assert blended(ARM, LIMITS, first, first.segment.time_at(first.zone.begin), second, T_FLANGE_TCP) is not None
    assert len(set(calls.poses)) == len(calls.poses) == 5
    assert len(calls.speeds) == 6
    assert calls.distances == 0


def test_a_move_near_a_singularity_takes_an_inverse_solution_for_each_grid_point(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    calls = Calls(monkeypatch)
    plan = plan_movel(ARM, LIMITS, Q_NEAR_WRIST, T_FLANGE_TCP, line_by(Q_NEAR_WRIST, 0.05, 0.2, -0.05, v=0.5))
    path = plan.segment.path
    assert isinstance(path, JointTrack)
    assert plan.notes
    # The start is known; the place that the note names is solved.
    assert len(calls.poses) == len(path.grid_s) - 1 + len(plan.notes)
    assert len(calls.speeds) == len(path.grid_s)
