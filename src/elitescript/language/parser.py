"""Parses a text to a syntax tree, and finds as many mistakes as possible in one pass.

Python's parser stops at the first mistake. Here the logical line with the mistake is replaced by
a harmless one and the rest is read again. Line and column of every node and every finding are
those of the author's text.
"""

from __future__ import annotations

import ast
import re
import warnings
from bisect import bisect_right
from collections.abc import Iterator

from elitescript.language.advice.syntax_errors import broken_escape, explain
from elitescript.language.diagnostics import Diagnostic, diagnostic, in_order
from elitescript.language.garbage import without_collection
from elitescript.language.hooks import LINE as LINE_HOOK
from elitescript.language.kinds import kind_of, outer_definition
from elitescript.language.limits import excess, too_deep
from elitescript.language.options import DEFAULT, KINDS, LINE, PROGRAM, SCRIPT, SECONDARY, Options
from elitescript.language.text.dialect import Translation, translate
from elitescript.language.text.lexer import LogicalLine
from elitescript.language.text.pieces import Pieces
from elitescript.language.text.rewriting import PositionMap
from elitescript.language.text.source import SourceFile
from elitescript.records import NamedTuple
from elitescript.said import said

MAX_SYNTAX_ERRORS = 20
NO_FILE = "<elitescript>"
"""File name for Python, which reads the file of this name to report a mistake; no file has it."""

_BESIDE_SYNTAX = ("E104", "E105")
"""Errors about the block of a header, not about the header itself."""

_PLACEHOLDERS = {
    "if": "if 1:",
    "elif": "elif 1:",
    "else": "else:",
    "while": "while 1:",
    "for": "for _ in ():",
    "with": "with 0:",
    "try": "try:",
    "except": "except Exception:",
    "finally": "finally:",
    "def": "def _():",
    "sec": "def _():",
    "thread": "def _():",
    "class": "class _:",
    "match": "match 0:",
    "case": "case 0:",
}
_CLAUSES = ("elif", "else", "except", "finally", "case")
"""Words of lines without which the statement around them may be none."""


class Parsed(NamedTuple):
    """A text that was read.

    Attributes:
        source: the text.
        tree: what was written, with mistaken lines left out.
        kind: `program`, `secondary`, `script` or `line`.
        name: the name behind `def` or `sec`; empty for a script or a line.
        unit: the outer definition of a program or secondary program, else None.
        diagnostics: findings, in the order of the text.
        has_line_marks: it holds `$ LINE` marks.
        is_complete: the tree is that of the whole text; False if reading was abandoned.
        translation: the text as Python saw it.
        options: how it was read.
        hidden: logical lines that are not in the tree, by index, with how often each was replaced.
    """

    source: SourceFile
    tree: ast.Module
    kind: str
    name: str
    unit: ast.FunctionDef | None
    diagnostics: tuple[Diagnostic, ...]
    has_line_marks: bool
    is_complete: bool
    translation: Translation
    options: Options
    hidden: dict[int, int]

    @property
    def body(self) -> list[ast.stmt]:
        """The statements that run: the body of the unit, or the whole text."""
        return self.unit.body if self.unit is not None else self.tree.body

    @property
    def has_errors(self) -> bool:
        return any(problem.is_error for problem in self.diagnostics)


@without_collection
def translated(source: SourceFile, options: Options = DEFAULT) -> Translation:
    """Return a text as `parse` gives it to Python. Never raises: mistakes are among the diagnostics."""
    return translate(_readable(source)[0], options)


@without_collection
def parse(
    source: SourceFile,
    options: Options = DEFAULT,
    translation: Translation | None = None,
    pieces: Pieces | None = None,
) -> Parsed:
    """Read a text. Never raises: mistakes are among the diagnostics.

    Args:
        source: the text.
        options: how it is read.
        translation: what `translated` has returned for them, if it was called.
        pieces: those of the version before; the tree shares nodes with that, and must not be compiled.
    """
    if options.kind is not None and options.kind not in KINDS:
        raise ValueError(f"kind must be one of {', '.join(KINDS)}, not {options.kind!r}")
    if (problem := excess(source.text)) is not None:
        return _unread(source, options, problem)
    source, unreadable = _readable(source)
    if translation is None:
        translation = translate(source, options)
    problems = [*unreadable, *translation.diagnostics]
    return _TextReader(source, translation, options, {}, problems, pieces).read()


