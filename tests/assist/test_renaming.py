"""Renames: what changes, what is refused, and that programs stay what they are."""

from __future__ import annotations

import dis
import re
import types
from random import Random
from typing import Any

import pytest

from elitescript.assist.document import Document, Settings
from elitescript.assist.names import Occurrence
from elitescript.assist.renaming import prepare_rename, rename
from elitescript.language.compiler import compile_unit
from elitescript.language.diagnostics import Edit
from elitescript.language.text.source import SourceFile
from tests.assist.random_scopes import random_scopes
from tests.assist.reading import marked
from tests.invariants.cases import CASES
from tests.language.random_programs import random_program
from tests.language.stage import Stage


def changed(text: str, new_name: str = "fresh") -> str:
    """Return the text after a rename at its mark; the reason if it is refused."""
    document, line, column = marked(text)
    result = rename(document, line, column, new_name)
    return result.refusal or with_edits(document, result.edits)


def with_edits(document: Document, edits: tuple[Edit, ...]) -> str:
    return document.edited(sorted(edits, reverse=True), 2).text


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            "def job():\n  ¦x = 1\n  textmsg('x', x)  # x\nend\n",
            "def job():\n  fresh = 1\n  textmsg('x', fresh)  # x\nend\n",
        ),
        (
            "def job():\n  n = 0\n  def f():\n    nonlocal n\n    n += 1\n    return ¦n\n  end\n  f()\nend\n",
            "def job():\n  fresh = 0\n  def f():\n    nonlocal fresh\n    fresh += 1\n"
            "    return fresh\n  end\n  f()\nend\n",
        ),
        (
            "def job():\n  global a, n\n  n = 1\n  def f():\n    textmsg(n)\n    n = 2\n    global ¦n\n"
            "  end\n  def g(n):\n    pass\n  end\nend\n",
            "def job():\n  global a, fresh\n  fresh = 1\n  def f():\n    textmsg(fresh)\n"
            "    fresh = 2\n    global fresh\n  end\n"
            "  def g(n):\n    pass\n  end\nend\n",
        ),
        (
            "def job():\n  def f(¦v, w=2):\n    return v\n  end\n  f(v=1, w=3)\n  start_thread(f, (1,))\nend\n",
            "def job():\n  def f(fresh, w=2):\n    return fresh\n  end\n  f(fresh=1, w=3)\n"
            "  start_thread(f, (1,))\nend\n",
        ),
        (
            "def job():\n  def ¦f():\n    pass\n  end\n  f()\n  start_thread(f, ())\nend\n",
            "def job():\n  def fresh():\n    pass\n  end\n  fresh()\n  start_thread(fresh, ())\nend\n",
        ),
        (
            "def job():\n  x = 1\n  y = [x for ¦x in (1, 2)]\nend\n",
            "def job():\n  x = 1\n  y = [fresh for fresh in (1, 2)]\nend\n",
        ),
        (
            "def job():\n  import ¦time\n  time.sleep(1)\nend\n",
            "def job():\n  import time as fresh\n  fresh.sleep(1)\nend\n",
        ),
        (
            "def job():\n  from math import sin as ¦s, cos\n  a = s(1)\nend\n",
            "def job():\n  from math import sin as fresh, cos\n  a = fresh(1)\nend\n",
        ),
        (
            "def job():\n  try:\n    pass\n  except (ValueError) as ¦e:\n    textmsg(e)\n  end\nend\n",
            "def job():\n  try:\n    pass\n  except (ValueError) as fresh:\n    textmsg(fresh)\n  end\nend\n",
        ),
        (
            "def job():\n  class A:\n    ¦size = 1\n    def get(self):\n      return self.size\n"
            "    end\n  end\n  A().size\nend\n",
            "def job():\n  class A:\n    fresh = 1\n    def get(self):\n      return self.fresh\n"
            "    end\n  end\n  A().fresh\nend\n",
        ),
        (
            "import math\nclass A:\n  def ¦close(self):\n    pass\n  end\nend\n"
            "a = A()\na.close()\ndef f(b):\n  b.shut()\nend\n",
            "import math\nclass A:\n  def fresh(self):\n    pass\n  end\nend\n"
            "a = A()\na.fresh()\ndef f(b):\n  b.shut()\nend\n",
        ),
        (
            "def f(¦a, /, **more):\n  return a\nend\nf(1, a=2)\n",
            "def f(fresh, /, **more):\n  return fresh\nend\nf(1, a=2)\n",
        ),
        ("def ¦job():\n  sleep(1)\nend\n", "def fresh():\n  sleep(1)\nend\n"),
        (
            "def job():\n  n = 2\n  textmsg(f'n={¦n:>{n}} é')\nend\n",
            "def job():\n  fresh = 2\n  textmsg(f'n={fresh:>{fresh}} é')\nend\n",
        ),
        (
            "def job():\n  match 1:\n    case ¦q:\n      textmsg(q)\n  end\nend\n",
            "def job():\n  match 1:\n    case fresh:\n      textmsg(fresh)\n  end\nend\n",
        ),
    ],
)
def test_a_rename_changes_all_places_and_nothing_else(text: str, expected: str) -> None:
    assert changed(text) == expected


