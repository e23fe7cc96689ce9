from __future__ import annotations

import ast
import time

import pytest

from elitescript.language.checkpoints import insert_checkpoints, is_checkpoint
from elitescript.language.nodes import Census
from tests.language.stage import Stage, Stopped

STATEMENT = "if not @tick():\n    @cp()"


def instrumented(text):
    tree = ast.parse(text)
    insert_checkpoints(Census(tree))
    return ast.unparse(tree)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("while x:\n    f()", "while x:\n    if not @tick():\n        @cp()\n    f()"),
        (
            "for i in x:\n    f()\nelse:\n    g()",
            "for i in x:\n    if not @tick():\n        @cp()\n    f()\nelse:\n    g()",
        ),
        ("def f():\n    return 1", "def f():\n    if not @tick():\n        @cp()\n    return 1"),
        (
            'def f():\n    """doc"""\n    return 1',
            'def f():\n    """doc"""\n    if not @tick():\n        @cp()\n    return 1',
        ),
        ("f = lambda x: x + 1", "f = lambda x: (@tick() or @cp()) and x + 1"),
        ("[i for i in x if i]", "[i for i in x if (@tick() or @cp()) if i]"),
        (
            "{i: j for i in x for j in i}",
            "{i: j for i in x if (@tick() or @cp()) for j in i if (@tick() or @cp())}",
        ),
        ("(i for i in x)", "(i for i in x if (@tick() or @cp()))"),
        (
            "try:\n    f()\nexcept:\n    g()",
            "try:\n    f()\nexcept @stop:\n    raise\nexcept:\n    g()",
        ),
        ("try:\n    f()\nfinally:\n    g()", "try:\n    f()\nfinally:\n    g()"),
        ("if x:\n    f()", "if x:\n    f()"),
        ("class C:\n    x = 1", "class C:\n    x = 1"),
        ("with x:\n    f()", "with x:\n    f()"),
    ],
)
def test_where_checkpoints_stand(text, expected):
    assert instrumented(text) == ast.unparse(ast.parse(expected.replace("@", "at_"))).replace("at_", "@")


def test_they_take_the_line_of_what_they_guard():
    tree = ast.parse("x = 1\nwhile x:\n\n  f(\n   lambda: 2)\n")
    insert_checkpoints(Census(tree))
    lines = {node.lineno for node in ast.walk(tree) if isinstance(node, ast.Name) and node.id == "@tick"}
    assert lines == {2, 5}


def test_they_are_recognised():
    tree = ast.parse("while x:\n  if not tick():\n    f()\n")
    insert_checkpoints(Census(tree))
    assert [is_checkpoint(statement) for statement in tree.body[0].body] == [True, False]


def test_a_tree_that_is_not_understood_is_not_touched():
    tree = ast.parse("while x:\n  async def f(): pass\n")
    before = ast.dump(tree)
    with pytest.raises(ValueError, match="AsyncFunctionDef"):
        insert_checkpoints(Census(tree))
    assert ast.dump(tree) == before


ENDLESS = [
    "while True: pass",
    "while True:\n  try:\n    f()\n  except:\n    pass",
    "while True:\n  try:\n    while True: pass\n  except BaseException:\n    pass",
    "while True:\n  try:\n    while True: pass\n  finally:\n    continue",
    "def f(): f()\nwhile True:\n  try: f()\n  except RecursionError: pass",
    "def g():\n  while True: yield 1\nfor x in g(): pass",
    "def g():\n  while True: yield 1\nsum(g())",
    "def g():\n  while True: yield 1\n[x for x in g()]",
    "def g():\n  while True: yield 1\nlist(y for x in [1] for y in g() if False)",
    "def g():\n  while True: yield 1\nlist(map(lambda x: x, g()))",
    "list(iter(lambda: 1, 2))",
    "def f(): return 1\nlist(iter(f, 2))",
    "class C:\n  def __iter__(self): return self\n  def __next__(self): return 1\nlist(C())",
    "class C:\n  def __getitem__(self, i): return i\nfor x in C(): pass",
    "class C:\n  def __getitem__(self, i): return i\n99.5 in C()",
    "x = [1]\nfor y in x: x.append(y)",
    "f = lambda n: f(n - 1) + f(n - 2)\nwhile True:\n  try: f(9)\n  except RecursionError: pass",
    "class C:\n  while True: pass",
    "def f():\n  try:\n    while True: pass\n  except:\n    f()\nf()",
    "class S:\n  def __enter__(self): pass\n  def __exit__(self, *a): return True\n"
    "while True:\n  with S():\n    while True: pass",
]


@pytest.mark.parametrize("text", ENDLESS)
def test_everything_endless_can_be_stopped(text):
    began = time.perf_counter()
    with pytest.raises((Stopped, RecursionError)):
        Stage(work=5_000).run(text)
    assert time.perf_counter() - began < 5.0


@pytest.mark.parametrize(
    ("text", "out"),
    [
        ("textmsg([i for i in range(5) if i % 2])", ["[1, 3]"]),
        ("textmsg((lambda a, b=2: a + b)(1))", ["3"]),
        ("textmsg((lambda: None)(), (lambda: 0)(), (lambda: [])())", ["None0[]"]),
        ("textmsg([(a, b) for a in 'xy' for b in a + 'z' if b != 'x'])", ["[('x', 'z'), ('y', 'y'), ('y', 'z')]"]),
        ("f = lambda: (yield 1)\ntextmsg(list(f()))", ["[1]"]),
        ("def f():\n  'doc'\n  return 1\ntextmsg(f.__doc__, f())", ["doc1"]),
        (
            "try:\n  1 / 0\nexcept ZeroDivisionError as e:\n  textmsg(e)\nelse:\n  textmsg(0)\nfinally:\n  textmsg(2)",
            ["division by zero", "2"],
        ),
        ("class C:\n  v = [i for i in range(2)]\n  w = lambda s: 3\ntextmsg(C.v, C().w())", ["[0, 1]3"]),
    ],
)
def test_values_are_those_of_python(text, out):
    stage = Stage()
    stage.run(text)
    assert stage.out == out


def test_the_count_of_work_is_exact():
    stage = Stage()
    stage.run("def f():\n  for i in range(3): pass\nend\nf()\nf()\n[i for i in range(4)]\nwhile False: pass")
    assert stage.ticks == 2 * (1 + 3) + 4
