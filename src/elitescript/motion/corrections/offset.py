"""Laws of path offsets: frames, smoothing, and how the arm follows them.

A *deviation* is the difference of the TCP from its nominal pose: a translation and a rotation along and about the axes
of the base frame, as a transform, so that `compliance.after_way` applies it. All laws are *assumed*, after those of
URScript, whose commands have the same names.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, sqrt
from typing import Final

from elitescript.kinematics.rotations import Rotation, Vector3, cross, from_columns, multiply, rotate, transpose
from elitescript.kinematics.transforms import IDENTITY, Transform, position_of, rotation_of
from elitescript.messages.motion import Six
from elitescript.messages.path_offset import OffsetFrame
from elitescript.messages.timing import PERIOD_S
from elitescript.motion.corrections.admittance import TRAVEL_MIN
from elitescript.motion.corrections.compliance import after_way, way_between
from elitescript.records import NamedTuple

_PARALLEL: Final = 1e-3
"""Sine of the angle between path and tool axis below which they define no direction across."""

_ARRIVED: Final = 1e-9
"""Distance, m and rad, at which a filter has arrived."""

SHARE: Final = 0.5
"""Share of the joints' speed and acceleration that a lagging offset may use; the rest is for the move itself."""

BRAKING_SHARE: Final = 0.35
"""Share of the acceleration for braking at the end of a lag, below `SHARE` as a reserve."""


def travel_axes(velocity: Sequence[float], T_base_tcp: Transform, before: Rotation | None) -> Rotation:
    """Return the axes of the frame of motion in the base frame.

    Args:
        velocity: of the TCP on its nominal path, m/s, base frame.
        T_base_tcp: pose of the TCP on it.
        before: the axes until now, which stay while the arm stands, turns on the spot or moves along the tool's z
            axis; None takes the tool's x axis for the direction of travel then.
    """
    tool = rotation_of(T_base_tcp)
    z_tool: Vector3 = (tool[2], tool[5], tool[8])
    speed = hypot(*velocity)
    if speed >= TRAVEL_MIN:
        vx, vy, vz = velocity
        x: Vector3 = (vx / speed, vy / speed, vz / speed)
        across = cross(x, z_tool)
        width = hypot(*across)
        if width > _PARALLEL:
            y: Vector3 = (across[0] / width, across[1] / width, across[2] / width)
            return from_columns(x, y, cross(x, y))
    if before is not None:
        return before
    x = (tool[0], tool[3], tool[6])
    y = cross(x, z_tool)
    return from_columns(x, y, cross(x, y))


def in_base(axes: Rotation, offset: Transform) -> Transform:
    """Return the deviation of an offset along and about axes."""
    if offset == IDENTITY:
        return IDENTITY
    return (
        *multiply(multiply(axes, rotation_of(offset)), transpose(axes)),
        *rotate(axes, position_of(offset)),
    )


def along_axes(axes: Rotation, deviation: Transform) -> Transform:
    """Return the offset along and about axes of a deviation."""
    return in_base(transpose(axes), deviation)


def smoothed(present: Transform, wanted: Transform, alpha: float) -> Transform:
    """Return the offset of the next period, a share of the way nearer to the wanted one."""
    way = way_between(present, wanted)
    if alpha == 1.0 or max(map(abs, way)) < _ARRIVED:
        return wanted
    a, b, c, d, e, f = way
    return after_way(present, (alpha * a, alpha * b, alpha * c, alpha * d, alpha * e, alpha * f))


class FollowingRate(NamedTuple):
    """Bounds of speed and acceleration along a lag, per unit of it: 1/s and 1/s^2."""

    speed: float
    acceleration: float


def pace(lag_qd: Six, qd_max: Six, qdd_max: Six) -> FollowingRate:
    """Return the bounds with which joints may make up for a lag.

    Args:
        lag_qd: how far each joint has to turn for it, rad.
        qd_max: highest joint speeds, rad/s.
        qdd_max: highest joint accelerations, rad/s^2.
    """
    ways = [max(abs(way), 1e-300) for way in lag_qd]
    return FollowingRate(
        SHARE * min(top / way for top, way in zip(qd_max, ways, strict=True)),
        BRAKING_SHARE * min(top / way for top, way in zip(qdd_max, ways, strict=True)),
    )


def closing_rate(limits: FollowingRate) -> float | None:
    """Return the share of a lag to make up for in a second, so that it ends at rest; None for all of it in one period.

    It is the discrete form of braking with a constant deceleration.
    """
    a = limits.acceleration * PERIOD_S * PERIOD_S
    if a >= 1.0 and limits.speed * PERIOD_S >= 1.0:
        return None
    braked = a * (sqrt(0.25 + 2.0 / a) - 0.5)
    return min(braked, limits.speed * PERIOD_S, 1.0) / PERIOD_S


def change_share(change_qd: Six, qdd_max: Six, share: float = SHARE) -> float:
    """Return the share of a change of joint speeds, rad/s, that can be made within one period."""
    return min([1.0] + [share * top * PERIOD_S / abs(w) for w, top in zip(change_qd, qdd_max, strict=True) if w])


class Excess(NamedTuple):
    """An element of an offset that is above its limit."""

    name: str
    value: float
    limit: float
    unit: str


def bounded(offset: Six, translation_m: float, rotation_rad: float) -> tuple[Six, Excess | None]:
    """Return an offset with each element brought within its limit, and the first that was above it."""
    kept, excess = [], None
    for name, value in zip(_ELEMENTS, offset, strict=True):
        limit, unit = (translation_m, "m") if len(name) == 1 else (rotation_rad, "rad")
        if abs(value) > limit and excess is None:
            excess = Excess(name, value, limit, unit)
        kept.append(max(-limit, min(limit, value)))
    a, b, c, d, e, f = kept
    return (a, b, c, d, e, f), excess


_ELEMENTS: Final = ("x", "y", "z", "rx", "ry", "rz")


def axes_of(frame: OffsetFrame, T_base_tcp: Transform, motion: Rotation) -> Rotation:
    """Return the axes of a frame in the base frame; `motion` are those of the frame of motion."""
    if frame is OffsetFrame.BASE:
        return rotation_of(IDENTITY)
    return rotation_of(T_base_tcp) if frame is OffsetFrame.TCP else motion
