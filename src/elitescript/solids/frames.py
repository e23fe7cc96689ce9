"""Frames of the links of an arm, and how far a joint moves what is on a link."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, hypot, sin
from typing import Final

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.transforms import IDENTITY, Transform
from elitescript.solids.shapes import FLANGE

Frames = Sequence[Transform]
"""`T_base_link` of links 0 to 7."""

_PARALLEL: Final = (2, 3, 4)
"""Joints whose axes are parallel in every arm that is not calibrated."""


def frames_of(arm: Arm) -> Callable[[Sequence[float]], Frames]:
    """Return a function that gives the frames of all links for joint positions in rad."""
    a, d, alpha = arm.modified_dh
    fixed = [(a[i], -sin(alpha[i]) * d[i], cos(alpha[i]) * d[i], cos(alpha[i]), sin(alpha[i])) for i in range(6)]

    def frames(q: Sequence[float]) -> Frames:
        r11, r12, r13, r21, r22, r23, r31, r32, r33, px, py, pz = T = IDENTITY
        found = [T]
        for angle, (x, y, z, ca, sa) in zip(q, fixed, strict=True):
            c, s = cos(angle), sin(angle)
            # The axes of the next frame before its own turn: x stays, y and z turn about it.
            y1, y2, y3 = ca * r12 + sa * r13, ca * r22 + sa * r23, ca * r32 + sa * r33
            z1, z2, z3 = ca * r13 - sa * r12, ca * r23 - sa * r22, ca * r33 - sa * r32
            px += r11 * x + r12 * y + r13 * z
            py += r21 * x + r22 * y + r23 * z
            pz += r31 * x + r32 * y + r33 * z
            r11, r12 = c * r11 + s * y1, c * y1 - s * r11
            r21, r22 = c * r21 + s * y2, c * y2 - s * r21
            r31, r32 = c * r31 + s * y3, c * y3 - s * r31
            r13, r23, r33 = z1, z2, z3
            found.append((r11, r12, r13, r21, r22, r23, r31, r32, r33, px, py, pz))
        found.append(found[-1])
        return found

    return frames


def lever_arms(arm: Arm, base: int, link: int, reach: float, across: float) -> tuple[float, ...]:
    """Return for each joint how far a point of a link moves against another link per radian, at most, m.

    Args:
        arm: its lengths.
        base: the link that it moves against.
        link: the link, `base` < `link`.
        reach: distance of the farthest point from the origin of the link's frame, m.
        across: distance of the farthest point from its z axis, m.
    """
    a, d, _ = arm.modified_dh
    link = min(link, FLANGE - 1)
    is_nominal = arm.calibration is None
    found = []
    for joint in range(1, 7):
        if not base < joint <= link:
            found.append(0.0)
            continue
        is_parallel = joint == link or (is_nominal and joint in _PARALLEL and link in _PARALLEL)
        way = across if is_parallel else reach
        for i in range(joint, link):
            # What lies along the joint's axis does not move with it.
            is_along = is_nominal and joint in _PARALLEL and i + 1 in _PARALLEL
            way += abs(a[i]) if is_along else hypot(a[i], d[i])
        found.append(way)
    return tuple(found)
