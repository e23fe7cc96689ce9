"""Observations: what the machine and the runtime have seen that is no event of a run, for its observers.

The place that knows a fact makes an observation only where the fact is rare, so a run in which it does not happen pays
nothing. `findings.observing` says which observer takes which.
"""

from __future__ import annotations

from elitescript.records import record


@record
class ChannelLeft:
    """A program has ended and has not read all that a channel has received."""

    tick: int
    channel: str
    """Name of the channel for users."""
    kind: str
    """`socket` or `serial`."""
    data: bytes
    """What is left."""
    line: int
    """Line of the statement that has opened it."""
    thread: str


@record
class MotionLeft:
    """A program ends while a motion, force mode or the tracking of a conveyor is under way."""

    tick: int
    command: str
    """That asked for it, such as `servoj`."""
    line: int
    """Of that command; 0 if unknown."""
    thread: str
    left_rad: float = 0.0
    """Largest way of a joint that is left to the target, rad; 0 without a target."""
    speed_rad_per_s: float = 0.0
    """Speed of the fastest joint, rad/s."""


Observation = ChannelLeft | MotionLeft
