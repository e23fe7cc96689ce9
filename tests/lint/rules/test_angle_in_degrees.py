from __future__ import annotations

from elitescript.language.text.source import apply_fixes
from tests.lint.checking import body, only, problems


def test_it_is_found():
    assert body("movej([0, -90, 90, 0, 90, 0])") == ["W230 2:13"]
    assert body("movej([r2d(1.5), 0, 0, 0, 0, 0])") == ["W230 2:10"]
    assert body("q = get_actual_joint_positions()", "a = r2d(q[0])", "textmsg(sin(a))") == ["W230 4:15"]
    assert body("a = d2r(90)", "textmsg(d2r(a))") == ["W230 3:15"]
    assert body("textmsg(cos(-90))", "textmsg(rpy2rotvec([180, 0, 90]))") == ["W230 2:15", "W230 3:23"]
    assert body("rx = 180", "movel([0.4, 0, 0.3, rx, 0, 0])") == ["W230 3:23"]


def test_what_almost_is_one_is_not_found():
    assert body("movej([0, d2r(-90), 6.28, 0, 1.57, 0])") == []
    assert body("a = r2d(0.5) * 3.14159 / 180", "textmsg(sin(a), sin(7), cos(12.3), rpy2rotvec([3.14, 0, 0]))") == []
    assert body("movel([0.4, 0, 0.3, 6.9, 9.42478, 0])") == []


def test_all_angles_of_the_list_are_converted_by_hand_only():
    text = "def job():\n  movej([0, -90, 45.5, 0, a, 0])\nend\n"
    fixed = "def job():\n  movej([0, d2r(-90), d2r(45.5), 0, a, 0])\nend\n"
    (problem,) = (problem for problem in problems(text) if problem.code == "W230")
    assert problem.fix is not None
    assert not problem.fix.safe
    assert apply_fixes(text, [problem.fix]) == fixed


def test_angles_are_converted_where_the_only_assignment_writes_them():
    text = "def job():\n  POSE = [400, 0, 0.3, 180, 0, 1.57]\n  movel(POSE)\nend\n"
    fixes = {problem.code: problem.fix for problem in problems(text)}
    assert apply_fixes(text, [fixes["W230"]]).split("\n")[1] == "  POSE = [400, 0, 0.3, d2r(180), 0, 1.57]"
    assert apply_fixes(text, [fixes["W231"]]).split("\n")[1] == "  POSE = [0.4, 0, 0.3, 180, 0, 1.57]"


def test_nothing_is_converted_that_is_computed_or_where_d2r_is_something_else():
    assert only("def job():\n  movej([0, 45 * 2, 0, 0, 0, 0])\nend\n").fix is None
    (*_, problem) = problems("def job():\n  d2r = 1\n  movej([d2r, 90, 0, 0, 0, 0])\nend\n")
    assert (problem.code, problem.fix) == ("W230", None)


def test_lengths_keep_their_digits():
    text = "def job():\n  movel([1234.56789, 0, 0.3, 0, 0, 0])\nend\n"
    (problem,) = (problem for problem in problems(text) if problem.code == "W231")
    assert "movel([1.23456789, 0," in apply_fixes(text, [problem.fix])
