"""Standard input of the server: lines whose texts all have an encoding.

The library neither reads nor answers a request in which half a surrogate pair stands as an escape of JSON.
"""

from __future__ import annotations

import select
from io import BufferedReader, RawIOBase, TextIOWrapper
from typing import BinaryIO, Final

from elitescript.shown import encodable_json

LINE_MAX: Final = 64 << 20
"""Bytes of a line that are read at once; a request is far shorter."""


class Requests(RawIOBase):
    """Reads another stream line by line; halves of surrogate pairs in it are escapes within texts, such as `\\\\ud83d`.

    Args:
        target: the stream; it stays open.
    """

    def __init__(self, target: BinaryIO) -> None:
        self._target = target
        self._rest = b""

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: memoryview, /) -> int:  # type: ignore[override]
        """Put what is there of the next line into a buffer; return how many bytes, 0 at the end."""
        if not self._rest:
            line = self._target.readline(LINE_MAX)
            self._rest = encodable_json(line.decode("utf-8", "replace")).encode()
        found, self._rest = self._rest[: len(buffer)], self._rest[len(buffer) :]
        buffer[: len(found)] = found
        return len(found)


class UntilReaderGoes(RawIOBase):
    """Reads another stream until it ends, or the reader of an output has gone.

    Args:
        target: the stream, without a buffer; it stays open.
        output: descriptor of the output. Where the system cannot wait for both, the stream is read to its end.
    """

    def __init__(self, target: RawIOBase, output: int) -> None:
        self._target = target
        self._output = output

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: memoryview, /) -> int | None:  # type: ignore[override]
        """Put what is there into a buffer; return how many bytes, 0 at the end."""
        if hasattr(select, "poll"):
            poll = select.poll()
            poll.register(self._target.fileno(), select.POLLIN)
            # Errors and hang-ups are always reported.
            poll.register(self._output, 0)
            if any(descriptor == self._output for descriptor, _ in poll.poll()):
                return 0
        return self._target.readinto(buffer)


def requests(target: BinaryIO) -> TextIOWrapper:
    """Return what takes the place of `sys.stdin`, whose buffer the library reads."""
    return TextIOWrapper(BufferedReader(Requests(target)), encoding="utf-8")
