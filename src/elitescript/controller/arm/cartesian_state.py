"""Computes poses and speeds of TCP and flange from the joints."""

from __future__ import annotations

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.jacobian import tcp_twist
from elitescript.kinematics.transforms import Transform, compose, pose_from_transform
from elitescript.messages.state import ZERO_SIX, JointState, Poses, TcpSpeeds


class CartesianStateFinder:
    """Computes poses and velocities, anew only for other joints or another TCP.

    Args:
        arm: the kinematics.
    """

    __slots__ = ("_arm", "_poses", "_poses_of", "_speeds", "_speeds_of")

    def __init__(self, arm: Arm) -> None:
        self._arm = arm
        self._poses_of: tuple[JointState, Transform] | None = None
        self._poses = Poses(ZERO_SIX, ZERO_SIX, ZERO_SIX)
        self._speeds_of: tuple[JointState, Transform] | None = None
        self._speeds = TcpSpeeds(ZERO_SIX, ZERO_SIX)

    def poses(self, joints: JointState, T_flange_tcp: Transform) -> Poses:
        """Return the poses for joints (rad) and the TCP."""
        if not _are_same(joints, T_flange_tcp, self._poses_of):
            self._poses_of = joints, T_flange_tcp
            arm = self._arm
            T_base_flange = arm.forward(joints.q_target)
            target = actual = pose_from_transform(compose(T_base_flange, T_flange_tcp))
            if not _is_on_target(joints):
                T_base_flange = arm.forward(joints.q_actual)
                actual = pose_from_transform(compose(T_base_flange, T_flange_tcp))
            self._poses = Poses(target, actual, pose_from_transform(T_base_flange))
        return self._poses

    def speeds(self, joints: JointState, T_flange_tcp: Transform) -> TcpSpeeds:
        """Return the velocities for joints (rad, rad/s) and the TCP."""
        if not _are_same(joints, T_flange_tcp, self._speeds_of):
            self._speeds_of = joints, T_flange_tcp
            arm = self._arm
            target = actual = tcp_twist(arm, joints.q_target, joints.qd_target, T_flange_tcp)
            if not _is_on_target(joints):
                actual = tcp_twist(arm, joints.q_actual, joints.qd_actual, T_flange_tcp)
            self._speeds = TcpSpeeds(target, actual)
        return self._speeds


def _is_on_target(joints: JointState) -> bool:
    return joints.q_actual == joints.q_target and joints.qd_actual == joints.qd_target


def _are_same(joints: JointState, T_flange_tcp: Transform, before: tuple[JointState, Transform] | None) -> bool:
    """Return whether both have the identical tuples; equal ones may differ in the sign of a zero."""
    if before is None or T_flange_tcp is not before[1]:
        return False
    other = before[0]
    return joints is other or (
        joints.q_target is other.q_target
        and joints.qd_target is other.qd_target
        and joints.q_actual is other.q_actual
        and joints.qd_actual is other.qd_actual
    )
