"""MODBUS TCP signals (manual 2.10 chapter 4.1, manual 2.14 chapter 6.1).

A signal has a name; the controller keeps reading or writing it in the background. There can be 200 of them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Final

from elitescript.commands.quantities import Bool, Boolean, Either, Integer, Number, Seconds, Str, Vector
from elitescript.commands.registry import command
from elitescript.errors import ArgumentRangeError, InvalidValueError, NotSimulatedError

if TYPE_CHECKING:
    from elitescript.commands.context import Robot

_NOT_YET: Final = "MODBUS TCP is not simulated yet"
_WRITE_SINGLE_REGISTER: Final = 6

_Register = Annotated[int, Integer(0, 65535)]
_RegisterCount = Annotated[int, Integer(1, 123)]
_TcpPort = Annotated[int, Integer(1, 65535)]
_Slave = Annotated[int, Integer(0, 255)]


@command(
    family="modbus",
    manual="4.1.1",
    spellings={"singal_type": "signal_type", "singal_name": "signal_name"},
    is_simulated=False,
)
def modbus_add_signal(
    IP: Str,
    slave_number: _Slave,
    signal_address: _Register,
    signal_type: Annotated[int, Integer(0, 3)],
    signal_name: Str,
    issequential: Bool = False,
    registers_count: _RegisterCount = 1,
    port: _TcpPort = 502,
) -> None:
    """Add a signal; the call does not wait for an answer. Firmware 2.10 knows the first five arguments.

    Outputs are read until a program sets them for the first time, and written from then on.

    Args:
        IP: address of the device.
        slave_number: number of the slave, usually 255; 0 is broadcast, 248 to 254 count as 255.
        signal_address: first coil or register.
        signal_type: 0 digital input, 1 digital output, 2 input register, 3 output register.
        signal_name: name of the signal; an older signal of that name is replaced.
        issequential: True updates the signals in the order in which they were added.
        registers_count: number of coils or registers.
        port: TCP port of the device.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus", manual="4.1.2", spellings={"singal_name": "signal_name"}, is_simulated=False)
def modbus_delete_signal(signal_name: Str) -> None:
    """Remove a signal.

    Args:
        signal_name: name of the signal.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus", since="2.14", manual="2.14: 6.1.3", is_simulated=False)
def modbus_add_rw_signal(
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

    Args:
        IP: address of the device.
        slave_number: number of the slave, usually 255; 0 is broadcast, 248 to 254 count as 255.
        read_address: first register to read.
        read_register_count: number of registers to read.
        write_address: first register to write; the ranges may overlap.
        write_register_count: number of registers to write.
        signal_name: name of the signal; an older signal of that name is replaced.
        issequential: True updates the signals in the order in which they were added.
        port: TCP port of the device.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus", manual="4.1.3", is_simulated=False)
def modbus_get_signal_status(
    signal_name: Str, is_secondary_program: Bool = False
) -> Annotated[Any, Either(Boolean(), Integer(), Vector(Integer(), None))]:
    """Value of a signal.

    Args:
        signal_name: name of the signal.
        is_secondary_program: accepted without effect; manual 2.14 names it and does not explain it.

    Returns:
        A bool for a coil, an int 0 to 65535 for a register, a list for several of them.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus", manual="4.1.4", is_simulated=False)
