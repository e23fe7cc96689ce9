"""Convex bodies that distances are computed of: a core and a margin about it.

The core of a sphere is a point, that of a capsule a segment; boxes, cylinders and cones have no margin. Round sides are
taken as regular polygons of `SIDES` sides about the circle: so every core is a polytope, and closest distance and depth
are exact but for what the polygon stands out, at most `ROUND_EXCESS` of the radius.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import atan2, cos, hypot, pi, sin, sqrt
from typing import Final

from elitescript.kinematics.rotations import Vector3
from elitescript.kinematics.transforms import Transform
from elitescript.solids.shapes import Part, transform_of

SIDES: Final = 24
ROUND_EXCESS: Final = 1.0 / cos(pi / SIDES) - 1.0
"""How far the corners of the polygon are outside the circle, as a share of the radius: 0.9 %."""

_STEP: Final = 2.0 * pi / SIDES
_CIRCLE: Final = tuple([(cos(_STEP * k), sin(_STEP * k)) for k in range(SIDES)])


class Body:
    """A convex body in a frame of its own, about its centre; immutable.

    Attributes:
        half: half extents of a box; of a round body radius of its lower end, radius of its upper end, half length along
            z, the radii to the corners of the polygon; of a segment its half length.
        margin: m, about the core.
        bound: radius of the sphere about the centre that encloses all of it, margin included.
        across: radius about the z axis that encloses the core.
        along: half length along z of the core.
        support: `support(T, dx, dy, dz)` returns the point of the core, placed at T, that is farthest in a direction.
    """

    __slots__ = ("across", "along", "bound", "half", "is_box", "is_slim", "is_symmetric", "margin", "support")

    def __init__(self, kind: str, size: tuple[float, ...]) -> None:
        self.margin = 0.0
        self.is_box = kind == "box"
        self.is_symmetric = kind != "cone"
        """Whether it looks the same from opposite sides."""
        self.is_slim = kind in ("sphere", "capsule")
        """Whether the core is a point or a segment."""
        self.support: Callable[[Transform, float, float, float], Vector3]
        if kind == "box":
            a, b, c = [0.5 * length for length in size]
            self.half = (a, b, c)
            self.across, self.along = hypot(a, b), c
            self.support = self._box
        elif kind in ("sphere", "capsule"):
            self.margin, length = (*size, 0.0)[:2]
            self.half = (0.5 * length, 0.0, 0.0)
            self.across, self.along = 0.0, 0.5 * length
            self.support = self._segment
        else:
            low, high = (size[0], size[1]) if kind == "cone" else (size[0], size[0])
            self.half = (low * (1.0 + ROUND_EXCESS), high * (1.0 + ROUND_EXCESS), 0.5 * size[-1])
            self.across, self.along = max(self.half[:2]), self.half[2]
            self.support = self._frustum
        self.bound = hypot(self.across, self.along) + self.margin

    def _box(self, T: Transform, dx: float, dy: float, dz: float) -> Vector3:
        r11, r12, r13, r21, r22, r23, r31, r32, r33, x, y, z = T
        a, b, c = self.half
        if r11 * dx + r21 * dy + r31 * dz < 0.0:
            a = -a
        if r12 * dx + r22 * dy + r32 * dz < 0.0:
            b = -b
        if r13 * dx + r23 * dy + r33 * dz < 0.0:
            c = -c
        return (
            x + r11 * a + r12 * b + r13 * c,
            y + r21 * a + r22 * b + r23 * c,
            z + r31 * a + r32 * b + r33 * c,
        )

    def _segment(self, T: Transform, dx: float, dy: float, dz: float) -> Vector3:
        _, _, r13, _, _, r23, _, _, r33, x, y, z = T
        h = self.half[0]
        if r13 * dx + r23 * dy + r33 * dz < 0.0:
            h = -h
        return x + r13 * h, y + r23 * h, z + r33 * h

    def _frustum(self, T: Transform, dx: float, dy: float, dz: float) -> Vector3:
        r11, r12, r13, r21, r22, r23, r31, r32, r33, x, y, z = T
        u = r11 * dx + r21 * dy + r31 * dz
        v = r12 * dx + r22 * dy + r32 * dz
        w = r13 * dx + r23 * dy + r33 * dz
        low, high, h = self.half
        # The corners are at half steps, so that the middles of the sides touch the circle at the axes of the body.
        c, s = _CORNERS[int(atan2(v, u) // _STEP)]
        way = u * c + v * s
        if high * way + h * w >= low * way - h * w:
            radius = high
        else:
            radius, h = low, -h
        a, b = radius * c, radius * s
        return (
            x + r11 * a + r12 * b + r13 * h,
            y + r21 * a + r22 * b + r23 * h,
            z + r31 * a + r32 * b + r33 * h,
        )

    def reach(self, T: Transform, nx: float, ny: float, nz: float) -> float:
        """Return how far the body reaches from its centre in the direction of a unit vector, or a little more, m."""
        r11, r12, r13, r21, r22, r23, r31, r32, r33, _, _, _ = T
        w = abs(r13 * nx + r23 * ny + r33 * nz)
        if self.is_slim:
            return w * self.along + self.margin
        if self.is_box:
            a, b, c = self.half
            u = abs(r11 * nx + r21 * ny + r31 * nz)
            v = abs(r12 * nx + r22 * ny + r32 * nz)
            return a * u + b * v + c * w
        return self.across * sqrt(max(0.0, 1.0 - w * w)) + self.along * w

    def normals(self, T: Transform) -> Iterator[Vector3]:
        """Yield the unit normals of the faces of the core, one of each parallel pair."""
        if self.is_slim:
            return
        r11, r12, r13, r21, r22, r23, r31, r32, r33, _, _, _ = T
        yield r13, r23, r33
        if self.is_box:
            yield r11, r21, r31
            yield r12, r22, r32
            return
        low, high, h = self.half
        # The sides of a cone lean.
        lean = (low - high) * cos(0.5 * _STEP)
        length = hypot(lean, 2.0 * h)
        w, across = lean / length, 2.0 * h / length
        for c, s in _CIRCLE if lean else _CIRCLE[: SIDES // 2]:
            u, v = across * c, across * s
            yield r11 * u + r12 * v + r13 * w, r21 * u + r22 * v + r23 * w, r31 * u + r32 * v + r33 * w

    def edges(self, T: Transform) -> Iterator[Vector3]:
        """Yield the directions of the edges of the core, one of each parallel pair, of any length."""
        r11, r12, r13, r21, r22, r23, r31, r32, r33, _, _, _ = T
        if self.is_slim:
            if self.along > 0.0:
                yield r13, r23, r33
            return
        if self.is_box:
            yield r11, r21, r31
            yield r12, r22, r32
            yield r13, r23, r33
            return
        low, high, h = self.half
        for c, s in _CIRCLE[: SIDES // 2]:
            yield r12 * c - r11 * s, r22 * c - r21 * s, r32 * c - r31 * s
        if low == high:
            yield r13, r23, r33
            return
        for c, s in _CORNERS[:SIDES]:
            u, v, w = (high - low) * c, (high - low) * s, 2.0 * h
            yield r11 * u + r12 * v + r13 * w, r21 * u + r22 * v + r23 * w, r31 * u + r32 * v + r33 * w


_CORNERS: Final = tuple([(cos(_STEP * (k + 0.5)), sin(_STEP * (k + 0.5))) for k in range(SIDES)])
"""Corners of the polygon, each in the middle of the directions in which it is the farthest."""


def body_of(part: Part) -> tuple[Body, Transform]:
    """Return the body of a part, and where it is in the frame of its link.

    The tubes of the arm become capsules: their round ends are inside the housings.
    """
    if part.role == "tube" and part.kind == "cylinder":
        return Body("capsule", part.size), transform_of(part.pose)
    return Body(part.kind, part.size), transform_of(part.pose)
