"""Encodes messages of the waist as lists that JSON can hold, and decodes them.

Both ends have the classes, so a message is the list of its fields in their order. A field that may hold one of several
classes is a list that begins with the name of the class. Decoding makes the classes that the fields of the expected
message may hold and no others, by their constructors, from values whose types, lengths and ranges it has checked. So
the sender need not be trusted.

    >>> shape_of(Input).encode(PlayTask("dashboard#1"))
    ['PlayTask', 'dashboard#1']

Bytes are base64. Floats keep every bit but for the payload of a NaN; in JSON text infinities and NaN are the strings
`"Infinity"`, `"-Infinity"` and `"NaN"`. Halves of surrogate pairs, which are no text, become escapes.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import IntEnum
from functools import cache
from types import MappingProxyType, NoneType, UnionType
from typing import Any, Final, TypeVar, get_args, get_origin, get_type_hints, overload

from elitescript.codec.values import (
    INT_LIMIT,
    SCALARS,
    SIGNAL_IMAGE,
    CodecError,
    Shape,
    blame,
    check_list,
    domain_image,
    enum_shape,
    floats,
    plain,
    read_text,
    shown,
    whole,
    write_text,
)
from elitescript.errors import UsageError
from elitescript.messages.enums import AnalogDomain
from elitescript.messages.signals import INT32_HIGH, INT32_LOW
from elitescript.messages.timing import TICK_MAX
from elitescript.records import fields_of, is_record

T = TypeVar("T")

_IMAGES: Final[dict[tuple[str, str], Shape[Any]]] = {
    ("Snapshot", "signals"): SIGNAL_IMAGE,
    ("Snapshot", "domains"): domain_image(AnalogDomain),
}
"""Fields that hold all points of a table, no more and no less."""

_BOUNDS: Final[dict[tuple[str, str], tuple[int, int]]] = {
    ("Snapshot", "tool_analog_mode"): (0, 255),
    ("Snapshot", "tool_pin_modes"): (0, 255),
    ("RobotState", "line"): (0, INT32_HIGH),
    ("RobotState", "node"): (INT32_LOW, INT32_HIGH),
    ("LineMarked", "number"): (INT32_LOW, INT32_HIGH),
    ("OpenChannel", "port"): (0, 65535),
    ("ChannelFault", "place"): (0, 65535),
    ("ChannelFault", "chunk"): (1, 65536),
    ("LineSettings", "baud"): (1, 10_000_000),
    ("LineSettings", "parity"): (0, 2),
    ("LineSettings", "stop_bits"): (1, 2),
    ("LineSettings", "size"): (5, 8),
    ("RegistersRead", "values"): (0, 2**16 - 1),
    ("RobotDescription", "type_id"): (0, INT32_HIGH),
    ("RobotDescription", "firmware"): (0, INT32_HIGH),
    ("RobotDescription", "safety_checksum"): (0, 2**32 - 1),
}
"""Whole numbers that end in a field of a packet: their range."""

_BOUNDS_BY_NAME: Final = {"tick": (0, TICK_MAX), "line": (0, INT32_HIGH), "column": (0, INT32_HIGH)}
"""The same for fields of this name in any class."""

_WIDEST: Final = (-INT_LIMIT, INT_LIMIT - 1)
"""Range of all other whole numbers."""


@overload
def shape_of(kind: type[T]) -> Shape[T]: ...


@overload
def shape_of(kind: UnionType) -> Shape[Any]: ...


def shape_of(kind: Any) -> Shape[Any]:
    """Return the shape of a message: a record, or a union of such classes.

    Raises:
        TypeError: it is none, or one of its fields has a type that no message may have.
    """
    return _shape(kind, _WIDEST)


def field_shapes(kind: type, names: Mapping[str, type] = MappingProxyType({})) -> dict[str, Shape[Any]]:
    """Return the shape of every field of a message that is written, in their order; see `outputs.NOT_WRITTEN`.

    Args:
        kind: a record.
        names: classes that its module imports for type checkers alone.

    Raises:
        TypeError: a field has a type that no message may have.
    """
    name, hints = kind.__name__, get_type_hints(kind, localns=dict(names))
    return {
        field: _IMAGES.get((name, field)) or _shape(hints[field], _bounds_of(name, field))
        for field, about in fields_of(kind).items()
        if about.init and about.metadata.get("is_written", True)
    }


@cache
def _shape(kind: Any, bounds: tuple[int, int]) -> Shape[Any]:
    if kind in SCALARS:
        return SCALARS[kind]
    if kind is int:
        return whole(*bounds)
    origin, parts = get_origin(kind), get_args(kind)
    if origin is tuple:
        return _tuple(parts, bounds)
    if origin in (dict, Mapping):
        return _mapping(parts, bounds)
    if origin is UnionType:
        return _union(parts, bounds)
    if isinstance(kind, type) and issubclass(kind, IntEnum):
        return enum_shape(kind)
    if is_record(kind):
        return _fields(kind)
    raise TypeError(f"{kind!r} is no message")


def _fields(kind: type) -> Shape[Any]:
    """Return the shape of a record: the list of the fields that its constructor takes."""
    name = kind.__name__
    shapes_by_name = field_shapes(kind)
    names, shapes = list(shapes_by_name), list(shapes_by_name.values())
    encoders = [(field, shape.encode) for field, shape in zip(names, shapes, strict=True)]
    decoders = [shape.decode for shape in shapes]
    count = len(names)

    def encode(value: Any) -> list[Any]:
        if type(value) is not kind:
            raise TypeError(f"a {name} is expected, not a {type(value).__name__}")
        return [write(getattr(value, field)) for field, write in encoders]

    def decode(data: Any) -> Any:
        if type(data) is not list or len(data) != count:
            raise CodecError(f"{name}: {count} fields are expected, not {shown(data)}")
        try:
            # A failed loop is repeated to name the field; naming it at each step would make every message slower.
            return kind(*[read(item) for read, item in zip(decoders, data, strict=True)])
        except CodecError:
            blame(name, names, decoders, data)
            raise
        except (ValueError, TypeError, UsageError) as error:
            raise CodecError(f"{name}: {error}") from None

    return Shape(encode, decode)


def _union(parts: tuple[Any, ...], bounds: tuple[int, int]) -> Shape[Any]:
    if NoneType in parts:
        rest = tuple(part for part in parts if part is not NoneType)
        inner = _shape(rest[0], bounds) if len(rest) == 1 else _union(rest, bounds)
        return Shape(
            lambda value: None if value is None else inner.encode(value),
            lambda data: None if data is None else inner.decode(data),
        )
    if set(parts) <= {bool, int, float, str}:
        return plain(parts)
    by_class = {part: _shape(part, bounds) for part in parts}
    by_name = {part.__name__: shape for part, shape in by_class.items()}

    def encode(value: Any) -> list[Any]:
        kind = type(value)
        if kind not in by_class:
            raise TypeError(f"one of {', '.join(by_name)} is expected, not a {kind.__name__}")
        return [kind.__name__, *by_class[kind].encode(value)]

    def decode(data: Any) -> Any:
        if type(data) is not list or not data or type(data[0]) is not str:
            raise CodecError(f"one of {', '.join(by_name)} is expected, not {shown(data)}")
        if data[0] not in by_name:
            raise CodecError(f"one of {', '.join(by_name)} is expected, not {data[0][:40]!r}")
        return by_name[data[0]].decode(data[1:])

    return Shape(encode, decode)


def _tuple(parts: tuple[Any, ...], bounds: tuple[int, int]) -> Shape[Any]:
    count = -1 if parts[-1] is Ellipsis else len(parts)
    kinds = set(parts) - {Ellipsis}
    if kinds == {float}:
        return floats(count)
    if len(kinds) > 1:
        shapes = [_shape(part, bounds) for part in parts]

        def encode(value: Any) -> list[Any]:
            return [shape.encode(item) for shape, item in zip(shapes, value, strict=True)]

        def decode(data: Any) -> tuple[Any, ...]:
            check_list(data, count)
            return tuple(shape.decode(item) for shape, item in zip(shapes, data, strict=True))

        return Shape(encode, decode)
    one = _shape(parts[0], bounds)

    def encode_all(value: Any) -> list[Any]:
        if count >= 0 and len(value) != count:
            raise TypeError(f"{count} values are expected, not {len(value)}")
        return [one.encode(item) for item in value]

    def decode_all(data: Any) -> tuple[Any, ...]:
        check_list(data, count)
        return tuple([one.decode(item) for item in data])

    return Shape(encode_all, decode_all)


def _mapping(parts: tuple[Any, ...], bounds: tuple[int, int]) -> Shape[Any]:
    if parts[0] is not str:
        raise TypeError("keys of a message are texts")
    one = _shape(parts[1], bounds)

    def encode(value: Any) -> dict[str, Any]:
        return {write_text(key): one.encode(item) for key, item in value.items()}

    def decode(data: Any) -> dict[str, Any]:
        if type(data) is not dict:
            raise CodecError(f"names with values are expected, not {shown(data)}")
        return {read_text(key): one.decode(item) for key, item in data.items()}

    return Shape(encode, decode)


def _bounds_of(kind: str, field: str) -> tuple[int, int]:
    return _BOUNDS.get((kind, field)) or _BOUNDS_BY_NAME.get(field, _WIDEST)
