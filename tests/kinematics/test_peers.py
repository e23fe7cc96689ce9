"""Kinematics and inverse dynamics against other people's packages, where they are installed."""

from __future__ import annotations

import random
from math import pi
from typing import Any

import pytest

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.dynamics import Body, joint_torques
from elitescript.kinematics.inverse import solutions
from elitescript.kinematics.jacobian import jacobian, singularity
from elitescript.kinematics.limits import wrap_to_pi
from elitescript.models.model import load_model

pytestmark = pytest.mark.peers

CS66 = Arm(0.1625, -0.427, -0.3905, 0.1475, 0.0965, 0.092)
ALPHA = (pi / 2, 0.0, 0.0, pi / 2, -pi / 2, 0.0)
A = (0.0, CS66.a2, CS66.a3, 0.0, 0.0, 0.0)
D = (CS66.d1, 0.0, 0.0, CS66.d4, CS66.d5, CS66.d6)


def regular_joints(count: int) -> list[tuple[float, ...]]:
    rng = random.Random(60)
    joints: list[tuple[float, ...]] = []
    while len(joints) < count:
        q = tuple(rng.uniform(-pi, pi) for _ in range(6))
        if min(singularity(CS66, q)) > 0.05:
            joints.append(q)
    return joints


def flat(T: Any) -> list[float]:
    return [*T[:3, :3].ravel(), *T[:3, 3]]


def test_eaik_finds_the_same_flange_and_the_same_solutions() -> None:
    np = pytest.importorskip("numpy")
    eaik = pytest.importorskip("eaik.IK_DH")
    robot = eaik.DhRobot(np.array(ALPHA), np.array(A), np.array(D))
    for q in regular_joints(100):
        T_base_flange = CS66.forward(q)
        T_peer = robot.fwdKin(np.array(q))
        assert T_base_flange == pytest.approx(flat(T_peer), abs=1e-12)
        answer = robot.IK(T_peer)
        exact = [s for s, least_squares in zip(answer.Q, answer.is_LS, strict=True) if not least_squares]
        ours = solutions(CS66, T_base_flange)
        assert len(exact) == len(ours)
        for solution in ours:
            differences = [
                max(abs(wrap_to_pi(a - b)) for a, b in zip(solution.q, other, strict=True)) for other in exact
            ]
            assert min(differences) < 1e-8


def test_roboticstoolbox_finds_the_same_flange_and_jacobian() -> None:
    np = pytest.importorskip("numpy")
    toolbox = pytest.importorskip("roboticstoolbox")
    robot = toolbox.DHRobot([toolbox.RevoluteDH(alpha=x, a=y, d=z) for x, y, z in zip(ALPHA, A, D, strict=True)])
    for q in regular_joints(50):
        assert CS66.forward(q) == pytest.approx(flat(robot.fkine(np.array(q)).A), abs=1e-12)
        assert np.abs(np.array(jacobian(CS66, q)) - robot.jacob0(np.array(q))).max() < 1e-12


def test_roboticstoolbox_finds_the_same_torques() -> None:
    np = pytest.importorskip("numpy")
    toolbox = pytest.importorskip("roboticstoolbox")
    model = load_model("CS66")
    links, peers = [], []
    for link, a, d, alpha in zip(model.links, *model.arm.modified_dh, strict=True):
        ixx, iyy, izz, ixy, ixz, iyz = link.inertia
        tensor = np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])
        links.append(Body(link.mass, link.com, link.inertia))
        peers.append(toolbox.RevoluteMDH(a=a, d=d, alpha=alpha, m=link.mass, r=list(link.com), I=tensor, Jm=0.0, G=1.0))
    # The toolbox takes the vector along which things fall.
    robot = toolbox.DHRobot(peers, gravity=[-g for g in model.gravity])
    rng = random.Random(61)
    for _ in range(50):
        q, qd, qdd = (tuple(rng.uniform(-span, span) for _ in range(6)) for span in (pi, 2.0, 8.0))
        theirs = robot.rne(np.array(q), np.array(qd), np.array(qdd))
        assert joint_torques(model.arm, links, q, qd, qdd, model.gravity) == pytest.approx(list(theirs), abs=1e-9)
