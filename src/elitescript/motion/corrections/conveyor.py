"""Motion of the tool with a conveyor: along a straight line, or about the axis of a turntable.

A *way* of the conveyor (m, or rad of a turntable) carries a pose, commanded for a conveyor at rest, along with the
part. Poses and twists are those of the TCP in the base frame.
"""

from __future__ import annotations

from math import hypot, pi
from typing import Protocol

from elitescript.kinematics.rotations import Vector3, multiply, rotate, rotation_from_rotvec
from elitescript.kinematics.transforms import Transform, position_of, rotation_of, transform_from_pose
from elitescript.messages.motion import Six


class Conveyor(Protocol):
    """One conveyor."""

    way_per_count: float
    """m or rad for a count of its encoder."""

    def carried(self, T_base_tcp: Transform, way: float) -> Transform:
        """Return a pose after the conveyor has gone a way."""

    def carried_twist(self, twist: Six, T_base_carried: Transform, way: float, speed: float) -> Six:
        """Return the twist of a pose that moves with `twist` relative to the conveyor, which itself has a speed.

        Args:
            twist: as if the conveyor stood still in its first place.
            T_base_carried: what `carried` returned.
            way: of the conveyor, m or rad.
            speed: of the conveyor, m/s or rad/s.
        """

    def lever(self, T_base_tcp: Transform, equivalent_radius_m: float) -> float:
        """Return the way of the tool, m, for a unit of way of the conveyor.

        Args:
            T_base_tcp: pose of the tool.
            equivalent_radius_m: way that a radian of rotation counts for, m.
        """


class StraightConveyor:
    """A belt. A `Conveyor`.

    Args:
        direction: of travel, base frame; its length does not count.
        counts_per_m: counts of the encoder for a metre; negative if it counts against the direction.
    """

    __slots__ = ("_direction", "way_per_count")

    def __init__(self, direction: Vector3, counts_per_m: float) -> None:
        length = hypot(*direction)
        x, y, z = direction
        self._direction = (x / length, y / length, z / length)
        self.way_per_count = 1.0 / counts_per_m

    def carried(self, T_base_tcp: Transform, way: float) -> Transform:
        r11, r12, r13, r21, r22, r23, r31, r32, r33, x, y, z = T_base_tcp
        u, v, w = self._direction
        return r11, r12, r13, r21, r22, r23, r31, r32, r33, x + way * u, y + way * v, z + way * w

    def carried_twist(self, twist: Six, T_base_carried: Transform, way: float, speed: float) -> Six:
        vx, vy, vz, wx, wy, wz = twist
        u, v, w = self._direction
        return vx + speed * u, vy + speed * v, vz + speed * w, wx, wy, wz

    def lever(self, T_base_tcp: Transform, equivalent_radius_m: float) -> float:
        return 1.0


class Turntable:
    """A conveyor that turns about the z axis of its centre's frame. A `Conveyor`.

    Args:
        center: pose of the centre, base frame; positive counts turn about its z axis by the right-hand rule.
        counts_per_turn: counts of the encoder for a turn; negative if it counts the other way.
        turns_tool: whether the tool turns too, or keeps its orientation.
    """

    __slots__ = ("_axis", "_center", "_turns_tool", "way_per_count")

    def __init__(self, center: Six, counts_per_turn: float, turns_tool: bool) -> None:
        T_base_center = transform_from_pose(center)
        self._center = position_of(T_base_center)
        self._axis = (T_base_center[2], T_base_center[5], T_base_center[8])
        self._turns_tool = turns_tool
        self.way_per_count = 2.0 * pi / counts_per_turn

    def carried(self, T_base_tcp: Transform, way: float) -> Transform:
        kx, ky, kz = self._axis
        R = rotation_from_rotvec((kx * way, ky * way, kz * way))
        dx, dy, dz = rotate(R, self._arm_of(position_of(T_base_tcp)))
        cx, cy, cz = self._center
        rotation = rotation_of(T_base_tcp)
        return (*(multiply(R, rotation) if self._turns_tool else rotation), cx + dx, cy + dy, cz + dz)

    def carried_twist(self, twist: Six, T_base_carried: Transform, way: float, speed: float) -> Six:
        kx, ky, kz = self._axis
        R = rotation_from_rotvec((kx * way, ky * way, kz * way))
        vx, vy, vz = rotate(R, twist[:3])
        wx, wy, wz = twist[3:]
        if self._turns_tool:
            wx, wy, wz = rotate(R, (wx, wy, wz))
            wx, wy, wz = wx + speed * kx, wy + speed * ky, wz + speed * kz
        dx, dy, dz = self._arm_of(position_of(T_base_carried))
        return (
            vx + speed * (ky * dz - kz * dy),
            vy + speed * (kz * dx - kx * dz),
            vz + speed * (kx * dy - ky * dx),
            wx,
            wy,
            wz,
        )

    def lever(self, T_base_tcp: Transform, equivalent_radius_m: float) -> float:
        """See `Conveyor.lever`: the distance from the axis, or the rotation if that is more."""
        kx, ky, kz = self._axis
        dx, dy, dz = self._arm_of(position_of(T_base_tcp))
        distance = hypot(ky * dz - kz * dy, kz * dx - kx * dz, kx * dy - ky * dx)
        return max(distance, equivalent_radius_m)

    def _arm_of(self, point: Vector3) -> Vector3:
        x, y, z = point
        cx, cy, cz = self._center
        return x - cx, y - cy, z - cz
