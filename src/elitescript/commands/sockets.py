"""TCP connections of a program (manual 2.10 chapter 5.1).

A connection has a name, `socket_0` unless the program gives another. What fails shows in the result, not as an alarm.
Text goes out and comes in as UTF-8, of which ASCII is a part (*assumed*).
"""

from __future__ import annotations

from typing import Annotated, Any, Final

from elitescript.commands import socket_rules as rules
from elitescript.commands.definition.context import Robot, Rule
from elitescript.commands.definition.quantities import (
    Bool,
    Either,
    Integer,
    Number,
    Quantity,
    Str,
    Text,
    TimeOut,
    Vector,
    Whole,
)
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import DONE, RECEIVED, STATE, Result
from elitescript.commands.strings import to_str
from elitescript.errors import ArgumentRangeError
from elitescript.messages.signals import INT32_HIGH, INT32_LOW
from elitescript.said import said

_DEFAULT_SOCKET: Final = "socket_0"
_LINE_ENDS: Final = ("\n", "\r", "\r\n")
_ANSWER_S: Final = 2.0
"""Timeout of `socket_get_var`."""
_ARGUMENTS: Final = {
    "socket_name": "name of the connection; empty for the usual one.",
    "timeout": "longest time to wait; 0 and less wait for ever.",
}
"""Texts of arguments that several commands share."""


class _Writable(Quantity):
    """What `socket_send_string` can send: a text, or what `to_str` writes as the peer would read it."""

    __slots__ = ()

    def __init__(self) -> None:
        super().__init__("str, number or list")

    def coerce(self, value: Any) -> Any:
        if not isinstance(value, (str, int, float, list)):
            error = self.wrong_type(value, "a text, a number or a list")
            if isinstance(value, (bytes, bytearray)):
                error.hint = "socket_send_byte_list sends bytes, as a list of numbers: list(value)"
            raise error
        return value


_Sent = Annotated[Any, _Writable()]
_NumberCount = Annotated[int, Integer(1, 30)]
_Ints = Annotated[tuple[int, ...], Vector(Integer(INT32_LOW, INT32_HIGH), None)]
_Bytes = Annotated[tuple[int, ...], Vector(Integer(-1, 255), None)]


@command(family="socket", manual="5.1.1", waits=True, arguments=_ARGUMENTS)
def socket_open(
    robot: Robot, address: Str, port: Annotated[int, Integer(0, 65535)], socket_name: Str = _DEFAULT_SOCKET
) -> Annotated[Bool, DONE]:
    """Connect to a TCP server, within 2 s.

    A connection of that name that still stands is kept; one that does not is opened anew.

    Args:
        address: address of the server.
        port: port of the server.

    Returns:
        True if the connection stands.
    """
    return robot.sockets.open(address, port, socket_name or _DEFAULT_SOCKET)


@command(family="socket", manual="5.1.2", arguments=_ARGUMENTS)
def socket_close(robot: Robot, socket_name: Str = _DEFAULT_SOCKET) -> None:
    """Close a connection; one that is unknown or closed does no harm (*assumed*)."""
    robot.sockets.close(socket_name or _DEFAULT_SOCKET)


@command(family="socket", since="2.14", manual="2.14: 7.1.3", arguments=_ARGUMENTS)
def socket_is_connected(robot: Robot, socket_name: Str = _DEFAULT_SOCKET) -> Annotated[Bool, DONE]:
    """Return whether a connection stands.

    Returns:
        True if it does.
    """
    return robot.sockets.is_connected(socket_name or _DEFAULT_SOCKET)


@command(family="socket", manual="5.1.3", waits=True, arguments=_ARGUMENTS)
def socket_get_var(
    robot: Robot, var_name: Str, socket_name: Str = _DEFAULT_SOCKET
) -> Annotated[int, Integer(INT32_LOW, INT32_HIGH), Result("channel", {0: "also after a failure"})]:
    """Ask the server for a variable: sends `GET <name>` and a line feed, waits 2 s for `<name> <int>`.

    Lines of another form are passed over (*assumed*).

    Args:
        var_name: name of the variable.

    Returns:
        The value, brought into 32 bits; 0 also after a failure.
    """
    question = f"GET {var_name}\n".encode("utf-8", "replace")
    return robot.sockets.ask(socket_name or _DEFAULT_SOCKET, question, rules.Variable(var_name), _ANSWER_S)


