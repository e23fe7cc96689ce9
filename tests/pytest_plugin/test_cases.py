"""Cases of sweeps are collected, fail with their story, and pass once the property holds."""

from __future__ import annotations

import pytest

from elitescript.pytest_plugin.file_names import CASE_FILES
from elitescript.sweep.failures.cases import FILE_NAME, SUFFIX

PROGRAM = "def p():\n  set_standard_digital_out(1, True)\n  sleep(2)\n  set_standard_digital_out(1, False)\nend\n"
CASE = """
program = "../cell.script"
[[stop]]
kind = "protective_stop"
at_s = 1.0
[expect]
property = "no_output_left_on"
state = "alarm"
line = 2
"""


def test_a_case_is_a_test(pytester: pytest.Pytester) -> None:
    pytester.makefile(".script", cell=PROGRAM)
    folder = pytester.mkdir("cases")
    (folder / "left_on.case.toml").write_text(CASE, encoding="utf-8")
    result = pytester.runpytest_inprocess("-p", "elitescript.pytest_plugin.plugin")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(
        [
            "*1.000 s  the safety system stopped the arm",
            "*2  set_standard_digital_out(1, True)",
            "E   the failure came again: no_output_left_on does not hold",
        ]
    )
    tied = PROGRAM.replace("def p():\n", "def p():\n  set_runstate_standard_digital_output_to_value(1, 1)\n")
    pytester.makefile(".script", cell=tied)
    pytester.runpytest_inprocess("-p", "elitescript.pytest_plugin.plugin").assert_outcomes(passed=1)


def test_a_case_that_makes_no_sense_says_where(pytester: pytest.Pytester) -> None:
    pytester.makefile(".toml", CASE="program = 'none.script'\n[expect]\nproprety = 'x'\n")
    result = pytester.runpytest_inprocess("-p", "elitescript.pytest_plugin.plugin")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*CASE.toml:3: expect.proprety: is not known*"])


def test_the_names_are_those_of_sweeps() -> None:
    assert (FILE_NAME, f"*{SUFFIX}") == CASE_FILES
