"""Maps command names of other robots' languages to commands."""

from __future__ import annotations

from typing import Final

FOREIGN: Final = {
    "delay": "sleep",
    "get_actual_tcp_force": "get_tcp_force",
    "get_analog_in": "get_standard_analog_in",
    "get_analog_out": "get_standard_analog_out",
    "get_controller_temp": "get_controller_temperature",
    "get_conveyor_tick_count": "encoder_get_tick_count",
    "get_digital_in": "get_standard_digital_in",
    "get_digital_out": "get_standard_digital_out",
    "get_joint_positions": "get_actual_joint_positions",
    "get_joint_speeds": "get_actual_joint_speeds",
    "get_joint_temp": "get_joint_temperatures",
    "get_target_payload": "get_target_payload_mass",
    "get_tcp_speed": "get_actual_tcp_speed",
    "get_tool_digital_in": "get_tool_digital",
    "get_tool_digital_out": "get_tool_digital",
    "rtde_set_watchdog": "rtsi_set_watchdog",
    "set_analog_inputrange": "set_standard_analog_input_domain",
    "set_analog_out": "set_standard_analog_out",
    "set_analog_outputdomain": "set_standard_analog_output_domain",
    "set_conveyor_tick_count": "encoder_set_tick_count",
    "set_digital_out": "set_standard_digital_out",
    "set_payload_cog": "set_payload",
    "set_payload_mass": "set_payload",
    "set_target_payload": "set_payload",
    "set_tool_communication": "tool_serial_config",
    "set_tool_digital_out": "set_tool_digital",
    "socket_read_line": "socket_read_string",
    "str_sub_string": "str_sub",
    "to_string": "to_str",
    "wait": "sleep",
}
"""Names that other languages have, and the commands that do the same."""
