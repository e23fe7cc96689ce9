"""Doubts about values, as findings of rules."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

from elitescript.commands.definition.plausibility import Doubt
from elitescript.lint.registry import Finding

if TYPE_CHECKING:
    from elitescript.lint.program import AnalysedProgram


class Doubted(NamedTuple):
    """A doubt about an argument, and where that stands."""

    node: ast.expr
    doubt: Doubt


def element(node: ast.expr, index: int | None) -> ast.expr:
    """Return the element of a list that is written out; else the whole expression."""
    if index is not None and isinstance(node, (ast.List, ast.Tuple)) and index < len(node.elts):
        return node.elts[index]
    return node


def findings(program: AnalysedProgram, code: str) -> Iterator[Finding]:
    """Yield the findings of the rule for one code."""
    for node, doubt in program.doubts:
        if doubt.code == code:
            yield Finding(node, doubt.text, doubt.hint)
