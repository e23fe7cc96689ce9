"""Answers of HTTP servers, in pieces of every size."""

from __future__ import annotations

from random import Random

import pytest

from elitescript.errors import PeerError
from elitescript.runtime.connections.http_answers import BODY_MAX, HEAD_MAX, HttpAnswer, HttpReader


def read(data: bytes, piece: int = 10**9, *, closes: bool = False) -> HttpAnswer | str | None:
    """Feed an answer in pieces, as a connection does."""
    reader, received, answer = HttpReader(), bytearray(), None
    for start in range(0, len(data), piece):
        received += data[start : start + piece]
        answer, used = reader(received, False)
        del received[:used]
        if answer is not None:
            return answer
    return reader.at_end() if closes else answer


ANSWERS = {
    "length": (b"HTTP/1.1 200 OK\r\nContent-Length: 5\r\n\r\nhello", HttpAnswer(200, "OK", b"hello", True)),
    "no body": (b"HTTP/1.1 200 OK\r\ncontent-length: 0\r\n\r\n", HttpAnswer(200, "OK", b"", True)),
    "old": (b"HTTP/1.0 200 OK\r\nContent-Length: 2\r\n\r\nhi", HttpAnswer(200, "OK", b"hi", False)),
    "old, kept": (
        b"HTTP/1.0 200 OK\r\nConnection: Keep-Alive\r\nContent-Length: 2\r\n\r\nhi",
        HttpAnswer(200, "OK", b"hi", True),
    ),
    "closing": (
        b"HTTP/1.1 404 Not Found\r\nConnection: close\r\nContent-Length: 1\r\n\r\nx",
        HttpAnswer(404, "Not Found", b"x", False),
    ),
    "chunks": (
        b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n3;x=y\r\nabc\r\nA\r\n0123456789\r\n0\r\nT: 1\r\n\r\n",
        HttpAnswer(200, "OK", b"abc0123456789", True),
    ),
    "after 100": (
        b"HTTP/1.1 100 Continue\r\n\r\nHTTP/1.1 200 OK\r\nContent-Length: 1\r\n\r\n1",
        HttpAnswer(200, "OK", b"1", True),
    ),
    "bare line feeds": (b"HTTP/1.1 200\nContent-Length: 1\n\n1", HttpAnswer(200, "", b"1", True)),
    "nothing to say": (b"HTTP/1.1 204 No Content\r\n\r\n", HttpAnswer(204, "No Content", b"", True)),
}


@pytest.mark.parametrize("name", ANSWERS)
@pytest.mark.parametrize("piece", [1, 2, 3, 7, 1000])
def test_reads_an_answer_in_pieces(name, piece):
    data, expected = ANSWERS[name]
    assert read(data, piece) == expected


@pytest.mark.parametrize("name", ANSWERS)
def test_leaves_what_follows(name):
    data, _ = ANSWERS[name]
    assert HttpReader()(bytearray(data + b"HTTP/1.1 500"), False)[1] == len(data)


@pytest.mark.parametrize("name", ANSWERS)
def test_wants_more_until_the_last_byte(name):
    data, _ = ANSWERS[name]
    assert read(data[:-1], 5) is None
    assert HttpReader()(bytearray(data[:-1]), True)[0] == ""


def test_without_a_length_the_end_of_the_connection_ends_the_answer():
    data = b"HTTP/1.0 200 OK\r\n\r\nall of it"
    assert read(data) is None
    assert read(data, 4, closes=True) == HttpAnswer(200, "OK", b"all of it", False)


@pytest.mark.parametrize("data", [b"", b"HTTP/1.1 200 OK\r\nContent-Length: 5\r\n\r\nhell"])
def test_an_answer_that_is_cut_short_is_none(data):
    with pytest.raises(PeerError, match="in its answer" if data else "unasked"):
        read(data, closes=True)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"SSH-2.0-OpenSSH_9.2\r\n", "no HTTP"),
        (b"HTTP/2 200\r\n\r\n", "no HTTP"),
        (b"HTTP/1.1 abc\r\n\r\n", "no HTTP"),
        (b"HTTP/1.1 200 OK\r\nno field\r\n\r\n", "no field"),
        (b"HTTP/1.1 200 OK\r\nContent-Length: -1\r\n\r\n", "no size"),
        (b"HTTP/1.1 200 OK\r\nContent-Length: 1_0\r\n\r\n", "no size"),
        (b"HTTP/1.1 200 OK\r\nContent-Length: 99999999\r\n\r\n", "no size"),
        (b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\nxyz\r\n", "no size"),
        (b"HTTP/1.1 200 OK\r\n" + b"a" * (HEAD_MAX + 20), "without the end of a head"),
        (b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n" + b"1" * (HEAD_MAX + 20), "no size"),
        (b"HTTP/1.1 200 OK\r\n\r\n" + b"a" * (BODY_MAX + 1), "more than"),
    ],
)
def test_refuses_what_is_no_answer(data, words):
    with pytest.raises(PeerError, match=words):
        read(data)


def test_any_bytes_are_an_answer_or_refused():
    random = Random(5)
    outcomes = set()
    for _ in range(2000):
        data = bytearray(random.choice(list(ANSWERS.values()))[0])
        for _ in range(random.randrange(4)):
            data[random.randrange(len(data))] = random.randrange(256)
        try:
            outcomes.add(type(read(bytes(data), random.randrange(1, 40), closes=True)))
        except PeerError:
            outcomes.add(PeerError)
    assert outcomes == {HttpAnswer, PeerError}
