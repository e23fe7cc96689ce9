"""Outputs as text: between a serving process and its child, and in the digests of a journal."""

from __future__ import annotations

from typing import TypeVar

from elitescript.codec.json_text import to_text
from elitescript.codec.messages import shape_of
from elitescript.messages.events import Event, MotionStarted
from elitescript.messages.motion import MoveML
from elitescript.messages.outputs import Output, TickResult
from elitescript.records import replace

Said = TypeVar("Said", Output, TickResult)


def output_text(output: Output) -> str:
    """Return an output as JSON text, the same wherever it is written."""
    return to_text(shape_of(Output).encode(without_points(output)))


def without_points(output: Said) -> Said:
    """Return an output without the points of files that the arm follows: they may be a million."""
    if any(_has_points(event) for event in output.events):
        return replace(output, events=tuple(map(_without_points, output.events)))
    return output


def _has_points(event: Event) -> bool:
    return isinstance(event, MotionStarted) and isinstance(event.request, MoveML)


def _without_points(event: Event) -> Event:
    if isinstance(event, MotionStarted) and isinstance(event.request, MoveML):
        points = replace(event.request.points, numbers=b"", file_lines=b"")
        return replace(event, request=replace(event.request, points=points))
    return event
