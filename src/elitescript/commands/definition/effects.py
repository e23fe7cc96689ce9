"""Says which commands only give a value."""

from __future__ import annotations

from typing import Final

from elitescript.commands.definition.registry import Command

_PURE_FAMILIES: Final = frozenset(("kinematics", "lists", "maths", "poses", "strings"))
_READING: Final = ("get_", "is_", "read_")
_ALSO_READING: Final = frozenset(
    """
    cal_rpy_frame controller_timestamp encoder_get_tick_count encoder_unwind_delta_tick_count force modbus_get_error
    modbus_get_signal_status modbus_get_time_since_signal_invalid path_offset_get serial_is_open serial_mode
    socket_is_connected tool_serial_is_open tool_serial_mode
    """.split()  # noqa: SIM905
)
_CHANGING: Final = frozenset(("random", "get_micro_line_values_by_index"))
"""`random` gives another value each time; the other one belongs to a file that is loaded."""


def only_gives_a_value(command: Command) -> bool:
    """Return whether a command changes nothing, so that a call of it is made for its result alone."""
    if command.waits or command.name in _CHANGING:
        return False
    module = command.function.__module__.rpartition(".")[2]
    return module in _PURE_FAMILIES or command.name in _ALSO_READING or command.name.startswith(_READING)
