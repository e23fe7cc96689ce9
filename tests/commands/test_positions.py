from __future__ import annotations

from typing import Any

import pytest


@pytest.mark.parametrize(
    ("name", "source"),
    [
        ("get_actual_joint_positions", ("joints", "q_actual")),
        ("get_actual_joint_speeds", ("joints", "qd_actual")),
        ("get_target_joint_positions", ("joints", "q_target")),
        ("get_target_joint_speeds", ("joints", "qd_target")),
        ("get_actual_tcp_pose", ("poses", "actual")),
        ("get_actual_tcp_speed", ("tcp_speeds", "actual")),
        ("get_target_tcp_pose", ("poses", "target")),
        ("get_target_tcp_speed", ("tcp_speeds", "target")),
        ("get_actual_tool_flange_pose", ("poses", "flange")),
    ],
)
def test_reading_is_a_list_of_what_the_machine_gives(call: Any, robot: Any, name: str, source: tuple[str, str]) -> None:
    robot.machine.tcp_offset = (0.0, 0.0, 0.1, 0.0, 0.0, 0.0)
    reading = call(name)
    assert type(reading) is list
    method, field = source
    assert reading == list(getattr(getattr(robot.machine, method)(), field))


def test_every_reading_is_a_new_list(call: Any) -> None:
    first = call("get_actual_joint_positions")
    first[0] = 99.0
    assert call("get_actual_joint_positions")[0] != 99.0


def test_temperatures(call: Any) -> None:
    assert call("get_joint_temperatures") == [31.0, 32.0, 33.0, 34.0, 35.0, 36.0]
    assert call("get_controller_temperature") == 41.5


def test_torques_are_those_of_the_machine(call: Any) -> None:
    assert call("get_joint_torques") == [0.1, -20.5, 8.25, 0.5, -0.25, 0.0]


def test_target_waypoint(call: Any) -> None:
    assert call("get_target_waypoint") == [0.4, 0.1, 0.3, 0.0, 1.0, 0.0]