@pytest.mark.parametrize(
    ("text", "new_name", "reason"),
    [
        ("¦x = 1\n", "2x", "is no name"),
        ("¦x = 1\n", "", "is no name"),
        ("¦x = 1\n", "while", "word of the language"),
        ("¦x = 1\n", "end", "word of the language"),
        ("¦x = 1\n", "sec", "word of the language"),
        ("¦x = 1\n", "movej", "command of the robot"),
        ("¦x = 1\n", "len", "Python has itself"),
        ("¦x = 1\n", "kill", "reserved by the robot"),
        ("¦x = 1\n", "__x", "belong to Python"),
        ("¦x = 1\n", "ﬁ", "Python reads"),
        ("¦movej([0,0,0,0,0,0])\n", "y", "`movej` is a command"),
        ("¦len([])\n", "y", "is not defined in this text"),
        ("¦while True:\n  sync()\nend\n", "y", "word of the language"),
        ("¦ # x\n", "y", "no name stands here"),
        ("x = 1\ny = 'a¦b'\n", "z", "no name stands here"),
        # It would capture, or be captured.
        ("¦x = 1\ny = 2\n", "y", "line 2 has another `y`"),
        ("¦x = 1\ntextmsg(y)\n", "y", "line 2 has another `y`"),
        ("¦x = 1\ndef f():\n  y = 2\n  return x\nend\n", "y", "line 3 has another `y`"),
        ("y = 1\ndef f():\n  ¦x = 2\n  return y\nend\n", "y", "line 4 has another `y`"),
        ("y = 1\ndef f():\n  ¦x = 2\n  def g():\n    return y\n  end\nend\n", "y", "line 5 has another `y`"),
        ("def f():\n  global ¦x\n  x = 1\n  y = 2\nend\n", "y", "line 4 has another `y`"),
        ("def f():\n  global ¦x\n  x = 1\nend\ndef g(y):\n  return x\nend\n", "y", "line 5 has another `y`"),
        ("y = 1\nz = [¦x + y for x in (1,)]\n", "y", "line 2 has another `y`"),
        ("z = [(y := x) for ¦x in (1,)]\n", "y", "line 1 has another `y`"),
        ("z = [(¦y := x) for x in (1,)]\n", "x", "line 1 has another `x`"),
        ("def f(¦a, **more):\n  pass\nend\nf(1, b=2)\n", "b", "line 4 passes an argument `b`"),
        # A use may be hidden.
        ("¦x = 1\ny = x +\n", "z", "line 2 has `x` too and cannot be read"),
        ("¦x = 1\nz = = 2\n", "z", "line 2 has `z` too and cannot be read"),
        ("def f(¦a):\n  pass\nend\nf(**{'a': 1})\n", "b", "line 4 may pass `a` by `**`"),
        ("def f(¦a):\n  pass\nend\ng = f\ng(a=1)\n", "b", "line 5 passes an argument `a`"),
        ("class A:\n  def f(self, ¦a):\n    pass\n  end\nend\nA().f(a=1)\n", "b", "line 6 passes an argument `a`"),
        ("class A:\n  ¦v = 1\nend\nclass B:\n  v = 2\nend\n", "w", "both have `v`"),
        ("class A:\n  ¦append = 1\nend\ndef f(x):\n  x.append(1)\nend\n", "w", "line 5 may use the `append`"),
        # A function may get its arguments by name from a call that does not say so.
        (
            "import functools\ndef f(¦a):\n  pass\nend\nfunctools.partial(f, a=1)()\n",
            "b",
            "line 5 passes an argument `a`",
        ),
        (
            "import functools\ndef f(¦a):\n  pass\nend\ng = functools.partial(f, **{})\n",
            "b",
            "line 5 may pass `a` by `**`",
        ),
        (
            "import threading\ndef f(¦a):\n  pass\nend\nthreading.Thread(target=f, kwargs={'a': 1}).start()\n",
            "b",
            "line 5 may pass `a` to a thread",
        ),
        ("def g(h, **more):\n  h(1)\nend\ndef f(¦a):\n  pass\nend\ng(f, a=1)\n", "b", "line 7 passes an argument `a`"),
        ("class A:\n  def f(self, ¦a):\n    pass\n  end\nend\nA().f(**{'a': 1})\n", "b", "line 6 may pass `a` by `**`"),
        ("class A:\n  def __init__(self, ¦a):\n    pass\n  end\nend\nA(**{'a': 1})\n", "b", "line 6 may pass `a` by"),
        ("(lambda ¦a: a)(**{'a': 1})\n", "b", "line 1 may pass `a` by `**`"),
        (
            "def w(g):\n  return lambda a: g(a)\nend\n@w\ndef f(¦a):\n  pass\nend\nf(a=1)\n",
            "b",
            "line 8 passes an argument",
        ),
        (
            "import math\ndef f(¦a):\n  pass\nend\nif get_time() > 1:\n  f = math.sin\nend\nf(a=1)\n",
            "b",
            "line 8 passes",
        ),
        # An attribute may be that of another object, or be named otherwise than by `.`.
        ("class A:\n  def ¦close(self):\n    pass\n  end\nend\nopen('a').close()\n", "w", "line 6 may use the `close`"),
        (
            "import threading\nclass A:\n  ¦start = 1\nend\nthreading.Thread().start()\n",
            "w",
            "line 5 may use the `start`",
        ),
        ("import datetime\nclass A:\n  ¦year = 1\nend\ndatetime.date.today().year\n", "w", "line 5 may use the `year`"),
        ("class A:\n  ¦grip = 1\nend\nrpc_factory('xmlrpc', 'x').grip()\n", "w", "line 4 may use the `grip`"),
        (
            "class A:\n  __slots__ = ('v',)\n  def __init__(self):\n    self.¦v = 1\n  end\nend\n",
            "w",
            "`__slots__` of `A`",
        ),
        ("class A:\n  ¦v = 1\nend\ntextmsg('{0.v}'.format(A()))\n", "w", "the string of line 4 may name `v`"),
        (
            "from dataclasses import dataclass\n@dataclass\nclass A:\n  ¦v: int = 1\nend\nA(v=2)\n",
            "w",
            "decorator of `A`",
        ),
        (
            "x = 1\nclass A:\n  if get_time() > 5:\n    ¦x = 2\n  end\n  y = x\nend\n",
            "w",
            "may read a `x` from outside",
        ),
        ("match 1:\n  case ¦q:\n    textmsg(q)\nend\n", "_", "stands for anything"),
        ("def f():\n  global ﬁx\n  fix = 1\nend\n¦fix = 2\n", "y", "not known exactly"),
        ("class A(B):\n  ¦v = 1\nend\n", "w", "derived"),
        ("class A:\n  ¦v = 1\n  w = 2\nend\n", "w", "there is a `w` already"),
        ("class ¦A:\n  __v = 1\nend\ntextmsg(A._A__v)\n", "w", "`_A__v` in line 4"),
        ("x = [].¦append\n", "w", "no class of this text defines"),
        ("¦x = 1\ntextmsg(locals())\n", "y", "through a string"),
        ("from math import *\n¦x = 1\n", "tau", "import *"),
        ("¦x = 1\ny = 2\ntextmsg(f'{y}{x=}')\n", "z", "line 3 prints the name `x`"),
        ("¦x = 1\ntextmsg(f'{1:{(x + 1) = !s:>9}}')\n", "z", "line 2 prints"),
        ("¦x = 1\ntextmsg(f'''{x\n=}''')\n", "z", "line 2 prints"),
        ("def f(¦x):\n  return x\nend\ntextmsg(f'{f(x=2)=}')\n", "z", "line 4 prints"),
        ("class A:\n  ¦v = 1\nend\ntextmsg(f'{A().v=}')\n", "w", "line 4 prints"),
        ("socket_open('1.2.3.4', 80, 'c¦am')\n", "y", "strings are not changed"),
    ],
)
def test_what_could_change_the_meaning_is_refused(text: str, new_name: str, reason: str) -> None:
    document, line, column = marked(text)
    result = rename(document, line, column, new_name)
    assert not result.edits
    assert reason in result.refusal


