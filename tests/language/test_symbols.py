from __future__ import annotations

import ast
import symtable

import pytest

from elitescript.language.parser import parse
from elitescript.language.symbols import Resolution, Symbols
from elitescript.language.text.source import SourceFile

LOCAL, CELL, GLOBAL, BUILTIN = Resolution.LOCAL, Resolution.CELL, Resolution.GLOBAL, Resolution.BUILTIN


def symbols_of(text):
    return Symbols(parse(SourceFile("f", text)))


def scope_named(symbols, name):
    return next(scope for scope in symbols.scopes if scope.name == name)


JOB = """def job(speed=0.5):
  global level, count
  level = 7
  RATIO = 1000
  import math, a.b as c
  def mix(u, *w, k=1):
    level = u * RATIO
    textmsg(level, count, math.pi, later)
    return [level + n for n in w if n > later]
  end
  class Box:
    size = 1
    def get(self):
      return size + Box.size
    end
  end
  def bump():
    global count
    nonlocal later
    count += 1
    later = 2
    with open(RATIO) as f, g() as (h, i):
      pass
    try:
      del h
    except ValueError as e:
      (m := e)
  end
  later = 1
  start_thread(mix, (1, 2))
  start_thread(function=bump)
  start_thread(lambda: 0, ())
end
"""


def inner(table):
    """The tables inside one, without those of annotations, which Python has since 3.14."""
    return [child for child in table.get_children() if child.get_name() != "__annotate__"]


class TestResolution:
    @pytest.mark.parametrize(
        ("scope", "name", "expected"),
        [
            ("job", "level", GLOBAL),
            ("job", "RATIO", LOCAL),
            ("job", "speed", LOCAL),
            ("job", "math", LOCAL),
            ("job", "c", LOCAL),
            ("job", "job", BUILTIN),
            ("job", "movej", BUILTIN),
            ("mix", "level", LOCAL),
            ("mix", "w", LOCAL),
            ("mix", "k", LOCAL),
            ("mix", "RATIO", CELL),
            ("mix", "later", CELL),
            ("mix", "count", GLOBAL),
            ("mix", "textmsg", BUILTIN),
            ("Box", "size", LOCAL),
            ("get", "size", BUILTIN),
            ("get", "Box", CELL),
            ("bump", "count", GLOBAL),
            ("bump", "later", CELL),
            ("bump", "f", LOCAL),
            ("bump", "h", LOCAL),
            ("bump", "i", LOCAL),
            ("bump", "e", LOCAL),
            ("bump", "m", LOCAL),
        ],
    )
    def test_of_names(self, scope, name, expected):
        assert scope_named(symbols_of(JOB), scope).resolve(name) is expected

    def test_comprehensions_have_their_own_variables(self):
        symbols = symbols_of(JOB)
        comprehension = next(scope for scope in symbols.scopes if scope.kind == "comprehension")
        assert comprehension.parent is scope_named(symbols, "mix")
        assert (comprehension.resolve("n"), comprehension.resolve("level")) == (LOCAL, CELL)
        assert set(comprehension.reads) == {"level", "n", "later"}
        assert "w" in comprehension.parent.reads

    def test_a_walrus_in_a_comprehension_binds_outside(self):
        symbols = symbols_of("def job():\n  x = [(y := i) for i in z]\nend")
        assert symbols.body.has_local("y")

    def test_a_global_of_an_enclosing_function_is_global_inside(self):
        symbols = symbols_of("x = 1\ndef f():\n  global x\n  def g():\n    return x\n")
        assert scope_named(symbols, "g").resolve("x") is GLOBAL

    @pytest.mark.parametrize(
        "text",
        [
            JOB,
            "def a():\n  def b():\n    global x\n    x = 1\n  def c():\n    return x + y\n  y = 2\nend",
            "def a():\n  def b(p):\n    class C(p):\n      p = p\n      def m(self): return p\n    return C\nend",
            "def a():\n  f = lambda x, y=z: x + y + z\n  z = {k: v for k, v in f() if k in z}\nend",
            "def a():\n  x = 1\n  def b():\n    def c():\n      nonlocal x\n      x = 2\n    for x2 in x: pass\nend",
            "def a():\n  match q:\n    case [r, *s]: t = r\n    case {'k': u, **v}: pass\n"
            "    case C(w=w2) as w3: pass\nend",
        ],
    )
    def test_agrees_with_pythons_own_symbol_table(self, text):
        parsed = parse(SourceFile("f", text))
        self.compare(Symbols(parsed).body, inner(symtable.symtable(parsed.translation.text, "f", "exec"))[0])

    def compare(self, scope, table):
        parameters = set(scope.parameters)
        # From 3.12 on the variables of a comprehension are listed with those of its function.
        inlined = {name for child in scope.children if child.kind == "comprehension" for name in child.bindings}
        for symbol in table.get_symbols():
            name = symbol.get_name()
            if (
                name.startswith(".")
                or name in ("__class__", "__classdict__", "__conditional_annotations__")
                or name in inlined
            ):
                continue
            ours = scope.resolve(name)
            if symbol.is_free():
                assert ours is CELL, name
            elif symbol.is_declared_global():
                assert ours is GLOBAL, name
            elif symbol.is_local():
                assert ours is LOCAL, name
            else:
                assert ours in (GLOBAL, BUILTIN), name
            assert symbol.is_parameter() == (name in parameters) or scope.kind == "comprehension"
        ours_inside = sorted((child.node.lineno, child.name) for child in scope.children if child.name)
        theirs = {
            (child.get_lineno(), child.get_name()): child
            for child in inner(table)
            if child.get_type() in ("function", "class") and child.get_name() not in ("lambda", "listcomp", "dictcomp")
        }
        assert ours_inside == sorted(theirs)
        for child in scope.children:
            if child.name:
                self.compare(child, theirs[(child.node.lineno, child.name)])


