from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ("tool_serial_config(True, 115200, 0, 1)", "textmsg(tool_modbus_read_registers(1, 0, 2))"),
        ("tool_serial_config(True, 115200, 0, 1, modbus_rtu=True)", "textmsg(serial_modbus_read_registers(1, 0, 2))"),
        ("serial_config(True, 9600, 0, 1, 8, False)", "textmsg(serial_modbus_write_single_bit(1, 0, 1))"),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W253"]


@pytest.mark.parametrize(
    "lines",
    [
        ("serial_config(True, 9600, 0, 1, modbus_rtu=True)", "textmsg(serial_modbus_read_registers(1, 0, 2))"),
        ("tool_serial_config(True, 115200, 0, 1, 8, True)", "textmsg(tool_modbus_read_registers(1, 0, 2))"),
        ("textmsg(tool_modbus_read_registers(1, 0, 2))",),
        (
            "is_rtu = get_flag(0)",
            "serial_config(True, 9600, 0, 1, 8, is_rtu)",
            "textmsg(serial_modbus_read_registers(1, 0, 2))",
        ),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W253" not in [problem.split()[0] for problem in body(*lines)]
