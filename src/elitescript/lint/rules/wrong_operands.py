"""An operation that Python does not have for these values: an alarm (`TypeError`, `ZeroDivisionError`).

A text and a number are not added, a list and a number neither, a text is not compared with a number by `<`, and `range`
takes whole numbers.

    def job():
      textmsg("parts: " + 3)                      # W264: "parts: " + str(3), or textmsg("parts: ", 3)
      if socket_read_string() > 5:                # W264: to_num(...) > 5
        halt()
      end
      for x in range(0, 1, 0.1):                  # W264: [n / 10 for n in range(10)]
        textmsg(x)
      end
      p = get_target_tcp_pose()
      textmsg(p.x)                                # W264: p[0]
      textmsg("parts: " + str(3))                 # fine
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from math import inf
from typing import Final

from elitescript.language.symbols import Resolution
from elitescript.lint.placing import conditions
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule, shown_source
from elitescript.said import Said, said
from elitescript.values.description import (
    BOOL,
    BYTES,
    DICT,
    FLOAT,
    FUNCTION,
    INT,
    LIST,
    NONE,
    NUMBER,
    OBJECT,
    RANGE,
    ROW,
    SET,
    SOME_INT,
    TEXT,
    TUPLE,
    WHOLE,
    Value,
)
from elitescript.values.plain import SIGNS
from elitescript.values.words import phrase

_SAME: Final = ((NUMBER, NUMBER), (TEXT, TEXT), (BYTES, BYTES), (LIST, LIST), (TUPLE, TUPLE))
_NUMBERS: Final = ((NUMBER, NUMBER),)
_WHOLE_NUMBERS: Final = ((WHOLE, WHOLE),)
_REPEATED: Final = TEXT | BYTES | ROW
_ANYTHING: Final = 2 * OBJECT - 1
_ALLOWED: Final[dict[type[ast.AST], tuple[tuple[int, int], ...]]] = {
    ast.Add: _SAME,
    ast.Sub: _NUMBERS,
    ast.Mult: (*_NUMBERS, (_REPEATED, WHOLE), (WHOLE, _REPEATED)),
    ast.Div: _NUMBERS,
    ast.FloorDiv: _NUMBERS,
    ast.Mod: (*_NUMBERS, (TEXT | BYTES, _ANYTHING)),
    ast.Pow: _NUMBERS,
    ast.BitAnd: _WHOLE_NUMBERS,
    ast.BitOr: _WHOLE_NUMBERS,
    ast.BitXor: _WHOLE_NUMBERS,
    ast.LShift: _WHOLE_NUMBERS,
    ast.RShift: _WHOLE_NUMBERS,
    ast.Lt: _SAME,
    ast.LtE: _SAME,
    ast.Gt: _SAME,
    ast.GtE: _SAME,
}
"""Kinds of the two sides that an operator takes."""
_DIVIDING: Final = (ast.Div, ast.FloorDiv, ast.Mod)


@rule(code="W264", since="0.3", needs_values=True)
def wrong_operands(program: AnalysedProgram) -> Iterator[Finding]:
    """Report operations that always fail; what stands in broken lines is not the author's."""
    broken = program.unread_lines
    for finding in _found(program):
        if not isinstance(finding.where, ast.expr) or finding.where.lineno not in broken:
            yield finding


def _found(program: AnalysedProgram) -> Iterator[Finding]:
    for node in program.nodes(ast.BinOp):
        if _is_zero(program, node) and not program.is_tried(node):
            yield Finding(node, said("{expression} divides by 0", expression=shown_source(program, node)), "")
            continue
        yield from _operands(program, node, node.op, node.left, node.right)
    for change in program.nodes(ast.AugAssign):
        # A list takes whatever can be gone through.
        before = program.values.before(change)
        if isinstance(change.target, ast.Name) and not before.kinds & LIST:
            name = ast.copy_location(ast.Name(change.target.id, ast.Load()), change.target)
            yield from _operands(program, change, change.op, (name, before), change.value)
    for sign in program.nodes(ast.UnaryOp):
        yield from _negated(program, sign)
    for loop in program.nodes(ast.For):
        yield from _gone_through(program, loop.iter)
    for part in program.nodes(ast.Subscript):
        yield from _indexed(program, part)
    for comparison in program.nodes(ast.Compare):
        if len(comparison.ops) == 1:
            yield from _operands(program, comparison, comparison.ops[0], comparison.left, comparison.comparators[0])
    for call in program.nodes(ast.Call):
        func = call.func
        if type(func) is ast.Name:
            if func.id in _COUNTING or func.id in _CONVERTING:
                yield from _steps(program, call, func.id)
        elif isinstance(func, ast.Attribute) and func.attr == "join":
            yield from _joined(program, call, func)
    if not any(isinstance(call.func, ast.Name) and call.func.id == "hasattr" for call in program.nodes(ast.Call)):
        for owned in program.nodes(ast.Attribute):
            if owned.attr not in _OF_PYTHON2:
                yield from _missing(program, owned)


