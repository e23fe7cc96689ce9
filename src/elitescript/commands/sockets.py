"""TCP connections of a program (manual 2.10 chapter 5.1).

A connection has a name, `socket_0` unless the program gives another. What fails shows in the result, not as an alarm.
"""

from __future__ import annotations

from typing import Annotated, Any, Final

from elitescript.commands.quantities import Any_, Bool, Either, Integer, Number, Str, Text, TimeOut, Vector, Whole
from elitescript.commands.registry import command
from elitescript.errors import ArgumentRangeError, NotSimulatedError
from elitescript.messages.signals import INT32_HIGH, INT32_LOW

_NOT_YET: Final = "TCP sockets are not simulated yet"
_DEFAULT_SOCKET: Final = "socket_0"

_NumberCount = Annotated[int, Integer(1, 30)]
_Ints = Annotated[tuple[int, ...], Vector(Integer(), None)]


@command(family="socket", manual="5.1.1", waits=True, is_simulated=False)
def socket_open(address: Str, port: Annotated[int, Integer(0, 65535)], socket_name: Str = _DEFAULT_SOCKET) -> Bool:
    """Connect to a TCP server, within 2 s.

    A connection of that name that still stands is kept; one that does not is opened anew.

    Args:
        address: address of the server.
        port: port of the server.
        socket_name: name of the connection; empty for the usual one.

    Returns:
        True if the connection stands.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="socket", manual="5.1.2", is_simulated=False)
def socket_close(socket_name: Str = _DEFAULT_SOCKET) -> None:
    """Close a connection; one that is unknown or closed does no harm (*assumed*).

    Args:
        socket_name: name of the connection; empty for the usual one.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="socket", since="2.14", manual="2.14: 7.1.3", is_simulated=False)
def socket_is_connected(socket_name: Str = _DEFAULT_SOCKET) -> Bool:
    """Whether a connection stands.

    Args:
        socket_name: name of the connection; empty for the usual one.

    Returns:
        True if it does.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="socket", manual="5.1.3", waits=True, is_simulated=False)
def socket_get_var(var_name: Str, socket_name: Str = _DEFAULT_SOCKET) -> Whole:
    """Ask the server for a variable: sends `GET <name>` and a line feed, waits 2 s for `<name> <int>`.

    Args:
        var_name: name of the variable.
        socket_name: name of the connection; empty for the usual one.

    Returns:
        The value, brought into 32 bits; 0 also after a failure.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="socket", manual="5.1.4", waits=True, is_simulated=False)
def socket_read_ascii_float(
    number: _NumberCount, socket_name: Str = _DEFAULT_SOCKET, timeout: TimeOut = 2
) -> Annotated[tuple[float, ...], Vector(Number(allows_non_finite=True), None)]:
    """Read numbers that are sent as text, such as `(3.14, 2.5)`; commas and blanks separate, empty fields are skipped.

    Args:
        number: how many numbers.
        socket_name: name of the connection; empty for the usual one.
        timeout: longest time to wait; 0 and less wait for ever.

    Returns:
        How many arrived, then `number` values; those that are missing are nan.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="socket", manual="5.1.5", waits=True, is_simulated=False)
def socket_read_binary_integer(number: _NumberCount, socket_name: Str = _DEFAULT_SOCKET, timeout: TimeOut = 2) -> _Ints:
    """Read signed numbers of 32 bits in network byte order.

    Args:
        number: how many numbers.
        socket_name: name of the connection; empty for the usual one.
        timeout: longest time to wait; 0 and less wait for ever.

    Returns:
        How many arrived, then `number` values; those that are missing are -1.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="socket", manual="5.1.6", waits=True, is_simulated=False)
def socket_read_byte_list(
    number: Annotated[int, Integer(1, 512)], socket_name: Str = _DEFAULT_SOCKET, timeout: TimeOut = 2
) -> _Ints:
    """Read bytes.

    Args:
        number: how many bytes.
        socket_name: name of the connection; empty for the usual one.
        timeout: longest time to wait; 0 and less wait for ever.

    Returns:
        How many arrived, then `number` values; those that are missing are -1.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="socket", manual="5.1.7", is_simulated=False)
def socket_send_byte_list(
    value: Annotated[tuple[int, ...], Vector(Integer(0, 255), None)], socket_name: Str = _DEFAULT_SOCKET
) -> Annotated[int, Integer(unit="byte")]:
    """Send bytes.

    Args:
        value: the bytes.
        socket_name: name of the connection; empty for the usual one.

    Returns:
        How many were sent.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="socket", manual="5.1.8", waits=True, is_simulated=False)
def socket_read_string(
    socket_name: Str = _DEFAULT_SOCKET, prefix: Str = "", suffix: Str = "", timeout: TimeOut = 2
) -> Str:
    """Read text, if wanted between two marks; at most 2047 bytes. What is not used up stays for the next call.

    Args:
        socket_name: name of the connection; empty for the usual one.
        prefix: mark in front of the text.
        suffix: mark behind the text, such as a line feed.
        timeout: longest time to wait; 0 and less wait for ever.

    Returns:
        The text without its marks; empty when none came in time.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="socket", manual="5.1.9", is_simulated=False)
def socket_send_byte(value: Annotated[Any, Either(Integer(), Text())], socket_name: Str = _DEFAULT_SOCKET) -> Bool:
    """Send one byte.

    Args:
        value: a number, of which the low 8 bits are sent, or a text of at most one character.
        socket_name: name of the connection; empty for the usual one.

    Returns:
        True if it was sent.

    Raises:
        ArgumentRangeError: a longer text.
    """
    if isinstance(value, str) and len(value) > 1:
        raise ArgumentRangeError(
            f"value must be a number or one character, got {value!r}",
            argument="value",
            value=value,
            limit="at most 1 character",
        )
    raise NotSimulatedError(_NOT_YET)


@command(family="socket", manual="5.1.10", is_simulated=False)
def socket_send_int(value: Annotated[int, Integer(INT32_LOW, INT32_HIGH)], socket_name: Str = _DEFAULT_SOCKET) -> Bool:
    """Send a signed number of 32 bits in network byte order.

    Args:
        value: the number.
        socket_name: name of the connection; empty for the usual one.

    Returns:
        True if it was sent.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="socket", manual="5.1.11", is_simulated=False)
def socket_send_line(
    str: Str, linefeed_type: Annotated[int, Integer(0, 2)] = 0, socket_name: Str = _DEFAULT_SOCKET
) -> Bool:
    """Send a text and a line end.

    Args:
        str: the text, ASCII.
        linefeed_type: 0 line feed, 1 carriage return, 2 both.
        socket_name: name of the connection; empty for the usual one.

    Returns:
        True if it was sent.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="socket", manual="5.1.12", is_simulated=False)
def socket_send_string(str: Any_, socket_name: Str = _DEFAULT_SOCKET) -> Bool:
    """Send a text as it is.

    Args:
        str: the text, ASCII; other values are written as `to_str` does (*assumed*).
        socket_name: name of the connection; empty for the usual one.

    Returns:
        True if it was sent.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="socket", manual="5.1.13", is_simulated=False)
def socket_set_var(name: Str, value: Whole, socket_name: Str = _DEFAULT_SOCKET) -> None:
    """Set a variable of the server: sends `SET <name> <value>` and a line feed.

    Args:
        name: name of the variable.
        value: its new value.
        socket_name: name of the connection; empty for the usual one.
    """
    raise NotSimulatedError(_NOT_YET)
