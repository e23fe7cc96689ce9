"""What expressions are, in words."""

from __future__ import annotations

import ast

import pytest

from elitescript.language.parser import parse
from elitescript.language.symbols import Symbols
from elitescript.language.text.source import SourceFile
from elitescript.messages.profile import Profile, profile
from elitescript.records import replace
from elitescript.values.description import FLOAT, INT, UNKNOWN, Value, holds
from elitescript.values.program import Values
from elitescript.values.words import words

NEWEST = profile()


def described(text: str, firmware: Profile = NEWEST) -> Value:
    """What the last argument of the last `textmsg` is."""
    symbols = Symbols(parse(SourceFile("<test>", text)))
    values = Values(symbols, profile=firmware)
    assert values.is_known
    calls = [call for scope in symbols.scopes for call in scope.calls if ast.unparse(call.func) == "textmsg"]
    last = max(calls, key=lambda call: (call.lineno, call.col_offset))
    return values.of(last.args[-1])


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("get_actual_joint_positions()", "joint positions, measured"),
        ("get_target_tcp_pose()", "pose in the base frame, commanded"),
        ("get_actual_tcp_pose()[0]", "float m, measured"),
        ("get_actual_tcp_pose()[4]", "float rad, measured"),
        ("get_inverse_kin(get_actual_tcp_pose())", "joint positions, measured"),
        ("get_standard_digital_in(0)", "bool, a signal"),
        ("read_input_integer_register(1)", "int -2147483648…2147483647, a signal"),
        ("modbus_get_signal_status('a')", "bool or int or list, a signal, may have no value yet"),
        ("socket_read_string()", "str, sent by a peer"),
        ("socket_read_ascii_float(3)", "list of 4, first element: how many, sent by a peer"),
        ("socket_read_ascii_float(3)[0]", "count, sent by a peer"),
        ("socket_read_byte_list(3)[2]", "int -1…255, sent by a peer"),
        ("str_find(socket_read_string(), 'a')", "position or -1 (not found)"),
        ("sin(get_actual_joint_positions()[0])", "float -1…1, measured"),
        ("len([1, 2, 3])", "3"),
        ("socket_open('a', 1)", "bool"),
        ("start_thread(movej, ())", "thread handle"),
        ("to_num('1')", "1"),
        ("to_num(socket_read_string())", "int or float"),
        ("tool_serial_read(2, True, 1)", "bytes or list, sent by a peer"),
        ("pose_trans(get_actual_tcp_pose(), [0, 0, 0.1, 0, 0, 0])", "pose in the base frame, measured"),
        ("pose_trans([0, 0, 0.1, 0, 0, 0], get_actual_tcp_pose())", "pose, measured"),
        ("pose_trans(p_from_to=[0, 0, 0.1, 0, 0, 0], p_from=get_forward_kin())", "pose in the base frame"),
        ('path_offset_get("base")', "pose, commanded"),
        ("get_tcp_force()", "list of 6 N, Nm, measured"),
        ("get_actual_tcp_pose()[2]", "float m, measured"),
        ("get_actual_joint_positions() == 1", "False"),
        ("socket_read_string() == 1", "False"),
        ("get_controller_temperature() + 1", "float degC, measured"),
        ("'%d' % 3", "str"),
        ("[x * 2 for x in range(3)]", "list of 3"),
        ("{'a': [1, 2]}['a']", "list of 2"),
        ("1 if get_flag(0) else None", "1 or None"),
        ("get_flag(0) and 3", "False or 3"),
        ("nowhere", ""),
        ("max(1, 2.5)", "2.5"),
        ("abs(get_actual_tcp_pose()[0])", "float m, measured"),
        ("print(1)", "None"),
        ("lambda x: x", "function"),
    ],
)
def test_expressions(expression, expected):
    assert words(described(f"textmsg({expression})")) == expected


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        # Branches join, and conditions narrow.
        ("x = None\nif get_flag(0):\n  x = 1\nend\ntextmsg(x)", "1 or None"),
        ("x = None\nif get_flag(0):\n  x = 1\nend\nif x is None:\n  return\nend\ntextmsg(x)", "1"),
        ("x = None\nif get_flag(0):\n  x = 1\nend\nwhile x != None:\n  textmsg(x)\nend", "1"),
        ("x = None\nif get_flag(0):\n  x = [1]\nend\nif x:\n  textmsg(x)\nend", "list of 1"),
        ("i = str_find('a', socket_read_string())\nif i != -1:\n  textmsg(i)\nend", "int >= 0"),
        ("i = str_find('a', socket_read_string())\nif i >= 0 and i < 4:\n  textmsg(i)\nend", "int 0…3"),
        ("i = str_find('a', socket_read_string())\nif i < 0:\n  textmsg(i)\nend", "-1"),
        ("x = nowhere\nif isinstance(x, (int, float)):\n  textmsg(x)\nend", "bool or int or float or object"),
        ("x = nowhere()\nif type(x) == int:\n  textmsg(x)\nend", ""),
        ("a = socket_read_ascii_float(3)\nif a[0] == 3:\n  textmsg(a[0])\nend", "3, sent by a peer"),
        ("a = get_all_inverse_kin(get_actual_tcp_pose())\nif len(a) == 2:\n  textmsg(a)\nend", "list of 2"),
        # What is never true changes nothing.
        ("x = 1\nif x == 2:\n  textmsg(x)\nend", "1"),
        ("x = 1\nif x is None:\n  textmsg(x)\nend", "1"),
        # Loops reach a fixpoint.
        ("n = 0\nwhile get_flag(0):\n  n += 1\nend\ntextmsg(n)", "int >= 0"),
        ("n = 0\nfor i in range(100):\n  textmsg(i)\nend", "int 0…99"),
        ("n = 0\nwhile n < 10:\n  textmsg(n)\n  n += 1\nend", "int 0…9"),
        ("x = 1\nwhile True:\n  if get_flag(0):\n    break\n  end\n  x = 2\nend\ntextmsg(x)", "1 or 2"),
        ("x = 1\nfor i in range(3):\n  if get_flag(0):\n    continue\n  end\n  x = 2\nend\ntextmsg(x)", "1 or 2"),
        # An exception may come at any point.
        ("x = 1\ntry:\n  x = 2\n  sync()\n  x = 3\nexcept Exception:\n  textmsg(x)\nend", "1 or 2 or 3"),
        (
            "x = 1\ntry:\n  if get_flag(0):\n    x = 2\n    sync()\n    x = 3\n  end\nfinally:\n  textmsg(x)\nend",
            "3 or 1 or 2",
        ),
        # Functions by summary.
        ("def f(a):\n  return a * 2\nend\ntextmsg(f(1))", "2"),
        ("def f(a):\n  return a * 2\nend\nf(5)\ntextmsg(f(1))", "10 or 2"),
        ("def f(a):\n  if a > 0:\n    return f(a - 1)\n  end\n  return 0\nend\ntextmsg(f(9))", "0"),
        ("def f(a):\n  if a > 0:\n    return a\n  end\nend\ntextmsg(f(9))", "9 or None"),
        ("def f(a, b=2):\n  textmsg(b)\nend\nf(1)\nf(1, b=4)", "2 or 4"),
        ("def g(f):\n  return f(1)\nend\ndef h(x):\n  textmsg(x)\nend\ng(h)", ""),
        ("def work(a):\n  textmsg(a)\nend\nstart_thread(work, (7,))", "7"),
        ("def numbers():\n  yield 1\nend\nfor n in numbers():\n  textmsg(n)\nend", ""),
        # Closures, `nonlocal`, `global`: the join of all that is written.
        ("n = 0\ndef f():\n  nonlocal n\n  n = 5\nend\nstart_thread(f)\ntextmsg(n)", "0 or 5"),
        ("n = 0\ndef f():\n  textmsg(n)\nend\nf()\nn = 5\nf()", "0 or 5"),
        ("global n\nn = 0\ndef f():\n  global n\n  n = 'a'\nend\ntextmsg(n)", "0 or 'a'"),
        ("global n\ntextmsg(n)", ""),
        ("global n\nn = 1\nexec('n = 2')\ntextmsg(n)", ""),
        ("n = 1\ninterpreter_mode()\ntextmsg(n)", ""),
        ("def f(a):\n  textmsg(a)\nend\nf(1)\neval('f(2)')", ""),
        ("a = [1]\neval('a.append(2)')\ntextmsg(a)", "list"),
        # Lists.
        ("p = get_actual_tcp_pose()\np[2] = p[2] + 0.1\ntextmsg(p)", "pose in the base frame"),
        ("p = get_actual_tcp_pose()\nfor i in range(6):\n  p[i] = 0\nend\ntextmsg(p)", "list of 6"),
        ("a = []\na.append(1)\na.append('b')\ntextmsg(a[get_flag(0)])", "1 or 'b'"),
        ("a = []\ndef add(x):\n  a.append(x)\nend\nadd(1)\nfor x in a:\n  textmsg(x)\nend", "1"),
        ("a, b = get_actual_tcp_pose(), 2\ntextmsg(a)", "pose in the base frame, measured"),
        ("for n, p in enumerate([[1], [2]]):\n  textmsg(p)\nend", "list of 1"),
        ("x, *y = [1, 2, 3]\ntextmsg(y)", "list"),
        ("a = [1, 2]\nb = a[:]\nb.append(3)\ntextmsg(a)", "list of 2"),
        # Endless nesting, and lists that hold themselves.
        ("a = 1\nwhile get_flag(0):\n  a = [a]\nend\ntextmsg(a)", "int or list"),
        ("a = [1]\na.append(a)\ntextmsg(a)", "list"),
    ],
)
def test_programs(lines, expected):
    body = "".join(f"  {line}\n" for line in lines.split("\n"))
    found = words(described(f"def job():\n{body}end\n"))
    if not expected:
        assert found in ("", "object")
    else:
        assert found == expected


