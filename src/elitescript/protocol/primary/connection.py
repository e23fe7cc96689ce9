"""Connections of the primary port and its variants: robot state and messages out, programs and plain commands in.

State is sent from accept on, at the rate of the port, on ticks that all clients share, so that the bytes of a tick are
packed once. Robot messages follow the events of a tick. The vendor's client takes one message in 10 ms, so they leave
at least `SPACING_TICKS` apart, from a bounded queue.

Received are programs, secondary programs, bare lines and plain commands, without lengths and without a reply. In local
control all of them are refused with a warning, *assumed*: the behaviour of a controller is not known. A plain command
with an invalid argument is a warning too, a program without its end a script exception.
"""

from __future__ import annotations

import re
from collections import deque
from typing import ClassVar, Final

from elitescript.language.limits import MAX_UNIT_BYTES
from elitescript.language.text.units import SILENCE_S, DiscardedText, Unit, UnitSplitter
from elitescript.messages.inputs import AddLog, Do, Input, RunUnit
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot import RobotDescription
from elitescript.messages.timing import TICKS_PER_S, ticks_for
from elitescript.protocol.connection import Connection, ProtocolError
from elitescript.protocol.garbage import GarbageBurst
from elitescript.protocol.primary.commands import is_command, request_of
from elitescript.protocol.primary.messages import (
    TERMINATOR,
    WARNING,
    RobotMessage,
    RobotMessageQueue,
    error_message,
    exception_message,
    message_of,
    version_message,
)
from elitescript.protocol.primary.packets import ASSUMED, DOCUMENTED, STATE_PARTS, SUB_MESSAGES, pack_state
from elitescript.records import NamedTuple

SPACING_TICKS: Final = 7
"""Between two robot messages: with ten states they stay below 50 messages a second."""
UNITS_PER_TICK: Final = 2
"""Units of one client that are read in one tick, about 2 ms of work; further ones wait. *Assumed.*"""
MAX_UNITS_AT_ONCE: Final = 500
"""Limit of units that wait when a client closes; further ones are refused. *Assumed.*"""
LINES_AT_ONCE: Final = 50
BYTES_AT_ONCE: Final = 4096
MAX_LINES_PER_TICK: Final = 500
MAX_BYTES_PER_TICK: Final = 16 * 1024
"""Limits of the text of one client that is read in one tick, about 1 ms of work; the rest waits."""
MAX_WAITING_BYTES: Final = MAX_UNIT_BYTES + 1024 * 1024
"""A program of the greatest size, and what was sent around it."""
SILENCE_TICKS: Final = ticks_for(SILENCE_S)
MAX_SILENT_LINE_BYTES: Final = 16 * 1024
"""A longer line is complete only with its line feed; silence does not end it."""

_LOCAL: Final = "refused: the robot is in local control; switch it to remote control to run programs and commands"
_DAMAGED: Final = "some bytes of a program are not UTF-8; each was replaced by U+FFFD"
_READS: Final = 60
"""Characters of a text that are shown in the encoding that it is in."""


def _encoding_warning(unit: Unit) -> str:
    """Return what is wrong with the bytes of a program; empty if nothing is."""
    if not unit.damaged:
        return ""
    return f"{_DAMAGED}; as GBK it reads `{unit.reads.strip()[:_READS]}`" if unit.reads else _DAMAGED


class PrimaryPort(NamedTuple):
    """Properties of one of the ports."""

    name: str
    number: int
    rate: int
    """Robot states per second."""
    sends_messages: bool
    takes_programs: bool
    evidence: str
    summary: str

    @property
    def period_ticks(self) -> int:
        """Ticks between two states."""
        return TICKS_PER_S // self.rate


PRIMARY: Final = PrimaryPort("primary", 30001, 10, True, True, DOCUMENTED, "state, messages, programs")
SECONDARY: Final = PrimaryPort("secondary", 30002, 10, False, True, ASSUMED, "state and programs, no messages")
REALTIME: Final = PrimaryPort("realtime", 30003, 125, False, True, ASSUMED, "state at a high rate, programs")
READ_ONLY: Final = PrimaryPort(
    "readonly", 30011, 10, True, False, ASSUMED, "as the primary port; what comes in is ignored"
)

PORTS: Final[tuple[PrimaryPort, ...]] = (PRIMARY, SECONDARY, REALTIME, READ_ONLY)


_counts: Final = re.compile(rb"[\r\n][^ \t\r\n]|['\"#\\\x80-\xff]").search
"""Finds what a line is looked at for: that it is not indented, and so may end a program or begin one; strings."""


