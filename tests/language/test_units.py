from __future__ import annotations

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elitescript.language.limits import MAX_UNIT_BYTES
from elitescript.language.options import LINE, PROGRAM, SECONDARY
from elitescript.language.text import units
from elitescript.language.text.units import SILENT_LINE_MAX, DiscardedText, Unit, UnitSplitter


def said(parts):
    """What a splitter returned, short: (kind, text, first line), or (code, first line)."""
    return [
        (part.kind, part.text, part.first_line) if isinstance(part, Unit) else (part.problems[0].code, part.first_line)
        for part in parts
    ]


STREAMS = [
    ("def a():\n  f()\nend\n", [(PROGRAM, "def a():\n  f()\nend", 1)]),
    ("sec b():\n  f()\nend\n", [(SECONDARY, "sec b():\n  f()\nend", 1)]),
    ("halt()\n", [(LINE, "halt()", 1)]),
    ("\n\n  \n# note\nhalt()\n\n", [(LINE, "halt()", 5)]),
    ("a()\nb()\n", [(LINE, "a()", 1), (LINE, "b()", 2)]),
    (
        "def a():\n  if x:\n    f()\n  end\nend\ndef b():\n  g()\nend # b\n",
        [(PROGRAM, "def a():\n  if x:\n    f()\n  end\nend", 1), (PROGRAM, "def b():\n  g()\nend # b", 6)],
    ),
    ("def a():\n  f()\nend\na()\n", [(PROGRAM, "def a():\n  f()\nend", 1), (LINE, "a()", 4)]),
    ("def a():\n  f()\nend;\n", [(PROGRAM, "def a():\n  f()\nend;", 1)]),
    ("def a():\n  end = 1\nendless = 2\nend\n", [(PROGRAM, "def a():\n  end = 1\nendless = 2\nend", 1)]),
    ('def a():\n  s = """\nend\n"""\n  f()\nend\n', [(PROGRAM, 'def a():\n  s = """\nend\n"""\n  f()\nend', 1)]),
    ("def a():\n  v = [\nend\n  ]\nend\n", [(PROGRAM, "def a():\n  v = [\nend\n  ]\nend", 1)]),
    ("def a():\n  v = 1 + \\\nend\nend\n", [(PROGRAM, "def a():\n  v = 1 + \\\nend\nend", 1)]),
    ("def a():\n  s = 'it\\\nend'\nend\n", [(PROGRAM, "def a():\n  s = 'it\\\nend'\nend", 1)]),
    ("def a():\n  s = ')' # (\nend\n", [(PROGRAM, "def a():\n  s = ')' # (\nend", 1)]),
    ("movej([0,\n  0])\nhalt()\n", [(LINE, "movej([0,\n  0])", 1), (LINE, "halt()", 3)]),
    ("def a():\n  f()\ndef b():\n  g()\nend\n", [("E102", 1), (PROGRAM, "def b():\n  g()\nend", 3)]),
    ("def a():\n  f((\nend\nsec b():\n  g()\nend\n", [("E102", 1), (SECONDARY, "sec b():\n  g()\nend", 4)]),
    ("f(\ndef b():\n  g()\nend\n", [(LINE, "f(", 1), (PROGRAM, "def b():\n  g()\nend", 2)]),
    ("sec = 5\nsection()\ndefine()\n", [(LINE, "sec = 5", 1), (LINE, "section()", 2), (LINE, "define()", 3)]),
    ("sec (1)\n", [(LINE, "sec (1)", 1)]),
    ("if True:\n  f()\n", [(LINE, "if True:", 1), (LINE, "  f()", 2)]),
    ("end\n", [(LINE, "end", 1)]),
    ("\ufeffdef 任务():\n  f('온도')\nend\n", [(PROGRAM, "def 任务():\n  f('온도')\nend", 1)]),
    ("def\ta():\n\tf()\nend\n", [(PROGRAM, "def\ta():\n\tf()\nend", 1)]),
]
IDS = [repr(text[:30]) for text, _ in STREAMS]


@pytest.mark.parametrize(("text", "expected"), STREAMS, ids=IDS)
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_whole(text, expected, end):
    splitter = UnitSplitter()
    assert said(splitter.receive(text.replace("\n", end).encode())) == expected
    assert not splitter.pending


@pytest.mark.parametrize(("text", "expected"), STREAMS, ids=IDS)
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_byte_by_byte(text, expected, end):
    splitter = UnitSplitter()
    found = []
    for byte in text.replace("\n", end).encode():
        found += splitter.receive(bytes([byte]))
    assert said(found) == expected


