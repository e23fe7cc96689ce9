"""Cuts a stream of bytes into messages: `Content-Length: N`, an empty line, N bytes."""

from __future__ import annotations

import re
from typing import Final

HEADER_BYTES_MAX: Final = 8192
MESSAGE_BYTES_MAX: Final = 64_000_000

_END: Final = b"\r\n\r\n"
_LENGTH: Final = re.compile(rb"(?:^|\r\n)content-length:[ \t]*(\d{1,10})[ \t]*(?:\r\n|$)", re.IGNORECASE)

BROKEN: Final = b""
"""In place of a message whose header makes no sense, or that is too long: it is no JSON, and gets that error."""


class Frames:
    """Takes bytes as they come and returns the messages that are complete."""

    __slots__ = ("_buffer", "_skipped", "_wanted")

    def __init__(self) -> None:
        self._buffer = bytearray()
        self._wanted: int | None = None
        """Length of the message that comes next; None in front of its header."""
        self._skipped = 0
        """Bytes that are still to come of a message that is too long."""

    def feed(self, data: bytes) -> list[bytes]:
        """Return the messages that end in these bytes."""
        if self._skipped:
            passed = min(self._skipped, len(data))
            self._skipped -= passed
            data = data[passed:]
        self._buffer += data
        found: list[bytes] = []
        while (message := self._next()) is not None:
            found.append(message)
        return found

    def _next(self) -> bytes | None:
        buffer = self._buffer
        if self._wanted is None:
            end = buffer.find(_END)
            if end < 0:
                if len(buffer) <= HEADER_BYTES_MAX:
                    return None
                # It may hold the begin of a header.
                del buffer[: -len(_END)]
                return BROKEN
            length = _LENGTH.search(buffer[:end])
            del buffer[: end + len(_END)]
            if length is None:
                return BROKEN
            self._wanted = int(length[1])
        if self._wanted > MESSAGE_BYTES_MAX:
            here = min(self._wanted, len(buffer))
            del buffer[:here]
            self._skipped, self._wanted = self._wanted - here, None
            return BROKEN
        if len(buffer) < self._wanted:
            return None
        message = bytes(buffer[: self._wanted])
        del buffer[: self._wanted]
        self._wanted = None
        return message