class PrimaryFeed:
    """Messages for all clients of one port: each state and each event is packed once.

    Args:
        description: the robot.
        port: which port.
        terminator: end of the texts of messages.
        sends_version: whether to greet with a version message.
    """

    __slots__ = (
        "_messages",
        "_messages_of",
        "_state",
        "_state_of",
        "description",
        "port",
        "sends_version",
        "terminator",
    )

    def __init__(
        self,
        description: RobotDescription,
        port: PrimaryPort = PRIMARY,
        *,
        terminator: bytes = TERMINATOR,
        sends_version: bool = False,
    ) -> None:
        self.description = description
        self.port = port
        self.terminator = terminator
        self.sends_version = sends_version
        self._state_of: Output | None = None
        self._state = b""
        self._messages_of: Output | None = None
        self._messages: tuple[RobotMessage, ...] = ()

    def state(self, output: Output) -> bytes:
        """Return the robot-state message of a tick."""
        if self._state_of is not output:
            self._state = pack_state(SUB_MESSAGES, output.snapshot, self.description)
            self._state_of = output
        return self._state

    def messages(self, output: Output) -> tuple[RobotMessage, ...]:
        """Return the robot messages of a tick."""
        if self._messages_of is not output:
            found = [message_of(event, self.terminator) for event in output.events]
            self._messages = tuple(message for message in found if message is not None)
            self._messages_of = output
        return self._messages


