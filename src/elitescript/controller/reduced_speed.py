"""Keeps motions below the speeds of reduced mode, so that a program for normal mode runs on, slower (*assumed*).

The limits with which motions are planned are lowered (`SafetyLimits.lowered`), which holds every speed but that of the
TCP in joint motions; here `movej` is slowed down for it, and so is what is under way when the mode changes.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from elitescript.controller.arm_state import ArmState
from elitescript.controller.motion_control import MotionControl
from elitescript.controller.safety_monitor import SPEED_TOLERANCE, SafetyMonitor
from elitescript.controller.setup import Setup
from elitescript.messages.enums import SafetyMode
from elitescript.messages.motion import MotionRequest, MoveJ, Six

SLOWED_MODES: Final = (SafetyMode.REDUCED, SafetyMode.RECOVERY)

SAMPLES: Final = 64
"""Places of a motion at which its speeds are compared with the limits."""

MARGIN: Final = 0.99
"""Share of a limit that motions are slowed down to: between two samples they may be a little faster."""


class ReducedSpeed:
    """The speed percentage, and what reduced mode leaves of it.

    Args:
        monitor: knows the limits.
        motion: the nominal motion.
        arm_state: target and actual joints.
        setup: the active TCP.
        scale: speed percentage at the start, as a fraction.
    """

    __slots__ = ("_arm_state", "_cap", "_monitor", "_motion", "_setup", "scale")

    def __init__(
        self, monitor: SafetyMonitor, motion: MotionControl, arm_state: ArmState, setup: Setup, scale: float
    ) -> None:
        self._monitor = monitor
        self._motion = motion
        self._arm_state = arm_state
        self._setup = setup
        self._cap = 1.0
        self.scale = scale

    def set_scale(self, fraction: float, tick: int) -> None:
        """New speed percentage."""
        self.scale = fraction
        self._motion.set_speed_scale(fraction * self._cap, tick)

    def release(self, tick: int) -> None:
        """The motion that was slowed down is over, or reduced mode is."""
        if self._cap != 1.0:
            self._cap = 1.0
            self._motion.set_speed_scale(self.scale, tick)

    def slow_down(self, tick: int) -> None:
        """Lower the speed so that the motions under way keep the limits at any speed percentage.

        It does not count how fast they are at this moment, so it may be asked for again at any time.
        """
        sources = self._motion.under_way
        share = max([self._share(*state) for source in sources for state in source.at_full_speed(tick, SAMPLES)] or [0])
        cap = MARGIN / share if share > 1.0 + SPEED_TOLERANCE else 1.0
        if cap != self._cap:
            self._cap = cap
            self._motion.set_speed_scale(self.scale * cap, tick)

    def prepared(self, request: MotionRequest, tick: int) -> MotionRequest:
        """A joint motion with a speed at which the TCP keeps its limit; any other request as it is."""
        if not isinstance(request, MoveJ):
            return request
        rest_tick = self._motion.next_tick if self._arm_state.is_moving else None
        q_start = self._motion.sample(tick if rest_tick is None else rest_tick).q
        way = [end - start for start, end in zip(q_start, request.q_target, strict=True)]
        length = max(map(abs, way))
        if length == 0.0:
            return request
        slope = _six([part / length for part in way])
        share = max(
            self._share(_six([q + length * k / SAMPLES * part for q, part in zip(q_start, slope, strict=True)]), slope)
            for k in range(SAMPLES + 1)
        )
        if share == 0.0:
            return request
        v_max = MARGIN / share
        # A move of given duration is nowhere faster than twice its mean speed.
        t_s = max(request.t_s, 2.0 * length / v_max) if request.t_s > 0.0 else 0.0
        return replace(request, v=min(request.v, v_max), t_s=t_s)

    def _share(self, q: Six, qd: Six) -> float:
        return self._monitor.speed_share(q, qd, self._setup.T_flange_tcp, SafetyMode.REDUCED)


def _six(values: list[float]) -> Six:
    a, b, c, d, e, f = values
    return (a, b, c, d, e, f)
