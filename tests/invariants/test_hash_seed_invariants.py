"""Programs that cannot show the order of a set give the same bytes whatever seed Python's string hashing has."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.invariants.cases import CASES

pytestmark = pytest.mark.invariants

ROOT = Path(__file__).resolve().parent.parent.parent
COUNT = max(CASES, 20)
"""With fewer, programs with sets might do the same under two seeds by chance."""

MISTAKES = (
    "movej([0, -1.5, -1.5, -1.5, 1.5, 0], vv=1, aa=2)",
    "set_standard_digtal_out(1, True)",
    "textmsg(coutn)",
    "x = {'a': 1}['b']",
    "movel([9, 9, 9, 0, 0, 0], a=1, v=1)",
    "set_standard_digital_out(99, True)",
    "get_standard_digital_in(b=1, a=2)",
    "x = [].appendd(1)",
    "for k, v in {'one': 1, 'two': 2, 'three': 3}.items():\n    textmsg(k, v)\n  end",
    "x = dict(zip('abcdefgh', range(8)))\n  textmsg(x, sorted(x), list(x), x | {'z': 1})",
    "raise ValueError({'b': 2, 'a': 1})",
    "def f(*, a, b, c):\n    pass\n  end\n  f()",
    "import json\n  textmsg(json.dumps({'b': 1, 'a': [1, 2]}))",
    "textmsg({'one', 'two', 'three', 'four', 'five'})",
    "class A:\n    def __repr__(self):\n      return 'A'\n    end\n  end\n  textmsg([A()], A)",
)
"""Statements whose messages and values are made from names."""

CHILD = """
import sys
from hashlib import sha256
from random import Random
from elitescript import VirtualRobot
from elitescript.errors import ProgramError
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.messages.profile import PROFILES
from tests.invariants.random_programs import random_program
from tests.invariants.test_hash_seed_invariants import MISTAKES
from tests.language import random_programs as of_the_language

for seed in range(int(sys.argv[1])):
    random_ = Random(seed)
    for text in (
        random_program(random_),
        of_the_language.random_program(random_),
        "def p():\\n  " + "\\n  ".join(random_.sample(MISTAKES, 3)) + "\\nend\\n",
    ):
        found = check_source(SourceFile("p", text), PROFILES["2.14"])
        try:
            robot = VirtualRobot()
            unit = robot.compile(text)
            run = robot.run(unit, until_s=5.0)
            shows = unit.shows_hash_order
            left = run.events, run.globals, run.signals, run.state, run.time_s, run.threads
            assert run.is_reproducible is not shows
        except ProgramError as error:
            shows, left = False, error.problems
        print(shows, sha256(repr((found, left)).encode()).hexdigest())
"""


def outputs() -> list[list[str]]:
    """Return what two processes with different seeds print."""
    environment = {
        **os.environ,
        "PYTHONHASHSEED": "random",
        "PYTHONPATH": os.pathsep.join((str(ROOT / "src"), str(ROOT))),
    }
    command = [sys.executable, "-c", CHILD, str(COUNT)]
    started = [
        subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True) for _ in range(2)
    ]
    texts = [process.communicate()[0] for process in started]
    assert [process.returncode for process in started] == [0, 0]
    return [text.splitlines() for text in texts]


def test_programs_without_sets_give_the_same_under_every_seed() -> None:
    first, second = outputs()
    assert len(first) == 3 * COUNT
    cannot = [one for one in first if one.startswith("False")]
    assert len(cannot) > COUNT
    assert [one for one in second if one.startswith("False")] == cannot
    # Sets are among the programs, and the seeds differ.
    assert first != second
