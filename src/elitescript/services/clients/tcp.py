"""TCP clients: sockets on one side, sans-I/O connections on the other.

What arrives is decoded at once, what a tick gives leaves at once; each message is one write. A client harms no other:

- of what it sends, as much is worked on in a tick as its share of time allows (`shares`); the rest is taken from its
  socket and kept, up to `Connection.kept_max` bytes, so that nothing is lost with the socket if the client closes. So
  it is with one whose connection has enough to work on (`is_busy`), or of whom `POSTED_MAX` inputs wait for the robot;
- one that reads slower than its stream misses samples of the stream (they are counted); one that lets `BACKLOG_MAX`
  bytes pile up, or takes nothing for `STALLED_TICKS`, is cut off;
- one that sends what cannot be is closed;
- one that begins like a web browser is closed before anything of it is read: no page reaches a robot;
- one that is in the middle of a text gets the states of that time after it, `SAMPLE_BACKLOG` bytes at most: what it has
  not read when it closes would reset the connection, and lose what it still holds;
- one that ends its own half is answered what it asked, and gets the stream where the service is one;
- of one that closes at once, or whose connection breaks, everything that had arrived by then is read and counts.
"""

from __future__ import annotations

import asyncio
import os
import select
import socket
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from typing import Any, Final, Protocol

from elitescript.messages.inputs import Input, VariablesArrived
from elitescript.messages.outputs import Output
from elitescript.messages.timing import TICKS_PER_S
from elitescript.protocol.connection import BrowserError, Connection, ProtocolError
from elitescript.protocol.ports import Service
from elitescript.services.clients.shares import READ_MAX, SHARE_NS, Shares

NS_PER_BYTE: Final = 250.0
"""What reading a byte of a client is taken to cost before any has been read."""
HANDING_NS: Final = 5_000
"""What handing one input on to the robot's process takes besides, about."""
POSTED_MAX: Final = 250
"""Inputs of one client that may wait for the robot."""
KEPT_OF_ALL_MAX: Final = 128 * 1024 * 1024
"""Bytes of all clients of a robot that are kept; beyond that they stay in the sockets."""
TAKEN_AT_ONCE: Final = 64 * 1024
"""Bytes that are taken from a socket at once to be kept."""
SAMPLE_BACKLOG: Final = 64 * 1024
"""Bytes that wait for a client, besides what the operating system holds, from which on samples are left out."""
BACKLOG_MAX: Final = 1024 * 1024
STALLED_TICKS: Final = 30 * TICKS_PER_S
GREETING_TICKS: Final = TICKS_PER_S // 50
"""How long a client that may send a text has to begin with it before its stream begins."""
LINGER_TICKS: Final = 5 * TICKS_PER_S
"""How long a client that has ended its half, or is to be closed, has to take what it asked for."""


class Hub(Protocol):
    """The robot server as its clients see it."""

    shares: Shares
    """The time that clients have."""

    @property
    def output(self) -> Output:
        """Of the last tick."""

    def post(self, inputs: list[Input]) -> int:
        """Take inputs for the next tick that begins; return its number."""

    def waiting_of(self, origin: str) -> int:
        """Return how many inputs of a client could not go in at the last tick."""

    def wake(self) -> None:
        """Let time go on, if it waited: a client that owes an input has sent something, has read, or goes."""

    def make_due(self) -> object:
        """Let the next tick run, whether anything else is due in it or not: a client has come, or was read."""

    def note(self, kind: str, text: str, *, is_problem: bool = False, **details: Any) -> None:
        """Write a line of the log."""


