from __future__ import annotations

import sys
import time
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elitescript.language.text import lexer
from elitescript.language.text.lexer import LogicalLine, indentation_width
from elitescript.language.text.masked import lex

ROOT = Path(__file__).parent.parent.parent


def code_lines(text):
    lexed = lex(text)
    return [lexed.masked[line.start : line.end] for line in lexed.lines]


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("a = 1\nb = 2\n", ["a = 1", "b = 2"]),
        ("a = 1  # note\n# alone\n\n   \nb", ["a = 1", "b"]),
        ("f(1,\n  2)\ng", ["f(1,   2)", "g"]),
        ("a = 1 + \\\n  2\nb", ["a = 1 +     2", "b"]),
        ("f(1, # one\n 2) # two\n", ["f(1,        2)"]),
        ('a = "x # y"  # z', ['a = """""""']),
        ("a = 'it''s'", ['a = """""""']),
        ('a = """x\nend\n"""\nb', ['a = """"""""""""', "b"]),
        ('a = "x\\\ny"\nb', ['a = """"""', "b"]),
        ("if x: # y\n  f()", ["if x:", "f()"]),
        ("a\\\n\n\nb", ["a", "b"]),
        ("", []),
        ("\\\na", ["a"]),
    ],
)
def test_logical_lines(text, lines):
    assert code_lines(text) == lines


@pytest.mark.parametrize("prefix", ["", "r", "R", "b", "B", "u", "U", "f", "F", "rb", "bR", "Rb", "BR", "fr", "RF"])
@pytest.mark.parametrize("quote", ["'", '"', "'''", '"""'])
def test_all_string_prefixes_belong_to_the_string(prefix, quote):
    text = f"a = {prefix}{quote}x(#{quote} + y"
    assert lex(text).masked == "a = " + '"' * len(f"{prefix}{quote}x(#{quote}") + " + y"


def test_letters_of_a_name_are_not_a_prefix():
    assert lex('bar"x"').masked == 'bar"""'


def test_a_raw_string_ends_at_the_quote_behind_an_even_backslash():
    assert [line.word for line in lex("a = r'\\\\'\nb = '\\''\nc").lines] == ["a", "b", "c"]


@pytest.mark.parametrize(
    "text",
    [
        "f'{d[\"key\"]}' # '",
        'f"{d["key"]}" # \'',
        "f'{x!r:>{width}}' + 'y'",
        "f'{{' + f'}}'",
        "f'{ {1: 2}[1] }'",
        "f\"{'#'}\" # x",
        "f'''{x\n}'''",
        "f'{f\"{1}\"}'",
        "f'\\N{DIGIT ONE}{x}'",
    ],
)
def test_formatted_strings_end_behind_their_fields(text):
    lexed = lex(f"a = {text}\nb = 1")
    assert [line.word for line in lexed.lines] == ["a", "b"]
    assert lexed.flaws == []


def test_masking_keeps_every_offset():
    text = 'a = "x" # y\nb = f("""p\nq""", [1,\n 2]) \\\n + 3\n'
    masked = lex(text).masked
    assert len(masked) == len(text)
    assert masked.index("f(") == text.index("f(")
    assert masked.index("+ 3") == text.index("+ 3")


@pytest.mark.parametrize(
    ("blank", "width"), [("", 0), ("  ", 2), ("\t", 8), ("\t  ", 10), ("  \t", 8), ("    \f  ", 2), (" \t \t", 16)]
)
def test_indentation_counts_tabs_like_python(blank, width):
    assert indentation_width(blank) == width
    assert lex(f"{blank}x").lines[0].column == width


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("a = (1\nb = 2\n", (1, 5), ["a", "b"]),
        ("f(g(1)\ndef h():\n  pass\n", (1, 2), ["f", "def", "pass"]),
        ("x = [1,\n     2,\nend\n", (1, 5), ["x", "end"]),
        ("x = 1)\ny\n", (1, 6), ["x", "y"]),
        ("x = (1]\ny\n", (1, 7), ["x", "y"]),
        ("x = 'abc\ny\n", (1, 5), ["x", "y"]),
        ("f('abc)\ny\n", (1, 3), ["f", "y"]),
        ('x = """abc\ny\n', (1, 5), ["x"]),
        ("f(\n", (1, 2), ["f"]),
        ("f(1\n   + 2\n\n# c\ng\n", (1, 2), ["f", "g"]),
    ],
)
def test_one_flaw_spoils_only_its_own_statement(text, place, words):
    lexed = lex(text)
    assert [lexed.place(flaw.start) for flaw in lexed.flaws] == [place]
    assert [line.word for line in lexed.lines] == words
    assert [line.broken for line in lexed.lines] == [True] + [False] * (len(words) - 1)


def test_an_open_bracket_before_a_docstring_does_not_cut_the_docstring():
    lexed = lex('def f(:\n  """x\ny(\n"""\n  g()\n')
    assert len(lexed.flaws) == 1


def test_masked_rows_are_those_of_physical_lines():
    lexed = lex("f('a', # b\n  2)  # c\n# d\nx")
    assert [lexed.masked_row(line).rstrip() for line in (1, 2, 3, 4)] == ['f(""",', "  2)", "", "x"]


def test_places_count_from_one():
    lexed = lex("ab\ncd\n")
    assert [lexed.place(offset) for offset in (0, 1, 3, 4, 6)] == [(1, 1), (1, 2), (2, 1), (2, 2), (3, 1)]


@pytest.mark.parametrize(
    "text",
    [
        "(\n" * 5_000,
        "f'{" * 20_000,
        "f'''{''' " * 10_000,
        "'\n" * 20_000,
        "f'{f\"" * 20_000,
        "[" * 100_000,
        "\\\n" * 50_000,
    ],
    ids=["brackets", "fields", "long fields", "quotes", "nested fields", "depth", "continuations"],
)
def test_hostile_texts_are_read_in_linear_time(text):
    began = time.perf_counter()
    lex(text)
    assert time.perf_counter() - began < 3.0


@settings(max_examples=300)
@given(st.text(alphabet="ab \t\n\\'\"#()[]{}f:r;", max_size=60))
def test_masking_never_changes_the_length_and_lines_follow_each_other(text):
    lexed = lex(text)
    assert len(lexed.masked) == len(text)
    last = 0
    for line in lexed.lines:
        assert last <= line.start < line.end <= len(text) or line.broken
        assert lexed.place(line.start)[0] == line.line
        assert line.line <= line.last_line <= text.count("\n") + 1
        last = line.end
    rows = [line.line for line in lexed.lines]
    assert rows == sorted(rows)


@pytest.mark.skipif(sys.version_info < (3, 12), reason="nested quotes are new in 3.12")
def test_nested_quotes_work_where_python_has_them():
    assert lex('a = f"{d["x"]}"\n').flaws == []


@pytest.mark.parametrize("path", sorted((ROOT / "examples").glob("*.script")), ids=lambda path: path.stem)
def test_plain_lines_that_are_read_at_once_are_as_those_that_are_read_sign_by_sign(monkeypatch, path):
    text = path.read_text(encoding="utf-8")

    def read(long_text):
        monkeypatch.setattr(lexer, "LONG_TEXT", long_text)
        lexed = lex(text)
        lines = [[getattr(line, name) for name in LogicalLine.__slots__] for line in lexed.lines]
        return lines, lexed.masked, lexed.flaws, [tuple(string) for string in lexed.strings]

    assert read(0) == read(len(text) + 1)
