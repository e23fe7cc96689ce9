"""The codec of everything that goes between a serving process and its child, and into a journal."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final, TypeVar

from elitescript.controller.force.contact import ContactConfig, Plane
from elitescript.controller.modes import PowerTimes
from elitescript.controller.safety.limits import SafetyBounds, SafetyLimits, SafetyPlane, ToolDirection
from elitescript.errors import UsageError
from elitescript.kernel.options import RobotOptions
from elitescript.messages.codec import Codec, to_text
from elitescript.messages.events import Event, MotionStarted
from elitescript.messages.motion import MoveML
from elitescript.messages.outputs import Output, TickResult
from elitescript.messages.shapes import CodecError, Shape, check_list, shown

Said = TypeVar("Said", Output, TickResult)


def full_codec() -> Codec:
    """Messages of the waist and configurations."""
    return Codec(RobotOptions, PowerTimes, ContactConfig, Plane, SafetyLimits, SafetyBounds, SafetyPlane, ToolDirection)


FORMAT_2: Final = (
    *("model", "model_text", "firmware", "seed", "first_tick", "epoch_s", "joints", "speed", "power_on"),
    *("power_times", "remote", "robot_id", "serial_number", "configuration", "contact", "safety", "plant"),
    *("signals", "faults", "work_per_tick", "rpc_timeout_s", "strict"),
)
"""Order of the options in journals of format 2, which do not name them."""


def options_data(codec: Codec, options: RobotOptions) -> dict[str, Any]:
    """Return options as they stand in a journal: by their names, which stay readable when an option is added."""
    return {name: shape.encode(getattr(options, name)) for name, shape in codec.field_shapes(RobotOptions).items()}


def options_from_journal(codec: Codec, header: Mapping[str, Any]) -> RobotOptions:
    """Return the options in the first line of a journal; what it does not name has its default.

    Raises:
        CodecError: an unknown option, or a value that makes no sense.
        KeyError: there are none.
    """
    if header["journal"] == 2:
        check_list(header["config"], len(FORMAT_2))
        data: Any = dict(zip(FORMAT_2, header["config"], strict=True))
    else:
        data = header["options"]
    if type(data) is not dict:
        raise CodecError(f"options by their names are expected, not {shown(data)}")
    shapes = codec.field_shapes(RobotOptions)
    for name in data:
        if name not in shapes:
            raise CodecError(f"there is no option {name[:40]!r} in this version")
    try:
        return RobotOptions(**{name: shapes[name].decode(value) for name, value in data.items()})
    except UsageError as error:
        raise CodecError(f"options: {error}") from None


def output_text(shape: Shape[Output], output: Output) -> str:
    """An output as JSON text, the same wherever it is written."""
    return to_text(shape.encode(without_points(output)))


def without_points(output: Said) -> Said:
    """Return an output as it is written: the event that the arm begins to follow a file does not carry its points."""
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
