"""Records the traffic on the connections of programs as events.

Bytes are shown as the text that they are in UTF-8; a byte that is no text, and a control character other than tab and
line ends, as `\\xNN`. What they are in GBK, if that is a likely text, stands behind them. Long messages are cut, and
the number of events in one tick is limited.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final

from elitescript.commands.definition.context import Machine
from elitescript.messages.events import BARRED, ChannelActivity, Warned
from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.runtime.threads.strand import Strand

if TYPE_CHECKING:
    from elitescript.messages.observations import Observation

DATA_MAX: Final = 200
"""Most bytes, or characters, of a message that are shown."""

NAME_MAX: Final = 80
"""Most characters of the name of a channel that are shown."""

PER_TICK_MAX: Final = 100
"""Most events in one tick, of all channels; one more states that others are left out."""

BARRED_MAX: Final = 200
"""Most statements and peers for which a connection that is not let through has a warning; all have an event."""

LEFT_OUT: Final = f"(more than {PER_TICK_MAX} in this tick; the others are not recorded)"

_CONTROLS: Final = {code: f"\\x{code:02x}" for code in (*range(32), *range(127, 160)) if chr(code) not in "\t\n\r"}


def shown(data: bytes) -> str:
    """Return bytes as text, cut to `DATA_MAX` of them."""
    part = data[:DATA_MAX]
    text = part.decode("utf-8", "backslashreplace")
    reads = None
    if not part.isascii():
        from elitescript.text_encoding import likely_gbk

        reads = likely_gbk(part)
    if not text.rstrip("\r\n").isprintable():
        text = text.translate(_CONTROLS)
    if reads is not None:
        text = f"{text.rstrip()} (as GBK: {reads.strip()})"
    return text if len(data) <= DATA_MAX else f"{text}… ({len(data)} bytes)"


def cut(text: str) -> str:
    """Return a text cut to `DATA_MAX` characters, with its length if it was longer."""
    return text if len(text) <= DATA_MAX else f"{text[:DATA_MAX]}… ({len(text)} characters)"


class Traffic:
    """Records the traffic on all channels of a host.

    Args:
        machine: receives the events.
        scheduler: has the calling thread.
    """

    __slots__ = ("_barred", "_count", "_machine", "_scheduler", "_tick")

    def __init__(self, machine: Machine, scheduler: Scheduler) -> None:
        self._barred: set[tuple[int, str]] = set()
        self._machine = machine
        self._scheduler = scheduler
        self._tick = -1
        self._count = 0

    @property
    def caller(self) -> Strand | None:
        """The running thread; None between two threads."""
        return self._scheduler.current

    def note(self, kind: str, channel: str, what: str, data: str = "", *, line: int = 0, thread: str = "") -> None:
        """Record an event; see `events.ChannelActivity`."""
        tick = self._machine.tick
        if tick != self._tick:
            self._tick, self._count = tick, 0
        self._count += 1
        if self._count > PER_TICK_MAX:
            if self._count > PER_TICK_MAX + 1:
                return
            data = LEFT_OUT
        self._machine.emit(ChannelActivity(tick, channel[:NAME_MAX], kind, what, data, line, thread))

    def left(self, kind: str, channel: str, data: bytes, *, line: int, thread: str) -> None:
        """Let observers see what a program has left unread at its end."""
        from elitescript.messages.observations import ChannelLeft

        self._machine.observe(ChannelLeft(self._machine.tick, channel[:NAME_MAX], kind, data, line, thread))

    def observe(self, make: Callable[..., Observation], kind: str, channel: str, *facts: Any) -> None:
        """Let observers see facts about a channel, with line and name of the running thread."""
        strand = self._scheduler.current
        line, thread = (0, "") if strand is None else (strand.line, strand.name)
        self._machine.observe(make(self._machine.tick, channel[:NAME_MAX], kind, line, thread, *facts))

    def bar(self, kind: str, channel: str, reason: str, *, line: int, thread: str) -> None:
        """Record a connection that the options of the robot do not let through, and warn of it once for each line."""
        self.note(kind, channel, "refused", reason, line=line, thread=thread)
        if (line, reason) not in self._barred and len(self._barred) < BARRED_MAX:
            self._barred.add((line, reason))
            self._machine.emit(Warned(self._machine.tick, reason, thread, line, BARRED))

    def note_of_caller(self, kind: str, channel: str, what: str, data: str = "") -> None:
        """Record an event with line and name of the running thread."""
        strand = self._scheduler.current
        if strand is None:
            self.note(kind, channel, what, data)
        else:
            self.note(kind, channel, what, data, line=strand.line, thread=strand.name)


class ChannelLog:
    """Records the traffic on one channel, from the attempt to open it on.

    Args:
        traffic: of the host.
        kind: `socket`, `rpc` or `serial`.
        channel: name of the channel for users.
        where: its peer.
        has_bytes: whether bytes are recorded; if not, the caller records their meaning.
    """

    __slots__ = ("_channel", "_has_bytes", "_kind", "_line", "_thread", "_traffic", "where")

    def __init__(self, traffic: Traffic, kind: str, channel: str, where: str = "", *, has_bytes: bool = True) -> None:
        self._traffic = traffic
        self._kind = kind
        self._channel = channel
        self.where = where
        self._has_bytes = has_bytes
        strand = traffic.caller
        self._line, self._thread = (0, "") if strand is None else (strand.line, strand.name)

    @property
    def place(self) -> tuple[str, str]:
        """Its kind and the name of the channel."""
        return self._kind, self._channel

    def note(self, what: str, data: str = "") -> None:
        """Record an event that the running thread has caused."""
        self._traffic.note_of_caller(self._kind, self._channel, what, data)

    def opened(self) -> None:
        """Record that it is open, with the statement that has opened it."""
        self._traffic.note(self._kind, self._channel, "open", self.where, line=self._line, thread=self._thread)

    def failed(self, reason: str, *, is_late: bool = False) -> None:
        """Record that it could not be opened; `is_late` if that took too long."""
        what = "timeout" if is_late else "refused"
        text = ": ".join(filter(None, (self.where, reason)))
        self._traffic.note(self._kind, self._channel, what, text, line=self._line, thread=self._thread)

    def barred(self, reason: str) -> None:
        """Record that the options of the robot do not let it through."""
        self._traffic.bar(self._kind, self._channel, reason, line=self._line, thread=self._thread)

    def sent(self, data: bytes) -> None:
        """Record sent bytes."""
        if self._has_bytes and data:
            self.note("sent", shown(data))

    def received(self, data: bytes, reader: Strand | None) -> None:
        """Record received bytes; `reader` is a thread that waits for them."""
        if self._has_bytes and data:
            line, thread = (0, "") if reader is None else (reader.line, reader.name)
            self._traffic.note(self._kind, self._channel, "received", shown(data), line=line, thread=thread)

    def timed_out(self, waited: str) -> None:
        """Record a timeout of the running thread."""
        self.note("timeout", waited)

    def lost(self, reason: str) -> None:
        """Record that the peer has closed, or the connection broke."""
        self._traffic.note(self._kind, self._channel, "closed", reason or "by the other side")

    def left(self, data: bytes) -> None:
        """Let observers see what the program has left unread at its end, with the statement that has opened it."""
        self._traffic.left(self._kind, self._channel, data, line=self._line, thread=self._thread)

    def observe(self, make: Callable[..., Observation], *facts: Any) -> None:
        """Let observers see facts about the channel that a call of the running thread has shown."""
        self._traffic.observe(make, self._kind, self._channel, *facts)

    def closed(self, reason: str, *, is_late: bool = False) -> None:
        """Record that this side has closed; `is_late` if it has not opened in time."""
        self.note("timeout" if is_late else "closed", reason)
