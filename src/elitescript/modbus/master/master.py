"""The MODBUS TCP master of the controller: signals by name, each read or written periodically.

It has no clock: `tick` is called in every tick that is run, `next_tick` returns a tick that must be run, and channels
deliver events. Signals of one address and port share a connection.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final

from elitescript.errors import InvalidValueError, ScriptStateError
from elitescript.messages.timing import TICKS_PER_S
from elitescript.modbus.master.connection import MasterChannels, MasterConnection
from elitescript.modbus.master.signals import ModbusSignal, SignalKind
from elitescript.said import said

SIGNALS_MAX: Final = 200
WATCHDOG_TICKS: Final = 5 * TICKS_PER_S
REQUESTS_MAX: Final = 64
"""Limit of single requests that wait at a time (*assumed*)."""
SINGLES_MAX: Final = 1024
"""Limit of addresses that are known to take one request at a time."""
WARNINGS_MAX: Final = 100
"""Limit of different warnings for one program."""


class Master:
    """Signals and the connections that they need.

    Args:
        channels: carry the bytes.
        listeners: takers of events, by channel.
        warn: records a warning, with a code if it has one.
        note: records traffic: name of the signal or of the connection, what, data
            (`runtime.connections.traffic`).
        tick: the present one.

    Attributes:
        signals: by name, in the order in which they were added.
        links: connections by address and port.
        now: the present tick.
    """

    __slots__ = (
        "_channels",
        "_is_running",
        "_listeners",
        "_note",
        "_repeated",
        "_singles",
        "_warn",
        "_warned",
        "links",
        "now",
        "signals",
        "where",
    )

    def __init__(
        self,
        channels: MasterChannels,
        listeners: dict[int, Any],
        warn: Callable[..., None],
        note: Callable[[str, str, str], None] = lambda name, what, data: None,
        *,
        tick: int = 0,
    ) -> None:
        self.signals: dict[str, ModbusSignal] = {}
        self.links: dict[tuple[str, int], MasterConnection] = {}
        self.where: dict[str, tuple[str, int]] = {}
        """Address and port of each signal."""
        self.now = tick
        self._channels = channels
        self._listeners = listeners
        self._warn = warn
        self._note = note
        self._warned: set[str] = set()
        self._singles: dict[tuple[str, int], None] = {}
        self._repeated: dict[tuple[str, int, int, int], ModbusSignal] = {}
        self._is_running = True

    # ---------------------------------------------------------------- signals

    def add(
        self,
        address: str,
        port: int,
        name: str,
        kind: SignalKind,
        unit: int,
        first: int,
        count: int,
        *,
        is_sequential: bool = False,
        write_first: int = 0,
        write_count: int = 0,
    ) -> None:
        """Add a signal; one of that name is replaced.

        Args:
            address: of the device.
            port: of the device.
            name: of the signal.
            kind: of the signal.
            unit: number of the slave.
            first: first coil or register; of those that are read, if it reads and writes.
            count: how many.
            is_sequential: whether it waits for the other sequential signals of its connection.
            write_first: first register that it writes, if it reads and writes.
            write_count: how many.

        Raises:
            ScriptStateError: there are too many.
        """
        if name not in self.signals:
            self._check_room()
        signal = ModbusSignal(
            name,
            kind,
            unit,
            first,
            count,
            tick=self.now,
            is_sequential=is_sequential,
            write_address=write_first,
            write_count=write_count,
        )
        signal.watchdog_ticks = WATCHDOG_TICKS
        link = self._link(address, port)
        link.add(signal)
        if name in self.signals:
            self.delete(name)
        self.signals[name] = signal
        self.where[name] = address, port

    def _check_room(self) -> None:
        if len(self.signals) + len(self._repeated) >= SIGNALS_MAX:
            raise ScriptStateError(
                said(
                    "there are {signals_max} MODBUS signals already, repeated requests included",
                    signals_max=SIGNALS_MAX,
                ),
                code="R104",
                value=SIGNALS_MAX + 1,
                limit=f"<= {SIGNALS_MAX}",
                hint="delete one with modbus_delete_signal",
            )

    def delete(self, name: str) -> None:
        """Delete a signal.

        Raises:
            InvalidValueError: there is none of that name.
        """
        signal = self.find(name)
        place = self.where.pop(name)
        del self.signals[name]
        self.links[place].part(signal)

    def find(self, name: str) -> ModbusSignal:
        """Return the signal of a name.

        Raises:
            InvalidValueError: there is none.
        """
        signal = self.signals.get(name)
        if signal is None:
            known = ", ".join(repr(other) for other in list(self.signals)[:5])
            raise InvalidValueError(
                said("there is no MODBUS signal {name!r}", name=name),
                argument="signal_name",
                value=name,
                hint=said("there are {known}", known=known) if known else "add it with modbus_add_signal",
            )
        return signal

    def set(self, name: str, values: Sequence[int]) -> None:
        """Set an output, which is written from now on; one without a frequency is written once."""
        signal = self.find(name)
        signal.set(values)
        self._prepare(signal, is_running=self._is_running)
        if not signal.frequency_hz:
            signal.is_owed = True
            self.links[self.where[name]].exchange.ask(signal)

    def choose(self, name: str, choice: int) -> None:
        """Tie an output to whether a program runs; see `ModbusSignal.forced`."""
        signal = self.find(name)
        signal.choice = choice
        self._prepare(signal, is_running=self._is_running)

    def _prepare(self, signal: ModbusSignal, *, is_running: bool) -> None:
        """Update the request of a signal, and record the values it writes from now on if they change."""
        before = signal.request
        signal.prepare(is_running=is_running)
        if signal.request is not before and (values := signal.written(is_running=is_running)):
            self._note(signal.name, "sent", signal.shown(values))

    def retime(self, name: str, frequency_hz: int) -> None:
        """Change how often a signal is requested."""
        signal = self.find(name)
        self.links[self.where[name]].retime(signal, frequency_hz)

    def codes(self, name: str) -> tuple[int, int]:
        """Return the errors of a signal: code of the device, code of the connection."""
        signal = self.find(name)
        return self.links[self.where[name]].codes(signal)

    # ---------------------------------------------------------------- requests and connections

    def request(self, address: str, port: int, unit: int, pdu: bytes, *, is_once: bool) -> None:
        """Send a custom request, once or periodically, at the default frequency of a signal.

        A periodic one ends with the program, or with another one of the same function there (*assumed*).

        Raises:
            ScriptStateError: too many wait, or there are too many signals.
        """
        key = address, port, unit, pdu[0]
        older = self._repeated.pop(key, None)
        if older is not None:
            self.links[address, port].remove(older)
        link = self._link(address, port)
        signal = ModbusSignal("", SignalKind.CUSTOM, unit, 0, 0, tick=self.now, custom=pdu, is_once=is_once)
        self._note(link.name, "sent", f"slave {unit}: {pdu.hex(' ')}")
        if is_once:
            if link.exchange.single_requests >= REQUESTS_MAX:
                raise ScriptStateError(
                    said("{requests_max} requests to {link} wait already", requests_max=REQUESTS_MAX, link=link.name),
                    code="R104",
                    value=REQUESTS_MAX + 1,
                    limit=f"<= {REQUESTS_MAX}",
                )
            link.exchange.ask(signal)
            return
        self._check_room()
        self._repeated[key] = signal
        link.add(signal)

    def link_at(self, address: str, port: int) -> MasterConnection:
        """Return the connection to a device.

        Raises:
            InvalidValueError: no signal uses one.
        """
        link = self.links.get((address, port))
        if link is None:
            known = ", ".join(sorted(other.name for other in self.links.values()))
            raise InvalidValueError(
                said("no MODBUS signal uses a connection to {address}:{port}", address=address, port=port),
                argument="connection_id",
                value=address,
                hint=said("there are {known}", known=known) if known else None,
            )
        return link

    def _link(self, address: str, port: int) -> MasterConnection:
        link = self.links.get((address, port))
        if link is None:
            link = self.links[address, port] = MasterConnection(
                address,
                port,
                self._channels,
                self._listen,
                self._warn_once,
                self._note,
                tick=self.now,
                is_single=(address, port) in self._singles,
            )
        return link

    def _listen(self, channel: int, link: MasterConnection | None) -> None:
        if link is None:
            self._listeners.pop(channel, None)
        else:
            self._listeners[channel] = link

    def _warn_once(self, text: str, code: str = "") -> None:
        if text not in self._warned and len(self._warned) < WARNINGS_MAX:
            self._warned.add(text)
            if code:
                self._warn(text, code)
            else:
                self._warn(text)

    # ---------------------------------------------------------------- time

    def tick(self, tick: int, *, is_running: bool) -> None:
        """Do what is due in a tick.

        Args:
            tick: the present one.
            is_running: whether a program runs, paused ones included (*assumed*).
        """
        self.now = tick
        self.set_running(is_running)
        for place, link in list(self.links.items()):
            link.tick(tick)
            if link.is_unused:
                self._part(place, link)

    def set_running(self, is_running: bool) -> None:
        """Follow the begin or end of a program: periodic requests end with it, tied outputs change."""
        if is_running == self._is_running:
            return
        self._is_running = is_running
        if is_running:
            self._warned.clear()
        else:
            for (address, port, _, _), signal in self._repeated.items():
                self.links[address, port].part(signal)
            self._repeated.clear()
        for name, signal in self.signals.items():
            before = signal.request
            self._prepare(signal, is_running=self._is_running)
            if signal.request is not before and not signal.frequency_hz:
                self.links[self.where[name]].exchange.ask(signal)

    # ---------------------------------------------------------------- what is owed

    @property
    def channels(self) -> list[int]:
        """Numbers of the open channels."""
        return [link.channel for link in self.links.values() if link.channel]

    def pending(self) -> tuple[str, ...]:
        """Return a text for each output that is set and not written yet, and each single request without answer."""
        return tuple(link.title(signal) for link, signal in self._owed())

    def give_up(self) -> tuple[str, ...]:
        """Stop waiting for what `pending` names, and return it; signals are still written."""
        given_up = []
        for link, signal in self._owed():
            given_up.append(link.title(signal))
            signal.is_owed = False
            if signal.is_once:
                signal.is_removed = True
                link.exchange.forget(signal)
        return tuple(given_up)

    def _owed(self) -> list[tuple[MasterConnection, ModbusSignal]]:
        owed = {id(signal): (link, signal) for link in self.links.values() for signal in link.exchange.owed}
        for name, signal in self.signals.items():
            if signal.is_owed:
                owed[id(signal)] = self.links[self.where[name]], signal
        return list(owed.values())

    # ---------------------------------------------------------------- connections

    def _part(self, place: tuple[str, int], link: MasterConnection) -> None:
        if link.exchange.is_single and len(self._singles) < SINGLES_MAX:
            self._singles[place] = None
        link.close()
        del self.links[place]

    def next_tick(self, tick: int, *, is_running: bool) -> int | None:
        """Return the earliest tick after `tick` at which something is due without an event."""
        if is_running != self._is_running:
            return tick + 1
        due = [at for link in self.links.values() if (at := link.next_tick(tick)) is not None]
        return min(due, default=None)

    def close(self) -> None:
        """Delete every signal and close every connection.

        Outputs that are tied to the end of a program are written before; answers are not awaited.
        """
        for place, link in self.links.items():
            tied = []
            for name, signal in self.signals.items():
                if self.where[name] == place and signal.forced(False) is not None:
                    self._prepare(signal, is_running=False)
                    tied.append(signal)
            link.close(tied)
        self.links.clear()
        self.signals.clear()
        self.where.clear()
        self._repeated.clear()
