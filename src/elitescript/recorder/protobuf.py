"""Rows as Protocol Buffers of one fixed size, and the descriptor that says so to other readers, without their package.

Every field of a message is always there, in the order of its numbers, and has a fixed width: so the bytes of a row are
one `struct` with the tags of the fields in it, and a row is packed and unpacked by one call each. Any decoder of
Protocol Buffers reads them by the descriptor, which MCAP keeps beside the channel.

Source: protobuf.dev, *Encoding* and `descriptor.proto`; the bytes are compared with those of the `protobuf` package.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Sequence
from operator import itemgetter
from typing import Any, Final

from elitescript.protocol.binary import Number
from elitescript.records import NamedTuple

_VARINT, _FIXED64, _LENGTH, _FIXED32 = 0, 1, 2, 5
"""Wire types."""
_SINGLE, _REPEATED = 1, 3
"""Labels of fields."""


class Scalar(NamedTuple):
    """A type of Protocol Buffers whose values have a fixed width."""

    number: int
    """`FieldDescriptorProto.Type`."""
    wire: int
    code: str
    """`struct` code."""


DOUBLE: Final = Scalar(1, _FIXED64, "d")
FLOAT: Final = Scalar(2, _FIXED32, "f")
FIXED64: Final = Scalar(6, _FIXED64, "Q")
FIXED32: Final = Scalar(7, _FIXED32, "I")
BOOL: Final = Scalar(8, _VARINT, "?")
SFIXED32: Final = Scalar(15, _FIXED32, "i")
SFIXED64: Final = Scalar(16, _FIXED64, "q")

_SCALARS: Final = {row.number: row for row in (DOUBLE, FLOAT, FIXED64, FIXED32, BOOL, SFIXED32, SFIXED64)}


class RowField(NamedTuple):
    """One field of a row."""

    name: str
    type: Scalar
    length: int = 1
    """Elements; a field with more than one is a packed list."""

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of its elements: its own, or that with `.0`, `.1` and so on."""
        if self.length == 1:
            return (self.name,)
        return tuple(f"{self.name}.{index}" for index in range(self.length))


class RowLayout:
    """How rows of some fields are bytes.

    Args:
        fields: in order; the first has the number 1.

    Attributes:
        fields: those.
        columns: names of the numbers of a row.
        size: of a row, in bytes.
    """

    __slots__ = ("_interleave", "_pack", "_tags", "columns", "fields", "size")

    def __init__(self, fields: Sequence[RowField]) -> None:
        self.fields = tuple(fields)
        self.columns = tuple(column for field in self.fields for column in field.columns)
        self._tags = tuple(_head(number, field) for number, field in enumerate(self.fields, 1))
        layout = "<"
        order: list[int] = []
        at = 0
        for place, (field, tag) in enumerate(zip(self.fields, self._tags, strict=True)):
            layout += f"{len(tag)}s{field.length}{field.type.code}"
            order += [len(self.columns) + place, *range(at, at + field.length)]
            at += field.length
        packer = struct.Struct(layout)
        self.size = packer.size
        self._pack = packer.pack
        self._interleave: Callable[[Any], tuple[Any, ...]] = itemgetter(*order)

    def pack(self, numbers: tuple[Number, ...]) -> bytes:
        """Return the bytes of a row, one number for each column.

        Raises:
            struct.error: a number does not fit its field.
        """
        return self._pack(*self._interleave(numbers + self._tags))

    def reader(self, wanted: Sequence[str]) -> struct.Struct:
        """Return what unpacks the numbers of these columns, in the order of the row, from the bytes of one."""
        chosen = frozenset(wanted)
        layout = "<"
        for field, tag in zip(self.fields, self._tags, strict=True):
            layout += f"{len(tag)}x"
            for column in field.columns:
                layout += field.type.code if column in chosen else f"{struct.calcsize('<' + field.type.code)}x"
        return struct.Struct(layout)

    def fits(self, data: bytes) -> bool:
        """Return whether these are the bytes of such a row: their number, and each tag in its place."""
        if len(data) != self.size:
            return False
        at = 0
        for field, tag in zip(self.fields, self._tags, strict=True):
            if not data.startswith(tag, at):
                return False
            at += len(tag) + field.length * struct.calcsize("<" + field.type.code)
        return True

    def descriptor(self, package: str, name: str) -> bytes:
        """Return the `FileDescriptorSet` of the message, as schemas of MCAP hold it."""
        fields = b"".join(
            _part(
                2,
                _part(1, field.name.encode())
                + _number(3, number)
                + _number(4, _SINGLE if field.length == 1 else _REPEATED)
                + _number(5, field.type.number)
                + _part(10, field.name.encode()),
            )
            for number, field in enumerate(self.fields, 1)
        )
        message = _part(1, name.encode()) + fields
        file = _part(1, f"{package}/{name}.proto".encode()) + _part(2, package.encode())
        return _part(1, file + _part(4, message) + _part(12, b"proto3"))


