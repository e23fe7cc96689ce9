"""What the record of a run and its world tell of why a thread waits: changes of signals, devices, what peers said."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Final

from elitescript.devices.surroundings import Surroundings
from elitescript.messages.events import Change, ChannelActivity, DeviceNoted, Event, SignalChanged
from elitescript.messages.signals import parse_signal_name, point_names
from elitescript.messages.timing import seconds
from elitescript.runtime.connections.traffic import cut
from elitescript.runtime.why.facts import Facts

_BY: Final = {
    "client": "a client",
    "device": "a device",
    "wire": "a wire",
    "schedule": "a schedule",
    "fault": "a fault",
}


class RunFacts(Facts):
    """Reads them in the record of a run, once something is asked.

    Args:
        events: returns those of the run, in order.
        is_whole: whether none has gone.
        start_tick: its first tick.
        surroundings: devices beside the robot; None if there are none.
        next_write: returns for family and index of a point the tick at which a queued request sets it, if one does.
        has_clients: whether clients of ports may set signals.
    """

    __slots__ = (
        "_changes",
        "_events",
        "_has_clients",
        "_is_whole",
        "_next_write",
        "_notes",
        "_start_tick",
        "_surroundings",
        "_traffic",
    )

    def __init__(
        self,
        events: Callable[[], Iterable[Event | Change]],
        *,
        is_whole: bool,
        start_tick: int,
        surroundings: Surroundings | None,
        next_write: Callable[[str, int], int | None],
        has_clients: bool,
    ) -> None:
        self._events = events
        self._is_whole = is_whole
        self._start_tick = start_tick
        self._surroundings = surroundings
        self._next_write = next_write
        self._has_clients = has_clients
        self._changes: dict[str, tuple[int, str, int]] | None = None
        self._traffic: dict[tuple[str, str], tuple[int, str, bool]] = {}
        self._notes: dict[str, str] = {}

    def history(self, name: str) -> str:
        """See `Facts.history`."""
        changes = self._read()
        if name not in changes:
            return "has not changed" if self._is_whole else ""
        tick, by, line = changes[name]
        setter = f"line {line}" if by == "program" and line else _BY.get(by, by)
        return f"has not changed since {seconds(tick - self._start_tick):g} s, by {setter}"

    def setters(self, name: str) -> list[str] | None:
        """See `Facts.setters`."""
        found = [] if self._surroundings is None else self._surroundings.setters(name)
        row, index = parse_signal_name(name)
        tick = self._next_write(row.name, index)
        if tick is not None:
            found = [*(found or ()), f"it is set at {seconds(tick - self._start_tick):g} s"]
        is_certain = not self._has_clients and all(by != "client" for _, by, _ in self._read().values())
        return found if found or (is_certain and found is not None) else None

    def sent(self, kind: str, channel: str) -> str:
        """See `Facts.sent`."""
        self._read()
        last = self._traffic.get((kind, channel))
        if last is None:
            return ""
        tick, data, is_answered = last
        said = []
        if data and not is_answered:
            said.append(f"{data.rstrip()!r} was sent at {seconds(tick - self._start_tick):g} s")
        where = self._traffic.get((kind, f"{channel} where"))
        peer = "" if where is None or self._surroundings is None else self._surroundings.title_at(kind, where[1])
        if peer in self._notes:
            said.append(f"{peer} {self._notes[peer]}")
        return ", ".join(said)

    def _read(self) -> dict[str, tuple[int, str, int]]:
        if self._changes is not None:
            return self._changes
        changes: dict[str, tuple[int, str, int]] = {}
        for event in self._events():
            if type(event) is tuple:
                tick, family, index, _, by, line = event
                changes[point_names(family)[index]] = tick, by, line
            elif type(event) is SignalChanged:
                changes[event.name] = event.tick, event.by, event.line
            elif type(event) is ChannelActivity:
                self._take(event)
            elif type(event) is DeviceNoted and event.is_warning:
                self._notes[event.device] = cut(event.text)
        self._changes = changes
        return changes

    def _take(self, event: ChannelActivity) -> None:
        key = event.kind, event.channel
        if event.what == "sent":
            self._traffic[key] = event.tick, event.data, False
        elif event.what == "received" and key in self._traffic:
            tick, data, _ = self._traffic[key]
            self._traffic[key] = tick, data, True
        elif event.what == "open":
            self._traffic[key] = event.tick, "", True
            self._traffic[event.kind, f"{event.channel} where"] = event.tick, event.data, True
