"""Kinematics and inverse dynamics against other people's packages, where they are installed."""

from __future__ import annotations

import random
from importlib.metadata import version
from math import pi
from typing import Any

import pytest

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.dynamics import RigidBody, joint_torques
from elitescript.kinematics.inverse import solutions
from elitescript.kinematics.jacobian import jacobian, singularity
from elitescript.kinematics.limits import wrap_to_pi
from elitescript.models.model import RobotModel, load_model, model_names
from tests.findings import Finding

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


def largest(ours: Any, theirs: Any) -> float:
    return max(abs(a - b) for a, b in zip(ours, theirs, strict=True))


def flat(T: Any) -> list[float]:
    return [*T[:3, :3].ravel(), *T[:3, 3]]


def test_eaik_finds_the_same_flange_and_the_same_solutions(finding: Finding) -> None:
    np = pytest.importorskip("numpy")
    eaik = pytest.importorskip("eaik.IK_DH")
    robot = eaik.DhRobot(np.array(ALPHA), np.array(A), np.array(D))
    flange = joints = 0.0
    for q in regular_joints(100):
        T_base_flange = CS66.forward(q)
        T_peer = robot.fwdKin(np.array(q))
        flange = max(flange, largest(T_base_flange, flat(T_peer)))
        answer = robot.IK(T_peer)
        exact = [s for s, least_squares in zip(answer.Q, answer.is_LS, strict=True) if not least_squares]
        ours = solutions(CS66, T_base_flange)
        assert len(exact) == len(ours)
        for solution in ours:
            differences = [
                max(abs(wrap_to_pi(a - b)) for a, b in zip(solution.q, other, strict=True)) for other in exact
            ]
            joints = max(joints, min(differences))
    assert flange < 1e-12
    assert joints < 1e-8
    peer = f"EAIK {version('eaik')}, 100 poses"
    finding("flange pose", peer, f"{flange:.1e}")
    finding("all solutions of the inverse kinematics", peer, f"{joints:.1e} rad")


def test_roboticstoolbox_finds_the_same_flange_and_jacobian(finding: Finding) -> None:
    np = pytest.importorskip("numpy")
    toolbox = pytest.importorskip("roboticstoolbox")
    robot = toolbox.DHRobot([toolbox.RevoluteDH(alpha=x, a=y, d=z) for x, y, z in zip(ALPHA, A, D, strict=True)])
    elements = 0.0
    for q in regular_joints(50):
        assert CS66.forward(q) == pytest.approx(flat(robot.fkine(np.array(q)).A), abs=1e-12)
        elements = max(elements, np.abs(np.array(jacobian(CS66, q)) - robot.jacob0(np.array(q))).max())
    assert elements < 1e-12
    finding("Jacobian", f"Robotics Toolbox {version('roboticstoolbox-python')}, 50 poses", f"{elements:.1e}")


def test_roboticstoolbox_finds_the_same_torques(finding: Finding) -> None:
    np = pytest.importorskip("numpy")
    toolbox = pytest.importorskip("roboticstoolbox")
    model = load_model("CS66")
    links, peers = [], []
    for link, a, d, alpha in zip(model.links, *model.arm.modified_dh, strict=True):
        ixx, iyy, izz, ixy, ixz, iyz = link.inertia
        tensor = np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])
        links.append(RigidBody(link.mass, link.com, link.inertia))
        peers.append(toolbox.RevoluteMDH(a=a, d=d, alpha=alpha, m=link.mass, r=list(link.com), I=tensor, Jm=0.0, G=1.0))
    # The toolbox takes the vector along which things fall.
    robot = toolbox.DHRobot(peers, gravity=[-g for g in model.gravity])
    rng = random.Random(61)
    torques = 0.0
    for _ in range(50):
        q, qd, qdd = (tuple(rng.uniform(-span, span) for _ in range(6)) for span in (pi, 2.0, 8.0))
        theirs = robot.rne(np.array(q), np.array(qd), np.array(qdd))
        torques = max(torques, largest(joint_torques(model.arm, links, q, qd, qdd, model.gravity), theirs))
    assert torques < 1e-9
    peer = f"Robotics Toolbox {version('roboticstoolbox-python')}, 50 states"
    finding("torques of the CS66 without a load", peer, f"{torques:.1e} N m")


def pinocchio_body(pinocchio: Any, np: Any, body: RigidBody) -> Any:
    ixx, iyy, izz, ixy, ixz, iyz = body.inertia
    tensor = np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])
    return pinocchio.Inertia(body.mass, np.array(body.com), tensor)


def pinocchio_arm(pinocchio: Any, np: Any, model: RobotModel, load: RigidBody) -> Any:
    """The arm with its load as Pinocchio sees it, from the link frames alone."""
    arm = pinocchio.Model()
    parent = 0
    for number, (link, a, d, alpha) in enumerate(zip(model.links, *model.arm.modified_dh, strict=True)):
        turn = pinocchio.utils.rotate("x", alpha)
        place = pinocchio.SE3(turn, np.array([a, 0.0, 0.0]) + turn @ np.array([0.0, 0.0, d]))
        parent = arm.addJoint(parent, pinocchio.JointModelRZ(), place, f"joint {number}")
        body = pinocchio_body(pinocchio, np, RigidBody(link.mass, link.com, link.inertia))
        arm.appendBodyToJoint(parent, body, pinocchio.SE3.Identity())
    arm.appendBodyToJoint(parent, pinocchio_body(pinocchio, np, load), pinocchio.SE3.Identity())
    return arm


def test_pinocchio_finds_the_same_torques_with_any_load_and_mounting(finding: Finding) -> None:
    np = pytest.importorskip("numpy")
    pinocchio = pytest.importorskip("pinocchio")
    rng = random.Random(62)
    largest_torque = torques = 0.0
    for name in model_names():
        model = load_model(name)
        links = [RigidBody(link.mass, link.com, link.inertia) for link in model.links]
        for _ in range(50):
            # A box, its axes parallel to the flange, with a product of inertia that a body may have.
            x, y, z = (rng.uniform(0.001, 0.05) for _ in range(3))
            load = RigidBody(
                rng.uniform(0.0, model.payload_max_kg),
                tuple(rng.uniform(-0.2, 0.2) for _ in range(3)),  # type: ignore[arg-type]
                (y + z, x + z, x + y, 0.3 * min(x, y), 0.0, 0.0),
            )
            gravity = tuple(rng.uniform(-9.82, 9.82) for _ in range(3))
            q, qd, qdd = (tuple(rng.uniform(-span, span) for _ in range(6)) for span in (pi, 3.0, 20.0))
            arm = pinocchio_arm(pinocchio, np, model, load)
            # Pinocchio takes the vector along which things fall.
            arm.gravity.linear = -np.array(gravity)
            data = arm.createData()
            theirs = pinocchio.rnea(arm, data, np.array(q), np.array(qd), np.array(qdd))
            torques = max(torques, largest(joint_torques(model.arm, links, q, qd, qdd, gravity, load), theirs))
            largest_torque = max(largest_torque, np.abs(theirs).max())
    assert torques < 1e-9
    peer = f"Pinocchio {version('pin')}, {len(model_names())} arms, 50 states each"
    finding("torques with a random load and mounting", peer, f"{torques:.1e} of up to {largest_torque:.0f} N m")
