"""Holds the TCP connections of a program: by name, shared by all of its threads, in virtual time.

The host has the connections of all programs by channel, and hands them their events.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from elitescript.commands.definition.context import Rule
from elitescript.commands.socket_rules import Counted, Floats, Texts, Variable
from elitescript.errors import ScriptStateError
from elitescript.messages.outputs import CHANNEL_WINDOW
from elitescript.messages.timing import TICKS_PER_S, seconds
from elitescript.runtime.connections.connection import NOT_ALL_THERE, Receiver, ScriptConnection
from elitescript.runtime.connections.traffic import DATA_MAX, ChannelLog, Traffic, cut
from elitescript.runtime.environment import Channels, bytes_without_addresses
from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.runtime.threads.strand import Stopped
from elitescript.said import said

CONNECT_TICKS: Final = 2 * TICKS_PER_S
"""Timeout of `socket_open`."""

CONNECTIONS_MAX: Final = 64
"""Most names in use by one program (*assumed*)."""

_READ_LINE_END: Final = 'read it away with socket_read_string(suffix="\\n"), or let the sender leave it out'
_OPEN_FIRST: Final = "open it with socket_open first; every socket has the name that socket_open gives it"
_SHOWN: Final = 253
"""Most characters of an address or a name in a warning: those of a host name."""

_READS: Final = 60
"""Characters of a text that are shown in the encoding that it is in."""
_SEND_UTF8: Final = (
    "let the device send UTF-8, or read the bytes with socket_read_byte_list and decode them: "
    'bytes(data[1:]).decode("gbk")'
)

NO_NETWORK: Final = "this run has no network"


class Sockets:
    """Implements `commands.definition.context.SocketAccess` for one program.

    Args:
        channels: carry the bytes.
        scheduler: runs the threads.
        connections: of every program of the host, by channel.
        traffic: records the traffic.
        warn_once: records a warning, once for each key: key, text, perhaps code and hint.
    """

    __slots__ = ("_by_name", "_channels", "_connections", "_is_over", "_scheduler", "_traffic", "_warn_once")

    def __init__(
        self,
        channels: Channels,
        scheduler: Scheduler,
        connections: dict[int, Receiver],
        traffic: Traffic,
        warn_once: Callable[..., None],
    ) -> None:
        self._channels = channels
        self._scheduler = scheduler
        self._connections = connections
        self._traffic = traffic
        self._warn_once = warn_once
        self._by_name: dict[str, ScriptConnection] = {}
        self._is_over = False

    def open(self, address: str, port: int, name: str) -> bool:
        """Connect to a server, within 2 s; an open connection of that name is kept.

        A thread that opens a name while another one does waits for that attempt (*assumed*).

        Raises:
            ScriptStateError: too many are open.
            Stopped: the thread was stopped.
        """
        if self._scheduler.caller.is_dying or self._is_over:
            raise Stopped
        connection = self._by_name.get(name)
        if connection is not None and connection.is_open:
            if (place := f"{address}:{port}") != connection.log.where:
                from elitescript.messages.observations import OtherServer

                connection.log.observe(OtherServer, connection.log.where, place)
            return True
        is_own = connection is None or not connection.is_opening
        if is_own:
            self.close(name)
            connection = self._begin(address, port, name)
        try:
            until = self._scheduler.now + CONNECT_TICKS
            while connection is not None and connection.is_opening:
                if (
                    not connection.wait(
                        said("{address}:{port} to accept a connection", address=address, port=port), until
                    )
                    and is_own
                ):
                    connection.close(
                        said("no answer within {seconds:g} s", seconds=seconds(CONNECT_TICKS)), is_late=True
                    )
        finally:
            if connection is not None and connection.is_opening and is_own:
                connection.close("its thread was stopped")
        if connection is None or not connection.is_open:
            reason = NO_NETWORK if connection is None else connection.reason or "closed at once"
            shown = address if len(address) <= _SHOWN else f"{address[:_SHOWN]}..."
            if connection is None or not connection.is_barred:
                text = said(
                    "socket {name!r} cannot connect to {shown}:{port}: {reason}",
                    name=name,
                    shown=shown,
                    port=port,
                    reason=reason,
                )
                self._warn_once(f"socket {name} {reason}", text)
            return False
        return True

    def _begin(self, address: str, port: int, name: str) -> ScriptConnection | None:
        if len(self._by_name) >= CONNECTIONS_MAX:
            for closed in [known for known, one in self._by_name.items() if one.is_closed]:
                self.close(closed)
        if len(self._by_name) >= CONNECTIONS_MAX:
            hint = "close those that are done with"
            raise ScriptStateError(
                said("{count} sockets are open already", count=CONNECTIONS_MAX),
                value=name,
                hint=hint,
            )
        log = ChannelLog(self._traffic, "socket", name, f"{address}:{port}")
        channel = self._channels.open(address, port, seconds(CONNECT_TICKS))
        if not channel:
            log.failed(NO_NETWORK)
            return None
        connection = ScriptConnection(channel, self._channels, self._scheduler, log)
        self._by_name[name] = self._connections[channel] = connection
        return connection

    def close(self, name: str) -> None:
        """Close a connection and drop its unread bytes; no effect on an unknown one."""
        connection = self._by_name.pop(name, None)
        if connection is not None:
            connection.close()
            self._connections.pop(connection.channel, None)

    def close_all(self) -> None:
        """Close every connection: the program is over."""
        self._is_over = True
        for name, connection in list(self._by_name.items()):
            if connection.received:
                connection.log.left(bytes(connection.received))
            self.close(name)

    def is_connected(self, name: str) -> bool:
        """Return whether a connection is open."""
        connection = self._by_name.get(name)
        return connection is not None and connection.is_open

    def send(self, name: str, data: bytes, *, is_text: bool = False) -> bool:
        """Send bytes, waiting for room if the peer takes none; return whether the connection is open.

        A stopped thread does not wait: its bytes are sent as soon as there is room.

        Raises:
            Stopped: the thread was stopped.
        """
        connection = self._by_name.get(name)
        if connection is None:
            self._tell_not_open(name, "sent")
            return False
        if not connection.is_open:
            self._tell_closed(connection, "sent")
            return False
        if self._scheduler.caller.is_dying and connection.queued - connection.sent > CHANNEL_WINDOW:
            return False
        connection.send(bytes_without_addresses(data))
        if is_text and not data.isascii():
            from elitescript.messages.observations import TextBeyondAscii

            connection.log.observe(TextBeyondAscii, data[:DATA_MAX].decode("utf-8", "ignore"))
        end = connection.queued
        while connection.sent < end and not self._scheduler.caller.is_dying:
            connection.wait(said("room to send on socket {name!r}", name=name), None)
            if connection.is_closed:
                return False
        return True

    def read(self, name: str, rule: Rule, timeout_s: float) -> Any:
        """Return what a rule takes from the received bytes, waiting while the connection is open.

        A secondary program does not wait; it is warned once if its data was incomplete. A read of a closed connection
        takes one tick, so that a loop around it lets time go by (*assumed*).

        Args:
            name: of the connection.
            rule: takes a value from the received bytes.
            timeout_s: longest time to wait; 0 and less wait for ever.

        Raises:
            Stopped: the thread was stopped.
        """
        connection = self._by_name.get(name)
        reason = said("data on socket {name!r}", name=name)
        if (
            connection is not None
            and self._scheduler.caller.is_secondary
            and rule(connection.received, False)[0] is None
        ):
            self._warn_once(f"sec read {name}", said(NOT_ALL_THERE, what=said("socket {name!r}", name=name)))
        looked = rule
        if connection is None:
            self._tell_not_open(name, "read")
        else:
            if isinstance(rule, Texts):
                looked = self._looking_for_line_end(name, connection, rule)
                looked = self._looking_at_encoding(name, connection, looked)
            connection.rule = rule
            late_data, connection.late_data = connection.late_data, b""
            value = connection.given = connection.read(looked, reason, timeout_s)
            if late_data or connection.late_data:
                self._tell_late(connection, rule, value, timeout_s)
            if value is not None:
                connection.is_behind_numbers = isinstance(rule, Floats) and bool(value)
                if isinstance(rule, Floats) and rule.dropped is not None:
                    from elitescript.messages.observations import NumbersDropped

                    connection.log.observe(NumbersDropped, *rule.dropped)
                return value
            self._tell_closed(connection, "read")
        if not self._scheduler.caller.is_secondary:
            self._scheduler.wait(reason, self._scheduler.now + 1)
        return rule(bytearray(), True)[0] if connection is None else connection.rest(looked)

    def ask(self, name: str, question: bytes, rule: Variable, timeout_s: float) -> int:
        """Send a question and return the number that its answer gives; 0 without one.

        Raises:
            Stopped: the thread was stopped.
        """
        connection = self._by_name.get(name)
        earlier = bytes(connection.received) if connection is not None else b""
        if not self.send(name, question):
            return 0
        value = int(self.read(name, rule, timeout_s))
        if connection is not None and (
            earlier.strip() or rule.odd is not None or (rule.is_late and not connection.late_data)
        ):
            from elitescript.messages.observations import OddAnswer

            asked, before = (cut(part.decode("utf-8", "backslashreplace")) for part in (question.rstrip(), earlier))
            connection.log.observe(OddAnswer, asked, before, rule.odd, rule.is_late)
        return value

    def _tell_late(self, connection: ScriptConnection, rule: Rule, value: Any, timeout_s: float) -> None:
        """Let observers see that a reading has ended by its timeout with data there, or that the next one has not."""
        if not connection.late_data:
            if value:
                from elitescript.messages.observations import ReadingResumed

                connection.log.observe(ReadingResumed)
        elif isinstance(rule, Counted | Floats | Texts):
            from elitescript.messages.observations import ReadingEnded

            data = connection.late_data
            connection.log.observe(ReadingEnded, data[:DATA_MAX], *rule.lacks(data), timeout_s)

    def _tell_closed(self, connection: ScriptConnection, done: str) -> None:
        """Let observers see the first use of a connection that its peer has closed."""
        if connection.is_closed and not connection.is_close_told:
            from elitescript.messages.observations import PeerClosed

            connection.is_close_told = True
            connection.log.observe(PeerClosed, done, connection.reason)

    def _tell_not_open(self, name: str, done: str) -> None:
        shown = name if len(name) <= _SHOWN else f"{name[:_SHOWN]}..."
        text = said("there is no open socket {shown!r}: nothing is {done}", shown=shown, done=done)
        self._warn_once(f"socket {name} not open", text, hint=_OPEN_FIRST)

    def _looking_for_line_end(self, name: str, connection: ScriptConnection, rule: Texts) -> Rule:
        """Return the rule; if it reads text after numbers, one that warns of a line end left by these."""
        if not connection.is_behind_numbers or rule.prefix or isinstance(rule, Variable):
            return rule

        def looking(data: bytearray, is_last: bool) -> tuple[Any, int]:
            value, used = rule(data, is_last)
            if used and data.startswith((b"\r", b"\n")):
                text = said(
                    "the text read from socket {name!r} begins with the line end that socket_read_ascii_float has left",
                    name=name,
                )
                self._warn_once(f"line end {name}", text, code="W272", hint=_READ_LINE_END)
            return value, used

        return looking

    def _looking_at_encoding(self, name: str, connection: ScriptConnection, rule: Rule) -> Rule:
        """Return a rule for text, which warns once a connection of bytes that are GBK."""

        def looking(data: bytearray, is_last: bool) -> tuple[Any, int]:
            value, used = rule(data, is_last)
            # Of a time-out nothing is used: the mark that the text waits for was perhaps there, in the other encoding.
            part = data[:used] if used or not is_last else data
            if part.isascii():
                return value, used
            from elitescript.text_encoding import likely_gbk

            if (reads := likely_gbk(bytes(part))) is not None:
                shown = _cut(reads.strip())
                text = said(
                    "the text that came from socket {name!r} looks like GBK, not UTF-8: as GBK it reads {shown!r}",
                    name=name,
                    shown=shown,
                )
                self._warn_once(f"encoding {connection.channel}", text, code="W275", hint=_SEND_UTF8)
            return value, used

        return looking


def _cut(text: str) -> str:
    return text if len(text) <= _READS else f"{text[:_READS]}..."
