"""Tests that are run again and again: what is read of their output, and what keeps the cores busy."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from tools.steady import Outcome, burners, on_one_core, outcome_of, summary, verdict

PASSED = "....\n4 passed in 0.31s\n"
FAILED = """..F.E
=================================== FAILURES ===================================
E       AssertionError: 4 failed in 1.0s
=========================== short test summary info ============================
FAILED tests/a/test_b.py::test_c[x - y] - assert 1 == 2
FAILED tests/a/test_b.py::test_d
ERROR tests/a/test_e.py::test_f - OSError: gone
2 failed, 2 passed, 1 error in 75.02s (0:01:15)
"""


def test_a_run_that_passed() -> None:
    outcome = outcome_of(PASSED, 0, 0.5, 0.25)
    assert outcome == Outcome((), "4 passed in 0.31s", 0, 0.5, 0.25)
    assert summary([outcome, outcome]) == "2 of 2 runs passed."
    assert verdict([outcome, outcome]) == 0


def test_the_tests_that_failed_are_named_the_most_frequent_first() -> None:
    failed = outcome_of(FAILED, 1, 80.0, 75.0)
    assert failed.line == "2 failed, 2 passed, 1 error in 75.02s (0:01:15)"
    assert [name.partition("::")[2] for name in failed.failed] == ["test_c[x - y]", "test_d", "test_f"]
    once = Outcome(("tests/a/test_e.py::test_f",), "1 failed in 1.00s", 1, 1.0, 1.0)
    assert summary([failed, once, outcome_of(PASSED, 0, 1.0, 1.0)]).splitlines()[1] == (
        "   2 of 3  tests/a/test_e.py::test_f"
    )
    assert verdict([failed, once]) == 1


@pytest.mark.parametrize("code", [2, 3, 4, 5])
def test_tests_that_could_not_be_run_are_no_success(code: int) -> None:
    assert verdict([outcome_of("", code, 1.0, 1.0)]) == 2
    assert outcome_of("", code, 1.0, 1.0).line == "no last line"


def test_no_runs_are_no_success() -> None:
    assert verdict([]) == 2


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="processes cannot be held to a core")
def test_a_process_is_held_to_one_core() -> None:
    call = on_one_core([sys.executable, "-S", "-c", "import os; print(len(os.sched_getaffinity(0)))"])
    assert subprocess.run(call, capture_output=True, text=True, check=True).stdout == "1\n"


def test_what_keeps_the_cores_busy_ends() -> None:
    with burners(2) as busy:
        assert [process.poll() for process in busy] == [None, None]
    assert all(process.poll() is not None for process in busy)
