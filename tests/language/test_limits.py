"""Bounds of the text of a program, and what findings show of a long line."""

from __future__ import annotations

import re

import pytest

from elitescript.language import limits
from elitescript.language.compiler import check_unit
from elitescript.language.diagnostics import LINE_KEPT, LINE_SHOWN, diagnostic, excerpt, line_kept, render
from elitescript.language.limits import LINES_MAX, MAX_UNIT_BYTES, SYMBOLS_MAX, excess, too_deep
from elitescript.language.parser import parse, translated
from elitescript.language.text.source import SourceFile
from elitescript.untrusted.files import PROGRAM


def found(text: str) -> tuple[int, str] | None:
    problem = excess(text)
    return None if problem is None else (problem.line, problem.text)


@pytest.fixture
def small(monkeypatch):
    monkeypatch.setattr(limits, "MAX_UNIT_BYTES", 1000)
    monkeypatch.setattr(limits, "LINES_MAX", 20)
    monkeypatch.setattr(limits, "SYMBOLS_MAX", 300)


def test_the_limits_are_these():
    assert PROGRAM.bytes_max == MAX_UNIT_BYTES
    assert (MAX_UNIT_BYTES, LINES_MAX, SYMBOLS_MAX) == (16_000_000, 200_000, 2_500_000)


@pytest.mark.usefixtures("small")
def test_a_text_at_each_limit_is_read():
    assert found("x" * 1000) is None
    assert found("é" * 500) is None
    assert found("\n" * 20) is None
    assert found("\n".join(["x"] * 20)) is None
    assert found("x," * 150) is None


@pytest.mark.usefixtures("small")
def test_a_text_above_one_says_count_and_limit_and_the_line():
    assert found("x" * 1001) == (1, "the program has 1,001 bytes, at most 1,000 are read")
    assert found("é" * 501) == (1, "the program has 1,002 bytes, at most 1,000 are read")
    assert found("\n" * 20 + "x") == (21, "the program has 21 lines, at most 20 are read")
    assert found("x\n" * 7 + "x," * 150) == (1, "the program has 307 words and signs, at most 300 are read")


@pytest.mark.usefixtures("small")
def test_the_line_is_the_one_in_which_there_are_too_many(monkeypatch):
    monkeypatch.setattr(limits, "_CHUNK", 10)
    assert found("\n" * 7 + "x," * 151) == (8, "the program has 302 words and signs, at most 300 are read")


@pytest.mark.parametrize("text", ["x=1", "not a", "f'{a}'", "é+ü", "a.b[c](d)", "1_000+0x1f", "if x: y # z"])
def test_counts_each_word_and_sign(monkeypatch, text):
    monkeypatch.setattr(limits, "SYMBOLS_MAX", 1)
    count = len(re.findall(r"\w+|[^\w\s]", text))
    assert found(text) == (1, f"the program has {count} words and signs, at most 1 are read")


def test_nothing_of_it_is_parsed(monkeypatch):
    text = "x = (\n" * (LINES_MAX + 5)
    parsed = parse(SourceFile("a.script", text))
    assert [problem.code for problem in parsed.diagnostics] == ["E001"]
    assert not parsed.is_complete
    assert parsed.tree.body == []
    assert parsed.source.text == text
    assert translated(SourceFile("a.script", text)).text == ""
    assert [problem.text for problem in check_unit(SourceFile("a.script", text))] == [
        "the program has 200,005 lines, at most 200,000 are read"
    ]


def test_too_little_memory_is_not_called_nesting():
    assert too_deep("x", MemoryError(), "read") == "the program is nested too deeply to be read"
    assert too_deep("x\n" * 300_000, RecursionError(), "read") == "the program is nested too deeply to be read"
    assert too_deep("x\n" * 300_000, MemoryError(), "compiled") == (
        "there is too little memory for the program to be compiled: 300,001 lines, 600,000 bytes"
    )


class TestLongLines:
    @pytest.mark.parametrize("column", [1, 2, 80, 81, 500, 950, 999, 1000])
    def test_the_caret_stands_under_its_character(self, column):
        line = "".join("abcdefghij"[at % 10] for at in range(1000))
        line = line[: column - 1] + "#" + line[column:]
        _, shown, caret = render(diagnostic("E001", 1, column, "text"), "f", line).split("\n")
        assert shown[caret.index("^")] == "#"
        assert len(shown) <= 4 + LINE_SHOWN + 6

    def test_a_line_that_fits_is_whole(self):
        line = "x" * LINE_SHOWN
        assert excerpt(line, 100) == (line, 0)

    def test_a_finding_to_the_end_of_the_line_is_underlined_to_the_end_of_the_excerpt(self):
        *_, caret = render(diagnostic("E001", 1, 1, "text", end_column=10_000), "f", "x" * 10_000).split("\n")
        assert len(caret) <= 4 + LINE_SHOWN + 6

    def test_an_alarm_keeps_the_beginning_or_what_is_around_its_place(self):
        line = "".join(chr(97 + at % 26) for at in range(5000))
        assert line_kept(line[:LINE_KEPT], 1) == line[:LINE_KEPT]
        assert line_kept(line, 10) == line[:LINE_KEPT] + "..."
        kept = line_kept(line, 4000)
        assert line[3950:4050] in kept
        assert len(kept) < 200
