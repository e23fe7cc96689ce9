"""RS-485 ports of the tool and of the control box (manual 2.10 sections 3.29 to 3.56).

A port stays configured when the program ends (*assumed*). What fails shows in the result, and its reason in the log;
only the use of a port that belongs to a daemon is an alarm. Text goes out as UTF-8, of which ASCII is a part
(*assumed*).
"""

from __future__ import annotations

from typing import Annotated, Any, Final

from elitescript.commands.definition.context import Robot
from elitescript.commands.definition.quantities import (
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
from elitescript.commands.definition.registry import alias, command
from elitescript.commands.definition.results import DONE, STATE, WRITTEN, Result
from elitescript.errors import ArgumentRangeError
from elitescript.messages.line import LineSettings
from elitescript.said import said

TOOL_PORT: Final = "tool"
CABINET_PORT: Final = "/dev/ttymxc0"
_SECOND_PORT: Final = "/dev/ttyS2"
_SECOND_PORT_SINCE: Final = (2, 14)

_DASHED_UNTIL: Final = (2, 10)
"""Firmware up to which the plain mode is written as the manual 2.10 prints it; of the control box *assumed*."""

CabinetPort = Annotated[str, Choice(CABINET_PORT, _SECOND_PORT)]
"""Device of the control box; the second one is that of B1 and MINI boxes, since 2.14."""

_Parity = Annotated[int, Integer(0, 2)]
_StopBits = Annotated[int, Choice(1, 2)]
_Data = Annotated[Any, Either(Text(), Integer(), Octets(), Vector(Integer(), None, "byte"))]
_Received = Annotated[Any, Anything("list[int] or bytes", "byte")]
_MODBUS_SIZE: Final = 8
_ByteCount = Annotated[int, Integer(0, unit="byte")]
_SentCount = Annotated[int, Integer(unit="byte")]
_ARGUMENTS: Final = {
    "port": "device; `/dev/ttyS2` on B1 and MINI boxes.",
    "time_out": "longest time to wait; 0 and less wait for ever.",
    "is_number": "True for a list of numbers 0 to 255, False for bytes.",
}
"""Texts of arguments that several commands share."""


def cabinet_device(robot: Robot, port: str) -> str:
    """Return the port of the control box that a program names.

    Raises:
        ArgumentRangeError: the firmware does not have it.
    """
    if port == _SECOND_PORT and robot.profile.release < _SECOND_PORT_SINCE:
        text = said(
            "port must be {cabinet_port!r}, got {port!r}, which firmware {profile} does not have",
            cabinet_port=CABINET_PORT,
            port=port,
            profile=robot.profile.name,
        )
        raise ArgumentRangeError(text, argument="port", value=port, limit=CABINET_PORT)
    return port


def _octets(data: Any) -> bytes:
    """Return the bytes to send for a value: of numbers the low 8 bits."""
    if isinstance(data, str):
        return data.encode("utf-8", "replace")
    if isinstance(data, bytes):
        return data
    return bytes(number & 0xFF for number in (data if isinstance(data, tuple) else (data,)))


def _received(data: bytes, is_number: bool) -> list[int] | bytes:
    return list(data) if is_number else data


@command(family="serial", manual="3.29")
def tool_serial_is_open(robot: Robot) -> Annotated[Bool, STATE]:
    """Return whether the serial port of the tool is enabled.

    Returns:
        True if it is.
    """
    return robot.lines.is_open(TOOL_PORT)


@command(family="serial", manual="3.30", waits=True)
def tool_serial_config(
    robot: Robot,
    enabled: Bool,
    baud_rate: Annotated[int, Choice(9600, 19200, 38400, 57600, 115200, 1000000, 2000000, unit="baud")],
    parity: _Parity,
    stop_bits: _StopBits,
    size: Annotated[int, Integer(5, 8, unit="bit")] = 8,
    modbus_rtu: Bool = False,
    usage: Annotated[int, Choice(0, 1)] = 0,
) -> Annotated[Bool, DONE]:
    """Enable, disable and set up the serial port of the tool.

    What waits in the port is lost, whatever is changed (*assumed*).

    Args:
        enabled: True enables the port.
        baud_rate: baud rate.
        parity: 0 none, 1 odd, 2 even.
        stop_bits: number of stop bits.
        size: bits of a character, 5 to 8 (*assumed*); always 8 in MODBUS-RTU mode.
        modbus_rtu: True for MODBUS-RTU, False for plain bytes.
        usage: 0 the port belongs to programs, 1 to a plug-in; programs that use it then get an alarm.

    Returns:
        True if the port is open now.
    """
    if not enabled:
        robot.lines.disable(TOOL_PORT)
        return False
    settings = LineSettings(baud_rate, parity, stop_bits, 8 if modbus_rtu else size)
    return robot.lines.enable(TOOL_PORT, settings, is_modbus=modbus_rtu, is_daemons=usage == 1)


@command(family="serial", manual="3.31", waits=True, arguments=_ARGUMENTS)
def tool_serial_read(
    robot: Robot, read_count: _ByteCount, is_number: Bool, time_out: TimeOut
) -> Annotated[_Received, Result("channel", kinds=(list, bytes))]:
    """Read from the serial port of the tool.

    Args:
        read_count: bytes to read.

    Returns:
        What arrived in time.
    """
    return _received(robot.lines.read(TOOL_PORT, read_count, time_out), is_number)


@command(family="serial", manual="3.32")
def tool_serial_write(robot: Robot, write_data: _Data) -> Annotated[_SentCount, WRITTEN]:
    """Send through the serial port of the tool.

    Args:
        write_data: text, bytes, or one or more numbers, of which the low 8 bits are sent.

    Returns:
        Number of bytes that were sent; what is less than 0 is a failure too.
    """
    return robot.lines.write(TOOL_PORT, _octets(write_data), is_text=isinstance(write_data, str)) or 0


@command(family="serial", manual="3.41")
def tool_serial_mode(robot: Robot) -> Annotated[Str, STATE]:
    """Return the mode of the serial port of the tool.

    Returns:
        `"MODBUS-RTU"`, `"CLOSE"` when the port is off, or `"RS485"`; with firmware 2.10 `"RS-485"`, as its manual
        prints it.
    """
    return _mode(robot, TOOL_PORT)


@command(family="serial", manual="3.43", waits=True, arguments=_ARGUMENTS)
def serial_config(
    robot: Robot,
    enable: Bool,
    baud: Annotated[
        int, Choice(2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400, 460800, 921600, 500000, unit="baud")
    ],
    parity_bit: _Parity,
    stop_bit: _StopBits,
    size: Annotated[int, Choice(7, 8, unit="bit")] = 8,
    modbus_rtu: Bool = False,
    port: CabinetPort = CABINET_PORT,
) -> Annotated[Bool, DONE]:
    """Enable, disable and set up the serial port of the control box.

    What waits in the port is lost, whatever is changed (*assumed*).

    Args:
        enable: True enables the port.
        baud: baud rate.
        parity_bit: 0 none, 1 odd, 2 even.
        stop_bit: number of stop bits.
        size: bits of a character; has to be 8 in MODBUS-RTU mode, else the call returns False (*assumed*).
        modbus_rtu: True for MODBUS-RTU, False for plain bytes.

    Returns:
        True if it worked.
    """
    device = cabinet_device(robot, port)
    if not enable:
        robot.lines.disable(device)
        return True
    if modbus_rtu and size != _MODBUS_SIZE:
        text = said(
            "serial_config: size must be {modbus_size} bit with modbus_rtu, got {size}; nothing was changed",
            modbus_size=_MODBUS_SIZE,
            size=size,
        )
        robot.warn_once(f"serial_config {device}", text)
        return False
    return robot.lines.enable(device, LineSettings(baud, parity_bit, stop_bit, size), is_modbus=modbus_rtu)


@command(family="serial", manual="3.44", waits=True, arguments=_ARGUMENTS)
def serial_read(
    robot: Robot,
    len: _ByteCount,
    is_number: Bool = True,
    time_out: TimeOut = 0.1,
    port: CabinetPort = CABINET_PORT,
) -> Annotated[_Received, Result("channel", kinds=(list, bytes))]:
    """Read from the serial port of the control box.

    Args:
        len: bytes to read.

    Returns:
        What arrived in time.
    """
    return _received(robot.lines.read(cabinet_device(robot, port), len, time_out), is_number)


@command(family="serial", manual="3.45", arguments=_ARGUMENTS)
def serial_write(robot: Robot, data: _Data, port: CabinetPort = CABINET_PORT) -> Annotated[Bool, DONE]:
    """Send through the serial port of the control box.

    Args:
        data: text, bytes, or one or more numbers, of which the low 8 bits are sent.

    Returns:
        True if it worked.
    """
    octets = _octets(data)
    return robot.lines.write(cabinet_device(robot, port), octets, is_text=isinstance(data, str)) == len(octets)


@command(family="serial", manual="3.46", arguments=_ARGUMENTS)
def serial_is_open(robot: Robot, port: CabinetPort = CABINET_PORT) -> Annotated[Bool, STATE]:
    """Return whether the serial port of the control box is enabled.

    Returns:
        True if it is.
    """
    return robot.lines.is_open(cabinet_device(robot, port))


@command(family="serial", manual="3.47", arguments=_ARGUMENTS)
def serial_mode(robot: Robot, port: CabinetPort = CABINET_PORT) -> Annotated[Str, STATE]:
    """Return the mode of the serial port of the control box.

    Returns:
        `"MODBUS-RTU"`, `"CLOSE"` when the port is off, or `"RS485"`; with firmware 2.10 `"RS-485"`, as its manual
        prints it.
    """
    return _mode(robot, cabinet_device(robot, port))


@command(family="serial", manual="3.56", arguments=_ARGUMENTS)
def serial_flush(robot: Robot, port: CabinetPort = CABINET_PORT) -> None:
    """Drop what has arrived in the serial port of the control box and is not read (*assumed*).

    What is being sent goes out all the same (*assumed*).
    """
    robot.lines.flush(cabinet_device(robot, port))


# Older name, in the vendor's SDK (four arguments) and in public programs (six).
alias("masterboard_serial_config", of="serial_config", evidence="observed")


def _mode(robot: Robot, device: str) -> str:
    mode = robot.lines.mode(device)
    return "RS-485" if mode == "RS485" and robot.profile.release <= _DASHED_UNTIL else mode