def test_what_is_nested_too_deep_is_unknown_and_takes_no_time():
    text = "x = [1] * 200\n" + "x = [x] * 200\n" * 20 + "textmsg(x)\n"
    assert described(text).kinds
    symbols = Symbols(
        parse(SourceFile("<test>", "if get_flag(0):\n" * 0 + "y = 1\ntextmsg(" + "(-" * 180 + "y" + ")" * 181))
    )
    values = Values(symbols)
    assert not values.is_known
    assert all(values.of(node) is UNKNOWN for node in ast.walk(symbols.parsed.tree) if isinstance(node, ast.expr))


def test_a_long_chain_of_branches_is_not_deep():
    text = (
        "x = nowhere\nif x == 0:\n  y = 0\n" + "".join(f"elif x == {n}:\n  y = {n}\n" for n in range(1, 400)) + "end\n"
    )
    assert words(described(text + "textmsg(y)")) == "int 0…399"


@pytest.mark.parametrize(
    ("expression", "real", "is_held"),
    [
        ("get_actual_joint_positions()", [0.0] * 6, True),
        ("get_actual_joint_positions()", [0.0] * 5, False),
        ("get_actual_joint_positions()", (0.0,) * 6, False),
        ("get_flag(0)", True, True),
        ("get_flag(0)", 1, False),
        ("socket_read_byte_list(1)", [1, 255], True),
        ("socket_read_byte_list(1)", [1, 256], False),
        ("socket_read_ascii_float(1)", [0, float("nan")], True),
        ("sin(get_steptime())", float("nan"), False),
        ("nowhere", object(), True),
    ],
)
def test_a_description_holds_what_it_says(expression, real, is_held):
    assert holds(described(f"textmsg({expression})"), real) is is_held


@pytest.mark.parametrize(
    ("expression", "whole", "real"),
    [
        ("pow(2, 3)", "8", "8.0"),
        ("pow(2, 0.5)", "1.4142135623730951", "1.4142135623730951"),
    ],
)
def test_powers_are_described_as_the_profile_has_them(expression: str, whole: str, real: str) -> None:
    for firmware, expected in ((NEWEST, whole), (replace(NEWEST, are_powers_whole=False), real)):
        text = f"def probe(n):\n  textmsg({expression})\nend\n"
        assert words(described(text, firmware)) == expected


def test_the_power_of_an_unknown_number_is_whole_or_not() -> None:
    assert described("textmsg(pow(2, read_input_integer_register(0)))\n").kinds == INT | FLOAT
