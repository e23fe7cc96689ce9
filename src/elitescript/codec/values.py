"""Shapes of single values: texts, numbers, enumerations, signal images. `messages` composes them."""

from __future__ import annotations

from base64 import b64decode, b64encode
from collections.abc import Callable, Mapping
from enum import IntEnum
from math import isfinite
from typing import Any, Final, Generic, TypeVar

from elitescript.errors import PeerError
from elitescript.messages.signals import INT32_HIGH, INT32_LOW, SIGNALS, Signal
from elitescript.said import Said, rebuilt, template_of
from elitescript.shown import encodable

T = TypeVar("T")
Encode = Callable[[Any], Any]
Decode = Callable[[Any], Any]

INT_LIMIT: Final = 2**63
"""Whole numbers of messages are in [-INT_LIMIT, INT_LIMIT)."""
_DEPTH_MAX: Final = 8
"""Lists in lists that the details of an alarm may have."""
_SAID: Final = "said"
"""What a text that keeps its template and values begins with."""
_NON_FINITE: Final = {"NaN": float("nan"), "Infinity": float("inf"), "-Infinity": float("-inf")}
_LEVELS: Final = bytes.maketrans(b"\0\1", b"01")


class CodecError(PeerError):
    """Raised for data that is no message, with place and reason."""


class Shape(Generic[T]):
    """Encodes and decodes the values of one type.

    Attributes:
        encode: makes lists, texts and numbers of a value.
        decode: makes the value of them; raises `CodecError`.
    """

    __slots__ = ("decode", "encode")

    def __init__(self, encode: Callable[[T], Any], decode: Callable[[Any], T]) -> None:
        self.encode = encode
        self.decode = decode


def float_word(value: float) -> str:
    """Return the word for an infinity or NaN, which JSON does not have."""
    return "NaN" if value != value else "Infinity" if value > 0 else "-Infinity"


def shown(data: Any) -> str:
    """Return at most some 50 characters that name the data."""
    if isinstance(data, list | dict):
        return f"a {type(data).__name__} of {len(data)}"
    if is_large(data):
        return "a large number"
    return f"{type(data).__name__} {(data[:40] if isinstance(data, str) else data)!r}"


def is_large(data: Any) -> bool:
    """Return True for a whole number outside of 64 bits, which no message holds."""
    return type(data) is int and not -INT_LIMIT <= data < INT_LIMIT


def blame(name: str, names: list[str], decoders: list[Decode], data: list[Any]) -> None:
    """Raise `CodecError` with the name of the first field that does not decode."""
    for field, read, item in zip(names, decoders, data, strict=True):
        try:
            read(item)
        except CodecError as error:
            raise CodecError(f"{name}.{field}: {error}") from None


def check_list(data: Any, count: int) -> None:
    """Raise `CodecError` unless the data is a list of `count` items, of any length if `count` is negative."""
    if type(data) is not list or (count >= 0 and len(data) != count):
        expected = "a list" if count < 0 else f"a list of {count}"
        raise CodecError(f"{expected} is expected, not {shown(data)}")


def write_text(value: str) -> str:
    """Return a text with an escape for each half of a surrogate pair; one of `said` keeps its parts: `with_parts`."""
    text = encodable(str.__str__(value))
    return value if type(value) is Said and text == value else text


def with_parts(data: Any) -> Any:
    """Return encoded data in which each text of `said` is `["said", text, template, values]`, not the text alone.

    What is encoded has the text alone as JSON, and is read as such; this form keeps template and values too.
    """
    if type(data) is Said:
        values = {name: with_parts(value) for name, value in data.values.items()}
        return [_SAID, str(data), template_of(data), values]
    if type(data) is list:
        return [with_parts(item) for item in data]
    if type(data) is dict:
        return {key: with_parts(item) for key, item in data.items()}
    return data


def without_parts(data: Any) -> Any:
    """Return data of `with_parts` with the texts alone."""
    if type(data) is list:
        return data[1] if data[:1] == [_SAID] else [without_parts(item) for item in data]
    if type(data) is dict:
        return {key: without_parts(item) for key, item in data.items()}
    return data


