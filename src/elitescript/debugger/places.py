"""Which statement a number, a line or a function means, in all texts of a run."""

from __future__ import annotations

from bisect import bisect_right
from typing import Final

from elitescript.language.compiler import CompiledUnit
from elitescript.language.probes import CountedStatement

_LOCALS: Final = ".<locals>."


class Places:
    """The statements of the texts of a run, by their numbers.

    Attributes:
        units: in the order in which they were compiled; the program is the first one.
    """

    __slots__ = ("_firsts", "units")

    def __init__(self) -> None:
        self.units: list[CompiledUnit] = []
        self._firsts: list[int] = []

    def add(self, unit: CompiledUnit) -> None:
        """Take note of a unit."""
        self.units.append(unit)
        self._firsts.append(unit.probes.first)

    def unit_of(self, number: int) -> CompiledUnit:
        """Return the unit of a statement."""
        return self.units[bisect_right(self._firsts, number) - 1]

    def statement(self, number: int) -> CountedStatement:
        """Return a statement by its number."""
        unit = self.unit_of(number)
        return unit.statements[number - unit.probes.first]

    def at_line(self, source: str, line: int) -> tuple[int, int, int, int]:
        """Return line, column and end of the statement that a line belongs to; the line alone if there is none."""
        best = None
        for unit in self.units:
            if unit.source.name == source:
                for row in unit.statements:
                    if row.line <= line <= row.end_line and (best is None or row.line >= best.line):
                        best = row if best is None or row.line > best.line else best
        return (line, 1, line, 1) if best is None else (best.line, best.column, best.end_line, best.end_column)

    def function_name(self, qualified: str) -> str:
        """Return the name of a function as users know it; that of its unit for the body."""
        outer, *inner = qualified.split(_LOCALS)
        return ".".join(inner) or outer

    def numbers_in(self, functions: set[tuple[str, str]]) -> set[int]:
        """Return the statements of functions, each given as source name and qualified name of its code."""
        wanted = {(source, self._dotted(qualified)) for source, qualified in functions}
        return {
            row.number for unit in self.units for row in unit.statements if (unit.source.name, row.function) in wanted
        }

    @staticmethod
    def _dotted(qualified: str) -> str:
        return ".".join(qualified.split(_LOCALS)[1:])
