from __future__ import annotations

import pytest

from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.messages.profile import profile
from elitescript.models.model import load_model
from tests.lint.checking import body


def found(*lines, arm="CS66"):
    text = "def job():\n" + "".join(f"  {line}\n" for line in lines) + "end\n"
    problems = check_source(SourceFile("<test>", text), profile("2.14"), arm=load_model(arm))
    return [f"{problem.code} {problem.line}:{problem.column}" for problem in problems]


def test_joints_beyond_every_range_are_found_without_an_arm():
    assert body("movej([0, -1.57, 6.6, 0, 0, 0])") == ["W236 2:20"]
    assert body("try:", "  movej([0, -1.57, 6.6, 0, 0, 0])", "except Exception:", "  pass", "end") == []


@pytest.mark.parametrize(("arm", "expected"), [("CS66", ["W236 2:9"]), ("CS620", [])])
def test_the_reach_is_that_of_the_arm(arm, expected):
    assert found("movel([1.2, 0, 0.3, 3.14, 0, 0])", arm=arm) == expected


def test_without_an_arm_no_pose_is_out_of_reach():
    assert body("movel([1.2, 0, 0.3, 3.14, 0, 0])") == []


def test_the_tcp_of_the_program_counts():
    far = "movel([1.3, 0, 0.1625, 0, 1.5708, 0])"
    assert found(far) == ["W236 2:9"]
    assert found("set_tcp([0, 0, 0.5, 0, 0, 0])", far) == []
    assert found("set_tcp(get_tcp_offset())", far) == []


def test_a_joint_at_the_end_of_its_range_is_reached():
    assert found("movej([0, -1.57, 6.28, 0, 0, 0])") == []


@pytest.mark.parametrize(
    ("rest", "expected"), [("", ["W236 2:36"]), (", mode=0", ["W236 2:36"]), (", mode=1", []), (", mode=MODE", [])]
)
def test_the_end_of_an_arc_counts_if_its_orientation_does(rest, expected):
    arc = "movec([0.4, 0, 0.3, 3.14, 0, 0], [1.2, 0, 0.3, 3.14, 0, 0]" + rest + ")"
    assert [problem for problem in found(arc) if problem.startswith("W236")] == expected
    assert [problem for problem in found(arc.replace("1.2", "0.5")) if problem.startswith("W236")] == []


def test_the_first_reason_is_the_only_one():
    assert found("movel([1200, 0, 0.3, 3.14, 0, 0])") == ["W231 2:10"]
