"""What the MODBUS TCP commands make of their arguments."""

from __future__ import annotations

from typing import Any

import pytest


@pytest.mark.parametrize(
    ("text", "asked"),
    [
        (
            "modbus_add_signal('192.168.1.100', 255, 0, 3, 'output1', False, 10, 502)",
            ("add", "192.168.1.100", 502, "output1", 3, 255, 0, 10, False),
        ),
        ("modbus_add_signal('10.0.0.1', 250, 7, 0, 'x')", ("add", "10.0.0.1", 502, "x", 0, 255, 7, 1, False)),
        (
            "modbus_add_rw_signal('172.140.17.11', 255, 0, 10, 2, 10, 'output1', True, 503)",
            ("add_read_write", "172.140.17.11", 503, "output1", 255, (0, 10), (2, 10), True),
        ),
        ("modbus_delete_signal('output1')", ("delete", "output1")),
        ("modbus_set_output_register('output1', 300)", ("set", "output1", (300,), False)),
        ("modbus_set_output_register('output1', 70000)", ("set", "output1", (70000,), False)),
        ("modbus_set_output_register('output1', [1, -1])", ("set", "output1", (1, -1), False)),
        ("modbus_set_output_signal('output2', True)", ("set", "output2", (1,), True)),
        ("modbus_set_output_signal('output2', [True, 0])", ("set", "output2", (1, 0), True)),
        ("modbus_set_runstate_dependent_choice('output2', 1)", ("tie", "output2", 1)),
        ("modbus_set_signal_update_frequency('output2', 20)", ("retime", "output2", 20)),
        ("modbus_set_signal_watchdog('MODBUS', 120)", ("set_watchdog", "MODBUS", 120.0)),
        ("modbus_reset_connection('192.168.1.123', True, 502)", ("reset", "192.168.1.123", 502, True)),
        (
            "modbus_send_custom_command('172.140.17.11',103,6,[17,32,2,88],True,502)",
            ("request", "172.140.17.11", 502, 103, 6, bytes([0x11, 0x20, 0x02, 0x58]), True),
        ),
    ],
)
def test_examples_of_the_manuals_ask_for_what_they_say(
    script: Any, robot: Any, text: str, asked: tuple[Any, ...]
) -> None:
    assert script(text) is None
    assert robot.modbus.asked == [asked]


@pytest.mark.parametrize(("source", "codes"), [(0, [2, 111]), (1, [2]), (2, [111])])
def test_errors_come_from_the_source_that_was_asked_for(script: Any, robot: Any, source: int, codes: list[int]) -> None:
    robot.modbus.codes = (2, 111)
    assert script(f"modbus_get_error('x', {source})") == codes


def test_a_secondary_program_may_use_all_of_them(script: Any, robot: Any) -> None:
    robot.is_secondary = True
    script("modbus_get_signal_status('x', True)")
    script("modbus_reset_connection('10.0.0.1')")
    assert len(robot.modbus.asked) == 2
