"""Signals, and the numbers of modes on the wire, against tables written by hand.

Counts and ranges of signals are those of the manual (I/O and register chapters) and of the vendor's sheet of the Modbus
server; the numbers of the modes those of the vendor's SDK. Assumed: that a tool pin has separate images of what is
applied to it and what is driven, and that flags and registers are kept when the controller is switched off.
"""

from __future__ import annotations

from enum import IntEnum

import pytest

from elitescript.messages import enums, timing
from elitescript.messages.enums import POWERED
from elitescript.messages.signals import ANALOG_CURRENT_A, ANALOG_VOLTAGE_V, KEPT, SIGNALS
from tests.tables import rows

# Family, type, how many, direction, lowest, highest, unit, whether it is kept.
SIGNAL_TABLE = """
standard_digital_in        bool     16   in    .             .            .        .
standard_digital_out       bool     16   out   .             .            .        .
configurable_digital_in    bool      8   in    .             .            .        .
configurable_digital_out   bool      8   out   .             .            .        .
tool_digital_in            bool      4   in    .             .            .        .
tool_digital_out           bool      4   out   .             .            .        .
standard_analog_in         float     2   in    0             10           V or A   .
standard_analog_out        float     2   out   0             10           V or A   .
tool_analog_in             float     1   in    0             10           V or A   .
tool_analog_out            float     1   out   0             10           V or A   .
tool_voltage               int       1   out   0             24           V        .
input_bool_register        bool    128   in    .             .            .        kept
input_int_register         int      48   in    -2147483648   2147483647   .        kept
input_float_register       float    48   in    .             .            .        kept
output_bool_register       bool    128   out   .             .            .        kept
output_int_register        int      48   out   -2147483648   2147483647   .        kept
output_float_register      float    48   out   .             .            .        kept
flag                       bool     32   out   .             .            .        kept
general_register           int     128   out   0             65535        .        kept
general_coil               bool     68   out   .             .            .        kept
emergency_stop             bool      1   in    .             .            .        .
system_emergency_stop      bool      1   in    .             .            .        .
safeguard_stop             bool      1   in    .             .            .        .
reduced_mode               bool      1   in    .             .            .        .
external_wrench            float     6   in    .             .            N, N m   .
external_force_torque      float     6   in    .             .            N, N m   .
encoder_speed              float     2   in    .             .            1/s      .
"""

ENUMS = {
    "RobotMode": """
        NO_CONTROLLER         -1
        DISCONNECTED           0
        CONFIRM_SAFETY         1
        BOOTING                2
        POWER_OFF              3
        POWER_ON               4
        IDLE                   5
        BACK_DRIVE             6
        RUNNING                7
        UPDATING               8
        WAITING_CALIBRATION    9
    """,
    "SafetyMode": """
        NORMAL                                 1
        REDUCED                                2
        PROTECTIVE_STOP                        3
        RECOVERY                               4
        SAFEGUARD_STOP                         5
        SYSTEM_EMERGENCY_STOP                  6
        ROBOT_EMERGENCY_STOP                   7
        VIOLATION                              8
        FAULT                                  9
        VALIDATE_JOINT_ID                     10
        UNDEFINED                             11
        AUTOMATIC_MODE_SAFEGUARD_STOP         12
        SYSTEM_THREE_POSITION_ENABLING_STOP   13
        TP_THREE_POSITION_ENABLING_STOP       14
    """,
    "TaskState": """
        UNKNOWN   0
        PLAYING   1
        PAUSED    2
        STOPPED   3
    """,
    "AnalogDomain": """
        CURRENT   0
        VOLTAGE   1
    """,
    "RunstateChoice": """
        KEEP                0
        LOW_WHEN_STOPPED    1
        HIGH_WHEN_STOPPED   2
        FOLLOW              3
    """,
    "ToolPinMode": """
        PUSH_PULL   0
        PNP         1
        NPN         2
    """,
    "PulseDecoder": """
        QUADRATURE   1
        EDGES        2
        RISING       3
        FALLING      4
    """,
    # Numbers of our own.
    "DiscardReason": """
        COMPILE_ERROR    1
        INVALID_STATE    2
        TOO_MANY         3
        CLEARED_BEFORE   4
        CLEARED_AT_END   5
        CLEARED          6
    """,
    # errno of Linux: EIO, EPIPE, ENETUNREACH, ECONNRESET, ETIMEDOUT, ECONNREFUSED, EHOSTDOWN, EHOSTUNREACH.
    "ChannelError": """
        BARRED                -2
        NOTHING_BOUND         -1
        OTHER                 5
        BROKEN_PIPE           32
        NETWORK_UNREACHABLE   101
        RESET                 104
        TIMED_OUT             110
        REFUSED               111
        HOST_DOWN             112
        HOST_UNREACHABLE      113
    """,
}


def number(value: float | None) -> str:
    return "" if value is None else f"{value:.0f}"


def test_signals() -> None:
    shown = [
        (
            row.name,
            row.kind,
            str(row.size),
            "in" if row.is_input else "out",
            number(row.low),
            number(row.high),
            row.unit,
            "kept" if row.is_kept else "",
        )
        for row in SIGNALS.values()
    ]
    assert shown == rows(SIGNAL_TABLE)
    assert list(KEPT) == [row[0] for row in rows(SIGNAL_TABLE) if row[-1] == "kept"]


def test_ranges_of_analog_channels() -> None:
    assert (ANALOG_CURRENT_A, ANALOG_VOLTAGE_V) == ((0.004, 0.020), (0.0, 10.0))


@pytest.mark.parametrize("name", ENUMS)
def test_numbers_on_the_wire(name: str) -> None:
    shown = [(member.name, str(member.value)) for member in getattr(enums, name)]
    assert shown == rows(ENUMS[name])


def test_every_enumeration_is_here() -> None:
    kinds = {name for name, kind in vars(enums).items() if isinstance(kind, type) and issubclass(kind, IntEnum)}
    assert kinds - {"IntEnum", "Mode"} == set(ENUMS)


def test_modes_with_power() -> None:
    assert {mode.name for mode in POWERED} == {"POWER_ON", "BOOTING", "IDLE", "BACK_DRIVE", "RUNNING"}


def test_time() -> None:
    # 250 ticks a second are observed in streams of the vendor's client; the rest is assumed.
    assert (timing.PERIOD_S, timing.TICKS_PER_S, timing.RPC_TIMEOUT_S) == (0.004, 250, 60.0)
    assert timing.TICK_MAX == 1_125_899_906_842_624
    assert timing.TICK_MAX * 4000 < 2**64, "microseconds of a tick have a place in a packet"
    assert timing.ticks_for(1e12) == timing.ticks_for(1e15) == timing.ticks_for(float("inf")) == 250 * 10**12
    assert [timing.ticks_for(duration) for duration in (0.0, 0.004, 0.0040001, 0.1 + 0.2, -1.0)] == [0, 1, 2, 75, 0]
