from __future__ import annotations

import random

from elitescript.language.options import DEFAULT
from elitescript.language.text.masked import lex
from elitescript.language.text.rewriting import Draft, Unfolding
from elitescript.language.text.source import SourceFile


def draft_of(text, unfolding=None):
    return Draft(SourceFile("f", text), lex(text), DEFAULT, unfolding)


def test_without_replacements_nothing_moves():
    text, positions = draft_of("a\nb").finish()
    assert text == "a\nb"
    assert positions.is_identity
    assert positions.to_source(2, 7) == (2, 7)


def test_replacements_of_equal_length_move_nothing():
    draft = draft_of("sec a():\n  f()")
    draft.replace(0, 3, "def")
    text, positions = draft.finish()
    assert text == "def a():\n  f()"
    assert positions.is_identity


def test_places_inside_new_text_lead_to_where_it_was_put():
    draft = draft_of("ab cd ef")
    draft.replace(3, 5, "LONGER")
    text, positions = draft.finish()
    assert text == "ab LONGER ef"
    columns = [positions.to_source(1, column)[1] for column in range(1, 13)]
    assert columns == [1, 2, 3, 4, 5, 6, 6, 6, 6, 6, 7, 8]
    assert not positions.moves(2)


def test_random_replacements_keep_the_rest_in_place():
    """Every character that was not replaced is found again at the author's place."""
    rng = random.Random(5)
    for _ in range(300):
        text = "".join(chr(0x4E00 + n) for n in range(40))
        draft = draft_of(text)
        cuts = sorted(rng.sample(range(40), 6))
        kept = set(range(40))
        for start, end in zip(cuts[::2], cuts[1::2], strict=True):
            draft.replace(start, end, "-" * rng.randrange(5))
            kept -= set(range(start, end))
        new, positions = draft.finish()
        for index in kept:
            at = new.index(text[index])
            assert positions.to_source(1, at + 1) == (1, index + 1)


def test_lines_of_an_unfolded_text_lead_to_the_single_line():
    draft = draft_of("if x:\n  a()", Unfolding(1, (0, 5)))
    _, positions = draft.finish()
    assert positions.to_source(1, 4) == (1, 4)
    assert positions.to_source(2, 3) == (1, 8)
    assert draft.place(8) == (1, 8)
