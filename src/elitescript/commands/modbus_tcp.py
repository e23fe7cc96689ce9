"""MODBUS TCP signals (manual 2.10 chapter 4.1, manual 2.14 chapter 6.1).

A signal has a name; the controller keeps reading or writing it in the background. There can be 200 of them.
"""

from __future__ import annotations

from typing import Annotated, Any, Final

from elitescript.commands.definition.context import Robot
from elitescript.commands.definition.quantities import Bool, Boolean, Either, Integer, Number, Seconds, Str, Vector
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import STATE, Result
from elitescript.errors import ArgumentRangeError, InvalidValueError
from elitescript.said import said

_WRITE_SINGLE_REGISTER: Final = 6
_INPUTS: Final = (0, 2)
_ADDRESSES: Final = 65536
_DATA_MAX: Final = 252
"""Bytes that fit behind a function code."""
_WRITE_MAX: Final = 121
"""Registers that function 23 can write."""
_BROADCAST: Final = 0
_ANY_SLAVE: Final = 255
_LAST_SLAVE: Final = 247

_Register = Annotated[int, Integer(0, 65535)]
_RegisterCount = Annotated[int, Integer(1, 123)]
_TcpPort = Annotated[int, Integer(1, 65535)]
_Slave = Annotated[int, Integer(0, 255)]
_ARGUMENTS: Final = {
    "IP": "address of the device.",
    "signal_name": "name of the signal.",
    "port": "TCP port of the device.",
}
"""Texts of arguments that several commands share."""


@command(family="modbus", manual="4.1.1", arguments=_ARGUMENTS)
def modbus_add_signal(
    robot: Robot,
    IP: Str,
    slave_number: _Slave,
    signal_address: _Register,
    signal_type: Annotated[int, Integer(0, 3)],
    signal_name: Str,
    issequential: Bool = False,
    registers_count: _RegisterCount = 1,
    port: _TcpPort = 502,
) -> None:
    """Add a signal; the call does not wait for an answer. Firmware 2.10 has the first five arguments.

    Outputs are read until a program sets them for the first time, and written from then on, 10 times a second
    (*assumed*) unless `modbus_set_signal_update_frequency` says otherwise. Signals stay when the program ends
    (*assumed*): the next program of the same robot finds them. What was set last is written before `elitescript run`
    ends.

    Args:
        slave_number: number of the slave, usually 255; 0 is broadcast, which gets no answer, so that there is
            nothing to read from it; 248 to 254 count as 255.
        signal_address: first coil or register.
        signal_type: 0 digital input, 1 digital output, 2 input register, 3 register output.
        signal_name: name of the signal; an older signal of that name is replaced.
        issequential: True updates the signals in the order in which they were added, each when the one before it was
            answered.
        registers_count: number of coils or registers.

    Raises:
        InvalidValueError: no address or name, or more coils or registers than there are from that address on.
        ScriptStateError: there are 200 signals already.
    """
    _check_names(IP, signal_name)
    _check_end("registers_count", signal_address, registers_count)
    slave = _slave(slave_number)
    if slave == _BROADCAST and signal_type in _INPUTS:
        text = said("a broadcast gets no answer: the MODBUS signal {signal_name!r} stays at 0", signal_name=signal_name)
        robot.warn_once(f"broadcast {signal_name}", text)
    robot.modbus.add(
        IP, port, signal_name, signal_type, slave, signal_address, registers_count, is_sequential=issequential
    )


@command(family="modbus", manual="4.1.2", arguments=_ARGUMENTS)
def modbus_delete_signal(robot: Robot, signal_name: Str) -> None:
    """Remove a signal.

    Raises:
        InvalidValueError: there is none of that name.
    """
    robot.modbus.delete(signal_name)


@command(family="modbus", since="2.14", manual="2.14: 6.1.3", arguments=_ARGUMENTS)
def modbus_add_rw_signal(
    robot: Robot,
    IP: Str,
    slave_number: _Slave,
    read_address: _Register,
    read_register_count: _RegisterCount,
    write_address: _Register,
    write_register_count: _RegisterCount,
    signal_name: Str,
    issequential: Bool = False,
    port: _TcpPort = 502,
) -> None:
    """Add a signal that reads and writes registers in one request (function code 23).

    It is read with function code 3 until a program sets it for the first time. It counts as one of the 200 signals
    (*assumed*).

    Args:
        slave_number: number of the slave, usually 255; 0 is broadcast, 248 to 254 count as 255.
        read_address: first register to read.
        read_register_count: number of registers to read.
        write_address: first register to write; the ranges may overlap.
        write_register_count: number of registers to write; more than 121 do not fit into a request of MODBUS.
        signal_name: name of the signal; an older signal of that name is replaced.
        issequential: True updates the signals in the order in which they were added.

    Raises:
        InvalidValueError: no address or name, more registers than there are from an address on, or too many to write.
        ScriptStateError: there are 200 signals already.
    """
    _check_names(IP, signal_name)
    _check_end("read_register_count", read_address, read_register_count)
    _check_end("write_register_count", write_address, write_register_count)
    if write_register_count > _WRITE_MAX:
        what, count = "write_register_count", write_register_count
        text = said(
            "{what} must be <= {write_max}, as more do not fit into a request, got {count}",
            what=what,
            write_max=_WRITE_MAX,
            count=count,
        )
        raise InvalidValueError(text, argument=what, value=count, limit=f"<= {_WRITE_MAX}")
    robot.modbus.add_read_write(
        IP,
        port,
        signal_name,
        _slave(slave_number),
        (read_address, read_register_count),
        (write_address, write_register_count),
        is_sequential=issequential,
    )


