"""Reads the response of an HTTP server from the bytes of a connection (RFC 9112).

A status, and a body of known length, in chunks or up to the end of the connection. Interim responses (1xx) are skipped.
"""

from __future__ import annotations

from typing import Final

from elitescript.errors import PeerError
from elitescript.records import record

HEAD_MAX: Final = 32_768
"""Bytes of the lines before a body."""
BODY_MAX: Final = 4 * 1024 * 1024
"""Bytes of a body (*assumed*)."""

_HEAD: Final = "head"
_BODY: Final = "body"
_TO_THE_END: Final = "to the end"
_CHUNK_SIZE: Final = "chunk size"
_CHUNK: Final = "chunk"
_TRAILER: Final = "trailer"

_WITHOUT_BODY: Final = (204, 304)


@record
class HttpAnswer:
    """A complete response."""

    status: int
    reason: str
    body: bytes
    keeps_open: bool
    """Whether the connection may serve another request."""


class HttpReader:
    """Reads one response: a `commands.definition.context.Rule` with state, which consumes all of its bytes.

    Attributes:
        has_begun: whether any byte of a response has arrived.
    """

    __slots__ = ("_body", "_is_chunked", "_keeps_open", "_left", "_phase", "_reason", "_status", "has_begun")

    def __init__(self) -> None:
        self.has_begun = False
        self._phase = _HEAD
        self._status = 0
        self._reason = ""
        self._keeps_open = False
        self._is_chunked = False
        self._left = 0
        self._body = bytearray()

    def __call__(self, received: bytearray, is_last: bool) -> tuple[HttpAnswer | str | None, int]:
        """Return the response, and how many of the received bytes are used.

        Returns:
            The response; None if more bytes are needed; an empty text if no more will come in time.

        Raises:
            PeerError: no HTTP response.
        """
        self.has_begun = self.has_begun or bool(received)
        used = 0
        while (size := self._step(received, used)) > 0:
            used += size
            if self._phase == "":
                return self._whole(), used
        return ("" if is_last else None), used

    def at_end(self) -> HttpAnswer:
        """Return the response: the server has closed the connection.

        Raises:
            PeerError: it is cut short.
        """
        if self._phase != _TO_THE_END:
            raise PeerError("the server closed the connection " + ("in its answer" if self.has_begun else "unasked"))
        return self._whole()

    def _whole(self) -> HttpAnswer:
        return HttpAnswer(self._status, self._reason, bytes(self._body), self._keeps_open)

    def _step(self, received: bytearray, at: int) -> int:
        """Use the next part; return its number of bytes."""
        if self._phase == _HEAD:
            return self._read_head(received, at)
        if self._phase in (_CHUNK_SIZE, _TRAILER):
            return self._read_line(received, at)
        size = len(received) - at
        if self._phase != _TO_THE_END:
            size = min(size, self._left)
        if len(self._body) + size > BODY_MAX:
            raise PeerError(f"the answer has more than {BODY_MAX} bytes")
        self._body += received[at : at + size]
        self._left -= size
        if self._left == 0 and self._phase == _BODY:
            self._phase = ""
        elif self._left == 0 and self._phase == _CHUNK:
            self._phase = _CHUNK_SIZE
        return size

    def _read_head(self, received: bytearray, at: int) -> int:
        end, size = received.find(b"\r\n\r\n", at), 4
        if end < 0:
            end, size = received.find(b"\n\n", at), 2
        if end < 0:
            if len(received) - at > HEAD_MAX:
                raise PeerError(f"what arrived is no HTTP: {HEAD_MAX} bytes without the end of a head")
            start = bytes(received[at : at + 5])
            if not b"HTTP/".startswith(start[: len(b"HTTP/")]):
                raise PeerError(f"what arrived is no HTTP; it begins with {start!r}")
            return 0
        lines = received[at:end].decode("latin-1").replace("\r\n", "\n").split("\n")
        self._read_status(lines[0])
        fields = _fields(lines[1:])
        if 100 <= self._status < 200:
            return end + size - at
        options = fields.get("connection", "").lower()
        is_old = lines[0].startswith("HTTP/1.0")
        self._keeps_open = "keep-alive" in options if is_old else "close" not in options
        if self._status in _WITHOUT_BODY:
            self._phase = ""
        elif fields.get("transfer-encoding", "").lower() == "chunked":
            self._phase = _CHUNK_SIZE
        elif "content-length" in fields:
            self._left = _number(fields["content-length"], 10)
            self._phase = _BODY if self._left else ""
        else:
            self._phase, self._keeps_open = _TO_THE_END, False
        return end + size - at

    def _read_status(self, line: str) -> None:
        version, _, rest = line.partition(" ")
        status, _, self._reason = rest.strip().partition(" ")
        if not version.startswith("HTTP/1.") or not (status.isdecimal() and len(status) == 3):
            raise PeerError(f"what arrived is no HTTP; it begins with {line[:40]!r}")
        self._status = int(status)

    def _read_line(self, received: bytearray, at: int) -> int:
        """Read the size of a chunk, the empty line after one, or a line after the last one."""
        end = received.find(b"\n", at)
        if end < 0:
            if len(received) - at > HEAD_MAX:
                raise PeerError(f"a chunk of the answer has no size in {HEAD_MAX} bytes")
            return 0
        line = received[at:end].decode("latin-1").strip()
        if self._phase == _TRAILER:
            if not line:
                self._phase = ""
        elif line:
            self._left = _number(line.partition(";")[0].strip(), 16)
            self._phase = _CHUNK if self._left else _TRAILER
        return end + 1 - at


def _fields(lines: list[str]) -> dict[str, str]:
    fields: dict[str, str] = {}
    for line in lines:
        name, colon, value = line.partition(":")
        if not colon:
            raise PeerError(f"the head of the answer has the line {line[:40]!r}, which is no field")
        fields[name.strip().lower()] = value.strip()
    return fields


def _number(text: str, base: int) -> int:
    try:
        number = int(text, base)
    except ValueError:
        number = -1
    if not 0 <= number <= BODY_MAX or not text.isalnum():
        raise PeerError(f"{text[:20]!r} is no size of an answer; at most {BODY_MAX} bytes are allowed")
    return number
