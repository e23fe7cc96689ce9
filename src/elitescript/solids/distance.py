"""Computes the distance of two convex bodies, or how deep they are in each other, with the points where it is.

Two capsules or spheres: closed form of the distance of two segments (Ericson, Real-Time Collision Detection, 5.1.9).
A corner above a face of a box: its height. Otherwise the distance of the cores by the algorithm of Gilbert, Johnson and
Keerthi (1988), which ends at the exact closest features of polytopes. Cores that overlap: the shortest way out along
the normals of their faces and the products of their edges, one of which it is for polytopes (separating axes;
Gottschalk 1996).
"""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot, inf, sqrt
from typing import Final

from elitescript.kinematics.rotations import Vector3
from elitescript.kinematics.transforms import Transform
from elitescript.records import NamedTuple
from elitescript.solids.bodies import Body

EXACT_M: Final = 1e-9
"""Error of a distance."""
_ITERATIONS: Final = 64
_TOUCHING_M: Final = 1e-8
"""Cores that are so near overlap: what is left is rounding."""


class Closest(NamedTuple):
    """The distance of two bodies."""

    distance: float
    """m; how deep they are in each other if it is negative."""
    first: Vector3
    """Point of the first body, m."""
    second: Vector3
    """Point of the second body, m."""


def least_distance(a: Body, T_a: Transform, b: Body, T_b: Transform) -> float:
    """Return a lower bound of the distance of two bodies, m, for a fraction of the cost."""
    dx, dy, dz = T_b[9] - T_a[9], T_b[10] - T_a[10], T_b[11] - T_a[11]
    least = hypot(dx, dy, dz) - a.bound - b.bound
    if a.is_box:
        for i in (0, 1, 2):
            nx, ny, nz = T_a[i], T_a[3 + i], T_a[6 + i]
            gap = abs(nx * dx + ny * dy + nz * dz) - a.half[i] - b.reach(T_b, nx, ny, nz)
            if gap > least:
                least = gap
    if b.is_box:
        for i in (0, 1, 2):
            nx, ny, nz = T_b[i], T_b[3 + i], T_b[6 + i]
            gap = abs(nx * dx + ny * dy + nz * dz) - b.half[i] - a.reach(T_a, nx, ny, nz)
            if gap > least:
                least = gap
    if not (a.is_box or b.is_box):
        gap = _axes(a, T_a, b, T_b)[0] - a.across - a.margin - b.across - b.margin
        if gap > least:
            least = gap
    return least


def ball_distance(T_ball: Transform, radius: float, body: Body, T: Transform) -> float:
    """Return the distance of a ball from a box, or from the cylinder or capsule that encloses another body, m.

    That is a lower bound of the distance of what is in the ball; it means nothing where it is negative.
    """
    r11, r12, r13, r21, r22, r23, r31, r32, r33, x, y, z = T
    dx, dy, dz = T_ball[9] - x, T_ball[10] - y, T_ball[11] - z
    w = r13 * dx + r23 * dy + r33 * dz
    if body.is_box:
        a, b, c = body.half
        u = abs(r11 * dx + r21 * dy + r31 * dz) - a
        v = abs(r12 * dx + r22 * dy + r32 * dz) - b
        w = abs(w) - c
        return hypot(u if u > 0.0 else 0.0, v if v > 0.0 else 0.0, w if w > 0.0 else 0.0) - radius
    square = dx * dx + dy * dy + dz * dz - w * w
    side = (sqrt(square) if square > 0.0 else 0.0) - body.across
    w = abs(w) - body.along
    return hypot(side if side > 0.0 else 0.0, w if w > 0.0 else 0.0) - body.margin - radius


