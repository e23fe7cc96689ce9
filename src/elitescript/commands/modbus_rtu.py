"""What the MODBUS-RTU commands of both serial ports have in common: their arguments, functions and bounds."""

from __future__ import annotations

from typing import Annotated, Any, Final

from elitescript.commands.definition.context import Robot
from elitescript.commands.definition.quantities import Boolean, Either, Integer, Vector
from elitescript.errors import ArgumentRangeError

READ_COILS: Final = 1
READ_DISCRETE_INPUTS: Final = 2
READ_HOLDING_REGISTERS: Final = 3
READ_INPUT_REGISTERS: Final = 4
WRITE_COIL: Final = 5
WRITE_REGISTER: Final = 6
WRITE_COILS: Final = 15
WRITE_REGISTERS: Final = 16

_ADDRESSES: Final = 65_536
_WRITTEN_MAX: Final = {WRITE_COILS: 1968, WRITE_REGISTERS: 123}
"""Values that one request can take."""

Slave = Annotated[int, Integer(1, 247)]
Address = Annotated[int, Integer(0, _ADDRESSES - 1)]
Count = Annotated[int, Integer(1, 125)]
RegisterValue = Annotated[int, Integer(0, 65535)]
Registers = Annotated[Any, Either(Integer(0, 65535), Vector(Integer(0, 65535), None))]
Bits = Annotated[Any, Either(Boolean(), Vector(Boolean(), None))]
Values = Annotated[tuple[int, ...], Vector(Integer(), None)]


def read(
    robot: Robot, device: str, function: int, slave: int, address: int, count: int, timeout_s: float
) -> tuple[int, ...]:
    """Ask a slave; nothing for a request that fails.

    Raises:
        ArgumentRangeError: beyond the last address.
    """
    _check_end(address, count)
    return robot.lines.read_slave(device, slave, function, address, count, timeout_s) or ()


def write(robot: Robot, device: str, function: int, slave: int, address: int, data: Any, timeout_s: float) -> int:
    """Have a slave take values over; how many it has, 0 for a request that fails.

    Raises:
        ArgumentRangeError: no values, more than a request can take, or beyond the last address.
    """
    values = tuple(map(int, data if isinstance(data, tuple) else (data,)))
    most = _WRITTEN_MAX.get(function, 1)
    if not 1 <= len(values) <= most:
        text = f"data must have 1 to {most} elements, got {len(values)}"
        raise ArgumentRangeError(text, argument="data", value=len(values), limit=f"1 to {most} elements")
    _check_end(address, len(values))
    return len(values) if robot.lines.write_slave(device, slave, function, address, values, timeout_s) else 0


def _check_end(address: int, count: int) -> None:
    if address + count > _ADDRESSES:
        text = f"{count} from address {address} on go beyond the last address, {_ADDRESSES - 1}"
        raise ArgumentRangeError(text, value=address + count - 1, limit=f"<= {_ADDRESSES - 1}")
