"""Which commands only give a value: a list by hand, as a mistake there makes false alarms."""

from __future__ import annotations

import pytest

from elitescript.commands.catalogue import CATALOGUE


@pytest.mark.parametrize(
    "name",
    [
        "get_actual_tcp_pose",
        "get_flag",
        "get_inverse_kin",
        "get_list_length",
        "is_within_safety_limits",
        "read_port_register",
        "pose_trans",
        "interpolate_pose",
        "d2r",
        "norm",
        "str_cat",
        "to_num",
        "bit_list_to_integer",
        "modbus_get_signal_status",
        "socket_is_connected",
        "controller_timestamp",
    ],
)
def test_reading_and_computing_commands_only_give_a_value(name):
    assert CATALOGUE.get(name).only_gives_a_value


@pytest.mark.parametrize(
    "name",
    [
        "movej",
        "set_flag",
        "socket_read_string",
        "socket_get_var",
        "socket_open",
        "serial_read",
        "tool_serial_config",
        "popup",
        "halt",
        "random",
        "start_thread",
        "rpc_factory",
        "load_micro_line_file",
        "modbus_send_custom_command",
        "encoder_set_tick_count",
        "zero_ftsensor",
        "textmsg",
        "write_port_bit",
    ],
)
def test_commands_that_do_something_are_no_mere_values(name):
    assert not CATALOGUE.get(name).only_gives_a_value


def test_every_command_that_moves_waits_or_sets_is_outside():
    pure = {command.name for command in CATALOGUE if command.only_gives_a_value}
    assert not [name for name in pure if name.startswith(("set_", "write_", "mov", "servo", "speed", "socket_send"))]
