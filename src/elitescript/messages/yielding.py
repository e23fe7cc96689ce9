"""Requests that let the arm yield to forces, beside its motion.

Frames are TCP poses in the base frame (`[x, y, z, rx, ry, rz]`, m and rad, roll-pitch-yaw).
"""

from __future__ import annotations

from elitescript.messages.motion import Six
from elitescript.records import record


@record
class ForceMode:
    """Let the selected axes of a frame yield until the arm presses with a wrench."""

    reference_frame: Six
    """Pose in the base frame."""
    selection: tuple[bool, ...]
    """x, y, z, Rx, Ry, Rz of the force frame."""
    target: Six
    """Wrench that the arm exerts, N and N m; counts for selected axes."""
    mode: int
    """How the force frame follows: 0 fixed, 1 point, 2 motion, 3 TCP."""
    speed_limits: Six
    """m/s and rad/s, >= 0."""


@record
class EndForceMode:
    """Come to rest and end force mode."""


@record
class Freedrive:
    """Let the arm be guided by hand."""

    free_axes: tuple[bool, ...]
    """x, y, z, Rx, Ry, Rz of the frame."""
    frame: Six | None = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    """Pose in the base frame; None for the TCP frame."""


@record
class EndFreedrive:
    """Come to rest and end hand guiding."""


YieldRequest = ForceMode | EndForceMode | Freedrive | EndFreedrive
