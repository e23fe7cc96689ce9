"""The value of every expression, each time that it is evaluated, is as its description at that place says.

`tests/sound_values.py` holds variables against all that they ever are; this holds the state at each place.
"""

from __future__ import annotations

import ast
import copy
from random import Random

import pytest

from elitescript.language.parser import parse
from elitescript.language.symbols import Symbols
from elitescript.language.text.source import SourceFile
from elitescript.values.description import holds
from elitescript.values.program import Values
from elitescript.values.words import words
from tests.values.random_programs import Drawn

TICKS_MAX = 150
LENGTH_MAX = 300
BITS_MAX = 2000


class Enough(BaseException):
    """The program has run long enough."""


class Watched(ast.NodeTransformer):
    """Puts a call of `watch` around each expression that is read."""

    def __init__(self) -> None:
        self.nodes: list[ast.expr] = []

    def visit(self, node: ast.AST) -> ast.AST:
        original = node.original
        made = self.generic_visit(node)
        is_read = isinstance(getattr(node, "ctx", None), ast.Load | None)
        if not isinstance(node, ast.expr) or isinstance(node, ast.Slice | ast.Starred) or not is_read:
            return made
        self.nodes.append(original)
        number = ast.Constant(len(self.nodes) - 1)
        return ast.copy_location(ast.Call(ast.Name("watch", ast.Load()), [number, made], []), node)


def outside(text):
    """Run a program; return what was said wrongly of its expressions, and how many values were compared."""
    symbols = Symbols(parse(SourceFile("drawn", text)))
    values = Values(symbols, frozenset({"tick"}))
    tree = symbols.parsed.tree
    copied = copy.deepcopy(tree)
    for node, made in zip(ast.walk(tree), ast.walk(copied), strict=True):
        made.original = node
    watched = Watched()
    code = compile(ast.fix_missing_locations(watched.visit(copied)), "drawn", "exec")
    ticks, seen, wrong, known = 0, 0, [], {}

    def tick():
        nonlocal ticks
        ticks += 1
        if ticks > TICKS_MAX:
            raise Enough

    def watch(number, value):
        nonlocal seen
        seen += 1
        node = watched.nodes[number]
        if number not in known:
            known[number] = values.of(node)
        if not holds(known[number], value):
            wrong.append(f"line {node.lineno}: {ast.unparse(node)} is {value!r:.60}, not {words(known[number])}")
            raise Enough
        if isinstance(value, list | str) and len(value) > LENGTH_MAX:
            raise Enough
        if isinstance(value, int) and value.bit_length() > BITS_MAX:
            raise Enough
        return value

    names = {"tick": tick, "watch": watch}
    try:
        exec(code, names)
        names["f"]()
    except (Enough, Exception):
        pass
    return wrong, seen


def compared(seeds):
    count = 0
    for seed in seeds:
        text = Drawn(Random(seed)).text()
        wrong, seen = outside(text)
        assert not wrong, f"seed {seed}: {wrong[0]}\n{text}"
        count += seen
    return count


def test_random_programs():
    assert compared(range(30)) > 3_000


@pytest.mark.slow
def test_many_random_programs(finding):
    count = compared(range(1_000, 3_000))
    finding("descriptions of values", f"{count:,} values of the expressions of 2,000 random programs", "none outside")


def test_the_comparison_finds_what_is_wrong(monkeypatch):
    monkeypatch.setattr(Values, "of", lambda self, node: self._evaluation.values[node].but(low=2))
    assert outside("def f():\n  a = 1\n  b = a\nend\n")[0] == ["line 2: 1 is 1, not 1"]
