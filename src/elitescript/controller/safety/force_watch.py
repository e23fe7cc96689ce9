"""Compares the force at the TCP with its limit, and lets an arm that presses too hard back out."""

from __future__ import annotations

from math import hypot
from typing import Final

from elitescript.controller.force.wrench_sensor import WrenchSensor
from elitescript.controller.safety.monitor import Breach, SafetyMonitor
from elitescript.messages.enums import SafetyMode
from elitescript.messages.motion import Six
from elitescript.messages.yielding import ForceMode

FORCE_TOLERANCE: Final = 0.02
"""By how much, as a share, a force above its limit may grow after the arm has been allowed to move on (*assumed*)."""


class ForceWatch:
    """The force at the TCP of one robot.

    Args:
        monitor: knows the limits.
        sensor: the force.
    """

    __slots__ = ("_known", "_monitor", "_sensor", "is_to_tolerate")

    def __init__(self, monitor: SafetyMonitor, sensor: WrenchSensor) -> None:
        self._monitor = monitor
        self._sensor = sensor
        self._known = 0.0
        self.is_to_tolerate = True
        """Whether a force that is found now is left alone until it grows: at the start, and after a stop."""

    @property
    def is_watching(self) -> bool:
        """Whether anything can push the TCP."""
        return self._sensor.is_in_use

    def look(self, q: Six, qd: Six, mode: SafetyMode) -> tuple[Breach | None, str]:
        """Compare the force on joints (rad, rad/s) with its limit.

        Returns:
            The limit that is exceeded, and what to warn of, where the force is tolerated.
        """
        if not self.is_watching:
            return None, ""
        force = self._sensor.force(q, qd)
        breach = self._monitor.force_breach(force, mode)
        if breach is None:
            self._known = 0.0
        elif self.is_to_tolerate:
            self._known = force * (1.0 + FORCE_TOLERANCE)
            return None, f"{breach.text}; the arm may move back out"
        return (None if force <= self._known else breach), ""

    def caution(self, request: ForceMode, mode: SafetyMode) -> str:
        """Return what to say about a target force that the arm may not reach; empty where it may."""
        rows = zip(request.target[:3], request.selection[:3], strict=True)
        force, limit = hypot(*[target for target, is_free in rows if is_free]), self._monitor.limits.tcp_force_max(mode)
        if force <= limit:
            return ""
        return f"force_mode asks for {force:g} N; at more than {limit:g} N the arm stops protectively (tcp_force)"
