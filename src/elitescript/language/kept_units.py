"""Keeps what was made of a text, for the next time that the same text is used: loops over runs, tests, the studio."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Final, Generic, TypeVar

Unit = TypeVar("Unit")

UNITS_MAX: Final = 64
CHARACTERS_MAX: Final = 250_000
"""Characters of all kept texts; their code takes some hundred bytes for each."""


class KeptUnits(Generic[Unit]):
    """Units by what they were made of; those that were used last, within two bounds.

    Args:
        units_max: most units.
        characters_max: most characters of their texts; a longer text is not kept at all.

    Threads may share one: each step leaves a dict that is whole.
    """

    __slots__ = ("_characters_max", "_units", "_units_max")

    def __init__(self, units_max: int = UNITS_MAX, characters_max: int = CHARACTERS_MAX) -> None:
        self._units_max = units_max
        self._characters_max = characters_max
        self._units: dict[Hashable, tuple[Unit, int]] = {}

    def __len__(self) -> int:
        return len(self._units)

    @property
    def characters(self) -> int:
        """Characters of all kept texts."""
        return sum(size for _, size in list(self._units.values()))

    def get(self, key: Hashable) -> Unit | None:
        """Return a unit; None if it is not kept."""
        entry = self._units.pop(key, None)
        if entry is None:
            return None
        # The last one of a dict is the newest.
        self._units[key] = entry
        return entry[0]

    def put(self, key: Hashable, unit: Unit, size: int) -> None:
        """Keep a unit, and let go of those that were used longest ago.

        Args:
            key: what it was made of.
            unit: the unit.
            size: characters of its text.
        """
        if size > self._characters_max:
            return
        self._units.pop(key, None)
        self._units[key] = unit, size
        while len(self._units) > self._units_max or self.characters > self._characters_max:
            self._units.pop(next(iter(self._units), None), None)
