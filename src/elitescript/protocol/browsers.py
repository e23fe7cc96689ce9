"""Recognises the first bytes of a web browser, so that no page can reach a robot through it.

A page in a browser of this computer can open a connection to any port and send any body, but the bytes before the body
are those of the browser. They are always one of these:

- the line of an HTTP request (RFC 9112, section 3): a method, which may be any token, a target in one of its four
  forms, and a version. A WebSocket begins with one too, and so does HTTP/2 without TLS;
- the first record of TLS (RFC 8446, section 5.1);
- a STUN message (RFC 8489, section 5), from WebRTC over TCP; between peers its length stands before it (RFC 4571).

No script, command or message of a robot's port begins like that: the forms of the target distinguish a request from a
comment (`# speaks HTTP/1.1`) or a popup (`popup -s HTTP/1.1`).
"""

from __future__ import annotations

import re
from typing import Final

_METHOD: Final = re.compile(rb"[!#$%&'*+\-.^_`|~0-9A-Za-z]*")
_BLANKS: Final = b" \t"
_BYTE_ORDER_MARK: Final = b"\xef\xbb\xbf"
_WORD: Final = re.compile(rb"[^\x00-\x20\x7f]*")
_TARGET: Final = re.compile(rb"/.*|\*|[A-Za-z][A-Za-z0-9+.\-]*://.*|[^/?#@]*:[0-9]+", re.DOTALL)
_VERSION: Final = b"HTTP/"
_METHOD_KEPT: Final = 32
_TARGET_KEPT: Final = 512
"""Bytes that decide about the form of a target: longer ones begin with a slash or a scheme."""
_HEAD_MAX: Final = 1024
"""Bytes that are parsed again when more arrive; method and target of a longer line are cut."""
_TLS: Final = re.compile(rb"\x16\x03[\x01-\x04]")
_STUN: Final = re.compile(rb"(?:..)?\x00[\x01\x03]..\x21\x12\xa4\x42", re.DOTALL)
_BINARY_MAX: Final = 10


class FirstBytes:
    """Examines the first bytes of a client until it is known whether it is a browser.

    Attributes:
        is_decided: whether no more bytes are needed.
        found: description of what a browser has sent; empty if none has so far.
    """

    __slots__ = ("_head", "found", "is_decided")

    def __init__(self) -> None:
        self._head = b""
        self.is_decided = False
        self.found = ""

    def feed(self, data: bytes) -> str:
        """Take the next bytes; return `found`."""
        if not self.is_decided:
            self._head += data
            self.found = _binary(self._head) or self._request()
            if self.found or self.is_decided:
                self.is_decided, self._head = True, b""
        return self.found

    def _request(self) -> str:
        """Return the description of a request line, empty if it is none; set `is_decided` if it cannot become one."""
        if (self._head[:1] < b" " or self._head[2:3] == b"\x00") and len(self._head) < _BINARY_MAX:
            return ""
        # Servers ignore blank lines, blanks and a byte order mark before a request.
        line = self._head = self._head.lstrip(b"\r\n \t")
        if line.startswith(_BYTE_ORDER_MARK):
            line = self._head = line[len(_BYTE_ORDER_MARK) :].lstrip(b"\r\n \t")
        if not line or _BYTE_ORDER_MARK.startswith(line):
            return ""
        method = _longest(_METHOD, line)
        behind = line[len(method) :]
        rest = behind.lstrip(_BLANKS)
        if not behind:
            self._keep(method[:_METHOD_KEPT])
        elif not method or len(rest) == len(behind):
            self.is_decided = True
        elif rest:
            return self._target(method[:_METHOD_KEPT], rest)
        else:
            self._keep(method[:_METHOD_KEPT] + b" ")
        return ""

    def _target(self, method: bytes, line: bytes) -> str:
        target = _longest(_WORD, line)
        behind = line[len(target) :]
        version = behind.lstrip(_BLANKS)
        if not behind:
            self._keep(method + b" " + target[:_TARGET_KEPT])
        elif len(version) == len(behind) or not _TARGET.fullmatch(target[:_TARGET_KEPT]):
            self.is_decided = True
        else:
            begin, digit = version[: len(_VERSION)].upper(), version[len(_VERSION) : len(_VERSION) + 1]
            if begin == _VERSION and digit.isdigit():
                return f"a web request ({method.decode('ascii')})"
            if digit or not _VERSION.startswith(begin):
                self.is_decided = True
            else:
                self._keep(method + b" " + target[:_TARGET_KEPT] + b" " + begin)
        return ""

    def _keep(self, head: bytes) -> None:
        """Shorten a line that is too long to `head`, which is parsed alike."""
        if len(self._head) > _HEAD_MAX:
            self._head = head


def is_web_request(line: bytes) -> bool:
    """Return whether a whole line is the first one of a browser."""
    return bool(FirstBytes().feed(line))


def _binary(head: bytes) -> str:
    if _TLS.match(head):
        return "a TLS greeting"
    return "a STUN message" if _STUN.match(head) else ""


def _longest(pattern: re.Pattern[bytes], data: bytes) -> bytes:
    found = pattern.match(data)
    assert found is not None
    return found[0]
