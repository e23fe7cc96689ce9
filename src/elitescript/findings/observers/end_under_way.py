"""Finds motions that are under way when a program finishes: the arm brakes where it is."""

from __future__ import annotations

from collections.abc import Iterable
from math import degrees

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import MotionLeft


class EndUnderWay(Observer):
    """Tells how far the arm is from its target, how fast it is, or in which mode."""

    __slots__ = ()

    def see(self, seen: MotionLeft) -> Iterable[Finding]:
        """Tell of each motion."""
        command = seen.command
        if command in _MODES:
            mode, ends = _MODES[command]
            text, hint = f"the program ends {mode}", f"call {ends} before the end"
        elif seen.left_rad:
            text = (
                f"the program ends {seen.left_rad:.3f} rad ({degrees(seen.left_rad):.1f} deg) before the target of "
                f"{command}: the arm brakes where it is"
            )
            hint = "send the last target again until the arm is there, or end with movej to it"
        else:
            text = f"the program ends while {command} moves the arm, {seen.speed_rad_per_s:.3f} rad/s: it brakes"
            hint = f"stop the arm with {_STOPS.get(command, 'stopj')} before the end"
        yield found("W280", text, line=seen.line, thread=seen.thread, hint=hint)


_MODES = {
    "force_mode": ("in force mode", "end_force_mode"),
    "tracking": ("while the arm follows a conveyor", "stop_conveyor_tracking"),
}
"""By observation: what the arm is in, and what ends it."""
_STOPS = {"speedj": "stopj", "speedl": "stopl"}
