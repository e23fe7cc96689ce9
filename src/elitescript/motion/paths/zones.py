"""Begin of a blend: the place at which the TCP enters the sphere of radius r about the waypoint for the last time.

A blend takes at most half of a move, so that the blends at its start and at its end never overlap, and a move has
reached its speed before it leaves its path.
"""

from __future__ import annotations

from collections.abc import Callable
from math import asin, dist
from typing import Final

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.rotations import Vector3
from elitescript.kinematics.transforms import Transform, position_of
from elitescript.messages.motion import BLEND_SHARE
from elitescript.motion.paths.cartesian import ArcPath, LinePath
from elitescript.motion.paths.track import JointTrack
from elitescript.motion.segment import JointPath
from elitescript.records import NamedTuple

SAMPLES: Final = 16
"""Places of half a joint move at which the distance from the waypoint is computed."""

HALVINGS: Final = 30


class Zone(NamedTuple):
    """The part of a path that is near its waypoint."""

    begin: float
    """Path position at which it begins."""
    radius: float
    """Distance of the TCP from the waypoint there, m."""
    is_shortened: bool
    """Whether the requested radius reaches back further than half of the move."""


def zone_before(path: JointPath, r: float, arm: Arm, T_flange_tcp: Transform) -> Zone:
    """Return the zone of radius r, m, about the end of a path."""
    half = BLEND_SHARE * path.length
    near = _near(path, r)
    if near is None:
        waypoint = position_of(path.T_base_tcp_end)

        def distance(way: float) -> float:
            return dist(_tcp(arm, path, path.length - way, T_flange_tcp), waypoint)

        near = _walked(distance, r, half)
        if near >= half:
            return Zone(path.length - half, min(r, distance(half)), distance(half) < r)
        return Zone(path.length - near, r, False)
    if near <= half:
        return Zone(path.length - near, r, False)
    if path.unit == "rad":
        # A rotation on the spot stays in any sphere.
        return Zone(half, r, False)
    return Zone(half, dist(_tcp(arm, path, half, T_flange_tcp), position_of(path.T_base_tcp_end)), True)


def way_within(path: JointPath, r: float, arm: Arm, T_flange_tcp: Transform) -> float:
    """Return the length of path from the start until the TCP is r, m, away; at most half of it."""
    half = BLEND_SHARE * path.length
    near = _near(path, r)
    if near is None:
        start = _tcp(arm, path, 0.0, T_flange_tcp)
        near = _walked(lambda way: dist(_tcp(arm, path, way, T_flange_tcp), start), r, half)
    return min(near, half)


def _near(path: JointPath, r: float) -> float | None:
    """Return the length of path that spans a chord r, from either end; None without a closed form."""
    if isinstance(path, JointTrack):
        way = path.path
        if isinstance(way, LinePath):
            return r if way.unit == "m" else way.length
        if isinstance(way, ArcPath):
            return way.length if r >= 2.0 * way.radius else 2.0 * way.radius * asin(0.5 * r / way.radius)
    return None


def _walked(distance: Callable[[float], float], r: float, half: float) -> float:
    """Return the first way, up to half, at which a distance reaches r."""
    inside = 0.0
    for sample in range(1, SAMPLES + 1):
        outside = half * sample / SAMPLES
        if distance(outside) > r:
            break
        inside = outside
    else:
        return half
    for _ in range(HALVINGS):
        middle = 0.5 * (inside + outside)
        if distance(middle) > r:
            outside = middle
        else:
            inside = middle
    return inside


def _tcp(arm: Arm, path: JointPath, s: float, T_flange_tcp: Transform) -> Vector3:
    return position_of(arm.forward_tcp(path.q(s), T_flange_tcp))
