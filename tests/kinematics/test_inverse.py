"""All branches, the nearest solution, borders and singular poses."""

from __future__ import annotations

import json
import random
from math import inf, nan, pi
from pathlib import Path
from typing import Any

import pytest

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.inverse import (
    BRANCHES,
    Solution,
    branch_of,
    nearest,
    reason_unreachable,
    solutions,
    solve_branch,
)
from elitescript.kinematics.limits import REACH_TOLERANCE_M, TURN, JointVector, wrap_to_pi
from elitescript.kinematics.transforms import Transform, compose, inverse, transform_from_pose

FILE = json.loads((Path(__file__).parents[1] / "data" / "kinematics_vectors.json").read_text(encoding="utf-8"))
DATA = FILE["models"]
ARMS = {name: Arm(**model["dh"]) for name, model in DATA.items()}
CS66 = ARMS["cs66"]
REGULAR = [(name, vector) for name, model in DATA.items() for vector in model["vectors"] if "solutions" in vector]
SINGULAR = [(name, vector) for name, model in DATA.items() for vector in model["vectors"] if "singular" in vector]
UNREACHABLE = [(name, vector) for name, model in DATA.items() for vector in model["unreachable"]]
FULL_TURNS = ((-TURN, TURN),) * 6


def flange_target(vector: dict[str, Any]) -> Transform:
    return compose(transform_from_pose(vector["tcp_pose"]), inverse(transform_from_pose(vector["tcp_offset"])))


def tolerance(vector: dict[str, Any]) -> float:
    """Joint tolerance: the error of a pose grows with the inverse distance to a singularity."""
    return 1e-8 if vector["kind"].startswith("near-") else 1e-12


def joint_difference(q: JointVector, q_other: Any) -> float:
    return max(abs(wrap_to_pi(a - b)) for a, b in zip(q, q_other, strict=True))


def ids(vectors: list[tuple[str, dict[str, Any]]]) -> list[str]:
    return [vector["id"] for _, vector in vectors]


@pytest.mark.parametrize(("model", "vector"), REGULAR, ids=ids(REGULAR))
def test_all_solutions_of_the_vector_in_canonical_order(model: str, vector: dict[str, Any]) -> None:
    found = solutions(ARMS[model], flange_target(vector))
    assert [solution.branch for solution in found] == vector["branch"]
    for solution, expected in zip(found, vector["solutions"], strict=True):
        assert joint_difference(solution.q, expected) < tolerance(vector)
        assert all(-pi < angle <= pi for angle in solution.q)


@pytest.mark.parametrize(("model", "vector"), REGULAR, ids=ids(REGULAR))
def test_each_branch_alone_equals_its_place_in_the_list(model: str, vector: dict[str, Any]) -> None:
    arm, T = ARMS[model], flange_target(vector)
    listed = {solution.branch: solution.q for solution in solutions(arm, T)}
    assert {branch: solve_branch(arm, T, branch) for branch in range(BRANCHES)} == {
        branch: listed.get(branch) for branch in range(BRANCHES)
    }


@pytest.mark.parametrize(("model", "vector"), REGULAR, ids=ids(REGULAR))
def test_branch_of_names_the_branch_of_every_solution(model: str, vector: dict[str, Any]) -> None:
    for solution in solutions(ARMS[model], flange_target(vector)):
        assert branch_of(ARMS[model], solution.q) == solution.branch


@pytest.mark.parametrize(("model", "vector"), REGULAR, ids=ids(REGULAR))
def test_nearest_solution_of_the_vector_with_full_turns(model: str, vector: dict[str, Any]) -> None:
    expected = vector["nearest"]
    found = nearest(solutions(ARMS[model], flange_target(vector)), expected["qnear"], FULL_TURNS)
    assert found is not None
    assert found.branch == expected["branch"]
    assert found.q == pytest.approx(expected["q"], abs=tolerance(vector))


@pytest.mark.parametrize(("model", "vector"), UNREACHABLE, ids=[f"{n}-{v['reason'][:6]}" for n, v in UNREACHABLE])
def test_unreachable_pose_has_no_solution_and_a_reason(model: str, vector: dict[str, Any]) -> None:
    T = transform_from_pose(vector["tcp_pose"])
    assert solutions(ARMS[model], T) == ()
    assert [solve_branch(ARMS[model], T, branch) for branch in range(BRANCHES)] == [None] * BRANCHES
    expected = "too far by" if vector["reason"].startswith("beyond") else "too near the base axis by"
    assert reason_unreachable(ARMS[model], T).startswith(expected)


def test_manual_example_lists_its_eight_solutions_in_its_order() -> None:
    example = FILE["manual_example"]
    found = solutions(CS66, transform_from_pose(example["tcp_pose"]))
    printed = example["solutions_printed_in_manual"]
    assert [[round(angle, 6) for angle in solution.q] for solution in found] == printed
    assert [solution.branch for solution in found] == list(range(8))
    for solution, exact in zip(found, example["solutions_exact"], strict=True):
        assert solution.q == pytest.approx(exact, abs=1e-12)


