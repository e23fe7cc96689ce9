from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ("if get_standard_digital_in(0):", "  x = 1", "end", "textmsg(x)"),
        ("n = read_input_integer_register(0)", "if n > 3:", "  x = 1", "end", "textmsg(x)"),
        ("m = read_input_integer_register(0)", "if m == 1:", "  x = 1", "elif m == 2:", "  x = 2", "end", "textmsg(x)"),
        ("if get_flag(0):", '  textmsg("a")', "else:", "  x = 1", "end", "textmsg(x)"),
        (
            "m = read_input_integer_register(0)",
            *("if m == 1:", "  x = 1", "elif m == 2:", "  x = 2", "else:", "  sync()", "end", "textmsg(x)"),
        ),
        ("while True:", "  if get_standard_digital_in(0):", "    x = 1", "  end", "  textmsg(x)", "  sleep(1)", "end"),
        ("n = read_input_integer_register(0)", "for i in range(n):", "  x = i", "end", "textmsg(x)"),
        ("n = read_input_integer_register(0)", "for i in range(n):", "  sync()", "end", "textmsg(i)"),
        ("while get_standard_digital_in(0):", "  x = 1", "  sync()", "end", "textmsg(x)"),
        (
            *(
                "try:",
                "  q = get_inverse_kin([0.4, 0, 0.3, 3.14, 0, 0])",
                "except Exception:",
                '  textmsg("no")',
                "end",
            ),
            "movej(q)",
        ),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W257"]


@pytest.mark.parametrize(
    "lines",
    [
        ("if get_standard_digital_in(0):", "  x = 1", "else:", "  x = 2", "end", "textmsg(x)"),
        ("x = 0", "if get_standard_digital_in(0):", "  x = 1", "end", "textmsg(x)"),
        ("a = get_standard_digital_in(0)", "if a:", "  x = 1", "end", "if a:", "  textmsg(x)", "end"),
        (
            "first = True",
            "for i in range(3):",
            "  if first:",
            "    x = 1",
            "    first = False",
            "  end",
            "  textmsg(x)",
            "end",
        ),
        ("if not get_standard_digital_in(0):", "  halt()", "else:", "  x = 1", "end", "textmsg(x)"),
        (
            "m = read_input_integer_register(0)",
            *("if m == 1:", "  x = 1", "elif m == 2:", "  x = 2", "else:", "  halt()", "end", "textmsg(x)"),
        ),
        (
            "n = read_input_integer_register(0)",
            "if n > 0:",
            "  for i in range(n):",
            "    x = i",
            "  end",
            "  textmsg(x)",
            "end",
        ),
        ("for i in range(3):", "  x = i", "end", "textmsg(x)"),
        ("while not get_standard_digital_in(0):", "  sync()", "end", "x = 1", "textmsg(x)"),
        (
            *("n = read_input_integer_register(0)", "for i in range(n):", "  x = i", "else:", "  x = 0", "end"),
            "textmsg(x)",
        ),
        (
            *("try:", "  q = get_inverse_kin([0.4, 0, 0.3, 3.14, 0, 0])", "except Exception:", "  halt()", "end"),
            "movej(q)",
        ),
        (
            *("try:", "  q = get_inverse_kin([0.4, 0, 0.3, 3.14, 0, 0])", "except Exception:"),
            *("  q = get_target_joint_positions()", "end", "movej(q)"),
        ),
        (
            *("ok = True", "try:", "  q = get_inverse_kin([0.4, 0, 0.3, 3.14, 0, 0])", "except Exception:"),
            *("  ok = False", "end", "if ok:", "  movej(q)", "end"),
        ),
        ("side = 'L'", "if side == 'L':", "  x = 1", "elif side == 'R':", "  x = 2", "end", "textmsg(x)"),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W257" not in [problem.split()[0] for problem in body(*lines)]
