from __future__ import annotations

import ast
import random
import time

import pytest

from elitescript.language.checkpoints import insert_checkpoints, is_checkpoint
from elitescript.language.nodes import Census
from tests.invariants.cases import first_of
from tests.language.stage import Stage, Stopped

GUARD = "if not @tick(): @cp()"


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


SHORT = "if range is @range and @pay({}):\n{}\nelse:\n{}"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            "for i in range(8):\n    s += a[i]",
            SHORT.format(
                8,
                "    for i in range(8): s += a[i]",
                f"    for i in range(8):\n        {GUARD}\n        s += a[i]",
            ),
        ),
        (
            "for i in range(4):\n    r = []\n    for j in range(3):\n        if i: r.append(float(j))",
            SHORT.format(
                16,
                "    for i in range(4):\n        r = []\n"
                "        for j in range(3):\n            if i: r.append(float(j))",
                f"    for i in range(4):\n        {GUARD}\n        r = []\n        for j in range(3):\n"
                f"            {GUARD}\n            if i: r.append(float(j))",
            ),
        ),
        (
            "x = [i * i for i in range(50) if i > 3]",
            "x = [i * i for i in range(50) if i > 3] if range is @range and @pay(50)"
            " else [i * i for i in range(50) if (@tick() or @cp()) if i > 3]",
        ),
        (
            "while x:\n    for i in range(9): pass",
            f"while x:\n    {GUARD}\n    if range is @range and @pay(9):\n        for i in range(9): pass\n"
            f"    else:\n        for i in range(9):\n            {GUARD}\n            pass",
        ),
    ],
)
def test_short_loops_pay_at_their_start(text, expected):
    assert instrumented(text) == ast.unparse(ast.parse(expected.replace("@", "at_"))).replace("at_", "@")


@pytest.mark.parametrize(
    "text",
    [
        "for i in range(7): pass",
        "for i in range(101): pass",
        "for i in range(51):\n  for j in range(2): pass",
        "for i in range(n): pass",
        "for i in range(9.0): pass",
        "for i in range(-9): pass",
        "for i in range(True): pass",
        "for i in range(0, 9): pass",
        "for i in range(*[9]): pass",
        "for i in range(9, step=1): pass",
        "for i in other(9): pass",
        "for i in [9]: pass",
        "for a.i in range(9): pass",
        "for a[0] in range(9): pass",
        "for i, j in range(9): pass",
        "for i in range(9): pass\nelse: f()",
        "for i in range(9): break",
        "for i in range(9):\n  if a: break",
        "for i in range(9):\n  if a: continue",
        "def f():\n  for i in range(9): return i",
        "def f():\n  for i in range(9): yield i",
        "for i in range(9): raise a",
        "for i in range(9): assert a",
        "for i in range(9): f()",
        "for i in range(9): f.appended(i)",
        "for i in range(9): sleep(abs(i))",
        "for i in range(9): abs(f())",
        "for i in range(9): a[f()] = i",
        "for i in range(9):\n  while a: pass",
        "for i in range(9):\n  for j in a: pass",
        "for i in range(9):\n  try: a\n  except b: c",
        "for i in range(9):\n  with a: pass",
        "for i in range(9):\n  def f(): pass",
        "for i in range(9):\n  class C: pass",
        "for i in range(9):\n  import a",
        "for i in range(9): a = lambda: 1",
        "for i in range(9): a = [j for j in b]",
        "for i in range(9): a = sum(j for j in b)",
        "for i in range(9): del a[0]",
        "for i in range(9):\n  match a:\n    case 1: pass",
        "[f(i) for i in range(9)]",
        "[j for i in range(9) for j in i]",
        "[i for i in range(9) if f(i)]",
        "[(lambda: i) for i in range(9)]",
        "[i for i in range(7)]",
        "[i for i, in range(9)]",
        "{i for i in range(9)}",
        "{i: i for i in range(9)}",
        "list(i for i in range(9))",
    ],
)
def test_all_other_loops_have_a_checkpoint_in_each_pass(text):
    assert "@pay" not in instrumented(text)


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
    "class A:\n  def __add__(self, o):\n    for i in range(9): self + o\nwhile True:\n  try: A() + 1\n"
    "  except RecursionError: pass",
    "class B:\n  def __bool__(self):\n    for i in range(99):\n      if self: pass\n    return True\nif B(): pass",
    "class E:\n  def __eq__(self, o): return [0 for i in range(99) if self == i]\nE() == 1",
    "class F:\n  def __format__(self, s): return f'{self}' + f'{self}'\nf'{F()}'",
    "class G:\n  @property\n  def x(self): return [self.x for i in range(99)]\nG().x",
    "class I:\n  def __contains__(self, x):\n    for i in range(99): x in self\n1 in I()",
    "def get(s): return [s.x for i in range(99)]\nclass H: x = property(get)\nH().x",
    "x = [0]\ndef range(n): return x\nfor i in range(9): x += [1]",
    "while True:\n  for i in range(9): pass",
    "while True: [i for i in range(9)]",
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