def _unread(source: SourceFile, options: Options, problem: Diagnostic) -> Parsed:
    """Return a text that is too large to be read."""
    tree, kind = ast.Module(body=[], type_ignores=[]), options.kind or SCRIPT
    nothing = translate(SourceFile(source.name, ""), options)
    return Parsed(source, tree, kind, "", None, (problem,), False, False, nothing, options, {})


def parse_without(parsed: Parsed, line: int) -> Parsed | None:
    """Read again with the logical line that holds physical line `line` left out.

    Returns:
        What is left, with no diagnostics but new ones; None if the line is already left out.
    """
    reader = _TextReader(parsed.source, parsed.translation, parsed.options, dict(parsed.hidden), [])
    index = reader.logical_index(line)
    if index < 0 or not reader.hide(index):
        return None
    return reader.read()


@without_collection
def read_again(parsed: Parsed) -> Parsed:
    """Return the same with a tree of its own, for what uses up a tree. Takes less time than `parse`."""
    again = _TextReader(parsed.source, parsed.translation, parsed.options, dict(parsed.hidden), []).read()
    return parsed._replace(tree=again.tree, unit=again.unit)


def syntax_tree(text: str) -> ast.Module:
    """Call Python's parser without its warnings on standard error."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        tree = compile(text, NO_FILE, "exec", ast.PyCF_ONLY_AST, dont_inherit=True, optimize=0)
    assert isinstance(tree, ast.Module)
    return tree


def _readable(source: SourceFile) -> tuple[SourceFile, list[Diagnostic]]:
    """Return the text without characters that Python cannot read, and the findings about them.

    Nothing is left of a text that is too large.
    """
    text = source.text
    if (problem := excess(text)) is not None:
        return SourceFile(source.name, ""), [problem]
    if text.isascii() and "\0" not in text:
        return source, []
    problems = []
    for found in re.finditer("\0+|[\ud800-\udfff]", text):
        line = text.count("\n", 0, found.start()) + 1
        column = found.start() - text.rfind("\n", 0, found.start())
        if found.group()[0] == "\0":
            count = len(found.group())
            what = "a NUL character" if count == 1 else said("{count} NUL characters in a row", count=count)
            problems.append(diagnostic("E001", line, column, said("{what} cannot stand in a program", what=what)))
        else:
            what = said("the character U+{ord:04X} is half of a pair and no text", ord=ord(found.group()))
            problems.append(diagnostic("E002", line, column, what, hint="save the file as UTF-8"))
        if len(problems) == MAX_SYNTAX_ERRORS:
            break
    if not problems:
        return source, []
    return SourceFile(source.name, re.sub("[\0\ud800-\udfff]", " ", text)), problems


class _TextReader:
    """Reads a text repeatedly, with one more line replaced each time."""

    __slots__ = (
        "_starts",
        "blamed",
        "complete",
        "hidden",
        "options",
        "pieces",
        "problems",
        "rows",
        "source",
        "translation",
    )

    def __init__(
        self,
        source: SourceFile,
        translation: Translation,
        options: Options,
        hidden: dict[int, int],
        problems: list[Diagnostic],
        pieces: Pieces | None = None,
    ) -> None:
        self.source = source
        self.translation = translation
        self.options = options
        self.problems = problems
        self.pieces: Pieces | None = None
        if translation.positions.is_identity:
            # Line marks of nodes that are shared are what they were before.
            self.pieces = Pieces() if pieces is None else pieces
        self.complete = True
        self.hidden: dict[int, int] = {}
        self.blamed: set[int] | None = None
        self._starts: list[int] | None = None
        self.rows: list[str] | None = None
        if translation.broken or translation.dropped:
            for index, line in enumerate(translation.lines):
                if line in translation.dropped:
                    self._drop(line)
                elif line in translation.broken:
                    self.hide(index)
        for index, times in hidden.items():
            while self.hidden.get(index, 0) < times and self.hide(index):
                pass

    def read(self) -> Parsed:
        tree = self._tree()
        translation = self.translation
        if not translation.positions.is_identity:
            _move_back(tree, translation.positions, self.rows or translation.text.split("\n"), self.source)
        if translation.marks:
            for line, column in _name_marks(tree, translation.marks, self.source):
                if self.complete and self.logical_index(line) not in self.hidden:
                    text = "a line mark consists of a number and one or two texts"
                    self._report(line, column, text, 'the form is: $ LINE: (12, "label")')
        kind, unit = self._kind(tree)
        return Parsed(
            self.source,
            tree,
            kind,
            unit.name if unit else "",
            unit,
            in_order(self.problems),
            bool(translation.marks),
            self.complete,
            translation,
            self.options,
            self.hidden,
        )

    # Syntax

    def _tree(self) -> ast.Module:
        text = self.translation.text
        while True:
            if (tree := self._tree_of_pieces()) is not None:
                return tree
            try:
                return syntax_tree("\n".join(self.rows) if self.rows else text)
            except SyntaxError as error:
                if not self._blame(error):
                    break
            except (RecursionError, MemoryError, ValueError, OverflowError) as error:
                self._report(1, 1, too_deep(text, error, "read"), "split long expressions")
                break
        self.complete = False
        return ast.Module(body=[], type_ignores=[])

    def _tree_of_pieces(self) -> ast.Module | None:
        if self.pieces is None:
            return None
        try:
            return self.pieces.tree(self._rows(), self.translation.lines, syntax_tree)
        except (SyntaxError, RecursionError, MemoryError, ValueError, OverflowError):
            # Only the whole text says what is wrong, and where.
            return None

    def _blame(self, error: SyntaxError) -> bool:
        """Report a mistake and hide its line; False to give up."""
        index = self.logical_index(error.lineno or 1)
        rows = self._rows()
        if self.blamed is None:
            self.blamed = {
                self.logical_index(problem.line)
                for problem in self.problems
                if problem.is_error and problem.code not in _BESIDE_SYNTAX and problem.line <= len(rows)
            }
        row = rows[min(error.lineno or 1, len(rows)) - 1]
        known = index in self.blamed or self.hidden.get(index)
        if not known:
            text, hint = explain(error.msg, row, max(0, (error.offset or 1) - 1))
            (line, column), end = self._range(error, index)
            self._report(line, column, text, hint, end)
            self.blamed.add(index)
        if isinstance(error, IndentationError) or len(self.blamed) > MAX_SYNTAX_ERRORS or index < 0:
            return False
        return self.hide(index)

    def _range(self, error: SyntaxError, index: int) -> tuple[tuple[int, int], tuple[int, int]]:
        if index >= 0:
            line = self.translation.lines[index]
            found = broken_escape(error.msg, "\n".join(self._rows()[line.line - 1 : line.last_line]))
            if found:
                row = line.line + found[0] - 1
                return self._place(row, found[1]), self._place(row, found[2])
        start = self._place(error.lineno or 1, error.offset or 1)
        end = (start[0], start[1] + 1)
        if error.end_lineno and error.end_offset and error.end_offset > 0:
            end = max(end, self._place(error.end_lineno, error.end_offset))
        return start, end

    def _place(self, line: int, column: int) -> tuple[int, int]:
        line, column = self.translation.positions.to_source(line, max(1, column))
        line = min(line, len(self.source.lines))
        return line, min(column, len(self.source.line(line)) + 1)

    def _report(self, line: int, column: int, text: str, hint: str, end: tuple[int, int] | None = None) -> None:
        end_line, end_column = end or (line, column + 1)
        self.problems.append(
            diagnostic("E001", line, column, text, end_line=end_line, end_column=end_column, hint=hint)
        )

    # Hiding lines

    def logical_index(self, line: int) -> int:
        """Return the index of the logical line that holds, or stands before, a physical line; -1 if none."""
        if self._starts is None:
            self._starts = [logical.line for logical in self.translation.lines]
        return bisect_right(self._starts, line) - 1

    def hide(self, index: int) -> bool:
        """Replace a logical line by a harmless one; False if nothing harmless is left to try."""
        lines = self.translation.lines
        line = lines[index]
        times = self.hidden.get(index, 0)
        if times == 2:
            return False
        self.hidden[index] = times + 1
        rows = self._rows()
        first = rows[line.line - 1]
        indentation = first[: len(first) - len(first.lstrip(" \t\f"))]
        word = line.word
        following = index + 1
        while following < len(lines) and lines[following] in self.translation.dropped:
            following += 1
        deeper = following < len(lines) and lines[following].column > line.column
        if line in self.translation.headers or deeper or word in _CLAUSES:
            text = _PLACEHOLDERS.get(word, "if 1:") if times == 0 else "if 1:"
            text += "" if deeper else " pass"
        elif self.source.text[line.start : line.start + 1] == "@":
            text = ""
        else:
            text = "pass"
        rows[line.line - 1] = indentation + text
        for row in range(line.line, line.last_line):
            rows[row] = ""
        return True

    def _drop(self, line: LogicalLine) -> None:
        rows = self._rows()
        for row in range(line.line - 1, line.last_line):
            rows[row] = ""

    def _rows(self) -> list[str]:
        if self.rows is None:
            self.rows = self.translation.text.split("\n")
        return self.rows

    # Units

    def _kind(self, tree: ast.Module) -> tuple[str, ast.FunctionDef | None]:
        wanted = self.options.kind
        kind = kind_of(tree, self.translation.secondaries)
        if wanted in (PROGRAM, SECONDARY) and wanted != kind and self.complete:
            word = "def" if wanted == PROGRAM else "sec"
            place = (tree.body[0].lineno, tree.body[0].col_offset + 1) if tree.body else (1, 1)
            self._report(
                *self._place(*place),
                said("this is not a single `{word} name():` with everything inside it", word=word),
                "put all statements into the body",
            )
        if wanted in (SCRIPT, LINE):
            kind = wanted
        if kind in (PROGRAM, SECONDARY):
            return kind, outer_definition(tree)
        told = {problem.text for problem in self.problems}
        for statement in tree.body:
            if not isinstance(statement, ast.FunctionDef) or statement.lineno not in self.translation.secondaries:
                continue
            # One that has lost its indentation has no body, which is said already: what follows belongs to it.
            flat = said("the body of the `sec` of line {line} should be indented here", line=statement.lineno)
            if flat not in told:
                text, hint = "a secondary program cannot be part of a longer text", "send it by itself, or write `def`"
                self.problems.append(diagnostic("E105", statement.lineno, 1, text, end_column=4, hint=hint))
        return kind, None


def character_offset(row: str, byte_offset: int) -> int:
    """Return the number of characters before a UTF-8 offset into a line."""
    if row.isascii():
        return byte_offset
    return len(row.encode("utf-8")[:byte_offset].decode("utf-8", "ignore"))


def _byte_offset(row: str, characters: int) -> int:
    return characters if row.isascii() else len(row[:characters].encode("utf-8"))


def _move_back(tree: ast.Module, positions: PositionMap, rows: list[str], source: SourceFile) -> None:
    """Set nodes on rewritten lines to the author's positions. Columns of nodes are UTF-8 offsets."""

    def back(line: int, offset: int) -> tuple[int, int]:
        if not positions.moves(line):
            return line, offset
        row = rows[line - 1] if line <= len(rows) else ""
        line, column = positions.to_source(line, character_offset(row, offset) + 1)
        return line, _byte_offset(source.line(line), column - 1)

    for node in ast.walk(tree):
        if isinstance(node, (ast.stmt, ast.expr, ast.excepthandler, ast.arg, ast.keyword, ast.alias, ast.pattern)):
            node.lineno, node.col_offset = back(node.lineno, node.col_offset)
            if node.end_lineno is not None and node.end_col_offset is not None:
                node.end_lineno, node.end_col_offset = back(node.end_lineno, node.end_col_offset)


