"""Laws of `force_mode`: speed with which the TCP yields, and the force frame.

The speed along each selected axis goes towards gain * (target - exerted), the admittance. A surface of stiffness k
answers with a force that grows by k times the way, so the force settles at the target whatever k is, with the time
constant 1 / (gain * k). One control period is the delay of the loop; from it follows that the loop is stable as long
as gain * k * period stays below 2. The unit of the gain is chosen so that gain scaling 1 is the limit for a hard
surface (1e5 N/m), of which the manual warns, and the initial 0.2 leaves a factor of five.

Damping slows an axis without contact down: with 0 it keeps its speed, with 1 it stops within some periods. In contact
the surface does so.

The laws and their numbers are *assumed*; the manual describes only the effect of scaling and damping on a program.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot
from typing import Final

from elitescript.kinematics.rotations import Rotation, Vector3, cross, from_columns, rotate, transpose
from elitescript.kinematics.transforms import Transform, position_of, rotation_of
from elitescript.messages.motion import Six
from elitescript.records import NamedTuple

GAIN: Final[Six] = (0.005, 0.005, 0.005, 0.5, 0.5, 0.5)
"""Speed for each unit of missing force at gain scaling 1: (m/s)/N, (rad/s)/(N m). *Assumed.*"""

FOLLOWING: Final = 0.8
"""Share of a wanted change of speed that is made in one control period. *Assumed.*"""

FIRM: Final[Six] = (1.0, 1.0, 1.0, 0.1, 0.1, 0.1)
"""Force or torque from which on a contact damps in full: N, N m. *Assumed.*"""

TRAVEL_MIN: Final = 1e-6
"""Speed of the TCP, m/s, below which it has no direction of travel."""


class ForceLaw(NamedTuple):
    """Law of the axes under force control; six elements, along and about the axes of the force frame."""

    selection: tuple[bool, ...]
    target: Six
    """Wrench that the arm is to exert: N, N m."""
    speed_limits: Six
    """m/s, rad/s; all >= 0."""
    gain_scaling: float
    damping: float

    def speeds(self, before: Sequence[float], exerted: Sequence[float]) -> Six:
        """Return the speeds of the next period, m/s and rad/s.

        Args:
            before: present speeds; those of axes that are not selected do not count.
            exerted: wrench that the arm exerts at present.
        """
        a, b, c, d, e, f = [
            self._speed(axis, v, force) if is_selected else 0.0
            for axis, (is_selected, v, force) in enumerate(zip(self.selection, before, exerted, strict=True))
        ]
        return (a, b, c, d, e, f)

    def _speed(self, axis: int, v: float, force: float) -> float:
        missing = self.target[axis] - force
        limit = self.speed_limits[axis]
        wanted = max(-limit, min(limit, self.gain_scaling * GAIN[axis] * missing))
        change = wanted - v
        if change * missing > 0.0 or abs(v) > limit:
            return v + FOLLOWING * change
        return v + FOLLOWING * max(self.damping, min(1.0, abs(force) / FIRM[axis])) * change


class ForceFrame(NamedTuple):
    """Force frame and the mode in which it follows the arm; see `force_mode` (manual 2.14, 4.1)."""

    mode: int
    """0 fixed, 1 point, 2 motion, 3 TCP."""
    T_base_reference: Transform

    def at_start(self) -> Rotation:
        """Return the axes at the start."""
        return rotation_of(self.T_base_reference)

    def axes(self, T_base_tcp: Transform, velocity: Sequence[float], before: Rotation) -> Rotation:
        """Return the axes of the force frame in the base frame.

        Args:
            T_base_tcp: pose of the TCP.
            velocity: of the TCP, m/s, base frame.
            before: the axes of the period before; they stay where position or velocity define no direction.
        """
        if self.mode == 1:
            return self._towards_point(T_base_tcp, before)
        if self.mode == 2:
            return self._along_travel(velocity, before)
        return rotation_of(T_base_tcp if self.mode == 3 else self.T_base_reference)

    def _towards_point(self, T_base_tcp: Transform, before: Rotation) -> Rotation:
        """Return axes with y towards the point, and x as near as possible to that of the period before (*assumed*)."""
        (x, y, z), (ox, oy, oz) = position_of(T_base_tcp), position_of(self.T_base_reference)
        y_axis = (ox - x, oy - y, oz - z)
        if hypot(*y_axis) < TRAVEL_MIN:
            return before
        y_axis = _unit(y_axis)
        x_axis, z_axis = _column(before, 0), _column(before, 2)
        across = cross(x_axis, y_axis)
        z_axis = _unit(across) if hypot(*across) > 1e-3 else _unit(cross(cross(y_axis, z_axis), y_axis))
        return from_columns(cross(y_axis, z_axis), y_axis, z_axis)

    def _along_travel(self, velocity: Sequence[float], before: Rotation) -> Rotation:
        R = rotation_of(self.T_base_reference)
        vx, vy, _ = rotate(transpose(R), velocity)
        if hypot(vx, vy) < TRAVEL_MIN:
            return before
        x_axis = rotate(R, _unit((vx, vy, 0.0)))
        z_axis = _column(R, 2)
        return from_columns(x_axis, cross(z_axis, x_axis), z_axis)


def along_axes(R: Rotation, six: Sequence[float]) -> Six:
    """Return the elements of a twist or wrench of the base frame along the axes R."""
    R_inverse = transpose(R)
    return (*rotate(R_inverse, six[:3]), *rotate(R_inverse, six[3:]))


def in_base(R: Rotation, six: Sequence[float]) -> Six:
    """Return in the base frame a twist or wrench that is given along the axes R."""
    return (*rotate(R, six[:3]), *rotate(R, six[3:]))


def selected(R: Rotation, selection: Sequence[bool], six: Sequence[float]) -> Six:
    """Return the part of a twist of the base frame along and about the selected ones of the axes R."""
    a, b, c, d, e, f = [
        value if is_selected else 0.0 for value, is_selected in zip(along_axes(R, six), selection, strict=True)
    ]
    return in_base(R, (a, b, c, d, e, f))


def _column(R: Rotation, index: int) -> Vector3:
    return R[index], R[index + 3], R[index + 6]


def _unit(v: Vector3) -> Vector3:
    x, y, z = v
    length = hypot(x, y, z)
    return x / length, y / length, z / length
