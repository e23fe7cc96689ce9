"""What `is_within_safety_limits` asks the machine, for each way of calling it."""

from __future__ import annotations

from typing import Any

import pytest

from elitescript.errors import ArgumentCountError
from elitescript.kinematics.transforms import compose, pose_from_transform, transform_from_pose
from tests.commands.conftest import Q_ACTUAL

INSIDE = [0.5, -1.2, 1.3, -1.6, -1.5, 0.2]
OUTSIDE = [1.5, -1.2, 1.3, -1.6, -1.5, 0.2]


def test_joints_are_asked_for_as_they_are(robot: Any, script: Any) -> None:
    assert script(f"is_within_safety_limits(q={INSIDE})") is True
    assert script(f"is_within_safety_limits(q={OUTSIDE}, ciPair=[1, 0, 0, 1])") is False
    assert robot.machine.tested == [(tuple(INSIDE), None), (tuple(OUTSIDE), (True, False, False, True))]


@pytest.mark.parametrize("near", ["", ", qNear=''", f", qnear={list(Q_ACTUAL)}"])
def test_a_pose_is_asked_for_by_the_joints_that_reach_it_with_the_active_tcp(
    robot: Any, script: Any, near: str
) -> None:
    robot.machine.tcp_offset = (0.01, 0.02, 0.1, 0.1, 0.2, 0.3)
    offset = transform_from_pose(robot.machine.tcp_offset)
    pose = pose_from_transform(compose(robot.machine.arm.forward(Q_ACTUAL), offset))
    assert script(f"is_within_safety_limits({list(pose)}{near})") is True
    ((q, pairs),) = robot.machine.tested
    assert q == pytest.approx(Q_ACTUAL)
    assert pairs is None


def test_a_pose_near_other_joints_is_another_solution(robot: Any, script: Any) -> None:
    pose = pose_from_transform(robot.machine.arm.forward(Q_ACTUAL))
    flipped = [Q_ACTUAL[0], Q_ACTUAL[1], Q_ACTUAL[2], Q_ACTUAL[3], Q_ACTUAL[4], Q_ACTUAL[5] - 6.0]
    script(f"is_within_safety_limits({list(pose)}, {flipped})")
    assert robot.machine.tested[0][0][5] == pytest.approx(Q_ACTUAL[5] - 6.283185307179586)


def test_a_pose_out_of_reach_is_outside_without_asking(robot: Any, script: Any) -> None:
    assert script("is_within_safety_limits([5, 0, 0, 0, 0, 0])") is False
    assert robot.machine.tested == []


@pytest.mark.parametrize("text", ["", "qNear=[0, 0, 0, 0, 0, 0]", "[1, 0, 0, 0, 0, 0], q=[0, 0, 0, 0, 0, 0]"])
def test_one_of_pose_and_joints_is_needed(script: Any, text: str) -> None:
    with pytest.raises(ArgumentCountError, match="needs a pose p or joint positions q"):
        script(f"is_within_safety_limits({text})")


@pytest.mark.parametrize("pairs", ["[1, 0, 0]", "[1, 0, 0, 2]"])
def test_pairs_are_four_zeros_or_ones(script: Any, pairs: str) -> None:
    with pytest.raises((TypeError, ValueError), match="ciPair"):
        script(f"is_within_safety_limits(q={INSIDE}, ciPair={pairs})")
