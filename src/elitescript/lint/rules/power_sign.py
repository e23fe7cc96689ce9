"""`^` where a power is meant: it compares bits.

A power is written `**`, or `pow(x, 2)`.

    def job():
      d = sqrt(3 ^ 2 + 4 ^ 2)                     # W279: 3 ** 2 + 4 ** 2
      flags = read_input_integer_register(0)
      write_output_integer_register(0, flags ^ 1) # fine: turns one bit over
      textmsg(d)
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.language.diagnostics import Edit, Fix
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule, shown_source
from elitescript.said import said

_SUMS = (ast.Add, ast.Sub)


@rule(code="W279", since="0.3", instead_of=("W264",))
def power_sign(program: AnalysedProgram) -> Iterator[Finding]:
    """Report powers of numbers that are written out, squares in a sum, and squares under a root."""
    for node in program.nodes(ast.BinOp):
        above = program.symbols.parent(node)
        if _is_xor(node) and not _is_xor(above) and _is_power(node, above):
            text = said("{expression}: `^` compares bits, and is no power", expression=shown_source(program, node))
            left, right = program.span(node.left), program.span(node.right)
            fix = None
            between = program.source.line(right.line)[left.end_column - 1 : right.column - 1]
            if left.end_line == right.line and between.strip() == "^" and _is_number(node.right):
                edit = Edit(left.end_line, left.end_column, right.line, right.column, " ** ")
                fix = Fix("write **", (edit,), safe=False)
            yield Finding(node, text, "a power is written `**`: x ** 2", fix)


def _is_power(node: ast.BinOp, above: ast.AST | None) -> bool:
    if isinstance(node.right, ast.BinOp) and isinstance(node.right.op, _SUMS) and _is_exponent(node.right.left):
        # `+` binds closer: `a ^ 2 + b ^ 2` is a ^ (2 + b) ^ 2.
        return True
    if _is_xor(node.left) and isinstance(node.left, ast.BinOp):
        return _is_power(node.left, node)
    if not _is_exponent(node.right):
        return False
    if _is_number(node.left) or _is_root(above, node):
        return True
    if not isinstance(above, ast.BinOp) or not isinstance(above.op, _SUMS):
        return False
    # Of two squares the first is told.
    other = above.right if above.left is node else above
    return isinstance(other, ast.BinOp) and _is_xor(other) and _is_exponent(other.right)


def _is_xor(node: ast.AST | None) -> bool:
    return isinstance(node, ast.BinOp) and isinstance(node.op, ast.BitXor)


def _is_number(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and type(node.value) in (int, float)


def _is_exponent(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and type(node.value) is int and node.value in (2, 3)


def _is_root(above: ast.AST | None, node: ast.BinOp) -> bool:
    if not isinstance(above, ast.Call) or node not in above.args:
        return False
    name = above.func.id if isinstance(above.func, ast.Name) else getattr(above.func, "attr", "")
    return name == "sqrt"