class Client(asyncio.BufferedProtocol):
    """One client: its socket and its connection.

    Args:
        hub: the robot.
        service: where it came in.
        connection: decodes and encodes its bytes.
        forget: called once when it has gone.
        refuse: called with the reason if it is a web browser.

    Attributes:
        peer: its address, once it is connected.
        dropped: samples that it has missed.
        owes_input: whether it has got a sample since its last input package.
        expected_ns: what it will take to read it once more, see `shares.Waiting`.
    """

    __slots__ = (
        "_buffer",
        "_deadline",
        "_descriptor",
        "_forget",
        "_held",
        "_held_bytes",
        "_hub",
        "_is_attended",
        "_is_full",
        "_is_gone",
        "_is_light",
        "_is_paused",
        "_is_prompt",
        "_is_silent",
        "_is_waiting",
        "_kept",
        "_late_ns",
        "_left",
        "_ns_per_byte",
        "_refuse",
        "_sees_end",
        "_service",
        "_size",
        "_spent_ns",
        "_stalled_since",
        "_streams_from",
        "_transport",
        "connection",
        "dropped",
        "expected_ns",
        "owes_input",
        "peer",
    )

    def __init__(
        self,
        hub: Hub,
        service: Service,
        connection: Connection,
        forget: Callable[[str], None],
        refuse: Callable[[str], None],
    ) -> None:
        self._hub = hub
        self._service = service
        self._forget = forget
        self._refuse = refuse
        self._buffer = memoryview(bytearray(READ_MAX))
        self._size = READ_MAX
        self._ns_per_byte = NS_PER_BYTE
        self._transport: asyncio.Transport | None = None
        self._descriptor = -1
        """Of the socket, while it is held."""
        self._is_prompt = True
        """Whether all that was read directly since the last sample was the answer to it."""
        self._left: socket.socket | None = None
        """What is to be read of a connection that broke."""
        self._kept = bytearray()
        """What was taken from the socket and is to be worked on."""
        self._is_full = False
        """Whether no more can be kept, so that the rest stays in the socket."""
        self._sees_end = False
        """Whether the client has ended its half behind what is kept."""
        self._is_gone = False
        """Whether the connection is over, and there is something of it to be worked on."""
        self._held: list[bytes] = []
        """What it gets once the text that it is sending has ended, see `_is_held`."""
        self._held_bytes = 0
        self._streams_from = 0
        """Tick from which on it is sent something, if it takes texts."""
        self._is_light = True
        self._is_silent = False
        self._is_paused = False
        self._is_waiting = False
        self._spent_ns = self._late_ns = 0
        self._stalled_since: int | None = None
        self._deadline: int | None = None
        self.connection = connection
        connection.attend = self._attend
        self._is_attended = False
        self.peer = ""
        self.dropped = 0
        self.owes_input = False
        self.expected_ns = 0

    @property
    def origin(self) -> str:
        """Its name, in inputs and in the log."""
        return self.connection.origin

    # ---------------------------------------------------------------- called by the event loop

    def connection_made(self, transport: Any) -> None:
        self._transport = transport
        self._streams_from = self._hub.output.tick + GREETING_TICKS
        transport.set_write_buffer_limits(high=SAMPLE_BACKLOG, low=SAMPLE_BACKLOG // 4)
        address = transport.get_extra_info("peername")
        self.peer = f"{address[0]}:{address[1]}" if address else "?"
        text = f"{self.origin}: connected from {self.peer}"
        self._hub.note("connected", text, origin=self.origin, peer=self.peer)
        self._write()

    def get_buffer(self, sizehint: int) -> memoryview:
        if self._is_paused:
            if len(self._buffer) < TAKEN_AT_ONCE:
                self._buffer = memoryview(bytearray(TAKEN_AT_ONCE))
            return self._buffer
        return self._buffer[: self._portion()]

    def _portion(self) -> int:
        """Return how many bytes are worked on at once."""
        self._size = self._hub.shares.size_for(self._ns_per_byte)
        return self._size

    def buffer_updated(self, nbytes: int) -> None:
        if self._deadline is not None:
            return
        data = bytes(self._buffer[:nbytes])
        is_paused = self._is_paused
        if is_paused:
            self._keep(data)
        if nbytes == (len(self._buffer) if is_paused else self._size):
            self._drain()
        if is_paused:
            return
        # Whatever it is, time may have waited for it.
        is_asked = self.owes_input
        self._read(data)
        if is_asked:
            self._hub.wake()
        if self._kept and not self._is_paused:
            self._is_paused = True
            self._work_on_kept()

    def _drain(self) -> None:
        """Take all that is in the socket now: what the client still holds when it closes is lost."""
        assert self._transport is not None
        raw = self._transport.get_extra_info("socket")
        try:
            while raw is not None and not self._is_full:
                data = os.read(raw.fileno(), TAKEN_AT_ONCE)
                self._keep(data)
                if len(data) < TAKEN_AT_ONCE:
                    return
        except OSError:
            # Nothing more is there, or the event loop sees what is wrong.
            return

    def _keep(self, data: bytes) -> None:
        """Keep what has come until it is the client's turn."""
        self._kept += data
        self._hub.shares.kept += len(data)
        if len(self._kept) >= self.connection.kept_max or self._hub.shares.kept >= KEPT_OF_ALL_MAX:
            self._is_full = True
            assert self._transport is not None
            self._transport.pause_reading()

    def _read(self, data: bytes) -> None:
        """Work on what has come, at the expense of the client's share."""
        start_ns, nbytes = time.thread_time_ns(), len(data)
        count = self._take_in(data)
        if count is None:
            return
        self._account(nbytes, time.thread_time_ns() - start_ns + HANDING_NS * count)
        if self.connection.is_over:
            self._finish()
        elif self.connection.is_busy or self._has_taken_enough(nbytes):
            self._pause()

    def _take_in(self, data: bytes) -> int | None:
        """Hand on what has come; return the number of inputs, or None if the client was closed for what it sent."""
        connection, hub = self.connection, self._hub
        hub.make_due()
        try:
            inputs = connection.take_in(data, hub.output)
        except BrowserError as error:
            self._end_browser(str(error))
            return None
        except ProtocolError as error:
            self._offend(str(error))
            return None
        except Exception:
            self._fail()
            return None
        if inputs:
            connection.posted(hub.post(inputs))
            if self.owes_input:
                self.owes_input = VariablesArrived not in map(type, inputs)
        self._write()
        return len(inputs)

    def _end_browser(self, why: str) -> None:
        """End the connection of a web browser; nothing of it counts."""
        self._is_silent = True
        self.owes_input = False
        self.connection.closed()
        self._refuse(f"{self.origin} from {self.peer}: closed: {why}")
        self.abort()

    def _account(self, size: int, spent_ns: int) -> None:
        whole_ns, self._late_ns = spent_ns + self._late_ns, 0
        self._ns_per_byte = (self._ns_per_byte + whole_ns / size) / 2
        self._spent_ns += spent_ns
        # One that has sent more than was read takes all that it gets.
        self.expected_ns = whole_ns if size < self._size else max(whole_ns, SHARE_NS)
        self._hub.shares.charge(spent_ns)

    def _has_taken_enough(self, size: int) -> bool:
        """Return whether the rest must wait for a later tick."""
        self._is_light = size < self._size
        if self._hub.shares.is_used_up(self._spent_ns, is_light=self._is_light):
            return True
        return self._hub.waiting_of(self.origin) >= POSTED_MAX

    def eof_received(self) -> bool:
        if self._kept:
            self._sees_end = True
        else:
            self._end_of_half()
        return True

    def _end_of_half(self) -> None:
        """Take note that the client sends no more."""
        self._sees_end = False
        self._end_of_input()
        if not self._service.outlives_silence and self._deadline is None:
            self._deadline = self._hub.output.tick + LINGER_TICKS
            self._close_unless_expecting()
        self._hub.wake()

    def connection_lost(self, exc: Exception | None) -> None:
        reason = f": {exc}" if exc else ""
        self._hub.note("gone", f"{self.origin}: gone{reason}", origin=self.origin, dropped=self.dropped)
        transport, self._transport = self._transport, None
        if exc is not None and transport is not None and self._deadline is None and not self._is_silent:
            # A client that closes without having read its stream resets the connection. What it sent before waits in
            # the socket still, which the transport is about to close.
            with suppress(OSError):
                self._left = transport.get_extra_info("socket").dup()
        if self._left is not None:
            self._left.setblocking(False)
        if self._left is None and (exc is None or not self._kept or self._is_silent or self._deadline is not None):
            self._part()
            return
        self._is_gone = self._is_paused = True
        self._stalled_since = None
        self.owes_input = False
        self._hub.wake()
        self._read_left()

    def pause_writing(self) -> None:
        self._stalled_since = self._hub.output.tick
        self.connection.is_behind = True

    def resume_writing(self) -> None:
        self._stalled_since = None
        self.connection.is_behind = False
        # The transport is in the middle of writing, and ticks that run at once could close it.
        asyncio.get_running_loop().call_soon(self._hub.wake)

    # ---------------------------------------------------------------- read past the event loop, see `direct`

    def hold(self) -> int:
        """Take the socket from the event loop; return its descriptor, or -1 if the client is not to be read now."""
        transport = self._transport
        if transport is None or self._deadline is not None or self._is_paused:
            return -1
        if not (self._is_prompt and transport.is_reading()):
            return -1
        transport.pause_reading()
        self._descriptor = transport.get_extra_info("socket").fileno()
        return self._descriptor

    def read_held(self) -> bool:
        """Read the socket once; return False if that is a matter of the event loop: an end, an error, a closed client.

        The time that it takes is not charged: nobody else waits for the robot meanwhile. That holds for an answer; a
        client that sends anything else instead is read at the expense of its share up to the next sample.
        """
        transport = self._transport
        if transport is None or transport.is_closing() or self._is_paused:
            return False
        is_asked = self.owes_input
        try:
            size = os.readv(self._descriptor, [self._buffer[:READ_MAX]])
        except OSError:
            # Nothing that had arrived is lost by that.
            self.abort()
            return False
        if not size:
            return False
        if self._take_in(bytes(self._buffer[:size])) is not None:
            if self.connection.is_over:
                self._finish()
            elif self.connection.is_busy:
                self._pause()
        self._is_prompt = is_asked and not self.owes_input
        return self._is_prompt

    def give_back(self) -> None:
        """Leave the socket to the event loop again."""
        if self._transport is not None and not self._transport.is_closing() and not self._is_full:
            self._transport.resume_reading()

    # ---------------------------------------------------------------- called in a tick

    @property
    def is_behind(self) -> bool:
        """Whether so much waits for it that it misses samples."""
        return self._stalled_since is not None

    @property
    def is_leaving(self) -> bool:
        """Whether it has ended its half, is to be closed, or has gone."""
        return self._deadline is not None or self._is_gone

    def next_tick(self, tick: int) -> int | None:
        """Return the next tick after `tick` that must run for it though nothing happens in it; None if none must."""
        if self._is_paused or self._held or self._deadline is not None or self._stalled_since is not None:
            return tick + 1
        connection = self.connection
        return tick + 1 if connection.reads(tick + 1) else connection.next_tick(tick)

    def publish(self, output: Output) -> None:
        """Give the client a tick."""
        connection = self.connection
        if connection.is_busy:
            # What it has sent before is worked on now, and is paid for as if it had just been read.
            start_ns = time.thread_time_ns()
            self._give(connection, output)
            spent_ns = time.thread_time_ns() - start_ns
            self._late_ns += spent_ns
            self._hub.shares.charge(spent_ns)
        else:
            self._give(connection, output)

    def _give(self, connection: Connection, output: Output) -> None:
        try:
            connection.publish(output)
            inputs = connection.due()
        except ProtocolError as error:
            self._offend(str(error))
            return
        except Exception:
            self._fail()
            return
        if inputs:
            self._hub.post(inputs)
        self._write()
        if self._deadline is not None:
            if output.tick >= self._deadline:
                self.abort()
            else:
                self._close_unless_expecting()
        elif connection.is_over:
            self._finish()
        elif self._stalled_since is not None and output.tick - self._stalled_since > STALLED_TICKS:
            self._cut_off(f"has read nothing for {STALLED_TICKS // TICKS_PER_S} s")
        elif self._is_paused:
            self.read_on()
        else:
            self._spent_ns = 0

    def relieve(self) -> None:
        """Go on with what needs no tick, while none comes."""
        connection = self.connection
        try:
            inputs = connection.read_on(self._hub.output)
        except ProtocolError as error:
            self._offend(str(error))
            return
        except Exception:
            self._fail()
            return
        if inputs:
            self._hub.post(inputs)
        self._write()
        if connection.is_over and self._deadline is None:
            self._finish()
        else:
            self.read_on()

    def read_on(self) -> None:
        """Take a place among those that wait to be read: a tick has gone by."""
        if self._is_paused and not self._is_waiting and self._may_be_read():
            self._is_waiting = True
            self._hub.shares.wait(self, is_light=self._is_light)
        self._spent_ns = 0

    def go_on(self) -> None:
        """Read on now."""
        self._is_waiting = False
        if self._is_gone:
            self._read_left()
        elif self._transport is not None and not self._transport.is_closing():
            self._work_on_kept()
            if not self._kept and self._may_be_read() and self._deadline is None:
                self._is_paused = False
                if self._sees_end:
                    self._end_of_half()

    def _work_on_kept(self) -> None:
        """Work on what is kept, as much as the client's share allows."""
        while self._kept and self._deadline is None and self._may_be_read():
            data = bytes(self._kept[: self._portion()])
            del self._kept[: len(data)]
            self._note_taken(len(data))
            is_asked = self.owes_input
            self._read(data)
            if is_asked:
                self._hub.wake()
            # Not more than its share: what it takes beyond that, those that wait behind it lack.
            if self._has_taken_enough(len(data)) or self._spent_ns + self._ns_per_byte * len(data) > SHARE_NS:
                break

    def _note_taken(self, count: int) -> None:
        """Note that so many bytes are not kept any more: there is room for others."""
        self._hub.shares.kept -= count
        if not self._is_full:
            return
        has_room = len(self._kept) < self.connection.kept_max // 2 and self._hub.shares.kept < KEPT_OF_ALL_MAX
        # Others may hold all that there is: each gets on all the same.
        if has_room or not self._kept:
            self._is_full = False
            if self._transport is not None and not self._transport.is_closing():
                self._transport.resume_reading()

    def _may_be_read(self) -> bool:
        if self.connection.is_busy or self.is_behind:
            return False
        return self._hub.waiting_of(self.origin) < POSTED_MAX

    def close(self) -> None:
        """End the connection once what waits has been sent."""
        if self._transport is not None:
            self._transport.close()
        elif self._is_gone:
            self._part()

    def abort(self) -> None:
        """End the connection at once."""
        if self._transport is not None:
            self._transport.abort()
        elif self._is_gone:
            self._part()

    # ---------------------------------------------------------------- inside

    def _attend(self) -> None:
        """Look at the connection in the next turn of the event loop."""
        if not self._is_attended:
            self._is_attended = True
            asyncio.get_running_loop().call_soon(self._attended)

    def _attended(self) -> None:
        self._is_attended = False
        self._write()
        if self.connection.is_over and self._deadline is None:
            self._finish()

    def _write(self) -> None:
        connection, transport = self.connection, self._transport
        if transport is None:
            if self._is_gone:
                # There is no peer any more. Before the connection is made, what is queued is still to be sent.
                connection.take()
            return
        messages = connection.take()
        if not messages and not self._held:
            return
        if self._is_held():
            self._hold_back(messages)
            return
        if self._held:
            messages, self._held, self._held_bytes = self._held + messages, [], 0
        is_sample = self._service.is_sample
        for message in messages:
            if transport.is_closing():
                return
            # Up to `SAMPLE_BACKLOG` the transport does not pause writing.
            backlog = 0 if self._stalled_since is None else transport.get_write_buffer_size()
            if is_sample(message):
                if backlog > SAMPLE_BACKLOG:
                    self._miss()
                    continue
                self.owes_input = self._is_prompt = True
            elif backlog > BACKLOG_MAX:
                self._cut_off(f"does not read: {backlog} bytes wait for it")
                return
            transport.write(message)
        if self._stalled_since is not None:
            self._pause()

    def _is_held(self) -> bool:
        """Return whether nothing is sent to the client for now, since it is in the middle of a text.

        What a client has not read when it closes resets the connection, and what it still holds is lost.
        """
        if not self.connection.takes_texts or self._is_silent or self._sees_end or self._deadline is not None:
            return False
        if self._kept or self.connection.is_uploading or self._hub.output.tick < self._streams_from:
            return True
        # Ticks that catch up with the clock leave the event loop no turn in which to read.
        return self._transport is not None and _has_come(self._transport.get_extra_info("socket"))

    def _hold_back(self, messages: list[bytes]) -> None:
        """Hold messages back until the text of the client has ended; of samples, as many as for a slow reader."""
        for message in messages:
            if self._service.is_sample(message) and self._held_bytes > SAMPLE_BACKLOG:
                self.dropped += 1
                continue
            self._held.append(message)
            self._held_bytes += len(message)
        if self._held_bytes > BACKLOG_MAX:
            self._cut_off(f"does not end its text: {self._held_bytes} bytes wait for it")

    def _miss(self) -> None:
        if not self.dropped:
            text = f"{self.origin}: reads too slowly and misses packages"
            self._hub.note("slow", text, is_problem=True, origin=self.origin)
        self.dropped += 1

    def _pause(self) -> None:
        """Keep what comes from now on, until it is the client's turn."""
        if self._transport is not None and not self._transport.is_closing():
            self._is_paused = True

    def _read_left(self) -> None:
        """Work on what is left of a connection that is over, as much as its share allows; then forget the client."""
        while self._left is not None and not _is_empty(self._left) and len(self._kept) < self.connection.kept_max:
            before = len(self._kept)
            self._kept += self._left.recv(TAKEN_AT_ONCE)
            self._hub.shares.kept += len(self._kept) - before
        self._work_on_kept()
        if not self._kept and (self._left is None or _is_empty(self._left)):
            self._part()

    def _part(self) -> None:
        """Forget the client: it has gone, and all that it sent is read."""
        self._is_gone = False
        self._hub.shares.kept -= len(self._kept)
        self._kept.clear()
        if self._left is not None:
            self._left.close()
            self._left = None
        self.expected_ns = 0
        self._end_of_input()
        self._forget(self.origin)
        self._hub.wake()

    def _end_of_input(self) -> None:
        if self._is_silent:
            return
        self._is_silent = True
        self.owes_input = False
        inputs = self.connection.closed()
        if inputs:
            self._hub.post(inputs)
        self._write()

    def _offend(self, why: str) -> None:
        self._hub.note("offence", f"{self.origin}: closed: {why}", is_problem=True, origin=self.origin)
        self._finish()

    def _cut_off(self, why: str) -> None:
        text = f"{self.origin}: cut off: it {why}"
        self._hub.note("cut_off", text, is_problem=True, origin=self.origin)
        self.abort()

    def _fail(self) -> None:
        """Report a defect of this program and end this client alone."""
        text = f"{self.origin}: internal error, please report it:\n{traceback.format_exc()}"
        self._hub.note("bug", text, is_problem=True, origin=self.origin)
        self.abort()

    def _close_unless_expecting(self) -> None:
        if not self.connection.is_expecting:
            self.close()

    def _finish(self) -> None:
        """Send what is left, then close."""
        if self._deadline is None:
            self._deadline = self._hub.output.tick + LINGER_TICKS
        self._write()
        self.close()


def _has_come(raw: socket.socket | None) -> bool:
    """Return whether something waits in a socket to be read, be it an end."""
    if raw is None or (descriptor := raw.fileno()) < 0:
        return False
    if hasattr(select, "poll"):
        poll = select.poll()
        poll.register(descriptor, select.POLLIN)
        return bool(poll.poll(0))
    return bool(select.select([descriptor], [], [], 0)[0])


def _is_empty(broken: socket.socket) -> bool:
    """Return whether nothing is left to be read of a connection that broke."""
    try:
        return not broken.recv(1, socket.MSG_PEEK)
    except OSError:
        return True
