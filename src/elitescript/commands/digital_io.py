"""Digital inputs and outputs of the control box (manual 2.10 chapter 3)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from elitescript.commands.definition.quantities import Bool, signal_index
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import SIGNAL

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot


@command(family="io", manual="3.1")
def get_configurable_digital_in(
    robot: Robot, n: Annotated[int, signal_index("configurable_digital_in")]
) -> Annotated[Bool, SIGNAL]:
    """Return the level of a configurable input.

    Args:
        n: index of the input.

    Returns:
        The level.
    """
    return bool(robot.machine.read("configurable_digital_in", n))


@command(family="io", manual="3.2")
def get_configurable_digital_out(
    robot: Robot, n: Annotated[int, signal_index("configurable_digital_out")]
) -> Annotated[Bool, SIGNAL]:
    """Return the level that a configurable output is set to.

    Args:
        n: index of the output.

    Returns:
        The level.
    """
    return bool(robot.machine.read("configurable_digital_out", n))


@command(family="io", manual="3.5")
def get_standard_digital_in(
    robot: Robot, n: Annotated[int, signal_index("standard_digital_in")]
) -> Annotated[Bool, SIGNAL]:
    """Return the level of a standard input.

    Args:
        n: index of the input. A MINI control box has only 0 to 7 (*assumed*: the simulated one has them all).

    Returns:
        The level.
    """
    return bool(robot.machine.read("standard_digital_in", n))


@command(family="io", manual="3.6")
def get_standard_digital_out(
    robot: Robot, n: Annotated[int, signal_index("standard_digital_out")]
) -> Annotated[Bool, SIGNAL]:
    """Return the level that a standard output is set to.

    Args:
        n: index of the output. A MINI control box has only 0 to 7 (*assumed*: the simulated one has them all).

    Returns:
        The level.
    """
    return bool(robot.machine.read("standard_digital_out", n))


@command(family="io", manual="3.10")
def set_configurable_digital_out(
    robot: Robot, n: Annotated[int, signal_index("configurable_digital_out")], b: Bool
) -> None:
    """Set a configurable output.

    Args:
        n: index of the output.
        b: level.
    """
    robot.machine.write("configurable_digital_out", n, b)


@command(family="io", manual="3.13")
def set_standard_digital_out(robot: Robot, n: Annotated[int, signal_index("standard_digital_out")], b: Bool) -> None:
    """Set a standard output.

    Args:
        n: index of the output. A MINI control box has only 0 to 7 (*assumed*: the simulated one has them all).
        b: level.
    """
    robot.machine.write("standard_digital_out", n, b)