_COUNTING: Final = ("range", "len")
_CONVERTING: Final = ("float", "int", "sum")

_TYPES: Final[dict[int, type]] = {
    BOOL: bool,
    INT: int,
    FLOAT: float,
    TEXT: str,
    BYTES: bytes,
    LIST: list,
    TUPLE: tuple,
    DICT: dict,
    NONE: type(None),
}
_MEANT: Final = {
    **dict.fromkeys(("length", "size", "len", "count"), "len({owner}) is how many there are"),
    **dict.fromkeys(("push", "push_back", "add", "put", "append"), "a list takes one more with {owner}.append(x)"),
    **dict.fromkeys(("contains", "includes", "has"), "ask `x in {owner}`"),
    **dict.fromkeys(("substring", "substr", "mid"), "a part of a text is {owner}[first:behind_the_last]"),
    **dict.fromkeys(("indexOf", "index_of", "indexof"), "{owner}.find(x) is the place of x, or -1"),
    **dict.fromkeys(("toUpperCase", "to_upper"), "{owner}.upper()"),
    **dict.fromkeys(("trim", "chomp"), "{owner}.strip()"),
    **dict.fromkeys(("x", "y", "z", "rx", "ry", "rz", "Rx", "Ry", "Rz"), "the elements are {owner}[0] to {owner}[5]"),
}
"""What is meant by names that other languages have for it."""


_OF_PYTHON2: Final = frozenset(("has_key", "iteritems", "iterkeys", "itervalues"))
"""Names that another rule tells."""


def _missing(program: AnalysedProgram, node: ast.Attribute) -> Iterator[Finding]:
    """Yield a method or attribute that no value of these kinds has."""
    if not isinstance(node.ctx, ast.Load) or node.attr.startswith("__"):
        return
    value = program.values.of(node.value)
    types = [kind for bit, kind in _TYPES.items() if value.kinds & bit]
    if not types or value.kinds & ~sum(_TYPES) or any(hasattr(kind, node.attr) for kind in types):
        return
    if program.is_tried(node) or not _is_built_in(value):
        return
    owner = ast.unparse(node.value)
    meant = _MEANT.get(node.attr)
    hint = "does a function return nothing?" if value.kinds == NONE else ""
    if meant is not None and value.kinds != NONE:
        hint = said(meant, owner=owner)
    text = said("{what}, which has no `{name}`", what=_said(program, node.value, value), name=node.attr)
    yield Finding(node, text, hint)


def _is_built_in(value: Value) -> bool:
    """Return whether a value is no object of a class of the program that is like one of Python's types."""
    return not value.refs


def _negated(program: AnalysedProgram, node: ast.UnaryOp) -> Iterator[Finding]:
    if type(node.operand) is ast.Constant and type(node.operand.value) in (int, float):
        return
    value = program.values.of(node.operand)
    is_number = (
        isinstance(node.op, (ast.Not, ast.Invert)) or not value.is_known or value.kinds & (NUMBER | OBJECT | NONE)
    )
    if not is_number and not program.is_tried(node):
        what = _said(program, node.operand, value)
        yield Finding(node, said("{what}: `-` does not take it", what=what), _advice(node.op, value, SOME_INT))


