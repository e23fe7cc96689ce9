"""Lists names that are not commands but that programs should not define: the checker warns about them.

*Observed*: the vendor's tools and an offline-programming post-processor refuse them as identifiers. Most may be
commands that were never released or that come from another maker's language.
"""

from __future__ import annotations

from typing import Final

RESERVED: Final = frozenset(
    """
    config_collision_fallback enable_register_sync get_collision_fallback_config get_collision_warning_thresh
    get_drag_adjust_params_idt get_drag_adjust_params_preset get_dyn_collision_force_min_ratio
    get_dyn_drag_speed_max_ratio get_dynamic_data get_target_rtcp_speed is_collision_detect_enabled
    is_disable_tool_led modbus_request_update_signal_value modbus_set_digital_input_action
    reset_revolution_counter_force rtcp_movec rtcp_movep serial_close serial_open
    set_bool_register_in set_collision_warning_thresh set_config_digital_in
    set_config_digital_in_pair set_disable_tool_led set_dynamic_config
    set_dynamic_data set_dynamic_param set_float_register_in set_highspeed_digital_in set_highspeed_encode_in
    set_int_register_in set_masterboard_es set_masterboard_sg set_rtcp set_standard_analog_in
    set_standard_digital_in set_tool_analog_in set_tool_digital_in set_tp_es set_tp_freedrive_io
    MODBUS assert_equals blocking_usleep cma_avg cma_max cma_min cma_reset cma_tick cma_tock
    conveyor_pulse_decode debugmsg enable_external_ft_sensor end end_joint_torque_mode end_screw_driving
    end_teach_mode enter_critical exit_critical get_actual_joint_positions_history get_analog_in
    get_analog_out get_controller_temp get_conveyor_tick_count get_digital_in get_digital_out
    get_euromap_input get_euromap_output get_joint_positions get_joint_speeds get_joint_temp
    get_max_torque_fraction get_numerical_inverse_kin get_robot_power get_target_payload get_tcp_power
    get_tcp_speed get_tool_accelerometer_reading get_tool_current get_tool_digital_in get_tool_digital_out
    get_tool_digital_output_mode get_tool_output_mode inkognito is_steady join joint_torque_mode jump_to_label
    kill local movel_rel pathj position_deviation_warning protective_stop read_register
    request_boolean_from_primary_client request_float_from_primary_client request_integer_from_primary_client
    request_string_from_primary_client reset_revolution_counter rpc_stub rtde_set_watchdog run screw_driving
    script_stop send_joint_regulation_parameter servoc servol set_analog_inputrange set_analog_out
    set_analog_outputdomain set_configurable_digital_in set_conveyor_tick_count set_digital_in set_digital_out
    set_euromap_output set_euromap_runstate_dependent_choice set_joint_param set_max_torque_fraction
    set_payload_cog set_payload_mass set_pos set_runstate_configurable_digital_outputs
    set_runstate_output_to_value set_runstate_outputs set_runstate_standard_analog_outputs
    set_runstate_standard_digital_outputs set_runstate_tool_digital_outputs set_tcp_wrench
    set_tool_communication set_tool_digital_out set_tool_digital_output_mode set_tool_output_mode
    socket_read_line teach_mode thread tool_contact tool_pose tracka varmsg wrench_trans write_register xor
    """.split()  # noqa: SIM905
)

GENERATED_PREFIXES: Final = (
    "var_",
    "waypoint_",
    "subTask_",
    "switch_",
    "move_thread_",
    "move_thread_flag_",
    "towardsPos_",
    "threadId_",
    "thread_flag_",
    "thread_handler_",
    "timer_",
)
"""Beginnings of names that belong to code which the pendant generates."""
