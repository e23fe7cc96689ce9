"""Which programs can show the order of a set."""

from __future__ import annotations

import ast
import sys

import pytest

from elitescript.language.compiler import compile_unit
from elitescript.language.hash_order import SAFE_MODULES, UNSAFE_NAMES, may_hold_set, shows_hash_order
from elitescript.language.modules import AVAILABLE
from elitescript.language.nodes import Census
from elitescript.language.text.source import SourceFile
from elitescript.runtime.names import bindings

CANNOT = [
    "movej([0, -1.5, -1.5, -1.5, 1.5, 0])",
    "x = {'a': 1, 'b': 2}\nfor k, v in x.items():\n  textmsg(k, v)\nend",
    "x = {'a': 1}\nfor k in x.keys():\n  textmsg(k)\nend",
    "x = [k for k in {'a': 1}.keys()]",
    "x = {k: v for k, v in {'a': 1}.items()}",
    "x = {'a': 1}\ntextmsg(x.values(), x.get('a'), list(x), sorted(x))",
    "import math\nimport time, json\nfrom queue import Queue",
    "class A:\n  def __init__(self):\n    self.x = 1\n  end\n  def __eq__(self, other):\n    return True\n  end\nend",
    "settings = 1\nreset = 2\nx.hashes = 3",
    "textmsg('set() {1, 2} hash')",
    "# {1, 2}",
    "match x:\n  case dict(values=v):\n    pass\n  end\nend",
]

CAN = [
    "x = {'a', 'b'}",
    "x = {1}",
    "x = {k for k in 'ab'}",
    "x = set('ab')",
    "x = frozenset('ab')",
    "x = list(map(set, ['ab']))",
    "x = hash('a')",
    "f = hash",
    "x = eval('{1, 2}')",
    "exec('x = {1, 2}')",
    "x = getattr({}, 'ke' + 'ys')()",
    "x = {'a': 1}.keys() & {'b': 2}.keys()",
    "x = {'a': 1}.items()",
    "f = {'a': 1}.keys\nx = f() | f()",
    "for k in x.keys() & y.keys():\n  pass\nend",
    "for k in f(x.keys()):\n  pass\nend",
    "for k in x.keys:\n  pass\nend",
    "x = 'a'.__hash__()",
    "import collections",
    "import math, operator",
    "from enum import Enum",
    "import my_module",
    "class A(set):\n  pass\nend",
    "match x:\n  case set():\n    pass\n  end\nend",
    "def f(x=set()):\n  pass\nend",
    "textmsg(f'{set(x)}')",
    "x = [k for k in 'ab' if k in {'a'}]",
    "match x:\n  case dict(keys=k):\n    pass\n  end\nend",
    "match x:\n  case dict(items=k):\n    pass\n  end\nend",
]


def shows(text: str) -> bool:
    return compile_unit(SourceFile("p.script", text + "\n")).shows_hash_order


@pytest.mark.parametrize("text", CANNOT)
def test_programs_that_cannot(text: str) -> None:
    assert not shows(text)


@pytest.mark.parametrize("text", CAN)
def test_programs_that_may(text: str) -> None:
    assert shows(text)


LOOP: list[object] = [1]
LOOP.append(LOOP)


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (1, False),
        ([None, True, 1.5, ("a", {"b": [b"c"]})], False),
        (LOOP, False),
        ({1}, True),
        ([1, {"a": ({"b": {2}},)}], True),
        ({frozenset("ab"): 1}, True),
        ({"a": 1}.keys(), True),
        (len, True),
    ],
)
def test_values_that_may_hold_sets(value: object, expected: bool) -> None:
    assert may_hold_set([value]) is expected


def test_a_run_that_begins_with_a_set_is_reproducible_with_a_fixed_seed_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    from elitescript import VirtualRobot

    monkeypatch.setenv("PYTHONHASHSEED", "random")
    text = "def p():\n  global x\n  textmsg(x)\nend\n"
    assert VirtualRobot().run(text, presets={"x": ["a"]}).is_reproducible
    is_fixed = not sys.flags.hash_randomization
    assert VirtualRobot().run(text, presets={"x": [{"a"}]}).is_reproducible is is_fixed


def test_a_run_beside_clients_or_secondary_programs_with_sets_needs_a_fixed_seed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from elitescript import VirtualRobot

    monkeypatch.setenv("PYTHONHASHSEED", "random")
    is_fixed = not sys.flags.hash_randomization
    for text, expected in (("textmsg(1)", True), ("textmsg({'a', 'b'})", is_fixed)):
        robot = VirtualRobot()
        run = robot.start("def p():\n  sleep(1)\nend\n")
        robot.submit_secondary(f"sec s():\n  {text}\nend\n")
        robot.advance(2.0)
        assert run.log != [] and run.is_reproducible is expected
    robot = VirtualRobot()
    before = robot.start("def p():\n  sleep(1)\nend\n")
    robot.connect("interpreter")
    robot.advance(2.0)
    assert before.is_reproducible is robot.run("textmsg(1)\n").is_reproducible is is_fixed


def test_syntax_that_is_not_known_may() -> None:
    assert shows_hash_order(Census(ast.parse("async def f(): pass")))


SAFE_NAMES = """
    abs all any ascii bin bool bytearray bytes callable chr classmethod complex dict divmod enumerate filter float
    format hex int isinstance issubclass iter len list long map max min next object oct open ord print property range
    repr reversed round slice sorted staticmethod str sum super tuple type unichr zip
    Ellipsis NotImplemented __debug__ copy delattr dir elicopy exit hasattr id input quit setattr
    breakpoint compile globals help locals memoryview vars
"""
"""Predefined names besides commands and exceptions that give neither sets nor hashes, nor run text; the last row is
refused."""


def test_every_predefined_name_is_known_to_be_safe_or_not() -> None:
    errors = {*bindings._ERRORS, "KeyboardInterrupt", "BaseExceptionGroup", "ExceptionGroup"}
    assert {*bindings._REAL, *bindings._MADE} - errors == {*SAFE_NAMES.split(), *UNSAFE_NAMES}


@pytest.mark.parametrize("name", sorted(SAFE_MODULES))
def test_no_safe_module_holds_a_set(name: str) -> None:
    assert name in AVAILABLE
    from elitescript import VirtualRobot

    held = f"[n for n in dir({name}) if isinstance(getattr({name}, n), (set, frozenset))]"
    assert VirtualRobot().run(f"import {name}\nglobal names\nnames = {held}\n").check().globals == {"names": []}
