"""What a web browser sends first, and what only looks like it."""

from __future__ import annotations

import pytest

from elitescript.protocol.browsers import FirstBytes, is_web_request

WEB = {
    "a form": (b"POST / HTTP/1.1\r\nHost: 127.0.0.1:30001\r\n\r\ndef f():\n", "a web request (POST)"),
    "an address in the tab": (b"GET /a?b=c%20d HTTP/1.0\r\n\r\n", "a web request (GET)"),
    "preflight": (b"OPTIONS * HTTP/1.1\r\n", "a web request (OPTIONS)"),
    "through a proxy": (b"GET http://robot/x HTTP/1.1\r\n", "a web request (GET)"),
    "a tunnel": (b"CONNECT 127.0.0.1:30001 HTTP/1.1\r\n", "a web request (CONNECT)"),
    "a tunnel, IPv6": (b"CONNECT [::1]:30001 HTTP/1.1\r\n", "a web request (CONNECT)"),
    "a method that looks like a command": (b"popup / HTTP/1.1\r\n", "a web request (popup)"),
    "a method that looks like a comment": (b"# / HTTP/1.1\r\n", "a web request (#)"),
    "any token": (b"!#$%&'*+-.^_`|~09azAZ / HTTP/1.1\r\n", "a web request (!#$%&'*+-.^_`|~09azAZ)"),
    "small letters": (b"post / http/1.1\r\n", "a web request (post)"),
    "wide blanks": (b"POST  /\t HTTP/1.1\r\n", "a web request (POST)"),
    "blank lines before": (b"\r\n\r\nPOST / HTTP/1.1\r\n", "a web request (POST)"),
    "blanks before": (b" \t POST / HTTP/1.1\r\n", "a web request (POST)"),
    "a byte order mark before": (b"\xef\xbb\xbf\r\nPOST / HTTP/1.1\r\n", "a web request (POST)"),
    "HTTP/2 without TLS": (b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", "a web request (PRI)"),
    "HTTP/3 some day": (b"GET / HTTP/3\r\n", "a web request (GET)"),
    "bare line feeds": (b"POST / HTTP/1.1\n\nhalt()\n", "a web request (POST)"),
    "a long target": (b"GET /" + b"a" * 100_000 + b" HTTP/1.1\r\n", "a web request (GET)"),
    "a long method": (b"X" * 100_000 + b" / HTTP/1.1\r\n", f"a web request ({'X' * 32})"),
    "TLS": (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", "a TLS greeting"),
    "WebRTC": (b"\x00\x03\x00\x24\x21\x12\xa4\x42" + bytes(12), "a STUN message"),
    "WebRTC between peers": (b"\x00\x54\x00\x01\x00\x40\x21\x12\xa4\x42" + bytes(12), "a STUN message"),
}

ROBOT = {
    "a program": b"def pick():\n  movej([0, 0, 0, 0, 0, 0])\nend\n",
    "a secondary program": b"sec s():\n  x = 1\nend\n",
    "a call": b"movej([0,-1.57,0,-1.57,0,0], a=1.4)\n",
    "a word": b"halt\n",
    "a command": b"stop task\n",
    "a division": b"speed / limit\n",
    "a comment about it": b"# speaks HTTP/1.1\ndef f():\n",
    "a longer comment": b"# POST / HTTP/1.1 is refused\n",
    "a text about it": b'textmsg("POST / HTTP/1.1")\n',
    "a popup": b"popup -s HTTP/1.1\n",
    "a longer popup": b"popup -s GET / HTTP/1.1\n",
    "a path": b"task -l /tasks/HTTP/1.1\n",
    "a query": b"req 1 get_actual_tcp_pose()\n",
    "RTSI": b"\x00\x05V\x00\x01\x00\x03v",
    "a long RTSI message": b"\x16\x03O" + b"a" * 100,
    "Modbus": b"\x16\x03\x00\x00\x00\x06\x01\x03\x00\x80\x00\x01",
    "Modbus, the first request": b"\x00\x01\x00\x00\x00\x06\x01\x03\x00\x80\x00\x01",
    "not a version": b"GET / HTTP/x\n",
    "nothing but a version": b"HTTP/1.1 200 OK\r\n",
    "an indented comment": b"  # GET / HTTP/1.1\n",
    "a byte order mark before a program": b"\xef\xbb\xbfdef pick():\n  halt()\nend\n",
    "blanks before a command": b"  robotControl -on\r\n",
    "nothing": b"",
}


@pytest.mark.parametrize("name", WEB)
@pytest.mark.parametrize("size", [1, 7, 1_000_000])
def test_a_browser_is_known_in_pieces_of_any_size(name, size):
    data, found = WEB[name]
    first = FirstBytes()
    longest = len(data) if size > 1 else min(len(data), 3000)
    if longest < len(data):
        # Byte by byte only the end of a long line is of interest.
        first.feed(data[: len(data) - longest])
        data = data[len(data) - longest :]
    for at in range(0, len(data), size):
        if first.feed(data[at : at + size]):
            break
    assert first.found == found
    assert first.is_decided


@pytest.mark.parametrize("name", ROBOT)
@pytest.mark.parametrize("size", [1, 7, 1_000_000])
def test_what_robots_are_sent_is_none(name, size):
    first = FirstBytes()
    for at in range(0, len(ROBOT[name]), size):
        assert not first.feed(ROBOT[name][at : at + size])


def test_only_the_first_line_counts():
    first = FirstBytes()
    assert not first.feed(b"halt()\n")
    assert first.is_decided
    assert not first.feed(b"POST / HTTP/1.1\r\n")


def test_a_line_without_an_end_is_not_kept():
    first = FirstBytes()
    for _ in range(1000):
        first.feed(b"a" * 1000)
    assert len(first._head) < 3000
    first.feed(b" /")
    for _ in range(1000):
        first.feed(b"a" * 1000)
    assert len(first._head) < 3000
    assert first.feed(b" HTTP/1.1")


def test_a_whole_line():
    assert is_web_request(b"POST / HTTP/1.1\r\n")
    assert not is_web_request(b'{"verb": "state"}\n')
