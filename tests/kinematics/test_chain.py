"""The measured chain: joint axes, linear equations, refinement."""

from __future__ import annotations

import random
from math import hypot, pi

import pytest

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.chain import CalibratedChain, refine, solve_linear
from elitescript.kinematics.inverse import branch_of, solutions, solve_branch
from elitescript.kinematics.jacobian import singularity
from elitescript.kinematics.limits import wrap_to_pi
from elitescript.kinematics.transforms import transform_from_pose

CS66 = Arm(0.1625, -0.427, -0.3905, 0.1475, 0.0965, 0.092)


def measured(rng: random.Random) -> Arm:
    """An arm whose lengths are off by up to 0.3 mm and its twists by up to 0.5 mrad."""
    a, d, alpha = CS66.modified_dh
    return CS66.calibrated(
        [value + rng.uniform(-3e-4, 3e-4) for value in a],
        [value + rng.uniform(-3e-4, 3e-4) for value in d],
        [value + rng.uniform(-5e-4, 5e-4) for value in alpha],
    )


def chain_of(arm: Arm) -> CalibratedChain:
    assert arm.calibration is not None
    return arm.calibration


def regular_joints(rng: random.Random, margin: float) -> tuple[float, float, float, float, float, float]:
    while True:
        q1, q2, q3, q4, q5, q6 = (rng.uniform(-pi, pi) for _ in range(6))
        q = (q1, q2, q3, q4, q5, q6)
        if min(singularity(CS66, q)) > margin:
            return q


def joint_difference(q: tuple[float, ...], q_other: tuple[float, ...]) -> float:
    return max(abs(wrap_to_pi(a - b)) for a, b in zip(q, q_other, strict=True))


def test_joint_directions_are_unit_vectors_and_the_last_is_the_flange_axis() -> None:
    chain = chain_of(measured(random.Random(20)))
    axes, T = chain.axes((0.3, -1.0, 1.2, 0.4, -0.9, 2.0))
    assert len(axes) == 6
    assert all(hypot(*direction) == pytest.approx(1.0, abs=1e-15) for _, direction in axes)
    assert axes[5][1] == (T[2], T[5], T[8])


def test_refinement_reaches_the_pose_to_rounding_from_a_nominal_start() -> None:
    rng = random.Random(21)
    for _ in range(60):
        arm = measured(rng)
        q = regular_joints(rng, margin=0.1)
        T = arm.forward(q)
        start = solve_branch(CS66, T, branch_of(CS66, q))
        if start is None:
            continue
        refined = refine(chain_of(arm), T, start)
        assert refined is not None
        assert arm.forward(refined) == pytest.approx(T, abs=2e-13)
        assert joint_difference(refined, q) < 2e-11


def test_calibrated_inverse_finds_the_joints_that_made_the_pose() -> None:
    rng = random.Random(22)
    for _ in range(60):
        arm = measured(rng)
        q = regular_joints(rng, margin=0.05)
        T = arm.forward(q)
        found = solutions(arm, T)
        assert min(joint_difference(solution.q, q) for solution in found) < 1e-10
        for solution in found:
            assert arm.forward(solution.q) == pytest.approx(T, abs=1e-12)
        one = solve_branch(arm, T, branch_of(arm, q))
        assert one is not None
        assert joint_difference(one, q) < 1e-10


def test_calibrated_inverse_lists_branches_once_and_in_order() -> None:
    rng = random.Random(23)
    for _ in range(20):
        arm = measured(rng)
        branches = [s.branch for s in solutions(arm, arm.forward(regular_joints(rng, margin=0.05)))]
        assert branches == sorted(set(branches))


def test_wrist_singular_pose_of_a_calibrated_arm_is_solved() -> None:
    rng = random.Random(24)
    for _ in range(10):
        arm = measured(rng)
        # The wrist of the nominal arm is singular in this pose, that of the measured one almost.
        T = CS66.forward((0.3, -1.0, -1.2, -0.5, 0.0, 0.7))
        found = solutions(arm, T)
        assert found
        for solution in found:
            assert arm.forward(solution.q) == pytest.approx(T, abs=1e-12)


def test_refinement_of_a_pose_out_of_reach_fails() -> None:
    chain = chain_of(measured(random.Random(25)))
    assert refine(chain, transform_from_pose((2.0, 0.0, 0.3, 0.0, 0.0, 0.0)), (0.0, -1.0, 1.0, 0.0, 1.0, 0.0)) is None


def test_linear_equations_are_solved_whatever_the_order_of_the_rows() -> None:
    rng = random.Random(26)
    for _ in range(20):
        rows = [[rng.uniform(-1, 1) for _ in range(6)] for _ in range(6)]
        rows[0][0] = 0.0
        x = [rng.uniform(-1, 1) for _ in range(6)]
        right = [sum(a * b for a, b in zip(row, x, strict=True)) for row in rows]
        assert solve_linear(rows, right) == pytest.approx(x, abs=1e-9)


def test_singular_equations_have_no_answer() -> None:
    rows = [[1.0, 2.0, 3.0, 4.0, 5.0, 6.0 + (i == 0)] for i in range(6)]
    assert solve_linear(rows, [1.0] * 6) is None