@command(family="modbus", manual="4.1.3", arguments=_ARGUMENTS)
def modbus_get_signal_status(
    robot: Robot, signal_name: Str, is_secondary_program: Bool = False
) -> Annotated[
    Any,
    Either(Boolean(), Integer(0, 65535), Vector(Either(Boolean(), Integer(0, 65535)), None)),
    Result("signal", may_be_late=True),
]:
    """Return the value of a signal: the last one read, zeros before; of an output, the last one set (*assumed*).

    Args:
        is_secondary_program: accepted without effect; manual 2.14 names it and does not explain it.

    Returns:
        A bool for a coil, an int 0 to 65535 for a register, a list for several of them.

    Raises:
        InvalidValueError: there is none of that name.
        ScriptStateError: it has not worked for longer than its watchdog allows (R134).
    """
    return robot.modbus.status(signal_name)


@command(family="modbus", manual="4.1.4", arguments=_ARGUMENTS)
def modbus_send_custom_command(
    robot: Robot,
    IP: Str,
    slave_number: _Slave,
    function_code: Annotated[int, Integer(1, 127)],
    data: Annotated[tuple[int, ...], Vector(Integer(0, 255), None)],
    oneshot: Bool = True,
    port: _TcpPort = 502,
) -> None:
    """Send a request with a function code and bytes of one's own; the answer is not delivered.

    A refusal, or no answer, is a warning. Repeated requests leave 10 times a second, until the program ends or sends
    another one of that function to that slave, and count as signals (*assumed*). Firmware 2.10 has the first four
    arguments and function code 6 alone.

    Args:
        slave_number: number of the slave, usually 255; 0 is broadcast; 248 to 254 count as 255 up to firmware 2.10.
        function_code: MODBUS function code.
        data: bytes behind the function code, at most 252.
        oneshot: True sends once, False again and again.

    Raises:
        ArgumentRangeError: another function code than 6 up to firmware 2.10.
        InvalidValueError: no address, or too many bytes.
        ScriptStateError: too many requests wait, or there are 200 signals already.
    """
    is_old = robot.profile.release <= (2, 10)
    if is_old and function_code != _WRITE_SINGLE_REGISTER:
        raise ArgumentRangeError(
            said(
                "function_code must be {only} in firmware {profile}, got {function_code}",
                only=_WRITE_SINGLE_REGISTER,
                profile=robot.profile.name,
                function_code=function_code,
            ),
            argument="function_code",
            value=function_code,
            limit=str(_WRITE_SINGLE_REGISTER),
        )
    _check_names(IP)
    if len(data) > _DATA_MAX:
        text = said(
            "data has {count} bytes, at most {data_max} fit behind a function code", count=len(data), data_max=_DATA_MAX
        )
        raise InvalidValueError(text, argument="data", value=len(data), limit=f"<= {_DATA_MAX}", unit="bytes")
    slave = _slave(slave_number) if is_old else slave_number
    robot.modbus.request(IP, port, slave, function_code, bytes(data), is_once=oneshot)


@command(family="modbus", manual="4.1.5", arguments=_ARGUMENTS)
def modbus_set_output_register(
    robot: Robot, signal_name: Str, register_value: Annotated[Any, Either(Integer(), Vector(Integer(), None))]
) -> None:
    """Set an output register signal, or the registers that a read/write signal writes.

    Args:
        register_value: value, of which the low 16 bits count; from 2.14 also a list, which may be shorter than the
            signal: the registers behind it keep what they have.

    Raises:
        InvalidValueError: an empty list, one longer than the signal, no signal of that name, or one of another type.
        ScriptStateError: it has not worked for longer than its watchdog allows (R134).
    """
    values = _values("register_value", register_value)
    robot.modbus.set(signal_name, values, is_digital=False)


@command(family="modbus", manual="4.1.6", arguments=_ARGUMENTS)
def modbus_set_output_signal(
    robot: Robot, signal_name: Str, digital_value: Annotated[Any, Either(Boolean(), Vector(Boolean(), None))]
) -> None:
    """Set a digital output signal.

    Args:
        digital_value: level; from 2.14 also a list, which may be shorter than the signal: the coils behind it keep what
            they have.

    Raises:
        InvalidValueError: an empty list, one longer than the signal, no signal of that name, or one of another type.
        ScriptStateError: it has not worked for longer than its watchdog allows (R134).
    """
    values = _values("digital_value", digital_value)
    robot.modbus.set(signal_name, tuple(int(value) for value in values), is_digital=True)


