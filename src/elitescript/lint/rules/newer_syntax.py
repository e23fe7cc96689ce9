"""Syntax that is newer than the Python of the robots, as far as that is known: 3.8 (*assumed*).

It works here and may be refused there. Found are `match` (3.10), brackets around the items of `with` (3.9),
`list[int]` and its like (3.9), `int | None` (3.10), decorators that are no plain names (3.9), and formatted
strings that use their own quotes, backslashes or comments inside the braces (3.12).

    def job():
      match get_flag(0):         # W212: write if and elif
        case True: halt()
      end
    end
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from typing import Final

from elitescript.language.symbols import Resolution
from elitescript.language.text.masked import lex
from elitescript.lint.program import AnalysedProgram, Span
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="W212", since="0.1")
def newer_syntax(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each such construct."""
    for statement in program.nodes(ast.Match):
        yield _finding(program.header_span(statement), "`match`", "3.10", "write if and elif")
    for block in program.nodes(ast.With):
        if _is_bracketed(block, program):
            text, hint = "brackets around the items of `with`", "nest two `with` blocks, or join the lines"
            yield _finding(program.header_span(block), text, "3.9", hint)
    for element in program.nodes(ast.Subscript):
        name = element.value
        is_generic = isinstance(name, ast.Name) and name.id in _GENERIC and _is_python_name(name, program)
        if isinstance(name, ast.Name) and is_generic and not _is_never_computed(element, program):
            yield _finding(
                program.span(element),
                said("`{name}[...]` as a type", name=name.id),
                "3.9",
                said("write {name} alone", name=name.id),
            )
    for operation in program.nodes(ast.BinOp):
        is_optional = isinstance(operation.op, ast.BitOr) and any(map(_is_none, (operation.left, operation.right)))
        if is_optional and not _is_never_computed(operation, program):
            yield _finding(program.span(operation), "`... | None` as a type", "3.10", "leave the annotation out")
    for decorator in _decorators(program):
        if not _is_plain_decorator(decorator):
            hint = "give the expression a name first"
            yield _finding(program.span(decorator), "a decorator that is no plain name", "3.9", hint)
    if sys.version_info >= (3, 12):
        for text in program.nodes(ast.JoinedStr):
            if _is_new_format(text, program):
                hint = "compute the value in a line before, or use the other kind of quotes inside"
                yield _finding(program.span(text), "this formatted string", "3.12", hint)


_GENERIC: Final = frozenset(("dict", "frozenset", "list", "set", "tuple", "type"))


def _finding(where: Span, what: str, version: str, hint: str) -> Finding:
    return Finding(
        where,
        said("{what} is new in Python {version}; the robot's Python may be older", what=what, version=version),
        hint,
    )


def _is_python_name(node: ast.Name, program: AnalysedProgram) -> bool:
    return program.symbols.scope_of(node).resolve(node.id) is Resolution.BUILTIN


def _is_never_computed(node: ast.expr, program: AnalysedProgram) -> bool:
    """Return whether it is the type of a variable of a function, which Python does not evaluate."""
    child: ast.AST = node
    for above in program.symbols.ancestors(node):
        if isinstance(above, ast.stmt):
            is_type = isinstance(above, ast.AnnAssign) and above.annotation is child
            return is_type and program.symbols.scope_of(above).kind != "class"
        child = above
    return False


def _is_none(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and node.value is None


def _decorators(program: AnalysedProgram) -> Iterator[ast.expr]:
    for function in program.nodes(ast.FunctionDef):
        yield from function.decorator_list
    for cls in program.nodes(ast.ClassDef):
        yield from cls.decorator_list


def _is_plain_decorator(node: ast.expr) -> bool:
    if isinstance(node, ast.Call):
        node = node.func
    while isinstance(node, ast.Attribute):
        node = node.value
    return isinstance(node, ast.Name)


def _is_bracketed(block: ast.With, program: AnalysedProgram) -> bool:
    """Return whether one pair of brackets holds all items, and these are more than an expression."""
    if len(block.items) == 1 and block.items[0].optional_vars is None:
        return False
    line, column = program.symbols.place(block)
    lines = program.source.lines
    last = block.body[0].lineno
    text = "\n".join([lines[line - 1][column - 1 :], *lines[line : last + 1]])
    masked = lex(text).masked
    found = re.match(r"with\s*\(", masked)
    if not found:
        return False
    depth = 1
    for index in range(found.end(), len(masked)):
        depth += (masked[index] in "([{") - (masked[index] in ")]}")
        if depth == 0:
            return masked[index + 1 :].lstrip().startswith(":")
    return False


def _is_new_format(text: ast.JoinedStr, program: AnalysedProgram) -> bool:
    """Return whether the braces of a formatted string hold what older Pythons do not accept there."""
    holds_text = any(
        isinstance(node, (ast.JoinedStr, ast.Constant)) and isinstance(getattr(node, "value", ""), str)
        for part in text.values
        if isinstance(part, ast.FormattedValue)
        for node in ast.walk(part.value)
    )
    line, column, end_line, end_column = program.span(text)
    rows = list(program.source.lines[line - 1 : end_line])
    rows[-1] = rows[-1][: end_column - 1]
    rows[0] = rows[0][column - 1 :]
    whole = "\n".join(rows)
    opening = re.match(r"(?P<prefix>[A-Za-z]*)(?P<quote>\"\"\"|'''|\"|')", whole)
    if not opening or "f" not in opening["prefix"].lower():
        return False
    if not holds_text and "\\" not in whole and "\n" not in whole:
        return False
    quote = opening["quote"]
    for part in text.values:
        if isinstance(part, ast.FormattedValue):
            inside = program.span(part.value)
            value = "\n".join(program.source.lines[inside.line - 1 : inside.end_line])
            if inside.line == inside.end_line:
                value = value[inside.column - 1 : inside.end_column - 1]
                if quote in value or "\\" in value:
                    return True
            elif len(quote) == 1:
                return True
    return False