def _read_said(data: list[Any], depth: int = 0) -> Said:
    if depth > _DEPTH_MAX or len(data) != 4 or type(data[3]) is not dict:
        raise CodecError("a text with template and values is expected")
    values: dict[str, str | int] = {}
    for name, value in data[3].items():
        if type(value) is list and value[:1] == [_SAID]:
            values[name] = _read_said(value, depth + 1)
        else:
            values[name] = value if type(value) is int and not is_large(value) else read_text(value)
    try:
        return rebuilt(read_text(data[1]), read_text(data[2]), values)
    except ValueError as error:
        raise CodecError(str(error)) from None


def read_text(data: Any) -> str:
    """Return a text, or raise `CodecError`."""
    if type(data) is list and data[:1] == [_SAID]:
        return _read_said(data)
    if type(data) is not str:
        raise CodecError(f"a text is expected, not {shown(data)}")
    if not data.isascii():
        try:
            data.encode()
        except UnicodeEncodeError:
            raise CodecError("half a surrogate pair in a text") from None
    return data


def _read_bool(data: Any) -> bool:
    if type(data) is not bool:
        raise CodecError(f"true or false is expected, not {shown(data)}")
    return data


def _read_float(data: Any) -> float:
    if type(data) is float:
        return data
    if type(data) is str and data in _NON_FINITE:
        return _NON_FINITE[data]
    raise CodecError(f"a float is expected, not {shown(data)}")


def _read_bytes(data: Any) -> bytes:
    if type(data) is str and data.isascii():
        try:
            return b64decode(data, validate=True)
        except ValueError:
            pass
    raise CodecError(f"base64 is expected, not {shown(data)}")


def _write_any(value: Any, depth: int = 0) -> Any:
    """Encode the details of an alarm: plain values; a list begins with its type, `list` or `tuple`."""
    if value is None or type(value) is bool:
        return value
    if isinstance(value, str):
        return write_text(value)
    if isinstance(value, int) and not is_large(int(value)):
        return int(value)
    if isinstance(value, float):
        return float(value) if isfinite(value) else ["float", float_word(value)]
    if depth < _DEPTH_MAX and type(value) in (list, tuple):
        return [type(value).__name__, *(_write_any(item, depth + 1) for item in value)]
    if depth < _DEPTH_MAX and type(value) is dict and all(isinstance(key, str) for key in value):
        return {write_text(key): _write_any(item, depth + 1) for key, item in value.items()}
    # Not its repr: that may be code of a script.
    return f"<{type(value).__name__}>"


def _read_any(data: Any, depth: int = 0) -> Any:
    if data is None or type(data) in (bool, float):
        return data
    if type(data) is str:
        return read_text(data)
    if type(data) is int and not is_large(data):
        return data
    if depth <= _DEPTH_MAX and type(data) is dict:
        return {read_text(key): _read_any(item, depth + 1) for key, item in data.items()}
    if depth <= _DEPTH_MAX and type(data) is list and data:
        if data[0] == _SAID:
            return _read_said(data)
        if data[0] == "float" and len(data) == 2:
            return _read_float(data[1])
        items = [_read_any(item, depth + 1) for item in data[1:]]
        if data[0] in ("list", "tuple"):
            return items if data[0] == "list" else tuple(items)
    raise CodecError(f"a plain value is expected, not {shown(data)}")


def whole(low: int, high: int) -> Shape[int]:
    """Return the shape of whole numbers in a range."""

    def decode(data: Any) -> int:
        if type(data) is not int:
            raise CodecError(f"a whole number is expected, not {shown(data)}")
        if not low <= data <= high:
            raise CodecError(f"a whole number in [{low}, {high}] is expected, not {shown(data)}")
        return data

    return Shape(int, decode)


def plain(parts: tuple[type, ...]) -> Shape[Any]:
    """Return the shape of numbers, or of texts and whole numbers, that keep their type."""
    allowed = frozenset(parts)

    def decode(data: Any) -> Any:
        if type(data) is str:
            return _read_float(data) if float in allowed else read_text(data) if str in allowed else refuse(data)
        return data if type(data) in allowed and not is_large(data) else refuse(data)

    def refuse(data: Any) -> Any:
        raise CodecError(f"one of {', '.join(part.__name__ for part in parts)} is expected, not {shown(data)}")

    return Shape(lambda value: write_text(value) if isinstance(value, str) else value, decode)


