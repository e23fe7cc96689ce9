"""Geometry in Cartesian space: the line and the circular arc, as poses over the path position s.

On both the tool turns about one axis that is fixed in the base, in step with s, while a point
of it follows the line or the circle. With the turned angle phi, the axis k and the lever x from
that point to the flange (Rodrigues' formula),

    Exp(phi k) x = k (k.x) + cos(phi) (x - k (k.x)) + sin(phi) (k x x)

The three vectors on the right are computed once, so that a pose costs one sine and one cosine.
Paths give the pose of the flange, for the inverse kinematics.

The path position is measured in metres along the way of the TCP. A pure rotation is measured in
radians (documented for speed and acceleration: they then are rad/s and rad/s^2).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from math import atan2, cos, hypot, pi, sin
from typing import Final, Protocol

from elitescript.errors import MotionError
from elitescript.kinematics.rotations import (
    Rotation,
    Vector3,
    cross,
    multiply,
    rotate,
    rotation_from_rotvec,
    rotvec_from_rotation,
    transpose,
)
from elitescript.kinematics.transforms import Transform, position_of, rotation_of
from elitescript.messages.motion import Six
from elitescript.motion.segment import AnyPath
from elitescript.said import said

ROTATION_LEADS_BELOW: Final = 1e-3
"""A move is a pure rotation when its translation is shorter than this share of the rotation
angle times the equivalent radius: about 0.4 mm for a quarter turn (*assumed*). In every other
move the translation leads and the rotation keeps step with it."""

SAME_PLACE: Final = 1e-9
"""Two poses this near (m and rad) are one: nothing has to move."""

ARC_HEIGHT_MIN_M: Final = 1e-6
"""Three points whose triangle is lower than this lie on a line as far as poses with six printed
decimals can tell; they have no circle."""


class FlangePath(AnyPath, Protocol):
    """Pose of the flange over a path position: a line, an arc, or the corner of a blend."""

    @property
    def way(self) -> float:
        """Way of the TCP over the path, m; 0 for a pure rotation."""

    @property
    def sweep(self) -> float:
        """Largest angle, rad, by which tool or direction of travel turns over the path."""

    @property
    def turn(self) -> float:
        """Angle by which the tool turns, rad."""

    @property
    def tool_rates(self) -> tuple[float, float]:
        """Way (m) and rotation (rad) of the tool per unit of path position, or bounds of them."""

    def place(self, s: float) -> str:
        """Return in words where on the move a path position is."""

    def flange(self, s: float) -> Transform:
        """Return `T_base_flange` at a path position."""

    def flange_and_slope(self, s: float) -> tuple[Transform, Six]:
        """Return `T_base_flange` at a path position, and the twist of the flange per unit of path position."""


class CartesianPath(ABC):
    """Pose of the flange over the path position; immutable. A `FlangePath`, made by `line` and `arc`."""

    __slots__ = (
        "T_base_tcp_end",
        "_axis",
        "_cosine_part",
        "_fixed_part",
        "_lever",
        "_rotation",
        "_sine_part",
        "_turn_rate",
        "kind",
        "length",
        "turn",
        "unit",
    )

    def __init__(
        self,
        kind: str,
        unit: str,
        length: float,
        axis: Vector3,
        turn: float,
        R_base_flange: Rotation,
        lever: Vector3,
        T_base_tcp_end: Transform,
    ) -> None:
        """Set up the turning.

        Args:
            kind: `line` or `arc`.
            unit: unit of the path position, `m` or `rad`.
            length: path position at the end.
            axis: unit vector in the base about which the tool turns.
            turn: angle of the whole turn, rad, >= 0.
            R_base_flange: orientation of the flange at the start.
            lever: from the guided point to the flange at the start, base frame, m.
            T_base_tcp_end: pose of the TCP at the end.
        """
        self.kind = kind
        self.unit = unit
        self.length = length
        self.turn = turn
        self.T_base_tcp_end = T_base_tcp_end
        self._axis = axis
        self._turn_rate = turn / length if length else 0.0
        self._rotation = R_base_flange
        self._lever = lever
        if self._turn_rate != 0.0:
            x, y, z = (_turning_parts(axis, R_base_flange[column::3]) for column in range(3))
            # In the order of a Transform: the rows of the three rotation columns, then the lever.
            self._fixed_part, self._cosine_part, self._sine_part = (
                (x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2], *part)
                for x, y, z, part in zip(x, y, z, _turning_parts(axis, lever), strict=True)
            )

    @property
    def tool_rates(self) -> tuple[float, float]:
        return (1.0 if self.unit == "m" else 0.0), self._turn_rate

    @property
    def way(self) -> float:
        return self.length if self.unit == "m" else 0.0

    @property
    def sweep(self) -> float:
        return self.turn

    @property
    def rotation_slope(self) -> Vector3:
        """Rotation vector of the tool per unit of path position, base frame."""
        return _scaled(self._axis, self._turn_rate)

    def place(self, s: float) -> str:
        if s <= 0.0:
            return "at the start"
        what = "rotation" if self.unit == "rad" else self.kind
        if s >= self.length:
            return said(
                "at the target, {length:.4f} {unit} from the start of the {what}",
                length=self.length,
                unit=self.unit,
                what=what,
            )
        return said(
            "{s:.4f} {unit} from the start of the {what} of {length:.4f} {unit}",
            s=s,
            unit=self.unit,
            what=what,
            length=self.length,
        )

    @abstractmethod
    def point(self, s: float) -> Vector3:
        """Return the guided point at a path position, base frame, m."""

    @abstractmethod
    def point_slope(self, s: float) -> Vector3:
        """Return the derivative of the guided point by the path position."""

    def flange(self, s: float) -> Transform:
        x, y, z = self.point(s)
        if self._turn_rate == 0.0:
            lever_x, lever_y, lever_z = self._lever
            return (*self._rotation, x + lever_x, y + lever_y, z + lever_z)
        angle = self._turn_rate * s
        c = cos(angle)
        n = sin(angle)
        r11, r12, r13, r21, r22, r23, r31, r32, r33, lever_x, lever_y, lever_z = [
            fixed + c * cosine + n * sine
            for fixed, cosine, sine in zip(self._fixed_part, self._cosine_part, self._sine_part, strict=True)
        ]
        return r11, r12, r13, r21, r22, r23, r31, r32, r33, x + lever_x, y + lever_y, z + lever_z

    def flange_and_slope(self, s: float) -> tuple[Transform, Six]:
        T_base_flange = self.flange(s)
        return T_base_flange, self.flange_slope(s, T_base_flange)

    def flange_slope(self, s: float, T_base_flange: Transform) -> Six:
        """Return the twist of the flange per unit of path position, given its pose there."""
        vx, vy, vz = self.point_slope(s)
        rate = self._turn_rate
        if rate == 0.0:
            return vx, vy, vz, 0.0, 0.0, 0.0
        kx, ky, kz = self._axis
        wx, wy, wz = rate * kx, rate * ky, rate * kz
        x, y, z = self.point(s)
        x = T_base_flange[9] - x
        y = T_base_flange[10] - y
        z = T_base_flange[11] - z
        return vx + wy * z - wz * y, vy + wz * x - wx * z, vz + wx * y - wy * x, wx, wy, wz


class LinePath(CartesianPath):
    """The TCP on a straight line, or at rest while the tool turns."""

    __slots__ = ("_direction", "_origin")

    def __init__(
        self,
        unit: str,
        length: float,
        axis: Vector3,
        turn: float,
        T_base_flange: Transform,
        T_base_tcp: Transform,
        T_base_tcp_end: Transform,
    ) -> None:
        start, end = position_of(T_base_tcp), position_of(T_base_tcp_end)
        lever = _difference(position_of(T_base_flange), start)
        super().__init__("line", unit, length, axis, turn, rotation_of(T_base_flange), lever, T_base_tcp_end)
        self._origin = start
        self._direction = _scaled(_difference(end, start), 1.0 / length if length else 0.0)

    def point(self, s: float) -> Vector3:
        x, y, z = self._origin
        u, v, w = self._direction
        return x + s * u, y + s * v, z + s * w

    def point_slope(self, s: float) -> Vector3:
        return self._direction


class ArcPath(CartesianPath):
    """The TCP on a circular arc; orientation held against the tangent or turned evenly to the end.

    Held against the tangent, the whole tool turns rigidly about the axis of the circle: the
    guided point is then the centre, and the lever reaches from there to the flange.
    """

    __slots__ = ("_centre", "_first", "_second", "angle", "radius")

    def __init__(
        self,
        centre: Vector3,
        radius: float,
        angle: float,
        normal: Vector3,
        axis: Vector3,
        turn: float,
        is_orientation_fixed: bool,
        T_base_flange: Transform,
        T_base_tcp: Transform,
        T_base_tcp_end: Transform,
    ) -> None:
        start = position_of(T_base_tcp)
        guided = centre if is_orientation_fixed else start
        lever = _difference(position_of(T_base_flange), guided)
        super().__init__("arc", "m", radius * angle, axis, turn, rotation_of(T_base_flange), lever, T_base_tcp_end)
        self.radius = radius
        self.angle = angle
        self._centre = centre
        first = (0.0, 0.0, 0.0) if is_orientation_fixed else _difference(start, centre)
        self._first = first
        self._second = cross(normal, first)

    @property
    def sweep(self) -> float:
        return max(self.turn, self.angle)

    def point(self, s: float) -> Vector3:
        x, y, z = self._centre
        angle = s / self.radius
        c = cos(angle)
        n = sin(angle)
        first, second = self._first, self._second
        return (
            x + c * first[0] + n * second[0],
            y + c * first[1] + n * second[1],
            z + c * first[2] + n * second[2],
        )

    def point_slope(self, s: float) -> Vector3:
        angle = s / self.radius
        c = cos(angle) / self.radius
        n = sin(angle) / self.radius
        first, second = self._first, self._second
        return c * second[0] - n * first[0], c * second[1] - n * first[1], c * second[2] - n * first[2]


def line(
    T_base_flange: Transform, T_base_tcp: Transform, T_base_tcp_end: Transform, equivalent_radius_m: float
) -> LinePath:
    """Return the line of the TCP from its present pose to another, turning by the shortest rotation.

    Args:
        T_base_flange: flange at the start.
        T_base_tcp: TCP at the start.
        T_base_tcp_end: TCP at the end.
        equivalent_radius_m: decides what is a pure rotation, see `ROTATION_LEADS_BELOW`.
    """
    axis, turn = _shortest_turn(T_base_tcp, T_base_tcp_end)
    distance = hypot(*_difference(position_of(T_base_tcp_end), position_of(T_base_tcp)))
    if distance < SAME_PLACE and turn < SAME_PLACE:
        return LinePath("m", 0.0, axis, 0.0, T_base_flange, T_base_tcp, T_base_tcp_end)
    if distance < ROTATION_LEADS_BELOW * equivalent_radius_m * turn:
        return LinePath("rad", turn, axis, turn, T_base_flange, T_base_tcp, T_base_tcp_end)
    return LinePath("m", distance, axis, turn, T_base_flange, T_base_tcp, T_base_tcp_end)


def arc(
    T_base_flange: Transform,
    T_base_tcp: Transform,
    T_base_tcp_via: Transform,
    T_base_tcp_end: Transform,
    is_orientation_fixed: bool,
) -> ArcPath:
    """Return the arc of the TCP from its present pose through a second point to a third.

    The orientation of the via pose is never used. Fixed orientation keeps its relation to the
    tangent, so that of the end pose is not used either; otherwise the tool turns evenly from
    the present orientation to that of the end pose by the shortest rotation (both *assumed*:
    the manual only names the modes).

    Raises:
        MotionError: R113, the three points have no circle.
    """
    start, via, end = position_of(T_base_tcp), position_of(T_base_tcp_via), position_of(T_base_tcp_end)
    to_via, to_end = _difference(via, start), _difference(end, start)
    sides = hypot(*to_via), hypot(*_difference(end, via)), hypot(*to_end)
    for side, names in zip(sides, (("start", "via"), ("via", "end"), ("start", "end")), strict=True):
        if side < ARC_HEIGHT_MIN_M:
            hint = (
                "a full circle takes two arcs of half a turn each"
                if names == ("start", "end")
                else "three different points are needed"
            )
            raise MotionError(
                said(
                    "the {first} and the {second} point of the arc are the same place ({side_mm:.4f} mm "
                    "apart, at least {least_mm:.3f} mm needed)",
                    first=names[0],
                    second=names[1],
                    side_mm=side * 1000.0,
                    least_mm=ARC_HEIGHT_MIN_M * 1000.0,
                ),
                code="R113",
                value=side,
                limit=f">= {ARC_HEIGHT_MIN_M:g}",
                unit="m",
                hint=hint,
            )
    area_normal = cross(to_via, to_end)
    twice_area = hypot(*area_normal)
    height = twice_area / max(sides)
    if height < ARC_HEIGHT_MIN_M:
        raise MotionError(
            said(
                "the three points of the arc lie on one line (the middle one is {height_mm:.4f} mm beside "
                "it, at least {least_mm:.3f} mm needed)",
                height_mm=height * 1000.0,
                least_mm=ARC_HEIGHT_MIN_M * 1000.0,
            ),
            code="R113",
            value=height,
            limit=f">= {ARC_HEIGHT_MIN_M:g}",
            unit="m",
            hint="use movel for a straight line",
        )
    normal = _scaled(area_normal, 1.0 / twice_area)
    # The centre seen from the start (circumcentre of a triangle in space).
    to_centre = _scaled(
        _difference(
            _scaled(cross(to_end, area_normal), sides[0] ** 2),
            _scaled(cross(to_via, area_normal), sides[2] ** 2),
        ),
        0.5 / twice_area**2,
    )
    centre = _sum(start, to_centre)
    radius = hypot(*to_centre)
    first = _scaled(to_centre, -1.0)
    second = cross(normal, first)
    last = _difference(end, centre)
    # About this normal the points follow one another counterclockwise, so the arc passes the via point.
    angle = atan2(_dot(last, second), _dot(last, first))
    if angle <= 0.0:
        angle += 2.0 * pi
    if is_orientation_fixed:
        turn_rotation = rotation_from_rotvec(_scaled(normal, angle))
        T_base_tcp_end = (*multiply(turn_rotation, rotation_of(T_base_tcp)), *end)
        axis, turn = normal, angle
    else:
        axis, turn = _shortest_turn(T_base_tcp, T_base_tcp_end)
    return ArcPath(
        centre, radius, angle, normal, axis, turn, is_orientation_fixed, T_base_flange, T_base_tcp, T_base_tcp_end
    )


_NO_TURN_RAD: Final = 1e-12
"""Orientations this near differ by rounding only."""


def _shortest_turn(T_base_tcp: Transform, T_base_tcp_end: Transform) -> tuple[Vector3, float]:
    """Return axis (unit vector, base frame) and angle of the shortest rotation between two poses."""
    R_start = rotation_of(T_base_tcp)
    rotvec = rotvec_from_rotation(multiply(transpose(R_start), rotation_of(T_base_tcp_end)))
    angle = hypot(*rotvec)
    if angle < _NO_TURN_RAD:
        return (0.0, 0.0, 1.0), 0.0
    return rotate(R_start, _scaled(rotvec, 1.0 / angle)), angle


def _turning_parts(axis: Vector3, x: Sequence[float]) -> tuple[Vector3, Vector3, Vector3]:
    """Return the parts of a vector that stay, and that go with cosine and sine of the angle."""
    vector = (x[0], x[1], x[2])
    along = _scaled(axis, _dot(axis, vector))
    return along, _difference(vector, along), cross(axis, vector)


def _dot(a: Vector3, b: Vector3) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _sum(a: Vector3, b: Vector3) -> Vector3:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _difference(a: Vector3, b: Vector3) -> Vector3:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _scaled(a: Vector3, factor: float) -> Vector3:
    return factor * a[0], factor * a[1], factor * a[2]
