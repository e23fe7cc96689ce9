"""Outputs that follow whether a program runs (manual 2.10 sections 3.18 to 3.23).

A choice takes effect at once and whenever a program ends; 3 also when one starts. With 1 and 2 the start of a program
leaves the level as it is, and only a running program can change it. A write without effect is a warning.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Final

from elitescript.commands.definition.quantities import Integer, signal_index
from elitescript.commands.definition.registry import command
from elitescript.messages.enums import RunstateChoice
from elitescript.messages.machine import SetRunstateChoice

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot

_Choice = Annotated[int, Integer(0, 3)]
_ARGUMENTS: Final = {
    "port": "index of the output.",
    "runstate": "0 not tied; 1 low without a program; 2 high without a program; 3 low without, high with a program. "
    "With 1 and 2 a program that starts finds the level unchanged; a write without effect is a warning.",
}
"""Texts of arguments that several commands share."""


@command(family="io", manual="3.18", arguments=_ARGUMENTS)
def set_runstate_configurable_digital_output_to_value(
    robot: Robot, port: Annotated[int, signal_index("configurable_digital_out")], runstate: _Choice
) -> None:
    """Tie a configurable output to whether a program runs."""
    robot.request(SetRunstateChoice("configurable_digital_out", port, RunstateChoice(runstate)))


@command(family="io", manual="3.19", arguments=_ARGUMENTS)
def set_runstate_gp_boolean_output_to_value(
    robot: Robot, port: Annotated[int, signal_index("output_bool_register")], runstate: _Choice
) -> None:
    """Tie a boolean output register to whether a program runs.

    Args:
        port: number of the register.
    """
    robot.request(SetRunstateChoice("output_bool_register", port, RunstateChoice(runstate)))


@command(family="io", manual="3.20", arguments=_ARGUMENTS)
def set_runstate_standard_analog_output_to_value(
    robot: Robot, port: Annotated[int, signal_index("standard_analog_out")], runstate: _Choice
) -> None:
    """Tie an analog output of the control box to whether a program runs.

    Args:
        runstate: 0 not tied; 1 lowest value without a program; 2 highest value without a program; 3 lowest without,
            highest with a program.
    """
    robot.request(SetRunstateChoice("standard_analog_out", port, RunstateChoice(runstate)))


@command(family="io", manual="3.21")
def set_runstate_tool_analog_output_to_value(robot: Robot, runstate: _Choice) -> None:
    """Tie the tool's analog output to whether a program runs.

    Args:
        runstate: 0 not tied; 1 lowest value without a program; 2 highest value without a program; 3 lowest without,
            highest with a program.
    """
    robot.request(SetRunstateChoice("tool_analog_out", 0, RunstateChoice(runstate)))


@command(family="io", manual="3.22", arguments=_ARGUMENTS)
def set_runstate_standard_digital_output_to_value(
    robot: Robot, port: Annotated[int, signal_index("standard_digital_out")], runstate: _Choice
) -> None:
    """Tie a standard output to whether a program runs."""
    robot.request(SetRunstateChoice("standard_digital_out", port, RunstateChoice(runstate)))


@command(family="io", manual="3.23", arguments=_ARGUMENTS)
def set_runstate_tool_digital_output_to_value(
    robot: Robot, port: Annotated[int, signal_index("tool_digital_out")], runstate: _Choice
) -> None:
    """Tie a tool output to whether a program runs.

    Args:
        port: index of the pin.
    """
    robot.request(SetRunstateChoice("tool_digital_out", port, RunstateChoice(runstate)))
