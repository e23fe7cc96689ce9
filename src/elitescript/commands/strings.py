"""Texts (manual 2.10 chapter 6.3).

Positions and lengths count characters; only the limit of what `to_str` and `str_cat` return counts bytes (*assumed*
where the manual mixes both; they agree for ASCII).
"""

from __future__ import annotations

from collections.abc import Iterator
from math import isinf
from typing import Annotated, Any, Final

from elitescript.commands.definition.quantities import Anything, Bool, Integer, Optionally, Quantity, Str, shown
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import Result
from elitescript.errors import ArgumentRangeError, ArgumentTypeError, InvalidValueError
from elitescript.said import said

LONGEST: Final = 1023
"""Bytes in UTF-8 that `to_str` and `str_cat` can return."""

_NUMBER: Final = (
    r"([+-]?)(?:0x([0-9a-f]+)|([0-9]+)"
    r"|((?:[0-9]+\.[0-9]*|\.[0-9]+|[0-9]+(?=e))(?:e[+-]?[0-9]+)?)|inf|infinity|nan)"
)
"""Sign, hexadecimal digits, decimal digits, float; letter case does not matter."""

_Position = Annotated[int, Integer(0)]


_SCALARS: Final = (str, int, float, complex, bytes, bytearray, range, type(None))
_CONTAINERS: Final = (list, tuple, dict, set, frozenset)
BUILT_IN: Final = (*_SCALARS, *_CONTAINERS)
"""Types whose values can be written."""


class _Printable(Quantity):
    """What `to_str` can write."""

    __slots__ = ()

    def __init__(self) -> None:
        super().__init__("any built-in type")

    def coerce(self, value: Any) -> Any:
        if not isinstance(value, BUILT_IN):
            raise self.wrong_type(value, "a value of a built-in type")
        return value


@command(family="string", manual="6.3.1")
def str_at(src: Str, index: _Position) -> Str:
    """Return one character of a text.

    Args:
        src: the text.
        index: position, counted from 0.

    Returns:
        The character.

    Raises:
        InvalidValueError: `src` is empty.
        ArgumentRangeError: `index` is negative or behind the last character.
    """
    if not src:
        raise InvalidValueError("src is empty and has no characters", argument="src", value=src)
    _check_position(src, index, len(src) - 1)
    return src[index]


@command(family="string", manual="6.3.2")
def str_cat(object1: Annotated[Any, _Printable()], object2: Annotated[Any, _Printable()]) -> Str:
    """Return two values as one text, nothing between them; written as `to_str` does.

    Args:
        object1: first value.
        object2: second value.

    Returns:
        The text.

    Raises:
        InvalidValueError: the text would be longer than 1023 bytes.
    """
    return _fitting(_written(object1) + _written(object2))


@command(family="string", manual="6.3.3")
def str_empty(str: Str) -> Bool:
    """Return whether a text is empty.

    Args:
        str: the text.

    Returns:
        True if it is.
    """
    return not str


@command(family="string", manual="6.3.4")
def str_find(
    src: Str, target: Str, start_from: _Position = 0
) -> Annotated[int, Integer(-1), Result("computed", {-1: "not found"})]:
    """Return the position of the first occurrence of a text in another.

    Args:
        src: text to look in.
        target: text to look for.
        start_from: position to begin at.

    Returns:
        Position counted from 0, or -1.
    """
    return src.find(target, start_from)


@command(family="string", manual="6.3.5")
def str_len(str: Str) -> _Position:
    """Return the number of characters of a text.

    Args:
        str: the text.

    Returns:
        The number.
    """
    return len(str)


@command(family="string", manual="6.3.6")
def str_sub(src: Str, index: _Position, len: Annotated[int | None, Optionally(Integer(0), None)] = None) -> Str:
    """Return the part of a text.

    Args:
        src: the text.
        index: position of the first character; the length of the text gives an empty result.
        len: greatest number of characters; without it, and when it is too large, the part goes to the end.

    Returns:
        The part.

    Raises:
        ArgumentRangeError: `index` or `len` is negative, or `index` is behind the end.
    """
    _check_position(src, index, _length(src))
    rest = src[index:]
    return rest if len is None else rest[:len]


