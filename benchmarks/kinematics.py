"""Forward and inverse kinematics, Jacobian and inverse dynamics of one pose, against other packages where installed."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from math import pi
from typing import Any

from benchmarks.measure import best_of_calls
from benchmarks.table import Row, Time, not_installed, print_rows, timed_row
from elitescript.kinematics.dynamics import RigidBody, joint_torques
from elitescript.kinematics.inverse import solutions, solve_branch
from elitescript.kinematics.jacobian import jacobian
from elitescript.models.model import LinkMass, RobotModel, load_model

Q = (0.3, -1.2, -1.5, -1.1, 1.4, 0.2)
"""A pose with eight solutions, far from singularities, rad."""
QD = (0.5, -0.4, 0.7, -0.9, 0.3, 1.1)
QDD = (1.0, 2.0, -1.5, 0.5, -2.5, 3.0)
LOAD_KG = 3.0
LOAD_COG = (0.02, -0.015, 0.09)
DYNAMICS = "inverse dynamics, with payload"
OWN_BRANCH = 5

Calls = dict[str, Callable[[], object]]


def rows() -> list[Row]:
    """Each calculation, beside every package that has it."""
    model = load_model("CS66")
    peers = {name: build(model) for name, build in PEERS.items() if find_spec(name)}
    return compared(_our_calls(model), peers) + [not_installed(name) for name in PEERS if name not in peers]


def compared(ours: Calls, peers: dict[str, Calls]) -> list[Row]:
    """Time our calls and the peers' calls of the same name: a row for each peer that has one, else one without."""
    table = []
    for what, call in ours.items():
        own = best_of_calls(call)
        others: dict[str, Time] = {name: best_of_calls(calls[what]) for name, calls in peers.items() if what in calls}
        table += [
            timed_row(f"{what} ({name})", own, "us", other=time.cpu_s, beside=name) for name, time in others.items()
        ]
        if not others:
            table.append(timed_row(what, own, "us"))
    return table


def _our_calls(model: RobotModel) -> Calls:
    arm = model.arm
    T = arm.forward(Q)
    links = [RigidBody(link.mass, link.com, link.inertia) for link in model.links]
    load = RigidBody(LOAD_KG, LOAD_COG)
    if len(solutions(arm, T)) != 8 or solve_branch(arm, T, OWN_BRANCH) is None:
        raise RuntimeError("the pose of this benchmark has to have eight solutions")
    return {
        "forward kinematics": lambda: arm.forward(Q),
        "inverse kinematics, all eight": lambda: solutions(arm, T),
        "inverse kinematics, one": lambda: solve_branch(arm, T, OWN_BRANCH),
        "Jacobian": lambda: jacobian(arm, Q),
        DYNAMICS: lambda: joint_torques(arm, links, Q, QD, QDD, model.gravity, load),
    }


def _eaik(model: RobotModel) -> Calls:
    import numpy as np
    from eaik.IK_DH import DhRobot

    alpha, a, d = (np.array(row) for row in _standard_dh(model))
    robot = DhRobot(alpha, a, d)
    q = np.array(Q)
    T = robot.fwdKin(q)
    return {
        "forward kinematics": lambda: robot.fwdKin(q),
        "inverse kinematics, all eight": lambda: robot.IK(T),
    }


def _pinocchio(model: RobotModel) -> Calls:
    import numpy as np
    import pinocchio

    arm, last = pinocchio.Model(), 0
    for number, (link, a, d, alpha) in enumerate(zip(model.links, *model.arm.modified_dh, strict=True)):
        turn = pinocchio.utils.rotate("x", alpha)
        place = pinocchio.SE3(turn, np.array([a, 0.0, 0.0]) + turn @ np.array([0.0, 0.0, d]))
        last = arm.addJoint(last, pinocchio.JointModelRZ(), place, f"joint {number}")
        inertia = pinocchio.Inertia(link.mass, np.array(link.com), np.array(_tensor(link)))
        arm.appendBodyToJoint(last, inertia, pinocchio.SE3.Identity())
    load = pinocchio.Inertia(LOAD_KG, np.array(LOAD_COG), np.zeros((3, 3)))
    arm.appendBodyToJoint(last, load, pinocchio.SE3.Identity())
    arm.gravity.linear = -np.array(model.gravity)
    data, q, qd, qdd = arm.createData(), np.array(Q), np.array(QD), np.array(QDD)

    def forward() -> Any:
        pinocchio.forwardKinematics(arm, data, q)
        return data.oMi[last]

    def base_jacobian() -> object:
        pinocchio.computeJointJacobians(arm, data, q)
        return pinocchio.getJointJacobian(arm, data, last, pinocchio.LOCAL_WORLD_ALIGNED)

    return {
        "forward kinematics": forward,
        "Jacobian": base_jacobian,
        DYNAMICS: lambda: pinocchio.rnea(arm, data, q, qd, qdd),
    }


def _toolbox(model: RobotModel) -> Calls:
    import numpy as np
    from roboticstoolbox import DHRobot, RevoluteDH, RevoluteMDH

    links = [RevoluteDH(alpha=x, a=y, d=z) for x, y, z in zip(*_standard_dh(model), strict=True)]
    robot: Any = DHRobot(links)
    q = np.array(Q)
    T = robot.fkine(q)
    start = q + 0.05
    heavy: Any = DHRobot(
        [
            RevoluteMDH(a=a, d=d, alpha=alpha, m=link.mass, r=list(link.com), I=_tensor(link), Jm=0.0, G=1.0)
            for link, a, d, alpha in zip(model.links, *model.arm.modified_dh, strict=True)
        ],
        gravity=[-g for g in model.gravity],
    )
    heavy.payload(LOAD_KG, list(LOAD_COG))
    qd, qdd = np.array(QD), np.array(QDD)
    return {
        "forward kinematics": lambda: robot.fkine(q),
        "inverse kinematics, one": lambda: robot.ikine_LM(T, q0=start),
        "Jacobian": lambda: robot.jacob0(q),
        DYNAMICS: lambda: heavy.rne(q, qd, qdd),
    }


def _tensor(link: LinkMass) -> list[list[float]]:
    ixx, iyy, izz, ixy, ixz, iyz = link.inertia
    return [[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]]


def _standard_dh(model: RobotModel) -> tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...]]:
    """Return alpha, a, d of the standard Denavit-Hartenberg form."""
    arm = model.arm
    return (
        (pi / 2, 0.0, 0.0, pi / 2, -pi / 2, 0.0),
        (0.0, arm.a2, arm.a3, 0.0, 0.0, 0.0),
        (arm.d1, 0.0, 0.0, arm.d4, arm.d5, arm.d6),
    )


PEERS: dict[str, Callable[[RobotModel], Calls]] = {"eaik": _eaik, "pinocchio": _pinocchio, "roboticstoolbox": _toolbox}

if __name__ == "__main__":
    print_rows(rows())
