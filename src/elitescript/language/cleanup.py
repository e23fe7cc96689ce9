"""Finds the lines of a text that run when something has gone wrong, or in any case: those of `except` and `finally`."""

from __future__ import annotations

import ast

from elitescript.language.parser import parse
from elitescript.language.text.source import SourceFile


def cleanup_lines(source: SourceFile) -> frozenset[int]:
    """Return the lines of all blocks of `except` and `finally`; none of a text that does not parse."""
    found: set[int] = set()
    for node in ast.walk(parse(source).tree):
        if isinstance(node, ast.Try | ast.TryStar):
            for block in (*(handler.body for handler in node.handlers), node.finalbody):
                if block:
                    found.update(range(block[0].lineno, (block[-1].end_lineno or block[-1].lineno) + 1))
    return frozenset(found)
