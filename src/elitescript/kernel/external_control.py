"""Tasks whose program comes from a client: the plugin mode of external control.

Such a task is a file `NAME.task` whose first line is `external_control HOST [PORT]`. When it is played, the controller
connects to the client's script sender, asks for the program, and runs what comes as the program of the task.

Evidence: port, request and the comment that ends the program are what the vendor's client serves. *Assumed*: the form
of the file, the limits, that a program without that comment ends with the connection or after a silence, and that a
program that does not come refuses the start (the vendor's plugin opens a message window instead).
"""

from __future__ import annotations

from errno import EINVAL
from typing import Final

from elitescript.language.limits import MAX_UNIT_BYTES
from elitescript.messages.inputs import ChannelClosed, ChannelData, ChannelEvent, ChannelOpened
from elitescript.messages.timing import TICKS_PER_S
from elitescript.records import NamedTuple
from elitescript.runtime.environment import Channels, Files
from elitescript.said import said
from elitescript.untrusted.plain_text import without_mark

WORD: Final = "external_control"
PORT: Final = 50002
"""Of the script sender, unless the task names another one."""
REQUEST: Final = b"request_program\n"
LAST_LINE: Final = b"# NODE_CONTROL_LOOP_ENDS"
CONNECT_S: Final = 2.0
FETCH_TICKS: Final = 3 * TICKS_PER_S
"""From the start to the whole program; clients of the dashboard wait a little longer for its reply."""
SILENCE_TICKS: Final = TICKS_PER_S // 2
TASK_FILE_MAX: Final = 64 * 1024
"""Bytes of a task file that may be of this kind."""


class Sender(NamedTuple):
    """Where the program of a task comes from."""

    host: str
    port: int

    def __str__(self) -> str:
        return f"{self.host}:{self.port}"


def sender_of(files: Files, name: str) -> Sender | None:
    """Read where the program of a task comes from; None if it is no such task.

    Args:
        files: the task folder.
        name: of the task in it.

    Raises:
        OSError: the line makes no sense.
    """
    if files.kind(name) != "file" or files.size(name) > TASK_FILE_MAX:
        return None
    with files.open(name, "rb", None, None) as file:
        line = bytes(file.read(TASK_FILE_MAX)).split(b"\n", 1)[0].decode("utf-8", "replace")
    words = without_mark(line).split()
    if not words or words[0] != WORD:
        return None
    port = words[2] if len(words) == 3 else str(PORT)
    is_port = port.isascii() and port.isdecimal() and 0 < int(port[:6]) < 65536
    if len(words) not in (2, 3) or not is_port:
        raise OSError(EINVAL, f"the first line of {name} must be {WORD} HOST [PORT], not {' '.join(words)[:80]!r}")
    return Sender(words[1], int(port))


class Fetch:
    """One program on its way.

    Args:
        channels: carry the bytes.
        sender: where the program is.
        origin: of the request that started the task.
        tick: of that request.
    """

    __slots__ = (
        "_abandoned",
        "_channels",
        "_failure",
        "_is_over",
        "_last_tick",
        "_start_tick",
        "channel",
        "data",
        "origin",
        "sender",
    )

    def __init__(self, channels: Channels, sender: Sender, origin: str, tick: int) -> None:
        self._channels = channels
        self.sender = sender
        self.origin = origin
        self.data = bytearray()
        self._start_tick = self._last_tick = tick
        self._abandoned = self._failure = ""
        self._is_over = False
        self.channel = channels.open(sender.host, sender.port, CONNECT_S)
        if not self.channel:
            self._failure = "there is no network"

    def event(self, event: ChannelEvent, tick: int) -> None:
        """Take an event of the channel."""
        if isinstance(event, ChannelOpened):
            if event.is_open:
                self._channels.send(self.channel, REQUEST)
            else:
                self.channel = 0
                self._failure = event.reason or "no connection"
        elif isinstance(event, ChannelData):
            self.data += event.data
            self._last_tick = tick
            self._channels.credit(self.channel, len(event.data))
            if len(self.data) > MAX_UNIT_BYTES:
                self._failure = said("the program is longer than {max_unit_bytes} bytes", max_unit_bytes=MAX_UNIT_BYTES)
        elif isinstance(event, ChannelClosed):
            self.channel = 0
            self._is_over = True

    def result(self, tick: int) -> bytes | None:
        """Return the program once it is whole; None as long as it is not.

        Raises:
            ConnectionError: it does not come; with the reason.
        """
        if not self._abandoned and not self._failure and not self._is_whole(tick):
            if tick - self._start_tick < FETCH_TICKS:
                return None
            self._failure = said("it has not come within {fetch_ticks:g} s", fetch_ticks=FETCH_TICKS / TICKS_PER_S)
        self.close()
        if self._abandoned:
            raise ConnectionError(0, said("{abandoned} before its program had come", abandoned=self._abandoned))
        if not self._failure and not self.data.strip():
            self._failure = "it has sent nothing"
        if self._failure:
            raise ConnectionError(
                0,
                said(
                    "no program from {sender}: {failure}; is the client running?",
                    sender=self.sender,
                    failure=self._failure,
                ),
            )
        return bytes(self.data)

    def abandon(self, why: str) -> None:
        """End with this reason: the program is not wanted any more."""
        self._abandoned = why

    def close(self) -> None:
        """Close the connection to the sender."""
        if self.channel:
            self._channels.close(self.channel)
            self.channel = 0

    def _is_whole(self, tick: int) -> bool:
        if self._is_over or LAST_LINE in self.data[-200:]:
            return True
        return bool(self.data) and tick - self._last_tick >= SILENCE_TICKS
