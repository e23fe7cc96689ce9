"""Rows of the tables that benchmarks print: times with CPU beside wall, other figures, what stands beside them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

SCALES = {"s": 1.0, "ms": 1e3, "us": 1e6}
"""How many of a unit of time are in a second."""
HEAD = ("what", "CPU", "wall", "figure", "for comparison", "ratio")


class Time(NamedTuple):
    """A measured time: wall, and CPU of all that was measured."""

    wall_s: float
    cpu_s: float


@dataclass(frozen=True, slots=True)
class Row:
    """One row: a time or another figure, and what a user would otherwise have.

    Times are in seconds, and shown in `unit` (us, ms or s). A figure that is no time is `value`, its `unit` any word.
    `other` is the CPU time (s) or the value of `beside`; `simulated_s` is the robot time that passed meanwhile.
    """

    what: str
    unit: str = ""
    cpu_s: float | None = None
    wall_s: float | None = None
    value: float | None = None
    words: str = ""
    other: float | None = None
    beside: str = ""
    simulated_s: float | None = None

    @property
    def ratio(self) -> str:
        """Return ours through the other's, of CPU times where there are such; of a simulation, how often real time."""
        if self.simulated_s is not None and self.wall_s:
            return f"{self.simulated_s / self.wall_s:.0f} x real time"
        ours = self.value if self.cpu_s is None else self.cpu_s
        return "" if ours is None or not self.other else f"{ours / self.other:.2g}"

    @property
    def cells(self) -> tuple[str, ...]:
        """Return the texts of the columns of `HEAD`."""
        figure = ", ".join(filter(None, ["" if self.value is None else self.shown(self.value), self.words]))
        other = self.beside
        if self.other is not None:
            other = f"{self.shown(self.other)} ({self.beside})"
        elif self.simulated_s is not None:
            other = f"{self.simulated_s:.4g} s (the robot)"
        return self.what, self.shown(self.cpu_s), self.shown(self.wall_s), figure, other, self.ratio

    def shown(self, figure: float | None) -> str:
        """Return a time (s) or value in the unit of this row, with three digits that count."""
        if figure is None:
            return ""
        scaled = figure if self.value is not None else figure * SCALES[self.unit]
        places = next((places for places, bound in enumerate((100, 10, 1)) if abs(scaled) >= bound), 3)
        return f"{scaled:.{places}f} {self.unit}".rstrip()


def timed_row(what: str, time: Time, unit: str = "ms", **more: Any) -> Row:
    """Return the row of a time; `more` are other fields of the row."""
    return Row(what, unit, time.cpu_s, time.wall_s, **more)


def words(what: str, ours: str, other: str = "", ratio: str = "") -> Row:
    """Return a row of texts, for what has no figure; `-` is the same as nothing."""
    said = [text for text in (ours, ratio) if text.strip("-")]
    return Row(what, words=", ".join(said), beside=other.strip("-"))


def not_installed(name: str) -> Row:
    """Return the row for what could be compared if `make peers` had installed it."""
    return Row(f"compared with {name}", beside=f"{name} is not installed")


def as_data(row: Row) -> dict[str, Any]:
    """Return the row as JSON has it; `Row(**data)` is the way back."""
    return asdict(row)


def print_table(head: tuple[str, ...], lines: Iterable[tuple[str, ...]]) -> None:
    """Print columns as wide as their longest cell, and a rule below the head."""
    lines = list(lines)
    widths = [max(map(len, column)) for column in zip(head, *lines, strict=True)]
    for line in (head, tuple("-" * width for width in widths), *lines):
        print("  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip())


def print_rows(rows: Iterable[Row]) -> None:
    """Print the table of these rows."""
    print_table(HEAD, (row.cells for row in rows))
