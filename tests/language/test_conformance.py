"""The rules of the language that need no robot: structure, names and scope."""

from __future__ import annotations

import pytest

from elitescript.language.options import SCRIPT, Options
from tests.language.stage import Stage, Stopped

SCOPE = {
    "a nested function makes a local": (
        "def a():\n  global level\n  level = 7\n  def mix(u, w):\n    level = u * w\n    textmsg('in ', level)\n"
        "    return level\n  end\n  mix(4, 5)\n  textmsg('out ', level)\nend",
        ["in 20", "out 7"],
        {"level": 7},
    ),
    "global is shared": (
        "def a():\n  global n, m\n  n = 1\n  m = 1\n  def bump():\n    global n\n    n = n + 1\n    m = 99\n  end\n"
        "  bump()\n  bump()\n  textmsg(n)\n  textmsg(m)\nend",
        ["3", "1"],
        {"n": 3, "m": 1},
    ),
    "a constant of the body is read without global": (
        "def a():\n  RATIO = 1000000\n  def scale(v):\n    return v / RATIO\n  end\n  textmsg(scale(2500000))\nend",
        ["2.5"],
        {},
    ),
    "a nested global does not reach a local of the body": (
        "def a():\n  c = 1\n  def f():\n    global c\n    c = 2\n  end\n  f()\n  textmsg(c)\nend",
        ["1"],
        {"c": 2},
    ),
    "nonlocal": (
        "def a():\n  c = 1\n  def f():\n    nonlocal c\n    c = 2\n  end\n  f()\n  textmsg(c)\nend",
        ["2"],
        {},
    ),
    "a declaration in the middle": (
        "def a():\n  textmsg('start')\n  global Loop_1\n  Loop_1 = 0\n  while Loop_1 < 2:\n    Loop_1 = Loop_1 + 1\n"
        "  end\n  textmsg(Loop_1)\nend",
        ["start", "2"],
        {"Loop_1": 2},
    ),
    "a declaration twice": ("def a():\n  global u\n  global u\n  u = 3\n  textmsg(u)\nend", ["3"], {"u": 3}),
    "an unknown name that is never reached": (
        "def a():\n  if False:\n    unconfigured\n    null\n  end\n  textmsg('ran')\nend",
        ["ran"],
        {},
    ),
    "lists are references": (
        "def a():\n  a1 = [1, 2, [3]]\n  b = a1\n  c = a1.copy()\n  d = copy.deepcopy(a1)\n  a1.append(4)\n"
        "  a1[2].append(9)\n  textmsg(b)\n  textmsg(c)\n  textmsg(d)\nend",
        ["[1, 2, [3, 9], 4]", "[1, 2, [3, 9]]", "[1, 2, [3]]"],
        {},
    ),
    "a bare script": (
        "global level\nlevel = 7\ndef mix(u, w):\n    level = u * w\n    return level\nmix(1, 2);\ntextmsg(level)\n",
        ["7"],
        {"level": 7},
    ),
    "names of a bare script are local": ("x = 1\ndef f():\n  textmsg(x)\nf()\n", ["1"], {}),
    "several functions make a bare script": (
        "def one():\n  textmsg(1)\nend\ndef two():\n  one()\n  textmsg(2)\nend\ntwo()\n",
        ["1", "2"],
        {},
    ),
    "several functions, none called": ("def one():\n  textmsg(1)\nend\ndef two():\n  textmsg(2)\nend\n", [], {}),
    "arguments": (
        "def a():\n  def f(name, age=35, *rest):\n    textmsg('{} {} {}'.format(name, age, rest))\n  end\n"
        "  f('a')\n  f(age=50, name='b')\n  f('c', 1, 2, 3)\nend",
        ["a 35 ()", "b 50 ()", "c 1 (2, 3)"],
        {},
    ),
    "parameters of the program have their defaults": ("def a(x=3, *y, z=4):\n  textmsg(x, y, z)\nend", ["3()4"], {}),
    "return ends the program": ("def a():\n  textmsg(1)\n  return\n  textmsg(2)\nend", ["1"], {}),
    "return in a bare script": ("textmsg(1)\nreturn\ntextmsg(2)", ["1"], {}),
    "nothing at all": ("", [], {}),
    "functions run only when called": (
        "def outer():\n  def helper(n):\n    return n * 2\n  end\n  def unused():\n    textmsg('never')\n  end\n"
        "  textmsg(helper(21))\nend",
        ["42"],
        {},
    ),
}
PYTHON = {
    "loops with else": (
        "def a():\n  n = 0\n  while n < 2:\n    n += 1\n  else:\n    textmsg('done ', n)\n  end\n"
        "  for k in [3, 4]:\n    if k == 4:\n      break\n  else:\n    textmsg('never')\n  end\nend",
        ["done 2"],
    ),
    "semicolons": (
        "def a():\n  x = 1; y = 2; textmsg(x + y);\n  def f(): return 5;\n  textmsg(f());\nend",
        ["3", "5"],
    ),
    "continuation lines": (
        "def a():\n  total = 1 + \\\n      2 + \\\n      3\n  q = [0.0,\n       -1.5,\n  1.5]\n"
        "  textmsg(total, len(q))\nend",
        ["63"],
    ),
    "one-blank indentation": ("def a():\n for k in [1,2]:\n  textmsg(k)\nend\n", ["1", "2"]),
    "names in every script": ("def 任务():\n  温度 = 25\n  textmsg('온도=', 温度)\nend", ["온도=25"]),
    "numbers": (
        "textmsg(86400000000000 * 10)\ntextmsg(7 / 2, ' ', 7 // 2, ' ', -7 % 3, ' ', 2 ** 10)\ntextmsg(0x69, 0o12)",
        ["864000000000000", "3.5 3 2 1024", "10510"],
    ),
    "formats": (
        "x = 1.5\ntextmsg(f\"{x:.2f} {'a'}\")\ntextmsg('%d-%s' % (3, 'b'))\ntextmsg((4.53e-7j) == complex(0, 4.53e-7))",
        ["1.50 a", "3-b", "True"],
    ),
    "exceptions": (
        "def a():\n  try:\n    x = 1 / 0\n  except ZeroDivisionError as e:\n    textmsg('caught')\n  finally:\n"
        "    textmsg('finally')\n  end\nend",
        ["caught", "finally"],
    ),
    "classes and generators": (
        "def a():\n  class Box:\n    def __init__(self, v):\n      self.v = v\n    end\n    def twice(self):\n"
        "      return self.v * 2\n    end\n  end\n  class Named(Box):\n    def __init__(self, v):\n"
        "      super().__init__(v)\n      self.name = 'n'\n  b = Named(4)\n  textmsg(b.twice())\n"
        "  textmsg(sum(i * i for i in range(4)))\n  textmsg('yes' if b.v > 3 else 'no')\n  f = lambda t: t + 1\n"
        "  textmsg(f(1))\nend",
        ["8", "14", "yes", "2"],
    ),
}


