"""The serial lines of a served robot, shared between its programs and bridges.

A bridge uses the channel that the robot has open for a port: the line has the settings that a program gave it, and
there is one owner of the device. While a bridge has a client, what arrives on the line goes to the client and not to
programs (*assumed*: two readers of one line get what the other leaves). Programs may go on sending.

The vendor's client enables a port by a program and connects soon after: what it sends meanwhile waits, for as long as
`GRACE_TICKS`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final, Protocol

from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelOpened, Input
from elitescript.messages.line import PORT_NAMES
from elitescript.messages.outputs import (
    CHANNEL_WINDOW,
    ChannelRequest,
    CloseChannel,
    CreditChannel,
    OpenLine,
    SendChannel,
)
from elitescript.messages.timing import TICKS_PER_S

GRACE_TICKS: Final = TICKS_PER_S
"""How long bytes of clients wait for a line that is not open."""
OPENING: Final = "it does not open"
NOT_ENABLED: Final = "no program has enabled it (tool_serial_config, masterboard_serial_config)"


class LineClient(Protocol):
    """A client of a bridge."""

    @property
    def is_behind(self) -> bool:
        """Whether so much waits for it that the line has to wait."""

    def receive(self, data: bytes) -> None:
        """Take what has come from the line."""

    def go_on(self) -> None:
        """Send on: there is room again."""


class _Tap:
    """One serial port."""

    __slots__ = ("channel", "clients", "device", "is_reported", "owed", "pending", "unsent", "waited", "why")

    def __init__(self, device: str) -> None:
        self.device = device
        self.channel = 0
        """That the robot has open; 0 if there is none."""
        self.why = NOT_ENABLED
        """Why it is closed; empty if it is open."""
        self.is_reported = False
        """Whether the log has it that bytes are lost."""
        self.clients: list[LineClient] = []
        self.pending = bytearray()
        """From clients, until the next tick, or until the line opens."""
        self.unsent = 0
        """Bytes from clients that have not left the line."""
        self.owed = 0
        """Bytes that clients got and for which the line has no credit yet."""
        self.waited = 0
        """Ticks for which clients have waited for the line to open."""

    @property
    def is_lost(self) -> bool:
        """Whether bytes from clients have nowhere to go, and nothing is to be waited for."""
        return bool(self.why) and (self.why not in (NOT_ENABLED, OPENING) or self.waited > GRACE_TICKS)

    def begin(self, channel: int, why: str) -> None:
        is_first = self.why == NOT_ENABLED and why == OPENING
        self.channel, self.why, self.is_reported = channel, why, False
        self.unsent = self.owed = self.waited = 0
        if not is_first:
            self.drop()

    def drop(self) -> None:
        """Lose what waits."""
        self.pending.clear()
        self.go_on()

    def go_on(self) -> None:
        """Have clients read again."""
        for client in self.clients:
            client.go_on()


class LineTaps:
    """Between a robot and its serial lines.

    Args:
        warn: takes a line for the log.

    Attributes:
        on_join: called when a bridge gets a client.
    """

    __slots__ = ("_by_channel", "_taps", "_warn", "on_join")

    def __init__(self, warn: Callable[[str], None]) -> None:
        self._taps = {device: _Tap(device) for device in PORT_NAMES}
        self._by_channel: dict[int, _Tap] = {}
        self._warn = warn
        self.on_join: Callable[[], object] = lambda: None

    # ---------------------------------------------------------------- called by bridges

    def join(self, device: str, client: LineClient) -> None:
        """Connect a client of a bridge to a serial port."""
        tap = self._taps[device]
        if not tap.clients:
            tap.waited = 0
        tap.clients.append(client)
        self.on_join()
        if tap.is_lost:
            self._report(tap)

    def leave(self, device: str, client: LineClient) -> None:
        """Disconnect a client."""
        tap = self._taps[device]
        tap.clients.remove(client)
        if tap.why and not tap.clients:
            # What waits is not for a line that opens some time later.
            tap.drop()

    def send(self, device: str, data: bytes) -> bool:
        """Send bytes at the next tick; return whether there is room for more. Those for a closed line are lost."""
        tap = self._taps[device]
        if tap.is_lost:
            self._report(tap)
            return False
        tap.pending += data
        return len(tap.pending) < CHANNEL_WINDOW

    def _report(self, tap: _Tap) -> None:
        if not tap.is_reported:
            tap.is_reported = True
            name = PORT_NAMES[tap.device]
            self._warn(f"a client bridges the serial port {name}, and its bytes go nowhere: {tap.why}")

    # ---------------------------------------------------------------- called by the robot server

    @property
    def is_active(self) -> bool:
        """Whether every tick is to run for a bridge."""
        return any(tap.clients or tap.owed or (tap.pending and not tap.why) for tap in self._taps.values())

    def outgoing(self, requests: Sequence[ChannelRequest]) -> Sequence[ChannelRequest]:
        """Return the requests of a robot in a tick, and those of bridges behind them."""
        for request in requests:
            match request:
                case OpenLine(number, device) if device in self._taps:
                    tap = self._taps[device]
                    self._by_channel.pop(tap.channel, None)
                    tap.begin(number, OPENING)
                    self._by_channel[number] = tap
                case CloseChannel(number) if number in self._by_channel:
                    self._by_channel.pop(number).begin(0, NOT_ENABLED)
        more: list[ChannelRequest] = []
        for tap in self._taps.values():
            if not tap.why:
                more += self._asked(tap)
            elif tap.clients and not tap.is_lost:
                self._wait(tap)
            else:
                # They are read once in a tick, however much they send for nothing.
                tap.go_on()
        return (*requests, *more) if more else requests

    def _wait(self, tap: _Tap) -> None:
        """Count a tick for which clients wait for a line that is not open."""
        tap.waited += 1
        if tap.is_lost:
            tap.drop()
            self._report(tap)

    @staticmethod
    def _asked(tap: _Tap) -> list[ChannelRequest]:
        asked: list[ChannelRequest] = []
        room = CHANNEL_WINDOW - tap.unsent
        if tap.pending and room > 0:
            asked.append(SendChannel(tap.channel, bytes(tap.pending[:room])))
            tap.unsent += min(room, len(tap.pending))
            del tap.pending[:room]
        if tap.owed and not any(client.is_behind for client in tap.clients):
            asked.append(CreditChannel(tap.channel, tap.owed))
            tap.owed = 0
        if len(tap.pending) < CHANNEL_WINDOW:
            for client in tap.clients:
                client.go_on()
        return asked

    def incoming(self, inputs: Sequence[Input]) -> list[Input]:
        """Return channel events for the robot, without those that belong to bridges."""
        return [kept for one in inputs if (kept := self._kept(one)) is not None]

    def _kept(self, one: Input) -> Input | None:
        match one:
            case ChannelData(number, data) if (tap := self._by_channel.get(number)) and tap.clients:
                for client in tap.clients:
                    client.receive(data)
                tap.owed += len(data)
                return None
            case ChannelCredit(number, size) if (tap := self._by_channel.get(number)) and tap.unsent:
                ours = min(size, tap.unsent)
                tap.unsent -= ours
                return ChannelCredit(number, size - ours) if size > ours else None
            case ChannelOpened(number, True) if number in self._by_channel:
                self._by_channel[number].why = ""
            case ChannelOpened(number, False, reason) if number in self._by_channel:
                self._end(number, reason)
            case ChannelClosed(number, reason) if number in self._by_channel:
                self._end(number, reason or "its device has gone")
        return one

    def _end(self, number: int, why: str) -> None:
        tap = self._by_channel.pop(number)
        tap.begin(0, why)
        if tap.clients:
            self._report(tap)