class PrimaryConnection(Connection):
    """One client.

    Args:
        origin: names the client.
        description: the robot.
        feed: shared with the other clients of the port, and which port it is; by default a primary port.
    """

    __slots__ = (
        "_burst",
        "_bytes_left",
        "_feed",
        "_has_noted_unread",
        "_is_greeted",
        "_is_remote",
        "_line_bytes",
        "_lines_left",
        "_next_message_at",
        "_next_state_at",
        "_raw",
        "_ready",
        "_received_at",
        "_splitter",
        "_tick",
        "_units_in_tick",
        "_waiting",
    )

    kept_max: ClassVar[int] = MAX_WAITING_BYTES

    def __init__(self, origin: str, description: RobotDescription, feed: PrimaryFeed | None = None) -> None:
        super().__init__(origin, description)
        self._feed = feed or PrimaryFeed(description)
        self._raw = bytearray()
        self._line_bytes = 0
        self._lines_left = MAX_LINES_PER_TICK
        self._bytes_left = MAX_BYTES_PER_TICK
        self._splitter = UnitSplitter()
        self._burst = GarbageBurst()
        self._ready: deque[Unit | DiscardedText] = deque()
        self._tick = 0
        self._is_remote = False
        self._is_greeted = False
        self._has_noted_unread = False
        self._received_at: int | None = None
        self._units_in_tick = 0
        self._next_state_at = 0
        self._next_message_at = 0
        self._waiting = RobotMessageQueue(self._feed.terminator)

    def receive(self, data: bytes, output: Output) -> list[Input]:
        if not self._feed.port.takes_programs:
            return self._note_unread(data)
        if not data:
            return []
        self._begin_tick(output)
        self._raw += data
        if len(self._raw) > MAX_WAITING_BYTES:
            raise ProtocolError(f"more than {MAX_WAITING_BYTES} bytes wait; programs come faster than they can be read")
        return self._read()

    def _note_unread(self, data: bytes) -> list[Input]:
        """Say once that the lines of a client of a port that takes nothing are not read; the client gets no answer."""
        if b"\n" not in data or self._has_noted_unread:
            return []
        self._has_noted_unread = True
        text = f"this port only sends, and what comes in is not read; send programs to {PRIMARY.number}"
        return [self._warning(f"{self.origin}: {text}")]

    @property
    def is_busy(self) -> bool:
        return bool(self._ready) or len(self._raw) >= MAX_BYTES_PER_TICK

    @property
    def takes_texts(self) -> bool:
        return self._feed.port.takes_programs

    @property
    def is_uploading(self) -> bool:
        return bool(self._raw) or (self._splitter.pending and self._received_at is not None)

    def reads(self, tick: int) -> int:
        return STATE_PARTS if tick >= self._next_state_at else 0

    def publish(self, output: Output) -> None:
        self._begin_tick(output)
        if not self._is_greeted and not output.has(STATE_PARTS):
            # Connected during this tick: its first state is that of the next one.
            self._next_state_at = output.tick + 1
        if self._feed.port.sends_messages:
            if self._feed.sends_version and not self._is_greeted:
                self._waiting.put(version_message(output.tick, self.description, self._feed.terminator), output.tick)
            for message in self._feed.messages(output):
                self._waiting.put(message, output.tick)
        self._is_greeted = True
        if self._waiting and output.tick >= self._next_message_at:
            self.send(self._waiting.take())
            self._next_message_at = output.tick + SPACING_TICKS
        if output.tick >= self._next_state_at:
            self.send(self._feed.state(output))
            period = self._feed.port.period_ticks
            self._next_state_at = output.tick - output.tick % period + period
        if self._raw or self._ready:
            self._due += self._read()
        elif self._received_at is not None and output.tick - self._received_at >= SILENCE_TICKS:
            self._received_at = None
            if self._splitter.pending and self._line_bytes <= MAX_SILENT_LINE_BYTES:
                self._ready += self._splitter.silence()
                self._due += self._read()
            if not self._burst.is_empty and not self._ready:
                if rest := self._splitter.drop_line():
                    self._burst.add(rest, output.tick)
                self._due.append(self._warning(self._burst.take(self.origin)))
        if self._burst.is_due(output.tick):
            self._due.append(self._warning(self._burst.take(self.origin)))

    def next_tick(self, tick: int) -> int | None:
        due = [self._next_state_at]
        if self._raw or self._ready:
            due.append(tick + 1)
        if self._waiting:
            due.append(self._next_message_at)
        if self._received_at is not None:
            due.append(self._received_at + SILENCE_TICKS)
        if (report_tick := self._burst.report_tick) is not None:
            due.append(report_tick)
        return max(min(due), tick + 1)

    def closed(self) -> list[Input]:
        left = [*self._ready, *self._splitter.receive(bytes(self._raw)), *self._splitter.close()]
        self._ready.clear()
        self._raw.clear()
        inputs = self.due()
        for item in left[:MAX_UNITS_AT_ONCE]:
            inputs += self._inputs(item)
        if len(left) > MAX_UNITS_AT_ONCE:
            text = f"more than {MAX_UNITS_AT_ONCE} programs and commands were waiting when the client went"
            inputs.append(self._warning(f"{self.origin}: {text}; the rest is lost"))
        if not self._burst.is_empty:
            inputs.append(self._warning(self._burst.take(self.origin)))
        return inputs

    # Units

    def _read(self) -> list[Input]:
        """Read as much text as this tick allows."""
        inputs: list[Input] = []
        while self._units_in_tick < UNITS_PER_TICK:
            if self._ready:
                found = self._inputs(self._ready.popleft())
                # What replaces a program has this tick for itself, see `kernel.unit_order`.
                is_alone = any(isinstance(item, RunUnit) and item.kind != "secondary" for item in found)
                self._units_in_tick += UNITS_PER_TICK if is_alone else 1
                inputs += found
            elif piece := self._piece():
                self._ready += self._splitter.receive(piece)
            else:
                break
        return inputs

    def _piece(self) -> bytes:
        """Take a piece of the text with few lines, so that few units are ready at once."""
        lines_left = min(self._lines_left, LINES_AT_ONCE)
        piece = bytes(self._raw[: min(self._bytes_left, BYTES_AT_ONCE)])
        # However many plain lines within a program come: they are taken at once, and no unit is ready because of them.
        is_within = self._splitter.is_in_program and _counts(piece) is None
        while (lines := 0 if is_within else piece.count(b"\n") + piece.count(b"\r")) > lines_left:
            piece = piece[: len(piece) // 2]
        if piece:
            del self._raw[: len(piece)]
            self._bytes_left -= len(piece)
            self._lines_left -= lines
            self._received_at = self._tick
            begin = piece.rfind(b"\n") + 1
            self._line_bytes = len(piece) - begin + (0 if begin else self._line_bytes)
        return piece

    def _inputs(self, found: Unit | DiscardedText) -> list[Input]:
        """Return the inputs of a unit; none if it is garbage."""
        if isinstance(found, DiscardedText):
            return [self._refusal(found)]
        if found.kind == "line" and self._burst.takes(found.text) and not is_command(found.text):
            self._burst.add(found.text, self._tick)
            return []
        return self._run(found)

    def _run(self, unit: Unit) -> list[Input]:
        if not self._is_remote:
            return [self._warning(f"{self.origin}: {_LOCAL}")]
        if unit.kind == "line":
            try:
                request = request_of(unit.text)
            except ValueError as error:
                return [self._warning(f"{self.origin}: {error}")]
            if request is not None:
                return [Do(self.origin, request)]
        # Lines of alarms count from the first line of the unit.
        run = RunUnit(self.origin, unit.kind, unit.text)
        if not (text := _encoding_warning(unit)):
            return [run]
        if self._feed.port.sends_messages:
            message = error_message(self._tick, WARNING, text, terminator=self._feed.terminator)
            self._waiting.put(message, self._tick)
        return [self._warning(f"{self.origin}: {text}"), run]

    def _refusal(self, refusal: DiscardedText) -> Input:
        """Report a text that is no program to the client, and to the log, since the client may have closed."""
        problem = refusal.problems[0]
        text = f"SyntaxError: {problem.text}"
        if self._feed.port.sends_messages:
            message = exception_message(self._tick, problem.line, problem.column, text, self._feed.terminator)
            self._waiting.put(message, self._tick)
        return AddLog(self.origin, text)

    def _warning(self, text: str) -> Input:
        return AddLog(self.origin, text, is_warning=True)

    # Ticks and messages

    def _begin_tick(self, output: Output) -> None:
        self._is_remote = output.snapshot.is_remote
        if output.tick != self._tick:
            self._tick = output.tick
            self._units_in_tick = 0
            self._lines_left = MAX_LINES_PER_TICK
            self._bytes_left = MAX_BYTES_PER_TICK
