"""Modes of joints and tool that ports report.

Evidence: the numbers are *documented* by the vendor's SDK. Their relation to the modes of the robot is *assumed*.
"""

from __future__ import annotations

from enum import IntEnum
from typing import Final

from elitescript.messages.enums import POWERED, RobotMode, SafetyMode
from elitescript.messages.state import RobotState


class DeviceMode(IntEnum):
    """State of the electronics of a joint or of the tool."""

    RESET = 235
    SHUTTING_DOWN = 236
    BACK_DRIVE = 238
    POWER_OFF = 239
    READY_FOR_POWER_OFF = 240
    NOT_RESPONDING = 245
    MOTOR_INITIALISATION = 246
    BOOTING = 247
    BOOTLOADER = 249
    VIOLATION = 251
    FAULT = 252
    RUNNING = 253
    IDLE = 255


_JOINT: Final = {
    RobotMode.NO_CONTROLLER: DeviceMode.NOT_RESPONDING,
    RobotMode.DISCONNECTED: DeviceMode.NOT_RESPONDING,
    RobotMode.CONFIRM_SAFETY: DeviceMode.POWER_OFF,
    RobotMode.POWER_OFF: DeviceMode.POWER_OFF,
    RobotMode.POWER_ON: DeviceMode.BOOTING,
    RobotMode.BOOTING: DeviceMode.MOTOR_INITIALISATION,
    RobotMode.IDLE: DeviceMode.IDLE,
    RobotMode.BACK_DRIVE: DeviceMode.BACK_DRIVE,
    RobotMode.RUNNING: DeviceMode.RUNNING,
    RobotMode.UPDATING: DeviceMode.BOOTLOADER,
    RobotMode.WAITING_CALIBRATION: DeviceMode.POWER_OFF,
}
_BROKEN: Final = {SafetyMode.VIOLATION: DeviceMode.VIOLATION, SafetyMode.FAULT: DeviceMode.FAULT}


def joint_mode(robot: RobotState) -> DeviceMode:
    """Return the mode of all six joints."""
    if robot.robot_mode in POWERED and robot.safety_mode in _BROKEN:
        return _BROKEN[robot.safety_mode]
    return _JOINT[robot.robot_mode]


def tool_mode(robot: RobotState) -> DeviceMode:
    """Return the mode of the tool, which has no brakes: with power it runs."""
    mode = _JOINT[robot.robot_mode]
    if mode in (DeviceMode.IDLE, DeviceMode.BACK_DRIVE):
        return DeviceMode.RUNNING
    return DeviceMode.BOOTING if mode is DeviceMode.MOTOR_INITIALISATION else mode