@command(family="socket", manual="5.1.4", waits=True, arguments=_ARGUMENTS)
def socket_read_ascii_float(
    robot: Robot, number: _NumberCount, socket_name: Str = _DEFAULT_SOCKET, timeout: TimeOut = 2
) -> Annotated[tuple[float, ...], Vector(Number(allows_non_finite=True), None), Result("channel", counted_by="number")]:
    """Read numbers that are sent as text, such as `(3.14, 2.5)`; commas and blanks separate, empty fields are skipped.

    What follows the parenthesis stays for the next call, the line end of the sender too: another call of this command
    skips it, a reading of text begins with it, which is a warning. `socket_read_string(suffix="\\n")` reads it away.

    Args:
        number: how many numbers.

    Returns:
        How many arrived, then `number` values; those that are missing are nan.
    """
    values = _read(robot, rules.Floats(number), socket_name, timeout)
    if len(values) < number:
        robot.note_missing("socket_read_ascii_float", len(values), number)
    return _counted(values, number, float("nan"))


@command(family="socket", manual="5.1.5", waits=True, arguments=_ARGUMENTS)
def socket_read_binary_integer(
    robot: Robot, number: _NumberCount, socket_name: Str = _DEFAULT_SOCKET, timeout: TimeOut = 2
) -> Annotated[_Ints, Result("channel", counted_by="number")]:
    """Read signed numbers of 32 bits in network byte order.

    Args:
        number: how many numbers.

    Returns:
        How many arrived, then `number` values; those that are missing are -1.
    """
    return _counted(_read(robot, rules.integers(number), socket_name, timeout), number, -1)


@command(family="socket", manual="5.1.6", waits=True, arguments=_ARGUMENTS)
def socket_read_byte_list(
    robot: Robot, number: Annotated[int, Integer(1, 512)], socket_name: Str = _DEFAULT_SOCKET, timeout: TimeOut = 2
) -> Annotated[_Bytes, Result("channel", counted_by="number")]:
    """Read bytes.

    Args:
        number: how many bytes.

    Returns:
        How many arrived, then `number` values; those that are missing are -1.
    """
    return _counted(_read(robot, rules.octets(number), socket_name, timeout), number, -1)


@command(family="socket", manual="5.1.7", arguments=_ARGUMENTS)
def socket_send_byte_list(
    robot: Robot, value: Annotated[tuple[int, ...], Vector(Integer(0, 255), None)], socket_name: Str = _DEFAULT_SOCKET
) -> Annotated[int, Integer(unit="byte"), STATE]:
    """Send bytes.

    Args:
        value: the bytes.

    Returns:
        How many were sent.
    """
    return len(value) if robot.sockets.send(socket_name or _DEFAULT_SOCKET, bytes(value)) else 0


@command(family="socket", manual="5.1.8", waits=True, arguments=_ARGUMENTS)
def socket_read_string(
    robot: Robot, socket_name: Str = _DEFAULT_SOCKET, prefix: Str = "", suffix: Str = "", timeout: TimeOut = 2
) -> Annotated[Str, RECEIVED]:
    """Read text, if wanted between two marks; at most 2047 bytes. What is not used up stays for the next call.

    Args:
        prefix: mark in front of the text.
        suffix: mark behind the text, such as a line feed.

    Returns:
        The text without its marks; empty when none came in time.
    """
    return str(_read(robot, rules.Texts(_mark(prefix, "prefix"), _mark(suffix, "suffix")), socket_name, timeout))


