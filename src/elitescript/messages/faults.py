"""Faults of connections and serial lines, as the robot gets them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ChannelFault:
    """Something that goes wrong on channels; `devices.channels.faults` has the kinds. For inputs see `DisturbInput`."""

    kind: str
    on: int | str
    """The place as a world file names it, for messages."""
    place: tuple[str, str, int]
    """`tcp`, address (empty for any) and port; or `line`, device and 0."""
    begin_tick: int = 0
    """The first tick with it; one that is over begins at once."""
    ticks: int | None = None
    """So many ticks; to the end if None."""
    nth: int = 1
    """The first message that it meets."""
    count: int | None = None
    """How many messages it meets; all if None."""
    direction: str = "both"
    """`to_robot`, `to_device` or `both`."""
    share: float = 1.0
    """Of these messages it meets this share, drawn at random."""
    delay_ticks: int = 0
    """Of `delay`."""
    chunk: int = 1
    """Of `trickle`, bytes."""
    form: str = ""
    """Of `wrong_reply`: `bytes`, or a MODBUS answer that is wrong in one way."""
    reply: bytes = b""
    """Of `wrong_reply`: what arrives of the form `bytes`, the number of an `exception`."""
