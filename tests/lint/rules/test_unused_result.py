from __future__ import annotations

import pytest

from tests.lint.checking import body, only


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        (("get_flag(0)",), ["W219 2:3"]),
        (("get_actual_tcp_pose()",), ["W219 2:3"]),
        (("p = get_actual_tcp_pose()", "pose_trans(p, p)"), ["W219 3:3"]),
        (("read_input_integer_register(0)",), ["W219 2:3"]),
        (("str_cat('a', 'b')",), ["W219 2:3"]),
        (("import math", "math.sin(1)"), ["W219 3:3"]),
        (("n = [2, 1]", "sorted(n)"), ["W219 3:3"]),
        (("str_cat('a', str(get_flag(0)))",), ["W219 2:3"]),
        (("n = 1", "n + 1"), ["W219 3:3"]),
        (("n = 1", "-n"), ["W219 3:3"]),
        (("n = 1 +", "  2"), None),
        (("n = 1", "+ 2"), ["W219 3:3"]),
    ],
)
def test_results_that_nothing_uses_are_found(lines, expected):
    findings = body(*lines)
    assert findings == expected if expected else "W219" not in str(findings)


@pytest.mark.parametrize(
    "lines",
    [
        ("socket_read_string()",),
        ("modbus_send_custom_command('10.0.0.1', 1, 6, [1])",),
        ("random()",),
        ("len([socket_open('10.0.0.1', 5000)])",),
        ("any(set_flag(n, True) for n in range(3))",),
        ("list(map(textmsg, [1, 2]))",),
        ("zero_ftsensor()",),
        ("halt()",),
        ("def get_part():", "  return socket_read_string()", "end", "get_part()"),
        ("gripper = rpc_factory('xmlrpc', 'http://127.0.0.1:9')", "gripper.get_state()"),
        ("n = []", "n.sort()"),
        ("n = [1]", "n.pop()"),
        ("try:", "  int('x')", "except ValueError:", "  sync()"),
        ("try:", "  get_inverse_kin([2, 0, 0, 0, 0, 0])", "except Exception:", "  textmsg('out of reach')"),
        ("class Log:", "  def __lshift__(self, text):", "    textmsg(text)", "log1 = Log()", "log1 << 'a'"),
        ("def f():", "  sync()", "  return 1", "end", "f() + 1"),
    ],
    ids=str,
)
def test_calls_that_do_something_or_ask_are_left_alone(lines):
    assert body(*lines) == []


def test_the_called_name_is_in_the_message():
    problem = only("def job():\n  pose_inv([0, 0, 0, 0, 0, 0])\nend\n")
    assert problem.text == "`pose_inv` only gives a value, and this line does not use it"
    assert problem.hint == "write x = pose_inv(...), or remove the line"
