"""Computes poses and speeds of TCP and flange from the joints."""

from __future__ import annotations

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.jacobian import tcp_twist
from elitescript.kinematics.transforms import Transform, compose, pose_from_transform
from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX, JointState
from elitescript.records import NamedTuple


class CartesianState(NamedTuple):
    """Holds poses and speeds that follow from joints and TCP, base frame: m, rad, m/s, rad/s."""

    pose_target: Six
    pose_actual: Six
    speed_target: Six
    speed_actual: Six
    flange_pose: Six


class CartesianStateFinder:
    """Computes Cartesian states, anew only for other joints or another TCP.

    Args:
        arm: the kinematics.
    """

    __slots__ = ("_T_flange_tcp", "_arm", "_joints", "_places")

    def __init__(self, arm: Arm) -> None:
        self._arm = arm
        self._joints: JointState | None = None
        self._T_flange_tcp: Transform | None = None
        self._places = CartesianState(ZERO_SIX, ZERO_SIX, ZERO_SIX, ZERO_SIX, ZERO_SIX)

    def places(self, joints: JointState, T_flange_tcp: Transform) -> CartesianState:
        """Return the Cartesian state for joints (rad, rad/s) and the TCP."""
        if T_flange_tcp is not self._T_flange_tcp or not _are_same(joints, self._joints):
            self._joints, self._T_flange_tcp = joints, T_flange_tcp
            self._places = self._worked_out(joints, T_flange_tcp)
        return self._places

    def _worked_out(self, joints: JointState, T_flange_tcp: Transform) -> CartesianState:
        arm = self._arm
        T_base_flange = arm.forward(joints.q_target)
        pose_target = pose_from_transform(compose(T_base_flange, T_flange_tcp))
        speed_target = tcp_twist(arm, joints.q_target, joints.qd_target, T_flange_tcp)
        pose_actual, speed_actual = pose_target, speed_target
        if joints.q_actual != joints.q_target or joints.qd_actual != joints.qd_target:
            T_base_flange = arm.forward(joints.q_actual)
            pose_actual = pose_from_transform(compose(T_base_flange, T_flange_tcp))
            speed_actual = tcp_twist(arm, joints.q_actual, joints.qd_actual, T_flange_tcp)
        return CartesianState(pose_target, pose_actual, speed_target, speed_actual, pose_from_transform(T_base_flange))


def _are_same(joints: JointState, other: JointState | None) -> bool:
    """Return whether both hold the identical tuples; equal ones may differ in the sign of a zero."""
    return other is not None and (
        joints.q_target is other.q_target
        and joints.qd_target is other.qd_target
        and joints.q_actual is other.q_actual
        and joints.qd_actual is other.qd_actual
    )
