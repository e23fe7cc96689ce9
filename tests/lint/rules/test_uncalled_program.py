from __future__ import annotations

import pytest

from tests.lint.checking import found, marked, only, problems, repaired

JOB = "def job():\n  sleep(1)\nend\n"


@pytest.mark.parametrize(
    "before",
    ["import math\n", "from math import pi\n", "SPEED = 0.5\n", "global n\nn = -1\n", "'text'\nx: float = 2.5 * 3\n"],
)
def test_a_program_beside_imports_and_constants_is_found_at_its_name(before):
    line = before.count("\n") + 1
    assert f"W214 {line}:5" in found(before + JOB)
    assert "W214 1:5" in found(JOB + before)


def test_the_name_is_underlined_and_the_hint_says_what_to_do():
    text = "import math\n" + JOB
    assert marked(text) == "job"
    assert only(text).text == "nothing calls `job`: beside other top-level lines a `def` is a function and does not run"
    assert only(text).hint == "put those lines into the `def`, which then runs by itself, or call job() at the end"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("def a():\n  sync()\nend\ndef b():\n  sync()\nend\n", "W214 4:5"),
        ("def b():\n  a()\nend\ndef a():\n  sync()\nend\n", "W214 1:5"),
        ("def a(x):\n  return x\nend\ndef b():\n  a(1)\nend\ndef c(y):\n  return y\nend\n", "W214 4:5"),
        ("import math\nHOME = [d2r(90), pose_inv([0, 0, 0, 0, 0, 0])]\n" + JOB, "W214 3:5"),
        ("import math\nx = get_flag(0)\n" + JOB, "W214 3:5"),
        ("import math\ndef area(r):\n  return math.pi * r * r\nend\n", "W214 2:5"),
        ("import math\ndef job():\n  job()\nend\n", "W214 2:5"),
        ("import math\ndef job(angle=d2r(90)):\n  sleep(1)\nend\n", "W214 2:5"),
        ("import math\nclass Box:\n  size = 3\n" + JOB, "W214 4:5"),
        ("# only a comment\n", "W214 1:1"),
    ],
)
def test_whatever_the_functions_are_nothing_runs(text, expected):
    assert found(text) == [expected]


def test_of_several_functions_the_one_that_nothing_calls_is_to_be_called():
    text = "def b():\n  a()\nend\ndef a():\n  sync()\nend\n"
    assert only(text).text == "nothing runs: the text only defines 2 functions (`b`, `a`), and no line calls one"
    assert only(text).hint == "call b() at the end, or put the other functions into the `def` of that one"
    assert repaired(text) == text[:-1] + "\nb()\n"


def test_of_several_that_nothing_calls_the_last_one_is_an_example():
    problem = only("def a():\n  sync()\nend\ndef b():\n  sync()\nend\n")
    assert (problem.line, problem.hint, problem.fix) == (4, "call what is to run at the end, as in b()", None)


def test_a_strict_check_takes_it_for_an_error():
    text = "def a():\n  sync()\nend\ndef b():\n  a()\nend\n"
    assert [problem.is_error for problem in problems(text)] == [False]
    assert [problem.is_error for problem in problems(text, strict=True)] == [True]


@pytest.mark.parametrize(
    "text",
    [
        JOB,
        "'text'\n" + JOB,
        "import math\n" + JOB + "job()\n",
        "import math\n" + JOB + "start_thread(job, ())\n",
        "import math\n" + JOB + "if get_flag(0):\n  sleep(1)\n",
        "def a():\n  sync()\nend\ndef b():\n  a()\nend\nb()\n",
        "import math\n" + JOB + "x = socket_open('10.0.0.1', 5000)\n",
        "import math\nclass Box:\n  sleep(1)\n" + JOB,
        "import math\nsec lamp():\n  textmsg(1)\nend\n",
        "import math\ndef job(ok=socket_open('10.0.0.1', 5000)):\n  sleep(1)\nend\n",
        "import math\n$ LINE: (1, 'a')\n" + JOB,
        "import math\n@staticmethod\n" + JOB,
        "import math\nx = 1\n",
    ],
)
def test_other_texts_are_left_alone(text):
    assert [finding for finding in found(text) if finding.startswith("W214")] == []


def test_a_program_with_defaults_counts():
    assert found("import math\ndef job(v=0.5, *, n=3):\n  sleep(v)\n  return\nend\n") == ["W214 2:5"]


def test_nothing_is_said_about_a_text_with_errors():
    assert found("import math\nx = = 1\n" + JOB) == ["E001 2:5"]
