from __future__ import annotations

import sys

import pytest

from tests.lint.checking import body, marked, only


@pytest.mark.parametrize(
    ("lines", "place", "version"),
    [
        (("match 2:", "  case 2:", "    textmsg(1)"), "2:3", "3.10"),
        (("with (open('a') as f, open('b') as g):", "  textmsg([f, g])"), "2:3", "3.9"),
        (("with (open('a') as f):", "  textmsg(f)"), "2:3", "3.9"),
        (("with (", "    open('a') as f,  # one :", "    open('b'),", "):", "  textmsg(f)"), "2:3", "3.9"),
        (("def f(x: list[int]):", "  return x", "f([1])"), "2:12", "3.9"),
        (("def f(x: int | None = None):", "  return x", "f()"), "2:12", "3.10"),
        (("class Box:", "  x: list[int] = []", "Box()"), "3:8", "3.9"),
        (("x = list[int]", "textmsg(x)"), "2:7", "3.9"),
        (("d = [abs]", "@d[0]", "def f(x):", "  return x", "textmsg(f)"), "3:4", "3.9"),
    ],
    ids=str,
)
def test_newer_syntax_is_found_with_its_version(lines, place, version):
    assert body(*lines) == [f"W212 {place}"]
    text = "def job():\n" + "".join(f"  {line}\n" for line in lines) + "end\n"
    assert f"Python {version};" in only(text).text


@pytest.mark.parametrize(
    "lines",
    [
        ("with open('a') as f, open('b') as g:", "  textmsg([f, g])"),
        ("with (open('a')) as f, (open('b')) as g:", "  textmsg([f, g])"),
        ("with (open('a')):", "  pass"),
        ("with (open('a')), open('b'):", "  pass"),
        ("if (n := 3) > 2:", "  textmsg(n)"),
        ("def f(a, /, b, *, c):", "  return f'{a=} {b!r:>{c}}'", "f(1, 2, c=3)"),
        ("d = {'a': [1]}", "textmsg(f\"{d['a'][0]:.2f}\")"),
        ("list = {1: 2}", "textmsg(list[1])"),
        ("x: list[int] = [1]", "y: int | None = None", "textmsg([x, y])"),
        ("x = 6 | 1", "textmsg(x)"),
        ("import functools", "@functools.lru_cache(None)", "def f(x):", "  return x", "f(1)"),
        ("x = (1,", "  2)", "match = x", "textmsg(match)"),
    ],
    ids=str,
)
def test_older_syntax_is_left_alone(lines):
    assert body(*lines) == []


def test_the_header_is_underlined():
    assert marked("def job():\n  match 2:  \n    case 2:\n      textmsg(1)\nend\n") == "match 2:"


@pytest.mark.skipif(sys.version_info < (3, 12), reason="older Pythons do not read such strings")
@pytest.mark.parametrize("string", ["f'{d['a']}'", "f'{\"\\n\".join(d)}'", 'f"{f"{1}"}"'])
def test_formatted_strings_of_newer_pythons_are_found(string):
    assert body("d = {'a': 1}", f"textmsg({string})") == ["W212 3:11"]
