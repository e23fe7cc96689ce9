from __future__ import annotations

import re
from typing import Any

import pytest

from elitescript.errors import ArgumentRangeError
from elitescript.messages.machine import SetGravity, SetPayload, SetTcp


def test_settings_are_passed_on(call: Any, robot: Any) -> None:
    call("set_tcp", [0, 0, 0.12, 0, 0, 1.57])
    call("set_payload", 1.2, [0, 0.01, 0.05])
    call("set_payload", 1.2, CoG=[0, 0.01, 0.05], inertia=[4, 5, 6, 0.3, 0.2, 0.1])
    call("set_gravity", [0, 0, 9.82])
    assert robot.asked == [
        SetTcp((0.0, 0.0, 0.12, 0.0, 0.0, 1.57)),
        SetPayload(1.2, (0.0, 0.01, 0.05), (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)),
        SetPayload(1.2, (0.0, 0.01, 0.05), (4.0, 5.0, 6.0, 0.3, 0.2, 0.1)),
        SetGravity((0.0, 0.0, 9.82)),
    ]


def test_defaults_arrive_as_floats(call: Any, robot: Any) -> None:
    call("set_payload", 1, [0, 0, 0])
    assert {type(value) for value in robot.asked[0].inertia} == {float}


def test_what_is_set_can_be_read(call: Any, robot: Any) -> None:
    robot.machine.tcp_offset = (0.0, 0.0, 0.1, 0.0, 0.0, 0.5)
    assert call("get_tcp_offset") == [0.0, 0.0, 0.1, 0.0, 0.0, 0.5]
    assert call("get_target_payload_mass") == 1.5
    assert call("get_target_payload_cog") == [0.01, 0.02, 0.03]


def test_a_payload_above_the_nominal_load_is_refused_by_the_machine(call: Any, robot: Any) -> None:
    robot.refusal = ArgumentRangeError("m must be at most 6 kg, got 7.5", argument="m", value=7.5, unit="kg")
    with pytest.raises(ArgumentRangeError, match=r"^set_payload: m must be at most 6 kg, got 7.5"):
        call("set_payload", 7.5, [0, 0, 0])


@pytest.mark.parametrize(
    ("name", "arguments", "said"),
    [
        ("set_payload", (1, [0, 0, 0.1], [0.1, 0.1, 0.3, 0, 0, 0]), r"no body has the inertia \[0.1, 0.1, 0.3, "),
        ("set_gravity", ([0, 0, 1],), "d is 1 m/s\\^2 long"),
        ("set_gravity", ([0, 0, 0],), "d is 0 m/s\\^2 long"),
    ],
)
def test_what_cannot_be_is_taken_with_a_warning(call: Any, robot: Any, name: str, arguments: Any, said: str) -> None:
    call(name, *arguments)
    request, (kind, _key, text) = robot.asked
    assert isinstance(request, SetPayload | SetGravity)
    assert kind == "warn_once"
    assert re.search(said, text)


@pytest.mark.parametrize("d", [[0, 0, -9.82], [9.8, 0, 0], [0, -6.94, 6.94]])
def test_every_mounting_on_earth_is_taken_without_a_word(call: Any, robot: Any, d: list[float]) -> None:
    call("set_gravity", d)
    assert len(robot.asked) == 1
