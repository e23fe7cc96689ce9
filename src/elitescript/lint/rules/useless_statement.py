"""A statement that does nothing: a name, a comparison, a list alone on its line.

Python works out the value and throws it away. Mostly something is missing: `==` stands where `=` was meant, the
parentheses of a method, or the line belongs to the one above it. Texts in quotes serve as comments, and in a
`try` a program may only test whether something exists; both are left alone.

    def job():
      parts == 0                 # W218: is `parts = 0` meant?
      box.close                  # W218: write box.close()
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.language.diagnostics import Edit, Fix
from elitescript.language.options import LINE
from elitescript.language.symbols import Resolution
from elitescript.lint.effects import has_effect
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="W218", since="0.2", needs_values=True)
def useless_statement(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each such statement."""
    if program.parsed.options.kind == LINE:
        return
    has_operators = _defines_operators(program)
    properties = {function.name for function in program.nodes(ast.FunctionDef) if function.decorator_list}
    for statement in program.nodes(ast.Expr):
        value = statement.value
        if program.is_tried(statement):
            continue
        if isinstance(value, ast.Compare) and not has_operators:
            yield _comparison(value, program)
        elif isinstance(value, ast.Name):
            scope = program.symbols.scope_of(value)
            is_function = bool(program.symbols.definitions(value.id, scope))
            if scope.resolve(value.id) is not Resolution.BUILTIN and not is_function:
                text = said("this line only names `{name}`: nothing happens", name=value.id)
                yield Finding(value, text, "give it a value with `=`, use it, or remove the line")
        elif isinstance(value, ast.Attribute) and value.attr not in properties and not has_effect(value, program):
            call = f"{ast.unparse(value)}()"
            yield Finding(
                value, "this line only names an attribute: nothing is called", said("write {call}", call=call)
            )
        elif isinstance(value, _PLAIN) and not has_effect(value, program) and not _is_text(value):
            yield Finding(value, "this line only makes a value: nothing happens", "use it, or remove the line")


_PLAIN = (
    ast.Constant,
    ast.List,
    ast.Tuple,
    ast.Dict,
    ast.Set,
    ast.Subscript,
    ast.Lambda,
    ast.BoolOp,
    ast.IfExp,
    ast.ListComp,
    ast.SetComp,
    ast.DictComp,
    ast.GeneratorExp,
    ast.JoinedStr,
)
_OPERATOR_FREE = frozenset(("__init__", "__str__", "__repr__", "__call__", "__enter__", "__exit__", "__len__"))


def _is_text(value: ast.expr) -> bool:
    """Return whether it is a comment in quotes, or the three dots of a body still to be written."""
    return isinstance(value, ast.Constant) and (isinstance(value.value, (str, bytes)) or value.value in (..., None))


def _defines_operators(program: AnalysedProgram) -> bool:
    """Return whether a class of the program gives operators a meaning of their own."""
    return any(
        isinstance(inner, ast.FunctionDef) and inner.name.startswith("__") and inner.name not in _OPERATOR_FREE
        for node in program.nodes(ast.ClassDef)
        for inner in node.body
    )


def _comparison(value: ast.Compare, program: AnalysedProgram) -> Finding:
    text = "this line only compares, and its result is not used"
    is_assignment = (
        len(value.ops) == 1
        and isinstance(value.ops[0], ast.Eq)
        and isinstance(value.left, (ast.Name, ast.Attribute, ast.Subscript))
    )
    if not is_assignment:
        return Finding(value, text, "put it into an `if` or a `while`, or remove the line")
    _, _, line, column = program.span(value.left)
    end_line, end_column, _, _ = program.span(value.comparators[0])
    between = program.source.line(line)[column - 1 : end_column - 1]
    if line != end_line or between.strip() != "==":
        return Finding(value, text, "`=` assigns, `==` compares")
    edit = Edit(line, column, end_line, end_column, between.replace("==", "="))
    target, new = ast.unparse(value.left), ast.unparse(value.comparators[0])
    hint = (
        said("is `{target} = {new}` meant?", target=target, new=new)
        if len(target) + len(new) <= _LONGEST
        else "is `=` meant?"
    )
    return Finding(value, text, hint, Fix("assign", (edit,), safe=False))


_LONGEST = 60
"""Characters of an assignment that the hint spells out."""
