"""What a robot has to say after a tick."""

from __future__ import annotations

from dataclasses import dataclass

from elitescript.messages.events import Event
from elitescript.messages.snapshot import Snapshot


@dataclass(frozen=True, slots=True)
class OpenChannel:
    """Connect to a peer; the answer is `ChannelOpened`."""

    channel: int
    kind: str
    """`tcp`."""
    address: str
    port: int
    timeout_s: float


@dataclass(frozen=True, slots=True)
class SendChannel:
    """Bytes for the peer."""

    channel: int
    data: bytes


@dataclass(frozen=True, slots=True)
class CloseChannel:
    """Close the connection."""

    channel: int


ChannelRequest = OpenChannel | SendChannel | CloseChannel


@dataclass(frozen=True, slots=True)
class Reply:
    """A line for the one who asked: interpreter acknowledgements, answers of the query port."""

    origin: str
    text: str


@dataclass(frozen=True, slots=True)
class Output:
    """All of it."""

    tick: int
    events: tuple[Event, ...]
    requests: tuple[ChannelRequest, ...]
    replies: tuple[Reply, ...]
    snapshot: Snapshot
