"""Reads a table of a world file key by key: checks every value, refuses unknown keys, locates every error."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite, sqrt
from typing import Any

from elitescript.errors import UsageError, did_you_mean


class ConfigTable:
    """Reads one table.

    Args:
        name: its name, as `safety` or `safety.reduced`.
        table: its keys and values.
        number: its place in a list of tables, from 1; 0 for a table by itself.

    Raises:
        UsageError: it is no table.
    """

    __slots__ = ("_asked", "_name", "_place", "_table")

    def __init__(self, name: str, table: object, number: int = 0) -> None:
        self._name = name
        self._place = f"[[{name}]] {number}:" if number else f"[{name}]"
        if not isinstance(table, Mapping):
            raise UsageError(f"{self._place} must be a table of keys, got {_shown(table)}")
        self._table: Mapping[str, Any] = table
        self._asked: list[str] = []

    def error(self, key: str, text: str) -> UsageError:
        """Return the error for an invalid value."""
        return UsageError(f"{self._place} {key} {text}")

    def refused(self, key: str, wanted: str, value: object) -> UsageError:
        """Return the error for a value that is not as `wanted` describes."""
        return self.error(key, f"{wanted}, got {_shown(value)}")

    def value(self, key: str) -> Any:
        """Return the value of a key and mark it as used; None if it is not given."""
        self._asked.append(key)
        return self._table.get(key)

    def table(self, key: str) -> ConfigTable | None:
        """Return a table in this one; None if the key is not given."""
        value = self.value(key)
        return None if key not in self._table else ConfigTable(f"{self._name}.{key}", value)

    def tables(self, key: str) -> list[ConfigTable]:
        """Return a list of tables in this one; empty if the key is not given."""
        rows = self.value(key)
        if rows is None:
            return []
        name = f"{self._name}.{key}"
        if not isinstance(rows, list):
            raise self.error(key, f"must be a list of tables: write each under [[{name}]]")
        return [ConfigTable(name, row, number) for number, row in enumerate(rows, 1)]

    def text(self, key: str, default: str, choices: tuple[str, ...] = ()) -> str:
        """Return a text, one of `choices` if there are any."""
        value = self.value(key)
        if value is None:
            return default
        if not isinstance(value, str) or not value:
            raise self.refused(key, "must be a text", value)
        if choices and value not in choices:
            raise self.error(key, f"must be one of {', '.join(map(repr, choices))}, got {value!r}")
        return value

    def number(self, key: str, unit: str, *, is_positive: bool = False) -> float | None:
        """Return a finite number; None if the key is not given."""
        value = self.value(key)
        return None if value is None else self._number(key, value, unit, is_positive)

    def numbers(self, key: str, count: int, unit: str, *, is_positive: bool = False) -> tuple[float, ...] | None:
        """Return `count` numbers; one number stands for all of them."""
        value = self.value(key)
        if value is None:
            return None
        if not isinstance(value, list):
            return (self._number(key, value, unit, is_positive),) * count
        if len(value) != count:
            raise self.error(key, f"must be {count} numbers in {unit}, got {len(value)}")
        return tuple(self._number(f"{key}[{i}]", item, unit, is_positive) for i, item in enumerate(value))

    def direction(self, key: str) -> tuple[float, float, float] | None:
        """Return three numbers as a vector of length 1."""
        value = self.value(key)
        if value is None:
            return None
        if not isinstance(value, list) or len(value) != 3:
            raise self.refused(key, "must be three numbers", value)
        x, y, z = (self._number(f"{key}[{i}]", item, "", False) for i, item in enumerate(value))
        length = sqrt(x * x + y * y + z * z)
        if length < 1e-9:
            raise self.error(key, "must be a direction, got a vector of length 0")
        return (x / length, y / length, z / length)

    def finish(self) -> None:
        """Refuse keys that have not been read."""
        for key in self._table:
            if key not in self._asked:
                near = did_you_mean(str(key), self._asked)
                raise UsageError(f"{self._place} {key} is not known; there are {', '.join(self._asked)}{near}")

    def _number(self, key: str, value: object, unit: str, is_positive: bool) -> float:
        parts = ("a number", "> 0" if is_positive else "", f"in {unit}" if unit else "")
        wanted = " ".join(part for part in parts if part)
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise self.refused(key, f"must be {wanted}", value)
        if not isfinite(value) or (is_positive and not value > 0.0):
            raise self.error(key, f"must be {wanted}, got {value:g}")
        return float(value)


def _shown(value: object) -> str:
    """Return a value of a table as text, short enough for a message."""
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
