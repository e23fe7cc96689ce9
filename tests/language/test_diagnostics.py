from __future__ import annotations

import json

import pytest

from elitescript.errors import CODES, ProgramError
from elitescript.language.diagnostics import (
    Edit,
    Fix,
    Severity,
    diagnostic,
    in_order,
    render,
    to_json,
)
from elitescript.language.text.source import SourceFile, apply_fixes


@pytest.mark.parametrize("code", ["E104", "W210", "E301"])
def test_severity_comes_from_the_table_of_codes(code):
    assert diagnostic(code, 1, 1, "text").severity == CODES[code].severity


def test_severity_can_be_overridden():
    assert diagnostic("E106", 1, 1, "text", severity=Severity.WARNING).severity is Severity.WARNING
    assert not diagnostic("E106", 1, 1, "text", severity=Severity.WARNING).is_error


def test_an_unknown_code_is_our_mistake():
    with pytest.raises(KeyError):
        diagnostic("E999", 1, 1, "text")


def test_without_an_end_it_covers_one_character():
    found = diagnostic("E001", 3, 5, "text")
    assert (found.end_line, found.end_column) == (3, 6)


def test_rendering_shows_place_line_caret_and_hint():
    source = SourceFile("pick.script", "def a():\n  while True:\n  end\nend\n")
    found = diagnostic("E104", 2, 3, "the body is empty", end_column=14, hint="write `pass`")
    assert render(found, source.where(found.line, found.column), source.line(found.line)).split("\n") == [
        "pick.script:2:3: error E104: the body is empty",
        "      while True:",
        "      ^^^^^^^^^^^",
        "hint: write `pass`",
    ]


@pytest.mark.parametrize(
    ("line", "column", "end_column", "carets"),
    [
        ("\tx = 012", 6, 9, "\t    ^^^"),
        ("温度 = 012", 6, 9, "       ^^^"),
        ('f("温度")', 3, 7, "  ^^^^^^"),
        ("abc", 4, 5, "   ^"),
    ],
)
def test_the_caret_stands_under_the_text_in_a_terminal(line, column, end_column, carets):
    found = diagnostic("E001", 1, column, "text", end_column=end_column)
    assert render(found, "f", line).split("\n")[2] == "    " + carets


def test_a_finding_over_several_lines_is_marked_up_to_the_end_of_the_first():
    found = diagnostic("E001", 1, 3, "text", end_line=2, end_column=2)
    assert render(found, "f", "abcde").split("\n")[2] == "      ^^^"


def test_a_finding_at_the_end_of_the_text_shows_no_empty_line():
    assert render(diagnostic("E001", 2, 1, "text"), "f:2:1", "") == "f:2:1: error E001: text"


def test_json_is_the_problem_object_of_the_command_line():
    found = diagnostic("E106", 3, 5, "text", hint="hint", severity=Severity.WARNING)
    assert json.loads(json.dumps(to_json(found))) == {
        "type": "problem",
        "severity": "warning",
        "code": "E106",
        "line": 3,
        "column": 5,
        "text": "text",
        "hint": "hint",
        "template": "text",
        "values": {},
        "hint_template": "hint",
        "hint_values": {},
    }


def test_order_is_that_of_the_text_errors_first():
    warning = diagnostic("W210", 2, 1, "w")
    error = diagnostic("E001", 2, 1, "e")
    early = diagnostic("E001", 1, 9, "first")
    assert in_order([warning, error, early]) == (early, error, warning)


def test_edits_are_applied_from_the_end_so_that_places_stay_true():
    fix = Fix("t", (Edit(1, 1, 1, 2, "long text"), Edit(1, 5, 2, 2, "!"), Edit(2, 3, 2, 3, "?")), safe=True)
    assert apply_fixes("a bcde\nfgh", [fix]) == "long text bc!g?h"


def test_a_fix_may_reach_behind_the_last_line():
    assert apply_fixes("a\r\nb", [Fix("drop", (Edit(2, 1, 3, 1, ""),), safe=True)]) == "a\r\n"


def test_program_errors_read_well():
    assert str(ProgramError((diagnostic("E104", 2, 3, "empty"),))) == "line 2, column 3: error E104: empty"