def _gone_through(program: AnalysedProgram, node: ast.expr) -> Iterator[Finding]:
    """Yield a loop over a number."""
    value = program.values.of(node)
    if value.kinds and not value.kinds & ~NUMBER and not program.is_tried(node):
        text = said("{what}, which no loop goes through", what=_said(program, node, value))
        yield Finding(node, text, said("range({number}) counts from 0", number=ast.unparse(node)))


def _indexed(program: AnalysedProgram, node: ast.Subscript) -> Iterator[Finding]:
    """Yield an element of a number, and an element of a list by a name."""
    value = program.values.of(node.value)
    if not value.kinds or program.is_tried(node):
        return
    if isinstance(node.ctx, ast.Store) and not value.kinds & ~(TEXT | BYTES | TUPLE):
        text = said("{what}, whose elements stay as they are", what=_said(program, node.value, value))
        hint = "make a list of it: list(x)" if value.kinds == TUPLE else "make a new text: s[:i] + c + s[i + 1:]"
        yield Finding(node, text, hint)
        return
    if not value.kinds & ~NUMBER:
        text = said("{what}, and has no elements", what=_said(program, node.value, value))
        yield Finding(node, text, "")
    elif not value.kinds & ~ROW and not isinstance(node.slice, ast.Slice):
        index = program.values.of(node.slice)
        if index.kinds and not index.kinds & ~(TEXT | FLOAT | NONE):
            text = said(
                "elements of a list are taken by whole numbers, and {what}", what=_said(program, node.slice, index)
            )
            yield Finding(node, text, "the first is 0")


def _is_zero(program: AnalysedProgram, node: ast.BinOp) -> bool:
    right = node.right
    is_written = isinstance(right, ast.Constant) and type(right.value) in (int, float) and right.value == 0
    if not isinstance(node.op, _DIVIDING) or not (is_written or isinstance(right, ast.Name)):
        return False
    if isinstance(node.left, (ast.JoinedStr, ast.List)) or program.values.of(node.left).kinds & (TEXT | BYTES):
        return False
    if is_written:
        return not (isinstance(node.left, ast.Constant) and isinstance(node.left.value, (str, bytes)))
    # A variable that is never anything else; where a condition stands around it, it may be a switch.
    if conditions(program.symbols, node):
        return False
    scope = program.symbols.scope_of(node)
    home = scope.home(right.id) if isinstance(right, ast.Name) else None
    value = program.values.of(right)
    if home is None or not value.has_constant or value.kinds & ~(INT | FLOAT) or value.constant != 0:
        return False
    return isinstance(right, ast.Name) and program.values.variable(right.id, scope).has_constant


def _operands(
    program: AnalysedProgram, node: ast.AST, op: ast.AST, first: ast.expr | tuple[ast.expr, Value], right: ast.expr
) -> Iterator[Finding]:
    """Yield an operator that does not take its sides; the first with its value where that is not what it is now."""
    left, one = first if isinstance(first, tuple) else (first, program.values.of(first))
    allowed = _ALLOWED.get(type(op))
    if allowed is None or (
        isinstance(left, ast.Constant) and isinstance(right, ast.Constant) and left.value == right.value
    ):
        return
    values = (one, program.values.of(right))
    if not all(value.is_known and not value.kinds & (OBJECT | SET | DICT | FUNCTION) for value in values):
        return
    one, other = values
    if any(one.kinds & a and other.kinds & b for a, b in allowed) or program.is_tried(node):
        return
    if isinstance(op, ast.Sub) and (one.kinds | other.kinds) & LIST and not (one.kinds | other.kinds) & TEXT:
        hint = "pose_sub, or element by element: [a - b for a, b in zip(p, q)]"
    else:
        hint = _advice(op, one, other)
    text = said(
        "{left}, {right}: `{sign}` does not take them",
        left=_said(program, left, one),
        right=_said(program, right, other),
        sign=SIGNS[type(op)],
    )
    yield Finding(node, text, hint)


def _said(program: AnalysedProgram, node: ast.expr, value: Value) -> str:
    if isinstance(node, ast.Constant):
        return said(
            "{expression} is a {kind}",
            expression=shown_source(program, node),
            kind=Said("text" if value.kinds & (TEXT | BYTES) else "number"),
        )
    return said("{expression} is {words}", expression=shown_source(program, node), words=phrase(value))


