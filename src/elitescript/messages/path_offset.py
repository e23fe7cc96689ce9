"""Requests that shift any motion of the arm by a path offset."""

from __future__ import annotations

from elitescript.messages.enums import Mode
from elitescript.messages.motion import Six
from elitescript.records import record


class OffsetFrame(Mode):
    """Frame of a path offset; the numbers that scripts use."""

    BASE = 1
    TCP = 2
    MOTION = 3
    """x along the path, y across it and the tool's z axis, z = x cross y."""


@record
class EnablePathOffset:
    """Apply path offsets from now on, beginning with none."""


@record
class SetPathOffset:
    """Shift the motion by an offset."""

    offset: Six
    """Translation, m, and roll-pitch-yaw, rad, along and about the axes of the frame."""
    frame: OffsetFrame


@record
class LimitPathOffset:
    """Bound the offsets."""

    translation_m: float
    """Along each axis."""
    rotation_rad: float
    """Of each angle."""


@record
class FilterPathOffset:
    """Smooth the offsets."""

    alpha: float
    """Share of the way to the wanted offset that is made in each control period, above 0 to 1."""


PathOffsetRequest = EnablePathOffset | SetPathOffset | LimitPathOffset | FilterPathOffset