def closest(a: Body, T_a: Transform, b: Body, T_b: Transform) -> Closest:
    """Return the distance of two bodies at T_a and T_b, and where it is."""
    margin = a.margin + b.margin
    if a.is_slim and b.is_slim:
        core, p, q = _axes(a, T_a, b, T_b)
    elif b.is_box and (found := _above_face(b, T_b, a, T_a)) is not None:
        core, q, p = found
    elif a.is_box and (found := _above_face(a, T_a, b, T_b)) is not None:
        core, p, q = found
    else:
        core, p, q = _cores(a, T_a, b, T_b)
    if core > _TOUCHING_M:
        nx, ny, nz = (q[0] - p[0]) / core, (q[1] - p[1]) / core, (q[2] - p[2]) / core
    elif a.is_slim and b.is_slim:
        core, (nx, ny, nz) = 0.0, _across(T_a, T_b)
    else:
        core, (nx, ny, nz), p, q = _depth(a, T_a, b, T_b)
    i, j = a.margin, b.margin
    return Closest(
        core - margin,
        (p[0] + i * nx, p[1] + i * ny, p[2] + i * nz),
        (q[0] - j * nx, q[1] - j * ny, q[2] - j * nz),
    )


def _axes(a: Body, T_a: Transform, b: Body, T_b: Transform) -> tuple[float, Vector3, Vector3]:
    """Return the distance of the axes of two bodies, segments about their centres along z, and its points."""
    h, k = a.along, b.along
    ux, uy, uz, vx, vy, vz = T_a[2], T_a[5], T_a[8], T_b[2], T_b[5], T_b[8]
    x, y, z = T_a[9] - T_b[9], T_a[10] - T_b[10], T_a[11] - T_b[11]
    slope = ux * vx + uy * vy + uz * vz
    c = ux * x + uy * y + uz * z
    f = vx * x + vy * y + vz * z
    sine = 1.0 - slope * slope
    # Positions s and t along the axes, s free of its bounds first; parallel axes may take any s.
    s = (slope * f - c) / sine if sine > 1e-12 else 0.0
    s = h if s > h else -h if s < -h else s
    t = slope * s + f
    if t > k or t < -k:
        t = k if t > k else -k
        s = slope * t - c
        s = h if s > h else -h if s < -h else s
    p = (T_a[9] + s * ux, T_a[10] + s * uy, T_a[11] + s * uz)
    q = (T_b[9] + t * vx, T_b[10] + t * vy, T_b[11] + t * vz)
    return hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]), p, q


def _across(T_a: Transform, T_b: Transform) -> Vector3:
    """Return a unit vector across the z axes of two bodies."""
    x, y, z = T_a[2], T_a[5], T_a[8]
    u, v, w = T_b[2], T_b[5], T_b[8]
    nx, ny, nz = y * w - z * v, z * u - x * w, x * v - y * u
    length = hypot(nx, ny, nz)
    return (nx / length, ny / length, nz / length) if length > _TOUCHING_M else (T_a[0], T_a[3], T_a[6])


# ---------------------------------------------------------------- cores apart


def _above_face(box: Body, T_box: Transform, b: Body, T_b: Transform) -> tuple[float, Vector3, Vector3] | None:
    """Return the distance of a box and a core whose lowest corner is above a face of it, and its points; else None."""
    dx, dy, dz = T_b[9] - T_box[9], T_b[10] - T_box[10], T_b[11] - T_box[11]
    face, most, is_below = 0, -inf, False
    for i in (0, 1, 2):
        nx, ny, nz = T_box[i], T_box[3 + i], T_box[6 + i]
        height = nx * dx + ny * dy + nz * dz
        gap = abs(height) - box.half[i] - b.reach(T_b, nx, ny, nz)
        if gap > most:
            face, most, is_below = i, gap, height < 0.0
    nx, ny, nz = T_box[face], T_box[3 + face], T_box[6 + face]
    if is_below:
        nx, ny, nz = -nx, -ny, -nz
    q = b.support(T_b, -nx, -ny, -nz)
    dx, dy, dz = q[0] - T_box[9], q[1] - T_box[10], q[2] - T_box[11]
    gap = nx * dx + ny * dy + nz * dz - box.half[face]
    if gap <= _TOUCHING_M:
        return None
    for i in (face - 1, face - 2):
        if abs(T_box[i % 3] * dx + T_box[3 + i % 3] * dy + T_box[6 + i % 3] * dz) > box.half[i]:
            return None
    return gap, (q[0] - gap * nx, q[1] - gap * ny, q[2] - gap * nz), q