class TestContents:
    def test_globals(self):
        symbols = symbols_of(JOB)
        assert symbols.global_names == {"level", "count"}
        assert [(binding.line, binding.kind) for binding in symbols.global_bindings("level")] == [(3, "assign")]
        assert [(binding.line, binding.kind) for binding in symbols.global_bindings("count")] == [(20, "augmented")]

    @pytest.mark.parametrize(
        ("name", "kinds"),
        [
            ("a", ["assign"]),
            ("b", ["for"]),
            ("c", ["with"]),
            ("d", ["except"]),
            ("e", ["import"]),
            ("f", ["def"]),
            ("g", ["class"]),
            ("h", ["walrus"]),
            ("i", ["annotated"]),
            ("j", ["match"]),
            ("k", ["assign", "augmented", "delete"]),
            ("l", ["for"]),
            ("m", ["parameter"]),
        ],
    )
    def test_kinds_of_bindings(self, name, kinds):
        text = (
            "def job(m=1):\n  a = 1\n  for b, (l, *_) in x: pass\n  with x as c: pass\n  try: pass\n"
            "  except E as d: pass\n  import e.z\n  def f(): pass\n  class g: pass\n  (h := 1)\n  i: int = 2\n"
            "  match x:\n    case j: pass\n  k = 1\n  k += 1\n  del k\nend"
        )
        assert [binding.kind for binding in symbols_of(text).body.bindings[name]] == kinds

    def test_an_augmented_assignment_reads_too(self):
        assert set(symbols_of("x += y").body.reads) == {"x", "y"}

    def test_calls_are_in_the_order_of_the_text(self):
        symbols = symbols_of("a(b(c()), d())\ne()\ndef f():\n  g()\n")
        assert [ast.unparse(call.func) for call in symbols.body.calls] == ["a", "b", "c", "d", "e"]
        assert [ast.unparse(call.func) for call in scope_named(symbols, "f").calls] == ["g"]

    def test_defaults_and_decorators_belong_outside(self):
        symbols = symbols_of("@d(p)\ndef f(a: q = r()) -> s:\n  return t\nx = 1")
        assert set(symbols.body.reads) == {"d", "p", "q", "r", "s"}
        assert set(scope_named(symbols, "f").reads) == {"t"}

    def test_statements_are_those_of_the_scope(self):
        symbols = symbols_of(JOB)
        assert symbols.body.statements is symbols.parsed.unit.body
        assert len(scope_named(symbols, "get").statements) == 1

    def test_deep_nesting_is_no_problem(self):
        assert len(symbols_of("x = " + "lambda: " * 80 + "0\nx = " + "[" * 80 + "]" * 80).scopes) == 81

    def test_scopes_come_from_outside_in(self):
        kinds = [(scope.kind, scope.name) for scope in symbols_of(JOB).scopes]
        assert kinds == [
            ("body", "job"),
            ("function", "mix"),
            ("comprehension", ""),
            ("class", "Box"),
            ("function", "get"),
            ("function", "bump"),
            ("lambda", ""),
        ]


class TestRelations:
    def test_parents_and_scopes(self):
        symbols = symbols_of("def job():\n  if f(x):\n    y = [g(z) for z in w]\n  end\nend")
        names = {node.id: node for node in ast.walk(symbols.parsed.tree) if isinstance(node, ast.Name)}
        assert isinstance(symbols.parent(names["x"]), ast.Call)
        assert symbols.scope_of(names["g"]).kind == "comprehension"
        assert symbols.scope_of(names["w"]).kind == "body"
        assert [type(node) for node in symbols.ancestors(names["y"])] == [ast.Assign, ast.If, ast.FunctionDef]

    def test_every_node_of_the_body_has_a_scope_and_a_parent(self):
        symbols = symbols_of(JOB)
        ignored = (ast.expr_context, ast.operator, ast.cmpop, ast.boolop, ast.unaryop)
        for statement in symbols.body.statements:
            for node in ast.walk(statement):
                if not isinstance(node, ignored):
                    assert symbols.parent(node) is not None, ast.dump(node)
                    assert node in symbols._scope_of, ast.dump(node)

    def test_ranges_count_characters_from_one(self):
        symbols = symbols_of("x = '温度' + yy\n")
        name = next(node for node in ast.walk(symbols.parsed.tree) if isinstance(node, ast.Name) and node.id == "yy")
        assert symbols.range_of(name) == (1, 12, 1, 14)

    def test_asynchronous_code_is_analysed_too(self):
        symbols = symbols_of("async def f(a):\n  async for b in a: pass\n  async with c as d: pass\nx = 1")
        assert set(scope_named(symbols, "f").bindings) == {"a", "b", "d"}
