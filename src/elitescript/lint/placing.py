"""Compares where statements stand: under which conditions, and in which loops."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.language.symbols import Symbols

_FUNCTIONS = (ast.FunctionDef, ast.Lambda, ast.ClassDef)

Condition = tuple[ast.AST, str]
"""A statement or expression, and the part of it that is not always run."""


def conditions(symbols: Symbols, node: ast.AST) -> list[Condition]:
    """Return under which conditions a node is run when its function is, from inside out."""
    found: list[Condition] = []
    child = node
    for above in symbols.ancestors(node):
        if isinstance(above, _FUNCTIONS):
            break
        part = _part(symbols, above, child)
        if part:
            found.append((above, part))
        child = above
    return found


def _part(symbols: Symbols, above: ast.AST, child: ast.AST) -> str:
    """Return the part of a node in which a child stands, if that is not always run; else an empty text."""
    if isinstance(above, (ast.If, ast.While, ast.For)):
        return symbols.block_of(child)[0]
    if isinstance(above, ast.Try):
        return "orelse" if symbols.block_of(child)[0] == "orelse" else ""
    if isinstance(above, (ast.ExceptHandler, ast.match_case)):
        return "body"
    if isinstance(above, ast.IfExp):
        return "" if child is above.test else "body" if child is above.body else "orelse"
    if isinstance(above, ast.BoolOp):
        return "" if child is above.values[0] else str(above.values.index(child)) if child in above.values else ""
    return ""


def loops(symbols: Symbols, node: ast.AST) -> Iterator[ast.For | ast.While]:
    """Yield the loops of the same function that repeat a node, from inside out."""
    child = node
    for above in symbols.ancestors(node):
        if isinstance(above, _FUNCTIONS):
            return
        if isinstance(above, ast.While):
            is_repeated = symbols.block_of(child)[0] != "orelse"
        else:
            is_repeated = isinstance(above, ast.For) and symbols.block_of(child)[0] == "body"
        if is_repeated and isinstance(above, (ast.For, ast.While)):
            yield above
        child = above
