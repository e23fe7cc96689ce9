from __future__ import annotations

import pytest

from elitescript.errors import ProgramError
from elitescript.language.text.source import SourceFile, find_word


@pytest.mark.parametrize("text", ["a\nb\n", "a\r\nb\r\n", "a\rb\r", "a\r\nb\r", "\ufeffa\nb\n"])
def test_line_ends_and_byte_order_mark_make_no_difference(text):
    source = SourceFile("f", text)
    assert source.text == "a\nb\n"
    assert source.lines == ("a", "b", "")


def test_only_line_ends_separate_lines():
    """Form feeds and Unicode separators are characters within a line, as in Python."""
    assert len(SourceFile("f", "a\x0cb\u2028c\x85d").lines) == 1


def test_lines_count_from_one():
    source = SourceFile("f", "one\ntwo")
    assert [source.line(n) for n in (0, 1, 2, 3)] == ["", "one", "two", ""]


def test_utf8_bytes_are_decoded():
    assert SourceFile.from_bytes("f", "温度 = 25\r\n".encode()).text == "温度 = 25\n"


@pytest.mark.parametrize(
    ("data", "line", "column"),
    [
        (b"\xff", 1, 1),
        (b"a = 1\nb = \xe9\n", 2, 5),
        (b"a\r\nb\r\n  \xb0", 3, 3),
        ("温度 = ".encode() + b"\xc3(", 1, 6),
        (b"\xef\xbb\xbfab\x80", 1, 3),
    ],
)
def test_bytes_that_are_not_utf8_are_refused_at_their_place(data, line, column):
    with pytest.raises(ProgramError) as caught:
        SourceFile.from_bytes("f", data)
    (problem,) = caught.value.problems
    assert (problem.code, problem.line, problem.column) == ("E002", line, column)
    assert "0x" in problem.text and problem.hint


def test_a_source_is_a_value():
    assert SourceFile("f", "a\r\n") == SourceFile("f", "a\n")
    assert hash(SourceFile("f", "a")) == hash(SourceFile("f", "a"))


@pytest.mark.parametrize(
    ("row", "start", "place"),
    [
        ("x = xx + x", 0, 0),
        ("xx = x", 0, 5),
        ("xx = x", 1, 1),
        ("_x x_ x1 \u4f4dx", 0, -1),
        ("(x)", 0, 1),
        ("", 0, -1),
    ],
)
def test_a_word_is_found_where_it_stands_by_itself(row, start, place):
    assert find_word(row, "x", start) == place
