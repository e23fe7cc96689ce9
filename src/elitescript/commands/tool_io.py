"""Digital pins, shared pins and supply of the tool connector (manual 2.10 chapter 3, manual 2.14 chapter 5)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from elitescript.commands.definition.quantities import Bool, Choice, Integer, signal_index
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import SIGNAL
from elitescript.messages.enums import ToolPinMode
from elitescript.messages.machine import SetToolAnalogMode, SetToolPin

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot

_PinIndex = Annotated[int, signal_index("tool_digital_out")]


@command(family="io", manual="3.16")
def set_tool_digital(robot: Robot, n: _PinIndex, b: Bool) -> None:
    """Set a tool pin that is configured as an output.

    Args:
        n: index of the pin.
        b: level.

    Raises:
        ScriptStateError: the pin is disabled or an input.
    """
    robot.machine.write("tool_digital_out", n, b)


@command(family="io", manual="3.17")
def get_tool_digital(robot: Robot, n: _PinIndex) -> Annotated[Bool, SIGNAL]:
    """Return the level of a tool pin, input or output.

    Args:
        n: index of the pin.

    Returns:
        The level.
    """
    return robot.machine.tool_pin(n)


@command(family="io", manual="2.14: 5.18")
def set_tool_analog_io_work_mode(robot: Robot, domain: Annotated[int, Integer(0, 3)]) -> None:
    """Choose what the tool's shared pins do.

    In the manual since 2.14; programs that the pendant generated call it since 2.1, so every firmware here has it.

    Args:
        domain: 0 serial port, 1 analog input, 2 analog output, 3 analog input and output.
    """
    robot.request(SetToolAnalogMode(domain))


@command(family="io", manual="2.14: 5.19")
def set_tool_digital_io_config(
    robot: Robot, index: _PinIndex, mode: Annotated[int, Integer(0, 2)], enable: Bool, is_out: Bool
) -> None:
    """Configure a tool pin.

    In the manual since 2.14; programs that the pendant generated call it since 2.1, so every firmware here has it.

    Args:
        index: index of the pin.
        mode: driver: 0 push/pull, 1 PNP, 2 NPN.
        enable: True puts the pin to use.
        is_out: True makes it an output, False an input.
    """
    robot.request(SetToolPin(index, ToolPinMode(mode), enable, is_out))


@command(family="io", manual="3.42")
def set_tool_voltage(robot: Robot, voltage: Annotated[int, Choice(0, 12, 24, unit="V")]) -> None:
    """Set the supply of the tool connector.

    Args:
        voltage: supply voltage.
    """
    robot.machine.write("tool_voltage", 0, voltage)
