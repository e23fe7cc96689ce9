"""Places in texts with every kind of line end, and what is computed once."""

from __future__ import annotations

import gc
from weakref import ref

import pytest

from elitescript.assist.document import Document
from elitescript.language.diagnostics import Edit, Outdated

TEXTS = ("", "a", "a\n", "a\r\nbé\r\n", "a\rb\r", "\ufeffa\n😀b", "\r\n\n\r", "a\n\rb", "\ufeff")


@pytest.mark.parametrize("text", TEXTS)
def test_every_offset_has_its_place(text: str) -> None:
    document = Document("c", text)
    for offset in range(len(text) + 1):
        line, column = document.place(offset)
        assert 1 <= line <= document.line_count
        assert 1 <= column <= len(document.line(line)) + 1
        is_inside_line_end = text[offset - 1 : offset + 1] == "\r\n" and offset > 0
        if not is_inside_line_end and not (offset == 0 and text.startswith("\ufeff")):
            assert document.offset(line, column) == offset


@pytest.mark.parametrize("text", TEXTS)
def test_the_number_of_lines_is_that_of_editors(text: str) -> None:
    document = Document("c", text)
    assert document.line_count == len(document.source.lines)
    assert [document.line(number) for number in (0, document.line_count + 1)] == ["", ""]


@pytest.mark.parametrize(
    ("text", "edits", "expected"),
    [
        ("a\r\nb", [Edit(1, 2, 2, 1, "")], "ab"),
        ("\ufeffa", [Edit(1, 1, 1, 1, "x")], "\ufeffxa"),
        ("a😀b", [Edit(1, 2, 1, 3, "é")], "aéb"),
        ("ab", [Edit(1, 1, 1, 2, ""), Edit(1, 1, 1, 2, "")], ""),
        ("a\nb", [Edit(9, 9, 9, 9, "c")], "a\nbc"),
        ("a\nb", [Edit(1, 9, 1, 9, "c")], "ac\nb"),
        ("a\nb", [Edit(2, 1, 1, 1, "c")], "a\ncb"),
        ("abc", [], "abc"),
    ],
)
def test_edits_are_made_one_after_the_other(text: str, edits: list[Edit], expected: str) -> None:
    after = Document("c", text, 1).edited(edits, 2)
    assert (after.text, after.version, after.name) == (expected, 2, "c")


def test_code_lines_hide_strings_and_comments() -> None:
    document = Document("c", "x = [  # a\r\n  'b c',\n  é]\r# d")
    assert [document.code_line(number) for number in range(6)] == ["", "x = [     ", '  """""' + ",", "  é]", "   ", ""]


def test_what_a_function_finds_is_kept() -> None:
    document = Document("c", "x = 1\n")
    calls = []

    def find(given: Document) -> int:
        calls.append(given)
        return len(calls)

    assert (document.once(find), document.once(find)) == (1, 1)
    assert Document("c", "x = 1\n").once(find) == 2


@pytest.mark.parametrize("step", ["translation", "parsed", "program"])
def test_findings_of_an_older_version_are_given_up_before_the_next_step(step):
    steps = ["translation", "parsed", "program"]
    document = Document("a.script", "def p():\n  x = nonsense\nend\n")
    for before in steps[: steps.index(step)]:
        getattr(document, before)
    document.is_outdated = True
    with pytest.raises(Outdated):
        _ = document.quick_problems
    assert step not in document.__dict__
    document.is_outdated = False
    assert [found.code for found in document.quick_problems] == ["W201"]


def test_what_was_found_can_be_let_go_and_found_again():
    document = Document("a.script", "def p():\n  def f(x):\n    return x\n  end\n  y = f(1) + nonsense\nend\n")
    found = document.problems, [found.span for found in document.names.occurrences]
    seen = ref(document.program.symbols)
    gc.disable()
    try:
        document.release()
        assert seen() is None
    finally:
        gc.enable()
    assert (document.problems, [found.span for found in document.names.occurrences]) == found
