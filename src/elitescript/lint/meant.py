"""Finds which name of a program is meant by one that nothing defines."""

from __future__ import annotations

from collections.abc import Callable, Collection
from functools import cached_property
from typing import Final

from elitescript.language.advice.unknown_names import nearest

MOST_SEARCHES: Final = 20
"""Names of one program for which similar ones are searched: each search goes through all names."""


class Meant:
    """Finds similar names for the first few unknown ones of a program.

    Args:
        names: returns the names that there are; called at the first search.
    """

    __slots__ = ("__dict__", "_found", "_make")

    def __init__(self, names: Callable[[], Collection[str]]) -> None:
        self._make = names
        self._found: dict[str, str] = {}

    @cached_property
    def _names(self) -> Collection[str]:
        return self._make()

    def by(self, name: str) -> str:
        """Return the name that is meant; empty if none is like it, or if too many were searched."""
        found = self._found.get(name)
        if found is None:
            if len(self._found) >= MOST_SEARCHES:
                return ""
            found = self._found[name] = nearest(name, self._names)
        return found
