"""What the commands of path offsets ask of the robot."""

from typing import Any

import pytest

from elitescript.errors import ArgumentRangeError, ScriptError
from elitescript.messages.path_offset import (
    EnablePathOffset,
    FilterPathOffset,
    LimitPathOffset,
    OffsetFrame,
    SetPathOffset,
)


@pytest.mark.parametrize(
    ("text", "request_"),
    [
        ("path_offset_enable()", EnablePathOffset()),
        (
            "path_offset_set([0.001, 0, 0.01, 0, 0, 0.1], 1)",
            SetPathOffset((0.001, 0, 0.01, 0, 0, 0.1), OffsetFrame.BASE),
        ),
        ("path_offset_set([0, 0, 0.01, 0, 0, 0], 2)", SetPathOffset((0, 0, 0.01, 0, 0, 0), OffsetFrame.TCP)),
        ("path_offset_set(offset=[0] * 6, type=3)", SetPathOffset((0,) * 6, OffsetFrame.MOTION)),
        ("path_offset_set_max_offset(0.02, 1.0)", LimitPathOffset(0.02, 1.0)),
        ("path_offset_set_max_offset(a=0.02, b=1)", LimitPathOffset(0.02, 1.0)),
        ("path_offset_set_alpha_filter(0.1)", FilterPathOffset(0.1)),
        ("path_offset_set_alpha_filter(a=1)", FilterPathOffset(1.0)),
    ],
)
def test_calls_become_requests(script: Any, robot: Any, text: str, request_: object) -> None:
    script(text)
    assert robot.asked == [request_]


def test_the_applied_offset_is_a_list_of_its_own(call: Any) -> None:
    # Generated programs compare it with [0] * 6 and change its elements.
    assert call("path_offset_get", 2) == [0.002, 0.0, 0.0, 0.0, 0.0, 0.0]
    assert call("path_offset_get", 2) is not call("path_offset_get", 2)


@pytest.mark.parametrize(
    "text",
    [
        "path_offset_set([0, 0, 0, 0, 0, 0], 0)",
        "path_offset_set([0, 0, 0, 0, 0, 0], 4)",
        "path_offset_set([0, 0, 0], 1)",
        "path_offset_get(0)",
        "path_offset_set_max_offset(-0.01, 0.1)",
        "path_offset_set_alpha_filter(0)",
        "path_offset_set_alpha_filter(1.01)",
    ],
)
def test_values_out_of_range_are_refused(script: Any, robot: Any, text: str) -> None:
    with pytest.raises((ArgumentRangeError, ScriptError)):
        script(text)
    assert robot.asked == []
