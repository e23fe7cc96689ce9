"""Simulates contacts of the TCP: planes that push it back.

A plane is a spring with a damper, without edges or a far side. The TCP is a point, so a plane gives a force and no
torque. Forces of several planes, which make a corner or a socket, add up.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import hypot, isfinite
from typing import Any, Final

from elitescript.errors import UsageError
from elitescript.kinematics.rotations import Vector3
from elitescript.messages.motion import Six
from elitescript.records import field, record
from elitescript.said import said

SLIDING_M_S: Final = 1e-3
"""Below this speed friction falls to zero in proportion, so that a point at rest is not pushed (*assumed*)."""


@record
class Plane:
    """A flat surface in the base frame.

    Args:
        point: any point of it, m.
        normal: direction towards the side where the TCP is free; of any length.
        stiffness: N/m.
        damping: N s/m; it never pulls.
        friction: ratio of the friction's force to the force along the normal.

    Raises:
        UsageError: an invalid number.
    """

    point: Vector3
    normal: Vector3
    stiffness: float = 1e5
    damping: float = 0.0
    friction: float = 0.0
    direction: Vector3 = field(init=False, repr=False, compare=False)
    """The normal with length 1."""

    def __post_init__(self) -> None:
        for name in ("point", "normal"):
            values = getattr(self, name)
            if len(values) != 3 or not all(map(isfinite, values)):
                raise UsageError(f"{name} of a contact plane needs three finite numbers, has {values!r}")
        length = hypot(*self.normal)
        if not length > 0.0:
            raise UsageError("normal of a contact plane has no direction: it is [0, 0, 0]")
        if not (isfinite(self.stiffness) and self.stiffness > 0.0):
            raise UsageError(f"stiffness of a contact plane must be > 0 N/m, got {self.stiffness!r}")
        for name, unit in (("damping", " N s/m"), ("friction", "")):
            value = getattr(self, name)
            if not (isfinite(value) and value >= 0.0):
                raise UsageError(f"{name} of a contact plane must be >= 0{unit}, got {value!r}")
        x, y, z = self.normal
        object.__setattr__(self, "direction", (x / length, y / length, z / length))

    def force(self, p: Sequence[float], v: Sequence[float]) -> Vector3:
        """Return the force on a point, N, for its position, m, and velocity, m/s, in the base frame."""
        nx, ny, nz = self.direction
        depth = -(nx * (p[0] - self.point[0]) + ny * (p[1] - self.point[1]) + nz * (p[2] - self.point[2]))
        if depth <= 0.0:
            return 0.0, 0.0, 0.0
        v_out = nx * v[0] + ny * v[1] + nz * v[2]
        push = max(0.0, self.stiffness * depth - self.damping * v_out)
        fx, fy, fz = push * nx, push * ny, push * nz
        if self.friction:
            sx, sy, sz = v[0] - v_out * nx, v[1] - v_out * ny, v[2] - v_out * nz
            share = self.friction * push / max(hypot(sx, sy, sz), SLIDING_M_S)
            fx, fy, fz = fx - share * sx, fy - share * sy, fz - share * sz
        return fx, fy, fz


@record
class ContactConfig:
    """Everything fixed that the TCP can touch."""

    planes: tuple[Plane, ...] = ()

    def wrench(self, p: Sequence[float], v: Sequence[float], external: Six) -> Six:
        """Return the wrench on the TCP, N and N m, base frame, moments about the TCP.

        Args:
            p: position of the TCP, m, base frame.
            v: its velocity, m/s.
            external: wrench from outside: N, N m, base frame.
        """
        fx, fy, fz, mx, my, mz = external
        for plane in self.planes:
            gx, gy, gz = plane.force(p, v)
            fx, fy, fz = fx + gx, fy + gy, fz + gz
        return fx, fy, fz, mx, my, mz

    @classmethod
    def from_table(cls, table: Mapping[str, Any]) -> ContactConfig:
        """Read the `[contact]` section of a world file: a list `planes` of tables with the fields of `Plane`.

        Raises:
            UsageError: an unknown or missing key, or an invalid value, with its place.
        """
        _require_known("[contact]", table, ("planes",), ())
        rows = table.get("planes", [])
        if not isinstance(rows, list) or not all(isinstance(row, Mapping) for row in rows):
            raise UsageError("[contact] planes must be tables, written as [[contact.planes]]")
        return cls(
            tuple(
                [
                    _plane_from(said("[[contact.planes]] {number}:", number=number), row)
                    for number, row in enumerate(rows, 1)
                ]
            )
        )


_KEYS: Final = ("point", "normal", "stiffness", "damping", "friction")


def _plane_from(place: str, row: Mapping[str, Any]) -> Plane:
    _require_known(place, row, _KEYS, ("point", "normal"))
    values: dict[str, Any] = {}
    for key, raw in row.items():
        numbers = raw if key in ("point", "normal") else [raw]
        if not isinstance(numbers, list) or not all(_is_number(value) for value in numbers):
            raise UsageError(f"{place} {key} must be {'three numbers' if raw is numbers else 'a number'}, got {raw!r}")
        values[key] = tuple(map(float, numbers)) if raw is numbers else float(raw)
    try:
        return Plane(**values)
    except UsageError as error:
        raise UsageError(f"{place} {error}") from None


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _require_known(place: str, table: Mapping[str, Any], known: Sequence[str], required: Sequence[str]) -> None:
    for key in table:
        if key not in known:
            raise UsageError(f"{place} {key} is no key here; there are {', '.join(known)}")
    for key in required:
        if key not in table:
            raise UsageError(f"{place} {key} is missing")
