"""Inverse dynamics: the joint torques of a motion.

Recursive Newton-Euler over the link frames of the modified Denavit-Hartenberg form (Luh, Walker and Paul 1980; Craig,
*Introduction to Robotics*, chapter 6): velocities and accelerations go outwards from the base, forces and moments
come back from the flange. The links are rigid. Rotor inertia, friction and the losses of the gears are left out,
because nothing is published about them.

Every body is taken about the origin of its frame instead of its centre of mass. With mass m, first moment h = m c and
inertia J about the origin, force and moment at the origin are

    F = m a + wd x h + w x (w x h)
    N = J wd + w x (J w) + h x a

for the acceleration a of the origin, the angular velocity w and the angular acceleration wd. What is fixed to the same
frame then simply adds up, and so does a payload to the last link.

Gravity enters as the acceleration of the base: a base that is accelerated upwards feels the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import cos, isfinite, sin
from typing import NamedTuple, TypeAlias

from elitescript.errors import UsageError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.limits import SixFloats
from elitescript.kinematics.rotations import Vector3

MassRow: TypeAlias = tuple[float, float, float, float, float, float, float, float, float, float]
"""Mass, kg; first moment x, y, z, kg m; inertia Jxx, Jyy, Jzz, Jxy, Jxz, Jyz about the frame's origin, kg m^2."""


class MassChain(NamedTuple):
    """Frames and masses of an arm with its payload."""

    frames: tuple[tuple[float, float, float, float, float], ...]
    """Of each link: length, and offset along y and z of the frame before, m; cosine and sine of the twist."""
    rows: tuple[MassRow, ...]


@dataclass(frozen=True, slots=True)
class RigidBody:
    """A rigid body fixed to a link frame, or to the flange.

    Args:
        mass: kg.
        com: centre of mass in the frame, m.
        inertia: elements Ixx, Iyy, Izz, Ixy, Ixz, Iyz of the tensor about the centre of mass, axes parallel to the
            frame, kg m^2. Elements of the tensor: Ixy is minus the integral of x y dm.

    Raises:
        UsageError: a mass that is negative, a number that is not finite, or not three and six of them.
    """

    mass: float
    com: Vector3 = (0.0, 0.0, 0.0)
    inertia: SixFloats = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    about_origin: MassRow = field(init=False, repr=False, compare=False)
    """The same about the origin of the frame, by Steiner's theorem."""

    def __post_init__(self) -> None:
        for name, values, count in (("mass", (self.mass,), 1), ("com", self.com, 3), ("inertia", self.inertia, 6)):
            if len(values) != count:
                raise UsageError(f"{name} of a body needs {count} numbers; it has {len(values)}")
            for value in values:
                if not isfinite(value):
                    raise UsageError(f"{name} of a body holds {value}; it has to be finite")
        if self.mass < 0.0:
            raise UsageError(f"mass of a body is {self.mass} kg; it cannot be negative")
        m = self.mass
        x, y, z = self.com
        ixx, iyy, izz, ixy, ixz, iyz = self.inertia
        row = (
            m,
            m * x,
            m * y,
            m * z,
            ixx + m * (y * y + z * z),
            iyy + m * (x * x + z * z),
            izz + m * (x * x + y * y),
            ixy - m * x * y,
            ixz - m * x * z,
            iyz - m * y * z,
        )
        object.__setattr__(self, "about_origin", row)


def joint_torques(
    arm: Arm,
    bodies: Sequence[RigidBody],
    q: Sequence[float],
    qd: Sequence[float],
    qdd: Sequence[float],
    gravity: Sequence[float],
    payload: RigidBody | None = None,
) -> SixFloats:
    """Return the torques that the joints apply, N m, positive about the joint.

    Args:
        arm: geometry; calibrated arms too.
        bodies: the six links that move, shoulder to wrist 3, each in its link frame.
        q: joint angles, rad.
        qd: joint speeds, rad/s.
        qdd: joint accelerations, rad/s^2.
        gravity: acceleration that the base feels, m/s^2 in the base frame; it points away from the earth, as the
            vector of `set_gravity` does (manual 2.10 chapter 2.1.15).
        payload: load on the flange, in the flange frame.
    """
    return torques_of(mass_chain(arm, bodies, payload), q, qd, qdd, gravity)


