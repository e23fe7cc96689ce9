from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        (
            "for i in range(5):",
            '  modbus_add_signal("10.0.0.5", 255, 0, 2, "s")',
            '  textmsg(modbus_get_signal_status("s"))',
            "  sleep(0.5)",
            "end",
        ),
        (
            "while True:",
            '  modbus_add_signal("10.0.0.5", 255, 0, 0, "s")',
            '  if modbus_get_signal_status("s"):',
            "    break",
            "  end",
            "  sync()",
            "end",
        ),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W251"]


@pytest.mark.parametrize(
    "lines",
    [
        (
            'modbus_add_signal("10.0.0.5", 255, 0, 2, "s")',
            "while True:",
            '  textmsg(modbus_get_signal_status("s"))',
            "  sleep(0.5)",
            "end",
        ),
        (
            "while True:",
            '  modbus_add_signal("10.0.0.5", 255, 0, 2, "s")',
            "  sleep(1)",
            '  textmsg(modbus_get_signal_status("s"))',
            "end",
        ),
        (
            "while True:",
            '  modbus_add_signal("10.0.0.5", 255, 0, 2, "s")',
            '  textmsg(modbus_get_signal_status("s"))',
            '  modbus_delete_signal("s")',
            "  sleep(1)",
            "end",
        ),
        (
            "for i in range(2):",
            '  modbus_add_signal("10.0.0.5", 255, 0, 2, "s")',
            "end",
            'textmsg(modbus_get_signal_status("s"))',
        ),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W251" not in [problem.split()[0] for problem in body(*lines)]
