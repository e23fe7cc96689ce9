"""The interface of every connection that the controller serves: bytes in, inputs out; output of a tick in, bytes out.

A connection is sans-I/O: it has no socket and no clock, only ticks. The pump (`services.clients.tcp`) calls `take_in`
with received bytes, passes the inputs to the robot, calls `publish` after every tick, and writes each message of `take`
with one call. Buffers are bounded. Invalid bytes raise `ProtocolError`, which closes that connection only.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import ClassVar, Final

from elitescript.messages.events import Alarm
from elitescript.messages.inputs import Input
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot import RobotDescription
from elitescript.protocol.browsers import FirstBytes

RESTARTED: Final = "R132"
"""Code of the alarm about a robot that was restarted in the place of another."""


def is_restarted(output: Output) -> bool:
    """Return whether the robot was restarted in a tick, and so answers no earlier request."""
    return any(isinstance(event, Alarm) and event.code == RESTARTED for event in output.events)


class ProtocolError(Exception):
    """The peer sent invalid bytes; the text names what, where and what was expected."""


class BrowserError(ProtocolError):
    """The peer is a web browser: its connection ends, and nothing that it sent counts."""


class Connection(ABC):
    """One client of one port.

    Args:
        origin: names the client in inputs and logs, such as `rtsi#2`.
        description: the robot.
    """

    __slots__ = ("_count", "_due", "_first_bytes", "_out", "attend", "description", "is_behind", "is_over", "origin")

    kept_max: ClassVar[int] = 1024 * 1024
    """Bytes of the peer that are kept until they are worked on, so that they are not lost if it closes."""

    def __init__(self, origin: str, description: RobotDescription) -> None:
        self.origin = origin
        self.description = description
        self.is_over = False
        """Whether the connection is to be closed once its messages are sent."""
        self.attend: Callable[[], object] = _no_pump
        """Set by the pump; called by a connection that has messages or is over without having been called before."""
        self.is_behind = False
        """Set by the pump: whether the client takes what it is sent more slowly than it asks for it."""
        self._first_bytes: FirstBytes | None = FirstBytes()
        """Those that decide whether the peer is a browser; None once that is decided."""
        self._out: list[bytes] = []
        self._due: list[Input] = []
        self._count = 0

    def take_in(self, data: bytes, output: Output) -> list[Input]:
        """Take received bytes as they come from outside, and `receive` them; return their inputs to the robot.

        Every pump calls this, so that a page reaches a robot nowhere.

        Raises:
            BrowserError: they are the request of a web browser.
            ProtocolError: see `receive`.
        """
        if self._first_bytes is not None:
            if found := self._first_bytes.feed(data):
                raise BrowserError(f"it sent {found}, as a web browser does")
            if self._first_bytes.is_decided:
                self._first_bytes = None
        return self.receive(data, output)

    @abstractmethod
    def receive(self, data: bytes, output: Output) -> list[Input]:
        """Take received bytes, any part of the stream; return their inputs to the robot.

        Args:
            data: the bytes.
            output: of the last tick, for requests that are answered at once.

        Raises:
            ProtocolError: invalid bytes; the connection is to be closed.
        """

    def posted(self, tick: int) -> None:
        """Note that the inputs that `receive` has just returned go in at a tick, or later if many wait."""
        return

    @abstractmethod
    def publish(self, output: Output) -> None:
        """Take the output of a tick: queue the messages to this client about it."""

    def reads(self, tick: int) -> int:
        """Return the parts of the snapshot of a tick that it reads, as bits of `messages.snapshot_parts`; 0 for none.

        Called before the tick runs. `receive` and `publish` may get a snapshot of which all other parts are older, and
        only the discrete state (levels, modes, tool, task) is always that of the tick. See `messages.outputs.Output`.
        """
        return 0

    @property
    def is_admitted(self) -> bool:
        """Whether the client may stay as long as it likes; one that has not logged in yet makes room for others."""
        return True

    @property
    def progress(self) -> int:
        """How far a client has come on its way to log in; of those that have come least far one makes room."""
        return 0

    @property
    def is_busy(self) -> bool:
        """Whether further bytes of the peer are to be left in the socket for now."""
        return False

    @property
    def is_uploading(self) -> bool:
        """Whether the peer is in the middle of a long text, to which nothing is answered before its end."""
        return False

    @property
    def is_expecting(self) -> bool:
        """Whether a request of the peer waits for its reply."""
        return False

    def next_tick(self, tick: int) -> int | None:
        """Return the next tick after `tick` that must be published although nothing happens in it; None if none must.

        A tick with events or replies must be published in any case.
        """
        return tick + 1 if self.is_busy or self.is_expecting else None

    def due(self) -> list[Input]:
        """Return inputs from earlier bytes that are due now; to be called after every `publish`."""
        due, self._due = self._due, []
        return due

    def read_on(self, output: Output) -> list[Input]:
        """Handle requests that were left for the next tick and need none, while no tick comes; return their inputs.

        Args:
            output: of the last tick.

        Raises:
            ProtocolError: see `receive`.
        """
        return []

    def closed(self) -> list[Input]:
        """Handle the end of the client; return the inputs to the robot."""
        return []

    def take(self) -> list[bytes]:
        """Return the messages to send, in order; each is one write."""
        out, self._out = self._out, []
        return out

    def next_origin(self) -> str:
        """Return a new origin for one request, such as `query#2/7` for the seventh of `query#2`."""
        self._count += 1
        return f"{self.origin}/{self._count}"

    def send(self, message: bytes) -> None:
        """Queue one message."""
        self._out.append(message)


def _no_pump() -> None:
    """Do nothing: a pump that sets no `attend` looks at its connections in every tick."""
