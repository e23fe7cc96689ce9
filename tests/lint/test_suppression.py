from __future__ import annotations

import pytest

from elitescript.language.diagnostics import diagnostic
from elitescript.lint.suppression import hiding
from tests.lint.checking import body, found


@pytest.mark.parametrize("comment", ["# check: ignore", "#check:ignore", "# why not  # check: ignore because"])
def test_a_comment_hides_everything_on_its_line(comment):
    assert body(f"textmsg(nothing)  {comment}", "textmsg(nothing)") == ["W201 3:11"]


def test_a_comment_with_codes_hides_these():
    assert body("sleep = nothing  # check: ignore[W203]") == ["W201 2:11"]
    assert body("sleep = nothing  # check: ignore[W201]") == ["W203 2:3"]
    assert body("sleep = nothing  # check: ignore[W201, W203]") == []
    assert body("sleep = nothing  # check: ignore[]") == []


def test_findings_against_the_catalogue_can_be_hidden():
    assert body("sleep('1')  # check: ignore[E304]") == []


def test_what_keeps_the_program_from_starting_cannot():
    assert body("x = = 1  # check: ignore") == ["E001 2:7"]
    assert body("if 1 <> 2: pass  # check: ignore[E111]") == ["E111 2:8"]


def test_a_warning_of_the_language_can():
    assert body("print 1  # check: ignore") == []


def test_a_text_in_a_string_is_no_comment():
    assert body("textmsg('# check: ignore', nothing)") == ["W201 2:30"]
    assert found("def job():\n  s = '''\n  # check: ignore''' + nothing\nend\n") == ["W201 3:24"]


def test_other_comments_hide_nothing():
    assert body("textmsg(nothing)  # check: this", "textmsg(nothing)  # ignore") == ["W201 2:11", "W201 3:11"]


@pytest.mark.parametrize(
    ("row", "masked", "expected"),
    [
        ("  x = y", "  x = y", "  x = y  # check: ignore[W201]"),
        ("  x = y   ", "  x = y   ", "  x = y  # check: ignore[W201]"),
        ("x # why", "x      ", "x # why  # check: ignore[W201]"),
        ("x # check: ignore[W203]", "x" + " " * 22, "x # check: ignore[W203, W201]"),
        ("x #check:ignore[ W203,E305 ] why", "x" + " " * 30, "x # check: ignore[W203, E305, W201] why"),
        ("'# check: ignore[W1]'", '"' * 21, "'# check: ignore[W1]'  # check: ignore[W201]"),
    ],
)
def test_the_comment_that_hides_a_problem(row, masked, expected):
    start, end, text = hiding(diagnostic("W201", 1, 1, "text"), row, masked)
    assert row[:start] + text + row[end:] == expected