class Counted:
    """A program that runs to its end, and one that stops after so many units of work."""

    def __init__(self, text, has_payments):
        self.text = text
        self.has_payments = has_payments

    def stage(self, work):
        stage = Stage(work)
        if not self.has_payments:
            stage.range = None
        return stage

    def result(self, work=100_000):
        stage = self.stage(work)
        try:
            stage.run(self.text)
        except Stopped:
            return stage.out, "stopped"
        except Exception as error:
            return stage.out, repr(error)
        return stage.out, stage.ticks


def random_loops(seed):
    """A program of loops, most of them short, that compute with lists and numbers and say what comes out."""
    draw = random.Random(seed)

    def block(depth, inside):
        lines = []
        for _ in range(draw.randint(1, 3)):
            kind = draw.randrange(7 if depth < 3 else 4)
            name = draw.choice("abc")
            index = draw.choice(inside) if inside else "1"
            if kind == 0:
                lines.append(f"{name} = {name} * 3 % 101 + {index}")
            elif kind == 1:
                lines.append(f"r.append({name} + {index})")
            elif kind == 2:
                lines += [f"if {name} % 2 == {draw.randrange(2)}:", f"  {name} += abs(int({index} - 3))"]
                lines += ["else:", "  pass"]
            elif kind == 3:
                lines.append(f"r = [v * {index} % 7 for v in range({draw.choice([3, 9, 40, 120])}) if v != {name}]")
            elif kind == 4:
                lines.append(f"textmsg({name}, len(r))")
            else:
                loop = f"i{depth}"
                lines.append(f"for {loop} in range({draw.choice([1, 2, 3, 6, 8, 12, 30])}):")
                lines += ["  " + line for line in block(depth + 1, [*inside, loop])]
        return lines

    text = ["a, b, c, r = 1, 2, 3, []", *block(0, []), *block(0, []), "textmsg(a, b, c, r)"]
    return "\n".join(text) + "\n"


@pytest.mark.parametrize("seed", first_of(range(150), 50))
def test_payments_change_nothing_but_the_time_it_takes(seed):
    text = random_loops(seed)
    paid, counted = Counted(text, True), Counted(text, False)
    assert paid.result() == counted.result()
    for work in (1, 7, 40, 99, 100, 101, 333):
        assert paid.result(work) == counted.result(work)


def test_random_loops_hold_payments():
    assert sum("@pay" in instrumented(random_loops(seed)) for seed in range(150)) > 75


def test_a_payment_is_all_or_nothing():
    text = "for i in range(9): pass\ntextmsg('there')\nfor i in range(9): pass\ntextmsg('never')"
    for work in (9, 10, 17):
        assert Counted(text, True).result(work) == (["there"], "stopped")


def test_a_range_of_the_program_is_asked_each_time():
    text = "def range(n): return [5]\nfor i in range(9): textmsg(i)\nx = [i for i in range(9)]\ntextmsg(x)"
    assert Counted(text, True).result() == Counted(text.replace("(9)", "(7)"), True).result() == (["5", "[5]"], 4)


SHORT_LOOP = "for i in range(9): 1 / (i - 2)"


@pytest.mark.parametrize(
    ("text", "work"),
    [
        (f"try:\n  {SHORT_LOOP}\nexcept ZeroDivisionError: pass", 3),
        ("try:\n  [1 / (i - 2) for i in range(9)]\nexcept ZeroDivisionError: pass", 3),
        (f"def f():\n  {SHORT_LOOP}\ntry:\n  f()\nexcept ZeroDivisionError: pass", 4),
        (f"from contextlib import suppress\nwith suppress(ZeroDivisionError):\n  {SHORT_LOOP}", 3),
    ],
)
def test_a_loop_that_ends_with_an_exception_uses_up_the_passes_that_it_made(text, work):
    assert Counted(text, True).result()[1] == work


@pytest.mark.parametrize(
    "text",
    [
        "class A:\n  def __add__(self, o):\n    textmsg(o)\n    return 1\na = A()\nfor i in range(9): a + i",
        "class A:\n  def append(self, o): textmsg(o)\na = A()\nfor i in range(9): a.append(i)",
        "class A:\n  @property\n  def x(self): textmsg(1)\na = A()\n[a.x for i in range(9)]",
        "def max(a, b):\n  textmsg(a)\n  return b\nfor i in range(9): max(i, 1)",
        "def biggest(a, b):\n  textmsg(a)\n  return b\nmax = biggest\n[max(i, 1) for i in range(9)]",
        "def twice(len):\n  for i in range(9): len(i)\ndef show(a): textmsg(a)\ntwice(show)",
        "import operator as abs\nfor i in range(9): a = 1",
        "def key(a):\n  textmsg(a)\n  return a\nfor i in range(9): max([i, 1], key=key)",
    ],
)
def test_a_function_of_the_program_in_a_loop_finds_the_work_of_the_passes_before_it(text):
    for work in range(40):
        assert Counted(text, True).result(work) == Counted(text, False).result(work)
    assert "@pay" not in instrumented(text)
