"""Solids: what they are made of, where they are, and how they are called."""

from __future__ import annotations

from math import pi
from typing import Final

from elitescript.kinematics.rotations import Vector3, rotation_from_rotvec, rotvec_from_rotation
from elitescript.kinematics.transforms import Transform, rotation_of
from elitescript.messages.motion import Six
from elitescript.records import NamedTuple

BASE: Final = 0
FLANGE: Final = 7
"""Links: 0 is the base, 1 to 6 are the frames of the modified Denavit-Hartenberg form, 7 is the flange, which is at the
place of frame 6."""

UPRIGHT: Final = (0.0, 0.0, 0.0)
ALONG_X: Final = (0.0, 0.5 * pi, 0.0)
ALONG_Y: Final = (-0.5 * pi, 0.0, 0.0)
"""Rotation vectors that turn the axis of a solid from z to x and to y."""


class Part(NamedTuple):
    """A solid in the frame of a link, as the page draws it."""

    link: int
    """`BASE` to `FLANGE`."""
    kind: str
    """`cylinder`, `cone`, `sphere`, `box` or `capsule`."""
    size: tuple[float, ...]
    """m. Of a cylinder radius and length along z; of a cone radius at -z, radius at +z and length; of a sphere its
    radius; of a box x, y, z; of a capsule radius and length between the centres of its ends."""
    pose: Six
    """Of its centre in the frame of the link: m, rotation vector in rad."""
    role: str
    """`base`, `housing`, `tube`, `cap`, `ring`, `flange`, `tool`, `payload` or `thing`."""
    name: str = ""
    """Of a thing or a tool."""
    color: str = ""
    """`#rrggbb`; empty if it has none of its own."""


def placed(center: Vector3, turn: Vector3 = UPRIGHT) -> Six:
    """Return the pose of a solid from its centre, m, and the rotation vector of its axes."""
    return (*center, *turn)


def pose_of(T: Transform) -> Six:
    """Return position and rotation vector of a transform."""
    return (*T[9:], *rotvec_from_rotation(rotation_of(T)))


def transform_of(pose: Six) -> Transform:
    """Return the transform of a pose with a rotation vector."""
    x, y, z, *turn = pose
    return (*rotation_from_rotvec(tuple(turn)), x, y, z)
