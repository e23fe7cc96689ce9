"""What a tick of a robot gives: events, requests of its programs, replies, and the machine as its ports show it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from elitescript.messages.events import Event
from elitescript.messages.line import LineSettings
from elitescript.messages.snapshot import Snapshot

CHANNEL_WINDOW: Final = 65_536
"""Bytes that may be on their way in each direction of a channel; more only after credit for them.

Whoever holds the connection reads no more from the peer than this and what `CreditChannel` has added since, and gives
`ChannelCredit` for what it got rid of. So a script that does not read stops its peer, and the other way round.
"""


@dataclass(frozen=True, slots=True)
class OpenChannel:
    """Connect to a peer; the answer is `ChannelOpened`."""

    channel: int
    kind: str
    """`tcp`."""
    address: str
    port: int
    timeout_s: float


NOT_CONNECTED: Final = "nothing is connected"
"""Reason of a `ChannelOpened` for a serial port that is bound to nothing: it opens all the same, and is silent."""


TIME_OUT_REASONS: Final = ("no answer within", "connection timed out")
"""How the reason of a connection that took too long begins, in small letters."""


@dataclass(frozen=True, slots=True)
class OpenLine:
    """Open a serial line; the answer is `ChannelOpened`. A line that is open already is closed before."""

    channel: int
    device: str
    """`tool`, or the device of the control box, such as `/dev/ttymxc0`."""
    settings: LineSettings


@dataclass(frozen=True, slots=True)
class SendChannel:
    """Bytes for the peer."""

    channel: int
    data: bytes


@dataclass(frozen=True, slots=True)
class CloseChannel:
    """Close the connection, once what was sent before is on its way. No event of this channel is expected any more."""

    channel: int


@dataclass(frozen=True, slots=True)
class CreditChannel:
    """The script has taken so many bytes: the peer may send as many more."""

    channel: int
    size: int


ChannelRequest = OpenChannel | OpenLine | SendChannel | CloseChannel | CreditChannel


@dataclass(frozen=True, slots=True)
class Reply:
    """A line for the one who asked: interpreter acknowledgements, answers of the query port."""

    origin: str
    text: str


@dataclass(frozen=True, slots=True)
class TickResult:
    """What happened in one tick."""

    tick: int
    events: tuple[Event, ...]
    requests: tuple[ChannelRequest, ...]
    replies: tuple[Reply, ...]

    def with_snapshot(self, snapshot: Snapshot) -> Output:
        """Return what ports publish of this tick."""
        return Output(self.tick, self.events, self.requests, self.replies, snapshot)


@dataclass(frozen=True, slots=True)
class Output:
    """What ports publish of one tick: what happened, and the machine as they show it."""

    tick: int
    events: tuple[Event, ...]
    requests: tuple[ChannelRequest, ...]
    replies: tuple[Reply, ...]
    snapshot: Snapshot
    """Of this tick, or an older one if nothing was to read more than its discrete state; see `is_fresh`."""

    @property
    def is_fresh(self) -> bool:
        """Whether the snapshot is of this very tick."""
        return self.snapshot.robot.tick == self.tick
