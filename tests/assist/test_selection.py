"""Selections that grow."""

from __future__ import annotations

import itertools

import pytest

from elitescript.assist.document import Document
from elitescript.assist.selection import selection_ranges
from elitescript.lint.program import Span
from tests.assist.reading import marked


def texts(document: Document, spans: tuple[Span, ...]) -> list[str]:
    return [
        document.text[document.offset(span.line, span.column) : document.offset(span.end_line, span.end_column)]
        for span in spans
    ]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("x = f(a + b¦c, 2)\n", ["bc", "a + bc", "f(a + bc, 2)", "x = f(a + bc, 2)"]),
        ("movej(q, a=1.4¦)\n", ["4", "1.4", "a=1.4", "movej(q, a=1.4)"]),
        ("textmsg('a b¦c')\n", ["bc", "a bc", "'a bc'", "textmsg('a bc')"]),
        ("x = 1  # on¦e two\n", ["one", "# one two", "x = 1  # one two"]),
        ("if a:\n  x¦ = 1\n  y = 2\nend\n", ["x", "x = 1", "x = 1\n  y = 2", "if a:\n  x = 1\n  y = 2\nend"]),
        ("x = (a¦b\n", ["ab", "x = (ab"]),
        ("", []),
    ],
)
def test_from_inside_out(text: str, expected: list[str]) -> None:
    document, line, column = marked(text)
    (spans,) = selection_ranges(document, [(line, column)])
    assert texts(document, spans) == [*expected, document.text]
    for inner, outer in itertools.pairwise(spans):
        assert outer[:2] <= inner[:2] <= inner[2:] <= outer[2:]
        assert inner != outer


def test_a_line_that_cannot_be_read_has_no_ranges_of_what_stands_for_it() -> None:
    document, line, column = marked("x = (\n¦= 1\ny = 2\n")
    (spans,) = selection_ranges(document, [(line, column)])
    assert texts(document, spans) == ["= 1", document.text]


def test_each_place_has_its_ranges() -> None:
    document = Document("cell.script", "a = 1\nb = 2\n")
    first, second, outside = selection_ranges(document, [(1, 1), (2, 1), (99, 99)])
    assert (texts(document, first)[0], texts(document, second)[0]) == ("a", "b")
    assert outside == (Span(1, 1, 3, 1),)
