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
PAUSE_TICKS: Final = TICKS_PER_S
"""Refusals that are further apart are not in a row."""


class SwallowedRefusals(Observer):
    """Tells of each line and command once."""

    __slots__ = ("_refused",)

    def __init__(self) -> None:
        self._refused: dict[tuple[int, str], tuple[int, int, str]] = {}
        """Number in a row, last tick and first text of each line and command."""

    def see(self, seen: CommandRefused) -> Iterable[Finding]:
        """Count the refusals of a line."""
        key = seen.line, seen.command
        count, tick, first = self._refused.get(key, (0, seen.tick, seen.text))
        most = MOVES_MAX if seen.moves else CALLS_MAX
        if count < most and seen.tick - tick > PAUSE_TICKS:
            count, first = 0, seen.text
        self._refused[key] = count + 1, seen.tick, first
        if count + 1 == most:
            text = said(
                "{command} was refused {most} times in a row, and the program goes on: {first}",
                command=seen.command,
                most=most,
                first=first,
            )
            hint = "end the loop, or say what went wrong, in the block of except"
            yield found("W292", text, line=seen.line, thread=seen.thread, hint=hint)
