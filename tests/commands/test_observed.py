from __future__ import annotations

from math import pi
from typing import Any

import pytest

from elitescript.errors import ArgumentRangeError, InvalidValueError
from elitescript.messages.machine import SetOption
from elitescript.messages.motion import MoveP

P = [0.4, -0.2, 0.4, 3.14, 0.0, 0.0]


def test_preamble_of_generated_programs_is_accepted(call: Any, robot: Any) -> None:
    call("set_safety_mode_transition_hardness", 1)
    call("set_tool_digital_io_work_mode", 0)
    call("labelmsg", 12, "MoveJ")
    assert robot.asked == [
        SetOption("safety_mode_transition_hardness", 1),
        SetOption("tool_digital_io_work_mode", 0),
        ("mark", 12, "MoveJ"),
    ]


def test_settings_of_collision_detection_are_stored(call: Any, robot: Any) -> None:
    call("set_collision_detect_enabled", 1)
    call("set_dyn_collision_force_min_ratio", 50)
    call("set_dyn_collision_force_min_ratio", 0.1)
    assert robot.asked == [
        SetOption("collision_detect_enabled", True),
        SetOption("dyn_collision_force_min_ratio", 50.0),
        SetOption("dyn_collision_force_min_ratio", 0.1),
    ]
    with pytest.raises(ArgumentRangeError):
        call("set_dyn_collision_force_min_ratio", 101)


def test_movep_is_a_line_of_a_chain(call: Any, robot: Any) -> None:
    call("movep", P, 1.2, 0.006, 0.001)
    assert robot.asked == [MoveP(tuple(P), 1.2, 0.006, 0.001)]


def test_frame_through_three_points(call: Any) -> None:
    frame = call("cal_rpy_frame", [1, 2, 3], [1, 5, 3, 9, 9, 9], [0, 2, 3])
    assert frame == pytest.approx([1, 2, 3, 0, 0, pi / 2])


def test_frame_needs_three_points_that_are_not_on_one_line(call: Any) -> None:
    cases = [
        ("origin", [[0, 0], [1, 0, 0], [0, 1, 0]]),
        ("x_axis", [[0, 0, 0], [0, 0, 0], [0, 1, 0]]),
        ("y_axis", [[0, 0, 0], [1, 0, 0], [2, 0, 0]]),
        ("y_axis", [[0, 0, 0], [1, 0, 0], [2, 0, 0, 0, 0]]),
    ]
    for argument, points in cases:
        with pytest.raises(InvalidValueError, match=r"^cal_rpy_frame: ") as caught:
            call("cal_rpy_frame", *points)
        assert caught.value.argument == argument


def test_pose_along_path_is_the_one_without_the_path_offset(call: Any) -> None:
    assert call("get_target_tcp_pose_along_path") == [0.4, 0.1, 0.2, 3.0, 0.0, 0.0]


def test_a_thread_that_is_pinned_goes_on(call: Any, robot: Any) -> None:
    call("pin_thread", cpu=1, prio=80, lockmem=1)  # as a control program of the vendor calls it
    call("pin_thread", 2, 80, True)
    call("pin_thread")
    assert robot.asked == [SetOption("pin_thread", core) for core in (1, 2, 0)]


def test_serial_ports_that_are_open(call: Any) -> None:
    assert call("serial_open_list") == ["/dev/ttymxc0", "tool"]
