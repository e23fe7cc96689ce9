"""Finds commands that are refused again and again while the program goes on."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import CommandRefused
from elitescript.messages.timing import TICKS_PER_S
from elitescript.said import said

MOVES_MAX: Final = 10
"""Refusals in a row of a command that moves the arm; a program may try a few places."""
CALLS_MAX: Final = 100
"""Refusals in a row of another one, such as `get_inverse_kin` in a search."""
EVER_MAX: Final = 100
"""Refusals of a line that moves the arm, with any time between."""
PAUSE_TICKS: Final = TICKS_PER_S
"""Refusals that are further apart are not in a row."""


class _Line:
    """What was refused at a line."""

    __slots__ = ("ever", "first", "in_a_row", "is_told", "tick")

    def __init__(self, seen: CommandRefused) -> None:
        self.tick = seen.tick
        self.first = seen.text
        self.in_a_row = self.ever = 0
        self.is_told = False


class SwallowedRefusals(Observer):
    """Tells of each line and command once."""

    __slots__ = ("_lines",)

    def __init__(self) -> None:
        self._lines: dict[tuple[int, str], _Line] = {}

    def see(self, seen: CommandRefused) -> Iterable[Finding]:
        """Count the refusals of a line."""
        line = self._lines.setdefault((seen.line, seen.command), _Line(seen))
        if line.is_told:
            return
        if seen.tick - line.tick > PAUSE_TICKS:
            line.in_a_row, line.first = 0, seen.text
        line.in_a_row, line.ever, line.tick = line.in_a_row + 1, line.ever + 1, seen.tick
        if line.in_a_row == (MOVES_MAX if seen.moves else CALLS_MAX):
            times = said("{count} times in a row", count=line.in_a_row)
        elif line.ever == EVER_MAX and seen.moves:
            times = said("{count} times", count=line.ever)
        else:
            return
        line.is_told = True
        text = said(
            "{command} was refused {times}, and the program goes on: {first}",
            command=seen.command,
            times=times,
            first=line.first,
        )
        hint = "end the loop, or say what went wrong, in the block of except"
        yield found("W292", text, line=seen.line, thread=seen.thread, hint=hint)
