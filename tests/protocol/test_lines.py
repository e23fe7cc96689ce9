"""Cutting a stream into lines."""

from __future__ import annotations

import random

import pytest

from elitescript.protocol.lines import LineSplitter, PacedLines, TextLine, one_line, shown


def fed(chunks: list[bytes], limit: int = 10) -> list[TextLine]:
    splitter = LineSplitter(limit)
    return [line for chunk in chunks for line in splitter.feed(chunk)]


@pytest.mark.parametrize(
    ("data", "texts"),
    [
        (b"", []),
        (b"abc", []),
        (b"abc\n", ["abc"]),
        (b"abc\r\n", ["abc"]),
        (b"abc\r\r\n", ["abc\r"]),
        (b"\n\r\n", ["", ""]),
        (b"a\nb\r\nc", ["a", "b"]),
        (b"a\rb\n", ["a\rb"]),
        ("grüß\n".encode(), ["grüß"]),
    ],
)
def test_lines_end_in_a_line_feed(data: bytes, texts: list[str]) -> None:
    whole = fed([data])
    assert [(line.text, line.problem) for line in whole] == [(text, "") for text in texts]
    assert fed([bytes([byte]) for byte in data]) == whole


@pytest.mark.parametrize("end", [b"\n", b"\r\n"])
def test_a_line_may_be_as_long_as_the_limit(end: bytes) -> None:
    assert fed([b"0123456789" + end]) == [TextLine("0123456789")]
    assert fed([b"0123456789\rab" + end]) == [TextLine("0123456789", "the line is longer than 10 bytes")]
    assert fed([b"0123456789a" + end]) == [TextLine("0123456789", "the line is longer than 10 bytes")]


def test_a_line_that_is_too_long_is_reported_once_and_before_its_end() -> None:
    splitter = LineSplitter(10)
    assert len(splitter.feed(b"x" * 12)) == 1
    assert splitter.feed(b"x" * 100_000) == []
    assert splitter.held == 0
    assert splitter.feed(b"yy\nnext\n") == [TextLine("next")]


def test_what_is_held_is_bounded() -> None:
    splitter = LineSplitter(10)
    for _ in range(1000):
        splitter.feed(b"z")
        assert splitter.held <= 11


def test_bytes_that_are_not_text_are_pointed_at() -> None:
    assert fed([b"ab\xffc\n"]) == [TextLine("ab\ufffdc", "the line is not UTF-8 at byte 2")]
    (line,) = fed(["popup 开始\n".encode("gbk")])
    assert line.problem == "the line is not UTF-8 at byte 6; as GBK it is 'popup 开始'"


def test_the_cut_of_the_stream_does_not_matter() -> None:
    for seed in range(300):
        chance = random.Random(seed)
        data = bytes(chance.choice(b"ab\r\n\xff\xc3\xa9") for _ in range(chance.randrange(60)))
        cuts = sorted(chance.randrange(len(data) + 1) for _ in range(chance.randrange(8)))
        chunks = [data[a:b] for a, b in zip([0, *cuts], [*cuts, len(data)], strict=True)]
        assert fed(chunks, 5) == fed([data], 5), seed


def test_text_of_a_peer_is_shown_short_and_printable() -> None:
    assert shown("a\x00b\x1b[31m") == "a?b?[31m"
    assert shown("x" * 61) == "x" * 60 + "..."
    assert one_line("a\r\nb\nc") == "a b c"


def test_so_many_lines_are_read_in_a_tick_however_they_arrive() -> None:
    data = b"".join(b"%d\n" % number for number in range(20)) + b"unfinished"
    for seed in range(100):
        chance = random.Random(seed)
        lines, found, at, tick = PacedLines(10, 3), [], 0, 0
        while at < len(data) or lines.is_waiting:
            size = chance.randrange(12)
            lines.feed(data[at : at + size])
            at += size
            taken = [line.text for line in lines.take(tick) + lines.take(tick)]
            assert len(taken) <= 3
            found += taken
            tick += 1
        assert found == [str(number) for number in range(20)], seed


def test_a_long_line_without_an_end_does_not_wait() -> None:
    lines = PacedLines(10, 3)
    lines.feed(b"x" * 100_000)
    assert [line.problem for line in lines.take(0)] == ["the line is longer than 10 bytes"]
    assert not lines.is_waiting


def test_what_waits_can_be_had_at_once() -> None:
    lines = PacedLines(10, 1)
    lines.feed(b"a\nb\nc\nd")
    assert [line.text for line in lines.take(0)] == ["a"]
    assert [line.text for line in lines.rest()] == ["b", "c"]