@command(family="string", manual="6.3.7")
def to_num(str: Str) -> Annotated[Any, Anything("int or float"), Result("computed", kinds=(int, float))]:
    """Return the number that a text shows.

    A sign may come first. Whole numbers (`40`) and hexadecimal ones (`0x1F`) give an int; a decimal point or an
    exponent (`-2.`, `.3`, `1.5E4`), `INF`, `INFINITY` and `NAN` give a float. Letter case and blanks around the
    number do not matter.

    Args:
        str: the text.

    Returns:
        The number.

    Raises:
        InvalidValueError: the text is no number, or the number is too large for a float.
    """
    import re

    match = re.fullmatch(_NUMBER, str.strip(" \t\r\n"), re.IGNORECASE | re.ASCII)
    if match is None:
        raise InvalidValueError(said("{text} is not a number", text=shown(str)), argument="str", value=str)
    sign, hexadecimal, decimal, real = match.groups()
    try:
        if hexadecimal or decimal:
            return int(sign + (hexadecimal or decimal), 16 if hexadecimal else 10)
        number = float(match.group())
    except ValueError:
        number = float("inf")
    if isinf(number) and (real or decimal):
        raise InvalidValueError(said("{text} is too large a number", text=shown(str)), argument="str", value=str)
    return number


@command(family="string", manual="6.3.8")
def to_str(val: Annotated[Any, _Printable()]) -> Str:
    """Return a value as a text.

    Floats are rounded to 6 decimals and lose their trailing zeros (1.0 gives 1), also inside lists and their like.
    These are written as Python does: texts in them stand in quotes, tuples have round brackets; sets are sorted
    (*assumed*).

    Args:
        val: the value.

    Returns:
        The text.

    Raises:
        InvalidValueError: the text would be longer than 1023 bytes.
    """
    return _fitting(_written(val))


_length = len
"""For the command whose parameter is called `len`."""


def _check_position(src: str, index: int, last: int) -> None:
    if index > last:
        limit = f"in [0, {last}]"
        raise ArgumentRangeError(
            said("index must be {limit}, got {index}; src is {src}", limit=limit, index=index, src=shown(src)),
            argument="index",
            value=index,
            limit=limit,
        )


def _written(value: Any) -> str:
    if isinstance(value, str):
        return value
    return _container_written(value) if isinstance(value, _CONTAINERS) else _scalar_written(value)


def _scalar_written(value: Any) -> str:
    if isinstance(value, float):
        text = f"{value:.6f}"
        return text.rstrip("0").rstrip(".") if "." in text else text
    if isinstance(value, int) and value.bit_length() > 4 * LONGEST:
        # Python refuses to write the longest numbers; any text that does not fit will do.
        return "9" * (LONGEST + 1)
    if not isinstance(value, _SCALARS):
        raise ArgumentTypeError(
            said(
                "what is written holds values of built-in types, not {name} {value}",
                name=type(value).__name__,
                value=shown(value),
            ),
            value=value,
        )
    return repr(value)


class _Mark(str):
    """A bracket or a separator between the elements of a container."""

    __slots__ = ()


def _container_written(container: Any) -> str:
    """Return a container as text; an endless one (a list that holds itself) is left off when it is too long anyway."""
    text = ""
    open_containers = [_pieces(container)]
    while open_containers and len(text) <= LONGEST:
        piece = next(open_containers[-1], open_containers)
        if piece is open_containers:
            open_containers.pop()
        elif isinstance(piece, _CONTAINERS):
            open_containers.append(_pieces(piece))
        else:
            text += piece if isinstance(piece, _Mark) else _scalar_written(piece)
    return text


def _pieces(container: Any) -> Iterator[Any]:
    """Yield brackets, elements and separators of a container."""
    if isinstance(container, (set, frozenset)):
        # In the order of their texts: that of a set is not the same in every run.
        elements = sorted(map(_container_written, ([element] for element in container)))
        body = "{" + ", ".join(element[1:-1] for element in elements) + "}" if elements else ""
        is_bare = bool(elements) and isinstance(container, set)
        yield _Mark(body if is_bare else f"{type(container).__name__}({body})")
        return
    is_tuple, is_dict = isinstance(container, tuple), isinstance(container, dict)
    yield _Mark("(" if is_tuple else "{" if is_dict else "[")
    for number, element in enumerate(container):
        if number:
            yield _Mark(", ")
        yield element
        if is_dict:
            yield _Mark(": ")
            yield container[element]
    if is_tuple and len(container) == 1:
        yield _Mark(",")
    yield _Mark(")" if is_tuple else "}" if is_dict else "]")


def _fitting(text: str) -> str:
    if len(text.encode("utf-8", "surrogatepass")) > LONGEST:
        raise InvalidValueError(
            said("the text would be longer than {longest} bytes", longest=LONGEST),
            value=text,
            limit=f"<= {LONGEST}",
            unit="bytes",
        )
    return text