def test_manual_example_of_the_nearest_solution() -> None:
    T = transform_from_pose((0.4, -0.2, 0.4, -3.1, 2.8, -1.8))
    found = nearest(solutions(CS66, T), (-0.2, -1.6, -1.4, -1.5, 1.5, -1.6), FULL_TURNS)
    assert found is not None
    assert found.q == pytest.approx((-0.199328, -2.075305, -1.690364, -4.143027, 1.910605, -3.188032), abs=6e-7)


@pytest.mark.parametrize(("model", "vector"), SINGULAR, ids=ids(SINGULAR))
def test_exactly_singular_pose_is_solved_and_the_pose_is_met(model: str, vector: dict[str, Any]) -> None:
    arm, T = ARMS[model], flange_target(vector)
    misses = [
        max(abs(a - b) for a, b in zip(arm.forward(solution.q), T, strict=True)) for solution in solutions(arm, T)
    ]
    assert min(misses) < 1e-12
    # Another branch may lie just beyond the border and be solved there.
    assert max(misses) <= REACH_TOLERANCE_M


def test_singular_wrist_takes_q6_from_the_caller_and_lists_each_elbow_once() -> None:
    q = (0.4, -2.6, 1.3, -0.6, 0.0, 0.9)
    T = CS66.forward(q)
    found = [solution for solution in solutions(CS66, T, q6_near=0.9) if solution.branch < 4]
    assert [solution.branch for solution in found] == [0, 1]
    assert all(solution.q[4] == 0.0 and solution.q[5] == 0.9 for solution in found)
    assert found[0].q == pytest.approx(q, abs=1e-9)
    assert solve_branch(CS66, T, 2, q6_near=0.9) == pytest.approx(found[0].q, abs=1e-15)


@pytest.mark.parametrize("wrist", [0, 2])
def test_singular_wrist_turned_by_half_a_turn_meets_the_pose_in_both_wrist_branches(wrist: int) -> None:
    q = (0.4, -2.6, 1.3, -0.6, pi, 0.9)
    T = CS66.forward(q)
    found = solve_branch(CS66, T, wrist, q6_near=-2.0)
    assert found is not None
    assert found[4] == pi
    assert found[5] == -2.0
    assert CS66.forward(found) == pytest.approx(T, abs=1e-9)


def test_default_q6_of_a_singular_wrist_is_zero() -> None:
    found = solutions(CS66, CS66.forward((0.4, -2.6, 1.3, -0.6, 0.0, 0.9)))
    assert found[0].q[5] == 0.0


def stretched_target(excess: float) -> Transform:
    """A flange target whose joint 4 lies `excess` beyond the reach of a stretched arm."""
    T = CS66.forward((0.3, -0.7, 0.0, -0.8, 1.2, 0.5))
    x, y, z = CS66.elbow((0.3, -0.7, 0.0, 0.0, 0.0, 0.0))
    dx, dy, dz = x / -CS66.a2, y / -CS66.a2, (z - CS66.d1) / -CS66.a2
    return (*T[:9], T[9] + excess * dx, T[10] + excess * dy, T[11] + excess * dz)


@pytest.mark.parametrize("excess", [0.0, 0.5 * REACH_TOLERANCE_M])
def test_stretched_arm_is_solved_at_the_border(excess: float) -> None:
    T = stretched_target(excess)
    listed = {solution.branch: solution.q for solution in solutions(CS66, T)}
    branch = branch_of(CS66, (0.3, -0.7, 0.0, -0.8, 1.2, 0.5))
    assert {branch, branch + 1} <= listed.keys()
    assert CS66.forward(listed[branch]) == pytest.approx(T, abs=excess + 1e-12)
    assert listed[branch] == pytest.approx(listed[branch + 1], abs=1e-6)


def test_pose_beyond_the_tolerance_is_refused_with_the_distance() -> None:
    T = stretched_target(0.0125)
    assert solutions(CS66, T) == ()
    assert reason_unreachable(CS66, T) == (
        "too far by 0.0125 m (wrist joint 1 would be 0.8300 m from the shoulder joint; the arm reaches 0.8175 m)"
    )


