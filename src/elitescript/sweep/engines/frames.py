"""Messages between a sweep and its children: four bytes of length, then JSON. No I/O in here."""

from __future__ import annotations

import json
from typing import Any, Final

from elitescript.errors import PeerError
from elitescript.untrusted.json_text import json_value

LENGTH_BYTES: Final = 4
BODY_MAX: Final = 256 * 1024 * 1024
"""Bytes of a message: a plan with its files, and rows with what programs put into measures (*assumed*)."""


def framed(message: Any) -> bytes:
    """Return a message as bytes; numbers that JSON does not have are written as Python reads them."""
    body = json.dumps(message, separators=(",", ":"), check_circular=False).encode("ascii")
    return len(body).to_bytes(LENGTH_BYTES, "big") + body


class Frames:
    """Cuts messages out of bytes as they arrive."""

    __slots__ = ("_buffer",)

    def __init__(self) -> None:
        self._buffer = bytearray()

    def feed(self, data: bytes) -> list[Any]:
        """Return the messages that are complete now, in their order.

        Raises:
            PeerError: a length beyond all sense, or no JSON: the other side is not what it should be.
        """
        self._buffer += data
        found: list[Any] = []
        while len(self._buffer) >= LENGTH_BYTES:
            size = int.from_bytes(self._buffer[:LENGTH_BYTES], "big")
            if size > BODY_MAX:
                raise PeerError(f"a message of {size} bytes; at most {BODY_MAX} are read")
            end = LENGTH_BYTES + size
            if len(self._buffer) < end:
                break
            body = bytes(self._buffer[LENGTH_BYTES:end])
            del self._buffer[:end]
            try:
                found.append(json_value(body, depth_max=None))
            except ValueError as error:
                raise PeerError(f"no JSON: {str(error)[:80]}") from None
        return found
