"""Messages between a serving process and its child: a length, a letter, and a JSON text but for `OUTPUT_CHANGES`.

Length (4 bytes, big-endian) counts letter and content. What is longer than `DOWN_MAX` or `UP_MAX` ends the connection:
no message of ours is so long.
"""

from __future__ import annotations

import os
import struct
from collections.abc import Iterator
from typing import Final

from elitescript.codec.values import CodecError
from elitescript.messages.cut import LOOKS_MAX, WHOLE, Cut
from elitescript.messages.timing import TICKS_PER_S

DOWN_MAX: Final = 32 * 1024 * 1024
UP_MAX: Final = 16 * 1024 * 1024
"""Less, because reading it takes the time of all clients; the longest text of a program fits, however it is escaped."""
READ_BYTES: Final = 1 << 16
"""Taken from a socket at once: more would be memory that the system has to find anew for every message."""
_LENGTH: Final = struct.Struct(">I")
_HEAD: Final = struct.Struct(">IB")
_TICK: Final = struct.Struct(">qB?BB")
_NUMBER: Final = struct.Struct(">q")
_ANSWERED: Final = struct.Struct(">qBIIII")
NEVER: Final = (1 << 63) - 1
"""Number of a tick that does not come."""
REFRESH_TICKS: Final = TICKS_PER_S // 10
"""A snapshot is at most so old when a fresh child goes on from it, though nothing reads one: while the arm moves, the
child names a tick that is due within this time (*assumed*: as often as the primary port shows joints)."""
AHEAD_TICKS: Final = 12
"""Ticks after one that runs whose rows a child sends with its answer, at most: computing them delays what comes in by a
millisecond, and a stop by no more."""

# Down.
LOCK_IN: Final = "L"
"""`[is_jailed, memory_max]`: the child locks itself in and answers `LOCKED_IN`."""
PREPARE: Final = "P"
"""Options: the child makes a robot like this, has it run a program, and forgets it, so that everything is loaded."""
BEGIN: Final = "B"
"""Options: the child makes its robot and answers `DESCRIBED`."""
TICK: Final = "T"
"""Number of a tick to leap to and run (i64), parts of its snapshot that are read (a byte), whether the next due tick is
asked for, how many rows ahead are asked for, and the parts of those (a byte each), then the inputs if there are any.
The child answers with `OUTPUT`, later `OUTPUT_CHANGES`; if nothing is read and the discrete state has not changed, with
`RESULT`. Behind the answer come its rows: `ROW`."""
ANSWER: Final = "A"
"""Answer to a `QUESTION`."""

CODE: Final = "M"
"""Number of a text (i64), and a part of the program that was made of it: from its compiler through the parent to the
child, unread on the way. From the compiler it comes without the number."""

# Up. The answers to a tick begin with the number of the next one that is due (i64); the next one if that was not asked
# for. Then comes how many rows follow (a byte), and how far programs came in the tick, a `Cut` (four times u32).
LOCKED_IN: Final = "L"
"""The layers of the jail."""
DESCRIBED: Final = "D"
"""The robot's description."""
OUTPUT: Final = "O"
"""The output of a tick."""
OUTPUT_CHANGES: Final = "C"
"""The same, after the first one: what is new, in the form of `output_changes`."""
RESULT: Final = "R"
"""`[line, result]`: what a tick gives without its snapshot, and the line of the program."""
ROW: Final = "W"
"""What a tick after the one that was answered gives if nothing is given to the robot by then: nothing is due in it. In
the form of `output_changes`, without events, requests and replies. The child stays at the tick that was answered."""
QUESTION: Final = "Q"
"""Something about files, in the middle of a tick."""
TEXT: Final = "K"
"""A part of a text to compile, see `services.compiler.jobs`: from the child through the parent to the compiler."""
DROP_TEXT: Final = "X"
"""Number of a text that needs no compiling any more (i64)."""
COMPILED: Final = "E"
"""From a compiler: all of the program was sent."""
FAILED: Final = "F"
"""`[kind, text]`: why the child ends; of a compiler the text alone."""
FAILURE_MAX: Final = 8000
"""Characters of that reason."""


def tick_content(number: int, parts: int, asks_due: bool, inputs: str, ahead: int = 0, ahead_parts: int = 0) -> bytes:
    """Return the content of `TICK`."""
    return _TICK.pack(number, parts, asks_due, ahead, ahead_parts) + inputs.encode()


def read_tick(content: bytes) -> tuple[int, int, bool, int, int, bytes]:
    """Return number, parts, whether the next due tick is asked for, rows ahead, their parts, and the inputs."""
    return *_TICK.unpack_from(content), content[_TICK.size :]