_Corner = tuple[float, float, float, Vector3, Vector3]
"""A corner of the difference of both cores, and the points that it is the difference of."""


def _cores(a: Body, T_a: Transform, b: Body, T_b: Transform) -> tuple[float, Vector3, Vector3]:
    """Return the distance of two cores and its points; 0 where they overlap."""
    support_a, support_b = a.support, b.support
    x, y, z = T_a[9] - T_b[9], T_a[10] - T_b[10], T_a[11] - T_b[11]
    simplex: list[_Corner] = []
    weights: list[float] = []
    best = inf
    for _ in range(_ITERATIONS):
        p, q = support_a(T_a, -x, -y, -z), support_b(T_b, x, y, z)
        wx, wy, wz = p[0] - q[0], p[1] - q[1], p[2] - q[2]
        square = x * x + y * y + z * z
        if simplex and square - (x * wx + y * wy + z * wz) <= EXACT_M * sqrt(square):
            break
        found = _nearest([*simplex, (wx, wy, wz, p, q)])
        if found is None:
            return 0.0, p, q
        kept, its_weights, (x, y, z) = found
        square = x * x + y * y + z * z
        if square >= best:
            break  # no progress: rounding
        simplex, weights, best = kept, its_weights, square
        if square <= _TOUCHING_M * _TOUCHING_M:
            break
    px = py = pz = qx = qy = qz = 0.0
    for weight, (_, _, _, p, q) in zip(weights, simplex, strict=True):
        px, py, pz = px + weight * p[0], py + weight * p[1], pz + weight * p[2]
        qx, qy, qz = qx + weight * q[0], qy + weight * q[1], qz + weight * q[2]
    return sqrt(best), (px, py, pz), (qx, qy, qz)


_Nearest = tuple[list[_Corner], list[float], Vector3]


def _nearest(simplex: list[_Corner]) -> _Nearest | None:
    """Return the face of a simplex that is nearest to the origin, weights of its corners and that point.

    None if the origin is inside.
    """
    if len(simplex) == 1:
        return simplex, [1.0], simplex[0][:3]
    if len(simplex) == 2:
        return _nearest_of_edge(*simplex)
    if len(simplex) == 3:
        return _nearest_of_triangle(*simplex)
    return _nearest_of_tetrahedron(*simplex)


def _nearest_of_edge(a: _Corner, b: _Corner) -> _Nearest:
    ax, ay, az = a[:3]
    dx, dy, dz = b[0] - ax, b[1] - ay, b[2] - az
    square = dx * dx + dy * dy + dz * dz
    t = -(ax * dx + ay * dy + az * dz)
    if t <= 0.0 or square == 0.0:
        return [a], [1.0], (ax, ay, az)
    if t >= square:
        return [b], [1.0], b[:3]
    t /= square
    return [a, b], [1.0 - t, t], (ax + t * dx, ay + t * dy, az + t * dz)


def _nearest_of_triangle(a: _Corner, b: _Corner, c: _Corner) -> _Nearest:
    """As Ericson 5.1.5, for the origin."""
    ax, ay, az = a[:3]
    bx, by, bz = b[:3]
    cx, cy, cz = c[:3]
    ux, uy, uz = bx - ax, by - ay, bz - az
    vx, vy, vz = cx - ax, cy - ay, cz - az
    d1, d2 = -(ux * ax + uy * ay + uz * az), -(vx * ax + vy * ay + vz * az)
    if d1 <= 0.0 and d2 <= 0.0:
        return [a], [1.0], (ax, ay, az)
    d3, d4 = -(ux * bx + uy * by + uz * bz), -(vx * bx + vy * by + vz * bz)
    if d3 >= 0.0 and d4 <= d3:
        return [b], [1.0], (bx, by, bz)
    vc = d1 * d4 - d3 * d2
    if vc <= 0.0 <= d1 and d3 <= 0.0 and d1 != d3:
        return _nearest_of_edge(a, b)
    d5, d6 = -(ux * cx + uy * cy + uz * cz), -(vx * cx + vy * cy + vz * cz)
    if d6 >= 0.0 and d5 <= d6:
        return [c], [1.0], (cx, cy, cz)
    vb = d5 * d2 - d1 * d6
    if vb <= 0.0 <= d2 and d6 <= 0.0 and d2 != d6:
        return _nearest_of_edge(a, c)
    va = d3 * d6 - d5 * d4
    if va <= 0.0 and d4 >= d3 and d5 >= d6:
        return _nearest_of_edge(b, c)
    whole = va + vb + vc
    if whole <= 0.0:
        # No area: one of its edges.
        edges = (_nearest_of_edge(a, b), _nearest_of_edge(a, c), _nearest_of_edge(b, c))
        return min(edges, key=_square)
    s, t = vb / whole, vc / whole
    point = (ax + s * ux + t * vx, ay + s * uy + t * vy, az + s * uz + t * vz)
    return [a, b, c], [1.0 - s - t, s, t], point