@pytest.mark.parametrize(("text", "expected"), STREAMS, ids=IDS)
def test_with_bytes_of_the_next_unit_behind(text, expected):
    splitter = UnitSplitter()
    lines = text.count("\n")
    assert said(splitter.receive(text.encode() + b"halt()\nst")) == [*expected, (LINE, "halt()", lines + 1)]
    assert splitter.pending
    assert said(splitter.receive(b"op()\n")) == [(LINE, "stop()", lines + 2)]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("def a():\n  f()\nend", [(PROGRAM, "def a():\n  f()\nend", 1)]),
        ("def a():\n  f()\nend ;", [(PROGRAM, "def a():\n  f()\nend ;", 1)]),
        ("halt()", [(LINE, "halt()", 1)]),
        ("def a():\n  f((\nend\n", [(PROGRAM, "def a():\n  f((\nend", 1)]),
        ("def a():\n  f((\nend", [(PROGRAM, "def a():\n  f((\nend", 1)]),
        ("f(\n", [(LINE, "f(", 1)]),
        ("f([1,\n2])", [(LINE, "f([1,\n2])", 1)]),
        ("def a():\n  f()\nen", []),
        ("def a():\n  f()\n", []),
        ("def a():", []),
        ("movej([0.1", []),
        ("f([1,\n2", []),
        ("  ", []),
        ("", []),
    ],
)
def test_silence(text, expected):
    splitter = UnitSplitter()
    assert splitter.receive(text.encode()) == []
    assert said(splitter.silence()) == expected
    assert said(splitter.silence()) == []


def test_silence_looks_at_nothing_twice_but_the_line_that_is_not_whole(monkeypatch):
    scanned = []
    advance = units._LineTracker.advance
    monkeypatch.setattr(
        units._LineTracker, "advance", lambda tracker, line: (scanned.append(len(line)), advance(tracker, line))
    )
    splitter = UnitSplitter()
    splitter.receive(b"f(\n" + b"  [1, (2)],\n" * 1000)
    before = sum(scanned)
    for _ in range(100):
        splitter.receive(b"1")
        assert splitter.silence() == []
    assert sum(scanned) - before == sum(range(1, 101))
    splitter.receive(b")")
    (unit,) = splitter.silence()
    assert (unit.kind, unit.text.count("\n")) == (LINE, 1001)


def test_silence_does_not_end_a_very_long_line(monkeypatch):
    decoded = []
    monkeypatch.setattr(
        UnitSplitter, "_decode", lambda _splitter, row, peek=False: (decoded.append(len(row)), row.decode())[1]
    )
    text = b"f(" + b" " * (SILENT_LINE_MAX - 3) + b")"
    splitter = UnitSplitter()
    splitter.receive(text)
    assert said(splitter.silence()) == [(LINE, text.decode(), 1)]
    decoded.clear()
    splitter.receive(text + b" ")
    assert splitter.silence() == []
    assert decoded == []
    assert said(splitter.receive(b"\n")) == [(LINE, text.decode() + " ", 1)]


def test_what_silence_did_not_end_goes_on():
    splitter = UnitSplitter()
    found = splitter.receive(b"def a():\n  f(1") + splitter.silence()
    found += splitter.receive(b", 2)\n") + splitter.silence() + splitter.receive(b"end") + splitter.silence()
    assert said(found) == [(PROGRAM, "def a():\n  f(1, 2)\nend", 1)]
    assert splitter.receive(b"\n") == []


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("def a():\n  f()\nend", [(PROGRAM, "def a():\n  f()\nend", 1)]),
        ("halt()", [(LINE, "halt()", 1)]),
        ("def a():\n  half()\n  movej(q)", [("E102", 1)]),
        ("def a():\n  half()\n", [("E102", 1)]),
        ("x()\ndef a():", [(LINE, "x()", 1), ("E102", 2)]),
        ("f(\n", [(LINE, "f(", 1)]),
        ("", []),
        ("# note", []),
    ],
)
def test_close(text, expected):
    splitter = UnitSplitter()
    assert said(splitter.receive(text.encode()) + splitter.close()) == expected
    assert not splitter.pending


def test_a_refusal_says_how_far_it_came():
    splitter = UnitSplitter()
    splitter.receive(b"def job():\n  half()\n")
    (refusal,) = splitter.close()
    (problem,) = refusal.problems
    assert (problem.line, problem.column, problem.end_column) == (1, 1, 11)
    assert "2 lines" in problem.text and "`end`" in problem.hint


def test_bytes_that_are_not_text_are_replaced_and_marked():
    splitter = UnitSplitter()
    bad, good = splitter.receive(b'textmsg("\xff\xfe")\nhalt()\n')
    assert (bad.text, bad.damaged) == ('textmsg("\ufffd\ufffd")', True)
    assert not good.damaged


def test_a_character_may_arrive_in_pieces():
    splitter = UnitSplitter()
    data = 'textmsg("温")\n'.encode()
    found = splitter.receive(data[:10]) + splitter.silence() + splitter.receive(data[10:])
    assert [(part.text, part.damaged) for part in found] == [('textmsg("温")', False)]


