"""Holds the program globals of one run, and the names that statements of interpreter mode have defined."""

from __future__ import annotations

from typing import Any


class ProgramGlobals:
    """The program globals of one run.

    Args:
        values: those that exist before the program begins.

    Attributes:
        values: the dict that code runs with.
    """

    __slots__ = ("_defined", "values")

    def __init__(self, values: dict[str, Any]) -> None:
        self.values = values
        self._defined: set[str] = set()

    def has(self, name: str) -> bool:
        """Return whether the program itself has a global of that name."""
        return name in self.values and name not in self._defined

    def assign(self, name: str, value: object) -> None:
        """Assign for a statement; a name that is new exists until `forget_defined`."""
        if name not in self.values:
            self._defined.add(name)
        self.values[name] = value

    def delete(self, name: str) -> None:
        """Delete a name that a statement has defined.

        Raises:
            NameError: no statement has defined it.
        """
        if name not in self._defined:
            raise NameError(f"name {name!r} is not defined by a statement", name=name)
        self._defined.discard(name)
        del self.values[name]

    def forget_defined(self) -> None:
        """Delete every name that statements have defined."""
        for name in self._defined:
            self.values.pop(name, None)
        self._defined.clear()

    def own(self) -> dict[str, Any]:
        """Return the globals of the program itself, in the order of their first assignment."""
        return {
            name: value
            for name, value in self.values.items()
            if not name.startswith(("__", "@")) and name not in self._defined
        }
