"""Messages of the Debug Adapter Protocol in a stream of bytes: a header with `Content-Length`, then one JSON object.

No I/O in here. What is no message becomes a `Malformed`, and reading goes on behind it.
Source: <https://microsoft.github.io/debug-adapter-protocol/overview>, "Base protocol".
"""

from __future__ import annotations

from typing import Any, Final

from elitescript.codec.json_text import to_text
from elitescript.records import NamedTuple
from elitescript.untrusted.json_text import JsonError, json_value

HEADER_MAX: Final = 8 * 1024
"""Bytes of a header (*assumed*: the protocol has no limit; ordinary ones have 25)."""
BODY_MAX: Final = 32 * 1024 * 1024
"""Bytes of a message (*assumed*)."""

_END: Final = b"\r\n\r\n"
_LENGTH: Final = b"content-length"


class Malformed(NamedTuple):
    """Bytes that are no message, and why."""

    text: str


def framed(message: dict[str, Any]) -> bytes:
    """Return a message as bytes of the stream."""
    body = to_text(message).encode("ascii")
    return b"Content-Length: %d\r\n\r\n%b" % (len(body), body)


class Decoder:
    """Cuts messages out of bytes as they arrive."""

    __slots__ = ("_buffer", "_skip", "_wanted")

    def __init__(self) -> None:
        self._buffer = bytearray()
        self._wanted: int | None = None
        """Bytes of the body that comes next; None in a header."""
        self._skip = 0
        """Bytes of a body that is too long, still to come."""

    def feed(self, data: bytes) -> list[dict[str, Any] | Malformed]:
        """Return the messages that are complete now, in their order."""
        self._buffer += data
        found: list[dict[str, Any] | Malformed] = []
        while True:
            if self._skip:
                skipped = min(self._skip, len(self._buffer))
                del self._buffer[:skipped]
                self._skip -= skipped
            if self._wanted is None:
                if not self._read_header(found):
                    return found
            elif len(self._buffer) >= self._wanted:
                body = bytes(self._buffer[: self._wanted])
                del self._buffer[: self._wanted]
                self._wanted = None
                found.append(_message(body))
            else:
                return found

    def _read_header(self, found: list[dict[str, Any] | Malformed]) -> bool:
        """Take a header away; return whether there was a complete one."""
        end = self._buffer.find(_END)
        if end < 0:
            if len(self._buffer) > HEADER_MAX:
                # The end of the header may have begun to arrive.
                del self._buffer[: -len(_END)]
                found.append(Malformed(f"{HEADER_MAX} bytes without the end of a header"))
            return False
        header = bytes(self._buffer[:end])
        del self._buffer[: end + len(_END)]
        length = _length(header)
        if length is None:
            shown = header[-60:].decode("ascii", "backslashreplace")
            found.append(Malformed(f"a header without a Content-Length in bytes: {shown!r}"))
        elif length > BODY_MAX:
            self._skip = length
            found.append(Malformed(f"a message of {length} bytes; at most {BODY_MAX} are read"))
        else:
            self._wanted = length
        return True


def _length(header: bytes) -> int | None:
    """Return the length that a header names; None if it names none. What stands before it in the header is left out."""
    for line in reversed(header.split(b"\r\n")):
        name, colon, value = line.partition(b":")
        value = value.strip()
        if colon and name.strip().lower().endswith(_LENGTH) and value.isdigit() and len(value) <= 12:
            return int(value)
    return None


def _message(body: bytes) -> dict[str, Any] | Malformed:
    try:
        data = json_value(body)
    except JsonError as error:
        return Malformed(f"no JSON: {error}")
    return data if isinstance(data, dict) else Malformed(f"a {type(data).__name__} where an object must be")