def layout_of(descriptor: bytes, lengths: dict[str, int]) -> RowLayout:
    """Return the layout of the rows of a channel.

    Args:
        descriptor: as `RowLayout.descriptor` makes it; of one message.
        lengths: elements of each list, which no descriptor holds.

    Raises:
        ValueError: it is another kind of message; says why.
    """
    file = _only(descriptor, 1, "a file")
    message = _only(file, 4, "a message")
    fields: list[RowField] = []
    for number, value in _parts(message):
        if number != 2:
            continue
        parts = dict(_parts(value))
        name = bytes(parts.get(1, b"")).decode()
        kind = _SCALARS.get(parts.get(5, 0))
        if kind is None:
            raise ValueError(f"the field {name!r} has no type of a fixed width")
        if parts.get(3) != len(fields) + 1:
            raise ValueError(f"the field {name!r} has the number {parts.get(3)}, not {len(fields) + 1}")
        length = lengths.get(name, 0) if parts.get(4) == _REPEATED else 1
        if not 1 <= length <= 1000:
            raise ValueError(f"the length of the list {name!r} is not known")
        fields.append(RowField(name, kind, length))
    if not fields:
        raise ValueError("a message without fields")
    return RowLayout(fields)


def _head(number: int, field: RowField) -> bytes:
    """Return the bytes in front of the numbers of a field."""
    if field.length == 1:
        return _varint(number << 3 | field.type.wire)
    size = field.length * struct.calcsize("<" + field.type.code)
    return _varint(number << 3 | _LENGTH) + _varint(size)


def _varint(value: int) -> bytes:
    found = bytearray()
    while value >= 0x80:
        found.append(value & 0x7F | 0x80)
        value >>= 7
    found.append(value)
    return bytes(found)


def _part(number: int, data: bytes) -> bytes:
    return _varint(number << 3 | _LENGTH) + _varint(len(data)) + data


def _number(number: int, value: int) -> bytes:
    return _varint(number << 3 | _VARINT) + _varint(value)


def _only(data: bytes, wanted: int, what: str) -> bytes:
    found = [value for number, value in _parts(data) if number == wanted]
    if len(found) != 1 or not isinstance(found[0], bytes):
        raise ValueError(f"the descriptor has {len(found)} times {what}, not once")
    return found[0]


def _parts(data: bytes) -> Iterator[tuple[int, Any]]:
    """Yield number and value of each field of a message: an int, or bytes."""
    at = 0
    while at < len(data):
        tag, at = _read_varint(data, at)
        if tag & 7 == _VARINT:
            value, at = _read_varint(data, at)
            yield tag >> 3, value
        elif tag & 7 == _LENGTH:
            size, at = _read_varint(data, at)
            if at + size > len(data):
                raise ValueError(f"a field of the descriptor ends {at + size - len(data)} bytes behind it")
            yield tag >> 3, data[at : at + size]
            at += size
        else:
            raise ValueError(f"the descriptor has a field of wire type {tag & 7}")


def _read_varint(data: bytes, at: int) -> tuple[int, int]:
    value = shift = 0
    while at < len(data) and shift < 64:
        byte = data[at]
        at += 1
        value |= (byte & 0x7F) << shift
        if byte < 0x80:
            return value, at
        shift += 7
    raise ValueError("the descriptor ends within a number")
