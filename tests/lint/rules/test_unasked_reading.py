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
        ("r = socket_read_ascii_float(3)", "p = get_target_tcp_pose()", "p[0] = p[0] + r[1]", "movel(p)"),
        ("r = socket_read_ascii_float(3)", "p = get_target_tcp_pose()", "p[0] += r[1] / 1000", "movel(p)"),
        ("r = socket_read_ascii_float(3)", "x = 0.3", "x += r[1]", "movel([x, 0, 0.4, 3.14, 0, 0])"),
        ("r = socket_read_ascii_float(6)", "q = []", "for i in range(6):", "  q.append(r[i + 1])", "end", "movej(q)"),
        ("r = socket_read_ascii_float(6)", "movej([a * 0.0174 for a in r[1:]])"),
        ("n, x, y = socket_read_ascii_float(2)", "movel([x, y, 0.4, 3.14, 0, 0])"),
        ("p = get_target_tcp_pose()", "p[2] = socket_read_ascii_float(1)[1]", "q = p.copy()", "movel(q)"),
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
            *("r = socket_read_ascii_float(3)", "p = get_target_tcp_pose()", "if r[0] == 3:", "  p[0] = p[0] + r[1]"),
            *("end", "movel(p)"),
        ),
        (
            *("r = socket_read_ascii_float(3)", "p = get_target_tcp_pose()", "movel(p)", "p[0] = r[1]"),
            *("p = get_target_tcp_pose()", "movel(p)"),
        ),
        (
            *("r = socket_read_ascii_float(1)", "p = get_target_tcp_pose()", "p[0] += r[1]"),
            *("if p[0] > 0.2 and p[0] < 0.5:", "  movel(p)", "end"),
        ),
        ("n, x, y = socket_read_ascii_float(2)", "if n == 2:", "  movel([x, y, 0.4, 3.14, 0, 0])", "end"),
        ("r = socket_read_ascii_float(2)", "movej([a for a in r[1:] if a == a] + [0, 0, 0, 0])"),
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