@pytest.mark.parametrize(("text", "out", "values"), SCOPE.values(), ids=SCOPE)
def test_scope(text, out, values):
    stage = Stage()
    stage.run(text)
    assert (stage.out, stage.globals) == (out, values)


@pytest.mark.parametrize(("text", "out"), PYTHON.values(), ids=PYTHON)
def test_python(text, out):
    stage = Stage()
    stage.run(text)
    assert stage.out == out


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("def a():\n  global k\n  k = 5\n  def f():\n    k = k + 1\n  end\n  f()\nend", UnboundLocalError),
        (
            "def a():\n  len = 3\n  def f(time, list=None):\n    return len + time\n  end\n  f(1)\n  len([1])\nend",
            TypeError,
        ),
        ("def func():\n\ttextmsg(1)\n\tabcd(123)\nend", NameError),
        ("target = p[0.4, 0, 0.3]", NameError),
        ("x = [1, 2, 3]\nx[5]", IndexError),
    ],
)
def test_failures_are_pythons(text, error):
    with pytest.raises(error):
        Stage().run(text)


def test_a_file_with_one_function_runs_it_unless_it_is_part_of_a_program():
    text = "def main():\n  textmsg(1)\nend"
    alone, inlined = Stage(), Stage()
    alone.run(text)
    inlined.run(text, Options(kind=SCRIPT))
    assert (alone.out, inlined.out) == (["1"], [])


def test_a_stop_passes_every_handler():
    stage = Stage(work=50)
    text = (
        "def a():\n  while True:\n    try:\n      while True:\n        pass\n"
        "    except:\n      textmsg('swallowed')\n    end\n  end\nend"
    )
    with pytest.raises(Stopped):
        stage.run(text)
    assert stage.out == []
