from __future__ import annotations

import pytest

from tests.lint.checking import body, problems


@pytest.mark.parametrize("lines", [("sleep(500)",), ("PAUSE = 100", "sleep(PAUSE)"), ("sleep(t=3000)",)], ids=str)
def test_it_is_a_note(lines):
    (problem,) = problems("def job():\n" + "".join(f"  {line}\n" for line in lines) + "end\n")
    assert (problem.code, str(problem.severity)) == ("N226", "note")


def test_it_says_what_was_meant():
    (problem,) = problems("def job():\n  sleep(500)\nend\n")
    assert problem.text == "sleep: t is 500 s"
    assert problem.hint == "all times are in seconds: 500 ms are 0.5 s"


@pytest.mark.parametrize("lines", [("sleep(99)",), ("sleep(read_input_float_register(0))",)], ids=str)
def test_what_almost_is_one_is_not_found(lines):
    assert body(*lines) == []