def numbered(number: int, content: bytes) -> bytes:
    """Return a content with the number of a text before it."""
    return _NUMBER.pack(number) + content


def split_number(content: bytes) -> tuple[int, bytes]:
    """Return the number of a text, and the content behind it.

    Raises:
        CodecError: there is none.
    """
    if len(content) < _NUMBER.size:
        raise CodecError("a message about a text without its number")
    return _NUMBER.unpack_from(content)[0], content[_NUMBER.size :]


def answer_content(due: int, content: str | bytes, cut: Cut = WHOLE, rows: int = 0) -> bytes:
    """Return the content of an answer to a tick: the next one that is due, rows, how far programs came, its output."""
    return _ANSWERED.pack(due, rows, *cut) + (content.encode() if isinstance(content, str) else content)


def read_answer(content: bytes) -> tuple[int, int, Cut, bytes]:
    """Return the next tick that is due, how many rows follow, how far programs came, and what the tick gives.

    Raises:
        CodecError: it is too short, or no tick has as many looks.
    """
    if len(content) < _ANSWERED.size:
        raise CodecError("an answer to a tick without its head")
    due, rows, *numbers = _ANSWERED.unpack_from(content)
    cut = Cut(*numbers)
    if max(cut) > LOOKS_MAX:
        raise CodecError(f"a tick that was cut at {', '.join(map(str, cut))}; none can be")
    return due, rows, cut, content[_ANSWERED.size :]


def frame(letter: str, content: str | bytes, limit: int = DOWN_MAX) -> bytes:
    """Return the bytes of one message.

    Raises:
        CodecError: it is too long.
    """
    if isinstance(content, str):
        content = content.encode()
    size = 1 + len(content)
    if size > limit:
        raise CodecError(f"a message of {size} bytes; at most {limit} are sent")
    return _HEAD.pack(size, ord(letter)) + content


class FrameReader:
    """Cuts messages out of the bytes that arrive.

    Args:
        limit: bytes of a message.
    """

    __slots__ = ("_buffer", "_limit")

    def __init__(self, limit: int = DOWN_MAX) -> None:
        self._buffer = bytearray()
        self._limit = limit

    def feed(self, data: bytes) -> Iterator[tuple[str, bytes]]:
        """Return the messages that are complete now: letter and text.

        What a message sets off may feed more bytes, and take what is left before this call goes on.

        Raises:
            CodecError: a length that no message has.
        """
        buffer = self._buffer
        if not buffer and len(data) > _LENGTH.size and _LENGTH.unpack_from(data)[0] == len(data) - _LENGTH.size:
            # As most come: one message in one piece.
            if len(data) - _LENGTH.size > self._limit:
                raise CodecError(f"a message of {len(data) - _LENGTH.size} bytes; there are 1 to {self._limit}")
            yield chr(data[_LENGTH.size]), data[_LENGTH.size + 1 :]
            return
        buffer += data
        while len(buffer) >= _LENGTH.size:
            (length,) = _LENGTH.unpack_from(buffer)
            if not 1 <= length <= self._limit:
                raise CodecError(f"a message of {length} bytes; there are 1 to {self._limit}")
            end = _LENGTH.size + length
            if len(buffer) < end:
                break
            body = bytes(buffer[_LENGTH.size : end])
            del buffer[:end]
            yield chr(body[0]), body[1:]


class BlockingLine:
    """Sends and receives one message at a time, for the child.

    Args:
        descriptor: of the connected socket.
    """

    __slots__ = ("_descriptor", "_messages", "_reader")

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._reader = FrameReader()
        self._messages: list[tuple[str, bytes]] = []

    def send(self, letter: str, content: str | bytes) -> None:
        """Send a message; waits until it is on its way."""
        self.send_frames(frame(letter, content, UP_MAX))

    def send_frames(self, frames: bytes) -> None:
        """Send messages that are framed already; waits until they are on their way."""
        data = memoryview(frames)
        while data:
            data = data[os.write(self._descriptor, data) :]

    def receive(self) -> tuple[str, bytes]:
        """Wait for the next message and return it.

        Raises:
            EOFError: the other end has gone.
        """
        while not self._messages:
            data = os.read(self._descriptor, READ_BYTES)
            if not data:
                raise EOFError
            self._messages += self._reader.feed(data)
        return self._messages.pop(0)

    def receive_answer(self, letter: str) -> bytes:
        """Wait for the next message with that letter and return its text; others keep their order."""
        waiting: list[tuple[str, bytes]] = []
        try:
            while True:
                found, text = self.receive()
                if found == letter:
                    return text
                waiting.append((found, text))
        finally:
            self._messages[:0] = waiting
