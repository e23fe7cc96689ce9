"""Values that are hardly meant, where only their range is known."""

from __future__ import annotations

import pytest

from elitescript.commands.definition.plausibility import JUDGES
from tests.lint.checking import body

LARGE = "z = 300\nif get_flag(0):\n  z = 400\nend"
"""A variable that is 300 or 400."""

OF_MEANING = {
    "joints": ("movej([z, 0, 0, 0, 0, 0])", "W230"),
    "pose": ("movel([0.3, 0.2, z, 3.14, 0, 0])", "W231"),
    "roll, pitch, yaw": ("textmsg(rpy2rotvec([z, 0, 0]))", "W230"),
    "tcp": ("set_tcp([0, 0, z, 0, 0, 0])", "W231"),
    "centre of gravity": ("set_payload(2, [0, 0, z])", "W231"),
    "joint speed": ("movej([0, 0, 0, 0, 0, 0], v=z)", "W232"),
    "joint speeds": ("speedj([z, 0, 0, 0, 0, 0], 1.0, 0.5)", "W232"),
    "joint acceleration": ("movej([0, 0, 0, 0, 0, 0], a=z)", "W232"),
    "tool speed": ("movel(get_actual_tcp_pose(), v=z)", "W232"),
    "tool velocity": ("speedl([z, 0, 0, 0, 0, 0], 1.0, 0.5)", "W232"),
    "tool acceleration": ("movel(get_actual_tcp_pose(), a=z)", "W232"),
    "blend radius": ("movel(get_actual_tcp_pose(), r=z)", "W231"),
    "payload": ("set_payload(z, [0, 0, 0])", "W233"),
    "fraction": ("set_standard_analog_out(0, z)", "W234"),
}


def codes(lines):
    return [found.partition(" ")[0] for found in body(*lines.split("\n"))]


@pytest.mark.parametrize("meaning", list(JUDGES))
def test_every_judge_judges_ranges(meaning):
    call, code = OF_MEANING[meaning]
    assert codes(f"{LARGE}\n{call}") == [code]


@pytest.mark.parametrize("meaning", list(JUDGES))
def test_a_range_with_one_value_that_may_be_meant_is_not_found(meaning):
    call, _ = OF_MEANING[meaning]
    assert codes(f"{LARGE.replace('400', '0.01')}\n{call}") == []
    assert codes(f"z = read_input_integer_register(3)\nif z > 0:\n  {call}\nend") == []


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        ("for d in range(20, 91):\n  movej([d, 0, 0, 0, 0, 0])\nend", ["W230"]),
        ("for d in range(-91, -20):\n  movej([d, 0, 0, 0, 0, 0])\nend", ["W230"]),
        # Of a range the round numbers say nothing: 7.3 rad may be the sum of turns.
        ("for d in range(7, 91):\n  movej([d, 0, 0, 0, 0, 0])\nend", []),
        ("for d in range(-91, 91):\n  movej([d, 0, 0, 0, 0, 0])\nend", []),
        ("n = read_input_integer_register(3)\nif n > 60:\n  set_payload(n, [0, 0, 0])\nend", ["W233"]),
        ("n = read_input_integer_register(3)\nif n < 0:\n  set_standard_analog_out(0, n)\nend", ["W234"]),
        ("def go(v):\n  movel(get_actual_tcp_pose(), v=v)\nend\ngo(250)\ngo(300)", ["W232"]),
        ("def go(v):\n  movel(get_actual_tcp_pose(), v=v)\nend\ngo(250)\ngo(0.3)", ["W232"]),
        (f"{LARGE}\np = get_actual_tcp_pose()\np[2] = z", ["W231"]),
    ],
)
def test_ranges(lines, expected):
    assert codes(lines) == expected
