"""The connection of a MODBUS TCP master to one address and port, shared by the signals there.

It is opened when a signal or a request needs it, and reopened when it breaks: at once if the device has answered, else
with a growing backoff. Requests leave once in a tick, in one piece; see `exchange`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final, Protocol

from elitescript.messages.enums import ChannelError
from elitescript.messages.events import UNDELIVERED
from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelEvent, ChannelOpened
from elitescript.messages.outputs import CHANNEL_WINDOW
from elitescript.messages.timing import TICKS_PER_S, seconds
from elitescript.modbus.frames.tcp import tcp_frame
from elitescript.modbus.master.exchange import Exchange
from elitescript.modbus.master.signals import CONNECTING, NO_ERROR, NOT_CONNECTED, ModbusSignal
from elitescript.said import said

CONNECT_TICKS: Final = 2 * TICKS_PER_S
"""Timeout of an attempt to connect (*assumed*, as for sockets)."""
RETRY_TICKS: Final = (TICKS_PER_S // 2, TICKS_PER_S, 2 * TICKS_PER_S, 4 * TICKS_PER_S)
"""Backoff after failed attempts to connect, one after the other; the last one stays (*assumed*)."""

_TIMED_OUT: Final = "connection timed out"
_CLOSED_BY_DEVICE: Final = "the device has closed the connection"
_NO_NETWORK: Final = "this run has no network"
_NO_MODBUS: Final = "what the device sends is no MODBUS"
_CREDIT_SIZE: Final = CHANNEL_WINDOW // 4

BARRED: Final = "barred"
"""What is recorded of a connection that the options of the robot do not let through, before it times out."""

_CLOSED: Final = "closed"
_OPENING: Final = "opening"
_OPEN: Final = "open"


class MasterChannels(Protocol):
    """TCP channels of the environment."""

    def open(self, address: str, port: int, timeout_s: float) -> int:
        """Try to connect; return the channel, or 0 without a network."""

    def send(self, channel: int, data: bytes) -> None: ...

    def credit(self, channel: int, size: int) -> None:
        """Let the peer send so many bytes more."""

    def close(self, channel: int) -> None: ...


class MasterConnection:
    """One connection.

    Args:
        address: of the device.
        port: of the device.
        channels: carry the bytes.
        listen: sets the listener of a channel; None removes it.
        warn: records a warning, with a code if it has one; called for every event, also repeated ones.
        note: records traffic: name of the signal or of the connection, what, data.
        tick: the present one.
        is_single: whether the device is known to take one request at a time.

    Attributes:
        signals: by their frequency in Hz, in the order in which they were added.
        exchange: requests and answers.
        channel: number of the channel; 0 without one.
        connection_code: why it is not open, an errno.
        retry_tick: when to try to connect; None without a network.
    """

    __slots__ = (
        "_attempts",
        "_channels",
        "_inbox",
        "_is_reset",
        "_last_tick",
        "_listen",
        "_note",
        "_open_end",
        "_room",
        "_state",
        "_taken",
        "_warn",
        "address",
        "channel",
        "connection_code",
        "exchange",
        "port",
        "retry_tick",
        "signals",
    )

    def __init__(
        self,
        address: str,
        port: int,
        channels: MasterChannels,
        listen: Callable[[int, MasterConnection | None], None],
        warn: Callable[..., None],
        note: Callable[[str, str, str], None],
        *,
        tick: int,
        is_single: bool = False,
    ) -> None:
        self.address = address
        self.port = port
        self.signals: dict[int, list[ModbusSignal]] = {}
        self.exchange = Exchange(self._report, self._note_of, self._give_up, is_single=is_single)
        self.connection_code = NO_ERROR
        self.retry_tick: int | None = tick + 1
        self._channels = channels
        self._listen = listen
        self._warn = warn
        self._note = note
        self._state = _CLOSED
        self.channel = 0
        self._inbox: list[ChannelEvent] = []
        self._last_tick = tick
        self._open_end = 0
        self._room = CHANNEL_WINDOW
        self._taken = 0
        self._attempts = 0
        """Failed attempts to connect since the last answer."""
        self._is_reset = False
        """Whether a program has asked for a new connection, with or without signals."""

    # ---------------------------------------------------------------- reading

    @property
    def name(self) -> str:
        """Address and port."""
        return f"{self.address}:{self.port}"

    @property
    def is_open(self) -> bool:
        """Whether the connection is open."""
        return self._state is _OPEN

    @property
    def is_settled(self) -> bool:
        """Whether the requested attempt to connect has ended."""
        return not self._is_reset

    @property
    def is_unused(self) -> bool:
        """Whether no signal or request needs it."""
        return not self.signals and self.exchange.is_idle

    def codes(self, signal: ModbusSignal) -> tuple[int, int]:
        """Return the errors of a signal: code of the device, code of the connection."""
        if self._state is _OPEN:
            return signal.device_code, signal.connection_code
        return CONNECTING if self._state is _OPENING else NOT_CONNECTED, self.connection_code

    # ---------------------------------------------------------------- signals

    def add(self, signal: ModbusSignal) -> None:
        """Add a signal, requested from the next tick on."""
        self.signals.setdefault(signal.frequency_hz, []).append(signal)
        self.exchange.ask(signal)

    def remove(self, signal: ModbusSignal) -> None:
        """Remove a signal at once."""
        signal.is_removed = True
        self.exchange.forget(signal)
        self._forget(signal)

    def part(self, signal: ModbusSignal) -> None:
        """Remove a signal, once its output is written."""
        if signal.is_owed and self._state is _CLOSED and self._attempts:
            self._give_up(signal, "not sent, the device cannot be reached")
        if not signal.is_owed:
            self.remove(signal)
            return
        signal.is_once = True
        if not self.exchange.is_under_way(signal):
            self.exchange.ask(signal)
        self._forget(signal)

    def retime(self, signal: ModbusSignal, frequency_hz: int) -> None:
        """Change how often a signal is requested."""
        self._forget(signal)
        signal.frequency_hz = frequency_hz
        self.signals.setdefault(frequency_hz, []).append(signal)

    def _forget(self, signal: ModbusSignal) -> None:
        row = self.signals[signal.frequency_hz]
        row.remove(signal)
        if not row:
            del self.signals[signal.frequency_hz]

    def _report(self, signal: ModbusSignal, problem: str, *, is_late: bool = False) -> None:
        if not signal.is_removed:
            self._note_of(signal, "timeout" if is_late else "refused", problem)
            self._warn(f"{self.title(signal)}: {problem}")

    def _give_up(self, signal: ModbusSignal, problem: str) -> None:
        signal.is_owed = False
        self._warn(f"{self.title(signal)}: {problem}", UNDELIVERED)

    def title(self, signal: ModbusSignal) -> str:
        """Return the name of a signal or request for messages."""
        what = said("MODBUS signal {signal!r}", signal=signal.name) if signal.name else "a MODBUS request"
        return said("{what} to {name}, slave {unit}", what=what, name=self.name, unit=signal.unit)

    def _note_of(self, signal: ModbusSignal, what: str, data: str) -> None:
        """Record the traffic of a signal, unless it is the same as before."""
        if signal.is_removed or (not signal.is_once and signal.noted == (what, data)):
            return
        signal.noted = what, data
        self._note(signal.name or self.name, what, data)

    # ---------------------------------------------------------------- time

    def take(self, event: ChannelEvent) -> None:
        """Queue an event of the channel for the next `tick`."""
        self._inbox.append(event)

    def tick(self, tick: int) -> None:
        """Handle events and do what is due in a tick."""
        if self._inbox:
            events, self._inbox = self._inbox, []
            for event in events:
                self._handle(event, tick)
        self._collect(tick)
        if self._state is _OPEN:
            if self.exchange.look_at_time(tick):
                self._lose(tick, _TIMED_OUT, ChannelError.TIMED_OUT)
        elif self._state is _OPENING and tick >= self._open_end:
            self._lose(tick, _TIMED_OUT, ChannelError.TIMED_OUT)
        if self._state is _CLOSED and self.retry_tick is not None and tick >= self.retry_tick and self._is_wanted:
            self._connect(tick)
        if self._state is _OPEN:
            self._send(tick)

    def next_tick(self, tick: int) -> int | None:
        """Return the earliest tick after `tick` at which something is due without an event."""
        if self.is_unused:
            return tick + 1  # then it is closed
        if self._state is _CLOSED and self.retry_tick is None:
            return None
        last = self._last_tick
        due = [-(-(last * hertz // TICKS_PER_S + 1) * TICKS_PER_S // hertz) for hertz in self.signals if hertz]
        if self._state is _OPEN:
            at = self.exchange.next_tick(tick)
            if at is not None:
                due.append(at)
        elif self._state is _OPENING:
            due.append(self._open_end)
        elif self._is_wanted and self.retry_tick is not None:
            due.append(self.retry_tick)
        return max(tick + 1, min(due)) if due else None

    @property
    def _is_wanted(self) -> bool:
        return self._is_reset or self.exchange.has_waiting or any(self.signals)

    def _collect(self, tick: int) -> None:
        """Queue the signals that are due, by a grid of their frequency."""
        last, self._last_tick = self._last_tick, tick
        exchange = self.exchange
        due: list[ModbusSignal] = []
        for hertz, signals in self.signals.items():
            if tick * hertz // TICKS_PER_S == last * hertz // TICKS_PER_S:
                continue
            for signal in signals:
                if signal.is_waiting:
                    signal.missed += 1
                    exchange.press()
                else:
                    due.append(signal)
        if exchange.has_waiting or len(due) > exchange.room:
            # There is no time for all of them: those that were requested longest ago come first.
            due.sort(key=lambda signal: signal.turn)
        for signal in due:
            exchange.ask(signal)

    def _send(self, tick: int) -> None:
        data = self.exchange.outgoing(tick, self._room)
        if data:
            self._room -= len(data)
            self._channels.send(self.channel, data)

    # ---------------------------------------------------------------- the connection

    def _handle(self, event: ChannelEvent, tick: int) -> None:
        if event.channel != self.channel:
            return
        if isinstance(event, ChannelData):
            self._taken += len(event.data)
            self.exchange.incoming(event.data, tick)
            if self.exchange.has_heard:
                self._attempts = 0
            if self.exchange.is_lost:
                self._lose(tick, _NO_MODBUS, ChannelError.OTHER)
            elif self._taken >= _CREDIT_SIZE:
                self._channels.credit(self.channel, self._taken)
                self._taken = 0
        elif isinstance(event, ChannelCredit):
            self._room += event.size
            if self._room >= CHANNEL_WINDOW and self.exchange.broadcasts:
                for signal in self.exchange.broadcasts:
                    signal.is_owed = False
                self.exchange.broadcasts.clear()
        elif isinstance(event, ChannelOpened) and event.is_open:
            self._state = _OPEN
            self._is_reset = False
            self.connection_code = NO_ERROR
            self._note(self.name, "open", "")
            self.exchange.begin(tick)
        elif isinstance(event, ChannelOpened) and event.error is ChannelError.BARRED:
            self._note(self.name, BARRED, event.reason)
        elif isinstance(event, ChannelOpened | ChannelClosed):
            self._lose(tick, event.reason, event.error)

    def _connect(self, tick: int) -> None:
        self._room, self._taken = CHANNEL_WINDOW, 0
        self.channel = self._channels.open(self.address, self.port, seconds(CONNECT_TICKS))
        if self.channel:
            self._state = _OPENING
            self._open_end = tick + CONNECT_TICKS
            self._listen(self.channel, self)
        else:
            self._note(self.name, "refused", _NO_NETWORK)
            self._fail(tick, ChannelError.NETWORK_UNREACHABLE, _NO_NETWORK)
            self.retry_tick = None

    def _lose(self, tick: int, reason: str, error: ChannelError) -> None:
        """Handle a failed attempt to connect, or a broken connection."""
        was_useful = self._state is _OPEN and self.exchange.has_heard
        if self._state is _OPEN:
            self._note(self.name, "closed", reason or "by the other side")
        else:
            self._note(self.name, "timeout" if error is ChannelError.TIMED_OUT else "refused", reason)
        self._state = _CLOSED
        self._hang_up()
        if self.exchange.is_probing:
            # The device has closed because of the burst.
            self.exchange.fall_back()
            self.retry_tick = tick
            return
        self._fail(tick, error, reason or _CLOSED_BY_DEVICE)
        self._attempts += 1
        self.retry_tick = tick + (1 if was_useful else RETRY_TICKS[min(self._attempts, len(RETRY_TICKS)) - 1])

    def _fail(self, tick: int, error: ChannelError, reason: str) -> None:
        self.connection_code = int(error)
        self._is_reset = False
        self._warn(said("MODBUS at {name}: {reason}", name=self.name, reason=reason))
        self._interrupt(tick)
        self.exchange.drop_once(reason)

    def _interrupt(self, tick: int) -> None:
        """Give up what is under way and mark every signal as failed."""
        self.exchange.end()
        for signals in self.signals.values():
            for signal in signals:
                signal.fail(tick, CONNECTING, NO_ERROR)

    def _hang_up(self) -> None:
        if self._state is _OPEN:
            self._note(self.name, "closed", "")
        if self.channel:
            self._channels.close(self.channel)
            self._listen(self.channel, None)
        self.channel = 0
        self._state = _CLOSED

    def reset(self, tick: int) -> None:
        """Close the connection and reopen it in the next tick."""
        self._hang_up()
        self._interrupt(tick)
        self._attempts = 0
        self._is_reset = True
        self.connection_code = NO_ERROR
        self.retry_tick = tick + 1

    def close(self, last: Sequence[ModbusSignal] = ()) -> None:
        """Close the connection for good.

        Args:
            last: signals whose requests are sent before; their answers are not awaited.
        """
        if self._state is _OPEN:
            for number, signal in enumerate(last):
                self._channels.send(self.channel, tcp_frame(number, signal.unit, signal.request))
        self._hang_up()
        self._is_reset = False
