"""A table of a cell file, read key by key: every value checked, every key used, every mistake with its place."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite, sqrt
from typing import Any

from elitescript.errors import UsageError, did_you_mean


class ConfigTable:
    """One table.

    Args:
        where: its name in messages, as `[safety]`.
        table: its keys and values.

    Raises:
        UsageError: it is no table.
    """

    __slots__ = ("_asked", "_table", "where")

    def __init__(self, where: str, table: object) -> None:
        if not isinstance(table, Mapping):
            raise UsageError(f"{where} must be a table of keys, got {shown(table)}")
        self.where = where
        self._table: Mapping[str, Any] = table
        self._asked: list[str] = []

    def error(self, key: str, text: str) -> UsageError:
        """The error for a value that makes no sense."""
        return UsageError(f"{self.where} {key} {text}")

    def has(self, key: str) -> bool:
        """Whether the key is given."""
        return key in self._table

    def value(self, key: str) -> Any:
        """The value of a key, None if it is not given; it counts as used."""
        self._asked.append(key)
        return self._table.get(key)

    def text(self, key: str, default: str, choices: tuple[str, ...] = ()) -> str:
        """A text, one of `choices` if there are any."""
        value = self.value(key)
        if value is None:
            return default
        if not isinstance(value, str) or not value:
            raise self.error(key, f"must be a text, got {shown(value)}")
        if choices and value not in choices:
            raise self.error(key, f"must be one of {', '.join(map(repr, choices))}, got {value!r}")
        return value

    def number(self, key: str, unit: str, *, is_positive: bool = False) -> float | None:
        """A finite number; None if the key is not given."""
        value = self.value(key)
        return None if value is None else self._number(key, value, unit, is_positive)

    def numbers(self, key: str, count: int, unit: str, *, is_positive: bool = False) -> tuple[float, ...] | None:
        """So many numbers, or one that stands for all of them."""
        value = self.value(key)
        if value is None:
            return None
        if not isinstance(value, list):
            return (self._number(key, value, unit, is_positive),) * count
        if len(value) != count:
            raise self.error(key, f"must be {count} numbers in {unit}, got {len(value)}")
        return tuple(self._number(f"{key}[{i}]", item, unit, is_positive) for i, item in enumerate(value))

    def direction(self, key: str) -> tuple[float, float, float] | None:
        """Three numbers as a vector of length 1."""
        value = self.value(key)
        if value is None:
            return None
        if not isinstance(value, list) or len(value) != 3:
            raise self.error(key, f"must be three numbers, got {shown(value)}")
        x, y, z = (self._number(f"{key}[{i}]", item, "", False) for i, item in enumerate(value))
        length = sqrt(x * x + y * y + z * z)
        if length < 1e-9:
            raise self.error(key, "must be a direction, got a vector of length 0")
        return (x / length, y / length, z / length)

    def finish(self) -> None:
        """Refuse keys that nobody has asked for."""
        for key in self._table:
            if key not in self._asked:
                near = did_you_mean(str(key), self._asked)
                raise UsageError(f"{self.where} {key} is not known; there are {', '.join(self._asked)}{near}")

    def _number(self, key: str, value: object, unit: str, is_positive: bool) -> float:
        parts = ("a number", "> 0" if is_positive else "", f"in {unit}" if unit else "")
        wanted = " ".join(part for part in parts if part)
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise self.error(key, f"must be {wanted}, got {shown(value)}")
        if not isfinite(value) or (is_positive and not value > 0.0):
            raise self.error(key, f"must be {wanted}, got {value:g}")
        return float(value)


def shown(value: object) -> str:
    """A value of a table, short enough for a message."""
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