@command(family="modbus", manual="4.1.7", arguments=_ARGUMENTS)
def modbus_set_runstate_dependent_choice(
    robot: Robot, signal_name: Str, runstate_choice: Annotated[int, Integer(0, 3)]
) -> None:
    """Tie a digital output signal to whether a program runs; a paused one does (*assumed*).

    Args:
        runstate_choice: 0 not tied; 1 low without a program; 2 high without a program; 3 low without, high with a
            program.

    Raises:
        InvalidValueError: there is no signal of that name, or it is no digital output.
    """
    robot.modbus.tie(signal_name, runstate_choice)


@command(family="modbus", manual="4.1.8", arguments=_ARGUMENTS)
def modbus_set_signal_update_frequency(
    robot: Robot, signal_name: Str, update_frequency: Annotated[int, Integer(0, 250, "Hz")]
) -> None:
    """Set how often a signal is read or written.

    Args:
        update_frequency: requests per second; 0 for none but one for each time that a program sets it (*assumed*).

    Raises:
        InvalidValueError: there is none of that name.
    """
    robot.modbus.retime(signal_name, update_frequency)


@command(family="modbus", since="2.14", manual="2.14: 6.1.10", arguments=_ARGUMENTS)
def modbus_set_signal_watchdog(
    robot: Robot, signal_name: Str, timeout: Annotated[float, Number("s", 0.0, 300.0)]
) -> None:
    """Set how long a signal may be faulty before using it is an alarm; 5 s at first.

    Args:
        timeout: the time.

    Raises:
        InvalidValueError: there is none of that name.
    """
    robot.modbus.set_watchdog(signal_name, timeout)


@command(family="modbus", since="2.14", manual="2.14: 6.1.15", arguments=_ARGUMENTS)
def modbus_get_error(
    robot: Robot, signal_name: Str, error_source: Annotated[int, Integer(0, 2)] = 0
) -> Annotated[tuple[int, ...], Vector(Integer(), None), STATE]:
    """Return what is wrong with a signal.

    Args:
        error_source: 0 both, 1 the device, 2 the connection.

    Returns:
        [code of the device, code of the connection], or the selected one. Devices: -2 not connected, -1
        connecting or not answered yet, 0 nothing, 1 to 11 MODBUS exceptions, 9 also an answer that makes no sense
        (*assumed*); connections: error numbers of TCP/IP, 110 also for a request without an answer within 1 s
        (*assumed*).

    Raises:
        InvalidValueError: there is none of that name.
    """
    codes = robot.modbus.errors(signal_name)
    return codes if error_source == 0 else (codes[error_source - 1],)


@command(family="modbus", since="2.14", manual="2.14: 6.1.16", arguments=_ARGUMENTS)
def modbus_get_time_since_signal_invalid(robot: Robot, signal_name: Str) -> Annotated[Seconds, STATE]:
    """Return the time since a faulty signal worked the last time; since it was added if it never did (*assumed*).

    Returns:
        The time; 0 for a signal that works.

    Raises:
        InvalidValueError: there is none of that name.
    """
    return robot.modbus.invalid_s(signal_name)


@command(
    family="modbus",
    since="2.14",
    manual="2.14: 6.1.17",
    spellings={"ip": "connection_id"},
    waits=True,
    arguments=_ARGUMENTS,
)
def modbus_reset_connection(robot: Robot, connection_id: Str, isBlocking: Bool = True, port: _TcpPort = 502) -> None:
    """Connect to a device anew.

    Args:
        connection_id: address of the device, as its signals name it.
        isBlocking: True waits for the outcome, at most 2 s; a secondary program does not wait.

    Raises:
        InvalidValueError: no signal uses that device (*assumed*).
    """
    robot.modbus.reset(connection_id, port, waits=isBlocking)


def _check_names(address: str, name: str | None = None) -> None:
    if not address:
        raise InvalidValueError("IP is empty", argument="IP", value=address, limit="an address")
    if name == "":
        raise InvalidValueError("signal_name is empty", argument="signal_name", value=name, limit="a name")


def _check_end(name: str, first: int, count: int) -> None:
    room = _ADDRESSES - first
    if count > room:
        text = said(
            "{name} must be <= {room}, as the last address is {addresses}, got {count}",
            name=name,
            room=room,
            addresses=_ADDRESSES - 1,
            count=count,
        )
        raise InvalidValueError(text, argument=name, value=count, limit=f"<= {room}")


def _slave(number: int) -> int:
    return _ANY_SLAVE if number > _LAST_SLAVE else number


def _values(name: str, value: Any) -> tuple[Any, ...]:
    if value == ():
        raise InvalidValueError(
            said("{name} is an empty list", name=name), argument=name, value=[], limit=">= 1 element"
        )
    return value if isinstance(value, tuple) else (value,)
