"""Sends the findings of texts: when the client asks, or by itself to clients that do not ask.

Of an open text that the server has run, in the background or on request, they are those of `check` and, marked as
such, those of that last run: until it has run again. When the text has changed since, what stands in lines that did not
change is shown as of an earlier text.
"""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from hashlib import blake2b
from time import perf_counter
from typing import Final

from lsprotocol import types

from elitescript.assist.diagnostics import Problem, diagnostics
from elitescript.assist.document import Document
from elitescript.assist.last_run import LastRun
from elitescript.language.diagnostics import Severity
from elitescript.lint.program import Span
from elitescript.lsp.feature import TAGS, Feature
from elitescript.lsp.positions import Positions
from elitescript.lsp.session import Session
from elitescript.said import parts_of

SOURCE: Final = "elitescript"
"""Name of the tool beside each finding."""

RUN_SOURCE: Final = "elitescript run"
"""The same of what the last run has found."""

PAUSE_S: Final = 0.05
"""Least time without a change before the findings of a changed text are looked for, s."""
PAUSE_MAX_S: Final = 1.0
"""Most of it: it grows with the time that the last check took."""

_RELATED: Final = (
    "text_document.publish_diagnostics.related_information",
    "text_document.diagnostic.related_information",
)

_SEVERITIES: Final = {
    Severity.ERROR: types.DiagnosticSeverity.Error,
    Severity.WARNING: types.DiagnosticSeverity.Warning,
    Severity.NOTE: types.DiagnosticSeverity.Information,
}


def shown(problem: Problem, positions: Positions, uri: str, *, has_related: bool = True) -> types.Diagnostic:
    """Return a finding as the protocol has it.

    Args:
        problem: the finding.
        positions: of its text.
        uri: of its text.
        has_related: the client shows places that belong to a finding, which have the hint; else the message has it.
    """
    found = problem.diagnostic
    span = Span(found.line, found.column, found.end_line, found.end_column)
    related = [
        types.DiagnosticRelatedInformation(types.Location(uri, positions.range(other.span)), other.text)
        for other in problem.related
    ]
    return types.Diagnostic(
        positions.range(span),
        found.text if has_related or not found.hint else f"{found.text}\nhint: {found.hint}",
        severity=_SEVERITIES[found.severity],
        code=found.code,
        code_description=types.CodeDescription(problem.page) if problem.page else None,
        source=SOURCE,
        tags=[TAGS[tag] for tag in problem.tags] or None,
        related_information=related if has_related and related else None,
        data={**parts_of(found.text), **parts_of(found.hint, "hint_")},
    )


def of_last_run(last: LastRun, positions: Positions) -> Iterator[types.Diagnostic]:
    """Yield what the last run of a text has found, as the protocol has it; lines that have changed since have none."""
    document = positions.document
    is_same = last.text == document.text
    same = last.same_lines(document.source.lines)
    now_by_ran = {same.ran(line): line for line in range(1, document.line_count + 1)}
    when = f"last run, {last.ended}" if is_same else f"last run, {last.ended}, of an earlier text"
    for found in last.findings:
        # What no line has caused is shown in the first one.
        line = now_by_ran.get(found.line) if found.line else 1
        if line is None:
            continue
        text = document.line(line)
        begin = found.column or len(text) - len(text.lstrip()) + 1
        hint = f"\nhint: {found.hint}" if found.hint else ""
        yield types.Diagnostic(
            positions.range(Span(line, begin, line, max(begin, len(text.rstrip())) + 1)),
            f"{when}: {found}{hint}",
            severity=_SEVERITIES[Severity(found.severity)] if is_same else types.DiagnosticSeverity.Information,
            data={**parts_of(found.text), **parts_of(found.hint, "hint_")},
            code=found.code or None,
            source=RUN_SOURCE,
        )


