from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ("r = socket_read_ascii_float(3)", "movel([r[1], r[2], 0.4, 3.14, 0, 0])"),
        ("r = socket_read_ascii_float(3)", "x = r[1] / 1000", "y = x + 0.1", "movel([x, y, 0.4, 3.14, 0, 0])"),
        ("b = socket_read_binary_integer(1)", "write_output_integer_register(0, b[1])"),
        (
            "def where():",
            "  return socket_read_ascii_float(3)",
            *("end", "r = where()", "movel([r[1], r[2], 0.4, 3.14, 0, 0])"),
        ),
        (
            "def go(r):",
            "  movel([r[1], r[2], 0.4, 3.14, 0, 0])",
            *("end", "go(socket_read_ascii_float(3))"),
        ),
        ("set_standard_analog_out(0, socket_read_ascii_float(1)[1])",),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W262"]


@pytest.mark.parametrize(
    "lines",
    [
        ("r = socket_read_ascii_float(3)", "if r[0] == 3:", "  movel([r[1], r[2], 0.4, 3.14, 0, 0])", "end"),
        ("r = socket_read_ascii_float(3)", "if r[0] != 3:", "  halt()", "end", "movel([r[1], r[2], 0.4, 3.14, 0, 0])"),
        (
            "r = socket_read_ascii_float(3)",
            "try:",
            "  movel([r[1], r[2], 0.4, 3.14, 0, 0])",
            "except:",
            '  textmsg("no")',
            "end",
        ),
        (
            "r = socket_read_byte_list(1)",
            "while r[0] != 1:",
            "  r = socket_read_byte_list(1)",
            "end",
            "write_output_integer_register(0, r[1])",
        ),
        ("r = socket_read_ascii_float(3)", "textmsg(r)"),
        (
            "def where():",
            "  r = socket_read_ascii_float(3)",
            "  while r[0] != 3:",
            "    r = socket_read_ascii_float(3)",
            *("  end", "  return r", "end", "r = where()", "movel([r[1], r[2], 0.4, 3.14, 0, 0])"),
        ),
        (
            "def go(r):",
            "  if r[0] == 3:",
            "    movel([r[1], r[2], 0.4, 3.14, 0, 0])",
            *("  end", "end", "go(socket_read_ascii_float(3))"),
        ),
        (
            "def is_fine(x):",
            "  return x[0] == 3",
            "end",
            "r = socket_read_ascii_float(3)",
            "ok = is_fine(r)",
            "if ok:",
            "  movel([r[1], r[2], 0.4, 3.14, 0, 0])",
            "end",
        ),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W262" not in [problem.split()[0] for problem in body(*lines)]
