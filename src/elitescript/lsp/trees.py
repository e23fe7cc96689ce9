"""Files of graphical programs in an editor: an outline, what a node does, what is wrong with it.

The text is XML that a pendant writes, so nothing is completed or laid out in it, and nothing renamed.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterator
from typing import Any, Final

from lsprotocol import types

from elitescript.assist.diagnostics import diagnostics
from elitescript.assist.document import Document
from elitescript.environment.task_files import opened_task
from elitescript.environment.task_places import FileSpan, TaskPlaces
from elitescript.errors import UsageError
from elitescript.kernel.arm_facts import arm_facts
from elitescript.kernel.options import RobotOptions
from elitescript.language.diagnostics import Diagnostic, Severity
from elitescript.lint.program import Span
from elitescript.lsp.connection import RequestFailed
from elitescript.lsp.feature import Feature, markup
from elitescript.lsp.positions import Positions
from elitescript.lsp.session import Session
from elitescript.models.model import model_names
from elitescript.paths import PROGRAM_SUFFIX
from elitescript.program_tree import Row, nodes
from elitescript.program_tree.listing import kind_of, name_of, summary_of
from elitescript.records import replace

LINES_MAX: Final = 40
"""Lines of the script that a hover shows."""

EDITED_ELSEWHERE: Final = "a task is edited as a tree: on the pendant, or in Python with `elitescript.program_tree`"

_KINDS: Final[dict[type[nodes.Node], types.SymbolKind]] = {
    nodes.MainTask: types.SymbolKind.Module,
    nodes.BeforeStart: types.SymbolKind.Module,
    nodes.InitVariables: types.SymbolKind.Module,
    nodes.SubTask: types.SymbolKind.Function,
    nodes.CallSubTask: types.SymbolKind.Function,
    nodes.Thread: types.SymbolKind.Event,
    nodes.Event: types.SymbolKind.Event,
    nodes.Folder: types.SymbolKind.Namespace,
    nodes.Waypoint: types.SymbolKind.Field,
    nodes.Move: types.SymbolKind.Method,
    nodes.Assignment: types.SymbolKind.Variable,
    nodes.Comment: types.SymbolKind.String,
}
"""What editors show beside nodes; others are keys, as line marks are in scripts."""

_SEVERITIES: Final = {
    Severity.ERROR: types.DiagnosticSeverity.Error,
    Severity.WARNING: types.DiagnosticSeverity.Warning,
    Severity.NOTE: types.DiagnosticSeverity.Information,
}


def places_of(document: Document) -> TaskPlaces:
    """Return the places of the graphical program that a text is, found once for each version.

    Raises:
        UsageError: a file beside it cannot be read.
    """
    return document.once(_places)


def _places(document: Document) -> TaskPlaces:
    return TaskPlaces(opened_task(document.name, None, document.text.encode("utf-8", "surrogatepass")))


def script_of(document: Document) -> Document:
    """Return the script of a graphical program, to run it; for the arm that it was made for, if none is chosen.

    Raises:
        RequestFailed: it cannot run.
    """
    task = places_of(document).task
    if task.errors:
        first = task.errors[0]
        where = task.source.place(first.line)
        raise RequestFailed(f"{where}: {first.text}" if where else f"line {first.line}: {first.text}")
    settings = document.settings
    if settings.arm is None and task.source.arm in model_names():
        settings = replace(settings, arm=arm_facts(RobotOptions(model=task.source.arm)))
    return Document(f"{document.name}{PROGRAM_SUFFIX}", task.source.text, document.version, settings)


# ---------------------------------------------------------------- findings


def findings_of(session: Session, document: Document, source: str, *, are_all: bool = True) -> list[types.Diagnostic]:
    """Return what is wrong with a graphical program, at the nodes in its file; slow.

    Args:
        session: of the client.
        document: the file.
        source: name of the tool beside each finding.
        are_all: those of the script, too, which take longer.
    """
    positions = session.positions(document)
    try:
        places = places_of(document)
    except UsageError as error:
        place = positions.range(Span(1, 1, 1, 2))
        return [types.Diagnostic(place, str(error), severity=types.DiagnosticSeverity.Error, source=source)]
    return [
        types.Diagnostic(
            positions.range(span), text, severity=_SEVERITIES[found.severity], code=found.code, source=source
        )
        for span, text, found in _located(document, places, are_all=are_all)
    ]


def _located(document: Document, places: TaskPlaces, *, are_all: bool) -> Iterator[tuple[Span, str, Diagnostic]]:
    """Yield findings with their place in the file and their text."""
    task = places.task
    if task.program is None:
        for found in task.errors:
            yield Span(found.line, found.column, found.line, found.column + 1), found.text, found
        return
    known = [*task.errors, *task.source.notes]
    if are_all and not task.errors:
        known += [problem.diagnostic for problem in diagnostics(script_of(document))]
    for found in known:
        row = places.row_of(found.line)
        span = _first_line(document, places.spans[row.number - 1]) if row is not None else Span(1, 1, 1, 2)
        where = task.source.place(found.line)
        text = f"{where}: {found.text} (script line {found.line})" if where else found.text
        yield span, f"{text}\nhint: {found.hint}" if found.hint else text, found


def _first_line(document: Document, span: FileSpan) -> Span:
    """Return the line in which a node begins, from its begin on."""
    end = span.end_column if span.end_line == span.line else len(document.line(span.line)) + 1
    return Span(span.line, span.column, span.line, max(end, span.column))


# ---------------------------------------------------------------- outline and hover


def _symbols(
    session: Session, document: Document, params: types.DocumentSymbolParams
) -> list[types.DocumentSymbol] | list[types.SymbolInformation]:
    places = places_of(document)
    positions = session.positions(document)
    if session.client.has("text_document.document_symbol.hierarchical_document_symbol_support"):
        return [_symbol(row, document, places, positions) for row in places.rows if not row.parent]
    uri = params.text_document.uri
    return [
        types.SymbolInformation(
            types.Location(uri, positions.range(Span(*places.spans[row.number - 1]))),
            _title(row),
            _symbol_kind(row),
            container_name=_title(places.rows[row.parent - 1]) if row.parent else None,
        )
        for row in places.rows
    ]


def _symbol(row: Row, document: Document, places: TaskPlaces, positions: Positions) -> types.DocumentSymbol:
    span = places.spans[row.number - 1]
    return types.DocumentSymbol(
        name=_title(row),
        detail=summary_of(row.node) or None,
        kind=_symbol_kind(row),
        range=positions.range(Span(*span)),
        selection_range=positions.range(_first_line(document, span)),
        children=[_symbol(child, document, places, positions) for child in row.inside],
    )


def _title(row: Row) -> str:
    return " ".join(f"{row.number} {kind_of(row.node)} {name_of(row.node)}".split())


def _symbol_kind(row: Row) -> types.SymbolKind:
    return _KINDS.get(type(row.node), types.SymbolKind.Key)


def _hover(session: Session, document: Document, params: types.HoverParams) -> types.Hover | None:
    places = places_of(document)
    positions = session.positions(document)
    line, _ = positions.place(params.position)
    row = places.row_at(line)
    program = places.task.program
    if row is None or program is None:
        return None
    summary = summary_of(row.node)
    lines = [text for text, number in zip(places.task.source.lines, program.script.line_rows, strict=False)
             if number == row.number]  # fmt: skip
    said = [f"**{_title(row)}**{f': {summary}' if summary else ''}"]
    if lines:
        script = textwrap.dedent("\n".join(lines[:LINES_MAX]))
        more = f"\n\n{len(lines) - LINES_MAX} more lines" if len(lines) > LINES_MAX else ""
        fence = "`" * max(3, 1 + max((len(run) for run in script.split() if set(run) == {"`"}), default=0))
        said.append(f"{fence}elitescript\n{script}\n{fence}\n\nscript line {places.script_lines[row.number]}{more}")
    problems = [problem.text for problem in program.script.problems if problem.row == row.number]
    said += [f"*{text}*" for text in problems]
    return types.Hover(markup("\n\n".join(said)), positions.range(_first_line(document, places.spans[row.number - 1])))


def _refused(session: Session, document: Document, params: Any) -> None:
    raise RequestFailed(EDITED_ELSEWHERE)


_ANSWERS: Final[dict[str, Callable[[Session, Document, Any], Any]]] = {
    types.TEXT_DOCUMENT_DOCUMENT_SYMBOL: _symbols,
    types.TEXT_DOCUMENT_HOVER: _hover,
    types.TEXT_DOCUMENT_RENAME: _refused,
    types.TEXT_DOCUMENT_PREPARE_RENAME: _refused,
    types.TEXT_DOCUMENT_REFERENCES: _refused,
}


async def _nothing() -> None:
    return None


def answer(session: Session, method: str, feature: Feature, document: Document, params: Any) -> Any:
    """Answer a request about the file of a graphical program; what it has not is nothing.

    Raises:
        RequestFailed: it would edit the file.
    """
    if method == types.TEXT_DOCUMENT_DIAGNOSTIC:
        return feature.answer(session, document, params)
    if (found := _ANSWERS.get(method)) is None:
        return _nothing() if feature.is_slow else None
    try:
        return found(session, document, params)
    except UsageError as error:
        # A file beside it: the findings say it, too.
        raise RequestFailed(str(error)) from None