def modbus_send_custom_command(
    robot: Robot,
    IP: Str,
    slave_number: _Slave,
    function_code: Annotated[int, Integer(0, 255)],
    data: Annotated[tuple[int, ...], Vector(Integer(0, 255), None)],
    oneshot: Bool = True,
    port: _TcpPort = 502,
) -> None:
    """Send a request with a function code and bytes of one's own; the answer is not delivered.

    Firmware 2.10 knows the first four arguments and function code 6 alone.

    Args:
        IP: address of the device.
        slave_number: number of the slave, usually 255.
        function_code: MODBUS function code.
        data: bytes behind the function code.
        oneshot: True sends once, False again and again.
        port: TCP port of the device.

    Raises:
        ArgumentRangeError: another function code than 6 up to firmware 2.10.
    """
    if robot.profile.release <= (2, 10) and function_code != _WRITE_SINGLE_REGISTER:
        raise ArgumentRangeError(
            f"function_code must be {_WRITE_SINGLE_REGISTER} in firmware {robot.profile.name}, got {function_code}",
            argument="function_code",
            value=function_code,
            limit=str(_WRITE_SINGLE_REGISTER),
        )
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus", manual="4.1.5", is_simulated=False)
def modbus_set_output_register(
    signal_name: Str, register_value: Annotated[Any, Either(Integer(), Vector(Integer(), None))]
) -> None:
    """Set an output register signal.

    Args:
        signal_name: name of the signal.
        register_value: value, of which the low 16 bits count; from 2.14 also a list, which may be shorter than the
            signal.
    """
    _refuse_empty("register_value", register_value)
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus", manual="4.1.6", spellings={"ignal_name": "signal_name"}, is_simulated=False)
def modbus_set_output_signal(
    signal_name: Str, digital_value: Annotated[Any, Either(Boolean(), Vector(Boolean(), None))]
) -> None:
    """Set a digital output signal.

    Args:
        signal_name: name of the signal.
        digital_value: level; from 2.14 also a list, which may be shorter than the signal.
    """
    _refuse_empty("digital_value", digital_value)
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus", manual="4.1.7", is_simulated=False)
def modbus_set_runstate_dependent_choice(signal_name: Str, runstate_choice: Annotated[int, Integer(0, 3)]) -> None:
    """Tie an output signal to whether a program runs.

    Args:
        signal_name: name of the signal.
        runstate_choice: 0 not tied; 1 low without a program; 2 high without a program; 3 low without, high with a
            program.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus", manual="4.1.8", spellings={"update_freqency": "update_frequency"}, is_simulated=False)
def modbus_set_signal_update_frequency(
    signal_name: Str, update_frequency: Annotated[int, Integer(0, 250, "Hz")]
) -> None:
    """Set how often a signal is read or written.

    Args:
        signal_name: name of the signal.
        update_frequency: requests per second; 0 for none (*assumed*).
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus", since="2.14", manual="2.14: 6.1.10", is_simulated=False)
def modbus_set_signal_watchdog(signal_name: Str, timeout: Annotated[float, Number("s", 0.0, 300.0)]) -> None:
    """Set how long a signal may be faulty before using it is an alarm; 5 s at first.

    Args:
        signal_name: name of the signal.
        timeout: the time.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus", since="2.14", manual="2.14: 6.1.15", is_simulated=False)
def modbus_get_error(
    signal_name: Str, error_source: Annotated[int, Integer(0, 2)] = 0
) -> Annotated[tuple[int, ...], Vector(Integer(), None)]:
    """What is wrong with a signal.

    Args:
        signal_name: name of the signal.
        error_source: 0 both, 1 the device, 2 the connection.

    Returns:
        [code of the device, code of the connection], or the one that was asked for. Devices: -2 not connected, -1
        connecting, 0 nothing, 1 to 11 MODBUS exceptions; connections: error numbers of TCP/IP.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus", since="2.14", manual="2.14: 6.1.16", is_simulated=False)
def modbus_get_time_since_signal_invalid(signal_name: Str) -> Seconds:
    """Time since a faulty signal worked the last time.

    Args:
        signal_name: name of the signal.

    Returns:
        The time; 0 for a signal that works.
    """
    raise NotSimulatedError(_NOT_YET)


@command(
    family="modbus",
    since="2.14",
    manual="2.14: 6.1.17",
    spellings={"ip": "connection_id"},
    waits=True,
    is_simulated=False,
)
def modbus_reset_connection(connection_id: Str, isBlocking: Bool = True, port: _TcpPort = 502) -> None:
    """Connect to a device anew.

    Args:
        connection_id: address of the device.
        isBlocking: True waits for the outcome.
        port: TCP port of the device.
    """
    raise NotSimulatedError(_NOT_YET)


def _refuse_empty(name: str, value: Any) -> None:
    if value == ():
        raise InvalidValueError(f"{name} is an empty list", argument=name, value=[], limit=">= 1 element")
