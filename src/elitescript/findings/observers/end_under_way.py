"""Finds motions that are under way when a program finishes: the arm brakes where it is."""

from __future__ import annotations

from collections.abc import Iterable
from math import degrees

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import MotionLeft
from elitescript.said import Said, said


class EndUnderWay(Observer):
    """Tells how far the arm is from its target, how fast it is, or in which mode."""

    __slots__ = ()

    def see(self, seen: MotionLeft) -> Iterable[Finding]:
        """Tell of each motion."""
        command = seen.command
        if command in _MODES:
            mode, ends = _MODES[command]
            text, hint = said("the program ends {mode}", mode=mode), said("call {command} before the end", command=ends)
        elif seen.left_rad:
            text = said(
                "the program ends {left_rad:.3f} rad ({left_deg:.1f} deg) before the target of "
                "{command}: the arm brakes where it is",
                left_rad=seen.left_rad,
                left_deg=degrees(seen.left_rad),
                command=command,
            )
            hint = "send the last target again until the arm is there, or end with movej to it"
        else:
            text = said(
                "the program ends while {command} moves the arm, {speed_rad_per_s:.3f} rad/s: it brakes",
                command=command,
                speed_rad_per_s=seen.speed_rad_per_s,
            )
            hint = said("stop the arm with {command} before the end", command=_STOPS.get(command, "stopj"))
        yield found("W280", text, line=seen.line, thread=seen.thread, hint=hint)


_MODES = {
    "force_mode": (Said("in force mode"), "end_force_mode"),
    "tracking": (Said("while the arm follows a conveyor"), "stop_conveyor_tracking"),
}
"""By observation: what the arm is in, and what ends it."""
_STOPS = {"speedj": "stopj", "speedl": "stopl"}
