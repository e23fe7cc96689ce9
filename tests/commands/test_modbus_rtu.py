"""MODBUS-RTU commands of both ports: what is asked of a slave, and the form of what comes back."""

from __future__ import annotations

import pytest

from elitescript.errors import ArgumentRangeError

BOX = "/dev/ttymxc0"


@pytest.fixture
def lines(robot):
    return robot.lines


@pytest.mark.parametrize(
    ("kind", "function"),
    [("read_bits", 1), ("read_input_bits", 2), ("read_registers", 3), ("read_input_registers", 4)],
)
def test_reading(script, lines, kind, function):
    assert script(f"tool_modbus_{kind}(7, 100, 2)") == [1, 2]
    assert script(f"serial_modbus_{kind}(7, 100, 2, 0.5)") == [1, 2]
    assert script(f"serial_modbus_{kind}(7, 100, 2, port='/dev/ttyS2')") == [1, 2]
    assert lines.asked == [
        ("read_slave", "tool", 7, function, 100, 2, 5.0, False),
        ("read_slave", BOX, 7, function, 100, 2, 0.5, True),
        ("read_slave", "/dev/ttyS2", 7, function, 100, 2, 5.0, False),
    ]
    lines.answer = None
    assert script(f"tool_modbus_{kind}(7, 100, 2)") == []
    assert script(f"serial_modbus_{kind}(7, 100, 2)") == []


WRITES = [
    ("write_registers", "[1, 65535]", 16, (1, 65535), 2),
    ("write_registers", "(5,)", 16, (5,), 1),
    ("write_registers", "5", 16, (5,), 1),
    ("write_registers", "[True]", 16, (1,), 1),
    ("write_bits", "[1, False, 7]", 15, (1, 0, 1), 3),
    ("write_bits", "True", 15, (1,), 1),
    ("write_bits", "0", 15, (0,), 1),
    ("write_bits", "-5", 15, (1,), 1),
    ("write_single_bit", "1", 5, (1,), 1),
    ("write_single_bit", "True", 5, (1,), 1),
    ("write_single_bit", "256", 5, (1,), 1),
    ("write_single_bit", "0", 5, (0,), 1),
    ("write_single_register", "65535", 6, (65535,), 1),
]


@pytest.mark.parametrize(("kind", "data", "function", "values", "count"), WRITES)
def test_writing(script, lines, kind, data, function, values, count):
    says_whether = kind in ("write_registers", "write_bits")
    for answer, by_tool, by_box in (((), True if says_whether else 1, count), (None, False if says_whether else 0, 0)):
        lines.asked.clear()
        lines.answer = answer
        results = [script(f"tool_modbus_{kind}(7, 100, {data})"), script(f"serial_modbus_{kind}(7, 100, {data}, 0.5)")]
        assert results == [by_tool, by_box]
        assert [type(result) for result in results] == [type(by_tool), int]
        assert lines.asked == [
            ("write_slave", "tool", 7, function, 100, values, 5.0, False),
            ("write_slave", BOX, 7, function, 100, values, 0.5, True),
        ]


@pytest.mark.parametrize("prefix", ["tool_modbus_", "serial_modbus_"])
@pytest.mark.parametrize(
    ("call", "argument"),
    [
        ("read_bits(0, 0, 1)", "slave"),
        ("read_bits(248, 0, 1)", "slave"),
        ("read_bits(1, -1, 1)", "addr"),
        ("read_bits(1, 65536, 1)", "addr"),
        ("read_bits(1, 0, 0)", "len"),
        ("read_registers(1, 0, 126)", "len"),
        ("read_registers(1, 65535, 2)", None),
        ("write_registers(1, 0, 65536)", "data"),
        ("write_registers(1, 0, [1, -1])", "data"),
        ("write_registers(1, 0, [])", "data"),
        ("write_registers(1, 0, [0] * 124)", "data"),
        ("write_registers(1, 65535, [0, 0])", None),
        ("write_bits(1, 0, [])", "data"),
        ("write_bits(1, 0, [0] * 1969)", "data"),
        ("write_single_register(1, 0, 65536)", "data"),
        ("write_single_register(1, 0, -1)", "data"),
        ("write_single_bit(1, 65536, 1)", "addr"),
    ],
)
def test_what_is_refused(script, lines, prefix, call, argument):
    with pytest.raises(ArgumentRangeError) as caught:
        script(prefix + call)
    error = caught.value
    assert str(error).startswith(f"{prefix}{call.partition('(')[0]}: ")
    assert (error.argument or "").removesuffix("ess") == (argument or "")
    assert error.limit
    assert lines.asked == []


def test_the_longest_requests_pass(script, lines):
    assert script("serial_modbus_write_registers(1, 65413, [0] * 123)") == 123
    assert script("serial_modbus_write_bits(1, 0, [1] * 1968)") == 1968
