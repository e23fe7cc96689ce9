"""Gives the programs of a host the MODBUS TCP signals.

Signals outlive the program that has added them: the next one uses them by name (*assumed*).
"""

from __future__ import annotations

from typing import Any, Final

from elitescript.commands.definition.context import Machine
from elitescript.errors import InvalidValueError, ScriptStateError
from elitescript.messages.events import Warned
from elitescript.messages.signals import WORD_MAX
from elitescript.messages.timing import seconds, ticks_for
from elitescript.modbus.frames.pdu import custom
from elitescript.modbus.master.connection import BARRED, CONNECT_TICKS, MasterConnection
from elitescript.modbus.master.master import Master
from elitescript.modbus.master.signals import BROADCAST, ModbusSignal, SignalKind
from elitescript.runtime.connections.connection import Receiver
from elitescript.runtime.connections.traffic import Traffic, cut
from elitescript.runtime.environment import Channels
from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.runtime.threads.strand import Stopped, Strand
from elitescript.said import said

ASKED_MAX: Final = 1024
"""Most connections of which the first statement is kept."""


class ModbusSignals:
    """Implements `commands.definition.context.ModbusSignalAccess`.

    Args:
        machine: the controller.
        scheduler: of the threads that wait for a connection.
        channels: carry the bytes.
        connections: receiver of each open channel.
        traffic: records the traffic.

    Attributes:
        master: carries out the requests.
    """

    __slots__ = ("_asked", "_machine", "_scheduler", "_traffic", "_waiting", "master")

    def __init__(
        self,
        machine: Machine,
        scheduler: Scheduler,
        channels: Channels,
        connections: dict[int, Receiver],
        traffic: Traffic,
    ) -> None:
        self._machine = machine
        self._scheduler = scheduler
        self._waiting: list[tuple[MasterConnection, Strand]] = []
        self._traffic = traffic
        self._asked: dict[str, tuple[int, str]] = {}
        """Line and thread that first asked for each connection."""
        self.master = Master(channels, connections, self._warn, self._note, tick=machine.tick)

    def _warn(self, text: str, code: str = "") -> None:
        self._machine.emit(Warned(self._machine.tick, text, code=code))

    def _note(self, name: str, what: str, data: str) -> None:
        if what == BARRED:
            line, thread = self._asked.get(name, (0, ""))
            self._traffic.bar("modbus", name, data, line=line, thread=thread)
        else:
            self._traffic.note_of_caller("modbus", name, what, cut(data))

    def _ask(self, address: str, port: int) -> None:
        """Take note of the statement that asks for a connection, for warnings about it."""
        strand = self._scheduler.current
        if strand is not None and len(self._asked) < ASKED_MAX:
            self._asked.setdefault(f"{address}:{port}", (strand.line, strand.name))

    # ---------------------------------------------------------------- signals

    def add(
        self, address: str, port: int, name: str, kind: int, slave: int, first: int, count: int, *, is_sequential: bool
    ) -> None:
        """Add a signal; see `commands.definition.context.ModbusSignalAccess.add`."""
        self._ask(address, port)
        self.master.add(address, port, name, SignalKind(kind), slave, first, count, is_sequential=is_sequential)

    def add_read_write(
        self,
        address: str,
        port: int,
        name: str,
        slave: int,
        read: tuple[int, int],
        write: tuple[int, int],
        *,
        is_sequential: bool,
    ) -> None:
        """Add a signal that reads and writes; see `commands.definition.context.ModbusSignalAccess.add_read_write`."""
        self._ask(address, port)
        self.master.add(
            address,
            port,
            name,
            SignalKind.READ_WRITE,
            slave,
            *read,
            is_sequential=is_sequential,
            write_first=write[0],
            write_count=write[1],
        )

    def delete(self, name: str) -> None:
        """Remove a signal."""
        self.master.delete(name)

    def status(self, name: str) -> bool | int | tuple[bool, ...] | tuple[int, ...]:
        """Return the values of a signal.

        Raises:
            ScriptStateError: it does not work for longer than its watchdog allows.
        """
        signal = self._working(name)
        if not signal.has_value and (signal.outputs is None or signal.kind is SignalKind.READ_WRITE):
            self._read_early(signal)
        elif signal.early is not None:
            self._read_later(signal)
        return _values_of(signal)

    def set(self, name: str, values: tuple[int, ...], *, is_digital: bool) -> None:
        """Set an output.

        Raises:
            InvalidValueError: no output of this kind, or fewer coils or registers.
            ScriptStateError: it does not work for longer than its watchdog allows.
        """
        signal = self.master.find(name)
        if not signal.is_output or signal.is_digital != is_digital:
            what = "digital output" if is_digital else "output register"
            raise InvalidValueError(
                said("the MODBUS signal {name!r} is no {what}", name=name, what=what),
                argument="signal_name",
                value=name,
            )
        if len(values) > signal.writable:
            raise InvalidValueError(
                said(
                    "the MODBUS signal {name!r} takes {writable} values, got {count}",
                    name=name,
                    writable=signal.writable,
                    count=len(values),
                ),
                argument="digital_value" if is_digital else "register_value",
                value=list(values),
                limit=f"<= {signal.writable} elements",
            )
        self._working(name)
        if not is_digital:
            given, values = values, tuple([value & WORD_MAX for value in values])
            if given != values:
                self._tell_cut(name, given, values)
        self._note_set(signal, values)
        self.master.set(name, values)

    # ---------------------------------------------------------------- observations

    def _note_set(self, signal: ModbusSignal, values: tuple[int, ...]) -> None:
        """Note a set, and let observers see if it replaces values which no request has carried."""
        before = signal.outputs
        if before is None:
            signal.first_set_tick = self._machine.tick
        elif before[: len(values)] == values:
            return
        elif signal.turn == signal.set_turn:
            self._tell_replaced(signal, values)
        signal.replaced, signal.set_turn, signal.set_tick = before, signal.turn, self._machine.tick
        signal.sets += 1

    @property
    def _caller(self) -> tuple[int, str]:
        strand = self._scheduler.current
        return (0, "") if strand is None else (strand.line, strand.name)

    def _read_early(self, signal: ModbusSignal) -> None:
        """Let observers see a reading before the first answer; a broadcast, which gets none, has its own warning."""
        if signal.unit == BROADCAST:
            return
        from elitescript.messages.observations import ModbusReadEarly

        line, thread = self._caller
        signal.early = signal.early or set()
        signal.early.add(line)
        tick = self._machine.tick
        shown = signal.shown(signal.values)
        self._machine.observe(ModbusReadEarly(tick, signal.name, line, thread, shown, tick - signal.added_tick))

    def _read_later(self, signal: ModbusSignal) -> None:
        """Let observers see that a line which has read a signal before its first answer has read it again."""
        early, (line, thread) = signal.early, self._caller
        if early is not None and line in early:
            from elitescript.messages.observations import ModbusReadAgain

            early.remove(line)
            signal.early = early or None
            self._machine.observe(ModbusReadAgain(self._machine.tick, signal.name, line, thread))

    def _tell_cut(self, name: str, given: tuple[int, ...], sent: tuple[int, ...]) -> None:
        """Let observers see values of which only the low 16 bits are sent."""
        from elitescript.messages.observations import RegisterCut

        line, thread = self._caller
        for value, low in zip(given, sent, strict=True):
            if value != low:
                self._machine.observe(RegisterCut(self._machine.tick, name, line, thread, value, low))

    def _tell_replaced(self, signal: ModbusSignal, values: tuple[int, ...]) -> None:
        """Let observers see that values are replaced which no request has carried."""
        from elitescript.messages.observations import ModbusReplaced

        line, thread = self._caller
        tick, unsent = self._machine.tick, signal.outputs or ()
        before = signal.replaced
        self._machine.observe(
            ModbusReplaced(
                tick,
                signal.name,
                line,
                thread,
                signal.shown(unsent),
                signal.shown((*values, *unsent[len(values) :])),
                tick - signal.set_tick,
                signal.frequency_hz,
                signal.sets,
                tick - signal.first_set_tick,
                is_back=before is not None and before[: len(values)] == values,
            )
        )

    def tie(self, name: str, choice: int) -> None:
        """Tie a digital output to whether a program runs.

        Raises:
            InvalidValueError: it is no digital output.
        """
        if self.master.find(name).kind is not SignalKind.DIGITAL_OUTPUT:
            raise InvalidValueError(
                said("the MODBUS signal {name!r} is no digital output", name=name), argument="signal_name"
            )
        self.master.choose(name, choice)

    def retime(self, name: str, frequency_hz: int) -> None:
        """Change the frequency of a signal."""
        self.master.retime(name, frequency_hz)

    def set_watchdog(self, name: str, timeout_s: float) -> None:
        """Change how long a signal may be faulty before its use is an alarm."""
        self.master.find(name).watchdog_ticks = ticks_for(timeout_s)

    # ---------------------------------------------------------------- errors

    def errors(self, name: str) -> tuple[int, int]:
        """Return the error code of the device and the error number of the connection."""
        return self.master.codes(name)

    def invalid_s(self, name: str) -> float:
        """Return the time since a faulty signal worked, or was added; 0 for one that works."""
        signal = self.master.find(name)
        return 0.0 if signal.fault_tick is None else seconds(self._machine.tick - signal.ok_tick)

    def _working(self, name: str) -> ModbusSignal:
        signal = self.master.find(name)
        if signal.is_overdue(self._machine.tick):
            device, connection = self.master.codes(name)
            raise ScriptStateError(
                said(
                    "the MODBUS signal {name!r} has not worked for {invalid_s:g} s (device {device}, "
                    "connection {connection})",
                    name=name,
                    invalid_s=self.invalid_s(name),
                    device=device,
                    connection=connection,
                ),
                code="R134",
                argument="signal_name",
                value=name,
                limit=f"<= {seconds(signal.watchdog_ticks):g}",
                unit="s",
                hint="modbus_get_error tells why, modbus_set_signal_watchdog sets how long that may last",
            )
        return signal

    def for_look(self) -> Any:
        """Return what programs read of them, for what looks at a program."""
        return _Look(self)

    def look(self, name: str) -> bool | int | tuple[bool, ...] | tuple[int, ...]:
        """Return what `status` returns; no observer sees it."""
        return _values_of(self._working(name))

    def has_value(self, name: str) -> bool:
        """Return whether the device has answered."""
        return self.master.find(name).has_value

    # ---------------------------------------------------------------- requests and connections

    def request(self, address: str, port: int, slave: int, function: int, data: bytes, *, is_once: bool) -> None:
        """Send a request once or repeatedly.

        Raises:
            ScriptStateError: too many wait, or there are too many signals.
        """
        self._ask(address, port)
        self.master.request(address, port, slave, custom(function, data), is_once=is_once)

    def reset(self, address: str, port: int, *, waits: bool) -> None:
        """Connect anew; with `waits` the thread waits for the result of one attempt.

        Raises:
            InvalidValueError: no signal uses that connection.
            Stopped: the thread was stopped.
        """
        link = self.master.link_at(address, port)
        strand = self._scheduler.current
        if strand is None or strand.is_dying:
            raise Stopped
        link.reset(self.master.now)
        if not waits or strand.is_secondary:
            return
        waiting = link, strand
        self._waiting.append(waiting)
        try:
            until = self._scheduler.now + CONNECT_TICKS + 1
            while not link.is_settled and self._scheduler.now < until:
                self._scheduler.wait(said("the MODBUS device at {link}", link=link.name), until)
        finally:
            self._waiting.remove(waiting)

    # ---------------------------------------------------------------- time

    def run_tick(self, tick: int, *, is_running: bool) -> None:
        """Run the master in a tick, before the threads."""
        self.master.tick(tick, is_running=is_running)
        self._wake()

    def _wake(self) -> None:
        for link, strand in self._waiting:
            if link.is_settled:
                self._scheduler.wake(strand)

    def next_tick(self, tick: int, *, is_running: bool) -> int | None:
        """Return the earliest tick after `tick` at which something is due by itself."""
        return self.master.next_tick(tick, is_running=is_running)

    def close(self) -> None:
        """Drop every signal and close every connection."""
        self.master.close()
        self._wake()


class _Look:
    """What programs read of MODBUS signals; no observer sees it."""

    __slots__ = ("errors", "invalid_s", "status")

    def __init__(self, signals: ModbusSignals) -> None:
        self.status = signals.look
        self.errors = signals.errors
        self.invalid_s = signals.invalid_s


def _values_of(signal: ModbusSignal) -> bool | int | tuple[bool, ...] | tuple[int, ...]:
    if signal.is_digital:
        levels = tuple(map(bool, signal.values))
        return levels if signal.count > 1 else levels[0]
    return signal.values if signal.count > 1 else signal.values[0]
