"""A call without its parentheses: `sync` where `sync()` was meant.

The name alone is the command or function itself, a value that is always true; nothing waits, reads or moves.
Reported is where that can be no purpose: as a statement and in a condition; of a command, and of a method of a text
or list, also in a calculation, and given to a name that is never called.

    while True:
      sync                                   # W215: write `sync()`
      if get_flag:                           # W215: always true
        words = "a b".split                  # W215: a method, no list
        textmsg(words[0])
      end
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.language.diagnostics import Edit, Fix
from elitescript.language.symbols import Scope
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import Said, said

_OPERATIONS = (ast.BoolOp, ast.BinOp, ast.Compare, ast.UnaryOp, ast.If, ast.While, ast.IfExp, ast.Assert)


@rule(code="W215", since="0.1", needs_values=True)
def uncalled_command(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the name of a command or function where only its call can be meant."""
    yield from _commands(program)
    yield from _functions(program)
    yield from _methods(program)


def _methods(program: AnalysedProgram) -> Iterator[Finding]:
    """Yield methods of texts, numbers, lists and dicts in calculations, and given to a name that is never called."""
    for node in program.nodes(ast.Attribute):
        parent = program.symbols.parent(node)
        if isinstance(parent, ast.Call) and parent.func is node:
            continue
        is_asked = _is_condition(node, parent)
        if not is_asked and not (isinstance(parent, (*_OPERATIONS, ast.Assign)) and _wants_the_result(program, node)):
            continue
        # Imported late: short programs do without values.
        from elitescript.values.references import Method

        refs = program.values.of(node).refs
        if refs is not None and len(refs) == 1 and isinstance(refs[0], Method):
            yield _finding(program, node, "method", needs_arguments=node.attr not in _PLAIN_METHODS)


_PLAIN_METHODS = frozenset(
    """
    capitalize clear copy decode encode isalnum isalpha isdigit islower isspace isupper items keys lower lstrip pop
    reverse rstrip sort split splitlines strip title upper values
    """.split()  # noqa: SIM905
)
"""Methods that are called without arguments."""


def _commands(program: AnalysedProgram) -> Iterator[Finding]:
    for use in program.outside:
        command = program.command(use.name, use.scope)
        if command is None or use.is_call or not _wants_the_result(program, use.node):
            continue
        needs_arguments = any(param.is_required for param in command.params)
        yield _finding(program, use.node, "command", needs_arguments=needs_arguments)


def _functions(program: AnalysedProgram) -> Iterator[Finding]:
    """Yield names of functions of the program, and of Python's own ones, as statements and conditions."""
    for node in _judged(program):
        if not isinstance(node, ast.Name):
            continue
        scope = program.symbols.scope_of(node)
        functions = _only_functions(node.id, scope, program)
        if functions:
            yield _finding(program, node, "function", needs_arguments=any(map(_needs_arguments, functions)))
    for use in program.outside:
        if use.name in _BUILTINS and isinstance(program.symbols.parent(use.node), ast.Expr):
            yield _finding(program, use.node, "function", needs_arguments=use.name not in _WITHOUT_ARGUMENTS)


_BUILTINS = frozenset(("exit", "input", "quit"))
_WITHOUT_ARGUMENTS = frozenset(("exit", "quit"))


def _finding(program: AnalysedProgram, node: ast.Name | ast.Attribute, kind: str, *, needs_arguments: bool) -> Finding:
    line, _, end_line, end_column = program.span(node)
    fix = None
    if not needs_arguments:
        fix = Fix("call it", (Edit(line, end_column, end_line, end_column, "()"),), safe=True)
    name = ast.unparse(node)
    return Finding(
        node,
        said(
            "`{name}` without parentheses is the {kind} itself, which does nothing and is always true",
            name=name,
            kind=Said(kind),
        ),
        said("write {name}(...)", name=name) if needs_arguments else said("write {name}()", name=name),
        fix,
    )


def _is_condition(node: ast.expr, parent: ast.AST | None) -> bool:
    if isinstance(parent, (ast.If, ast.While, ast.IfExp, ast.Assert)):
        return parent.test is node
    return isinstance(parent, ast.UnaryOp) and isinstance(parent.op, ast.Not)


def _judged(program: AnalysedProgram) -> Iterator[ast.expr]:
    """Yield statements that are expressions, and conditions."""
    for statement in program.nodes(ast.Expr):
        yield statement.value
    for kind in (ast.If, ast.While, ast.IfExp, ast.Assert):
        for asked in program.nodes(kind):
            yield asked.test  # type: ignore[attr-defined]
    for sign in program.nodes(ast.UnaryOp):
        if isinstance(sign.op, ast.Not):
            yield sign.operand


def _only_functions(name: str, scope: Scope, program: AnalysedProgram) -> list[ast.FunctionDef]:
    """Return the functions that a name stands for; none if it may be something else."""
    functions = []
    for binding in program.symbols.bindings(name, scope):
        if not isinstance(binding.node, ast.FunctionDef):
            return []
        functions.append(binding.node)
    return functions


def _needs_arguments(function: ast.FunctionDef) -> bool:
    args = function.args
    return len(args.posonlyargs) + len(args.args) > len(args.defaults) or None in args.kw_defaults


def _wants_the_result(program: AnalysedProgram, node: ast.expr) -> bool:
    parent = program.symbols.parent(node)
    if isinstance(parent, ast.Expr):
        return True
    if isinstance(parent, _OPERATIONS):
        # `f == sync` and `f is sync` test which function f is.
        return not isinstance(parent, ast.Compare) or not all(
            isinstance(operator, (ast.Eq, ast.NotEq, ast.Is, ast.IsNot)) for operator in parent.ops
        )
    if isinstance(parent, ast.Assign) and parent.value is node:
        targets = [target.id for target in parent.targets if isinstance(target, ast.Name)]
        return len(targets) == len(parent.targets) and program.derived(_used_as_functions).isdisjoint(targets)
    return False


def _used_as_functions(program: AnalysedProgram) -> frozenset[str]:
    """Return the names that are called, or passed on to what may call them."""
    return frozenset(
        node.id
        for node in program.nodes(ast.Name)
        if isinstance(node.ctx, ast.Load) and not _is_no_function(program.symbols.parent(node), node)
    )


def _is_no_function(parent: ast.AST | None, node: ast.Name) -> bool:
    """Return whether a value is used where no function can be meant."""
    if isinstance(parent, ast.Subscript):
        return parent.value is node
    if isinstance(parent, ast.For):
        return parent.iter is node
    return isinstance(parent, (ast.Expr, *_OPERATIONS))
