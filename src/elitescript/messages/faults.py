"""Faults of connections and serial lines."""

from __future__ import annotations

from elitescript.records import NamedTuple, record


@record
class ChannelFault:
    """A fault of channels; `devices.channels.faults` has the kinds. For inputs see `DisturbInput`."""

    kind: str
    on: int | str
    """The place as a world file names it, for messages."""
    place: tuple[str, str, int]
    """`tcp`, address (empty for any) and port; or `line`, device and 0."""
    begin_tick: int = 0
    """First tick with the fault; a past one begins at once."""
    ticks: int | None = None
    """How long it lasts; to the end if None."""
    nth: int = 1
    """Number of the first message that it affects."""
    count: int | None = None
    """How many messages it affects; all if None."""
    direction: str = "both"
    """`to_robot`, `to_device` or `both`."""
    share: float = 1.0
    """Share of these messages that it affects, drawn at random."""
    delay_ticks: int = 0
    """Of `delay`."""
    chunk: int = 1
    """Of `trickle`, bytes."""
    form: str = ""
    """Of `wrong_reply`: `bytes`, or a MODBUS answer that is wrong in one way."""
    reply: bytes = b""
    """Of `wrong_reply`: the bytes of the form `bytes`, the number of an `exception`."""


class Passing(NamedTuple):
    """A message, or the part of one that has come in a tick, on its way over a channel."""

    tick: int
    place: tuple[str, str, int]
    """As `ChannelFault.place`."""
    direction: str
    """`to_robot` or `to_device`."""
    data: bytes
    """As it was sent."""
    faults: tuple[tuple[str, int | str], ...]
    """Kind and place of each fault that it meets."""
