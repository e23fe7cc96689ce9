from __future__ import annotations

import pytest

from tests.lint.checking import found, marked, only

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
    "text",
    [
        JOB,
        "'text'\n" + JOB,
        "import math\n" + JOB + "job()\n",
        "import math\n" + JOB + "start_thread(job, ())\n",
        "import math\n" + JOB + "if get_flag(0):\n  sleep(1)\n",
        "import math\n" + JOB + "x = get_flag(0)\n",
        "import math\n" + JOB + "def other():\n  sleep(1)\nend\n",
        "import math\n" + JOB + "class Box:\n  pass\n",
        "import math\ndef area(r):\n  return math.pi * r * r\nend\n",
        "import math\ndef area(*, r):\n  return math.pi * r * r\nend\n",
        "import math\nsec lamp():\n  textmsg(1)\nend\n",
        "import math\ndef job():\n  job()\nend\n",
        "import math\ndef job(angle=d2r(90)):\n  sleep(1)\nend\n",
        "import math\ndef area():\n  return math.pi\nend\n",
        "import math\ndef numbers():\n  yield 1\nend\n",
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
