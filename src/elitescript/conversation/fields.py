"""Readers of the fields of messages: each takes a value of JSON and its place, and returns it checked.

The place is written as a page would write it, `program.options.inputs[2].at_s`, and begins the text of every refusal.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from math import inf, isfinite
from typing import Any, Final

from elitescript.errors import UsageError, did_you_mean

Reader = Callable[[Any, str], Any]
"""Returns a value checked, or raises `MessageError` with its place."""

WHOLE_MAX: Final = 2**53 - 1
"""Largest whole number that a page can count to."""


class MessageError(UsageError):
    """A message that cannot be read; the text begins with the place."""


def whole(low: int = 0, high: int = WHOLE_MAX) -> Reader:
    """Return a reader of whole numbers."""

    def read(value: Any, place: str) -> int:
        # JSON of a page has one kind of numbers: 3.0 is 3.
        if isinstance(value, float) and value.is_integer():
            value = int(value)
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            raise MessageError(f"{place}: must be a whole number from {low} to {high}, got {_shown(value)}")
        return value

    return read


def number(low: float = -inf, high: float = inf, unit: str = "") -> Reader:
    """Return a reader of finite numbers."""
    limits = [f">= {low:g}"] * isfinite(low) + [f"<= {high:g}"] * isfinite(high)
    wanted = " ".join(("a number", " and ".join(limits), unit)).replace("  ", " ").strip()

    def read(value: Any, place: str) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise MessageError(f"{place}: must be {wanted}, got {_shown(value)}")
        if isinstance(value, int) and abs(value) > WHOLE_MAX:
            raise MessageError(f"{place}: must be {wanted}, got a number of {value.bit_length()} bits")
        if not (isfinite(value) and low <= value <= high):
            raise MessageError(f"{place}: must be {wanted}, got {value:g}")
        return float(value)

    return read


def text(characters_max: int, *, is_empty_allowed: bool = True) -> Reader:
    """Return a reader of texts."""

    def read(value: Any, place: str) -> str:
        if not isinstance(value, str):
            raise MessageError(f"{place}: must be a text, got {_shown(value)}")
        if len(value) > characters_max:
            raise MessageError(f"{place}: a text of {len(value)} characters; at most {characters_max} are taken")
        if not value and not is_empty_allowed:
            raise MessageError(f"{place}: is empty")
        return value

    return read


def choice(*values: str | int) -> Reader:
    """Return a reader of one of these values."""

    def read(value: Any, place: str) -> str | int:
        for known in values:
            if type(value) is type(known) and value == known:
                return known
        near = did_you_mean(value, [known for known in values if isinstance(known, str)]) if _is_text(value) else ""
        raise MessageError(f"{place}: must be one of {', '.join(map(str, values))}, got {_shown(value)}{near}")

    return read


def switch(value: Any, place: str) -> bool:
    """Read true or false."""
    if not isinstance(value, bool):
        raise MessageError(f"{place}: must be true or false, got {_shown(value)}")
    return value


def listed(item: Reader, items_max: int, *, items_min: int = 0) -> Reader:
    """Return a reader of lists, which gives tuples."""

    def read(value: Any, place: str) -> tuple[Any, ...]:
        if not isinstance(value, list):
            raise MessageError(f"{place}: must be a list, got {_shown(value)}")
        if not items_min <= len(value) <= items_max:
            wanted = f"{items_min}" if items_min == items_max else f"at most {items_max}"
            raise MessageError(f"{place}: a list of {len(value)} items; it has {wanted}")
        return tuple(item(part, f"{place}[{index}]") for index, part in enumerate(value))

    return read


def table(make: Callable[..., Any], fields: Mapping[str, Reader], optional: Iterable[str] = ()) -> Reader:
    """Return a reader of objects.

    Args:
        make: called with the fields that are there, by their names.
        fields: reader of each field.
        optional: fields that may be missing.
    """
    needed = [name for name in fields if name not in frozenset(optional)]

    def read(value: Any, place: str) -> Any:
        if not isinstance(value, dict):
            raise MessageError(f"{place}: must be an object, got {_shown(value)}")
        for name in value:
            if name not in fields:
                near = did_you_mean(name, list(fields))
                raise MessageError(f"{place}.{name[:40]}: there is no such field{near}")
        for name in needed:
            if name not in value:
                raise MessageError(f"{place}.{name}: is missing")
        return make(**{name: fields[name](part, f"{place}.{name}") for name, part in value.items()})

    return read


def level(value: Any, place: str) -> bool | float | str:
    """Read the level of a signal: true, false, a finite number or a text."""
    if isinstance(value, bool):
        return value
    if isinstance(value, str):
        return str(text(1000)(value, place))
    if isinstance(value, int) and abs(value) <= WHOLE_MAX:
        return value
    return float(number()(value, place))


def plain_table(value: Any, place: str) -> dict[str, Any]:
    """Read an object whose fields have a meaning elsewhere."""
    if not isinstance(value, dict):
        raise MessageError(f"{place}: must be an object, got {_shown(value)}")
    return value


def _is_text(value: Any) -> bool:
    return isinstance(value, str) and len(value) <= 40


def _shown(value: Any) -> str:
    """Return a short text for a value of JSON."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    if isinstance(value, dict | list):
        return "an object" if isinstance(value, dict) else "a list"
    if isinstance(value, int) and value.bit_length() > 200:
        return f"a number of {value.bit_length()} bits"
    words = repr(value)
    return words if len(words) <= 60 else f"{words[:57]}..."
