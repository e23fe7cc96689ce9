"""A pose as URScript writes it: `p[x, y, z, rx, ry, rz]`.

To Python this takes an element of something called `p`: an alarm when it is reached. Poses are plain lists.

    def job():
      movel(p[0.4, 0, 0.3, 0, 3.14, 0])      # W211: leave the `p` out
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.language.diagnostics import Edit, Fix
from elitescript.language.symbols import Resolution
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule


@rule(code="W211", since="0.1", instead_of=("W201",))
def pose_literal(program: AnalysedProgram) -> Iterator[Finding]:
    """Report `p[...]` where `p` is nothing, or has six numbers between its brackets."""
    for node in program.nodes(ast.Subscript):
        name = node.value
        if not isinstance(name, ast.Name) or name.id != "p":
            continue
        has_six = isinstance(node.slice, ast.Tuple) and len(node.slice.elts) == 6
        is_nothing = program.symbols.scope_of(name).resolve("p") is Resolution.BUILTIN
        if has_six or (is_nothing and isinstance(node.slice, ast.Tuple)):
            fix = Fix("leave the `p` out", (Edit(*program.span(name), ""),), safe=True)
            yield Finding(node, "`p[...]` is a pose of URScript; here a pose is a list", "leave the `p` out", fix)
