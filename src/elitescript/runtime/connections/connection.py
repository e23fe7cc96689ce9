"""One channel of script threads: received bytes wait here until they are read.

At most `CHANNEL_WINDOW` bytes wait: the peer may send more when they are read.
"""

from __future__ import annotations

from typing import Any, Final, Protocol

from elitescript.commands.definition.context import Rule
from elitescript.messages.enums import ChannelError
from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelEvent, ChannelOpened
from elitescript.messages.outputs import CHANNEL_WINDOW
from elitescript.runtime.connections.traffic import ChannelLog
from elitescript.runtime.environment import Channels
from elitescript.runtime.threads.deadline import Deadline
from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.runtime.threads.strand import Strand
from elitescript.said import said

NOT_ALL_THERE: Final = "a secondary program (sec) does not wait: {what} was read once, before all had come"
"""Warning for a read with a timeout in a secondary program."""

_OPENING: Final = "opening"
_OPEN: Final = "open"
_CLOSED: Final = "closed"

_CREDIT_SIZE: Final = CHANNEL_WINDOW // 4
"""Bytes read after which credit is sent to the peer."""


class Receiver(Protocol):
    """Receives the events of a channel."""

    def take(self, event: ChannelEvent) -> None:
        """Receive an event."""


class ScriptConnection:
    """One connection, or one serial line.

    Args:
        channel: its number.
        channels: carry the bytes.
        scheduler: of the threads that wait for it.
        log: records the traffic.

    Attributes:
        reason: of the close; empty if the peer or the program closed it.
        received: bytes that have arrived and are not read.
        is_barred: whether the options of the robot do not let it through; it is opening until it is closed.
        is_behind_numbers: whether the last read gave a list of numbers in parentheses.
        rule: of the last read of a socket; None before.
        late_data: what was there when the last read ended by its timeout; empty if it did not, or nothing was.
        given: what the last read of a socket gave; None before.
        is_close_told: whether observers know that the program uses it though its peer has closed.
    """

    __slots__ = (
        "_channels",
        "_outgoing",
        "_room",
        "_scheduler",
        "_state",
        "_taken",
        "_waiting",
        "channel",
        "error",
        "given",
        "is_barred",
        "is_behind_numbers",
        "is_close_told",
        "late_data",
        "log",
        "queued",
        "reason",
        "received",
        "rule",
        "sent",
    )

    def __init__(self, channel: int, channels: Channels, scheduler: Scheduler, log: ChannelLog) -> None:
        self.channel = channel
        self.log = log
        self.reason = ""
        self.error: ChannelError | None = None
        self.received = bytearray()
        self.is_barred = False
        self.is_behind_numbers = False
        self.rule: Rule | None = None
        self.late_data = b""
        self.given: Any = None
        self.is_close_told = False
        self.queued = 0
        """Bytes that the program has sent so far."""
        self.sent = 0
        """Those of them that are handed over."""
        self._channels = channels
        self._scheduler = scheduler
        self._state = _OPENING
        self._outgoing = bytearray()
        self._room = CHANNEL_WINDOW
        self._taken = 0
        self._waiting: list[Strand] = []

    @property
    def is_opening(self) -> bool:
        """Whether the attempt to connect is under way."""
        return self._state is _OPENING

    @property
    def is_open(self) -> bool:
        """Whether bytes can be sent and received."""
        return self._state is _OPEN

    @property
    def is_closed(self) -> bool:
        """Whether it is closed; bytes that arrived before can still be read."""
        return self._state is _CLOSED

    # ---------------------------------------------------------------- events

    def take(self, event: ChannelEvent) -> None:
        """Receive an event of the channel and wake the waiting threads; ignored after a close from this side."""
        if self._state is _CLOSED:
            return
        if isinstance(event, ChannelData):
            if len(self.received) + len(event.data) + self._taken > CHANNEL_WINDOW:
                self._channels.close(self.channel)
                reason = said(
                    "the peer sent more than {channel_window} bytes that are not read", channel_window=CHANNEL_WINDOW
                )
                self.log.closed(reason)
                self._end(reason)
            else:
                self.log.received(event.data, self._waiting[0] if self._waiting else None)
                self.received += event.data
        elif isinstance(event, ChannelCredit):
            self._room += event.size
            self._push()
        elif isinstance(event, ChannelOpened) and event.is_open:
            self._state = _OPEN
            self.log.opened()
        elif isinstance(event, ChannelOpened) and event.error is ChannelError.BARRED:
            self.is_barred = True
            self.log.barred(event.reason)
        elif isinstance(event, ChannelOpened | ChannelClosed):
            if self._state is _OPEN:
                self.log.lost(event.reason)
            elif event.error is not ChannelError.NOTHING_BOUND:
                self.log.failed(event.reason, is_late=event.error is ChannelError.TIMED_OUT)
            self.error = event.error
            self._end(event.reason)
        self._wake()

    def is_awaited_by(self, strand: Strand) -> bool:
        """Return whether a thread waits for an event of it."""
        return strand in self._waiting

    def wait(self, reason: str, until: int | None) -> bool:
        """Let the calling thread wait for an event, or until a tick; return whether there was one.

        Raises:
            Stopped: the thread was stopped.
        """
        strand = self._scheduler.current
        assert strand is not None
        self._waiting.append(strand)
        try:
            return self._scheduler.wait(reason, until)
        finally:
            self._waiting.remove(strand)

    def wait_for_more(self, reason: str, deadline: Deadline, silence_ticks: int | None = None) -> bool:
        """Wait for an event; return whether time is up. Single bytes do not extend the deadline.

        Args:
            reason: of the wait.
            deadline: end of the wait.
            silence_ticks: longest time without an event; any if None.

        Raises:
            Stopped: the thread was stopped.
        """
        if silence_ticks is not None:
            silent, until = self._scheduler.now + silence_ticks, deadline.tick
            return not self.wait(reason, silent if until is None else min(until, silent)) or deadline.is_over
        while not self.wait(reason, deadline.tick):
            # The deadline may have moved, as robot time has caught up with the wall clock.
            if deadline.is_over:
                return True
        return deadline.is_over

    def _wake(self) -> None:
        for strand in self._waiting:
            self._scheduler.wake(strand)

    # ---------------------------------------------------------------- calls of the program

    def drop(self, size: int) -> None:
        """Drop bytes that are read; the peer may send as many more."""
        del self.received[:size]
        self._taken += size
        if self._taken >= _CREDIT_SIZE and self.is_open:
            self._channels.credit(self.channel, self._taken)
            self._taken = 0

    def read(self, rule: Rule, reason: str, timeout_s: float) -> Any:
        """Apply a rule to the received bytes, waiting for more while the connection is open.

        A secondary program does not wait.

        Args:
            rule: takes a value from the received bytes.
            reason: of the wait.
            timeout_s: longest time to wait; 0 and less wait for ever.

        Returns:
            The value of the rule; None if it needs more bytes and the connection is closed.

        Raises:
            Stopped: the thread was stopped.
        """
        strand = self._scheduler.current
        assert strand is not None
        deadline = Deadline(self._scheduler, timeout_s)
        is_last = strand.is_secondary
        is_late = False
        while True:
            value, used = rule(self.received, is_last)
            self.drop(used)
            if value is not None or not self.is_open:
                return value
            if is_late:
                is_last = True
                self.late_data = bytes(self.received)
                self.log.timed_out(f"{timeout_s:g} s for {reason}")
            elif used == 0:
                is_late = self.wait_for_more(reason, deadline)

    def rest(self, rule: Rule) -> Any:
        """Return the value of a rule for the received bytes; no more will come."""
        value, used = rule(self.received, True)
        self.drop(used)
        return value

    def send(self, data: bytes) -> None:
        """Queue bytes for the peer and hand over as many as there is room for."""
        self.log.sent(data)
        self._outgoing += data
        self.queued += len(data)
        self._push()

    def _push(self) -> None:
        size = min(self._room, len(self._outgoing))
        if size:
            self._channels.send(self.channel, bytes(self._outgoing[:size]))
            del self._outgoing[:size]
            self._room -= size
            self.sent += size

    @property
    def unsent(self) -> int:
        """Bytes that the program has sent and that wait for room."""
        return len(self._outgoing)

    def discard(self) -> None:
        """Drop the bytes that wait for room."""
        self.sent += len(self._outgoing)
        self._outgoing.clear()

    def close(self, reason: str = "", *, is_late: bool = False) -> None:
        """Close it from this side; `is_late` if it has not opened in time."""
        if self._state is not _CLOSED:
            if self._outgoing:
                self._channels.send(self.channel, bytes(self._outgoing))
            self._channels.close(self.channel)
            self.log.closed(reason, is_late=is_late)
            self._end(reason)
            self._wake()

    def _end(self, reason: str) -> None:
        self._state = _CLOSED
        self.reason = reason
        self._outgoing.clear()
