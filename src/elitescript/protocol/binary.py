"""Big-endian packing from tables of fields, for the binary ports.

A field has a name and a `WireType`; a `FieldList` is a table of fields with its compiled layout. Values go in and come
out one per field: a number for a scalar type, a sequence of numbers for a vector.

    >>> head = FieldList(Field("size", UINT32), Field("kind", UINT8))
    >>> head.pack([5, 16]).hex()
    '0000000510'

Evidence: byte order, names and sizes are what the vendor's client parses; INT8, INT16, INT64 and FLOAT occur on the
primary port only or not at all.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Sequence
from itertools import compress
from typing import Final

from elitescript.records import NamedTuple

Number = bool | int | float
WireValue = Number | tuple[Number, ...]
"""A number, or the numbers of a vector."""


class WireType(NamedTuple):
    """Encoding of a value."""

    name: str
    code: str
    """`struct` code of one element."""
    length: int = 1
    """Elements; a vector has more than one."""

    @property
    def layout(self) -> str:
        """`struct` format without the byte order."""
        return self.code * self.length

    @property
    def size(self) -> int:
        """Size in bytes."""
        return struct.calcsize(">" + self.layout)

    @property
    def is_vector(self) -> bool:
        """Whether a value is a sequence of numbers."""
        return self.length > 1


BOOL: Final = WireType("BOOL", "?")
INT8: Final = WireType("INT8", "b")
INT16: Final = WireType("INT16", "h")
INT32: Final = WireType("INT32", "i")
INT64: Final = WireType("INT64", "q")
UINT8: Final = WireType("UINT8", "B")
UINT16: Final = WireType("UINT16", "H")
UINT32: Final = WireType("UINT32", "I")
UINT64: Final = WireType("UINT64", "Q")
FLOAT: Final = WireType("FLOAT", "f")
DOUBLE: Final = WireType("DOUBLE", "d")
VECTOR3D: Final = WireType("VECTOR3D", "d", 3)
VECTOR6D: Final = WireType("VECTOR6D", "d", 6)
VECTOR6INT32: Final = WireType("VECTOR6INT32", "i", 6)
VECTOR6UINT32: Final = WireType("VECTOR6UINT32", "I", 6)


class Field(NamedTuple):
    """One row of a message's table."""

    name: str
    type: WireType
    unit: str = ""
    evidence: str = ""
    summary: str = ""


class FieldList:
    """Consecutive fields, without gaps, in the order of the wire."""

    __slots__ = ("_plan", "_struct", "fields", "size")

    def __init__(self, *fields: Field) -> None:
        self.fields = fields
        self._struct = struct.Struct(">" + "".join(field.type.layout for field in fields))
        self.size = self._struct.size
        """Size of all fields in bytes."""
        self._plan = tuple(field.type.length for field in fields)

    def pack(self, values: Sequence[Number | Sequence[Number]]) -> bytes:
        """Return the bytes of one value for each field.

        Raises:
            ValueError: a value does not fit its type, or there are too many or too few; names the field.
        """
        if len(values) != len(self.fields):
            raise ValueError(f"{len(self.fields)} fields need as many values, not {len(values)}")
        try:
            return self._struct.pack(*_flattened(values))
        except (struct.error, TypeError, OverflowError):
            self._raise_unfit(values)
            raise

    def unpack(self, data: bytes | memoryview, offset: int = 0) -> tuple[WireValue, ...]:
        """Return one value for each field; vectors as tuples.

        Raises:
            ValueError: fewer bytes than the fields need.
        """
        if len(data) - offset < self.size:
            raise ValueError(f"the fields need {self.size} bytes, there are {max(len(data) - offset, 0)}")
        flat: tuple[Number, ...] = self._struct.unpack_from(data, offset)
        if len(flat) == len(self._plan):
            return flat
        values: list[WireValue] = []
        at = 0
        for count in self._plan:
            values.append(flat[at] if count == 1 else flat[at : at + count])
            at += count
        return tuple(values)

    def offsets(self) -> tuple[int, ...]:
        """Return the offset of each field, in bytes."""
        begins: list[int] = []
        at = 0
        for field in self.fields:
            begins.append(at)
            at += field.type.size
        return tuple(begins)

    def _raise_unfit(self, values: Sequence[Number | Sequence[Number]]) -> None:
        """Raise with the name of the first field whose value does not fit."""
        for field, value in zip(self.fields, values, strict=True):
            parts = (value,) if isinstance(value, int | float) else value
            try:
                struct.pack(">" + field.type.layout, *parts)
            except (struct.error, TypeError, OverflowError) as error:
                raise ValueError(f"{field.name}: {value!r} is no {field.type.name} ({error})") from None


def _flattened(values: Iterable[Number | Sequence[Number]]) -> list[Number]:
    flat: list[Number] = []
    for value in values:
        if isinstance(value, int | float):
            flat.append(value)
        else:
            flat.extend(value)
    return flat


_POWERS: Final = tuple(1 << bit for bit in range(64))


def packed_bits(levels: Sequence[Number]) -> int:
    """Return the word whose bit i is `levels[i]`; 64 bits at most."""
    if len(levels) > len(_POWERS):
        raise ValueError(f"a word has {len(_POWERS)} bits, not {len(levels)}")
    return sum(compress(_POWERS, levels))
