from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ("track_conveyor_linear([1, 0, 0, 0, 0, 0], 10000)",),
        ("encoder_enable_set_tick_count(0, 0)", "track_conveyor_linear([1, 0, 0, 0, 0, 0], 10000, 1)"),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["N221"]


@pytest.mark.parametrize(
    "lines",
    [
        ("encoder_enable_set_tick_count(0, 0)", "track_conveyor_linear([1, 0, 0, 0, 0, 0], 10000)"),
        ("encoder_enable_pulse_decode(1, 1, 16, 17)", "track_conveyor_linear([1, 0, 0, 0, 0, 0], 10000, 1)"),
        (
            "n = read_input_integer_register(0)",
            "encoder_enable_set_tick_count(n, 0)",
            "track_conveyor_linear([1, 0, 0, 0, 0, 0], 10000)",
        ),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "N221" not in [problem.split()[0] for problem in body(*lines)]


def test_a_command_that_the_firmware_lacks_is_told_alone():
    lines = ("encoder_enable_pulse_decode(0, 1, 16, 17)", "track_conveyor_linear([1, 0, 0, 0, 0, 0], 10000)")
    assert body(*lines, firmware="2.10") == ["E302 2:3"]
