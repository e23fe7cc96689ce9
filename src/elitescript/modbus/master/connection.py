"""The connection of a MODBUS TCP master to one address and port, shared by the signals there.

It is made when somebody wants it, and made anew when it breaks: at once if it was good for something, else after
pauses that grow. Requests leave once in a tick, in one piece; see `exchange`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final, Protocol

from elitescript.messages.events import UNDELIVERED
from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelEvent, ChannelOpened
from elitescript.messages.outputs import CHANNEL_WINDOW, TIME_OUT_REASONS
from elitescript.messages.timing import TICKS_PER_S, seconds
from elitescript.modbus.frames.tcp import tcp_frame
from elitescript.modbus.master.exchange import TIMED_OUT, Exchange
from elitescript.modbus.master.signals import CONNECTING, NO_ERROR, NOT_CONNECTED, ModbusSignal

CONNECT_TICKS: Final = 2 * TICKS_PER_S
"""How long an attempt to connect may take (*assumed*, as for sockets)."""
RETRY_TICKS: Final = (TICKS_PER_S // 2, TICKS_PER_S, 2 * TICKS_PER_S, 4 * TICKS_PER_S)
"""Pauses between attempts to connect that fail one after the other; the last one stays (*assumed*)."""

IO_ERROR: Final = 5
UNREACHABLE: Final = 101
ERROR_NUMBERS: Final = {
    "": 104,
    "broken pipe": 32,
    "network is unreachable": UNREACHABLE,
    "connection reset by peer": 104,
    "connection timed out": TIMED_OUT,
    "connection refused": 111,
    "host is down": 112,
    "no route to host": 113,
    "the address is not known": 113,
    "name or service not known": 113,
}
"""Error numbers of TCP/IP on Linux by their text; a peer that just closes counts as a reset, others as `IO_ERROR`."""

LATE: Final = TIME_OUT_REASONS[0]
"""How others say that an attempt to connect took too long."""

_TIMED_OUT: Final = TIME_OUT_REASONS[1]
_CLOSED_BY_DEVICE: Final = "the device has closed the connection"
_NO_NETWORK: Final = "this run has no network"
_NO_MODBUS: Final = "what the device sends is no MODBUS"
_CREDIT_SIZE: Final = CHANNEL_WINDOW // 4

_CLOSED: Final = "closed"
_OPENING: Final = "opening"
_OPEN: Final = "open"


class MasterChannels(Protocol):
    """What carries the bytes: the TCP part of `runtime.environment.MasterChannels`."""

    def open(self, address: str, port: int, timeout_s: float) -> int:
        """Try to connect; return the channel, or 0 if there is nothing to connect to."""

    def send(self, channel: int, data: bytes) -> None:
        """Send bytes."""

    def credit(self, channel: int, size: int) -> None:
        """Let the peer send so many bytes more."""

    def close(self, channel: int) -> None:
        """Close."""


class MasterConnection:
    """One connection.

    Args:
        address: of the device.
        port: of the device.
        channels: carry the bytes.
        listen: tells who listens to a channel, or with None that nobody does.
        warn: records a warning, with a code if it has one; asked for each event, those that repeat are its business.
        note: records what passes: name of the signal or of the connection, what, data.
        tick: the present one.
        is_single: whether the device is known to take one request at a time.

    Attributes:
        signals: by their frequency in Hz, in the order in which they were added.
        exchange: requests and answers.
        connection_code: why it does not stand, an error number of TCP/IP.
        retry_tick: when to try to connect; None if that makes no sense.
    """

    __slots__ = (
        "_attempts",
        "_channel",
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
        self.exchange = Exchange(self._complain, self._note_of, self._give_up, is_single=is_single)
        self.connection_code = NO_ERROR
        self.retry_tick: int | None = tick + 1
        self._channels = channels
        self._listen = listen
        self._warn = warn
        self._note = note
        self._state = _CLOSED
        self._channel = 0
        self._inbox: list[ChannelEvent] = []
        self._last_tick = tick
        self._open_end = 0
        self._room = CHANNEL_WINDOW
        self._taken = 0
        self._attempts = 0
        """Attempts to connect that have come to nothing since it was good for something."""
        self._is_reset = False
        """Whether a program wants it anew, signals or not."""

    # ---------------------------------------------------------------- reading

    @property
    def name(self) -> str:
        """Address and port."""
        return f"{self.address}:{self.port}"

    @property
    def is_open(self) -> bool:
        """Whether the connection stands."""
        return self._state is _OPEN

    @property
    def channel(self) -> int:
        """Number of the channel; 0 without one."""
        return self._channel

    @property
    def is_settled(self) -> bool:
        """Whether the attempt to connect that was asked for is over."""
        return not self._is_reset

    @property
    def is_unused(self) -> bool:
        """Whether nobody needs it."""
        return not self.signals and self.exchange.is_idle

    def codes(self, signal: ModbusSignal) -> tuple[int, int]:
        """Return what is wrong with a signal: code of the device, code of the connection."""
        if self._state is _OPEN:
            return signal.device_code, signal.connection_code
        return CONNECTING if self._state is _OPENING else NOT_CONNECTED, self.connection_code

    # ---------------------------------------------------------------- signals

    def add(self, signal: ModbusSignal) -> None:
        """Ask for a signal from the next tick on."""
        self.signals.setdefault(signal.frequency_hz, []).append(signal)
        self.exchange.ask(signal)

    def remove(self, signal: ModbusSignal) -> None:
        """Ask for it no more."""
        signal.is_removed = True
        self.exchange.forget(signal)
        self._forget(signal)

    def part(self, signal: ModbusSignal) -> None:
        """Ask for it no more, except once for what is owed."""
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
        """Change how often it is asked for."""
        self._forget(signal)
        signal.frequency_hz = frequency_hz
        self.signals.setdefault(frequency_hz, []).append(signal)

    def _forget(self, signal: ModbusSignal) -> None:
        row = self.signals[signal.frequency_hz]
        row.remove(signal)
        if not row:
            del self.signals[signal.frequency_hz]

    def _complain(self, signal: ModbusSignal, trouble: str) -> None:
        if not signal.is_removed:
            self._note_of(signal, "timeout" if trouble.startswith(LATE) else "refused", trouble)
            self._warn(f"{self.title(signal)}: {trouble}")

    def _give_up(self, signal: ModbusSignal, trouble: str) -> None:
        signal.is_owed = False
        self._warn(f"{self.title(signal)}: {trouble}", UNDELIVERED)

    def title(self, signal: ModbusSignal) -> str:
        """Return a signal or request in words."""
        what = f"MODBUS signal {signal.name!r}" if signal.name else "a MODBUS request"
        return f"{what} to {self.name}, slave {signal.unit}"

    def _note_of(self, signal: ModbusSignal, what: str, data: str) -> None:
        """Record what has come of a signal, unless it is the same as before."""
        if signal.is_removed or (not signal.is_once and signal.noted == (what, data)):
            return
        signal.noted = what, data
        self._note(signal.name or self.name, what, data)

    # ---------------------------------------------------------------- time

    def take(self, event: ChannelEvent) -> None:
        """Something has happened on the channel; the next `tick` looks at it."""
        self._inbox.append(event)

    def tick(self, tick: int) -> None:
        """Do what is due in a tick."""
        if self._inbox:
            events, self._inbox = self._inbox, []
            for event in events:
                self._happened(event, tick)
        self._collect(tick)
        if self._state is _OPEN:
            if self.exchange.look_at_time(tick):
                self._lose(tick, _TIMED_OUT)
        elif self._state is _OPENING and tick >= self._open_end:
            self._lose(tick, _TIMED_OUT)
        if self._state is _CLOSED and self.retry_tick is not None and tick >= self.retry_tick and self._is_wanted:
            self._connect(tick)
        if self._state is _OPEN:
            self._send(tick)

    def next_tick(self, tick: int) -> int | None:
        """Return the earliest tick after `tick` at which something is due without anything arriving."""
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
        """Queue the signals whose turn it is, by a grid of their frequency."""
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
            # There is not time for all of them: it is the turn of those that were asked for longest ago.
            due.sort(key=_turn)
        for signal in due:
            exchange.ask(signal)

    def _send(self, tick: int) -> None:
        data = self.exchange.outgoing(tick, self._room)
        if data:
            self._room -= len(data)
            self._channels.send(self._channel, data)

    # ---------------------------------------------------------------- the connection

    def _happened(self, event: ChannelEvent, tick: int) -> None:
        if event.channel != self._channel:
            return
        if isinstance(event, ChannelData):
            self._taken += len(event.data)
            self.exchange.incoming(event.data, tick)
            if self.exchange.has_heard:
                self._attempts = 0
            if self.exchange.is_lost:
                self._lose(tick, _NO_MODBUS)
            elif self._taken >= _CREDIT_SIZE:
                self._channels.credit(self._channel, self._taken)
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
        elif isinstance(event, ChannelOpened | ChannelClosed):
            self._lose(tick, event.reason)

    def _connect(self, tick: int) -> None:
        self._room, self._taken = CHANNEL_WINDOW, 0
        self._channel = self._channels.open(self.address, self.port, seconds(CONNECT_TICKS))
        if self._channel:
            self._state = _OPENING
            self._open_end = tick + CONNECT_TICKS
            self._listen(self._channel, self)
        else:
            self._note(self.name, "refused", _NO_NETWORK)
            self._fail(tick, UNREACHABLE, _NO_NETWORK)
            self.retry_tick = None

    def _lose(self, tick: int, reason: str) -> None:
        """The connection does not come about, or stands no longer."""
        was_useful = self._state is _OPEN and self.exchange.has_heard
        if self._state is _OPEN:
            self._note(self.name, "closed", reason or "by the other side")
        else:
            self._note(self.name, "timeout" if error_number(reason) == TIMED_OUT else "refused", reason)
        self._state = _CLOSED
        self._hang_up()
        if self.exchange.is_probing:
            # It was the burst that it has not survived.
            self.exchange.fall_back()
            self.retry_tick = tick
            return
        self._fail(tick, error_number(reason), reason or _CLOSED_BY_DEVICE)
        self._attempts += 1
        self.retry_tick = tick + (1 if was_useful else RETRY_TICKS[min(self._attempts, len(RETRY_TICKS)) - 1])

    def _fail(self, tick: int, code: int, reason: str) -> None:
        self.connection_code = code
        self._is_reset = False
        self._warn(f"MODBUS at {self.name}: {reason}")
        self._interrupt(tick)
        self.exchange.drop_once(reason)

    def _interrupt(self, tick: int) -> None:
        """What was under way is lost, and no signal works."""
        self.exchange.end()
        for signals in self.signals.values():
            for signal in signals:
                signal.fail(tick, CONNECTING, NO_ERROR)

    def _hang_up(self) -> None:
        if self._state is _OPEN:
            self._note(self.name, "closed", "")
        if self._channel:
            self._channels.close(self._channel)
            self._listen(self._channel, None)
        self._channel = 0
        self._state = _CLOSED

    def reset(self, tick: int) -> None:
        """Close the connection and make it anew in the next tick."""
        self._hang_up()
        self._interrupt(tick)
        self._attempts = 0
        self._is_reset = True
        self.connection_code = NO_ERROR
        self.retry_tick = tick + 1

    def close(self, last: Sequence[ModbusSignal] = ()) -> None:
        """Close the connection for good.

        Args:
            last: signals whose requests leave before; their answers are not waited for.
        """
        if self._state is _OPEN:
            for number, signal in enumerate(last):
                self._channels.send(self._channel, tcp_frame(number, signal.unit, signal.request))
        self._hang_up()
        self._is_reset = False


def error_number(reason: str) -> int:
    """Return the error number of TCP/IP that stands for the text of a reason."""
    return TIMED_OUT if reason.startswith(LATE) else ERROR_NUMBERS.get(reason.lower(), IO_ERROR)


def _turn(signal: ModbusSignal) -> int:
    return signal.turn
