"""Registers that programs share with clients and fieldbuses (manual 2.10 sections 3.58 to 3.66).

Input registers are written from outside and read here; output registers are written here and read outside.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Final

from elitescript.commands.definition.quantities import Bool, Integer, Real, signal_index
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import SIGNAL
from elitescript.messages.signals import INT32_HIGH, INT32_LOW

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot

_BoolAddress = Annotated[int, signal_index("input_bool_register")]
_IntAddress = Annotated[int, signal_index("input_int_register")]
_FloatAddress = Annotated[int, signal_index("input_float_register")]
_ARGUMENTS: Final = {"address": "number of the register."}
"""Texts of arguments that several commands share."""


@command(family="registers", manual="3.58", arguments=_ARGUMENTS)
def read_input_boolean_register(robot: Robot, address: _BoolAddress) -> Annotated[Bool, SIGNAL]:
    """Return the value of a boolean input register.

    Returns:
        The value.
    """
    return bool(robot.machine.read("input_bool_register", address))


@command(family="registers", manual="3.59", arguments=_ARGUMENTS)
def read_input_float_register(robot: Robot, address: _FloatAddress) -> Annotated[Real, SIGNAL]:
    """Return the value of a float input register.

    Returns:
        The value.
    """
    return float(robot.machine.read("input_float_register", address))


@command(family="registers", manual="3.60", arguments=_ARGUMENTS)
def read_input_integer_register(
    robot: Robot, address: _IntAddress
) -> Annotated[int, Integer(INT32_LOW, INT32_HIGH), SIGNAL]:
    """Return the value of an integer input register.

    Returns:
        The value, signed 32 bits.
    """
    return int(robot.machine.read("input_int_register", address))


@command(family="registers", manual="3.61", arguments=_ARGUMENTS)
def read_output_boolean_register(robot: Robot, address: _BoolAddress) -> Annotated[Bool, SIGNAL]:
    """Return the value of a boolean output register.

    Returns:
        The value.
    """
    return bool(robot.machine.read("output_bool_register", address))


@command(family="registers", manual="3.62", arguments=_ARGUMENTS)
def read_output_float_register(robot: Robot, address: _FloatAddress) -> Annotated[Real, SIGNAL]:
    """Return the value of a float output register.

    Returns:
        The value.
    """
    return float(robot.machine.read("output_float_register", address))


@command(family="registers", manual="3.63", arguments=_ARGUMENTS)
def read_output_integer_register(
    robot: Robot, address: _IntAddress
) -> Annotated[int, Integer(INT32_LOW, INT32_HIGH), SIGNAL]:
    """Return the value of an integer output register.

    Returns:
        The value, signed 32 bits.
    """
    return int(robot.machine.read("output_int_register", address))


@command(family="registers", manual="3.64", arguments=_ARGUMENTS)
def write_output_boolean_register(robot: Robot, address: _BoolAddress, value: Bool) -> None:
    """Set a boolean output register.

    Args:
        value: what to store.
    """
    robot.machine.write("output_bool_register", address, value)


@command(family="registers", manual="3.65", arguments=_ARGUMENTS)
def write_output_float_register(robot: Robot, address: _FloatAddress, value: Real) -> None:
    """Set a float output register.

    Args:
        value: what to store.
    """
    robot.machine.write("output_float_register", address, value)


@command(family="registers", manual="3.66", arguments=_ARGUMENTS)
def write_output_integer_register(
    robot: Robot, address: _IntAddress, value: Annotated[int, Integer(INT32_LOW, INT32_HIGH)]
) -> None:
    """Set an integer output register.

    Args:
        value: what to store, signed 32 bits (*assumed*).
    """
    robot.machine.write("output_int_register", address, value)
