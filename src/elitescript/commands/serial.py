"""RS-485 ports of the tool and of the control box (manual 2.10 sections 3.29 to 3.56).

The ports cannot be switched on yet. Switching them off works, and so does asking whether they are on: programs of the
pendant do both before they begin.
"""

from __future__ import annotations

from typing import Annotated, Any, Final

from elitescript.commands.quantities import (
    Anything,
    Bool,
    Choice,
    Either,
    Integer,
    Octets,
    Str,
    Text,
    TimeOut,
    Vector,
)
from elitescript.commands.registry import alias, command
from elitescript.errors import NotSimulatedError

_NOT_YET: Final = "serial ports are not simulated yet"

CABINET_PORT: Final = "/dev/ttymxc0"

CabinetPort = Annotated[str, Choice(CABINET_PORT, "/dev/ttyS2")]
"""Device of the control box; the second one is that of B1 and MINI boxes, since 2.14."""

_Parity = Annotated[int, Integer(0, 2)]
_StopBits = Annotated[int, Choice(1, 2)]
_Data = Annotated[Any, Either(Text(), Integer(), Octets(), Vector(Integer(), None, "byte"))]
_Received = Annotated[Any, Anything("list[int] or bytes", "byte")]
_ByteCount = Annotated[int, Integer(0, unit="byte")]


@command(family="serial", manual="3.29")
def tool_serial_is_open() -> Bool:
    """Whether the serial port of the tool is enabled.

    Returns:
        True if it is.
    """
    return False


@command(family="serial", manual="3.30")
def tool_serial_config(
    enabled: Bool,
    baud_rate: Annotated[int, Choice(9600, 19200, 38400, 57600, 115200, 1000000, 2000000, unit="baud")],
    parity: _Parity,
    stop_bits: _StopBits,
    size: Annotated[int, Integer(unit="bit")] = 8,
    modbus_rtu: Bool = False,
    usage: Annotated[int, Choice(0, 1)] = 0,
) -> Bool:
    """Enable, disable and set up the serial port of the tool.

    Only disabling it is simulated yet.

    Args:
        enabled: True enables the port.
        baud_rate: baud rate.
        parity: 0 none, 1 odd, 2 even.
        stop_bits: number of stop bits.
        size: bits of a character; always 8 in MODBUS-RTU mode.
        modbus_rtu: True for MODBUS-RTU, False for plain bytes.
        usage: 0 the port belongs to programs, 1 to a plug-in; programs that use it then get an alarm.

    Returns:
        True if the port is open now.
    """
    if enabled:
        raise NotSimulatedError(_NOT_YET)
    return False


@command(family="serial", manual="3.31", waits=True, is_simulated=False)
def tool_serial_read(read_count: _ByteCount, is_number: Bool, time_out: TimeOut) -> _Received:
    """Read from the serial port of the tool.

    Args:
        read_count: bytes to read.
        is_number: True for a list of numbers 0 to 255, False for bytes.
        time_out: longest time to wait; 0 and less wait for ever.

    Returns:
        What arrived in time.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="serial", manual="3.32", is_simulated=False)
def tool_serial_write(write_data: _Data) -> _ByteCount:
    """Send through the serial port of the tool.

    Args:
        write_data: text, bytes, or one or more numbers, of which the low 8 bits are sent.

    Returns:
        Number of bytes that were sent; 0 and less for a failure.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="serial", manual="3.41")
def tool_serial_mode() -> Str:
    """Mode of the serial port of the tool.

    Returns:
        `"MODBUS-RTU"`, `"RS485"`, or `"CLOSE"` when the port is off.
    """
    return "CLOSE"


@command(family="serial", manual="3.43")
def serial_config(
    enable: Bool,
    baud: Annotated[
        int, Choice(2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400, 460800, 921600, 500000, unit="baud")
    ],
    parity_bit: _Parity,
    stop_bit: _StopBits,
    size: Annotated[int, Choice(7, 8, unit="bit")] = 8,
    modbus_rtu: Bool = False,
    port: CabinetPort = CABINET_PORT,
) -> Bool:
    """Enable, disable and set up the serial port of the control box.

    Only disabling it is simulated yet.

    Args:
        enable: True enables the port.
        baud: baud rate.
        parity_bit: 0 none, 1 odd, 2 even.
        stop_bit: number of stop bits.
        size: bits of a character; has to be 8 in MODBUS-RTU mode, else the call returns False (*assumed*).
        modbus_rtu: True for MODBUS-RTU, False for plain bytes.
        port: device; `/dev/ttyS2` on B1 and MINI boxes.

    Returns:
        True if it worked.
    """
    if enable:
        raise NotSimulatedError(_NOT_YET)
    return True


@command(family="serial", manual="3.44", spellings={"timeout": "time_out"}, waits=True, is_simulated=False)
def serial_read(
    len: Annotated[int, Integer(unit="byte")],
    is_number: Bool = True,
    time_out: TimeOut = 0.1,
    port: CabinetPort = CABINET_PORT,
) -> _Received:
    """Read from the serial port of the control box.

    Args:
        len: bytes to read.
        is_number: True for a list of numbers 0 to 255, False for bytes.
        time_out: longest time to wait; 0 and less wait for ever.
        port: device; `/dev/ttyS2` on B1 and MINI boxes.

    Returns:
        What arrived in time.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="serial", manual="3.45", is_simulated=False)
def serial_write(data: _Data, port: CabinetPort = CABINET_PORT) -> Bool:
    """Send through the serial port of the control box.

    Args:
        data: text, bytes, or one or more numbers, of which the low 8 bits are sent.
        port: device; `/dev/ttyS2` on B1 and MINI boxes.

    Returns:
        True if it worked.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="serial", manual="3.46")
def serial_is_open(port: CabinetPort = CABINET_PORT) -> Bool:
    """Whether the serial port of the control box is enabled.

    Args:
        port: device; `/dev/ttyS2` on B1 and MINI boxes.

    Returns:
        True if it is.
    """
    return False


@command(family="serial", manual="3.47")
def serial_mode(port: CabinetPort = CABINET_PORT) -> Str:
    """Mode of the serial port of the control box.

    Args:
        port: device; `/dev/ttyS2` on B1 and MINI boxes.

    Returns:
        `"MODBUS-RTU"`, `"RS485"`, or `"CLOSE"` when the port is off.
    """
    return "CLOSE"


@command(family="serial", manual="3.56", is_simulated=False)
def serial_flush(port: CabinetPort = CABINET_PORT) -> None:
    """Drop what waits in the serial port of the control box, in both directions (*assumed*).

    Args:
        port: device; `/dev/ttyS2` on B1 and MINI boxes.
    """
    raise NotSimulatedError(_NOT_YET)


# Older name, in the vendor's SDK (four arguments) and in public programs (six).
alias("masterboard_serial_config", of="serial_config", evidence="observed")
