"""Forward and inverse kinematics, Jacobian and inverse dynamics of one pose, against other packages where installed."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from math import pi
from timeit import repeat
from typing import Any

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
RUNS = 7
RUN_S = 0.05
PEERS = ("eaik", "roboticstoolbox")

Calls = dict[str, Callable[[], object]]


def rows() -> list[tuple[str, str, str, str]]:
    """What, ours, the other, ratio."""
    model = load_model("CS66")
    ours = {what: _time_us(call) for what, call in _our_calls(model).items()}
    peers = {name: build(model) for name, build in (("eaik", _eaik), ("roboticstoolbox", _toolbox)) if find_spec(name)}
    table = []
    for what, own_us in ours.items():
        others = [(name, _time_us(calls[what])) for name, calls in peers.items() if what in calls]
        if not others:
            table.append((what, f"{own_us:.1f} us", "-", "-"))
        for name, other_us in others:
            table.append((what, f"{own_us:.1f} us", f"{other_us:.1f} us ({name})", f"{own_us / other_us:.2g}"))
    table += [(f"compared with {name}", "-", "not installed", "-") for name in PEERS if name not in peers]
    return table


def main() -> None:
    """Print the table."""
    table = [("CS66, one pose", "ours", "other", "ours / other"), *rows()]
    widths = [max(len(row[column]) for row in table) for column in range(4)]
    for row in table:
        print("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())


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
            RevoluteMDH(a=a, d=d, alpha=alpha, m=link.mass, r=list(link.com), I=_toolbox_inertia(link), Jm=0.0, G=1.0)
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


def _toolbox_inertia(link: LinkMass) -> list[list[float]]:
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


def _time_us(call: Callable[[], object]) -> float:
    """Return the best time of one call over some runs, us."""
    once = min(repeat(call, number=1, repeat=5))
    number = max(1, int(RUN_S / max(once, 1e-7)))
    return min(repeat(call, number=number, repeat=RUNS)) / number * 1e6


if __name__ == "__main__":
    main()
