"""Messages of the waist as JSON-able lists, and back.

Both ends know the classes, so a message is the list of its fields in their order. Where a field may hold one of
several classes its list begins with the name of the class. Only classes of `REGISTRY` are made, by their own
constructors from values whose types have been checked: nothing that arrives can name anything else. Hence one process
can read what another writes whom it does not trust.

    >>> codec = Codec()
    >>> codec.shape(Input).encode(PlayTask("dashboard#1"))
    ['PlayTask', 'dashboard#1']

Bytes are base64. Floats keep every bit but for the payload of a NaN; in JSON text infinities and NaN are the strings
`"Infinity"`, `"-Infinity"` and `"NaN"`. Halves of surrogate pairs, which are no text, become `?`.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import IntEnum
from types import NoneType, UnionType
from typing import Any, Final, TypeVar, get_args, get_origin, get_type_hints, overload

from elitescript.errors import UsageError
from elitescript.messages import machine, motion, outputs, snapshot, state, yielding
from elitescript.messages.enums import AnalogDomain
from elitescript.messages.events import Event
from elitescript.messages.inputs import Input
from elitescript.messages.line import LineSettings
from elitescript.messages.outputs import ChannelRequest
from elitescript.messages.plant import PlantConfig
from elitescript.messages.shapes import (
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
    number,
    read_text,
    shown,
    spelled_out,
    whole,
    write_text,
)
from elitescript.messages.signals import INT32_HIGH, INT32_LOW
from elitescript.messages.timing import TICK_MAX

T = TypeVar("T")

REGISTRY: Final[tuple[type, ...]] = (
    *get_args(Input),
    *get_args(Event),
    *get_args(ChannelRequest),
    *get_args(machine.MachineRequest),
    *get_args(motion.MotionRequest),
    *get_args(motion.TrackRequest),
    *get_args(yielding.YieldRequest),
    motion.MicroLine,
    LineSettings,
    outputs.Output,
    outputs.TickResult,
    outputs.Reply,
    snapshot.RobotDescription,
    snapshot.Snapshot,
    snapshot.TaskPicture,
    state.JointState,
    state.Payload,
    state.RobotState,
    PlantConfig,
)
"""Every class that may be made from what arrives."""

TEXT_MAX: Final = 32 * 1024 * 1024
"""Characters of a JSON text."""

_JSON: Final = json.JSONEncoder(allow_nan=False, check_circular=False, separators=(",", ":"))

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
    ("LineSettings", "baud"): (1, 10_000_000),
    ("LineSettings", "parity"): (0, 2),
    ("LineSettings", "stop_bits"): (1, 2),
    ("LineSettings", "size"): (5, 8),
    ("RobotDescription", "type_id"): (0, INT32_HIGH),
    ("RobotDescription", "firmware"): (0, INT32_HIGH),
    ("RobotDescription", "safety_checksum"): (0, 2**32 - 1),
}
"""Whole numbers that end in a field of a packet: their range."""

_BOUNDS_BY_NAME: Final = {"tick": (0, TICK_MAX), "line": (0, INT32_HIGH), "column": (0, INT32_HIGH)}
"""The same for fields of this name in any class."""

_WIDEST: Final = (-INT_LIMIT, INT_LIMIT - 1)
"""Range of all other whole numbers."""


class Codec:
    """Shapes of the registered classes, worked out when they are first asked for.

    Args:
        more: classes beside those of `REGISTRY`, such as a configuration.

    Raises:
        ValueError: two classes of one name.
    """

    __slots__ = ("_classes", "_shapes")

    def __init__(self, *more: type) -> None:
        self._classes = {known.__name__: known for known in (*REGISTRY, *more)}
        if len(self._classes) != len({*REGISTRY, *more}):
            raise ValueError("two classes of messages have the same name")
        self._shapes: dict[Any, Shape[Any]] = {}

    @overload
    def shape(self, kind: type[T]) -> Shape[T]: ...

    @overload
    def shape(self, kind: UnionType) -> Shape[Any]: ...

    def shape(self, kind: Any) -> Shape[Any]:
        """The shape of a registered class, or of a union of them.

        Raises:
            TypeError: there is none for that type.
        """
        return self._shape(kind, _WIDEST)

    def field_shapes(self, kind: type) -> dict[str, Shape[Any]]:
        """The shape of every field of a registered class, in the order in which they are written.

        Raises:
            TypeError: a field has a type that no message may have.
        """
        assert is_dataclass(kind)
        name = kind.__name__
        # Names that a module imports for type checkers alone are those of other registered classes.
        hints = get_type_hints(kind, localns=self._classes)
        return {
            field.name: _IMAGES.get((name, field.name)) or self._shape(hints[field.name], _bounds_of(name, field.name))
            for field in fields(kind)
            if field.init
        }

    def _shape(self, kind: Any, bounds: tuple[int, int]) -> Shape[Any]:
        known = self._shapes.get((kind, bounds))
        if known is None:
            known = self._shapes[kind, bounds] = self._made(kind, bounds)
        return known

    def _made(self, kind: Any, bounds: tuple[int, int]) -> Shape[Any]:
        if kind in SCALARS:
            return SCALARS[kind]
        if kind is int:
            return whole(*bounds)
        origin, parts = get_origin(kind), get_args(kind)
        if origin is tuple:
            return self._tuple(parts, bounds)
        if origin in (dict, Mapping):
            return self._mapping(parts, bounds)
        if origin is UnionType:
            return self._union(parts, bounds)
        if isinstance(kind, type) and issubclass(kind, IntEnum):
            return enum_shape(kind)
        if isinstance(kind, type) and self._classes.get(kind.__name__) is kind:
            return self._fields(kind)
        raise TypeError(f"{kind!r} is not registered as a message")

    def _fields(self, kind: type) -> Shape[Any]:
        """A frozen dataclass: the list of the fields that its constructor takes."""
        name = kind.__name__
        shapes_by_name = self.field_shapes(kind)
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
                # The loop costs a microsecond, naming the field on every way a dozen.
                return kind(*[read(item) for read, item in zip(decoders, data, strict=True)])
            except CodecError:
                blame(name, names, decoders, data)
                raise
            except (ValueError, TypeError, UsageError) as error:
                raise CodecError(f"{name}: {error}") from None

        return Shape(encode, decode)

    def _union(self, parts: tuple[Any, ...], bounds: tuple[int, int]) -> Shape[Any]:
        if set(parts) <= {bool, int, float}:
            return number(parts)
        if NoneType in parts:
            inner = self._shape(parts[0] if parts[1] is NoneType else parts[1], bounds)
            return Shape(
                lambda value: None if value is None else inner.encode(value),
                lambda data: None if data is None else inner.decode(data),
            )
        by_class = {part: self._shape(part, bounds) for part in parts}
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

    def _tuple(self, parts: tuple[Any, ...], bounds: tuple[int, int]) -> Shape[Any]:
        count = -1 if parts[-1] is Ellipsis else len(parts)
        kinds = set(parts) - {Ellipsis}
        if kinds == {float}:
            return floats(count)
        if len(kinds) > 1:
            shapes = [self._shape(part, bounds) for part in parts]

            def encode(value: Any) -> list[Any]:
                return [shape.encode(item) for shape, item in zip(shapes, value, strict=True)]

            def decode(data: Any) -> tuple[Any, ...]:
                check_list(data, count)
                return tuple(shape.decode(item) for shape, item in zip(shapes, data, strict=True))

            return Shape(encode, decode)
        one = self._shape(parts[0], bounds)

        def encode_all(value: Any) -> list[Any]:
            if count >= 0 and len(value) != count:
                raise TypeError(f"{count} values are expected, not {len(value)}")
            return [one.encode(item) for item in value]

        def decode_all(data: Any) -> tuple[Any, ...]:
            check_list(data, count)
            return tuple([one.decode(item) for item in data])

        return Shape(encode_all, decode_all)

    def _mapping(self, parts: tuple[Any, ...], bounds: tuple[int, int]) -> Shape[Any]:
        if parts[0] is not str:
            raise TypeError("keys of a message are texts")
        one = self._shape(parts[1], bounds)

        def encode(value: Any) -> dict[str, Any]:
            return {write_text(key): one.encode(item) for key, item in value.items()}

        def decode(data: Any) -> dict[str, Any]:
            if type(data) is not dict:
                raise CodecError(f"names with values are expected, not {shown(data)}")
            return {read_text(key): one.decode(item) for key, item in data.items()}

        return Shape(encode, decode)


def _bounds_of(kind: str, field: str) -> tuple[int, int]:
    return _BOUNDS.get((kind, field)) or _BOUNDS_BY_NAME.get(field, _WIDEST)


def to_text(data: Any) -> str:
    """Encoded data as one line of ASCII JSON."""
    try:
        return _JSON.encode(data)
    except ValueError:
        return _JSON.encode(spelled_out(data))


def from_text(text: str | bytes, limit: int = TEXT_MAX) -> Any:
    """The data of a JSON text.

    Raises:
        CodecError: longer than `limit`, or no JSON.
    """
    if len(text) > limit:
        raise CodecError(f"a message of {len(text)} characters; at most {limit} are read")
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise CodecError(f"no JSON: {str(error)[:80]}") from None
