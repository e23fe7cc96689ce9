"""Finds the lines of a text that are as they were in an earlier version."""

from __future__ import annotations

from collections.abc import Sequence

from elitescript.records import NamedTuple


class SameLines(NamedTuple):
    """Which lines of a text are those of an earlier version.

    Attributes:
        before: lines up to this one did not change.
        behind: lines from the one behind this one on did not change.
        shift: what to add to the number of a line behind, to get that of the earlier version.
    """

    before: int
    behind: int
    shift: int

    def earlier(self, line: int) -> int:
        """Return the number that a line had in the earlier version; 0 if it has changed since."""
        if line <= self.before:
            return line
        return line + self.shift if line > self.behind else 0

    def now(self, line: int) -> int:
        """Return the number that a line of the earlier version has now; 0 if it has changed since."""
        if line <= self.before:
            return line
        return line - self.shift if line - self.shift > self.behind else 0


def same_lines(earlier: Sequence[str], now: Sequence[str]) -> SameLines:
    """Return which lines are the same: those in front of the first changed one, and behind the last changed one."""
    most = min(len(earlier), len(now))
    first = next((index for index in range(most) if earlier[index] != now[index]), most)
    last = next((index for index in range(most - first) if earlier[-1 - index] != now[-1 - index]), most - first)
    return SameLines(first, len(now) - last, len(earlier) - len(now))
