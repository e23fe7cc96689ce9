from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ("set_standard_digital_out(True, 0)",),
        ("set_configurable_digital_out(False, 3)",),
        ("set_flag(True, 1)",),
        ("write_output_boolean_register(True, 3)",),
        ("on = get_standard_digital_in(0)", "set_standard_digital_out(on, 1)"),
        ("x = serial_read(False, 21, 0.5)",),
        ("SIZE = 9", "x = tool_serial_read(True, SIZE, 0.5)"),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W266"]


@pytest.mark.parametrize(
    "lines",
    [
        ("set_standard_digital_out(0, True)",),
        ("set_standard_digital_out(0, 1)",),
        ("set_standard_digital_out(True, True)",),
        ("n = 3", "set_flag(n, True)"),
        ("x = serial_read(21, False, 0.5)",),
        ("x = serial_read(True, 1, 0.5)",),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W266" not in [problem.split()[0] for problem in body(*lines)]
