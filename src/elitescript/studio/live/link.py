"""How the engine talks to its processes.

With workers in frames: `u8` kind, `u32` length, little endian, then JSON or rows. With the keeper in `COMMAND` and
`EVENT`.
"""

from __future__ import annotations

import asyncio
import json
import os
from mmap import mmap
from struct import Struct
from typing import Any, Final, cast

from elitescript.codec.json_text import to_text
from elitescript.untrusted.json_text import JsonError, json_value

JSON: Final = 0
ROWS: Final = 1

COMMAND: Final = Struct("=cI")
"""To the keeper: `n` a new worker, `k` kill it, `t` have it write its trace; its number. With a new one come
descriptors: of its link, of where it writes its trace, of the pipe that ends it (`environment.process`), and of its
`Board`."""
DESCRIPTORS: Final = 4
EVENT: Final = Struct("=cIi")
"""From the keeper: `b` begun, `e` ended; the number; the process, or its exit code as `subprocess` has it."""

_HEAD: Final = Struct("<BI")
_READ_BYTES: Final = 1 << 16
FRAME_MAX: Final = 64 << 20
"""Bytes of a frame of a worker, in which a program of a stranger runs; the largest holds the page of a run."""


_NUMBER: Final = (int, float)
_TEXTS: Final = (str,)
_MOMENT: Final = {"t": _NUMBER, "line": (int,), "globals": [{"name": _TEXTS, "value": _TEXTS}]}
_RUN: Final = {"run": (int,)}
_ASK: Final = {"ask": (int,)}
_ALARM: Final = {"line": (int,), "code": _TEXTS, "text": _TEXTS}
SHAPES: Final[dict[str, Any]] = {
    "problems": {"version": (int,), "list": [{}], "compiles": (bool,)},
    "scene": {},
    "notice": {"severity": _TEXTS, "text": _TEXTS},
    "code": {"digest": _TEXTS, "lines": [(int,)]},
    "same": {"moved": [[(int,)]]},
    "at": {"moment": _MOMENT},
    "progress": _RUN | {"t": _NUMBER},
    "run_began": _RUN | {"version": (int,)},
    "lines": _RUN | {"thread": _TEXTS, "t": [_NUMBER], "line": [(int,)]},
    "marks": _RUN | {"t": [_NUMBER], "node": [(int,)]},
    "moves": _RUN | {"list": [{"line": (int,), "start_s": _NUMBER, "end_s": _NUMBER}]},
    "events": _RUN | {"list": [{"type": _TEXTS, "text?": _TEXTS, "line?": (int,)}]},
    "left_out": _RUN | {"events": (int,), "bytes": (int,)},
    "contacts": _RUN | {"list": [{}]},
    "cycle": _RUN | {"table": [{"line": (int,), "visits": (int,), "moving_s": _NUMBER, "standing_s": _NUMBER}]},
    "run_ended": _RUN | {"state": _TEXTS, "moment": _MOMENT, "is_repeatable": (bool,), "alarm?": _ALARM},
    "state": _RUN | _ASK | {"moment": _MOMENT},
    "detail_ended": _RUN | _ASK,
    "recorded": _ASK | {"content": _TEXTS},
    "refused": _ASK | {"text": _TEXTS},
}
"""What a worker may send, and what of it the engine and those behind it read: types of values, lists of one kind of
item, objects with these fields at least; `?` may be missing."""


def framed(message: dict[str, Any]) -> bytes:
    """Return a message as a frame."""
    data = to_text(message).encode("ascii")
    return _HEAD.pack(JSON, len(data)) + data


async def read_frame(reader: asyncio.StreamReader) -> tuple[int, bytes]:
    """Return kind and content of the next frame.

    Raises:
        EOFError: there is none any more, or it is larger than `FRAME_MAX`.
    """
    try:
        kind, size = _HEAD.unpack(await reader.readexactly(_HEAD.size))
        if size > FRAME_MAX:
            raise EOFError
        return kind, await reader.readexactly(size)
    except (asyncio.IncompleteReadError, ConnectionError):
        raise EOFError from None


def message_of(data: bytes) -> dict[str, Any]:
    """Return the message in a frame of a worker.

    Raises:
        EOFError: it is none, or lacks what its kind has: such a worker is taken for one that has ended.
    """
    try:
        message = json_value(data)
    except JsonError:
        raise EOFError from None
    kind = message.get("type") if isinstance(message, dict) else None
    if type(kind) is not str or kind not in SHAPES or not _fits(message, SHAPES[kind]):
        raise EOFError
    return cast("dict[str, Any]", message)


def _fits(value: Any, shape: Any) -> bool:
    if isinstance(shape, tuple):
        return type(value) in shape
    if isinstance(shape, list):
        return type(value) is list and all(_fits(item, shape[0]) for item in value)
    return type(value) is dict and all(
        _fits(value[name], inner) if (name := field.rstrip("?")) in value else name != field
        for field, inner in shape.items()
    )


class Board:
    """A number that a worker writes and the engine reads at any time, also when the worker does not return.

    It is the last tick up to which nothing is left to do: the run can be made again up to there.

    Args:
        descriptor: of a file of `SIZE` bytes.
    """

    SIZE: Final = 8
    __slots__ = ("_memory",)

    def __init__(self, descriptor: int) -> None:
        self._memory = mmap(descriptor, self.SIZE)

    def write(self, tick: int) -> None:
        """Write it."""
        self._memory[:] = tick.to_bytes(self.SIZE, "little")

    def read(self) -> int:
        """Return what was written last; 0 at first."""
        return int.from_bytes(self._memory[:], "little")

    def close(self) -> None:
        """Release the memory."""
        self._memory.close()


class Link:
    """The end of a worker. Whoever does not read holds it back.

    Args:
        incoming: descriptor of the requests.
        outgoing: descriptor of the answers.
        board: of a run; None where there is none.
    """

    __slots__ = ("_incoming", "_outgoing", "_rest", "board")

    def __init__(self, incoming: int, outgoing: int, board: Board | None = None) -> None:
        self._incoming = incoming
        self._outgoing = outgoing
        self._rest = b""
        self.board = board

    def send(self, message: dict[str, Any]) -> None:
        """Send a message."""
        self._write(framed(message))

    def send_rows(self, frame: bytes) -> None:
        """Send a frame of rows."""
        self._write(_HEAD.pack(ROWS, len(frame)) + frame)

    def receive(self) -> dict[str, Any]:
        """Return the next message when it has come.

        Raises:
            EOFError: there will be none.
        """
        _, size = _HEAD.unpack(self._exactly(_HEAD.size))
        message: dict[str, Any] = json.loads(self._exactly(size))
        return message

    def _write(self, data: bytes) -> None:
        view = memoryview(data)
        while view:
            view = view[os.write(self._outgoing, view) :]

    def _exactly(self, size: int) -> bytes:
        while len(self._rest) < size:
            data = os.read(self._incoming, _READ_BYTES)
            if not data:
                raise EOFError
            self._rest += data
        found, self._rest = self._rest[:size], self._rest[size:]
        return found
