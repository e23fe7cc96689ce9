"""Finds outputs behind a move with a blend radius, which come before its point."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import OutputBeforePoint
from elitescript.said import said

NEAR_M: Final = 0.001
"""Distance of the point within which an output comes at it (*assumed*)."""


class OutputsBeforePoints(Observer):
    """Tells of each line once."""

    __slots__ = ("_told",)

    def __init__(self) -> None:
        self._told: set[int] = set()

    def see(self, seen: OutputBeforePoint) -> Iterable[Finding]:
        """Tell how far it is to the point."""
        if seen.left_m < NEAR_M or seen.line in self._told:
            return
        self._told.add(seen.line)
        text = said(
            "{signal} changed {left_mm:.1f} mm before the point of the move in line {move_line}: a "
            "move with a blend radius returns where the blend begins",
            signal=seen.signal,
            left_mm=1000 * seen.left_m,
            move_line=seen.move_line,
        )
        hint = "leave out r for an output at the point"
        yield found("N223", text, line=seen.line, thread=seen.thread, hint=hint)
