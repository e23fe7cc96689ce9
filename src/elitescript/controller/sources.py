"""What can move the arm: a planned move, a braking, a motion that goes on until something else is asked for.

A *source* says where the arm is at any tick from its own beginning up to `due_tick`, the next tick at which
anything about it changes by itself. `MotionControl` holds one at a time. A source in closed form is due rarely; one
that goes from period to period (`stepped_drives`) is due at every tick while it moves.
"""

from __future__ import annotations

from math import isinf
from typing import Final, Protocol

from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX
from elitescript.messages.timing import PERIOD_S, ticks_for
from elitescript.motion.segment import Segment, Setpoint
from elitescript.motion.speed import SpeedProfile
from elitescript.motion.timescale import TimeScale

NEVER: Final = 1 << 62
"""Tick of what does not happen by itself."""


class Source(Protocol):
    """What moves the arm at present."""

    number: int
    """Of the call that asked for it."""
    thread: str
    is_stopping: bool
    """Whether it comes to rest and cannot do anything else any more."""
    reaches_end: bool
    """Whether it comes to rest where it was meant to."""

    @property
    def end_tick(self) -> int:
        """Tick at which the arm rests; NEVER while that is not known."""

    @property
    def due_tick(self) -> int:
        """Next tick at which something changes by itself."""

    @property
    def q_rest(self) -> Six:
        """Where the arm rests at `end_tick`, rad."""

    def setpoint(self, tick: float) -> Setpoint:
        """Target joints at a tick up to `due_tick`: rad, rad/s."""

    def is_awaited(self, number: int) -> bool:
        """Whether the call of that number is not over."""


class Move:
    """One accepted move, from its start to standstill."""

    __slots__ = (
        "end_tick",
        "is_stopping",
        "number",
        "reaches_end",
        "scale",
        "segment",
        "start_tick",
        "thread",
        "waypoint",
    )

    def __init__(
        self, number: int, segment: Segment, start_tick: int, scale: TimeScale, thread: str, waypoint: Six
    ) -> None:
        self.number = number
        self.segment = segment
        self.start_tick = start_tick
        self.scale = scale
        self.thread = thread
        self.waypoint = waypoint
        self.is_stopping = False
        self.reaches_end = True
        """Whether the path's end is where the arm comes to rest."""
        self.end_tick = self._arrival_tick()

    def _arrival_tick(self) -> int:
        arrival_s = self.scale.time_of(self.segment.duration_s)
        # A move takes at least the tick in which it is commanded (assumed), so that a loop of empty moves waits.
        return NEVER if isinf(arrival_s) else max(ticks_for(arrival_s), self.start_tick + 1)

    @property
    def due_tick(self) -> int:
        """Tick at which something about the move changes by itself."""
        return self.end_tick

    def setpoint(self, tick: float) -> Setpoint:
        """Target joints at a tick from the start on."""
        if tick >= self.end_tick:
            return Setpoint(self.q_rest, ZERO_SIX)
        q, qd = self.segment.setpoint(self.path_time_s(tick))
        rate = self.scale.rate(tick * PERIOD_S)
        if rate != 1.0:
            a, b, c, d, e, f = qd
            qd = (a * rate, b * rate, c * rate, d * rate, e * rate, f * rate)
        return Setpoint(q, qd)

    def is_awaited(self, number: int) -> bool:
        """Whether the call of that number is not over."""
        return number == self.number

    def set_rate(self, tick: int, rate: float, ramp_s: float) -> None:
        """Let path time run at `rate` from now on, reached after a ramp."""
        self.scale = self.scale.with_target(tick * PERIOD_S, rate, ramp_s)
        self.end_tick = self._arrival_tick()

    def stop(self, tick: int, ramp_s: float) -> None:
        """Come to rest on the path within `ramp_s`, or at its end if that is nearer."""
        self.set_rate(tick, 0.0, ramp_s)
        self.is_stopping = True
        standstill_tick = max(ticks_for(tick * PERIOD_S + ramp_s), self.start_tick + 1)
        self.reaches_end = self.end_tick <= standstill_tick
        self.end_tick = min(self.end_tick, standstill_tick)

    def hold(self) -> None:
        """Do not begin: the arm stays where the move starts until a rate is set."""
        self.scale = TimeScale.start(self.start_tick * PERIOD_S, 0.0)
        self.end_tick = NEVER

    def path_time_s(self, tick: float) -> float:
        """How far along the segment the arm is, as time at full speed."""
        return min(self.scale.path_time(tick * PERIOD_S), self.segment.duration_s)

    @property
    def q_rest(self) -> Six:
        """Where the arm rests when the move is over."""
        return self.segment.q_end if self.reaches_end else self.segment.sample(self.path_time_s(self.end_tick))


class Braking:
    """Joints that come to rest in closed form, by a profile that does not change any more.

    Args:
        number: of the call that ends at standstill.
        thread: who is to blame.
        profile: ends at rest.
        start_tick: its beginning.
    """

    __slots__ = ("end_tick", "is_stopping", "number", "profile", "q_rest", "reaches_end", "start_tick", "thread")

    def __init__(self, number: int, thread: str, profile: SpeedProfile, start_tick: int) -> None:
        self.number = number
        self.thread = thread
        self.profile = profile
        self.start_tick = start_tick
        self.is_stopping = True
        self.reaches_end = False
        self.end_tick = start_tick + max(1, ticks_for(profile.duration_s))
        self.q_rest = profile.at(profile.duration_s).q

    @property
    def due_tick(self) -> int:
        """Tick of standstill."""
        return self.end_tick

    def setpoint(self, tick: float) -> Setpoint:
        """Target joints at a tick from the start on."""
        if tick >= self.end_tick:
            return Setpoint(self.q_rest, ZERO_SIX)
        return self.profile.at((tick - self.start_tick) * PERIOD_S)

    def is_awaited(self, number: int) -> bool:
        """Whether the call of that number is not over."""
        return number == self.number
