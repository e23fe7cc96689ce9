from __future__ import annotations

import pytest

from tests.lint.checking import body, repaired


@pytest.mark.parametrize(
    "lines",
    [
        "if socket_read_string() == 1:\n  halt()\nend",
        "if 1 == socket_read_string():\n  halt()\nend",
        "s = socket_read_string()\nif s != 5:\n  halt()\nend",
        'if get_standard_digital_in(0) == "True":\n  halt()\nend',
        'if read_input_integer_register(0) == "5":\n  halt()\nend',
        "if get_actual_tcp_pose() == 0:\n  halt()\nend",
        'if socket_open("1.2.3.4", 80) == "OK":\n  halt()\nend',
        "if socket_read_ascii_float(3) == [1.0, 2.0, 3.0]:\n  halt()\nend",
        's = socket_read_string()\nif s is "on":\n  halt()\nend',
        "n = read_input_integer_register(0)\nif n is not 500:\n  halt()\nend",
        "if to_str(3) == 3:\n  halt()\nend",
        'if get_flag(0) is "on":\n  halt()\nend',
        'modbus_add_signal("1.2.3.4", 255, 0, 2, "a")\nv = modbus_get_signal_status("a")\nif v < 0:\n  halt()\nend',
        'modbus_add_signal("1.2.3.4", 255, 0, 0, "a")\nif modbus_get_signal_status("a") == "on":\n  halt()\nend',
        "if read_port_register(3) > 70000:\n  halt()\nend",
        'if not socket_open("1.2.3.4", 80) == 2:\n  halt()\nend',
        "if 3 == get_flag(1):\n  halt()\nend",
        "d = serial_read(9, False)\nif d[3:6] != 1:\n  halt()\nend",
        'global m\nm = 0\nm = read_input_integer_register(5)\nif m == "7":\n  halt()\nend',
        'def state():\n  return get_flag(0)\nend\nif state() == "on":\n  halt()\nend',
    ],
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines.split("\n"))] == ["W240"]


@pytest.mark.parametrize(
    "lines",
    [
        'if socket_read_string() == "1":\n  halt()\nend',
        "if get_standard_digital_in(0) == 1:\n  halt()\nend",
        "if get_flag(0) == None:\n  halt()\nend",
        "if get_flag(0) == 1.0:\n  halt()\nend",
        "debug = True\nif debug == 2:\n  halt()\nend",
        'd = serial_read(9, False)\nif d[3:6] == b"GS,":\n  halt()\nend',
        "debug = False\nif debug == True:\n  halt()\nend",
        "most = 0.15\nif 0.2 > most:\n  halt()\nend",
        'x = None\nif get_flag(0):\n  x = "a"\nend\nif x == "a":\n  halt()\nend',
        'if 1 == "a":\n  halt()\nend',
        'v = modbus_get_signal_status("a")\nif v < 0:\n  halt()\nend',
        "v = read_port_register(3)\nif v > 32767:\n  v = v - 165536\nend\nif v < -40000:\n  halt()\nend",
        "v = read_port_register(3)\nif v > 5:\n  return\nend\nif v <= 5:\n  halt()\nend",
        'i = str_find(socket_read_string(), "a")\nif i == -1:\n  halt()\nend',
        'def f(x):\n  if x == 1:\n    halt()\n  end\nend\ng = f\ng("a")',
        "global command\ncommand = ''\nwhile command != 5:\n  sync()\nend",
    ],
)
def test_what_almost_is_one_is_not_found(lines):
    assert body(*lines.split("\n")) == []


@pytest.mark.parametrize(
    ("domain", "condition", "is_found"),
    [
        (0, "get_standard_analog_in(0) > 10", True),
        (0, "12 < get_standard_analog_in(0)", True),
        (0, "get_standard_analog_in(0) > 0.01", False),
        (1, "get_standard_analog_in(0) > 8", False),
        (1, "get_standard_analog_in(0) > 50", True),
    ],
)
def test_an_analog_input_never_reaches_more_than_its_domain(domain, condition, is_found):
    lines = (f"set_standard_analog_input_domain(0, {domain})", f"if {condition}:", "  halt()", "end")
    assert body(*lines) == (["W240 3:6"] if is_found else [])


def test_a_coordinate_in_millimetres_is_no_length_in_metres():
    assert body("z = get_actual_tcp_pose()[2] * 1000", "if z > 300:", "  halt()", "end") == []
    assert body("z = get_actual_tcp_pose()[2]", "if z > 300:", "  halt()", "end") == ["W231 3:10"]


def test_is_beside_a_text_is_repaired():
    text = 'def job():\n  s = socket_read_string()\n  if s is not  "on": halt()\nend\n'
    assert 'if s != "on": halt()' in repaired(text)
    assert body("x = get_flag(0)", "if x is True: halt()", "if x is None: halt()") == []
