"""Values of several kinds, refused in plain words."""

from __future__ import annotations

from typing import Any

import pytest

from elitescript.errors import ArgumentTypeError


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("freedrive_mode([1, 1, 1, 1, 1, 1], 'flange')", "frame must be one of 'base', 'tool', got 'flange'"),
        ("modbus_set_output_signal('s', 'on')", "digital_value must be bool or list"),
    ],
)
def test_values_of_several_kinds_are_refused_in_plain_words(script: Any, text: str, message: str) -> None:
    with pytest.raises(Exception, match=message):
        script(text)


def test_control_time_of_servoj_is_a_number(script: Any) -> None:
    with pytest.raises(ArgumentTypeError, match=r"^servoj: t must be a number, not str 'fast'"):
        script("servoj([0, 0, 0, 0, 0, 0], 'fast')")
