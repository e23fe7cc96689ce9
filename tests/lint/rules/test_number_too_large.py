from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ('modbus_add_signal("10.0.0.5", 255, 0, 3, "s")', 'modbus_set_output_register("s", 70000)'),
        ('modbus_add_signal("10.0.0.5", 255, 0, 3, "s")', "n = 100000", 'modbus_set_output_register("s", n)'),
        ('modbus_add_signal("10.0.0.5", 255, 0, 3, "s")', 'modbus_set_output_register("s", -40000)'),
        ("socket_send_byte(300)",),
        ("set_standard_digital_out(0, 5)",),
        ("n = 2", "write_output_boolean_register(3, n)"),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W268"]


@pytest.mark.parametrize(
    "lines",
    [
        ('modbus_add_signal("10.0.0.5", 255, 0, 3, "s")', 'modbus_set_output_register("s", 65535)'),
        ('modbus_add_signal("10.0.0.5", 255, 0, 3, "s")', 'modbus_set_output_register("s", -5)'),
        (
            'modbus_add_signal("10.0.0.5", 255, 0, 3, "s")',
            'modbus_set_output_register("s", read_input_integer_register(0))',
        ),
        ("socket_send_byte(255)",),
        ("set_standard_digital_out(0, 1)", "set_standard_digital_out(1, 0)"),
        ("set_standard_digital_out(0, read_input_integer_register(0))",),
        ('socket_send_byte("a")',),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W268" not in [problem.split()[0] for problem in body(*lines)]