def test_shoulder_singular_pose_is_solved_at_the_border() -> None:
    """The wrist centre on the cylinder around the base axis: both shoulder branches meet."""
    wx, wy, wz = 0.0, -CS66.d4, 0.5
    flange_down = (1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0)
    for shortfall in (0.0, 0.5 * REACH_TOLERANCE_M):
        T: Transform = (*flange_down, wx, wy + shortfall, wz - CS66.d6)
        found = solutions(CS66, T)
        assert {solution.branch // 4 for solution in found} == {0, 1}
        for solution in found:
            assert CS66.forward(solution.q) == pytest.approx(T, abs=shortfall + 1e-9)


def test_too_near_the_base_axis_names_the_distance() -> None:
    T: Transform = (1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0, -0.1, 0.5)
    assert reason_unreachable(CS66, T) == (
        "too near the base axis by 0.0475 m (the wrist centre would be 0.1000 m from it; 0.1475 m is the least)"
    )


def test_folded_too_far_names_the_distance() -> None:
    """The wrist centre at the height of the shoulder and on the cylinder: joint 4 is d5 from the shoulder."""
    arm = ARMS["cs616"]
    T: Transform = (1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0, -arm.d4, arm.d1 - arm.d6)
    assert solutions(arm, T) == ()
    assert reason_unreachable(arm, T) == (
        "folded too far by 0.0040 m (wrist joint 1 would be 0.1180 m from the shoulder joint; 0.1220 m is the least)"
    )


def test_reason_is_empty_for_a_reachable_pose() -> None:
    assert reason_unreachable(CS66, CS66.forward((0.3, -1.0, 1.2, 0.4, -0.9, 2.0))) == ""


def test_calibrated_arm_gives_its_reasons_too() -> None:
    arm = CS66.calibrated()
    assert reason_unreachable(arm, stretched_target(0.2)).startswith("too far by 0.2000 m")
    assert reason_unreachable(arm, arm.forward((0.3, -1.0, 1.2, 0.4, -0.9, 2.0))) == ""


@pytest.mark.parametrize("index", range(12))
@pytest.mark.parametrize("value", [nan, inf])
def test_a_target_that_is_not_finite_has_no_solution(index: int, value: float) -> None:
    T = list(CS66.forward((0.3, -1.0, 1.2, 0.4, -0.9, 2.0)))
    T[index] = value
    broken: Transform = tuple(T)  # type: ignore[assignment]
    assert solutions(CS66, broken) == ()
    assert solve_branch(CS66, broken, 0) is None
    assert reason_unreachable(CS66, broken) == "the pose holds a number that is not finite"


def test_wrist_centre_on_the_base_axis_itself_has_no_solution() -> None:
    T: Transform = (1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.5)
    assert solutions(CS66, T) == ()
    assert reason_unreachable(CS66, T).startswith("too near the base axis by 0.1475 m")


def test_nearest_drops_solutions_that_no_turn_brings_into_range() -> None:
    inside = Solution(3, (0.5, 0.0, 0.0, 0.0, 0.0, 0.0))
    outside = Solution(0, (0.0, 2.0, 0.0, 0.0, 0.0, 0.0))
    ranges = ((-1.0, 1.0),) * 6
    assert nearest((outside, inside), (0.0,) * 6, ranges) == inside
    assert nearest((outside,), (0.0,) * 6, ranges) is None
    assert nearest((), (0.0,) * 6, ranges) is None


def test_nearest_takes_the_first_on_a_tie() -> None:
    low, high = Solution(2, (-0.5, 0.0, 0.0, 0.0, 0.0, 0.0)), Solution(5, (0.5, 0.0, 0.0, 0.0, 0.0, 0.0))
    assert nearest((low, high), (0.0,) * 6, FULL_TURNS) == low
    assert nearest((high, low), (0.0,) * 6, FULL_TURNS) == high


def test_nearest_takes_the_turn_back_when_the_nearest_one_is_out_of_range() -> None:
    found = nearest((Solution(0, (-3.0, 0.0, 0.0, 0.0, 0.0, 0.0)),), (9.0, 0.0, 0.0, 0.0, 0.0, 0.0), FULL_TURNS)
    assert found is not None
    assert found.q[0] == pytest.approx(TURN - 3.0)


def test_nearest_is_the_best_over_all_turns_of_all_solutions() -> None:
    rng = random.Random(30)
    for _ in range(50):
        q_near = tuple(rng.uniform(-TURN, TURN) for _ in range(6))
        candidates = solutions(CS66, CS66.forward([rng.uniform(-pi, pi) for _ in range(6)]))
        found = nearest(candidates, q_near, FULL_TURNS)
        assert found is not None

        def cost(q: JointVector, near: tuple[float, ...] = q_near) -> float:
            turns = ([a - TURN, a, a + TURN] for a in q)
            return sum(
                min((t - n) ** 2 for t in three if -TURN <= t <= TURN) for three, n in zip(turns, near, strict=True)
            )

        spent = sum((a - b) ** 2 for a, b in zip(found.q, q_near, strict=True))
        assert spent == pytest.approx(min(cost(candidate.q) for candidate in candidates), abs=1e-9)
        assert joint_difference(found.q, next(c.q for c in candidates if c.branch == found.branch)) < 1e-12


def test_a_straight_passage_keeps_its_branch_and_moves_the_joints_steadily() -> None:
    q = (0.2, -1.2, -1.5, -1.1, 1.4, 0.2)
    start = CS66.forward(q)
    branch = branch_of(CS66, q)
    before: JointVector = q
    for step in range(1, 51):
        T: Transform = (*start[:9], start[9] + 0.002 * step, start[10] - 0.001 * step, start[11] + 0.001 * step)
        after = solve_branch(CS66, T, branch)
        assert after is not None
        assert joint_difference(after, before) < 0.02
        before = after
