"""Reuses the trees of the functions of a program that are as they were in the version before.

A tool reads a program again for each character that is typed, and Python's parser takes half of that time. Here a
program is cut in front of its functions, each piece is parsed by itself behind as many empty lines as stand above it,
and the pieces whose text and line are those of before are not parsed at all. The tree is that of the whole text.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence

from elitescript.language.text.lexer import LogicalLine


class Pieces:
    """Holds the pieces of the last text that was read; nothing may change their nodes."""

    __slots__ = ("_known",)

    def __init__(self) -> None:
        self._known: dict[tuple[int, str], list[ast.stmt]] = {}

    def tree(
        self, rows: Sequence[str], lines: Sequence[LogicalLine], parse: Callable[[str], ast.Module]
    ) -> ast.Module | None:
        """Return the tree of a text; None if it has to be parsed as a whole.

        Args:
            rows: its lines, as Python sees them.
            lines: its logical lines; none of them is longer or shorter in `rows`.
            parse: Python's parser.

        Raises:
            SyntaxError: it has a mistake; its place need not be the right one.
        """
        cuts = _cuts(rows, lines)
        if not cuts:
            return None
        indentation = _indentation(rows[cuts[0] - 1])
        head = parse("\n".join([*rows[: cuts[0] - 1], f"{indentation}pass"]))
        if len(head.body) != 1 or not isinstance(unit := head.body[0], ast.FunctionDef):
            return None
        del unit.body[-1]
        ends = [*cuts[1:], len(rows) + 1]
        keys = [(start, "\n".join(rows[start - 1 : end - 1])) for start, end in zip(cuts, ends, strict=True)]
        known = {key: self._known[key] for key in keys if key in self._known}
        fresh: list[tuple[int, str]] = []
        for key in [*keys, None]:
            if key is not None and key not in known:
                fresh.append(key)
            elif fresh:
                if not _read(fresh, parse, known):
                    return None
                fresh = []
        self._known = known
        for key in keys:
            unit.body += known[key]
        unit.end_lineno, unit.end_col_offset = unit.body[-1].end_lineno, unit.body[-1].end_col_offset
        return head


def _cuts(rows: Sequence[str], lines: Sequence[LogicalLine]) -> list[int]:
    """Return the lines of the functions directly inside the one that is the whole program; none if it is no such."""
    if len(lines) < 3 or lines[0].word != "def" or lines[0].column or lines[0].line == lines[1].line:
        return []
    column = lines[1].column
    if not column or any(line.column == 0 and line.word != "end" for line in lines[1:]):
        return []
    found = [line.line for line in lines[1:] if line.word == "def" and line.column == column]
    indentation = _indentation(rows[lines[1].line - 1])
    # A decorator, or a backslash on a line of its own, would belong to the piece above its function.
    if any(row.lstrip().startswith("@") for row in rows) or any(
        _indentation(rows[line - 1]) != indentation or rows[line - 2].endswith("\\") for line in found
    ):
        return []
    return found


def _indentation(row: str) -> str:
    return row[: len(row) - len(row.lstrip(" \t\f"))]


def _read(
    keys: list[tuple[int, str]], parse: Callable[[str], ast.Module], known: dict[tuple[int, str], list[ast.stmt]]
) -> bool:
    """Parse neighbouring pieces at once; False if they are not statements of one block."""
    first = keys[0][0]
    module = parse("\n" * (first - 2) + "if 1:\n" + "\n".join(text for _, text in keys))
    if len(module.body) != 1 or not isinstance(block := module.body[0], ast.If) or block.orelse:
        return False
    for key in keys:
        known[key] = []
    index = 0
    for statement in block.body:
        while index + 1 < len(keys) and statement.lineno >= keys[index + 1][0]:
            index += 1
        known[keys[index]].append(statement)
    return True
