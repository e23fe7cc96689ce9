"""Compares the force at the TCP with its limit, and tolerates it while an arm that presses too hard moves back."""

from __future__ import annotations

from math import hypot
from typing import Final

from elitescript.controller.force.wrench_sensor import WrenchSensor
from elitescript.controller.safety.monitor import Breach, SafetyMonitor
from elitescript.messages.enums import SafetyMode
from elitescript.messages.motion import Six
from elitescript.messages.yielding import ForceMode
from elitescript.said import said

FORCE_TOLERANCE: Final = 0.02
"""Share by which a tolerated force may grow before it is a breach (*assumed*)."""


class ForceWatch:
    """Compares the force at the TCP of one robot with its limit.

    Args:
        monitor: the limits.
        sensor: measures the force.
    """

    __slots__ = ("_known", "_monitor", "_sensor", "is_to_tolerate")

    def __init__(self, monitor: SafetyMonitor, sensor: WrenchSensor) -> None:
        self._monitor = monitor
        self._sensor = sensor
        self._known = 0.0
        self.is_to_tolerate = True
        """Whether a force above the limit is tolerated until it grows: at the start, and after a stop."""

    @property
    def is_watching(self) -> bool:
        """Whether anything can push the TCP."""
        return self._sensor.is_in_use

    def look(self, q: Six, qd: Six, mode: SafetyMode) -> tuple[Breach | None, str]:
        """Compare the force on joints (rad, rad/s) with its limit.

        Returns:
            The limit that is exceeded, and the warning for a tolerated force.
        """
        if not self.is_watching:
            return None, ""
        force = self._sensor.force(q, qd)
        breach = self._monitor.force_breach(force, mode)
        if breach is None:
            self._known = 0.0
        elif self.is_to_tolerate:
            self._known = force * (1.0 + FORCE_TOLERANCE)
            return None, said("{text}; the arm may move back out", text=breach.text)
        return (None if force <= self._known else breach), ""

    def caution(self, request: ForceMode, mode: SafetyMode) -> str:
        """Return the warning for a target force above the limit; empty otherwise."""
        rows = zip(request.target[:3], request.selection[:3], strict=True)
        force, limit = hypot(*[target for target, is_free in rows if is_free]), self._monitor.limits.tcp_force_max(mode)
        if force <= limit:
            return ""
        return said(
            "force_mode asks for {force:g} N; at more than {limit:g} N the arm stops protectively (tcp_force)",
            force=force,
            limit=limit,
        )
