"""Keeps motions below the speeds of reduced mode, so that a program for normal mode runs on, slower (*assumed*).

Motions are planned as in normal mode. A planned move runs as planned wherever that is slow enough; where it is not,
its time is scaled so that it runs at the limit; it takes up its own speed when reduced mode ends. A motion at a speed
runs at the share of its speed that the limits allow, in the same direction. Streams of `servoj` and conveyor tracking
are not slowed; the arm is stopped when they are too fast.
"""

from __future__ import annotations

from typing import Final

from elitescript.controller.force.compliance_control import ComplianceControl
from elitescript.controller.motion.control import MotionControl
from elitescript.controller.motion.joint_drive import Drive
from elitescript.controller.motion.sources import Move
from elitescript.controller.safety.monitor import SPEED_TOLERANCE, SafetyMonitor
from elitescript.controller.tool_setup import Setup
from elitescript.errors import ArgumentRangeError
from elitescript.messages.enums import SafetyMode
from elitescript.messages.motion import Six
from elitescript.messages.timing import PERIOD_S, ticks_for
from elitescript.said import said

SLOWED_MODES: Final = (SafetyMode.REDUCED, SafetyMode.RECOVERY)

GRACE_TICKS: Final = ticks_for(0.5)
"""Time to brake from the change to reduced mode until its speed limits hold (*assumed*)."""

SAMPLES: Final = 64
"""Places of a motion at a speed at which it is compared with the limits."""

MARGIN: Final = 0.99
"""Share of a limit that motions are slowed down to; between two samples they may be a little faster."""

_ROUNDS: Final = 3
"""Iterations for the rate of a period, which depends on the place that it leads to."""


class ReducedSpeed:
    """Applies the speed percentage and its reduction.

    Args:
        monitor: the limits.
        motion: the nominal motion.
        yielding: force mode and hand guiding.
        setup: the active TCP.
        scale: speed percentage at the start, as a fraction.
    """

    __slots__ = ("_cap", "_is_move_slowed", "_monitor", "_motion", "_setup", "_yielding", "scale")

    def __init__(
        self,
        monitor: SafetyMonitor,
        motion: MotionControl,
        yielding: ComplianceControl,
        setup: Setup,
        scale: float,
    ) -> None:
        self._monitor = monitor
        self._motion = motion
        self._yielding = yielding
        self._setup = setup
        self._cap = 1.0
        self._is_move_slowed = False
        self.scale = scale

    def set_scale(self, fraction: float, tick: int) -> None:
        """Set the speed percentage, as a fraction.

        Raises:
            ArgumentRangeError: outside [0, 1].
        """
        if not 0.0 <= fraction <= 1.0:
            text = said("the speed percentage must be in [0, 1], got {fraction:g}", fraction=fraction)
            raise ArgumentRangeError(text, value=fraction, limit="[0, 1]")
        self.scale = fraction
        self._motion.set_speed_scale(min(fraction, self._cap), tick)

    def enter(self, mode: SafetyMode, tick: int) -> None:
        """Apply the limits of a mode in which the arm may move."""
        is_slowed = mode in SLOWED_MODES
        self._yielding.limit_speed(self._monitor.limits.bounds(mode).tcp_speed_max if is_slowed else None)
        if not is_slowed:
            self.release(tick)

    def release(self, tick: int) -> None:
        """End the reduction: the motion or reduced mode is over."""
        if self._cap != 1.0 or self._is_move_slowed:
            self._cap = 1.0
            self._is_move_slowed = False
            self._motion.set_speed_scale(self.scale, tick)

    def slow_down(self, tick: int) -> bool:
        """Reduce the speed of the motion; return whether it is slower than in normal mode. Called in every tick."""
        source = self._motion.source
        if isinstance(source, Move):
            if self._cap != 1.0:
                self.release(tick)
            return self._slow_move(source, tick)
        cap = 1.0
        if isinstance(source, Drive):
            share = max([self._share(*state) for state in source.at_full_speed(tick, SAMPLES)] or [0.0])
            cap = MARGIN / share if share > 1.0 + SPEED_TOLERANCE else 1.0
        if cap != self._cap:
            self._cap = cap
            self._motion.set_speed_scale(min(self.scale, cap), tick)
        return self._cap < self.scale

    def _slow_move(self, move: Move, tick: int) -> bool:
        if self._motion.is_paused or move.is_stopping or tick < move.start_tick:
            return False
        now_s = tick * PERIOD_S
        rate, path_time_s = move.scale.rate(now_s), move.path_time_s(tick)
        planned = move.segment.setpoint(path_time_s)
        share = self._share(*planned)
        wanted, share_ahead, ahead = rate, share, planned
        for _ in range(_ROUNDS):
            ahead = move.segment.setpoint(path_time_s + 0.5 * (rate + wanted) * PERIOD_S)
            share_ahead = self._share(*ahead)
            before, wanted = wanted, min(self.scale, MARGIN / share_ahead) if share_ahead > MARGIN else self.scale
            if wanted == before:
                break
        if not self._is_move_slowed and wanted >= min(self.scale, move.scale.rate(now_s + PERIOD_S)):
            return False
        self._is_move_slowed = wanted < self.scale or rate < self.scale
        # Keep the speed, and change it no faster than a new speed percentage may.
        level = min(rate * share / share_ahead, self.scale) if share_ahead > 0.0 else wanted
        most = PERIOD_S / self._motion.speed_ramp_s
        wanted = max(level - most, min(level + most, wanted))
        self._motion.path_rate(self._possible(rate, planned.qd, wanted, ahead.qd), tick)
        return True

    def _possible(self, rate: float, qd: Six, wanted: float, qd_ahead: Six) -> float:
        """Return the rate nearest to the wanted one that the joints can reach within a period."""
        low, high = 0.0, 1.0
        for w, w_ahead, limit in zip(qd, qd_ahead, self._motion.limits.qdd_max, strict=True):
            if w_ahead:
                room = MARGIN * limit * PERIOD_S / abs(w_ahead)
                level = rate * w / w_ahead
                low, high = max(low, level - room), min(high, level + room)
        return max(low, min(high, wanted)) if low <= high else rate

    def _share(self, q: Six, qd: Six) -> float:
        return self._monitor.speed_share(q, qd, self._setup.T_flange_tcp, SafetyMode.REDUCED)
