"""Parses a program in pieces, and reuses the trees of those that are as they were in the version before.

Python's parser needs a few kilobytes for each line until it has read the whole text, so a long text is cut in front of
statements of its outermost block, and each piece is parsed by itself behind as many empty lines as stand above it. A
tool reads a program again for each character that is typed: pieces whose text and line are those of before are not
parsed at all. The tree is that of the whole text.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence
from typing import Any, Final

from elitescript.language.nodes import children
from elitescript.language.text.flat import CLAUSES
from elitescript.language.text.lexer import LogicalLine

PIECE_LINES: Final = 100
"""Lines of a piece, if its last statement ends then; a function is a piece of its own."""
READ_LINES: Final = 400
"""Lines that are parsed at once."""

_UNITS: Final = ("def", "sec")
_CONTINUING: Final = CLAUSES | {"case", "end"}


class Pieces:
    """Holds the pieces of the last text that was read; nothing else may change their nodes.

    Args:
        may_move: pieces that stand in other lines are used again too, with the lines of their nodes changed: the tree
            of the version before is of no use then.
    """

    __slots__ = ("_known", "_may_move")

    def __init__(self, *, may_move: bool = False) -> None:
        self._may_move = may_move
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
        is_unit = len(lines) > 2 and _is_unit(lines)
        cuts = _cuts(rows, lines[1:] if is_unit else lines)
        if not cuts:
            return None
        indentation = _indentation(rows[cuts[0] - 1])
        head = parse("\n".join([*rows[: cuts[0] - 1], f"{indentation}pass"]))
        unit = head.body[0] if is_unit and len(head.body) == 1 else None
        if is_unit and not isinstance(unit, ast.FunctionDef):
            return None
        block = unit.body if isinstance(unit, ast.FunctionDef) else head.body
        del block[-1]
        ends = [*cuts[1:], len(rows) + 1]
        texts = ["\n".join(rows[start - 1 : end - 1]).rstrip() for start, end in zip(cuts, ends, strict=True)]
        keys = list(zip(cuts, texts, strict=True))
        known = {key: self._known[key] for key in keys if key in self._known}
        if self._may_move:
            self._move(keys, known)
        fresh: list[tuple[int, str]] = []
        for key in [*keys, None]:
            if fresh and (key is None or key in known or key[0] - fresh[0][0] > READ_LINES):
                if not _read(fresh, parse, known, is_inside=is_unit):
                    return None
                fresh = []
            if key is not None and key not in known:
                fresh.append(key)
        self._known = known
        for key in keys:
            block += known[key]
        if unit is not None:
            unit.end_lineno, unit.end_col_offset = _end(block[-1], rows)
        return head

    def _move(self, keys: Sequence[tuple[int, str]], known: dict[tuple[int, str], list[ast.stmt]]) -> None:
        """Use pieces that stand in other lines now; `known` gets them."""
        left: dict[str, list[int]] = {}
        for start, text in self._known:
            if (start, text) not in known:
                left.setdefault(text, []).append(start)
        for start, text in keys:
            if (start, text) not in known and left.get(text):
                before = left[text].pop(0)
                statements = self._known.pop((before, text))
                _shift(statements, start - before)
                known[start, text] = self._known[start, text] = statements


def _shift(statements: Sequence[ast.stmt], lines: int) -> None:
    """Change the lines of nodes."""
    stack: list[Any] = [*statements]
    while stack:
        node = stack.pop()
        if hasattr(node, "lineno"):
            node.lineno += lines
            if node.end_lineno is not None:
                node.end_lineno += lines
        stack += children(node)


def _is_unit(lines: Sequence[LogicalLine]) -> bool:
    """Return whether a text is one definition with everything inside it."""
    first, second = lines[:2]
    return (
        first.word in _UNITS
        and first.column == 0 < second.column
        and first.line != second.line
        and all(line.column or line.word == "end" for line in lines[1:])
    )


def _cuts(rows: Sequence[str], lines: Sequence[LogicalLine]) -> list[int]:
    """Return the lines at which pieces begin: statements directly inside the block that some logical lines are."""
    if len(rows) < 2 * PIECE_LINES and not any(line.word in _UNITS for line in lines):
        return []
    column, indentation = lines[0].column, _indentation(rows[lines[0].line - 1])
    found: list[int] = []
    before = ""
    is_behind_function = False
    for line in lines:
        if line.column == column and line.word not in _CONTINUING:
            is_function = line.word in _UNITS
            if not found or is_function or is_behind_function or line.line - found[-1] >= PIECE_LINES:
                row = rows[line.line - 1]
                # A decorator, or a backslash on a line of its own, belongs to what is below.
                above = rows[line.line - 2] if line.line > 1 else ""
                if not before.startswith("@") and not above.endswith("\\"):
                    if _indentation(row) != indentation:
                        return []
                    found.append(line.line)
            is_behind_function = is_function
            before = rows[line.line - 1].lstrip()
    return found if len(found) > 1 else []


def _indentation(row: str) -> str:
    return row[: len(row) - len(row.lstrip(" \t\f"))]


def _read(
    keys: list[tuple[int, str]],
    parse: Callable[[str], ast.Module],
    known: dict[tuple[int, str], list[ast.stmt]],
    *,
    is_inside: bool,
) -> bool:
    """Parse neighbouring pieces at once; False if they are not statements of one block."""
    first = keys[0][0]
    parts: list[str] = []
    for start, part in keys:
        parts += [""] * (start - first - len(parts))
        parts += part.split("\n")
    text = "\n".join(parts)
    if is_inside:
        module = parse("\n" * (first - 2) + "if 1:\n" + text)
        if len(module.body) != 1 or not isinstance(block := module.body[0], ast.If) or block.orelse:
            return False
        statements = block.body
    else:
        statements = parse("\n" * (first - 1) + text).body
    for key in keys:
        known[key] = []
    index = 0
    for statement in statements:
        line = _first_line(statement)
        while index + 1 < len(keys) and line >= keys[index + 1][0]:
            index += 1
        known[keys[index]].append(statement)
    return True


def _end(last: ast.stmt, rows: Sequence[str]) -> tuple[int, int]:
    """Return where a function ends: for Python a semicolon behind its last statement belongs to it."""
    line, offset = last.end_lineno or last.lineno, last.end_col_offset or 0
    behind = rows[line - 1].encode()[offset:].partition(b"#")[0]
    return line, offset + behind.rfind(b";") + 1


def _first_line(statement: ast.stmt) -> int:
    decorators = getattr(statement, "decorator_list", None)
    return decorators[0].lineno if decorators else statement.lineno
