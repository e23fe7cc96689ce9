from __future__ import annotations

import pytest

from elitescript.lint.rules.misspelt_variable import Spellings
from tests.lint.checking import body, only, repaired

LOOP = ("counter = 0", "while counter < 3:", "  conuter = counter + 1", "  sleep(0.5)", "end")


def test_a_variable_that_nothing_reads_beside_another():
    assert "W223 4:5" in body(*LOOP)


@pytest.mark.parametrize(
    "lines",
    [
        ("global level", "lveel = 0.0", "level = get_standard_analog_in(0)"),
        ("speed = 0.1", "Speed = 0.2", "movel(get_actual_tcp_pose(), v=speed)"),
        ("def go(speed):", "  sped = 0.2", "  movel(get_actual_tcp_pose(), v=speed)", "end", "go(0.1)"),
    ],
    ids=str,
)
def test_globals_parameters_and_capitals(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W223"]


def test_the_repair_writes_the_other_name():
    text = "def job():\n  global level\n  {} = 0.0\n  level = get_standard_analog_in(0)\nend\n"
    assert only(text.format("lveel")).hint == "is `level` meant?"
    assert repaired(text.format("lveel")) == text.format("level")


@pytest.mark.parametrize(
    "lines",
    [
        ("part = 0", "for parts in [1, 2]:", "  textmsg(parts)", "end"),
        ("left = 1", "lift = 2", "textmsg(lift)"),
        ("class Part:", "  pass", "end", "part = Part()"),
        ("def count():", "  return 1", "end", "counnt = count()"),
        ("pose1 = 1", "pose2 = 2", "textmsg(pose2)"),
        ("count = 0", "cuont = 1", "textmsg(count + cuont)"),
        ("count = 0", "cuont = 1", "textmsg(count)", "textmsg(eval('1'))"),
        ("for cuont in [1, 2]:", "  count = 3", "  textmsg(count)", "end"),
        ("def w():", "  return cuont", "end", "count = 0", "cuont = 1", "textmsg(count, w())"),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W223" not in [problem.split()[0] for problem in body(*lines)]


@pytest.mark.parametrize(
    ("one", "other", "slip"),
    [
        ("count", "cuont", True),
        ("waited", "waitd", True),
        ("waited", "waitted", True),
        ("Count", "count", True),
        ("count", "count", False),
        ("count", "mount", False),
        ("part", "parts", False),
        ("place", "placed", False),
        ("pose", "pose1", False),
        ("count", "conutr", False),
    ],
)
def test_which_names_are_slips_of_each_other(one, other, slip):
    assert (Spellings([other]).nearest(one) == other) is (Spellings([one]).nearest(other) == one) is slip