def mass_chain(arm: Arm, bodies: Sequence[RigidBody], payload: RigidBody | None = None) -> MassChain:
    """Return what `torques_of` needs of an arm, its links and its payload; see `joint_torques`."""
    rows = [body.about_origin for body in bodies]
    if payload is not None:
        own, carried = rows[5], payload.about_origin
        rows[5] = (
            own[0] + carried[0],
            own[1] + carried[1],
            own[2] + carried[2],
            own[3] + carried[3],
            own[4] + carried[4],
            own[5] + carried[5],
            own[6] + carried[6],
            own[7] + carried[7],
            own[8] + carried[8],
            own[9] + carried[9],
        )
    links = _nominal_links(arm) if arm.calibration is None else arm.calibration.links
    return MassChain(
        tuple([(length, -sa * offset, ca * offset, ca, sa) for length, offset, ca, sa in links]), tuple(rows)
    )


def torques_of(
    chain: MassChain, q: Sequence[float], qd: Sequence[float], qdd: Sequence[float], gravity: Sequence[float]
) -> SixFloats:
    """Return the torques that the joints apply, N m; see `joint_torques`."""
    # Outwards. w, wd: angular velocity and acceleration of the frame; a: acceleration of its origin, all in the frame.
    wx = wy = wz = ex = ey = ez = 0.0
    ax, ay, az = gravity
    loads = []
    for (length, py, pz, ca, sa), angle, speed, acceleration, row in zip(
        chain.frames, q, qd, qdd, chain.rows, strict=True
    ):
        c = cos(angle)
        s = sin(angle)
        # The origin of this frame, still in the axes of the one before: a + wd x p + w x (w x p).
        ux = wy * pz - wz * py
        uy = wz * length - wx * pz
        uz = wx * py - wy * length
        bx = ax + ey * pz - ez * py + wy * uz - wz * uy
        by = ay + ez * length - ex * pz + wz * ux - wx * uz
        bz = az + ex * py - ey * length + wx * uy - wy * ux
        # Into the axes of this frame: back by the twist, then by the joint angle.
        t = ca * by + sa * bz
        ax, ay, az = c * bx + s * t, c * t - s * bx, ca * bz - sa * by
        t = ca * wy + sa * wz
        wx, wy, wz = c * wx + s * t, c * t - s * wx, ca * wz - sa * wy
        t = ca * ey + sa * ez
        ex, ey, ez = c * ex + s * t + wy * speed, c * t - s * ex - wx * speed, ca * ez - sa * ey + acceleration
        wz += speed
        m, hx, hy, hz, jxx, jyy, jzz, jxy, jxz, jyz = row
        ux = wy * hz - wz * hy
        uy = wz * hx - wx * hz
        uz = wx * hy - wy * hx
        lx = jxx * wx + jxy * wy + jxz * wz
        ly = jxy * wx + jyy * wy + jyz * wz
        lz = jxz * wx + jyz * wy + jzz * wz
        loads.append(
            (
                c,
                s,
                m * ax + ey * hz - ez * hy + wy * uz - wz * uy,
                m * ay + ez * hx - ex * hz + wz * ux - wx * uz,
                m * az + ex * hy - ey * hx + wx * uy - wy * ux,
                jxx * ex + jxy * ey + jxz * ez + wy * lz - wz * ly + hy * az - hz * ay,
                jxy * ex + jyy * ey + jyz * ez + wz * lx - wx * lz + hz * ax - hx * az,
                jxz * ex + jyz * ey + jzz * ez + wx * ly - wy * lx + hx * ay - hy * ax,
            )
        )

    # Inwards. f, n: force and moment that the link before applies at the origin of this frame.
    fx = fy = fz = nx = ny = nz = 0.0
    torques = []
    for (length, py, pz, ca, sa), load in zip(reversed(chain.frames), reversed(loads), strict=True):
        c, s, load_fx, load_fy, load_fz, load_nx, load_ny, load_nz = load
        fx += load_fx
        fy += load_fy
        fz += load_fz
        nx += load_nx
        ny += load_ny
        nz += load_nz
        torques.append(nz)
        t = s * fx + c * fy
        fx, fy, fz = c * fx - s * fy, ca * t - sa * fz, sa * t + ca * fz
        t = s * nx + c * ny
        nx, ny, nz = (
            c * nx - s * ny + py * fz - pz * fy,
            ca * t - sa * nz + pz * fx - length * fz,
            sa * t + ca * nz + length * fy - py * fx,
        )
    t6, t5, t4, t3, t2, t1 = torques
    return t1, t2, t3, t4, t5, t6


def _nominal_links(arm: Arm) -> tuple[tuple[float, float, float, float], ...]:
    """Return (a, d, cos alpha, sin alpha) of each link, with sine and cosine of the right angles exact."""
    return (
        (0.0, arm.d1, 1.0, 0.0),
        (0.0, 0.0, 0.0, 1.0),
        (arm.a2, 0.0, 1.0, 0.0),
        (arm.a3, arm.d4, 1.0, 0.0),
        (0.0, arm.d5, 0.0, 1.0),
        (0.0, arm.d6, 0.0, -1.0),
    )
