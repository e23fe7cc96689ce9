from __future__ import annotations

import pytest

from tests.lint.checking import body, only


@pytest.mark.parametrize(
    "lines",
    [
        ('textmsg("a" + 3)',),
        ("for i in range(0, 1, 0.1):", "  textmsg(i)", "end"),
        ("textmsg(5 / 0)",),
        ("textmsg(3 % 0)",),
        ('textmsg("x" + read_input_integer_register(0))',),
        ("if socket_read_string() > 5:", "  halt()", "end"),
        ("textmsg(len(5))",),
        ("n = 0", 'n += "1"', "textmsg(n)"),
        ('s = "n: "', "s += 3", "textmsg(s)"),
        ('textmsg(-"3")',),
        ("for i in 5:", "  textmsg(i)", "end"),
        ("n = 3", 'textmsg(n["x"])'),
        ("p = get_target_tcp_pose()", 'textmsg(p["z"])'),
        ("p = get_target_tcp_pose()", "p[0.5] = 1", "movel(p)"),
        ("p = get_target_tcp_pose()", "d = p - [0, 0, 0.1, 0, 0, 0]", "textmsg(d)"),
        ("p = get_target_tcp_pose()", "movel(p + 0.1)"),
        ("p = get_target_tcp_pose()", "textmsg(p.x)"),
        ("s = socket_read_string()", 'if s.contains("go"):', "  sync()", "end"),
        ("a = [1]", "a.push(2)"),
        ("t = (1, 2)", "t[0] = 3", "textmsg(t)"),
        ('s = "ab"', 's[0] = "c"', "textmsg(s)"),
        ("textmsg(float([1, 2]))",),
        ("r = socket_read_ascii_float(3)", "textmsg(int(r))"),
        ('textmsg(",".join(get_target_tcp_pose()))',),
        ('textmsg(sum(["1", "2"]))',),
        ("n = 0", "textmsg(10 / n)"),
        ("a = [1]", "textmsg(a.length)"),
        ("x = get_standard_analog_in(0)", "if x > 0.5 & get_flag(1):", "  sync()", "end"),
        ("textmsg(get_standard_analog_in(0) ^ 3)",),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W264"]


@pytest.mark.parametrize(
    "lines",
    [
        ('textmsg("a" + str(3))',),
        ('textmsg("=" * 20)',),
        ('textmsg("%d parts" % 3)',),
        ("n = 0", "if n > 0:", "  textmsg(5 / n)", "end"),
        ("try:", '  textmsg("a" + 3)', "except:", '  textmsg("no")', "end"),
        ("textmsg([1] + [2])",),
        ('s = "n: "', "s += str(3)", "n = 1", "n += 0.5", "n *= 2", "textmsg(s, n)"),
        ("l = [1]", "l += (2,)", "textmsg(l)"),
        ("for c in 'abc':", "  textmsg(c)", "end", "d = {'x': 1}", "textmsg(d['x'])"),
        ("textmsg(-True)", "textmsg(not 'a')"),
        ("textmsg(True + 1)",),
        ("a = [1]", "a.append(2)", 's = "x"', "textmsg(a.copy(), s.strip().upper(), (1.5).is_integer())"),
        ("textmsg(float(3), int('4'), sum([1, 2]), ','.join(['a']), ','.join(map(str, [1])))",),
        ("n = 0", "for i in range(3):", "  n = n + 1", "  textmsg(10 / n)", "end"),
        ('s = "x"', 'if hasattr(s, "decode"):', "  textmsg(s.decode())", "end"),
        ("n = read_input_integer_register(0)", "textmsg(n & 3, n | 4, n ^ 1, n << 2, get_flag(0) & get_flag(1))"),
        ("class Box:", "  def push(self, x):", "    textmsg(x)", "b = Box()", "b.push(1)"),
        ("for i in range(len([1, 2])):", "  textmsg(i)", "end"),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W264" not in [problem.split()[0] for problem in body(*lines)]


@pytest.mark.parametrize(
    ("line", "text", "hint"),
    [
        ("textmsg([1].length)", "`[1]` is", "len([1]) is how many there are"),
        ("textmsg(0.5 & get_flag(0))", None, "`and` and `or` join conditions"),
        ("textmsg(range(4.0))", "range takes whole numbers, and `4.0` is", "write 4"),
        (
            "textmsg(serial_read(4, False) > 2)",
            None,
            "x.decode() makes a text of bytes, and to_num(...) a number of that",
        ),
    ],
)
def test_the_hint_says_what_to_write(line, text, hint):
    problem = only(f"def job():\n  {line}\nend\n")
    assert problem.hint == hint
    assert text is None or problem.text.startswith(text)
