"""The codec of everything that goes between a serving process and its child, and into a journal."""

from __future__ import annotations

from dataclasses import replace

from elitescript.controller.force.contact import ContactConfig, Plane
from elitescript.controller.modes import PowerTimes
from elitescript.controller.safety.limits import SafetyBounds, SafetyLimits, SafetyPlane, ToolDirection
from elitescript.kernel.options import RobotOptions
from elitescript.messages.codec import Codec, to_text
from elitescript.messages.events import Event, MotionStarted
from elitescript.messages.motion import MoveML
from elitescript.messages.outputs import Output
from elitescript.messages.shapes import Shape


def full_codec() -> Codec:
    """Messages of the waist and configurations."""
    return Codec(RobotOptions, PowerTimes, ContactConfig, Plane, SafetyLimits, SafetyBounds, SafetyPlane, ToolDirection)


def output_text(shape: Shape[Output], output: Output) -> str:
    """An output as JSON text, the same wherever it is written."""
    return to_text(shape.encode(without_points(output)))


def without_points(output: Output) -> Output:
    """An output as it is written.

    A million points of a file are not sent to whoever hears that the arm begins to follow them.
    """
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
