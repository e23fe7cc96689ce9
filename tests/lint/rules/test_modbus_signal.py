from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ('modbus_add_signal("10.0.0.5", 255, 0, 3, "s")', 'modbus_set_output_signal("s", True)'),
        ('modbus_add_signal("10.0.0.5", 255, 0, 1, "s")', 'modbus_set_output_register("s", 1)'),
        ('modbus_add_signal("10.0.0.5", 255, 0, 0, "s")', 'modbus_set_output_signal("s", True)'),
        ('modbus_add_signal("10.0.0.5", 255, 0, 2, "s")', 'modbus_set_output_register("s", 3)'),
        ('modbus_add_signal("10.0.0.5", 255, 0, 2, "s")', 'textmsg(modbus_get_signal_status("t"))'),
        ('modbus_add_signal("10.0.0.5", 255, 0, 3, "s")', 'modbus_set_signal_update_frequency("S", 10)'),
        ('modbus_add_rw_signal("10.0.0.5", 255, 0, 2, 8, 2, "s")', 'modbus_set_output_signal("s", True)'),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W249"]


@pytest.mark.parametrize(
    "lines",
    [
        ('modbus_add_signal("10.0.0.5", 255, 0, 3, "s")', 'modbus_set_output_register("s", 3)'),
        ('modbus_add_signal("10.0.0.5", 255, 0, 1, "s")', 'modbus_set_output_signal("s", True)'),
        ('modbus_set_output_signal("s", True)',),
        (
            "kind = read_input_integer_register(0)",
            'modbus_add_signal("10.0.0.5", 255, 0, kind, "s")',
            'modbus_set_output_signal("s", True)',
        ),
        (
            "for n in range(3):",
            '  modbus_add_signal("10.0.0.5", 255, n, 3, "s" + str(n))',
            "end",
            'modbus_set_output_register("t", 1)',
        ),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W249" not in [problem.split()[0] for problem in body(*lines)]
