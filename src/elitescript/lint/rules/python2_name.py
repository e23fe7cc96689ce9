"""A name that only Python 2 has.

Older manuals list `long` and `unichr`, which work here with this warning; the others are alarms (`NameError`,
`AttributeError`, `TypeError`) when they are reached. A Python 3 controller has none of them, so all are errors
in strict mode.

    def job():
      for n in xrange(3):        # W209: range
        textmsg(unichr(65 + n))  # W209: chr
      end
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.language.diagnostics import Edit, Fix
from elitescript.language.symbols import Resolution
from elitescript.lint.program import AnalysedProgram, Span
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="W209", since="0.1", instead_of=("W201", "E301"))
def python2_name(program: AnalysedProgram) -> Iterator[Finding]:
    """Report names, methods and the old form of `sort`."""
    for use in program.outside:
        is_old = use.name in _NAMES and use.name not in program.unread_names
        if is_old and not program.expects_missing_names(use.node):
            new, hint = _NAMES[use.name]
            fix = _replacement(program.span(use.node), new) if new else None
            text = said("`{name}` is Python 2; a Python 3 controller does not know it", name=use.name)
            yield Finding(use.node, text, hint or said("write {new}", new=new), fix)
    for call in program.nodes(ast.Call):
        if isinstance(call.func, ast.Attribute):
            yield from _method(call, call.func, program)


_NAMES: Final = {
    "basestring": ("str", ""),
    "execfile": ("", "put the lines into the program"),
    "long": ("int", "write int: integers have no limit"),
    "raw_input": ("", "a program has no terminal to read from; use an input or a register"),
    "reduce": ("", "write `from functools import reduce` before it, or a loop"),
    "unichr": ("chr", ""),
    "unicode": ("str", ""),
    "xrange": ("range", ""),
}
"""Each name with its replacement, if that is a name, and the hint."""

_ITERATORS: Final = {"iteritems": "items", "iterkeys": "keys", "itervalues": "values"}


def _method(call: ast.Call, function: ast.Attribute, program: AnalysedProgram) -> Iterator[Finding]:
    name = function.attr
    if name not in ("has_key", "sort", *_ITERATORS) or _is_own_method(name, program):
        return
    place = _attribute_span(function, program)
    if name == "has_key" and len(call.args) == 1 and not call.keywords:
        fix = _membership(call, function, program)
        text = "dictionaries have no `has_key` in Python 3"
        yield Finding(place, text, "write `key in dictionary`", fix)
    elif name in _ITERATORS and not call.args and not call.keywords:
        new = _ITERATORS[name]
        text = said("dictionaries have no `{name}` in Python 3", name=name)
        yield Finding(place, text, said("write {new}()", new=new), _replacement(place, new))
    elif name == "sort" and call.args and not _is_module(function.value, program):
        text = "`sort` takes no comparing function in Python 3: it has no positional arguments"
        hint = "write sort(key=...), with functools.cmp_to_key for a comparing function"
        yield Finding(call.args[0], text, hint)


def _is_own_method(name: str, program: AnalysedProgram) -> bool:
    """Return whether a class of the program has a method of that name."""
    return any(scope.kind == "class" and name in scope.bindings for scope in program.symbols.scopes)


def _is_module(node: ast.expr, program: AnalysedProgram) -> bool:
    if not isinstance(node, ast.Name):
        return False
    scope = program.symbols.scope_of(node)
    if scope.resolve(node.id) is Resolution.BUILTIN:
        return True
    return any(binding.kind == "import" for binding in program.symbols.bindings(node.id, scope))


def _attribute_span(node: ast.Attribute, program: AnalysedProgram) -> Span:
    _, _, line, end = program.span(node)
    return Span(line, end - len(node.attr), line, end)


def _replacement(span: Span, new: str) -> Fix:
    return Fix(said("write {new}", new=new), (Edit(*span, new),), safe=True)


def _membership(call: ast.Call, function: ast.Attribute, program: AnalysedProgram) -> Fix | None:
    span = program.span(call)
    if span.line != span.end_line:
        return None
    row = program.source.line(span.line)
    key, owner = (program.span(node) for node in (call.args[0], function.value))
    new = f"({row[key.column - 1 : key.end_column - 1]} in {row[owner.column - 1 : owner.end_column - 1]})"
    return Fix("write `in`", (Edit(*span, new),), safe=False)
