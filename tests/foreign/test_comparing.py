"""How a program came out on the robot beside CPython, and the table of what is known."""

from __future__ import annotations

import pytest

from tests.foreign.comparing import IS_DIFFERENT, Cause, compare, settle
from tests.foreign.known import load_known
from tests.foreign.page import Result, table
from tests.foreign.running import Outcome, on_python, on_robot, run_all
from tests.foreign.slicing import Case

PASSED = Outcome("passed", notes=[["equal", "1", "1"]])


@pytest.mark.parametrize(
    ("python", "robot", "cause"),
    [
        (PASSED, PASSED, Cause.SAME),
        (PASSED, Outcome("passed", notes=[["equal", "1", "2"]]), Cause.VALUE),
        (PASSED, Outcome("passed", notes=[]), Cause.VALUE),
        (PASSED, Outcome("failed", "AssertionError", "1 != 2", 7, [["equal", "1", "1"]]), Cause.VALUE),
        (Outcome("failed", "AssertionError", "x", 7), Outcome("failed", "AssertionError", "x", 7), Cause.ALIKE),
        (Outcome("failed", "AssertionError", "x", 7), Outcome("failed", "AssertionError", "x", 8), Cause.VALUE),
        (Outcome("error", "KeyError", "x", 7), Outcome("error", "KeyError", "y", 7), Cause.WORDING),
        (Outcome("error", "KeyError", "x", 7), Outcome("error", "ValueError", "x", 7), Cause.VALUE),
        (PASSED, Outcome("error", "ImportError", "the module `gc` is not available", 3), Cause.POLICY),
        (PASSED, Outcome("error", "ScriptPermissionError", "whatever", 3), Cause.POLICY),
        (PASSED, Outcome("error", "NameError", "name 'compile' is not defined", 3), Cause.TEXTS),
        (
            PASSED,
            Outcome("error", "ImportError", "the module `gc` is not available", 3, [["equal", "1", "2"]]),
            Cause.VALUE,
        ),
        (PASSED, Outcome("refused", "E115", "the attribute `__dict__` is not available"), Cause.REFUSED),
        (PASSED, Outcome("refused", "E001", "something is missing"), Cause.SYNTAX),
        (Outcome("refused", "SyntaxError", "invalid"), Outcome("refused", "E001", "something"), Cause.ALIKE),
        (Outcome("passed"), Outcome("skipped"), Cause.POLICY),
        (
            Outcome("error", "AttributeError", "'X' object has no attribute 'y'", 7),
            Outcome("error", "AttributeError", "the module 'x' of the robot has no 'y'", 7),
            Cause.POLICY,
        ),
        (PASSED, Outcome("late"), Cause.STUCK),
        (Outcome("late"), Outcome("stuck"), Cause.ALIKE),
        (PASSED, Outcome("crash", "SIGSEGV"), Cause.OURS),
        (PASSED, Outcome("internal", "KeyError", "'x' (host.py:run)"), Cause.OURS),
        (
            Outcome("passed", notes=[["message", "'bad'"], ["is", "True", "<A object at 0x7f01>"]]),
            Outcome("passed", notes=[["message", "'bad value'"], ["is", "True", "<A object>"]]),
            Cause.WORDING,
        ),
        (
            Outcome("passed", notes=[["message", "'bad'"], ["equal", "1", "1"]]),
            Outcome("passed", notes=[["message", "'bad value'"], ["equal", "1", "2"]]),
            Cause.VALUE,
        ),
        (
            Outcome("passed", notes=[["is", "True", "<A object at 0x7f01>"]]),
            Outcome("passed", notes=[["is", "True", "<A object>"]]),
            Cause.SAME,
        ),
    ],
)
def test_the_cause_of_a_pair(python: Outcome, robot: Outcome, cause: Cause) -> None:
    assert compare(python, robot).cause == cause


def noted(*values: int) -> Outcome:
    return Outcome("passed", notes=[["equal", str(value), "1"] for value in values])


def test_what_varies_in_cpython_itself_hides_nothing_else() -> None:
    assert settle(noted(1, 7, 3), noted(1, 8, 3), noted(1, 9, 3)).cause == Cause.VARIES
    assert settle(noted(1, 7, 3), noted(1, 8, 4), noted(1, 9, 3)).cause == Cause.VALUE
    assert settle(noted(1, 7), noted(1, 8), noted(1, 7)).cause == Cause.VALUE
    assert settle(noted(1, 7), noted(1), noted(1, 7, 8)).cause == Cause.VARIES


def test_a_failure_over_a_value_that_varies_varies() -> None:
    slow, slower = (Outcome("failed", "AssertionError", f"{s} not less than 0.1", 7) for s in (0.3, 0.2))
    assert settle(slow, Outcome("passed"), slower).cause == Cause.VARIES
    assert settle(slow, Outcome("passed"), slow).cause == Cause.VALUE


