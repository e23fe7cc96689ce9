"""Simulates the force/torque sensor: contacts at the TCP, and the load at the flange.

All wrenches are those of the surroundings on the arm: an arm that presses down on a table reads an upward force.
`force_mode` has the opposite sign. (*Assumed*: the manual calls the one
the external force at the TCP and the other the force on the environment.)

A program can select a client's sensor instead (`ft_rtsi_input_enable`), also for force control.

The sensor is ideal. The payload of `set_payload` is the load at the flange (*assumed*), so the compensated wrench is
exactly that of the contacts.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import hypot

from elitescript.controller.force.contact import ContactConfig
from elitescript.controller.signals.image import SignalImage
from elitescript.controller.tool_setup import Setup
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.jacobian import tcp_twist
from elitescript.kinematics.rotations import Rotation, Vector3, multiply, rotate, transpose
from elitescript.kinematics.transforms import IDENTITY, Transform, position_of, rotation_of
from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX

_INSTANT_S = 1e-4
"""Accelerations are central differences of velocities over this time; the error is some 1e-8 of them."""


class WrenchSensor:
    """Computes wrenches for given joints; its only state is its zero.

    Args:
        arm: geometry.
        setup: TCP, payload and gravity.
        signals: for `external_wrench`, which pushes the TCP.
        contact: what the TCP can touch.
    """

    __slots__ = ("_arm", "_setup", "_signals", "client_offset", "contact", "zero")

    def __init__(self, arm: Arm, setup: Setup, signals: SignalImage, contact: ContactConfig) -> None:
        self._arm = arm
        self._setup = setup
        self._signals = signals
        self.contact = contact
        self.client_offset: Vector3 | None = None
        """Place of a client's sensor, flange frame, m; None while the arm's own is read."""
        self.zero: Six = ZERO_SIX
        """Wrench that `compensated` subtracts, TCP frame."""

    @property
    def external_wrench(self) -> Six:
        """Wrench on the TCP besides the contacts: N, N m, base frame."""
        a, b, c, d, e, f = map(float, self._signals.levels("external_wrench"))
        return (a, b, c, d, e, f)

    @property
    def is_in_use(self) -> bool:
        """Whether anything can push the TCP."""
        return bool(self.contact.planes) or self.external_wrench != ZERO_SIX

    def force(self, q: Six, qd: Six) -> float:
        """Return the force of all contacts on the TCP, N, for actual joints (rad, rad/s)."""
        return hypot(*self.external(q, qd)[:3])

    def external(self, q: Six, qd: Six) -> Six:
        """Return the wrench of all contacts on the TCP for actual joints (rad, rad/s), base frame."""
        if self.client_offset is not None:
            return self._client_reading(q, self.client_offset)
        if not self.contact.planes:
            return self.external_wrench
        T_flange_tcp = self._setup.T_flange_tcp
        p = position_of(self._arm.forward_tcp(q, T_flange_tcp))
        v = tcp_twist(self._arm, q, qd, T_flange_tcp)[:3]
        return self.contact.wrench(p, v, self.external_wrench)

    def _client_reading(self, q: Six, offset: Vector3) -> Six:
        """Return what a client's sensor reads, along the axes of the base frame, with moments about the TCP.

        Its axes are those of the flange, and what it sends is free of the weight of tool and sensor (*assumed*).
        """
        reading = [float(self._signals.read("external_force_torque", index)) for index in range(6)]
        T_base_tcp = self._arm.forward_tcp(q, self._setup.T_flange_tcp)
        R_base_flange = rotation_of(self._arm.forward(q))
        force, moment = rotate(R_base_flange, reading[:3]), rotate(R_base_flange, reading[3:])
        lever = _minus(position_of(self._arm.forward_tcp(q, (*IDENTITY[:9], *offset))), position_of(T_base_tcp))
        mx, my, mz = [about + swing for about, swing in zip(moment, _cross(lever, force), strict=True)]
        return (*force, mx, my, mz)

    def compensated(self, q: Six, qd: Six) -> Six:
        """Return the wrench without the payload and less the zero, in the TCP frame."""
        return self._tared(self._untared(q, qd))

    def compensated_in_base(self, q: Six, qd: Six) -> Six:
        """Return the compensated wrench along the axes of the base frame, moments about the TCP."""
        if self.zero == ZERO_SIX:
            return self.external(q, qd)
        return _turned(rotation_of(self._arm.forward_tcp(q, self._setup.T_flange_tcp)), self.compensated(q, qd))

    def raw(self, q: Six, qd: Six, qdd: Callable[[], Six]) -> Six:
        """Return the wrench with weight and inertia of the payload, not tared, in the TCP frame.

        Args:
            q: actual joints, rad.
            qd: their speeds, rad/s.
            qdd: computes their accelerations, rad/s^2; called only with a payload.
        """
        return self._loaded(self._untared(q, qd), q, qd, qdd)

    def readings(self, q: Six, qd: Six, qdd: Callable[[], Six]) -> tuple[Six, Six]:
        """Return `compensated` and `raw`; what they share is computed once."""
        untared = self._untared(q, qd)
        return self._tared(untared), self._loaded(untared, q, qd, qdd)

    def tare(self, q: Six, qd: Six) -> None:
        """Take the present wrench as zero."""
        self.zero = self._untared(q, qd)

    def _tared(self, untared: Six) -> Six:
        return untared if self.zero is ZERO_SIX else _difference(untared, self.zero)

    def _loaded(self, untared: Six, q: Six, qd: Six, qdd: Callable[[], Six]) -> Six:
        if self.client_offset is not None or self._setup.payload.mass_kg == 0.0:
            return untared
        load = self._payload_wrench(q, qd, qdd())
        a, b, c, d, e, f = [x + y for x, y in zip(untared, load, strict=True)]
        return (a, b, c, d, e, f)

    def _untared(self, q: Six, qd: Six) -> Six:
        external = self.external(q, qd)
        if external == ZERO_SIX:
            return ZERO_SIX
        R_base_tcp = rotation_of(self._arm.forward_tcp(q, self._setup.T_flange_tcp))
        return _turned(transpose(R_base_tcp), external)

    def _payload_wrench(self, q: Six, qd: Six, qdd: Six) -> Six:
        """Return the wrench of the payload on the flange, about the TCP and along its axes."""
        payload = self._setup.payload
        T_flange_com: Transform = (*IDENTITY[:9], *payload.cog)
        ax, ay, az, *alpha = self._acceleration(q, qd, qdd, T_flange_com)
        gx, gy, gz = self._setup.gravity
        m = payload.mass_kg
        force = (-m * (ax + gx), -m * (ay + gy), -m * (az + gz))
        T_base_com = self._arm.forward_tcp(q, T_flange_com)
        R_base_flange = rotation_of(T_base_com)
        T_base_tcp = self._arm.forward_tcp(q, self._setup.T_flange_tcp)
        lever = _minus(position_of(T_base_com), position_of(T_base_tcp))
        inertia = _in_base(R_base_flange, payload.inertia)
        omega = tcp_twist(self._arm, q, qd)[3:]
        spin = rotate(inertia, alpha)
        gyro = _cross(omega, rotate(inertia, omega))
        swing = _cross(lever, force)
        mx, my, mz = [s - t - g for s, t, g in zip(swing, spin, gyro, strict=True)]
        return _turned(transpose(rotation_of(T_base_tcp)), (*force, mx, my, mz))

    def _acceleration(self, q: Six, qd: Six, qdd: Six, T_flange_point: Transform) -> Six:
        """Return the acceleration of a point of the flange and angular acceleration, base frame."""
        before, after = [
            tcp_twist(
                self._arm,
                [a + h * w for a, w in zip(q, qd, strict=True)],
                [w + h * dw for w, dw in zip(qd, qdd, strict=True)],
                T_flange_point,
            )
            for h in (-_INSTANT_S, _INSTANT_S)
        ]
        a, b, c, d, e, f = [(y - x) / (2.0 * _INSTANT_S) for x, y in zip(before, after, strict=True)]
        return (a, b, c, d, e, f)


def _turned(R: Rotation, wrench: Sequence[float]) -> Six:
    return (*rotate(R, wrench[:3]), *rotate(R, wrench[3:]))


def _difference(one: Six, other: Six) -> Six:
    a, b, c, d, e, f = [x - y for x, y in zip(one, other, strict=True)]
    return (a, b, c, d, e, f)


def _minus(a: Vector3, b: Vector3) -> Vector3:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _cross(a: Sequence[float], b: Sequence[float]) -> Vector3:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _in_base(R: Rotation, inertia: Six) -> Rotation:
    """Return a tensor of the flange frame along the axes of the base frame."""
    xx, yy, zz, xy, xz, yz = inertia
    return multiply(multiply(R, (xx, xy, xz, xy, yy, yz, xz, yz, zz)), transpose(R))