def _square(found: _Nearest) -> float:
    x, y, z = found[2]
    return x * x + y * y + z * z


def _nearest_of_tetrahedron(a: _Corner, b: _Corner, c: _Corner, d: _Corner) -> _Nearest | None:
    best: _Nearest | None = None
    is_flat = False
    for i, j, k, apex in ((a, b, c, d), (a, c, d, b), (a, d, b, c), (b, d, c, a)):
        ux, uy, uz = j[0] - i[0], j[1] - i[1], j[2] - i[2]
        vx, vy, vz = k[0] - i[0], k[1] - i[1], k[2] - i[2]
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        origin = -(nx * i[0] + ny * i[1] + nz * i[2])
        inner = nx * (apex[0] - i[0]) + ny * (apex[1] - i[1]) + nz * (apex[2] - i[2])
        is_flat = is_flat or abs(inner) < 1e-18
        if is_flat or origin * inner < 0.0:
            found = _nearest_of_triangle(i, j, k)
            if best is None or _square(found) < _square(best):
                best = found
    return best


# ---------------------------------------------------------------- cores that overlap


def _depth(a: Body, T_a: Transform, b: Body, T_b: Transform) -> tuple[float, Vector3, Vector3, Vector3]:
    """Return minus the shortest way that takes two cores apart, its direction from a to b, and a point of each."""
    best, normal, is_of_a = inf, (0.0, 0.0, 1.0), False
    cx, cy, cz = T_b[9] - T_a[9], T_b[10] - T_a[10], T_b[11] - T_a[11]
    is_symmetric = a.is_symmetric and b.is_symmetric
    for (nx, ny, nz), of_a in _ways(a, T_a, b, T_b):
        # Away from the other centre is shorter, if both bodies look the same from both sides.
        if nx * cx + ny * cy + nz * cz < 0.0:
            nx, ny, nz = -nx, -ny, -nz
        for x, y, z in ((nx, ny, nz),) if is_symmetric else ((nx, ny, nz), (-nx, -ny, -nz)):
            px, py, pz = a.support(T_a, x, y, z)
            qx, qy, qz = b.support(T_b, -x, -y, -z)
            depth = (px - qx) * x + (py - qy) * y + (pz - qz) * z
            if depth < best - EXACT_M:
                best, normal, is_of_a = depth, (x, y, z), of_a
    x, y, z = normal
    if is_of_a:
        q = b.support(T_b, -x, -y, -z)
        p = (q[0] + best * x, q[1] + best * y, q[2] + best * z)
    else:
        p = a.support(T_a, x, y, z)
        q = (p[0] - best * x, p[1] - best * y, p[2] - best * z)
    return -best, normal, p, q


def _ways(a: Body, T_a: Transform, b: Body, T_b: Transform) -> Iterator[tuple[Vector3, bool]]:
    """Yield the directions, one of which is the shortest way out, and whether it is a normal of a."""
    for normal in a.normals(T_a):
        yield normal, True
    for normal in b.normals(T_b):
        yield normal, False
    edges = list(b.edges(T_b))
    for ux, uy, uz in a.edges(T_a):
        for vx, vy, vz in edges:
            nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
            square = nx * nx + ny * ny + nz * nz
            if square > 1e-12 * (ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz):
                length = sqrt(square)
                yield (nx / length, ny / length, nz / length), False
