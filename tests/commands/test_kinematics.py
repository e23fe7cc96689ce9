from __future__ import annotations

from math import pi
from typing import Any

import pytest

from elitescript.errors import MotionError
from elitescript.kinematics.pose import pose_trans

TOOL = [0.02, -0.01, 0.15, 0.1, 0.2, 0.3]


def test_inverse_of_forward_is_the_present_position(call: Any, robot: Any) -> None:
    assert call("get_inverse_kin", call("get_forward_kin")) == pytest.approx(robot.machine.joints().q_actual, abs=1e-9)


def test_the_active_tcp_counts_unless_another_is_given(call: Any, robot: Any) -> None:
    flange = call("get_forward_kin")
    robot.machine.tcp_offset = tuple(TOOL)
    assert call("get_forward_kin") == pytest.approx(pose_trans(flange, TOOL), abs=1e-12)
    assert call("get_forward_kin", tcp=[0] * 6) == pytest.approx(flange, abs=1e-12)
    assert call("get_inverse_kin", flange, tcp=[0, 0, 0, 0, 0, 0]) == pytest.approx(
        robot.machine.joints().q_actual, abs=1e-9
    )
    assert call("get_inverse_kin", pose_trans(flange, TOOL)) == pytest.approx(robot.machine.joints().q_actual, abs=1e-9)


@pytest.mark.parametrize("left_out", [None, "", "active tcp"])
def test_placeholders_stand_for_the_active_tcp(call: Any, robot: Any, left_out: Any) -> None:
    robot.machine.tcp_offset = tuple(TOOL)
    assert call("get_forward_kin", "", left_out) == call("get_forward_kin")


def test_documented_forward_and_inverse_examples(call: Any) -> None:
    # Computed for a CS66 without a tool; the manual prints no results.
    assert call("get_forward_kin", [-0.2, -1.6, -1.4, -1.5, 1.5, 0]) == pytest.approx(
        [0.471919, -0.252803, 0.575060, -2.928686, -0.069203, -1.785744], abs=6e-7
    )
    near = [-0.2, -1.6, -1.4, -1.5, 1.5, -1.6]
    solution = [-0.199328, -2.075305, -1.690364, -4.143027, 1.910605, -3.188032]
    assert call("get_inverse_kin", [0.4, -0.2, 0.4, -3.1, 2.8, -1.8], qnear=near) == pytest.approx(solution, abs=6e-7)
    assert call("get_inverse_kin", [0.4, -0.2, 0.4, -3.1, 2.8, -1.8], qNear=near) == pytest.approx(solution, abs=6e-7)


def test_full_turns_follow_qnear(call: Any, robot: Any) -> None:
    pose = call("get_forward_kin")
    near = list(robot.machine.joints().q_actual)
    near[5] += 2 * pi
    robot.machine.joint_ranges = ((-3 * pi, 3 * pi),) * 6
    assert call("get_inverse_kin", pose, near) == pytest.approx(near, abs=1e-9)


def test_unreachable_pose_is_an_alarm_with_reason(call: Any) -> None:
    with pytest.raises(
        MotionError, match=r"^get_inverse_kin: no joint position reaches the pose \[3, 0, 0\.4, 0, 0, 0\]"
    ):
        call("get_inverse_kin", [3, 0, 0.4, 0, 0, 0])
    assert call("get_inverse_kin_has_solution", [3, 0, 0.4, 0, 0, 0]) is False
    assert call("get_all_inverse_kin", [3, 0, 0.4, 0, 0, 0]) == []


def test_pose_outside_the_joint_limits_is_an_alarm_of_its_own(call: Any, robot: Any) -> None:
    pose = call("get_forward_kin")
    robot.machine.joint_ranges = ((-0.001, 0.001),) * 6
    with pytest.raises(MotionError, match="each of the 8 solutions has a joint outside its limits") as caught:
        call("get_inverse_kin", pose)
    assert caught.value.code == "R110"
    assert call("get_inverse_kin_has_solution", pose) is False
    assert len(call("get_all_inverse_kin", pose)) == 8


def test_documented_pose_has_a_solution(call: Any) -> None:
    assert call("get_inverse_kin_has_solution", [0.41951, -0.16, 0.25745, -3.11757, 0, -1.5708]) is True


def test_a_singular_wrist_keeps_its_last_joint_where_it_is(call: Any) -> None:
    pose = call("get_forward_kin", [0.3, -1.2, 1.3, -1.6, 0.0, 0.4])
    near = [0.3, -1.2, 1.3, -1.5, 0.0, 0.3]
    assert call("get_inverse_kin", pose, near)[5] == pytest.approx(0.3, abs=1e-9)
