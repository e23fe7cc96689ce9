from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ("set_tool_digital_io_config(1, 0, True, False)", "set_tool_digital(1, True)"),
        ("set_tool_digital_io_config(0, 0, False, True)", "set_tool_digital(0, True)"),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W255"]


@pytest.mark.parametrize(
    "lines",
    [
        ("set_tool_digital_io_config(1, 0, True, True)", "set_tool_digital(1, True)"),
        ("set_tool_digital_io_config(1, 0, True, False)", "set_tool_digital(0, True)"),
        (
            "set_tool_digital_io_config(1, 0, True, False)",
            "set_tool_digital_io_config(1, 0, True, True)",
            "set_tool_digital(1, True)",
        ),
        ("is_out = get_flag(0)", "set_tool_digital_io_config(1, 0, True, is_out)", "set_tool_digital(1, True)"),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W255" not in [problem.split()[0] for problem in body(*lines)]