def test_a_global_that_has_its_value_from_outside_keeps_its_name() -> None:
    document, line, column = marked("global ¦speed\ntextmsg(speed)\n", Settings(presets=frozenset(("speed",))))
    assert "before the program begins" in rename(document, line, column, "v").refusal


def test_a_secondary_program_shares_its_globals() -> None:
    assert "runs beside this one" in changed("sec go():\n  global ¦n\n  n = 1\nend\n")


def test_the_same_name_changes_nothing() -> None:
    assert changed("¦x = 1\n", "x") == "x = 1\n"


def test_prepare_rename_returns_the_name_at_the_cursor() -> None:
    document, line, column = marked("speed = 1\ntextmsg(spe¦ed)\n")
    ready = prepare_rename(document, line, column)
    assert ready is not None
    assert (ready.span, ready.name, ready.refusal) == ((2, 9, 2, 14), "speed", "")
    document, line, column = marked("x = 1  # com¦ment\n")
    assert prepare_rename(document, line, column) is None


# ---------------------------------------------------------------- programs stay what they are


def programs(seed: int) -> str:
    rng = Random(seed)
    return rng.choice((random_program, random_scopes))(rng)


def code_of(text: str, names: dict[str, str]) -> Any:
    """Return all that runs of a text, with some names replaced."""

    def plain(value: Any) -> Any:
        if isinstance(value, types.CodeType):
            # Equal constants share a place, which names of keyword arguments are too: the values count.
            rows = [(step.opcode, plain(step.argval)) for step in dis.get_instructions(value)]
            named = (value.co_varnames, value.co_cellvars, value.co_freevars, value.co_name)
            return rows, [plain(row) for row in named], value.co_flags, value.co_argcount, value.co_kwonlyargcount
        if isinstance(value, tuple):
            return tuple(plain(item) for item in value)
        if isinstance(value, str):
            # Names of functions and classes are constants, such as `job.<locals>.f`; `_Box__v` is the `__v` of a `Box`.
            parts = [names.get(part, part) for part in value.split(".")]
            for new, old in names.items():
                parts = [part.replace(f"_{new}__", f"_{old}__", 1) for part in parts]
            return ".".join(parts)
        return value

    return plain(compile_unit(SourceFile("cell.script", text)).code)