def _advice(op: ast.AST, one: Value, other: Value) -> str:
    both = one.kinds | other.kinds
    if isinstance(op, ast.BitXor) and not both & ~NUMBER:
        return "`**` is the power"
    if isinstance(op, (ast.BitAnd, ast.BitOr)) and not both & ~NUMBER:
        return "`and` and `or` join conditions"
    if both & TEXT and both & NUMBER:
        return "str(x) makes a text of a number" if isinstance(op, ast.Add) else "to_num(x) makes a number of a text"
    if both & BYTES and both & (NUMBER | TEXT):
        return "x.decode() makes a text of bytes, and to_num(...) a number of that"
    if both & LIST and both & NUMBER:
        return "take an element, x[0], or go through the list: [2 * a for a in p]"
    if both & NONE:
        return "does a function return nothing?"
    return "make a list of it: list(x)" if both & RANGE else ""


def _steps(program: AnalysedProgram, call: ast.Call, name: str) -> Iterator[Finding]:
    """Yield arguments of `range`, `len`, `float`, `int` and `sum` that these do not take."""
    if program.symbols.scope_of(call).resolve(name) is not Resolution.BUILTIN:
        return
    if name in _CONVERTING:
        yield from _converted(program, call, name)
        return
    if name == "len":
        value = program.values.of(call.args[0]) if len(call.args) == 1 else None
        if value is not None and value.kinds and not value.kinds & ~(NUMBER | NONE) and not program.is_tried(call):
            yield Finding(
                call.args[0],
                said(
                    "{expression} is {words}, and has no length",
                    expression=shown_source(program, call.args[0]),
                    words=phrase(value),
                ),
                "",
            )
        return
    for node in call.args:
        value = program.values.of(node)
        if value.is_known and not value.kinds & (WHOLE | OBJECT | SET) and not program.is_tried(call):
            hint = "int(x) makes a whole number; [n / 10 for n in range(10)] goes in steps of 0.1"
            if value.kinds == LIST:
                hint = "range(len(x)) counts the elements of a list"
            elif value.kinds & ~(INT | FLOAT):
                hint = ""
            number = value.constant if value.has_constant and value.kinds == FLOAT and abs(value.low) < inf else 0.5
            if number == int(number):
                hint = said("write {number}", number=int(number))
            what = _said(program, node, value)
            yield Finding(node, said("range takes whole numbers, and {what}", what=what), hint)
            return


def _joined(program: AnalysedProgram, call: ast.Call, method: ast.Attribute) -> Iterator[Finding]:
    """Yield numbers that are joined as if they were texts."""
    if len(call.args) != 1 or program.values.of(method.value).kinds != TEXT or program.is_tried(call):
        return
    shape = program.values.of(call.args[0]).shape
    element = None if shape is None or shape.least < 1 else shape.any
    if element is not None and element.is_number:
        node = call.args[0]
        text = said("{expression} has numbers, and join takes texts", expression=shown_source(program, node))
        yield Finding(node, text, said("write map(str, {expression})", expression=ast.unparse(node)))


def _converted(program: AnalysedProgram, call: ast.Call, name: str) -> Iterator[Finding]:
    """Yield what no number can be made of: lists for `float` and `int`, texts in a list for `sum`."""
    if len(call.args) != 1 or program.is_tried(call):
        return
    node = call.args[0]
    value = program.values.of(node)
    if name == "sum":
        shape = value.shape
        element = None if shape is None or shape.least < 1 else shape.any
        if element is not None and element.kinds == TEXT:
            text = said("{expression} has texts, and sum takes numbers", expression=shown_source(program, node))
            yield Finding(node, text, said("write sum(map(float, {expression}))", expression=ast.unparse(node)))
    elif value.kinds and not value.kinds & ~(ROW | DICT | SET | RANGE | NONE | FUNCTION):
        text = said("{what}, and {name} makes no number of it", what=_said(program, node, value), name=name)
        hint = "take an element, x[0], or go through the list: [float(a) for a in x]" if value.kinds & ROW else ""
        yield Finding(node, text, hint)
