"""Output of a tick of a robot: events, requests of its programs, replies, and the snapshot that its ports show."""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

from elitescript.messages.events import Event
from elitescript.messages.line import LineSettings
from elitescript.messages.outcomes import Outcome
from elitescript.messages.snapshot import Snapshot
from elitescript.messages.snapshot_parts import ALL_PARTS
from elitescript.records import field, record

NOT_WRITTEN: Final = MappingProxyType({"is_written": False})
"""Metadata of a field that stays out of journals and of messages between processes."""

CHANNEL_WINDOW: Final = 65_536
"""Bytes that may be under way in each direction of a channel; more only after credit.

The owner of the connection reads no more from the peer than this plus what `CreditChannel` has added since, and gives
`ChannelCredit` for what it has sent. So a script that does not read stops its peer, and the other way round.
"""


@record
class OpenChannel:
    """Connect to a peer; the reply is `ChannelOpened`."""

    channel: int
    kind: str
    """`tcp`."""
    address: str
    port: int
    timeout_s: float


NOT_CONNECTED: Final = "nothing is connected"
"""Reason of a `ChannelOpened` with `ChannelError.NOTHING_BOUND`."""


@record
class OpenLine:
    """Open a serial line; the reply is `ChannelOpened`. A line that is open already is closed before."""

    channel: int
    device: str
    """`tool`, or the device of the control box, such as `/dev/ttymxc0`."""
    settings: LineSettings


@record
class SendChannel:
    """Send bytes to the peer."""

    channel: int
    data: bytes


@record
class CloseChannel:
    """Close the connection, once what was sent before has left. The channel has no events any more."""

    channel: int


@record
class CreditChannel:
    """Let the peer send so many bytes more: the script has taken as many."""

    channel: int
    size: int


ChannelRequest = OpenChannel | OpenLine | SendChannel | CloseChannel | CreditChannel


@record
class Reply:
    """The answer to a request, for the client that sent it; some requests have several in time."""

    origin: str
    """Of the request."""
    outcome: Outcome


REPEAT_AFTER_S: Final = 0.1
"""So long without a new row streams are silent, s; then they repeat the last one (*assumed*)."""


@record
class TickResult:
    """What happened in one tick."""

    tick: int
    events: tuple[Event, ...]
    requests: tuple[ChannelRequest, ...]
    replies: tuple[Reply, ...]

    def with_snapshot(self, snapshot: Snapshot, parts: int = ALL_PARTS) -> Output:
        """Return the output that ports publish; for `parts` see `Output.parts`."""
        return Output(self.tick, self.events, self.requests, self.replies, snapshot, parts)


@record
class Output(TickResult):
    """What ports publish of one tick: what happened, and the snapshot."""

    snapshot: Snapshot
    """Of this tick; an older one if no port reads more than its discrete state, see `has`."""
    parts: int = field(default=ALL_PARTS, metadata=NOT_WRITTEN)
    """Parts of the snapshot that are of its tick, as bits; the others may be older. See `messages.snapshot_parts`."""
    late_rows: tuple[Output, ...] | None = field(default=None, metadata=NOT_WRITTEN)
    """See `rows`; None while the robot keeps up."""
    repeats: bool = field(default=False, metadata=NOT_WRITTEN)
    """Whether streams send their last row again: for `REPEAT_AFTER_S` there has been no new one."""

    @property
    def rows(self) -> tuple[Output, ...]:
        """The outputs of ticks that leave with this one, each once, the oldest first: this one alone, or others.

        While a robot in a process of its own is late there is none; what it makes up for leaves together.
        """
        return (self,) if self.late_rows is None else self.late_rows

    def has(self, parts: int) -> bool:
        """Return whether these parts of the snapshot are of this tick."""
        return self.snapshot.robot.tick == self.tick and not parts & ~self.parts
