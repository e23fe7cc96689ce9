"""Messages in a stream: whole, byte by byte, trailing, broken, too long."""

from __future__ import annotations

import json
import random

import pytest

from elitescript.dap.framing import BODY_MAX, HEADER_MAX, Decoder, Malformed, framed

MESSAGE = {"seq": 3, "type": "request", "command": "évaluer", "arguments": {"x": [1, None, "𝄞"]}}


def raw(body: bytes, header: bytes = b"") -> bytes:
    return header + b"Content-Length: %d\r\n\r\n%b" % (len(body), body)


def test_a_message_is_a_header_and_json():
    data = framed({"seq": 1})
    assert data == b'Content-Length: 9\r\n\r\n{"seq":1}'


def test_messages_come_whole_or_byte_by_byte():
    data = framed(MESSAGE) + framed({"seq": 4})
    assert Decoder().feed(data) == [MESSAGE, {"seq": 4}]
    decoder = Decoder()
    found = [message for at in range(len(data)) for message in decoder.feed(data[at : at + 1])]
    assert found == [MESSAGE, {"seq": 4}]


def test_lengths_count_bytes_not_characters():
    body = json.dumps(MESSAGE, ensure_ascii=False).encode()
    assert Decoder().feed(raw(body) + raw(b"{}")) == [MESSAGE, {}]


@pytest.mark.parametrize(
    "header", [b"Content-Type: application/json\r\n", b"X: y\r\nContent-Type: a; charset=utf-8\r\n"]
)
def test_other_headers_are_left_out(header):
    assert Decoder().feed(raw(b"{}", header)) == [{}]


def test_names_of_headers_have_any_case():
    assert Decoder().feed(b"content-length:2\r\n\r\n{}") == [{}]


@pytest.mark.parametrize(
    ("data", "text"),
    [
        (b"Content-Length: x\r\n\r\n", "without a Content-Length"),
        (b"Content-Length: -2\r\n\r\n", "without a Content-Length"),
        (b"hello\r\n\r\n", "without a Content-Length"),
        (b"\r\n\r\n", "without a Content-Length"),
        (raw(b"{"), "no JSON"),
        (raw(b"[1]"), "a list where an object"),
        (raw(b"7"), "a int where an object"),
        (raw(b'{"x": "\xff"}'), "not UTF-8"),
        (raw(b"[" * 100_000), "no JSON"),
        (b"x" * (HEADER_MAX + 1) + b"\r\n\r\n", "without the end of a header"),
    ],
)
def test_what_is_no_message_is_named_and_the_next_one_is_read(data, text):
    first, *rest = Decoder().feed(data + framed(MESSAGE))
    assert isinstance(first, Malformed)
    if "end of a header" not in text:
        assert text in first.text
    assert rest[-1] == MESSAGE


def test_a_header_without_an_end_is_not_kept():
    decoder = Decoder()
    (found,) = decoder.feed(b"x" * (HEADER_MAX + 1))
    assert isinstance(found, Malformed)
    assert "without the end of a header" in found.text
    assert decoder.feed(b"\r\n\r\n" + framed(MESSAGE))[-1] == MESSAGE


def test_a_message_that_is_too_long_is_skipped_without_being_kept():
    decoder = Decoder()
    (found,) = decoder.feed(b"Content-Length: %d\r\n\r\n" % (BODY_MAX + 3))
    assert isinstance(found, Malformed)
    assert str(BODY_MAX) in found.text
    piece = bytes(1 << 20)
    for _ in range(BODY_MAX >> 20):
        assert decoder.feed(piece) == []
        assert len(decoder._buffer) == 0
    assert decoder.feed(b"xyz" + framed(MESSAGE)) == [MESSAGE]


def test_random_bytes_between_messages_never_raise():
    chance = random.Random(5)
    for _ in range(300):
        decoder = Decoder()
        data = bytearray(framed(MESSAGE) * 3)
        for _ in range(chance.randrange(1, 6)):
            at = chance.randrange(len(data))
            data[at : at + chance.randrange(3)] = chance.randbytes(chance.randrange(4))
        for begin in range(0, len(data), 50):
            for message in decoder.feed(bytes(data[begin : begin + 50])):
                assert isinstance(message, dict | Malformed)
