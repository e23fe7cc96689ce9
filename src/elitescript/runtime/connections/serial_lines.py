"""Gives programs the serial ports of the robot, in virtual time.

The ports stay configured when a program ends (*assumed*). One thread at a time reads from a port, and one sends a
request to a slave and waits for its response; other threads wait in the order in which they came.

A request waits until the line was silent for `gap_s`, counted in ticks; bytes before it, such as a late response, are
dropped. A response that has begun and is silent for `BROKEN_S` is given up before the timeout: it is cut short, or its
checksum is wrong (*assumed*).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from elitescript.errors import ScriptPermissionError
from elitescript.messages.enums import ChannelError
from elitescript.messages.events import BARRED
from elitescript.messages.line import PORT_NAMES, LineSettings, bind_hint
from elitescript.messages.outputs import CHANNEL_WINDOW, NOT_CONNECTED
from elitescript.messages.timing import TICKS_PER_S, seconds, ticks_for
from elitescript.modbus.frames import pdu
from elitescript.modbus.frames.pdu import ExceptionResponse
from elitescript.modbus.rtu_exchange import RtuExchange, gap_s
from elitescript.runtime.connections.background import Background
from elitescript.runtime.connections.connection import NOT_ALL_THERE, Receiver
from elitescript.runtime.connections.serial_line import (
    CLOSED,
    MODBUS,
    PLAIN,
    LineConnection,
    SerialLine,
    SilentLineConnection,
)
from elitescript.runtime.connections.traffic import DATA_MAX, ChannelLog, cut
from elitescript.runtime.environment import Channels, bytes_without_addresses
from elitescript.runtime.threads.deadline import Deadline
from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.runtime.threads.strand import Stopped
from elitescript.said import said

OPEN_TICKS: Final = 2 * TICKS_PER_S
"""How long a device may take to open (*assumed*)."""

BROKEN_S: Final = 0.5
"""Silence after which a response that has begun is given up (*assumed*)."""

TOOL: Final = "tool"

FUNCTIONS: Final = {
    pdu.READ_COILS: "read coils",
    pdu.READ_DISCRETE_INPUTS: "read discrete inputs",
    pdu.READ_HOLDING_REGISTERS: "read holding registers",
    pdu.READ_INPUT_REGISTERS: "read input registers",
    pdu.WRITE_COIL: "write coil",
    pdu.WRITE_REGISTER: "write register",
    pdu.WRITE_COILS: "write coils from",
    pdu.WRITE_REGISTERS: "write registers from",
}
"""Function codes in words, as recorded before an address."""


class SerialLines:
    """Implements `commands.definition.context.SerialLineAccess` for one program.

    Args:
        channels: carry the bytes.
        scheduler: runs the threads.
        connections: receiver of each open channel.
        background: has the ports, and records their traffic.
        warn_once: records a warning, once for each key: key, text, perhaps code and hint.
    """

    __slots__ = ("_channels", "_connections", "_lines", "_scheduler", "_traffic", "_warn_once")

    def __init__(
        self,
        channels: Channels,
        scheduler: Scheduler,
        connections: dict[int, Receiver],
        background: Background,
        warn_once: Callable[..., None],
    ) -> None:
        self._channels = channels
        self._scheduler = scheduler
        self._connections = connections
        self._lines = background.lines
        self._traffic = background.traffic
        self._warn_once = warn_once

    # ---------------------------------------------------------------- configuring

    def enable(self, device: str, settings: LineSettings, *, is_modbus: bool, is_daemons: bool = False) -> bool:
        """Open a port, or open it anew; return whether it is open. Received bytes are lost (*assumed*).

        Raises:
            Stopped: the thread was stopped.
        """
        if self._scheduler.caller.is_dying:
            raise Stopped
        line = self._lines.setdefault(device, SerialLine(self._scheduler))
        line.close(self._connections)
        line.begin(settings, MODBUS if is_modbus else PLAIN)
        if is_daemons:
            line.is_daemons = True
            return True
        channel = self._channels.open_line(device, settings)
        if not channel:
            return self._open_silent(line, device)
        log = self._log(line, device, _settings_text(settings))
        line.wire = wire = self._connections[channel] = LineConnection(channel, self._channels, self._scheduler, log)
        try:
            until = self._scheduler.now + OPEN_TICKS
            while wire.is_opening:
                if not wire.wait(said("{called} to open", called=_called(device)), until):
                    wire.close(
                        said("no answer within {seconds:g} s: it does not open", seconds=seconds(OPEN_TICKS)),
                        is_late=True,
                    )
        finally:
            if line.wire is wire and not wire.is_open:
                line.close(self._connections)
        if wire.is_closed and line.wire is None and wire.error is ChannelError.NOTHING_BOUND:
            return self._open_silent(line, device)
        if not wire.is_open:
            reason = wire.reason or "it was configured by another thread meanwhile"
            self._warn_once(
                f"line {device} {reason}",
                said("{called} cannot be opened: {reason}", called=_called(device), reason=reason),
            )
        return wire.is_open

    def _open_silent(self, line: SerialLine, device: str) -> bool:
        line.wire = SilentLineConnection(self._scheduler, self._log(line, device, NOT_CONNECTED))
        text = said(
            "{not_connected} to {called}: it is open, and silent", not_connected=NOT_CONNECTED, called=_called(device)
        )
        self._warn_once(f"line {device} silent", text, code=BARRED, hint=bind_hint(device))
        return True

    def _log(self, line: SerialLine, device: str, where: str) -> ChannelLog:
        # Of an exchange with a slave its meaning is recorded, in `_ask`.
        return ChannelLog(self._traffic, "serial", PORT_NAMES.get(device, device), where, has_bytes=line.mode == PLAIN)

    def disable(self, device: str) -> None:
        """Close a port; no effect on a closed one."""
        line = self._lines.get(device)
        if line is not None:
            line.close(self._connections)

    def is_open(self, device: str) -> bool:
        """Return whether a port is enabled."""
        line = self._lines.get(device)
        return line is not None and line.is_open

    def open_devices(self) -> list[str]:
        """Return devices of the ports that are enabled, sorted."""
        return sorted(device for device, line in self._lines.items() if line.is_open)

    def mode(self, device: str) -> str:
        """`RS485`, `MODBUS-RTU` or `CLOSE`."""
        return self._lines[device].mode if self.is_open(device) else CLOSED

    def _usable(self, device: str, mode: str) -> tuple[SerialLine, LineConnection] | None:
        """Return the port, if it is open in a mode; otherwise warn.

        Raises:
            ScriptPermissionError: it belongs to a daemon.
        """
        line = self._lines.get(device)
        if line is not None and line.is_daemons:
            text = said("{called} belongs to a daemon (usage 1); programs may not use it", called=_called(device))
            raise ScriptPermissionError(text, value=1, limit="usage 0", hint="configure it with usage=0")
        if line is None or line.wire is None:
            self._warn_once(f"line {device} closed", said("{called} is not enabled", called=_called(device)))
        elif not line.wire.is_open:
            reason = line.wire.reason or "its device has gone"
            self._warn_once(
                f"line {device} {reason}", said("{called} is closed: {reason}", called=_called(device), reason=reason)
            )
        elif line.mode != mode:
            self._warn_once(
                f"line {device} {mode}",
                said("{called} is in mode {mode}, not {wanted}", called=_called(device), mode=line.mode, wanted=mode),
            )
        else:
            return line, line.wire
        return None

    # ---------------------------------------------------------------- plain bytes

    def read(self, device: str, count: int, timeout_s: float) -> bytes:
        """Read bytes; fewer if time is up or the port closes. A secondary program does not wait.

        A read of a port that is not open in plain mode takes one tick.

        Args:
            device: the port.
            count: how many bytes.
            timeout_s: longest time to wait; 0 and less wait for ever.

        Raises:
            ScriptPermissionError: the port belongs to a daemon.
            Stopped: the thread was stopped.
        """
        deadline = Deadline(self._scheduler, timeout_s)
        reason = said("{count} bytes on {called}", count=count, called=_called(device))
        found = self._usable(device, PLAIN)
        if found is None:
            self._let_time_go_by(reason)
            return b""
        line, wire = found
        if count <= 0 or not line.readers.take(reason, deadline.tick):
            return b""
        try:
            return self._read(wire, device, count, reason, deadline)
        finally:
            line.readers.give()

    def _read(self, wire: LineConnection, device: str, count: int, reason: str, deadline: Deadline) -> bytes:
        data = bytearray()
        is_last = self._scheduler.caller.is_secondary
        if is_last and len(wire.received) < count:
            self._warn_once(f"sec read {device}", said(NOT_ALL_THERE, what=_called(device)))
        is_late = False
        while True:
            size = min(count - len(data), len(wire.received))
            data += wire.received[:size]
            wire.drop(size)
            if len(data) == count or is_last or not wire.is_open:
                if is_late and len(data) < count:
                    wire.log.timed_out(f"{count - len(data)} of {reason} have not come in time")
                    if data:
                        from elitescript.messages.observations import ReadingEnded

                        came = said("{came} of {count} bytes", came=len(data), count=count)
                        wire.log.observe(ReadingEnded, bytes(data[:DATA_MAX]), "count", came, 0.0)
                return bytes(data)
            is_last = is_late = wire.wait_for_more(reason, deadline)

    def write(self, device: str, data: bytes, *, is_text: bool = False) -> int | None:
        """Send bytes, waiting for room if the line is behind by `CHANNEL_WINDOW`.

        A secondary program and a stopped thread do not wait: their bytes are sent as soon as there is room.

        Returns:
            How many were sent; None if the port is not open in plain mode.

        Raises:
            ScriptPermissionError: the port belongs to a daemon.
            Stopped: the thread was stopped.
        """
        found = self._usable(device, PLAIN)
        if found is None:
            return None
        _, wire = found
        waits = not (self._scheduler.caller.is_dying or self._scheduler.caller.is_secondary)
        if not waits and wire.queued - wire.sent > CHANNEL_WINDOW:
            return 0
        data = bytes_without_addresses(data)
        wire.send(data)
        if is_text and not data.isascii():
            from elitescript.messages.observations import TextBeyondAscii

            wire.log.observe(TextBeyondAscii, data[:DATA_MAX].decode("utf-8", "ignore"))
        end = wire.queued
        while waits and wire.sent < end and wire.is_open:
            wire.wait(said("room to send on {called}", called=_called(device)), None)
        return len(data) - max(0, end - wire.sent) if waits else len(data)

    def tell_left(self) -> None:
        """Let observers see what has come and was not read: the program is over. The data stays for the next one."""
        for line in self._lines.values():
            if line.mode == PLAIN and line.wire is not None and line.wire.received and not line.is_daemons:
                line.wire.log.left(bytes(line.wire.received))

    def flush(self, device: str) -> None:
        """Drop received bytes that are not read; bytes to be sent stay (*assumed*).

        Raises:
            ScriptPermissionError: the port belongs to a daemon.
        """
        found = self._usable(device, PLAIN)
        if found is not None:
            found[1].drop(len(found[1].received))

    # ---------------------------------------------------------------- MODBUS

    def read_slave(
        self, device: str, slave: int, function: int, address: int, count: int, timeout_s: float, *, is_polled: bool
    ) -> tuple[int, ...] | None:
        """Read values of a slave; return None, with a warning, if that fails.

        Args:
            device: the port.
            slave: number of the slave.
            function: 1 to 4.
            address: first address.
            count: how many values.
            timeout_s: longest time to wait, for other threads and for the response; 0 and less wait for ever.
            is_polled: whether a secondary program does not wait; else it waits as long as it may run.

        Raises:
            ScriptPermissionError: the port belongs to a daemon.
            Stopped: the thread was stopped.
        """
        last = said(" to {address}", address=address + count - 1) if count > 1 else ""
        request = pdu.read(function, address, count)
        return self._ask(device, slave, request, timeout_s, f"{address}{last}", is_polled=is_polled)

    def write_slave(
        self,
        device: str,
        slave: int,
        function: int,
        address: int,
        values: tuple[int, ...],
        timeout_s: float,
        *,
        is_polled: bool,
    ) -> bool:
        """Write values to a slave, by function 5, 6, 15 or 16; see `read_slave`."""
        match function:
            case pdu.WRITE_COIL:
                request = pdu.write_coil(address, values[0])
            case pdu.WRITE_REGISTER:
                request = pdu.write_register(address, values[0])
            case pdu.WRITE_COILS:
                request = pdu.write_coils(address, values)
            case _:
                request = pdu.write_registers(address, values)
        text = f"{address} = {values[0] if len(values) == 1 else list(values)}"
        return self._ask(device, slave, request, timeout_s, text, is_polled=is_polled) is not None

    def _ask(
        self, device: str, slave: int, request: bytes, timeout_s: float, asked: str, *, is_polled: bool
    ) -> tuple[int, ...] | None:
        caller = self._scheduler.caller
        waits = not caller.is_secondary
        if caller.is_secondary and not is_polled and caller.until_tick is not None:
            # One tick is left in which the program goes on.
            left_s = seconds(caller.until_tick - self._scheduler.now - 1)
            waits, timeout_s = left_s > 0.0, min(timeout_s, left_s) if timeout_s > 0.0 else left_s
        deadline = Deadline(self._scheduler, timeout_s)
        reason = said("the answer of slave {slave} on {called}", slave=slave, called=_called(device))
        found = self._usable(device, MODBUS)
        if found is None:
            self._let_time_go_by(reason)
            return None
        line, wire = found
        if not line.masters.take(reason, deadline.tick, waits=waits):
            self._say(device, slave, "another thread asks a slave")
            return None
        try:
            # During the wait the port may have been configured anew.
            if line.wire is not wire or not wire.is_open:
                why = "the port was closed"
            elif not self._wait_for_quiet(line, wire, reason, deadline, waits=waits):
                why = "the line is not silent"
            else:
                wire.log.note("sent", cut(f"slave {slave}: {FUNCTIONS[request[0]]} {asked}"))
                exchange = RtuExchange(slave, request)
                values, why = self._exchange(line, wire, exchange, reason, deadline, waits=waits)
                if not why:
                    wire.log.note("received", cut(f"slave {slave}: {', '.join(map(str, values)) or 'done'}"))
                    return values
                if wire.is_open:
                    wire.log.timed_out(f"slave {slave}: {why}")
            self._say(device, slave, why)
            return None
        except ExceptionResponse as error:
            wire.log.note("refused", f"slave {slave}: {error}")
            self._say(device, slave, said("it refuses: {error}", error=error))
            return None
        finally:
            self._clear(line, wire)
            line.masters.give()

    def _wait_for_quiet(
        self, line: SerialLine, wire: LineConnection, reason: str, deadline: Deadline, *, waits: bool
    ) -> bool:
        """Drop bytes that come before a request until the line is silent; return whether it is so in time."""
        while True:
            if line.repeated and wire.received.startswith(line.repeated):
                # The echo was taken for the response.
                line.has_echo = True
            if wire.has_heard:
                self._clear(line, wire)
            now = self._scheduler.now
            if now >= line.quiet_tick:
                line.repeated = b""
                return True
            if not waits or deadline.is_over or not wire.is_open:
                return False
            until = deadline.tick
            wire.wait(reason, line.quiet_tick if until is None else min(until, line.quiet_tick))

    def _exchange(
        self,
        line: SerialLine,
        wire: LineConnection,
        exchange: RtuExchange,
        reason: str,
        deadline: Deadline,
        *,
        waits: bool,
    ) -> tuple[tuple[int, ...], str]:
        """Send a request and wait for its response; return its values, or the reason why there are none.

        Raises:
            DeviceError: the slave refuses.
        """
        wire.send(exchange.frame)
        gap = ticks_for(gap_s(line.settings.character_s))
        line.quiet_tick = self._scheduler.now + line.ticks_of(len(exchange.frame)) + gap
        may_echo = line.has_echo or not exchange.repeats
        is_last = not waits
        while True:
            if may_echo and (end := exchange.echo_end(wire.received)):
                line.has_echo, may_echo = True, False
                wire.drop(end)
            values = exchange.answer(wire.received)
            if values is not None:
                line.has_echo = line.has_echo and not may_echo
                line.repeated = exchange.frame if exchange.repeats and not line.has_echo else b""
                return values, ""
            if not wire.is_open:
                return (), wire.reason or "the port was closed"
            has_begun = exchange.has_begun(wire.received)
            if is_last:
                return (), "its answer is broken" if has_begun else "no answer in time"
            is_last = wire.wait_for_more(reason, deadline, ticks_for(BROKEN_S) if has_begun else None)

    def _clear(self, line: SerialLine, wire: LineConnection) -> None:
        """Drop received bytes; the line was not silent until now."""
        if wire.has_heard:
            wire.has_heard = False
            wire.drop(len(wire.received))
            line.quiet_tick = max(line.quiet_tick, self._scheduler.now + ticks_for(gap_s(line.settings.character_s)))

    def _say(self, device: str, slave: int, why: str) -> None:
        self._warn_once(
            f"slave {device} {slave} {why}",
            said("slave {slave} on {called}: {why}", slave=slave, called=_called(device), why=why),
        )

    # ---------------------------------------------------------------- time

    def _let_time_go_by(self, reason: str) -> None:
        if not self._scheduler.caller.is_secondary:
            self._scheduler.wait(reason, self._scheduler.now + 1)


def _settings_text(settings: LineSettings) -> str:
    parity = "NOE"[settings.parity]
    return f"{settings.baud} {settings.size}{parity}{settings.stop_bits}"


def _called(device: str) -> str:
    return "the serial port of the tool" if device == TOOL else said("the serial port {device}", device=device)
