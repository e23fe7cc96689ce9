from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        'if str_find(socket_read_string(), "OK"):\n  halt()\nend',
        's = "OK part"\nif not str_find(s, "ERROR"):\n  halt()\nend',
        'if str_find(socket_read_string(), "OK") == False:\n  halt()\nend',
        'if socket_read_string().find("OK"):\n  halt()\nend',
        "if socket_read_ascii_float(3):\n  halt()\nend",
        "x = read_input_integer_register(0)\nif 1 < x & x < 10:\n  halt()\nend",
        "x = read_input_integer_register(0)\nset_flag(1, x == 1 | x == 3)",
        "x = read_input_integer_register(0)\nif x == 1 or 2:\n  halt()\nend",
        "x = read_input_integer_register(0)\nset_standard_digital_out(1, x == 1 or 2)",
        "x = read_input_integer_register(0)\nif x == 1 or 2 and get_flag(0):\n  halt()\nend",
        "x = read_input_integer_register(0)\nif get_flag(0) and x == 1 or 2:\n  halt()\nend",
    ],
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines.split("\n"))] == ["W241"]


@pytest.mark.parametrize(
    "lines",
    [
        'if str_find(socket_read_string(), "OK") >= 0:\n  halt()\nend',
        'if str_find(socket_read_string(), "OK") != -1:\n  halt()\nend',
        "points = [[1, 2], [3, 4]]\nif points:\n  halt()\nend",
        "while True:\n  sync()\nend",
        "r = tool_modbus_read_registers(1, 0, 2)\nif r:\n  halt()\nend",
        "if get_flag(0) == 1 or get_flag(1):\n  halt()\nend",
        "x = read_input_integer_register(0) or 2\ntextmsg(x)",
        "x = read_input_integer_register(0)\nif x == 1 or x == 2 and get_flag(0):\n  halt()\nend",
        "s = socket_read_string()\nif s:\n  halt()\nend",
    ],
)
def test_what_almost_is_one_is_not_found(lines):
    assert body(*lines.split("\n")) == []
