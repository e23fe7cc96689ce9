"""Messages of the primary port as a client reads them, without I/O.

A message is its length (u32, of the whole message), its type, and what it carries: the robot state in parts, each with
a length and type of its own, or a robot message. The tables are `protocol.primary.packets` and `.messages`. Parts and
kinds that are not in the tables, which newer firmware may send, are left out.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from typing import Final

from elitescript.errors import PeerError
from elitescript.protocol.binary import WireValue
from elitescript.protocol.primary.messages import HEAD, KINDS, ROBOT_ERROR, ROBOT_MESSAGE, TEXT_DATA, MessageKind
from elitescript.protocol.primary.packets import ROBOT_STATE, SUB_MESSAGES, SubMessage
from elitescript.records import record

MESSAGE_MAX: Final = 1 << 20
"""Bytes of a message; more is no message of a controller (*assumed*: a state has 1157)."""

_FRAME: Final = struct.Struct(">IB")
_PARTS: Final[dict[int, SubMessage]] = {part.number: part for part in SUB_MESSAGES}
_KINDS: Final[dict[int, MessageKind]] = {kind.number: kind for kind in KINDS}
_HEAD_SIZE: Final = sum(field.type.size for field in HEAD)
_ERROR_DATA: Final = {1: ">I", 2: ">i", 3: ">f", 4: ">I", 6: ">i"}
"""`struct` formats of the data of a robot error, by its data type."""
_HEXADECIMAL: Final = 4


@record
class RobotState:
    """One state message: the bytes of its parts, which are read when they are asked for."""

    parts: Mapping[int, bytes]
    """By type number, with their heads."""

    def part(self, row: SubMessage) -> dict[str, WireValue] | None:
        """Return the values of a part by field; None if the message has none, or a shorter one than the table."""
        data = self.parts.get(row.number)
        return None if data is None or len(data) < row.size else row.unpack(data)


@record
class RobotText:
    """One robot message."""

    kind: str
    """Name of a row of `protocol.primary.messages.KINDS`; `kind N` of any other."""
    source: int
    values: Mapping[str, WireValue]
    """Its fields by name."""
    texts: Mapping[str, str]
    """Its texts by name; the last is `text`."""


class MessageReader:
    """Cuts the stream of a controller into messages and decodes them, however it arrives.

    Attributes:
        count: messages that were complete, of all types.
    """

    __slots__ = ("_rest", "count")

    def __init__(self) -> None:
        self._rest = bytearray()
        self.count = 0

    def feed(self, data: bytes) -> list[RobotState | RobotText]:
        """Return the messages that are complete now; those of other types are left out.

        Raises:
            PeerError: bytes that cannot be a message; what follows cannot be read.
        """
        rest = self._rest
        rest += data
        found: list[RobotState | RobotText] = []
        at = 0
        while len(rest) - at >= _FRAME.size:
            size, kind = _FRAME.unpack_from(rest, at)
            if not _FRAME.size <= size <= MESSAGE_MAX:
                raise PeerError(
                    f"primary port: a message says that it has {size} bytes; "
                    f"one has from {_FRAME.size} to {MESSAGE_MAX}"
                )
            if len(rest) - at < size:
                break
            whole = bytes(rest[at : at + size])
            if kind == ROBOT_STATE:
                found.append(_state(whole))
            elif kind == ROBOT_MESSAGE:
                found.append(_message(whole))
            at += size
            self.count += 1
        del rest[:at]
        return found


def _state(data: bytes) -> RobotState:
    parts: dict[int, bytes] = {}
    at = _FRAME.size
    while at < len(data):
        if at + _FRAME.size > len(data):
            raise PeerError(f"primary port: a robot state ends within the head of a part, at byte {at}")
        size, number = _FRAME.unpack_from(data, at)
        if size < _FRAME.size or at + size > len(data):
            raise PeerError(f"primary port: part {number} of a robot state at byte {at} says that it has {size} bytes")
        parts[number] = data[at : at + size]
        at += size
    return RobotState(parts)


def _message(data: bytes) -> RobotText:
    if len(data) < _HEAD_SIZE:
        raise PeerError(f"primary port: a robot message has {len(data)} bytes; its head alone has {_HEAD_SIZE}")
    source, number = data[_HEAD_SIZE - 2], data[_HEAD_SIZE - 1]
    kind = _KINDS.get(number)
    if kind is None:
        return RobotText(f"kind {number}", source, {}, {"text": ""})
    try:
        values, texts = kind.unpack(data)
    except ValueError as error:
        # Most layouts are assumed, and the next message can be read: this one is no reason to hang up.
        return RobotText(kind.name, source, {}, {"text": f"(a {kind.name} message that cannot be read: {error})"})
    if kind is ROBOT_ERROR and values["data type"] != TEXT_DATA:
        texts = {"text": _error_data(values["data type"], data[kind.fields.size :])}
    return RobotText(kind.name, source, values, texts)


def _error_data(data_type: WireValue, data: bytes) -> str:
    layout = _ERROR_DATA.get(data_type) if isinstance(data_type, int) else None
    if layout is None or len(data) < struct.calcsize(layout):
        return ""
    (value,) = struct.unpack_from(layout, data)
    return f"{value:#x}" if data_type == _HEXADECIMAL else f"{value:g}" if isinstance(value, float) else str(value)