class TestLimits:
    def refused(self, data, size=None, limit=100):
        splitter = UnitSplitter(limit)
        found = []
        for start in range(0, len(data), size or len(data)):
            found += splitter.receive(data[start : start + (size or len(data))])
            assert len(splitter._partial) <= limit + (size or len(data))
            assert splitter._size <= limit
        return said(found + splitter.close())

    @pytest.mark.parametrize("size", [None, 1, 7])
    def test_a_program_that_does_not_end(self, size):
        data = b"def a():\n" + b"  f()\n" * 50 + b"end\nhalt()\n"
        assert self.refused(data, size) == [("E102", 1), (LINE, "halt()", 53)]

    @pytest.mark.parametrize("size", [None, 1, 7])
    def test_a_line_that_does_not_end(self, size):
        assert self.refused(b"x" * 500 + b"\nhalt()\n", size) == [("E102", 1), (LINE, "halt()", 2)]

    @pytest.mark.parametrize("size", [None, 1, 7])
    def test_the_tail_of_a_line_that_is_too_long_is_never_run(self, size):
        assert self.refused(b"x = '" + b"x" * 500 + b"';halt()", size) == [("E102", 1)]

    @pytest.mark.parametrize("size", [None, 1, 7])
    def test_a_new_program_behind_one_that_was_too_long(self, size):
        data = b"def a():\n" + b"  f()\n" * 50 + b"def b():\n  g()\nend\n"
        assert self.refused(data, size) == [("E102", 1), (PROGRAM, "def b():\n  g()\nend", 52)]

    def test_says_size_and_limit_once_when_the_end_shows_the_size(self):
        splitter = UnitSplitter(100)
        assert splitter.receive(b"def a():\n" + b"  f()\n" * 50) == []
        (refusal,) = splitter.receive(b"end\n")
        assert refusal.problems[0].text == "the text has 313 bytes without an end, at most 100 are read"
        assert splitter.close() == []

    def test_says_it_after_a_silence_too(self):
        splitter = UnitSplitter(100)
        splitter.receive(b"x" * 150)
        assert splitter.pending
        (refusal,) = splitter.silence()
        assert refusal.problems[0].text == "the text has 150 bytes without an end, at most 100 are read"
        assert not splitter.pending

    def test_the_limit_is_sixteen_megabytes(self):
        assert MAX_UNIT_BYTES == 16_000_000
        splitter = UnitSplitter()
        body = (b"  x = 1" + b" " * 1017) * ((MAX_UNIT_BYTES - 20) // 1024)
        (unit,) = splitter.receive(b"def a():\n" + body + b"\nend\n")
        assert isinstance(unit, Unit)
        (refusal,) = splitter.receive(b"def a():\n" + body + b" " * 1100 + b"\nend\n")
        assert isinstance(refusal, DiscardedText)


@settings(max_examples=200)
@given(st.binary(max_size=80), st.integers(0, 2**32))
def test_garbage_never_fails_and_pieces_make_no_difference(data, seed):
    whole = UnitSplitter(60)
    expected = said(whole.receive(data) + whole.close())
    rng = random.Random(seed)
    pieces = UnitSplitter(60)
    found = []
    position = 0
    while position < len(data):
        size = rng.randrange(1, 9)
        found += pieces.receive(data[position : position + size])
        position += size
    assert said(found + pieces.close()) == expected


class LineByLine(UnitSplitter):
    """Looks at each line closely."""

    __slots__ = ()

    def _takes_plainly(self, row: bytes) -> bool:
        return False


@settings(max_examples=300)
@given(st.lists(st.text("ab ([{}])'\"#\\=é", max_size=12), max_size=6))
def test_lines_that_are_taken_at_once_make_no_difference(lines):
    data = ("def a():\n" + "".join(f" {line}\n" for line in lines) + "end\nhalt()\n").encode()
    fast, slow = UnitSplitter(), LineByLine()
    assert said(fast.receive(data) + fast.close()) == said(slow.receive(data) + slow.close())


LINES = [
    "def a():",
    "sec b():",
    "end",
    "  f()",
    'x = """',
    "x = (",
    ")",
    "# c",
    "",
    "halt()",
    "'",
    "\\",
    "end # x",
    "  end",
]


@settings(max_examples=200)
@given(st.lists(st.sampled_from(LINES), max_size=15), st.integers(1, 5))
def test_programs_in_pieces_make_no_difference(lines, size):
    data = "\n".join(lines).encode()
    whole, pieces = UnitSplitter(40), UnitSplitter(40)
    expected = said(whole.receive(data) + whole.close())
    found = []
    for start in range(0, len(data), size):
        found += pieces.receive(data[start : start + size])
    assert said(found + pieces.close()) == expected


def test_refusals_and_units_are_values():
    assert Unit(LINE, "x", 1) == Unit(LINE, "x", 1)
    assert DiscardedText((), 1) == DiscardedText((), 1)


def test_a_line_that_is_not_complete_can_be_dropped():
    splitter = UnitSplitter()
    assert splitter.receive(b"f(1,\n2, \xff") == []
    assert splitter.drop_line() == "f(1,\n2, \ufffd"
    assert not splitter.pending
    assert said(splitter.receive(b"halt()\n")) == [(LINE, "halt()", 2)]


def test_a_program_that_is_not_complete_is_not_dropped():
    splitter = UnitSplitter()
    splitter.receive(b"def a():\n  f(")
    assert splitter.drop_line() == ""
    assert said(splitter.receive(b")\nend\n")) == [(PROGRAM, "def a():\n  f()\nend", 1)]
