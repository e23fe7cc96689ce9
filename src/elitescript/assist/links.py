"""Finds names of files in a text."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from enum import StrEnum
from typing import Final

from elitescript.assist.document import Document
from elitescript.language.symbols import Resolution
from elitescript.lint.program import Span
from elitescript.records import NamedTuple

_FILE_PARAMETER: Final = "file_name"
"""Parameter of commands that read a file of the task folder."""
_OPENER: Final = "open"
_IN_COMMENT: Final = re.compile(r"(?<![\w./\\:-])[\w./\\-]*\w\.(?:script|toml|journal)\b")


class FileKind(StrEnum):
    """Where a file is looked for."""

    TASK = "task"
    """In the task folder: a file that the program reads."""
    NAMED = "named"
    """Named in a comment, such as a world file: beside the program, or below the folder of the workspace."""


class DocumentLink(NamedTuple):
    """A name of a file.

    Attributes:
        span: the name, without quotes.
        path: what is written there. Whether such a file exists is not known here.
        kind: where it is looked for.
    """

    span: Span
    path: str
    kind: FileKind


def document_links(document: Document) -> tuple[DocumentLink, ...]:
    """Return the names of files, in the order of the text. Never raises."""
    return tuple(sorted([*_task_files(document), *_in_comments(document)]))


def _task_files(document: Document) -> Iterator[DocumentLink]:
    program = document.program
    named: list[ast.expr] = []
    for arguments in program.arguments:
        named += [node for param, node in arguments.given if param.name == _FILE_PARAMETER]
    for scope in program.symbols.scopes:
        if scope.resolve(_OPENER) is Resolution.BUILTIN:
            calls = [call for call in scope.calls if isinstance(call.func, ast.Name) and call.func.id == _OPENER]
            named += [call.args[0] for call in calls if call.args]
    for node in named:
        # The folder may be written in front: `get_task_path() + "points.txt"`.
        last = node.right if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add) else node
        if isinstance(last, ast.Constant) and isinstance(last.value, str):
            span = document.names.inside_quotes(last, last.value)
            if span is not None:
                yield DocumentLink(span, last.value, FileKind.TASK)


def _in_comments(document: Document) -> Iterator[DocumentLink]:
    for line in range(1, document.line_count + 1):
        row = document.line(line)
        start = row.find("#", len(document.code_line(line).rstrip()))
        for found in _IN_COMMENT.finditer(row, start) if start >= 0 else ():
            span = Span(line, found.start() + 1, line, found.end() + 1)
            yield DocumentLink(span, found.group(), FileKind.NAMED)
