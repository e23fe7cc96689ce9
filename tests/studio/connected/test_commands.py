"""What is sent for what a page asks for, and what a text of the editor becomes."""

from __future__ import annotations

import pytest

from elitescript.errors import UsageError
from elitescript.studio.connected.commands import globals_of, output_program, unit_of
from elitescript.studio.connected.picture import Picture
from elitescript.studio.connected.signals import FAST, REGISTERS, signals_of


@pytest.mark.parametrize(
    ("text", "unit", "offset"),
    [
        ("def pick():\n    x = 1\nend\n", "def pick():\n    x = 1\nend\n", 0),
        ("# why\ndef pick():\r\n  x = 1\r\nend", "# why\ndef pick():\n  x = 1\nend\n", 0),
        ("x = 1", "def studio():\n\tx = 1\nend\n", 1),
        ("def f():\n  x = 1\nend\nf()\n", "def studio():\n\tdef f():\n\t  x = 1\n\tend\n\tf()\n\t\nend\n", 1),
        ('t = """a\nb"""\n', 'def studio():\n\tt = """a\nb"""\n\t\nend\n', 1),
        ("x = (\n", "def studio():\n\tx = (\n\t\nend\n", 1),
    ],
)
def test_a_text_becomes_one_program(text, unit, offset):
    assert unit_of(text) == (unit, offset)


def test_names_that_are_declared_global():
    text = "global a, b # two\nx = 1\n  global c\nglobal a\nglobal d = 4\nglobal 7\nglobally = 1\n"
    assert globals_of(text) == ("a", "b", "c", "d")


@pytest.mark.parametrize(
    ("name", "value", "statement"),
    [
        ("standard_digital_out[3]", True, "set_standard_digital_out(3, True)"),
        ("tool_digital_out[1]", False, "set_tool_digital(1, False)"),
        ("output_int_register[7]", -5, "write_output_integer_register(7, -5)"),
        ("output_float_register[7]", 0.5, "write_output_float_register(7, 0.5)"),
        ("tool_voltage", 24, "set_tool_voltage(24)"),
    ],
)
def test_outputs(name, value, statement):
    assert output_program(name, value) == f"sec studio_set():\n    {statement}\nend\n"


@pytest.mark.parametrize(
    "name", ["standard_digital_in[1]", "standard_analog_out[0]", "flag[3]", "sparkle", "tool_digital_out[9]"]
)
def test_signals_that_are_not_set(name):
    with pytest.raises(UsageError, match=name.partition("[")[0]):
        output_program(name, 1)


def test_signals_by_name():
    values = {
        "actual_digital_input_bits": 1 << 3 | 1 << 17 | 1 << 25,
        "actual_digital_output_bits": 1 << 15,
        "standard_analog_input1": 2.5,
        "standard_analog_output0": 0.0,
        "tool_output_voltage": 24.0,
        "output_bit_registers32_to_63": 1 << 31,
        "input_int_register5": -7,
        "output_double_register47": 0.25,
    }
    assert values.keys() <= {*FAST, *REGISTERS}
    assert signals_of(values) == {
        "standard_digital_in[3]": True,
        "configurable_digital_in[1]": True,
        "tool_digital_in[1]": True,
        "standard_digital_out[15]": True,
        "standard_analog_in[1]": 2.5,
        "tool_voltage": 24,
        "input_int_register[5]": -7,
        "output_bool_register[63]": True,
        "output_float_register[47]": 0.25,
    }


@pytest.mark.parametrize(
    "values",
    [
        {"actual_joint_positions": (float("nan"),) * 6},
        {"actual_joint_positions": (0.0, float("inf"), 0.0, 0.0, 0.0, 0.0)},
        {"timestamp": float("nan")},
    ],
)
def test_numbers_that_no_controller_has_are_left_out(values):
    picture = Picture("here")
    picture.take_package({"timestamp": 1.0, "actual_joint_positions": (0.5,) * 6})
    picture.take_package(values)
    assert picture.values == {"timestamp": 1.0, "actual_joint_positions": (0.5,) * 6}


def test_modes_that_are_not_known():
    picture = Picture("here")
    picture.take_package(
        {"robot_mode": 77, "safety_status": 255, "runtime_state": 99, "target_speed_fraction": float("nan")}
    )
    controller = picture.message()["controller"]
    assert [controller[name] for name in ("robot_mode", "safety_mode", "task_state")] == [
        "DISCONNECTED",
        "UNDEFINED_SAFETY_MODE",
        "UNKNOWN",
    ]
    assert controller["speed_fraction"] == 1.0
