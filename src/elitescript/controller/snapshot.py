"""Builds the picture of the machine that everybody reads."""

from __future__ import annotations

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.jacobian import tcp_twist
from elitescript.kinematics.transforms import Transform, pose_from_transform
from elitescript.messages.enums import RobotMode, SafetyMode, TaskState
from elitescript.messages.motion import Six
from elitescript.messages.state import JointState, Payload, RobotState
from elitescript.messages.timing import seconds


def build_state(
    *,
    tick: int,
    joints: JointState,
    arm: Arm,
    T_flange_tcp: Transform,
    tcp_offset: Six,
    robot_mode: RobotMode,
    safety_mode: SafetyMode,
    task_state: TaskState,
    payload: Payload,
    gravity: tuple[float, float, float],
    speed_scale: float,
    is_moving: bool,
    line: int,
    node: tuple[int, str],
) -> RobotState:
    """Put together the state of one tick; poses and speeds follow from the joints and the TCP offset."""
    pose_target = pose_from_transform(arm.forward_tcp(joints.q_target, T_flange_tcp))
    speed_target = tcp_twist(arm, joints.q_target, joints.qd_target, T_flange_tcp)
    is_ideal = joints.q_actual == joints.q_target and joints.qd_actual == joints.qd_target
    pose_actual, speed_actual = pose_target, speed_target
    if not is_ideal:
        pose_actual = pose_from_transform(arm.forward_tcp(joints.q_actual, T_flange_tcp))
        speed_actual = tcp_twist(arm, joints.q_actual, joints.qd_actual, T_flange_tcp)
    return RobotState(
        tick=tick,
        time_s=seconds(tick),
        robot_mode=robot_mode,
        safety_mode=safety_mode,
        task_state=task_state,
        q_target=joints.q_target,
        qd_target=joints.qd_target,
        q_actual=joints.q_actual,
        qd_actual=joints.qd_actual,
        tcp_offset=tcp_offset,
        tcp_pose_target=pose_target,
        tcp_pose_actual=pose_actual,
        tcp_speed_target=speed_target,
        tcp_speed_actual=speed_actual,
        flange_pose_actual=pose_from_transform(arm.forward(joints.q_actual)),
        payload=payload,
        gravity=gravity,
        speed_scale=speed_scale,
        is_moving=is_moving,
        line=line,
        node=node,
    )
