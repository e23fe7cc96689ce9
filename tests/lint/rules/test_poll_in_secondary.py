from __future__ import annotations

import pytest

from tests.lint.checking import found, problems


@pytest.mark.parametrize(
    "call",
    [
        "socket_read_string('a', timeout=2)",
        "socket_read_byte_list(3, 'a', 2)",
        "socket_read_binary_integer(3, 'a', 2)",
        "socket_read_ascii_float(3, 'a', 2)",
        "tool_serial_read(3, True, 1)",
        "serial_read(3)",
        "tool_modbus_read_registers(1, 0, 1, 5)",
        "tool_modbus_read_registers(1, 0, 1, time_out=5)",
        "serial_modbus_read_registers(1, 0, 1, timeout=3)",
        "serial_modbus_read_registers(*[1, 0, 1])",
    ],
)
def test_a_reading_with_a_time_out_is_found_in_sec_alone(call):
    assert found(f"sec ask():\n  x = {call}\nend\n") == ["W221 2:7"]
    assert found(f"def ask():\n  x = {call}\nend\n") == []


def test_a_helper_inside_the_secondary_program_counts():
    text = "sec ask():\n  def read():\n    return socket_read_string('a')\n  x = read()\nend\n"
    assert found(text) == ["W221 3:12"]


@pytest.mark.parametrize("call", ["tool_modbus_read_registers(1, 0, 1)", "tool_modbus_write_single_bit(1, 0, 1)"])
def test_a_request_to_a_slave_without_a_time_out_waits(call):
    assert found(f"sec ask():\n  x = {call}\nend\n") == []


def test_what_does_not_wait_is_left_alone():
    assert found("sec ask():\n  socket_send_line('a')\n  x = get_flag(0)\nend\n") == []


def test_remote_procedures_are_refused_there():
    text = "sec ask():\n  box = rpc_factory('xmlrpc', 'http://127.0.0.1:9')\n  box.move(1)\nend\n"
    (problem,) = problems(text)
    assert (problem.code, problem.line) == ("W205", 3)
    assert "may not call remote procedures" in problem.text
