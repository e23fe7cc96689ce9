"""A stream is cut into messages wherever its parts begin and end."""

from __future__ import annotations

import pytest

from elitescript.lsp import frames
from elitescript.lsp.frames import BROKEN, Frames


def framed(body: bytes) -> bytes:
    return b"Content-Length: %d\r\n\r\n%s" % (len(body), body)


MESSAGES = [b'{"a": 1}', b"{}", '{"\u00e9": 2}'.encode()]
STREAM = b"".join(map(framed, MESSAGES))


@pytest.mark.parametrize("size", [1, 3, 7, len(STREAM)])
def test_parts_of_any_size(size):
    cut = Frames()
    found = []
    for start in range(0, len(STREAM), size):
        found += cut.feed(STREAM[start : start + size])
    assert found == MESSAGES


def test_other_headers_and_capitals_do_not_matter():
    data = b"Content-Type: application/vscode-jsonrpc; charset=utf-8\r\ncontent-length:2\r\n\r\n{}"
    assert Frames().feed(data) == [b"{}"]


@pytest.mark.parametrize("header", [b"Content-Length: x", b"Content-Length: -2", b"hello", b""])
def test_a_header_without_a_length_is_one_broken_message(header):
    cut = Frames()
    assert cut.feed(header + b"\r\n\r\n") == [BROKEN]
    assert cut.feed(STREAM) == MESSAGES


def test_bytes_without_a_header_do_not_pile_up():
    cut = Frames()
    found = cut.feed(b"x" * 3 * frames.HEADER_BYTES_MAX)
    assert found == [BROKEN]
    assert len(cut._buffer) < 10


@pytest.mark.parametrize("size", [5, 1000])
def test_a_message_that_is_too_long_is_skipped(monkeypatch, size):
    monkeypatch.setattr(frames, "MESSAGE_BYTES_MAX", 20)
    data = framed(b"y" * 100) + framed(b"{}")
    cut = Frames()
    found = []
    for start in range(0, len(data), size):
        found += cut.feed(data[start : start + size])
    assert found == [BROKEN, b"{}"]
