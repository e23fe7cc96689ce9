"""Channels on which things go wrong: around the virtual ones, the real ones of `run`, or those of a served robot."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection, Iterable, Sequence
from typing import Any, Final

from elitescript.devices.agenda import Agenda
from elitescript.devices.channels.faults import BOTH, LINE, TCP, TO_DEVICE, TO_ROBOT, title_of
from elitescript.devices.channels.wrong_replies import wrong_reply
from elitescript.errors import UsageError
from elitescript.messages.enums import ChannelError
from elitescript.messages.faults import ChannelFault, Passing
from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelEvent, ChannelOpened
from elitescript.messages.line import LineSettings
from elitescript.records import replace
from elitescript.runtime.environment import Channels
from elitescript.said import said

PAUSE_TICKS: Final = 2
"""Bytes of a serial line that come so soon after others belong to the same message."""

BROKEN: Final = "connection reset by peer"
REFUSED: Final = "connection refused"

Pieces = list[tuple[int, bytes]]
"""Parts of a message with the ticks that each comes later."""


class _Active:
    """A fault and what it has met so far."""

    __slots__ = ("begin", "end", "fault", "has_acted", "number", "place", "seen")

    def __init__(self, fault: ChannelFault, number: int, now: int) -> None:
        self.fault = fault
        self.number = number
        self.place = fault.place
        self.begin = max(fault.begin_tick, now)
        self.end = None if fault.ticks is None else self.begin + fault.ticks
        self.seen = 0
        self.has_acted = False

    def is_on(self, tick: int) -> bool:
        return self.begin <= tick and (self.end is None or tick < self.end)


class _FaultyChannel:
    """One channel as the robot sees it."""

    __slots__ = (
        "credits",
        "held",
        "inner",
        "is_heard",
        "is_message",
        "last",
        "last_data",
        "number",
        "place",
        "request",
        "surplus",
    )

    def __init__(self, number: int, place: tuple[str, str, int]) -> None:
        self.number = number
        self.place = place
        self.inner = 0
        self.is_heard = True
        """Whether the robot still gets its events."""
        self.held: dict[int, tuple[int, Callable[[], None]]] = {}
        """What faults hold back on its way to the device, by a number: how many bytes, 0 for the end of the connection,
        and the call that lets it go on."""
        self.request = b""
        self.last = {TO_ROBOT: 0, TO_DEVICE: 0}
        """The tick in which the last piece leaves, in each direction."""
        self.last_data = -PAUSE_TICKS - 1
        self.is_message: dict[int, bool] = {}
        """For each fault by number, whether the message that is arriving is one that it meets."""
        self.credits: deque[list[int]] = deque()
        """For each message on its way to the device: bytes that it has, bytes that the robot sent."""
        self.surplus = 0
        """Bytes that the robot gets and no device has sent."""


class FaultyChannels:
    """Implements `runtime.environment.Channels` around others.

    Args:
        inner: carry the bytes.
        faults: from the start.
        seed: of what is drawn.
        say: called with a text when a fault acts for the first time.

    Attributes:
        on_message: called with each message that passes, whether a fault meets it or not.
    """

    __slots__ = (
        "_active",
        "_agenda",
        "_by_inner",
        "_channels",
        "_events",
        "_faults",
        "_held",
        "_holding",
        "_inner",
        "_last",
        "_say",
        "_seed",
        "on_message",
    )

    def __init__(
        self,
        inner: Channels,
        faults: Iterable[ChannelFault] = (),
        *,
        seed: int = 0,
        say: Callable[[str], Any] | None = None,
    ) -> None:
        self._inner = inner
        self._seed = seed
        self._say = say
        self._agenda = Agenda()
        self._active: list[_Active] = []
        self._faults = 0
        """So many have been added."""
        self._channels: dict[int, _FaultyChannel] = {}
        self._by_inner: dict[int, _FaultyChannel] = {}
        self._events: list[ChannelEvent] = []
        self._last = 0
        self._holding: dict[int, _FaultyChannel] = {}
        """Channels of which something is held back, closed ones too, by their identity."""
        self._held = 0
        """Counts what was held back."""
        self.on_message: Callable[[Passing], Any] | None = None
        for fault in faults:
            self.put(fault)

    @property
    def is_real(self) -> bool:
        """Whether one leads to a peer that lives in wall-clock time."""
        return self._inner.is_real

    def add(self, fault: ChannelFault) -> None:
        """Add a fault, from now on or from its time on if that is later.

        Raises:
            UsageError: a reconnect where nothing is disconnected.
        """
        if fault.kind == "reconnect" and not any(
            active.fault.kind == "disconnect" and active.place == fault.place for active in self._active
        ):
            raise UsageError(f"kind: reconnect on {fault.on!r} has no disconnect before it, at that place")
        self.put(fault)

    def clear(self) -> None:
        """End all faults."""
        self._active.clear()

    def put(self, fault: ChannelFault) -> None:
        """Add a fault that was checked together with the others."""
        active = _Active(fault, self._faults, self._agenda.tick)
        self._faults += 1
        self._active.append(active)
        if fault.kind in ("disconnect", "reconnect"):
            self._agenda.put(active.begin - self._agenda.tick, lambda: self._switch(active))

    def _switch(self, active: _Active) -> None:
        """Carry out a disconnect or reconnect."""
        if active not in self._active:
            return
        self._acts(active)
        if active.fault.kind == "reconnect":
            for other in self._active:
                if other.fault.kind == "disconnect" and other.place == active.place and other.is_on(active.begin):
                    other.end = active.begin
        elif active.place[0] == TCP:
            for channel in [channel for channel in self._channels.values() if _is_at(channel.place, active.place)]:
                self._forget(channel)
                if channel.inner:
                    self._inner.close(channel.inner)
                self._tell(channel, ChannelClosed(channel.number, BROKEN))
                channel.is_heard = False

    def _acts(self, active: _Active) -> None:
        if not active.has_acted:
            active.has_acted = True
            if self._say is not None:
                self._say(said("{title} acts", title=title_of(active.fault.kind, active.fault.on)))

    def _found(self, place: tuple[str, str, int], *kinds: str) -> _Active | None:
        """Return a fault of some kind that is at work at a place."""
        for active in self._active:
            if active.fault.kind in kinds and _is_at(place, active.place) and active.is_on(self._agenda.tick):
                return active
        return None

    # ---------------------------------------------------------------- requests

    def open(self, address: str, port: int, timeout_s: float) -> int:
        place = (TCP, address, port)
        refused = self._found(place, "refuse", "disconnect")
        if refused is not None:
            self._acts(refused)
            number = self._number()
            event = ChannelOpened(number, False, REFUSED, ChannelError.REFUSED)
            self._agenda.put(1, lambda: self._events.append(event))
            return number
        silent = self._found(place, "silence")
        if silent is not None and silent.fault.direction == BOTH:
            self._acts(silent)
            return self._number()
        return self._opened(self._inner.open(address, port, timeout_s), place)

    def open_line(self, device: str, settings: LineSettings) -> int:
        return self._opened(self._inner.open_line(device, settings), (LINE, device, 0))

    def _number(self) -> int:
        self._last += 1
        return self._last

    def _opened(self, inner: int, place: tuple[str, str, int]) -> int:
        if not inner:
            return 0
        channel = _FaultyChannel(self._number(), place)
        channel.inner = inner
        self._channels[channel.number] = channel
        self._by_inner[inner] = channel
        return channel.number

    def send(self, channel: int, data: bytes) -> None:
        found = self._channels.get(channel)
        if found is None:
            return
        found.request = data
        pieces = self._pieces(found, TO_DEVICE, data)
        size = sum(len(piece) for _, piece in pieces)
        if not size:
            self._agenda.put(1, lambda: self._tell(found, ChannelCredit(channel, len(data))))
            return
        found.credits.append([size, len(data)])
        self._pass_all(found, TO_DEVICE, pieces, lambda piece: self._inner.send(found.inner, piece))

    def credit(self, channel: int, size: int) -> None:
        found = self._channels.get(channel)
        if found is not None:
            extra = min(size, found.surplus)
            found.surplus -= extra
            if size > extra:
                self._inner.credit(found.inner, size - extra)

    def close(self, channel: int) -> None:
        found = self._channels.get(channel)
        if found is not None:
            found.is_heard = False
            del self._channels[channel]

            def close() -> None:
                self._by_inner.pop(found.inner, None)
                self._inner.close(found.inner)

            self._pass(found, TO_DEVICE, 0, close)

    # ---------------------------------------------------------------- events

    def arrivals(self, tick: int) -> Sequence[ChannelEvent]:
        arrived = self._inner.arrivals(tick)
        self._agenda.run(tick)
        for event in arrived:
            self._take(event)
        events, self._events = self._events, []
        return events

    def incoming(self, event: ChannelEvent) -> Sequence[ChannelEvent]:
        """Return the events that the robot gets now for one that was brought to it."""
        self._take(event)
        events, self._events = self._events, []
        return events

    def pending(self, ignoring: Collection[int] = ()) -> tuple[str, ...]:
        """See `runtime.environment.Channels.pending`; what a fault has swallowed is not pending."""
        held = [_held_back(channel) for channel in self._holding.values() if channel.number not in ignoring]
        return (*held, *self._inner.pending(self._inner_numbers(ignoring)))

    def give_up(self, ignoring: Collection[int] = ()) -> tuple[str, ...]:
        inner = self._inner_numbers(ignoring)
        given_up = list(self._inner.give_up(inner))
        for channel in [channel for channel in self._holding.values() if channel.number not in ignoring]:
            given_up.append(_held_back(channel))
            for number, (size, _) in list(channel.held.items()):
                if size:
                    del channel.held[number]
                    self._take_credit(channel, size)
                else:
                    self._let_go(channel, number)
            self._holding.pop(id(channel), None)
        self._inner.give_up(inner)  # the ends of connections that were held back until now
        return tuple(given_up)

    def _inner_numbers(self, channels: Collection[int]) -> list[int]:
        return [self._channels[channel].inner for channel in channels if channel in self._channels]

    def next_tick(self, tick: int) -> int | None:
        own, other = self._agenda.next_tick(tick), self._inner.next_tick(tick)
        return own if other is None else other if own is None else min(own, other)

    def _take(self, event: ChannelEvent) -> None:
        channel = self._by_inner.get(event.channel)
        if channel is None:
            return
        match event:
            case ChannelData(_, data):
                self._take_data(channel, data)
            case ChannelCredit(_, size):
                self._take_credit(channel, size)
            case ChannelOpened():
                if not event.is_open:
                    self._forget(channel)
                self._tell(channel, replace(event, channel=channel.number))
            case ChannelClosed():
                self._forget(channel)
                end = replace(event, channel=channel.number)
                self._pass(channel, TO_ROBOT, 0, lambda: self._tell(channel, end))

    def _take_data(self, channel: _FaultyChannel, data: bytes) -> None:
        pieces = self._pieces(channel, TO_ROBOT, data)
        channel.last_data = self._agenda.tick
        more = sum(len(piece) for _, piece in pieces) - len(data)
        if more > 0:
            channel.surplus += more
        elif more < 0:
            self._inner.credit(channel.inner, -more)
        self._pass_all(channel, TO_ROBOT, pieces, lambda piece: self._tell(channel, ChannelData(channel.number, piece)))

    def _take_credit(self, channel: _FaultyChannel, size: int) -> None:
        given = 0
        while size and channel.credits:
            entry = channel.credits[0]
            used = min(size, entry[0])
            entry[0] -= used
            size -= used
            returned = entry[1] if not entry[0] else min(used, entry[1] - 1)
            entry[1] -= returned
            given += returned
            if not entry[0]:
                channel.credits.popleft()
        if given:
            self._tell(channel, ChannelCredit(channel.number, given))

    def _tell(self, channel: _FaultyChannel, event: ChannelEvent) -> None:
        if channel.is_heard:
            self._events.append(event)

    def _forget(self, channel: _FaultyChannel) -> None:
        self._channels.pop(channel.number, None)
        self._by_inner.pop(channel.inner, None)

    def _pass(
        self, channel: _FaultyChannel, direction: str, ticks: int, act: Callable[[], None], size: int = 0
    ) -> None:
        """Do something now or later, behind what is on its way already; `size` is how many bytes that sends."""
        now = self._agenda.tick
        at = channel.last[direction] = max(now + ticks, channel.last[direction])
        if at == now:
            act()
        elif direction == TO_ROBOT:
            self._agenda.put(at - now, act)
        else:
            self._held += 1
            number = self._held
            channel.held[number] = size, act
            self._holding[id(channel)] = channel
            self._agenda.put(at - now, lambda: self._let_go(channel, number))

    def _let_go(self, channel: _FaultyChannel, number: int) -> None:
        _, act = channel.held.pop(number, (0, None))
        if not channel.held:
            self._holding.pop(id(channel), None)
        if act is not None:
            act()

    def _pass_all(self, channel: _FaultyChannel, direction: str, pieces: Pieces, act: Callable[[bytes], None]) -> None:
        """Pass pieces on; the time between them stays what it is."""
        shift = 0
        for ticks, piece in pieces:
            at = self._agenda.tick + ticks + shift
            shift += max(0, channel.last[direction] - at)
            self._pass(channel, direction, ticks + shift, lambda piece=piece: act(piece), len(piece))  # type: ignore[misc]

    # ---------------------------------------------------------------- faults

    def _pieces(self, channel: _FaultyChannel, direction: str, data: bytes) -> Pieces:
        """Return what becomes of a message, or of one part of it."""
        is_continued = (
            direction == TO_ROBOT and channel.place[0] == LINE and self._agenda.tick - channel.last_data <= PAUSE_TICKS
        )
        pieces: Pieces = [(0, data)]
        met: list[ChannelFault] = []
        for active in self._active:
            fault = active.fault
            if not _is_at(channel.place, active.place) or not active.is_on(self._agenda.tick):
                continue
            if fault.kind == "disconnect":
                met.append(fault)
                pieces = []
                break
            way = TO_ROBOT if fault.kind == "wrong_reply" else fault.direction
            if fault.kind not in _EFFECTS or way not in (BOTH, direction):
                continue
            is_met = self._meets(active, channel, direction, is_continued)
            if is_met:
                self._acts(active)
                met.append(fault)
                key = (self._seed, active.number, active.seen, self._agenda.tick)
                pieces = _EFFECTS[fault.kind](active.fault, pieces, channel.request, key, is_continued)
        if self.on_message is not None:
            faults = tuple((fault.kind, fault.on) for fault in met)
            self.on_message(Passing(self._agenda.tick, channel.place, direction, data, faults))
        return [piece for piece in pieces if piece[1]]

    def _meets(self, active: _Active, channel: _FaultyChannel, direction: str, is_continued: bool) -> bool:
        """Return whether a fault meets the message that is passing; a message that comes in parts is one."""
        if is_continued and active.number in channel.is_message:
            return channel.is_message[active.number]
        active.seen += 1
        fault = active.fault
        is_met = active.seen >= fault.nth and (fault.count is None or active.seen < fault.nth + fault.count)
        if is_met and fault.share < 1.0:
            is_met = _share(self._seed, active.number, active.seen) < fault.share
        if direction == TO_ROBOT:
            channel.is_message[active.number] = is_met
        return is_met


def _is_at(place: tuple[str, str, int], where: tuple[str, str, int]) -> bool:
    """Return whether a channel is at the place that a fault names."""
    kind, address, port = where
    return place[0] == kind and place[2] == port and (place[1] == address or (kind == TCP and not address))


def _held_back(channel: _FaultyChannel) -> str:
    """Return what a fault holds back of a channel, in words."""
    kind, address, port = channel.place
    place = address if kind == LINE else f"{address}:{port}"
    size = sum(size for size, _ in channel.held.values())
    return (
        said("{size} bytes to {place}, which a fault delays", size=size, place=place)
        if size
        else said("the end of the connection to {place}", place=place)
    )


_Key = tuple[int, ...]


def _lost(_fault: ChannelFault, _pieces: Pieces, _request: bytes, _key: _Key, _is_continued: bool) -> Pieces:
    return []


def _later(fault: ChannelFault, pieces: Pieces, _request: bytes, _key: _Key, _is_continued: bool) -> Pieces:
    return [(ticks + fault.delay_ticks, data) for ticks, data in pieces]


def _twice(_fault: ChannelFault, pieces: Pieces, _request: bytes, _key: _Key, _is_continued: bool) -> Pieces:
    return pieces * 2


def _corrupted(_fault: ChannelFault, pieces: Pieces, _request: bytes, key: _Key, _is_continued: bool) -> Pieces:
    wrong: Pieces = []
    for number, (ticks, data) in enumerate(pieces):
        spoiled = bytearray(data)
        for begin in range(0, len(spoiled), 8):
            draw = _drawn(*key, number, begin)
            spoiled[begin + draw % min(8, len(spoiled) - begin)] ^= 1 << (draw >> 8) % 8
        wrong.append((ticks, bytes(spoiled)))
    return wrong


def _trickled(fault: ChannelFault, pieces: Pieces, _request: bytes, _key: _Key, _is_continued: bool) -> Pieces:
    parts: Pieces = []
    for ticks, data in pieces:
        first = max(ticks, parts[-1][0] + 1) if parts else ticks
        starts = range(0, len(data), fault.chunk)
        parts += [(first + number, data[begin : begin + fault.chunk]) for number, begin in enumerate(starts)]
    return parts


def _replaced(fault: ChannelFault, pieces: Pieces, request: bytes, _key: _Key, is_continued: bool) -> Pieces:
    if is_continued or not pieces:
        return []  # the wrong one has come in the place of the first part
    return [(pieces[0][0], wrong_reply(fault, request, pieces[0][1]))]


_EFFECTS: Final[dict[str, Callable[[ChannelFault, Pieces, bytes, _Key, bool], Pieces]]] = {
    "silence": _lost,
    "drop": _lost,
    "delay": _later,
    "duplicate": _twice,
    "corrupt": _corrupted,
    "trickle": _trickled,
    "wrong_reply": _replaced,
}
"""What becomes of the parts of a message that a fault meets."""


_MASK: Final = (1 << 64) - 1


def _drawn(*key: int) -> int:
    """Return a whole number in [0, 2**64) for a key, whatever else is drawn and in which order.

    This is the finalizer of SplitMix64 (Steele, Lea, Flood 2014).
    """
    value = 0
    for part in key:
        value = (value + part + 0x9E3779B97F4A7C15) & _MASK
        value = ((value ^ value >> 30) * 0xBF58476D1CE4E5B9) & _MASK
        value = ((value ^ value >> 27) * 0x94D049BB133111EB) & _MASK
        value ^= value >> 31
    return value


def _share(*key: int) -> float:
    """Return a number in [0, 1) for a key."""
    return (_drawn(*key) >> 11) / (1 << 53)
