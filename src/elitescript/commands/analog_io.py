"""Analog inputs and outputs of the control box and of the tool (manual 2.10 chapter 3).

A channel carries a current (4 to 20 mA) or a voltage (0 to 10 V); its domain says which. Readings are in A or V.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from elitescript.commands.definition.quantities import Choice, Number, signal_index
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import COMMANDED, MEASURED
from elitescript.messages.enums import AnalogDomain
from elitescript.messages.machine import SetAnalogDomain, SetAnalogFraction

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot

_Level = Annotated[float, Number("A or V")]
_Fraction = Annotated[float, Number(meaning="fraction")]
_Domain = Annotated[int, Choice(0, 1)]


@command(family="io", manual="3.3")
def get_standard_analog_in(
    robot: Robot, n: Annotated[int, signal_index("standard_analog_in")]
) -> Annotated[_Level, MEASURED]:
    """Return the level of an analog input of the control box.

    Args:
        n: index of the input.

    Returns:
        A (0.004 to 0.020) or V (0 to 10), as the input's domain says.
    """
    return float(robot.machine.read("standard_analog_in", n))


@command(family="io", manual="3.4")
def get_standard_analog_out(
    robot: Robot, n: Annotated[int, signal_index("standard_analog_out")]
) -> Annotated[_Level, COMMANDED]:
    """Return the level that an analog output of the control box is set to.

    Args:
        n: index of the output.

    Returns:
        A (0.004 to 0.020) or V (0 to 10), as the output's domain says.
    """
    return float(robot.machine.read("standard_analog_out", n))


@command(family="io", manual="3.12")
def set_standard_analog_out(
    robot: Robot,
    n: Annotated[int, signal_index("standard_analog_out")],
    f: _Fraction,
) -> None:
    """Set an analog output of the control box to a fraction of its range.

    What lies outside 0 to 1 is set to the nearer end, as the manual says, with a warning (W234) for each line.

    Args:
        n: index of the output.
        f: 0 is 4 mA or 0 V, 1 is 20 mA or 10 V.
    """
    robot.request(SetAnalogFraction("standard_analog_out", n, min(1.0, max(0.0, f))))


@command(family="io", manual="3.11")
def set_standard_analog_input_domain(
    robot: Robot, port: Annotated[int, signal_index("standard_analog_in")], domain: _Domain
) -> None:
    """Choose current or voltage for an analog input of the control box.

    Args:
        port: index of the input.
        domain: 0 current, 1 voltage.
    """
    robot.request(SetAnalogDomain("standard_analog_in", port, AnalogDomain(domain)))


@command(family="io", manual="3.9")
def set_standard_analog_output_domain(
    robot: Robot, port: Annotated[int, signal_index("standard_analog_out")], domain: _Domain
) -> None:
    """Choose current or voltage for an analog output of the control box.

    Args:
        port: index of the output.
        domain: 0 current, 1 voltage.
    """
    robot.request(SetAnalogDomain("standard_analog_out", port, AnalogDomain(domain)))


@command(family="io", manual="3.7")
def get_tool_analog_in(robot: Robot) -> Annotated[_Level, MEASURED]:
    """Return the level of the tool's analog input.

    Returns:
        A (0.004 to 0.020) or V (0 to 10), as the input's domain says.
    """
    return float(robot.machine.read("tool_analog_in"))


@command(family="io", manual="3.8")
def get_tool_analog_out(robot: Robot) -> Annotated[_Level, COMMANDED]:
    """Return the level that the tool's analog output is set to.

    Returns:
        A (0.004 to 0.020) or V (0 to 10), as the output's domain says.
    """
    return float(robot.machine.read("tool_analog_out"))


@command(family="io", manual="3.14")
def set_tool_analog_input_domain(robot: Robot, domain: _Domain) -> None:
    """Choose current or voltage for the tool's analog input.

    Args:
        domain: 0 current, 1 voltage.
    """
    robot.request(SetAnalogDomain("tool_analog_in", 0, AnalogDomain(domain)))


@command(family="io", manual="3.15")
def set_tool_analog_output_domain(robot: Robot, domain: _Domain) -> None:
    """Choose current or voltage for the tool's analog output.

    Args:
        domain: 0 current, 1 voltage.
    """
    robot.request(SetAnalogDomain("tool_analog_out", 0, AnalogDomain(domain)))
