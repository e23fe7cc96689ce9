"""What turns of loops and callers give to commands is judged like what is written at the command."""

from __future__ import annotations

import pytest

from tests.lint.checking import body, found, problems

ADD = 'modbus_add_signal("10.0.0.5", 255, 0, 3, "s")'


@pytest.mark.parametrize(
    ("lines", "places"),
    [
        (("for v in [5, 70000]:", '  modbus_set_output_register("s", v)'), ["W268 3:16"]),
        (("for n, v in [('s', 5), ('s', 70000)]:", "  modbus_set_output_register(n, v)"), ["W268 3:32"]),
        (("for s in [['s', 5], ['s', 70000]]:", "  modbus_set_output_register(s[0], s[1])"), ["W268 3:29"]),
        (
            ("values = [5, 70000]", "for v in values:", '  modbus_set_output_register("s", v)'),
            ["W268 3:16"],
        ),
        (("def put(v):", '  modbus_set_output_register("s", v)', "put(5)", "put(70000)"), ["W268 6:7"]),
        (("def put(v):", '  modbus_set_output_register("s", v)', "put(5)", "put(v=70000)"), ["W268 6:9"]),
        (
            ("def put(v):", '  modbus_set_output_register("s", v)', "put(5)", "h = start_thread(put, (70000,))"),
            ["W268 6:26"],
        ),
        (("def put(f, v):", "  f('s', v)", "put(modbus_set_output_register, 5)", "put(modbus_set_output_signal, True)"),
         ["W249 4:7"]),
        (("def put(v):", '  modbus_set_output_register("s", v)', "for v in [5, 70000]:", "  put(v)"), ["W268 5:16"]),
        (("put = modbus_set_output_signal", 'put("s", True)'), ["W249 4:7"]),
        (("for q in [[0, 0, 0, 0, 0, 0], [90, 0, 0, 0, 0, 0]]:", "  movej(q)"), ["W230 3:34"]),
        (("for t in [1, 2000]:", "  movej([0, 0, 0, 0, 0, 0], t=t)"), ["W244 3:16"]),
        (("for x in [0.1, 400]:", "  movel([x, 0.2, 0.3, 0, 3.14, 0])"), ["W231 3:18"]),
    ],
    ids=str,
)  # fmt: skip
def test_what_certainly_arrives_is_judged_where_it_is_written(lines, places):
    assert body(ADD, *lines) == places


@pytest.mark.parametrize(
    "lines",
    [
        ("for v in [5, 70000]:", "  if v < 65536:", '    modbus_set_output_register("s", v)'),
        ("for v in [5, 70000]:", "  if v > 65535: continue", '  modbus_set_output_register("s", v)'),
        ("for v in [5, 70000]:", "  v = v % 65536", '  modbus_set_output_register("s", v)'),
        ("values = [5, 70000]", "values[1] = 7", "for v in values:", '  modbus_set_output_register("s", v)'),
        ("def put(v):", "  if v > 65535: return", '  modbus_set_output_register("s", v)', "put(5)", "put(70000)"),
        ("def put(v):", "  v = v % 65536", '  modbus_set_output_register("s", v)', "put(5)", "put(70000)"),
        ("def put(v):", '  x = 0 if v > 65535 else modbus_set_output_register("s", v)', "put(5)", "put(70000)"),
        ("for v in [5, '6']:", "  try:", "    sleep(v)", "  except Exception:", "    pass"),
        ("f = sleep if get_flag(0) else textmsg", "f('x')"),
        ("for v in []:", '  modbus_set_output_register("s", v)'),
    ],
    ids=str,
)
def test_what_may_not_arrive_is_left_alone(lines):
    assert [problem for problem in body(ADD, *lines) if not problem.startswith(("W203", "W215"))] == []


def test_one_cause_is_one_finding():
    lines = ("def put(v):", "  modbus_set_output_register('s', v)", "put(70000)", "put(80000)")
    assert body(ADD, *lines) == ["W268 4:37"]


def test_the_hint_says_where_the_value_goes():
    text = f"def job():\n  {ADD}\n  for v in [5, 70000]:\n    modbus_set_output_register('s', v)\n  end\nend\n"
    (problem,) = problems(text)
    assert problem.hint == "4464 is sent; it gets there in line 4"


def test_many_turns_and_callers_end():
    nested = [f"{'  ' * n}for v{n} in [1, 2, 3, 4, 5, 6]:" for n in range(8)]
    assert body(*nested, f"{'  ' * 8}sleep(v1 + v7)") == []
    calls = "".join(f"  def f{n}(x):\n    f{n - 1}(x)\n    f{n - 1}(x + 1)\n  end\n" for n in range(1, 12))
    assert found(f"def job():\n  def f0(x):\n    sleep(x)\n  end\n{calls}  f11(1)\nend\n") == []
