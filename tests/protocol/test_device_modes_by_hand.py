"""Numbers of joint and tool modes against a table written by hand.

The numbers are documented by the vendor's SDK; which of them goes with which mode of the robot is assumed.
"""

from __future__ import annotations

import pytest

from elitescript.messages.enums import POWERED, RobotMode, SafetyMode
from elitescript.protocol.device_modes import DeviceMode, joint_mode, tool_mode
from tests.protocol.snapshots import robot_state
from tests.tables import rows

NUMBERS = """
235   RESET
236   SHUTTING_DOWN
238   BACK_DRIVE
239   POWER_OFF
240   READY_FOR_POWER_OFF
245   NOT_RESPONDING
246   MOTOR_INITIALISATION
247   BOOTING
249   BOOTLOADER
251   VIOLATION
252   FAULT
253   RUNNING
255   IDLE
"""

# Robot mode; joint and tool as long as nothing is broken; joint in VIOLATION and FAULT; power. A tool has no motors:
# it boots while they are initialised, and runs with the brakes engaged.
MODES = """
NO_CONTROLLER         245   245   245   245   off
DISCONNECTED          245   245   245   245   off
CONFIRM_SAFETY        239   239   239   239   off
BOOTING               246   247   251   252   on
POWER_OFF             239   239   239   239   off
POWER_ON              247   247   251   252   on
IDLE                  255   253   251   252   on
BACK_DRIVE            238   253   251   252   on
RUNNING               253   253   251   252   on
UPDATING              249   249   249   249   off
WAITING_CALIBRATION   239   239   239   239   off
"""
TOOL_NUMBERS = {235, 236, 239, 245, 247, 249, 252, 253, 255}
"""Those that clients know for a tool."""


def test_numbers() -> None:
    assert {str(mode.value): mode.name for mode in DeviceMode} == dict(rows(NUMBERS))


def test_every_robot_mode_is_in_the_table() -> None:
    assert [row[0] for row in rows(MODES)] == [mode.name for mode in RobotMode]


@pytest.mark.parametrize(("mode", "joint", "tool", "violated", "faulty", "power"), rows(MODES))
@pytest.mark.parametrize("safety", SafetyMode)
def test_modes_of_joint_and_tool(
    mode: str, joint: str, tool: str, violated: str, faulty: str, power: str, safety: SafetyMode
) -> None:
    state = robot_state(robot_mode=RobotMode[mode], safety_mode=safety)
    wanted = {"VIOLATION": violated, "FAULT": faulty}.get(safety.name, joint)
    assert joint_mode(state) == int(wanted)
    assert tool_mode(state) == int(tool)
    assert tool_mode(state) in TOOL_NUMBERS
    assert (RobotMode[mode] in POWERED) == (power == "on")
