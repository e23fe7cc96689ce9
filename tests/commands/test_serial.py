"""Commands of the serial ports: arguments, what is asked of a port, and the form of what comes back."""

from __future__ import annotations

import pytest

from elitescript.errors import ArgumentRangeError
from elitescript.messages.line import LineSettings
from elitescript.messages.profile import profile

BOX = "/dev/ttymxc0"


@pytest.fixture
def lines(robot):
    return robot.lines


@pytest.mark.parametrize(
    ("call", "asked"),
    [
        ("tool_serial_config(1, 9600, 2, 1)", ("enable", "tool", LineSettings(9600, 2, 1, 8), False, False)),
        ("tool_serial_config(True, 9600, 0, 2, 5)", ("enable", "tool", LineSettings(9600, 0, 2, 5), False, False)),
        ("tool_serial_config(True, 9600, 0, 2, 5, 1)", ("enable", "tool", LineSettings(9600, 0, 2, 8), True, False)),
        ("tool_serial_config(True, 9600, 0, 2, usage=1)", ("enable", "tool", LineSettings(9600, 0, 2, 8), False, True)),
        ("serial_config(True, 2400, 1, 1)", ("enable", BOX, LineSettings(2400, 1, 1, 8), False, False)),
        ("serial_config(True, 2400, 1, 1, 7)", ("enable", BOX, LineSettings(2400, 1, 1, 7), False, False)),
        ("serial_config(True, 2400, 1, 1, 8, True)", ("enable", BOX, LineSettings(2400, 1, 1, 8), True, False)),
        (
            "serial_config(True, 2400, 1, 1, port='/dev/ttyS2')",
            ("enable", "/dev/ttyS2", LineSettings(2400, 1, 1, 8), False, False),
        ),
    ],
)
@pytest.mark.parametrize("opens", [True, False])
def test_enabling_says_whether_it_worked(script, lines, call, asked, opens):
    lines.opens = opens
    assert script(call) is opens
    assert lines.asked == [asked]


def test_disabling(script, lines):
    assert script("tool_serial_config(False, 115200, 0, 1)") is False
    assert script("serial_config(False, 115200, 0, 1)") is True
    assert script("serial_config(False, 115200, 0, 1, 7, True, '/dev/ttyS2')") is True
    assert lines.asked == [("disable", "tool"), ("disable", BOX), ("disable", "/dev/ttyS2")]


def test_seven_bits_are_not_for_modbus(script, lines, robot):
    assert script("serial_config(True, 115200, 0, 1, 7, True)") is False
    assert lines.asked == []
    assert robot.asked[0][2] == "serial_config: size must be 8 bit with modbus_rtu, got 7; nothing was changed"


@pytest.mark.parametrize(
    ("call", "result", "asked"),
    [
        ("tool_serial_is_open()", True, ("is_open", "tool")),
        ("serial_is_open()", True, ("is_open", BOX)),
        ("serial_is_open('/dev/ttyS2')", True, ("is_open", "/dev/ttyS2")),
        ("tool_serial_mode()", "RS485", ("mode", "tool")),
        ("serial_mode()", "RS485", ("mode", BOX)),
        ("tool_serial_read(2, True, 0.5)", [97, 98], ("read", "tool", 2, 0.5)),
        ("tool_serial_read(5, False, 0)", b"abc", ("read", "tool", 5, 0.0)),
        ("serial_read(2)", [97, 98], ("read", BOX, 2, 0.1)),
        ("serial_read(2, False, timeout=3)", b"ab", ("read", BOX, 2, 3.0)),
        ("serial_read(0)", [], ("read", BOX, 0, 0.1)),
        ("tool_serial_write('hello')", 5, ("write", "tool", b"hello")),
        ("tool_serial_write([255, 256, -1])", 3, ("write", "tool", b"\xff\x00\xff")),
        ("serial_write(300)", True, ("write", BOX, b"\x2c")),
        ("serial_write(bytearray(b'a'), '/dev/ttyS2')", True, ("write", "/dev/ttyS2", b"a")),
        ("serial_flush()", None, ("flush", BOX)),
    ],
)
def test_what_is_asked_and_returned(script, lines, call, result, asked):
    value = script(call)
    assert (value, type(value)) == (result, type(result))
    assert lines.asked == [asked]


def test_what_is_returned_when_nothing_can_be_sent(script, lines):
    lines.opens = False
    assert script("[tool_serial_write('a'), serial_write('a')]") == [0, False]
    assert script("[tool_serial_is_open(), serial_is_open()]") == [False, False]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        ("serial_write([1, 'a'])", "data element 1 must be an int, not str 'a'"),
        ("serial_write(1.5)", "data must be str or int or bytes or list"),
        ("tool_serial_config(True, 2400, 0, 1)", "baud_rate must be one of 9600, .* baud, got 2400"),
        ("serial_config(True, 1000000, 0, 1)", "baud must be one of 2400, .* baud, got 1000000"),
        ("serial_config(True, 9600, 3, 1)", r"parity_bit must be in \[0, 2\], got 3"),
        ("tool_serial_config(True, 9600, 0, 3)", "stop_bits must be one of 1, 2, got 3"),
        ("serial_config(True, 9600, 0, 1, 6)", "size must be one of 7, 8 bit, got 6"),
        ("tool_serial_config(True, 9600, 0, 1, 9)", r"size must be in \[5, 8\] bit, got 9"),
        ("tool_serial_config(True, 9600, 0, 1, usage=2)", "usage must be one of 0, 1, got 2"),
        ("serial_mode('/dev/ttyUSB0')", "port must be one of '/dev/ttymxc0', '/dev/ttyS2', got '/dev/ttyUSB0'"),
        ("tool_serial_read(-1, True, 1)", "read_count must be >= 0 byte, got -1"),
    ],
)
def test_what_is_refused(script, lines, call, message):
    with pytest.raises(Exception, match=f"^{call.partition('(')[0]}: {message}"):
        script(call)
    assert lines.asked == []


@pytest.mark.parametrize(
    "call",
    [
        "serial_config(True, 9600, 0, 1, port='/dev/ttyS2')",
        "serial_read(1, port='/dev/ttyS2')",
        "serial_write('a', '/dev/ttyS2')",
        "serial_is_open('/dev/ttyS2')",
        "serial_mode('/dev/ttyS2')",
        "serial_flush('/dev/ttyS2')",
        "serial_modbus_read_bits(1, 0, 1, port='/dev/ttyS2')",
        "serial_modbus_write_bits(1, 0, 1, port='/dev/ttyS2')",
    ],
)
def test_older_firmware_has_no_second_port(script, robot, lines, call):
    robot.profile = profile("2.10")
    with pytest.raises(ArgumentRangeError, match=r"which firmware 2\.10 does not have") as caught:
        script(call)
    assert (caught.value.argument, caught.value.value, caught.value.limit) == ("port", "/dev/ttyS2", BOX)
    assert lines.asked == []
