"""An element that a list, a text or a dict does not have: an alarm (`IndexError`, `KeyError`). Elements count from 0.

A reading of three numbers is a list of four: how many arrived, then the numbers.

    def job():
      p = get_target_tcp_pose()
      textmsg(p[5])                               # fine: the last one
      textmsg(p[6])                               # W265: six elements, 0 to 5
      for i in range(6):
        textmsg(p[i + 1])                         # W265: in the last turn
      end
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from math import inf

from elitescript.lint.called import CalledCommands
from elitescript.lint.placing import conditions, loops
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule, shown_source
from elitescript.said import said
from elitescript.values.description import BYTES, INT, LIST, RANGE, TEXT, TUPLE


@rule(code="W265", since="0.3", needs_values=True)
def index_out_of_range(program: AnalysedProgram) -> Iterator[Finding]:
    """Report indices and unpackings of lists whose length is certain."""
    written = _are_counts_written(program)
    for node in program.nodes(ast.Subscript):
        if isinstance(node.slice, ast.Slice):
            continue
        yield from _missing_key(program, node)
        yield from _past_the_end(program, node, written)
        index = program.values.of(node.slice)
        # A variable may be a switch, or be checked before.
        if (
            not index.has_constant
            or index.kinds != INT
            or any(isinstance(part, ast.Name) for part in ast.walk(node.slice))
        ):
            continue
        length = _length(program, node.value, written)
        if length is not None and not -length <= index.constant < length and not program.is_tried(node):
            words = (
                "{expression} has {length} characters, and none with the index {index}"
                if program.values.of(node.value).kinds == TEXT
                else "{expression} has {length} elements, and none with the index {index}"
            )
            text = said(words, expression=shown_source(program, node.value), length=length, index=index.constant)
            yield Finding(node, text, said("the first is 0, the last {length}", length=length - 1) if length else "")
    for assignment in program.nodes(ast.Assign):
        for target in assignment.targets:
            if not isinstance(target, (ast.Tuple, ast.List)) or any(
                isinstance(part, ast.Starred) for part in target.elts
            ):
                continue
            length = _length(program, assignment.value, written)
            if length is not None and length != len(target.elts) and not program.is_tried(assignment):
                what = said(
                    "{expression} has {length} elements",
                    expression=shown_source(program, assignment.value),
                    length=length,
                )
                yield Finding(
                    target,
                    said("{what}, and {count} names take them", what=what, count=len(target.elts)),
                    "take as many as there are",
                )


def _past_the_end(program: AnalysedProgram, node: ast.Subscript, written: bool) -> Iterator[Finding]:
    """Yield an element that the last turn of a loop takes, and that is not there: `range(len(p) + 1)`."""
    counter = node.slice
    if isinstance(counter, ast.BinOp) and isinstance(counter.op, ast.Add) and isinstance(counter.right, ast.Constant):
        counter = counter.left
    if not isinstance(counter, ast.Name):
        return
    loop = next(loops(program.symbols, node), None)
    if not isinstance(loop, ast.For) or not isinstance(loop.target, ast.Name) or loop.target.id != counter.id:
        return
    numbers, last = program.values.of(loop.iter), program.values.of(node.slice)
    shape = numbers.shape
    if numbers.kinds != RANGE or shape is None or shape.least < 1 or shape.least != shape.most:
        return
    if last.kinds != INT or program.is_tried(node) or _is_conditional(program, node, loop):
        return
    length = _length(program, node.value, written)
    if length is not None and last.low >= 0 and length <= last.high < inf:
        text = said(
            "{expression} has {length} elements, and the last turn of the loop takes the index {index}",
            expression=shown_source(program, node.value),
            length=length,
            index=int(last.high),
        )
        hint = said("the last index is {last}: range(n) counts from 0 to n - 1", last=length - 1)
        yield Finding(node, text, hint)


def _is_conditional(program: AnalysedProgram, node: ast.AST, loop: ast.For) -> bool:
    """Return whether a condition, or a way out of the loop, may keep its last turn from a node."""
    around = conditions(program.symbols, node)
    if not around or around[0][0] is not loop:
        return True
    leaving = (ast.Break, ast.Return, ast.Raise, ast.Continue, ast.Yield)
    if any(isinstance(part, leaving) for statement in loop.body for part in ast.walk(statement)):
        return True
    name = loop.target.id if isinstance(loop.target, ast.Name) else ""
    scope = program.symbols.scope_of(loop)
    return sum(loop.lineno <= binding.line <= (loop.end_lineno or 0) for binding in scope.bindings.get(name, ())) != 1


def _missing_key(program: AnalysedProgram, node: ast.Subscript) -> Iterator[Finding]:
    """Yield a key that a dict does not have which is written out and stays as it is."""
    if not isinstance(node.value, ast.Name) or not isinstance(node.slice, ast.Constant):
        return
    symbols = program.symbols
    name, home = node.value.id, symbols.scope_of(node).home(node.value.id)
    bindings = [] if home is None else home.bindings[name]
    made = symbols.parent(bindings[0].node) if len(bindings) == 1 else None
    if not isinstance(made, ast.Assign) or made.targets != [bindings[0].node] or not isinstance(made.value, ast.Dict):
        return
    keys = [key.value for key in made.value.keys if isinstance(key, ast.Constant)]
    if len(keys) != len(made.value.keys) or node.slice.value in keys or not isinstance(node.ctx, ast.Load):
        return
    if program.is_tried(node) or not all(_only_reads(program, read) for read in symbols.reads_of(name, home)):
        return
    text = said("`{name}` has no key {key}", name=name, key=repr(node.slice.value))
    yield Finding(node, text, said("it has {keys}", keys=", ".join(map(repr, keys[:_KEYS_MAX]))) if keys else "")


_KEYS_MAX = 8
_READING = frozenset(("get", "items", "keys", "values"))


def _only_reads(program: AnalysedProgram, read: ast.Name) -> bool:
    """Return whether a use of a dict takes a value, or one of its methods that change nothing."""
    above = program.symbols.parent(read)
    if isinstance(above, ast.Subscript):
        return above.value is read and isinstance(above.ctx, ast.Load)
    if isinstance(above, ast.Attribute):
        return above.attr in _READING
    return isinstance(above, ast.For) and above.iter is read


def _are_counts_written(program: AnalysedProgram) -> bool:
    """Return whether each reading says as a number how many values it waits for; else that may be filled in later."""
    readings = [
        found
        for found in program.derived(CalledCommands)
        if "number" in found.given and found.name.startswith("socket_read_")
    ]
    return all(isinstance(found.given["number"], ast.Constant) for found in readings)


def _length(program: AnalysedProgram, node: ast.expr, is_written: bool) -> int | None:
    """Return how many elements a list has in any case; None if that is not certain."""
    value = program.values.of(node)
    shape = value.shape
    if value.kinds in (TEXT, BYTES) and value.constants:
        return max(map(len, value.constants))
    if (
        value.kinds not in (LIST, TUPLE)
        or shape is None
        or shape.items is None
        or (shape.is_counted and not is_written)
    ):
        return None
    return len(shape.items)