@command(family="socket", manual="5.1.9", arguments=_ARGUMENTS)
def socket_send_byte(
    robot: Robot, value: Annotated[Any, Either(Integer(), Text())], socket_name: Str = _DEFAULT_SOCKET
) -> Annotated[Bool, DONE]:
    """Send one byte.

    Args:
        value: a number, of which the low 8 bits are sent, or a text of at most one character.

    Returns:
        True if it was sent.

    Raises:
        ArgumentRangeError: a longer text.
    """
    if isinstance(value, str) and len(value) > 1:
        raise ArgumentRangeError(
            said("value must be a number or one character, got {value!r}", value=value),
            argument="value",
            value=value,
            limit="at most 1 character",
        )
    codes = [ord(letter) for letter in value] if isinstance(value, str) else [value]
    return robot.sockets.send(socket_name or _DEFAULT_SOCKET, bytes(code & 0xFF for code in codes))


@command(family="socket", manual="5.1.10", arguments=_ARGUMENTS)
def socket_send_int(
    robot: Robot, value: Annotated[int, Integer(INT32_LOW, INT32_HIGH)], socket_name: Str = _DEFAULT_SOCKET
) -> Annotated[Bool, DONE]:
    """Send a signed number of 32 bits in network byte order.

    Args:
        value: the number.

    Returns:
        True if it was sent.
    """
    return robot.sockets.send(socket_name or _DEFAULT_SOCKET, value.to_bytes(4, "big", signed=True))


@command(family="socket", manual="5.1.11", arguments=_ARGUMENTS)
def socket_send_line(
    robot: Robot, str: Str, linefeed_type: Annotated[int, Integer(0, 2)] = 0, socket_name: Str = _DEFAULT_SOCKET
) -> Annotated[Bool, DONE]:
    """Send a text and a line end.

    Args:
        str: the text, ASCII.
        linefeed_type: 0 line feed, 1 carriage return, 2 both.

    Returns:
        True if it was sent.
    """
    return _send(robot, str + _LINE_ENDS[linefeed_type], socket_name)


@command(family="socket", manual="5.1.12", arguments=_ARGUMENTS)
def socket_send_string(robot: Robot, str: _Sent, socket_name: Str = _DEFAULT_SOCKET) -> Annotated[Bool, DONE]:
    """Send a text as it is.

    Args:
        str: the text, ASCII; numbers, truth values and lists are written as `to_str` does (*assumed*). Bytes, None,
            tuples and dicts are refused: they would go out as Python spells them.

    Returns:
        True if it was sent.
    """
    return _send(robot, _written(str), socket_name)


@command(family="socket", manual="5.1.13", arguments=_ARGUMENTS)
def socket_set_var(robot: Robot, name: Str, value: Whole, socket_name: Str = _DEFAULT_SOCKET) -> None:
    """Set a variable of the server: sends `SET <name> <value>` and a line feed.

    Args:
        name: name of the variable.
        value: its new value.
    """
    _send(robot, f"SET {name} {value}\n", socket_name)


def _read(robot: Robot, rule: Rule, socket_name: str, timeout_s: float) -> Any:
    return robot.sockets.read(socket_name or _DEFAULT_SOCKET, rule, timeout_s)


def _send(robot: Robot, words: str, socket_name: str) -> bool:
    return robot.sockets.send(socket_name or _DEFAULT_SOCKET, words.encode("utf-8", "replace"), is_text=True)


def _counted(values: list[Any], number: int, missing: Any) -> tuple[Any, ...]:
    """Return the number of values, the values, and what stands for those that are missing."""
    return (len(values), *values, *[missing] * (number - len(values)))


def _mark(words: str, argument: str) -> bytes:
    """Return a mark as it is sent.

    Raises:
        ArgumentRangeError: it is longer than what can be read at once.
    """
    mark = words.encode("utf-8", "replace")
    if len(mark) > rules.TEXT_MAX:
        limit = f"at most {rules.TEXT_MAX} bytes"
        text = said("{argument} must have {limit}, got {count}", argument=argument, limit=limit, count=len(mark))
        raise ArgumentRangeError(text, argument=argument, value=words, limit=limit, unit="byte")
    return mark


def _written(value: Any) -> str:
    """Return a value as it is sent."""
    return value if isinstance(value, str) else to_str(value)
