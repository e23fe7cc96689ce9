"""The joints along a path, to the last bit as the plainest code finds them: one call for each question."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from math import ceil, pi
from random import Random
from typing import Any

import pytest

from elitescript.errors import MotionError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.inverse import branch_of, reason_unreachable, solve_branch
from elitescript.kinematics.jacobian import joint_speeds, singularity
from elitescript.kinematics.transforms import Transform, compose, pose_from_transform, transform_from_pose
from elitescript.messages.motion import Six
from elitescript.models.model import load_model
from elitescript.motion import refusals
from elitescript.motion.limits import MotionLimits, joint_outside, joint_range_error
from elitescript.motion.paths import track
from elitescript.motion.paths.cartesian import CartesianPath, FlangePath, arc, line
from elitescript.motion.paths.corner import Corner
from elitescript.motion.paths.track import follow
from tests.invariants.cases import CASES
from tests.motion.moves import FULL_TURN, Q_NEAR_WRIST, Q_WORK, limits_of, six

Grid = tuple[list[float], list[Six], list[Six], list[tuple[float, float, float]]]


def plainly_unwrapped(q: Six, near: Six) -> Six:
    return six(angle + FULL_TURN * round((other - angle) / FULL_TURN) for angle, other in zip(q, near, strict=True))


def plainly_sloped(arm: Arm, path: FlangePath, s: float, q: Six) -> Six:
    distance = singularity(arm, q)
    slope = None if distance.blocked else joint_speeds(arm, q, path.flange_and_slope(s)[1])
    if slope is None:
        raise refusals.singular(path, s, distance)
    return slope


def plainly_weighed(
    h: float, q_a: Six, q_b: Six, slope_a: Six, slope_b: Six, limits: MotionLimits, speed: float, acceleration: float
) -> tuple[bool, tuple[float, float, float]]:
    """Whether the interval is too coarse, and its ratios."""
    is_coarse = False
    ratios = [[0.0], [0.0], [0.0]]
    for j in range(6):
        step, da, db = q_b[j] - q_a[j], slope_a[j], slope_b[j]
        error = abs(step - 0.5 * h * (da + db))
        steepest = max(abs(da), abs(db)) + 1.5 * error / h
        curvature = (6.0 * error / h + abs(db - da)) / h
        for row, size, limit in zip(
            ratios,
            (steepest, steepest, curvature),
            (limits.qd_max[j], limits.qdd_max[j], limits.qdd_max[j]),
            strict=True,
        ):
            if size > max(row) * limit:
                row.append(size / limit)
        is_near = (
            steepest * speed > track.NEAR_LIMIT * limits.qd_max[j]
            or steepest * acceleration + curvature * speed * speed > track.NEAR_LIMIT * limits.qdd_max[j]
        )
        excursion = track.RANGE_EXCURSION * h * steepest
        leaves = max(q_a[j], q_b[j]) + excursion > limits.q_max[j] or min(q_a[j], q_b[j]) - excursion < limits.q_min[j]
        is_coarse = (
            is_coarse
            or abs(step) > track.STEP_MAX_RAD
            or abs(db - da) * h > track.BEND_MAX_RAD
            or error > (track.ERROR_FINE_RAD if is_near else track.ERROR_COARSE_RAD)
            or (da * db < 0.0 and excursion > track.RANGE_RESOLUTION_RAD and leaves)
        )
    one, other, third = (row[-1] for row in ratios)
    return is_coarse, (one, other, third)


def plainly_followed(
    arm: Arm, limits: MotionLimits, path: FlangePath, q_start: Six, speed: float, acceleration: float
) -> Grid:
    """What `follow` does, as it was written first."""
    branch, length = branch_of(arm, q_start), path.length
    if solve_branch(arm, path.flange(length), branch) is None:
        reason = reason_unreachable(arm, path.flange(length))
        if reason:
            raise refusals.out_of_reach(path, length, reason)
    joint = joint_outside(limits, q_start)
    if joint is not None:
        raise joint_range_error(limits, joint, q_start[joint], path.place(0.0), hint=refusals.RANGE_HINT)
    slope_start = plainly_sloped(arm, path, 0.0, q_start)
    grid: Grid = [0.0], [q_start], [slope_start], []
    intervals = max(2, ceil(path.way / track.INTERVAL_M), ceil(path.sweep / track.INTERVAL_RAD))
    s_a, q_a, slope_a = 0.0, q_start, slope_start
    for number in range(1, intervals + 1):
        ahead: list[tuple[float, Six | None]] = [(length * number / intervals if number < intervals else length, None)]
        while ahead:
            s_b, solved = ahead[-1]
            if solved is None:
                solved = solve_branch(arm, path.flange(s_b), branch, q_a[5])
                if solved is None:
                    raise refusals.leaves_reach(arm, path, branch, s_a, s_b)
                plainly_sloped(arm, path, s_b, solved)
                ahead[-1] = s_b, solved
            slope_b = plainly_sloped(arm, path, s_b, solved)
            q_b = plainly_unwrapped(solved, q_a)
            h = s_b - s_a
            is_coarse, ratios = plainly_weighed(h, q_a, q_b, slope_a, slope_b, limits, speed, acceleration)
            if is_coarse and h > track.INTERVAL_MIN:
                ahead.append((0.5 * (s_a + s_b), None))
                continue
            if is_coarse and max(abs(b - a) for a, b in zip(q_a, q_b, strict=True)) > refusals.JUMP_RAD:
                raise refusals.jump(path, s_b, q_a, q_b)
            joint = joint_outside(limits, q_b)
            if joint is not None:
                raise refusals.out_of_range(arm, limits, path, branch, joint, s_a, q_a, s_b, q_b)
            ahead.pop()
            for column, value in zip(grid, (s_b, q_b, slope_b, ratios), strict=True):
                column.append(value)  # type: ignore[arg-type]
            s_a, q_a, slope_a = s_b, q_b, slope_b
    return grid


def outcome(call: Callable[[], Any]) -> tuple[Any, ...]:
    """What it returns, with every bit of its numbers, or how it is refused."""
    try:
        return ("followed", *(repr(list(column)) for column in call()))
    except MotionError as error:
        return error.code, str(error), repr(error.value), error.limit, error.unit, error.hint


def grid_of(followed: track.JointTrack) -> tuple[Sequence[Any], ...]:
    return followed.grid_s, followed.grid_q, followed.grid_slope, followed.interval_ratios


ARMS = [
    (load_model(name).arm, limits)
    for name in ("CS63", "CS66", "CS620")
    for limits in (limits_of(name), limits_of(name, qdd_max=(5.0,) * 6))
]


def random_arm(chance: Random) -> tuple[Arm, MotionLimits]:
    arm, limits = chance.choice(ARMS)
    if chance.random() < 0.04:
        arm = arm.calibrated(*[[x + chance.gauss(0.0, 3e-4) for x in row] for row in arm.modified_dh])
    return arm, limits


def random_start(chance: Random) -> Six:
    nearly_singular = six((*Q_NEAR_WRIST[:4], chance.choice((0.0, 0.0005, 0.002, 0.01, 0.05, -0.1, pi)), Q_WORK[5]))
    anywhere = six(chance.uniform(-2.0 * pi, 2.0 * pi) for _ in range(6))
    working = six(q + chance.gauss(0.0, 0.3) for q in Q_WORK)
    stretched = six((0.0, -0.5 * pi, chance.choice((0.0, 1e-3, 0.01)), -0.5 * pi, 0.5 * pi, 0.0))
    at_range_end = six((FULL_TURN - 10.0 ** chance.uniform(-6.0, -1.0), *Q_WORK[1:5], chance.uniform(-1.0, 1.0)))
    return chance.choice((nearly_singular, anywhere, working, working, stretched, at_range_end))


def random_path(chance: Random, arm: Arm, T_base_flange: Transform, T_flange_tcp: Transform) -> CartesianPath | None:
    size = chance.choice((1e-4, 0.0015, 0.02, 0.2, 0.6))
    turn = chance.choice((0.0, min(1.0, 5.0 * size)))
    T_base_tcp = compose(T_base_flange, T_flange_tcp)
    pose = pose_from_transform(T_base_tcp)

    def target() -> Transform:
        return transform_from_pose(
            [x + chance.uniform(-1.0, 1.0) * (size if axis < 3 else turn) for axis, x in enumerate(pose)]
        )

    if chance.random() < 0.7:
        return line(T_base_flange, T_base_tcp, target(), 0.25)
    try:
        return arc(T_base_flange, T_base_tcp, target(), target(), chance.random() < 0.5)
    except MotionError:
        return None


def random_follows(count: int) -> Iterator[tuple[Arm, MotionLimits, FlangePath, Six, float, float]]:
    """Random paths of three arms, and the corners between those that follow one another."""
    for number in range(count):
        chance = Random(f"follow {number}")
        arm, limits = random_arm(chance)
        q_start = random_start(chance)
        tool = [chance.uniform(-0.1, 0.1) for _ in range(3)] + [chance.uniform(-pi, pi) for _ in range(3)]
        T_flange_tcp = transform_from_pose(chance.choice((tool, [0.0, 0.0, 0.15, 0.0, 0.0, 0.0])))
        speed, acceleration = 10.0 ** chance.uniform(-2.0, 0.3), 10.0 ** chance.uniform(-1.0, 1.0)
        path = random_path(chance, arm, arm.forward(q_start), T_flange_tcp)
        if path is None or path.length == 0.0:
            continue
        yield arm, limits, path, q_start, speed, acceleration
        try:
            first = follow(arm, limits, path, q_start, speed, acceleration)
        except MotionError:
            continue
        second = random_path(chance, arm, arm.forward(first.q_end), T_flange_tcp)
        if second is not None and second.length > 0.0:
            d1, d2 = (chance.uniform(0.0, 0.5) * way.length for way in (path, second))
            corner = Corner(path, second, d1, d2, chance.uniform(0.1, 1.0), "s", T_flange_tcp)
            yield arm, limits, corner, first.q(path.length - d1), 1.0, 0.0


@pytest.mark.invariants
def test_random_paths_are_followed_as_by_the_plainest_code() -> None:
    seen: Counter[str] = Counter()
    for case in random_follows(10 * CASES):
        wanted = outcome(lambda: plainly_followed(*case))  # noqa: B023
        found = outcome(lambda: grid_of(follow(*case)))  # noqa: B023
        assert found == wanted
        seen[f"{type(case[2]).__name__} {wanted[0]}"] += 1
    assert {"LinePath followed", "ArcPath followed", "Corner followed"} <= set(seen)
    assert {"R110", "R111", "R112"} <= {what.split()[1] for what in seen}