def _statements(tree: ast.Module) -> Iterator[ast.stmt]:
    stack: list[ast.AST] = [tree]
    while stack:
        node = stack.pop()
        if isinstance(node, ast.stmt):
            yield node
        for field in ("body", "orelse", "finalbody", "handlers", "cases"):
            children = getattr(node, field, None)
            if isinstance(children, list):
                stack.extend(children)


def _name_marks(tree: ast.Module, marks: frozenset[tuple[int, int]], source: SourceFile) -> Iterator[tuple[int, int]]:
    """Make every line mark a call of the hook; yield the places of those that are malformed."""
    left = set(marks)
    for statement in _statements(tree):
        if not isinstance(statement, ast.Expr) or not isinstance(statement.value, ast.Call):
            continue
        place = _place_of(statement, source)
        call = statement.value
        if place in left and isinstance(call.func, ast.Name) and _is_mark(call):
            call.func.id = LINE_HOOK
            left.remove(place)
    # The filler is not a name of the author's text and must not show in findings.
    for node in ast.walk(tree) if left else ():
        if isinstance(node, ast.Name) and _place_of(node, source) in left:
            node.id = LINE_HOOK
    yield from left


def _place_of(node: ast.stmt | ast.expr, source: SourceFile) -> tuple[int, int]:
    return node.lineno, character_offset(source.line(node.lineno), node.col_offset) + 1


def _is_mark(call: ast.Call) -> bool:
    values = [argument.value for argument in call.args if isinstance(argument, ast.Constant)]
    if len(values) != len(call.args) or len(values) not in (2, 3) or call.keywords:
        return False
    return type(values[0]) is int and all(isinstance(value, str) for value in values[1:])