PROGRAM = """global foreign_end, foreign_notes
foreign_notes = [["equal", repr(3), repr(1 + 2)]]
foreign_end = []
def fails():
    raise KeyError("x")
try:
    fails()
except KeyError as error:
    foreign_end.append(["error", type(error).__name__, str(error)])
    raise
"""


def test_both_sides_say_the_same_of_one_program() -> None:
    expected = Outcome("error", "KeyError", "'x'", 5, [["equal", "3", "3"]])
    assert on_python(PROGRAM) == expected
    assert on_robot(PROGRAM) == expected


def test_programs_that_do_not_compile_are_refused() -> None:
    assert on_python("x = (\n").end == "refused"
    assert (on_robot("x = (\n").end, on_robot("x = (\n").kind) == ("refused", "E001")
    assert on_robot("x = [].__class__.__bases__\n").kind == "E115"


def test_processes_that_die_and_those_that_fail_have_an_outcome(monkeypatch: pytest.MonkeyPatch) -> None:
    jobs = [
        (0, "python", PROGRAM),
        (1, "python", "import os\nos._exit(3)\n"),
        (2, "python", "import os\nos.kill(os.getpid(), 15)\n"),
    ]
    found = dict(run_all(jobs, 2))
    assert found[0].end == "error" and found[0].line == 5
    assert (found[1].end, found[1].kind) == ("crash", "")
    assert (found[2].end, found[2].kind) == ("crash", "SIGTERM")
    assert dict(run_all([(0, "python", "import time\ntime.sleep(60)\n")], 1, wall_s=0.1))[0].end == "late"


ROWS = """
[[known]]
tests = ["m.A.test_a", "m.B.test_a"]
kind = "value"
decided = true
reason = "a decision of the language"

[[known]]
tests = ["m.A.test_old"]
kind = "wording"
decided = false
python = ["3.12"]
reason = "another text of an error"
"""


def judged(*rows: tuple[str, Cause]) -> list[tuple[Case, object]]:
    from tests.foreign.comparing import Verdict

    return [(Case(name, "language", "x"), Verdict(cause, "shown")) for name, cause in rows]


def test_rows_that_hold_leave_nothing_to_say() -> None:
    known = load_known(ROWS, "3.11")
    result = Result.of(judged(("m.A.test_a", Cause.VALUE), ("m.B.test_a", Cause.VALUE), ("m.A.x", Cause.SAME)), known)
    assert result.is_known and list(result.lines()) == []
    assert "| language | 3 | 1 | 2 |" in table(result)


def test_a_difference_without_a_row_and_a_row_without_a_difference_are_told() -> None:
    known = load_known(ROWS, "3.11")
    result = Result.of(judged(("m.A.test_a", Cause.WORDING), ("m.B.test_a", Cause.VALUE), ("m.C.x", Cause.OURS)), known)
    assert not result.is_known
    assert list(result.lines()) == [
        "wording: m.A.test_a: shown",
        "mistake of ours: m.C.x: shown",
        "known.toml has m.A.test_a, which does not differ in that way",
    ]


def test_rows_of_tests_that_were_not_run_are_no_matter_in_a_part() -> None:
    known = load_known(ROWS, "3.11")
    part = judged(("m.A.test_a", Cause.VALUE))
    assert Result.of(part, known, is_whole=False).is_known
    assert list(Result.of(part, known).lines()) == ["known.toml has m.B.test_a, which does not differ in that way"]


def test_rows_may_hold_for_some_versions_only() -> None:
    assert [row.tests[0] for row in load_known(ROWS, "3.12")] == ["m.A.test_a", "m.A.test_old"]


@pytest.mark.parametrize(
    "row",
    [
        'tests = ["a"]\nkind = "value"\ndecided = true',
        'tests = []\nkind = "value"\ndecided = true\nreason = "because of this"',
        'tests = ["a"]\nkind = "mood"\ndecided = true\nreason = "because of this"',
        'tests = ["a"]\nkind = "value"\ndecided = true\nreason = "known"',
        'tests = ["m.A.test_a"]\nkind = "value"\ndecided = true\nreason = "because of this"',
    ],
)
def test_rows_without_a_reason_and_rows_that_are_there_twice_are_refused(row: str) -> None:
    with pytest.raises(ValueError, match="row"):
        load_known(f"{ROWS}\n[[known]]\n{row}\n", "3.11")


def test_the_table_of_this_version_can_be_read() -> None:
    for row in load_known():
        assert not row.reason[0].isupper() and not row.reason.endswith(".")


def test_what_needs_a_reason() -> None:
    assert {Cause.VALUE, Cause.WORDING, Cause.SYNTAX, Cause.STUCK, Cause.OURS} == IS_DIFFERENT