class Findings:
    """Pushes findings, after a pause in the typing; see the module."""

    __slots__ = ("_last_s", "_session", "_timers")

    def __init__(self, session: Session) -> None:
        self._session = session
        self._timers: dict[str, asyncio.TimerHandle] = {}
        self._last_s = 0.0
        """Time that the last check took."""

    def text_changed(self, uri: str, *, is_new: bool) -> None:
        """Push the findings of a text soon, if this client does not ask for them."""
        if self._session.client.has("text_document.diagnostic"):
            return
        self.forget(uri)
        pause_s = 0.0 if is_new else min(max(PAUSE_S, 2.0 * self._last_s), PAUSE_MAX_S)
        loop = asyncio.get_running_loop()
        self._timers[uri] = loop.call_later(pause_s, self._begin, uri)

    def closed(self, uri: str) -> None:
        """Take back the findings of a text that was closed."""
        self.forget(uri)
        if not self._session.client.has("text_document.diagnostic"):
            self._session.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri, []))

    def forget(self, uri: str) -> None:
        """Leave out what is due for a text."""
        if (timer := self._timers.pop(uri, None)) is not None:
            timer.cancel()

    def close(self) -> None:
        """Leave out what is due."""
        for uri in list(self._timers):
            self.forget(uri)

    def renew_of(self, uri: str) -> None:
        """Say the findings of one text again: it has run."""
        if self._session.client.has("workspace.diagnostics.refresh_support"):
            self._session.refresh(types.WORKSPACE_DIAGNOSTIC_REFRESH)
        self.text_changed(uri, is_new=True)

    def renew(self) -> None:
        """Look for the findings of all open texts again, since settings have changed."""
        if self._session.client.has("workspace.diagnostics.refresh_support"):
            self._session.refresh(types.WORKSPACE_DIAGNOSTIC_REFRESH)
        for uri in self._session.texts.open:
            self.text_changed(uri, is_new=True)

    def _begin(self, uri: str) -> None:
        self._timers.pop(uri, None)
        document = self._session.texts.open.get(uri)
        if document is not None:
            self._session.begin(self._push(uri, document))

    async def _push(self, uri: str, document: Document) -> None:
        started_s = perf_counter()
        if self._session.texts.open.get(uri) is not document:
            return
        twin = self._session.twin(document)
        found = await self._session.in_thread(findings_of, self._session, uri, twin, self._session.last_run(uri))
        self._last_s = perf_counter() - started_s
        if self._session.texts.open.get(uri) is document:
            self._session.text_document_publish_diagnostics(
                types.PublishDiagnosticsParams(uri, found, document.version)
            )


def findings_of(session: Session, uri: str, document: Document, last: LastRun | None = None) -> list[types.Diagnostic]:
    """Return the findings of a text and of its last run; slow."""
    has_related = any(map(session.client.has, _RELATED))
    positions = session.positions(document)
    found = [shown(problem, positions, uri, has_related=has_related) for problem in diagnostics(document)]
    return found if last is None else [*found, *of_last_run(last, positions)]


def result_id(document: Document, generation: int, last: LastRun | None = None) -> str:
    """Return a text that is the same as long as the findings are."""
    known = document.text if last is None or not last.findings else f"{document.text}\0{last.ended}{last.findings}"
    digest = blake2b(known.encode("utf-8", "surrogatepass"), digest_size=12).hexdigest()
    return f"{generation}.{digest}"


async def _document_diagnostic(
    session: Session, document: Document, params: types.DocumentDiagnosticParams
) -> types.DocumentDiagnosticReport:
    last = session.last_run(params.text_document.uri)
    number = result_id(document, session.texts.generation, last)
    if number == params.previous_result_id:
        return types.RelatedUnchangedDocumentDiagnosticReport(number)
    found = await session.in_thread(findings_of, session, params.text_document.uri, session.twin(document), last)
    return types.RelatedFullDocumentDiagnosticReport(found, result_id=number)


async def _workspace_diagnostic(
    session: Session, document: None, params: types.WorkspaceDiagnosticParams
) -> types.WorkspaceDiagnosticReport:
    known = {previous.uri: previous.value for previous in params.previous_result_ids}
    generation = session.texts.generation
    opened = session.twins()
    last_runs = dict(session.last_runs)

    def look() -> list[tuple[str, Document]]:
        return list(session.all_texts(opened))

    def report(uri: str, text: Document) -> types.WorkspaceDocumentDiagnosticReport:
        last = last_runs.get(uri)
        number = result_id(text, generation, last)
        version = text.version if uri in opened else None
        if known.get(uri) == number:
            return types.WorkspaceUnchangedDocumentDiagnosticReport(uri, number, version)
        found = findings_of(session, uri, text, last)
        return types.WorkspaceFullDocumentDiagnosticReport(uri, found, version, result_id=number)

    reports: list[types.WorkspaceDocumentDiagnosticReport] = []
    texts = await session.in_thread(look)
    for uri, text in texts:
        # One by one, so that findings of open texts go in between.
        reports.append(await session.in_thread(report, uri, text))
    gone = known.keys() - {uri for uri, _ in texts}
    reports += [types.WorkspaceFullDocumentDiagnosticReport(uri, []) for uri in sorted(gone)]
    return types.WorkspaceDiagnosticReport(reports)


FEATURES: Final = {
    types.TEXT_DOCUMENT_DIAGNOSTIC: Feature(
        _document_diagnostic, types.DiagnosticOptions(False, True, identifier=SOURCE), is_slow=True, may_be_late=True
    ),
    types.WORKSPACE_DIAGNOSTIC: Feature(_workspace_diagnostic, is_slow=True),
}
