"""Access to the controller's own MODBUS server (manual 2.10 chapter 4.1).

Programs see the same registers and coils as clients. A program may set whatever a client may set; a write to any other
address changes nothing, with one warning for each address in a program (*assumed*).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from elitescript.commands.definition.quantities import Bool, Integer
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import SIGNAL
from elitescript.errors import MirroredAddressError
from elitescript.messages.machine import WritePortCoils, WritePortRegisters
from elitescript.messages.signals import WORD_MAX
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot

_SHORT_LOW = -(2**15)

_Coil = Annotated[int, Integer(0, 127)]
_Register = Annotated[int, Integer(0, 511)]


@command(family="modbus", manual="4.1.9")
def read_port_bit(robot: Robot, address: _Coil) -> Annotated[Bool, SIGNAL]:
    """Return a coil of the controller's own MODBUS server.

    Args:
        address: number of the coil.

    Returns:
        The value; False where nothing is behind the address (*assumed*).
    """
    return robot.machine.port_coil(address)


@command(family="modbus", manual="4.1.10")
def read_port_register(
    robot: Robot, address: _Register, is_signed: Bool = False
) -> Annotated[int, Integer(_SHORT_LOW, 2**16 - 1), SIGNAL]:
    """Return a register of the controller's own MODBUS server.

    Args:
        address: number of the register.
        is_signed: True for a value from -32768 to 32767, False for 0 to 65535.

    Returns:
        The value; 0 where nothing is behind the address (*assumed*).
    """
    value = robot.machine.port_register(address, robot.profile.version)
    return value - (WORD_MAX + 1) if is_signed and value > WORD_MAX // 2 else value


@command(family="modbus", manual="4.1.11")
def write_port_bit(robot: Robot, address: _Coil, value: Bool) -> None:
    """Set a coil of the controller's own MODBUS server.

    Args:
        address: number of the coil; the range is that of `read_port_bit` (*assumed*). Those from 32 on can be set.
        value: value to store.

    Raises:
        ScriptStateError: the coil is a tool pin that is no output.
    """
    _write(robot, "write_port_bit", WritePortCoils(address, (value,)))


@command(family="modbus", manual="4.1.12")
def write_port_register(robot: Robot, address: _Register, value: Annotated[int, Integer(_SHORT_LOW, WORD_MAX)]) -> None:
    """Set a register of the controller's own MODBUS server.

    Args:
        address: number of the register.
        value: value to store, 16 bits signed or unsigned.

    Raises:
        InvalidValueError: the register cannot have that value.
        ScriptStateError: the register sets a tool pin that is no output.
    """
    _write(robot, "write_port_register", WritePortRegisters(address, (value & WORD_MAX,)))


def _write(robot: Robot, name: str, request: WritePortCoils | WritePortRegisters) -> None:
    try:
        robot.request(request)
    except MirroredAddressError as error:
        hint = "docs/reference/modbus.md lists what can be set"
        robot.warn_once(
            f"{name} {request.first}",
            said("{name}: {error}; nothing changes", name=name, error=error),
            code="W260",
            hint=hint,
        )
