"""Round trips of forward and inverse kinematics over random joint angles and tools.

`ELITESCRIPT_INVARIANTS` sets a tenth of the joint vectors that are tried for each model (30 if unset);
100,000 vectors take about eight seconds a model.
"""

from __future__ import annotations

import os
import random
from math import pi
from typing import NamedTuple

import pytest

from elitescript.kinematics.inverse import branch_of, nearest, solutions, solve_branch
from elitescript.kinematics.jacobian import joint_speeds, singularity, tcp_twist
from elitescript.kinematics.limits import REACH_TOLERANCE_M, TURN, WRIST_SINGULAR_SINE, wrap_to_pi
from elitescript.kinematics.transforms import compose, inverse, transform_from_pose
from elitescript.models.model import RobotModel, load_model, model_names
from tests.findings import Finding

pytestmark = pytest.mark.invariants

COUNT = 10 * int(os.environ.get("ELITESCRIPT_INVARIANTS", "30"))
SEED = 20
TOOL = (0.3, 0.3, 0.3, pi, pi, pi)
"""Random TCP offsets lie within these bounds, m and rad."""
REGULAR = 0.01
"""Joint vectors with |s3|, |s5| and |X| (m) above this count as regular."""
AT_BORDER = 1e-9
"""Solutions this near to a singularity were put on the border of the workspace."""


class Worst(NamedTuple):
    """Largest errors of a sample."""

    pose: float
    """Any element of the flange transform of any solution inside the workspace, m or 1."""
    joint_regular: float
    """Joint angle of the branch that the sample came from, rad, at regular joint vectors."""
    joint: float
    """The same at all joint vectors but those with a singular wrist, rad."""
    branches: frozenset[int]
    """Numbers of solutions that occurred."""


def round_trips(model: RobotModel, count: int, seed: int) -> Worst:
    """Return the worst errors of `count` round trips through tool, inverse and forward kinematics.

    Asserts on the way what has no tolerance: order and range of the solutions, and that the
    branch that the sample came from is among them.
    """
    arm = model.arm
    rng = random.Random(f"{seed} {model.name}")
    worst_pose = worst_regular = worst_joint = 0.0
    counts = set()
    for _ in range(count):
        q = tuple(rng.uniform(-TURN, TURN) for _ in range(6))
        T_flange_tcp = transform_from_pose([rng.uniform(-reach, reach) for reach in TOOL])
        T_base_flange = compose(arm.forward_tcp(q, T_flange_tcp), inverse(T_flange_tcp))
        distance = singularity(arm, q)
        if distance.wrist < WRIST_SINGULAR_SINE:
            continue
        found = solutions(arm, T_base_flange, q[5])
        counts.add(len(found))
        branch = branch_of(arm, q)
        assert [s.branch for s in found] == sorted({s.branch for s in found})
        for solution in found:
            assert all(-pi < angle <= pi for angle in solution.q), (q, solution)
            pairs = zip(arm.forward(solution.q), T_base_flange, strict=True)
            miss = max([abs(a - b) for a, b in pairs])
            reached = singularity(arm, solution.q)
            if reached.wrist < WRIST_SINGULAR_SINE or min(reached) < AT_BORDER:
                # Another branch may be singular, or lie just beyond the border, and is solved there.
                assert miss <= REACH_TOLERANCE_M + WRIST_SINGULAR_SINE
            else:
                worst_pose = max(worst_pose, miss)
        own = next((solution.q for solution in found if solution.branch == branch), None)
        assert own is not None, (q, branch, found)
        assert solve_branch(arm, T_base_flange, branch, q[5]) == own
        error = max([abs(wrap_to_pi(a - b)) for a, b in zip(own, q, strict=True)])
        worst_joint = max(worst_joint, error)
        if min(distance) > REGULAR:
            worst_regular = max(worst_regular, error)
            back = nearest(found, q, model.joint_ranges)
            assert back is not None
            assert sum([(a - b) ** 2 for a, b in zip(back.q, q, strict=True)]) < 1e-20, (q, back)
    return Worst(worst_pose, worst_regular, worst_joint, frozenset(counts))


@pytest.mark.timeout(1800)
@pytest.mark.parametrize("name", model_names())
def test_round_trip_meets_pose_and_joints(name: str, finding: Finding) -> None:
    worst = round_trips(load_model(name), COUNT, SEED)
    # Positions near three metres are resolved to 4e-16, and the tool adds two products.
    assert worst.pose < 2e-14
    assert worst.joint_regular < 1e-11
    # The error of the pose, 1e-15, grows with the inverse distance to a singularity.
    assert worst.joint < 1e-7
    assert worst.branches <= {2, 4, 6, 8}
    found = f"pose {worst.pose:.0e}; joints {worst.joint_regular:.0e} rad, near singularities {worst.joint:.0e} rad"
    finding(f"round trips of the kinematics, {name}", f"{COUNT} joint vectors and tools", found)


@pytest.mark.timeout(1800)
@pytest.mark.parametrize("name", model_names())
def test_joint_speeds_and_twist_are_inverse_to_each_other(name: str) -> None:
    arm = load_model(name).arm
    rng = random.Random(f"{SEED} speeds {name}")
    for _ in range(COUNT):
        q = tuple(rng.uniform(-TURN, TURN) for _ in range(6))
        qd = tuple(rng.uniform(-3, 3) for _ in range(6))
        T_flange_tcp = transform_from_pose([rng.uniform(-0.3, 0.3) for _ in range(6)])
        distance = min(singularity(arm, q))
        if distance < 1e-6:
            continue
        back = joint_speeds(arm, q, tcp_twist(arm, q, qd, T_flange_tcp), T_flange_tcp)
        assert back is not None
        assert max([abs(a - b) for a, b in zip(back, qd, strict=True)]) < 1e-12 / distance**2
