"""Reads TOML files of sweeps; whatever makes no sense is refused with file, line and key."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from elitescript.errors import UsageError, did_you_mean
from elitescript.untrusted.toml_lines import Path, lines_of, nearest
from elitescript.untrusted.toml_text import toml_tables

_REQUIRED: Any = object()


class TomlText:
    """One text.

    Args:
        text: TOML.
        file: its name, for messages.
        noun: what it is, for messages.

    Attributes:
        tables: what it holds.

    Raises:
        UsageError: no TOML.
    """

    __slots__ = ("_file", "_lines", "tables")

    def __init__(self, text: str, file: str, noun: str) -> None:
        self._file = file
        self.tables: dict[str, Any] = toml_tables(text, file, noun)
        self._lines = lines_of(text)

    def line(self, path: Path) -> int:
        """Return the line of a key, or of the nearest one above it."""
        return nearest(self._lines, path)

    def error(self, path: Path, text: str) -> UsageError:
        """Return the error about a key."""
        name = ""
        for part in path:
            name += f"[{part}]" if isinstance(part, int) else f".{part}" if name else part
        return UsageError(f"{self._file}:{self.line(path)}: {name + ': ' if name else ''}{text}")

    def unknown(self, path: Path, known: Collection[str], name: str = "") -> UsageError:
        """Return the error about a key, or the name that is its value, that is none of those that there are."""
        near = did_you_mean(name or str(path[-1]), known)
        return self.error(path, f"{f'{name!r} ' if name else ''}is not known; there are {', '.join(known)}{near}")

    def value(self, path: Path) -> Any:
        """Return what stands at a path; None if nothing does."""
        found: Any = self.tables
        for part in path:
            if isinstance(part, int):
                found = found[part]
            elif not isinstance(found, Mapping) or part not in found:
                return None
            else:
                found = found[part]
        return found

    def check_keys(self, path: Path, known: Collection[str]) -> None:
        """Refuse keys of a table that are none of those that there are.

        Raises:
            UsageError: there is one.
        """
        for key in self.table(path):
            if key not in known:
                raise self.unknown((*path, key), known)

    def table(self, path: Path) -> Mapping[str, Any]:
        """Return a table; an empty one if it is not there.

        Raises:
            UsageError: it is no table.
        """
        found = self.value(path)
        if found is None:
            return {}
        if not isinstance(found, Mapping):
            raise self.error(path, f"must be a table: write [{path[-1]}] on a line of its own, its keys below")
        return found

    def rows(self, name: str) -> list[Mapping[str, Any]]:
        """Return a list of tables; an empty one if it is not there.

        Raises:
            UsageError: it is no list of tables.
        """
        found = self.tables.get(name, [])
        if not isinstance(found, list) or not all(isinstance(row, Mapping) for row in found):
            raise self.error((name,), f"must be a list of tables: write [[{name}]] on a line of its own")
        return found

    def text(self, path: Path, default: str = _REQUIRED) -> str:
        """Return a text.

        Raises:
            UsageError: it is none, or missing without a default.
        """
        found = self._given(path, default)
        if not isinstance(found, str):
            raise self.error(path, f"must be a text, got {found!r:.60}")
        return found

    def number(self, path: Path, low: float, high: float, default: float = _REQUIRED) -> float:
        """Return a number from `low` to `high`.

        Raises:
            UsageError: it is none, or missing without a default.
        """
        found = self._given(path, default)
        if isinstance(found, bool) or not isinstance(found, int | float) or not low <= found <= high:
            raise self.error(path, f"must be a number in [{low:g}, {high:g}], got {found!r:.60}")
        return float(found)

    def whole(self, path: Path, low: int, high: int, default: int = _REQUIRED) -> int:
        """Return a whole number from `low` to `high`.

        Raises:
            UsageError: it is none, or missing without a default.
        """
        found = self._given(path, default)
        if isinstance(found, bool) or not isinstance(found, int) or not low <= found <= high:
            raise self.error(path, f"must be a whole number in [{low}, {high}], got {found!r:.60}")
        return found

    def _given(self, path: Path, default: Any) -> Any:
        found = self.value(path)
        if found is not None:
            return found
        if default is _REQUIRED:
            raise self.error(path, "is missing")
        return default
