"""One channel as script threads see it: what has arrived waits here until somebody reads it.

The host hands a connection what arrives. No more than `CHANNEL_WINDOW` bytes wait: the peer may send more when they are
read.
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

NOT_ALL_THERE: Final = "a secondary program (sec) does not wait: {what} was read once, before all had come"
"""What is said once of readings with a time-out."""

_OPENING: Final = "opening"
_OPEN: Final = "open"
_CLOSED: Final = "closed"

_CREDIT_SIZE: Final = CHANNEL_WINDOW // 4
"""Bytes read after which the peer hears of it."""


class Receiver(Protocol):
    """Whoever is told what happens on a channel."""

    def take(self, event: ChannelEvent) -> None:
        """Something has happened on the channel."""


class ScriptConnection:
    """One connection, or one serial line.

    Args:
        channel: its number.
        channels: carry the bytes.
        scheduler: of the threads that wait for it.
        log: records what passes.

    Attributes:
        reason: why it is closed; empty if the peer or the program did it.
        received: what has arrived and is not read.
        is_behind_numbers: whether the last thing that was read was a list of numbers in parentheses.
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
        "is_behind_numbers",
        "log",
        "queued",
        "reason",
        "received",
        "sent",
    )

    def __init__(self, channel: int, channels: Channels, scheduler: Scheduler, log: ChannelLog) -> None:
        self.channel = channel
        self.log = log
        self.reason = ""
        self.error: ChannelError | None = None
        self.received = bytearray()
        self.is_behind_numbers = False
        self.queued = 0
        """Bytes that the program has sent so far."""
        self.sent = 0
        """How many of them are handed over."""
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
        """Whether bytes can come and go."""
        return self._state is _OPEN

    @property
    def is_closed(self) -> bool:
        """Whether it is over; what arrived before can still be read."""
        return self._state is _CLOSED

    # ---------------------------------------------------------------- what arrives

    def take(self, event: ChannelEvent) -> None:
        """Take note of what has happened on the channel, and let the threads that wait for it look.

        What was under way when it was closed here changes nothing any more.
        """
        if self._state is _CLOSED:
            return
        if isinstance(event, ChannelData):
            if len(self.received) + len(event.data) + self._taken > CHANNEL_WINDOW:
                self._channels.close(self.channel)
                reason = f"the peer sent more than {CHANNEL_WINDOW} bytes that nobody has read"
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
        elif isinstance(event, ChannelOpened | ChannelClosed):
            if self._state is _OPEN:
                self.log.lost(event.reason)
            elif event.error is not ChannelError.NOTHING_BOUND:
                self.log.failed(event.reason, is_late=event.error is ChannelError.TIMED_OUT)
            self.error = event.error
            self._end(event.reason)
        self._wake()

    def wait(self, reason: str, until: int | None) -> bool:
        """Let the calling thread wait until something happens here, or until a tick; whether something did.

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
        """Wait until something happens here; whether time is up. A peer that trickles does not put that off.

        Args:
            reason: what the thread waits for, in words.
            deadline: when time is up.
            silence_ticks: how long nothing may happen; any time if None.

        Raises:
            Stopped: the thread was stopped.
        """
        if silence_ticks is not None:
            silent, until = self._scheduler.now + silence_ticks, deadline.tick
            return not self.wait(reason, silent if until is None else min(until, silent)) or deadline.is_over
        while not self.wait(reason, deadline.tick):
            # Robot time may have caught up with the wall clock meanwhile, which puts the end off.
            if deadline.is_over:
                return True
        return deadline.is_over

    def _wake(self) -> None:
        for strand in self._waiting:
            self._scheduler.wake(strand)

    # ---------------------------------------------------------------- what the program does

    def drop(self, size: int) -> None:
        """Forget bytes that are read; the peer may send as many more."""
        del self.received[:size]
        self._taken += size
        if self._taken >= _CREDIT_SIZE and self.is_open:
            self._channels.credit(self.channel, self._taken)
            self._taken = 0

    def read(self, rule: Rule, reason: str, timeout_s: float) -> Any:
        """What a rule finds in what has arrived, waiting for more of it as long as the connection stands.

        A secondary program does not wait.

        Args:
            rule: finds something in what has arrived.
            reason: what the thread waits for, in words.
            timeout_s: longest time to wait; 0 and less wait for ever.

        Returns:
            What the rule makes of it; None if it needs more and the connection does not stand.

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
                # What came in the last moment was not enough either.
                is_last = True
                self.log.timed_out(f"{timeout_s:g} s for {reason}")
            elif used == 0:
                is_late = self.wait_for_more(reason, deadline)

    def rest(self, rule: Rule) -> Any:
        """What a rule makes of what has arrived, as nothing more will come."""
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
        """Forget the bytes that wait for room."""
        self.sent += len(self._outgoing)
        self._outgoing.clear()

    def close(self, reason: str = "", *, is_late: bool = False) -> None:
        """Close it from this side, whatever is under way; `is_late` if it has not opened in time."""
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
