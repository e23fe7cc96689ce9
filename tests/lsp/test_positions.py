"""Places are converted exactly, in every encoding, and moved into the text."""

from __future__ import annotations

import random

import pytest
from lsprotocol.types import Position

from elitescript.assist.document import Document
from elitescript.language.diagnostics import Edit
from elitescript.lsp.positions import UTF8, UTF16, UTF32, Positions, chosen_encoding, units

TEXT = "a = 1\nb = '\u00e9\U0001f916x'\r\n\rlast"
"""é is two bytes and one unit; the robot is four bytes and two units."""


def positions(encoding: str, text: str = TEXT) -> Positions:
    return Positions(Document("a.script", text), encoding)


# (line, column) of a text, and (line, character) in UTF-16, UTF-8, UTF-32.
BY_HAND = [
    ((1, 1), (0, 0), (0, 0), (0, 0)),
    ((1, 6), (0, 5), (0, 5), (0, 5)),
    ((2, 6), (1, 5), (1, 5), (1, 5)),
    ((2, 7), (1, 6), (1, 7), (1, 6)),
    ((2, 8), (1, 8), (1, 11), (1, 7)),
    ((2, 10), (1, 10), (1, 13), (1, 9)),
    ((3, 1), (2, 0), (2, 0), (2, 0)),
    ((4, 5), (3, 4), (3, 4), (3, 4)),
]


@pytest.mark.parametrize(("place", "utf16", "utf8", "utf32"), BY_HAND)
def test_places_by_hand(place, utf16, utf8, utf32):
    for encoding, expected in ((UTF16, utf16), (UTF8, utf8), (UTF32, utf32)):
        assert positions(encoding).position(*place) == Position(*expected)
        assert positions(encoding).place(Position(*expected)) == place


@pytest.mark.parametrize(
    ("position", "place"),
    [
        ((1, 7), (2, 7)),  # between the halves of the robot: in front of it
        ((1, 99), (2, 10)),
        ((9, 0), (4, 5)),
        ((9, 7), (4, 5)),
    ],
)
def test_a_place_outside_is_moved_into_the_text(position, place):
    assert positions(UTF16).place(Position(*position)) == place


def test_a_byte_order_mark_is_a_character_of_the_client():
    converts = positions(UTF16, "\ufeffx = 1\n")
    assert converts.place(Position(0, 0)) == (1, 0)
    assert converts.place(Position(0, 1)) == (1, 1)
    assert converts.position(1, 1) == Position(0, 1)
    assert converts.position(1, 0) == Position(0, 0)
    assert converts.document.edited([Edit(1, 0, 1, 1, "")], 1).text == "x = 1\n"


@pytest.mark.parametrize(
    ("offered", "chosen"),
    [(None, UTF16), ([], UTF16), (["utf-8", "utf-16"], UTF8), (["utf-7", "utf-32"], UTF32), (["utf-7"], UTF16)],
)
def test_the_first_encoding_that_both_have_is_chosen(offered, chosen):
    assert chosen_encoding(offered) == chosen


@pytest.mark.parametrize("encoding", [UTF8, UTF16, UTF32])
def test_units_are_those_of_python_codecs(encoding):
    made = random.Random(5)
    width = {UTF8: 1, UTF16: 2, UTF32: 4}[encoding]
    for _ in range(200):
        text = "".join(made.choice("a\u00e9\u4e2d\U0001f916\ud800") for _ in range(made.randrange(8)))
        codec = {UTF8: "utf-8", UTF16: "utf-16-le", UTF32: "utf-32-le"}[encoding]
        expected = sum(len(character.encode(codec, "surrogatepass")) // width for character in text)
        assert units(text, encoding) == expected


@pytest.mark.parametrize(
    ("text", "end"), [("a\n", "\n"), ("a\r\nb\n", "\r\n"), ("a\rb", "\r"), ("a", "\n"), ("a\nb\r\n", "\n")]
)
def test_new_lines_end_as_those_of_the_text(text, end):
    assert positions(UTF16, text).with_line_ends("x\ny") == f"x{end}y"
