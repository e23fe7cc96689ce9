"""Options of a robot as data, by their names: on the way to a child, and in the first line of a journal."""

from __future__ import annotations

from typing import Any, Final

from elitescript.codec.messages import field_shapes
from elitescript.codec.values import CodecError, shown
from elitescript.controller.force.contact import ContactConfig
from elitescript.controller.safety.limits import SafetyLimits
from elitescript.errors import UsageError
from elitescript.kernel.options import RobotOptions
from elitescript.messages.faults import ChannelFault
from elitescript.messages.machine import DisturbInput
from elitescript.messages.plant import PlantConfig

_LAZY: Final = {kind.__name__: kind for kind in (ChannelFault, ContactConfig, DisturbInput, PlantConfig, SafetyLimits)}
"""Types of options that `kernel.options` does not import."""


def options_data(options: RobotOptions) -> dict[str, Any]:
    """Return options by their names, which stay readable when an option is added."""
    return {name: shape.encode(getattr(options, name)) for name, shape in field_shapes(RobotOptions, _LAZY).items()}


def options_from_data(data: Any) -> RobotOptions:
    """Return the options of such data; what it does not name has its default.

    Raises:
        CodecError: an unknown option, or a value that it does not take.
    """
    if type(data) is not dict:
        raise CodecError(f"options by their names are expected, not {shown(data)}")
    shapes = field_shapes(RobotOptions, _LAZY)
    for name in data:
        if name not in shapes:
            raise CodecError(f"there is no option {name[:40]!r} in this version")
    try:
        return RobotOptions(**{name: shapes[name].decode(value) for name, value in data.items()})
    except UsageError as error:
        raise CodecError(f"options: {error}") from None