def enum_shape(kind: type[IntEnum]) -> Shape[Any]:
    """Return the shape of an enumeration: members as their numbers."""
    members = {int(member): member for member in kind}

    def decode(data: Any) -> Any:
        if type(data) is not int or data not in members:
            raise CodecError(f"{kind.__name__}: no such member: {shown(data)}")
        return members[data]

    return Shape(int, decode)


def domain_image(kind: type[IntEnum]) -> Shape[dict[str, tuple[Any, ...]]]:
    """Return the shape of the domains of analog signals: a member for each point of each family that has one."""
    one = enum_shape(kind)
    sizes = {row.name: row.size for row in SIGNALS.values() if row.has_domain}

    def encode(image: Mapping[str, tuple[Any, ...]]) -> dict[str, list[int]]:
        return {name: list(map(int, domains)) for name, domains in image.items()}

    def decode(data: Any) -> dict[str, tuple[Any, ...]]:
        if type(data) is not dict or data.keys() != sizes.keys():
            raise CodecError(f"domains of {', '.join(sizes)} are expected, not {shown(data)}")
        for name, size in sizes.items():
            check_list(data[name], size)
        return {name: tuple(map(one.decode, domains)) for name, domains in data.items()}

    return Shape(encode, decode)


def floats(count: int) -> Shape[tuple[float, ...]]:
    """Return the shape of `count` floats, of any number of them if `count` is negative."""
    only_floats = {float}

    def encode(value: tuple[float, ...]) -> list[float]:
        if count >= 0 and len(value) != count:
            raise TypeError(f"{count} numbers are expected, not {len(value)}")
        return list(map(float, value))

    def decode(data: Any) -> tuple[float, ...]:
        check_list(data, count)
        if set(map(type, data)) <= only_floats:
            return tuple(data)
        return tuple(map(_read_float, data))

    return Shape(encode, decode)


def _signals() -> Shape[Any]:
    """Return the shape of the signal image: a list of families in the order of their table, digital ones as 0 and 1."""
    rows = tuple(SIGNALS.values())
    writers = [(row.name, row.size, _family_writer(row)) for row in rows]
    readers = [(row.name, _family_reader(row)) for row in rows]

    def encode(image: Mapping[str, tuple[Any, ...]]) -> list[Any]:
        if len(image) != len(rows):
            raise TypeError(f"a signal image has {len(rows)} families, not {len(image)}")
        written = []
        for name, size, write in writers:
            levels = image[name]
            if len(levels) != size:
                raise TypeError(f"{name} has {size} points, not {len(levels)}")
            written.append(write(levels))
        return written

    def decode(data: Any) -> dict[str, tuple[Any, ...]]:
        check_list(data, len(rows))
        return {name: read(item) for (name, read), item in zip(readers, data, strict=True)}

    return Shape(encode, decode)


def _family_writer(row: Signal) -> Encode:
    if row.kind == "bool":
        return lambda levels: bytes(levels).translate(_LEVELS).decode()
    convert = int if row.kind == "int" else float
    return lambda levels: list(map(convert, levels))


def _family_reader(row: Signal) -> Decode:
    size, only_int = row.size, {int}
    low = INT32_LOW if row.low is None else row.low
    high = INT32_HIGH if row.high is None else row.high

    def read_levels(data: Any) -> tuple[bool, ...]:
        if type(data) is not str or len(data) != size or data.strip("01"):
            raise CodecError(f"{row.name}: {size} times 0 or 1 are expected, not {shown(data)}")
        return tuple(map("1".__eq__, data))

    def read_ints(data: Any) -> tuple[int, ...]:
        check_list(data, size)
        if set(map(type, data)) != only_int or min(data) < low or max(data) > high:
            raise CodecError(f"{row.name}: whole numbers in [{low:.0f}, {high:.0f}] are expected")
        return tuple(data)

    if row.kind == "bool":
        return read_levels
    return read_ints if row.kind == "int" else floats(size).decode


SIGNAL_IMAGE: Final = _signals()
SCALARS: Final[dict[Any, Shape[Any]]] = {
    str: Shape(write_text, read_text),
    bool: Shape(bool, _read_bool),
    float: Shape(float, _read_float),
    bytes: Shape(lambda value: b64encode(value).decode(), _read_bytes),
    Any: Shape(_write_any, _read_any),
}