def meaning(document: Document) -> list[tuple[Any, ...]]:
    """Return what each name of a text is and which ones are the same, without the names."""
    numbers: dict[Any, int] = {}

    def row(item: Occurrence) -> tuple[Any, ...]:
        outside = item.entity.name if item.entity.kind in ("outside", "string") else ""
        number = numbers.setdefault(item.entity, len(numbers))
        return item.entity.kind, number, outside, item.access, item.role

    return [row(item) for item in document.names.occurrences]


def shown(text: str) -> list[str]:
    stage = Stage()
    try:
        stage.run(text)
    except Exception as error:
        stage.out.append(type(error).__name__)
    # Errors name the variables that have no value, classes and functions their names.
    return [re.sub(r"'\w+'|(?<=<locals>\.)\w+|0x\w+", "...", row) for row in stage.out]


def test_a_new_name_leaves_the_compiled_code_as_it_is() -> None:
    done = 0
    for seed in range(CASES // 3):
        rng = Random(seed)
        text = programs(seed)
        document = Document("cell.script", text)
        code = code_of(text, {})
        for item in rng.sample(document.names.occurrences, min(6, len(document.names.occurrences))):
            old = item.entity.name
            # It is sorted where the old one is: cells of a function are numbered in the order of their names.
            result = rename(document, item.span.line, item.span.column, f"{old}_")
            if not result.refusal:
                assert result.edits
                assert code_of(with_edits(document, result.edits), {f"{old}_": old}) == code, (seed, item)
                done += 1
    assert done >= CASES // 3


def test_a_name_in_a_formatted_string_that_prints_its_value_is_renamed() -> None:
    text = "¦x = 1\ny = 2\ntextmsg(f'{y=}{x}x={x!r}={x:=5}{x==1}{x}=}}')\n"
    expected = "z = 1\ny = 2\ntextmsg(f'{y=}{z}x={z!r}={z:=5}{z==1}{z}=}}')\n"
    assert changed(text, "z") == expected


def test_a_name_that_is_there_already_is_refused_or_means_the_same() -> None:
    done = 0
    for seed in range(CASES // 3):
        rng = Random(seed)
        text = programs(seed).replace(", Box.__name__", "")
        document = Document("cell.script", text)
        own = sorted({item.entity.name for item in document.names.occurrences})
        out = shown(text)
        for item in rng.sample(document.names.occurrences, min(10, len(document.names.occurrences))):
            result = rename(document, item.span.line, item.span.column, rng.choice(own))
            if result.edits:
                after = with_edits(document, result.edits)
                assert meaning(Document("cell.script", after)) == meaning(document), (seed, item, after)
                assert shown(after) == out, (seed, item, after)
                done += 1
    assert done >= CASES // 20


@pytest.mark.parametrize("name", ["cell.task", "/cells/cell.task.script", "file:///cell.TASK"])
def test_a_script_of_a_tree_is_renamed_in_the_tree(name):
    document = Document(name, "n = 1\ntextmsg(n)\n")
    assert "is generated from the tree in cell." in rename(document, 1, 1, "k").refusal
    assert "is generated from the tree in cell." in prepare_rename(document, 1, 1).refusal
