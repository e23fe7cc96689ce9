"""The handle of a thread where the result of its function is meant.

What the function of a thread returns is lost; `start_thread` returns a handle for `stop_thread` and `join_thread`. A
global or a `nonlocal` variable brings a value back.

    def job():
      def measure():
        sleep(0.1)
        return 0.25
      end
      height = start_thread(measure, ())
      join_thread(height)                         # fine
      set_standard_analog_out(0, height)          # W254: this is the handle
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.commands.definition.quantities import Integer, Number, Optionally
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said
from elitescript.values.description import INT
from elitescript.values.results import HANDLE

_TAKING: Final = ("stop_thread", "join_thread", "start_thread")


@rule(code="W254", since="0.3", needs_values=True)
def handle_as_value(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each such use."""
    arguments: dict[ast.expr, str] = {}
    for found, placed in zip(program.command_calls, program.arguments, strict=True):
        for param, node in placed.given:
            quantity = param.quantity.inner if isinstance(param.quantity, Optionally) else param.quantity
            if isinstance(quantity, (Number, Integer)) and found.command.name not in _TAKING:
                arguments[node] = found.command.name
            elif isinstance(node, (ast.List, ast.Tuple)) and found.command.name not in _TAKING:
                arguments.update(dict.fromkeys(node.elts, found.command.name))
    nodes: list[ast.expr] = [node for node in program.nodes(ast.Name) if isinstance(node.ctx, ast.Load)]
    for node in [*nodes, *program.nodes(ast.Call)]:
        value = program.values.of(node)
        if value.role != HANDLE or value.kinds != INT:
            continue
        above = program.symbols.parent(node)
        where = arguments.get(node, "")
        is_value = isinstance(above, ast.BinOp) or (isinstance(above, ast.Compare) and _is_a_value(above))
        if where or is_value or _is_condition(above, node):
            text = said(
                "`{expression}` is the handle of a thread, not what its function returns", expression=ast.unparse(node)
            )
            hint = "what a thread returns is lost: let it write a global or `nonlocal` variable"
            yield Finding(node, said("{command}: {text}", command=where, text=text) if where else text, hint)


def _is_a_value(node: ast.Compare) -> bool:
    """Return whether a comparison asks for True or a number with decimals, which no handle is."""
    sides = (node.left, *node.comparators)
    return any(isinstance(side, ast.Constant) and isinstance(side.value, (float, bool)) for side in sides)


def _is_condition(above: ast.AST | None, node: ast.expr) -> bool:
    """Return whether a handle is asked for its truth: it is always true."""
    if isinstance(above, (ast.If, ast.While, ast.IfExp)):
        return above.test is node
    return isinstance(above, ast.UnaryOp) and isinstance(above.op, ast.Not)
