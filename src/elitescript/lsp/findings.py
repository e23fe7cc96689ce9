"""Sends the findings of texts: when the client asks, or by itself to clients that do not ask.

What needs no values of expressions is found first. Where the rest takes longer it is sent at once, with what the
version before had in lines that have not changed, and all findings in a second message.

Of an open text that the server has run, in the background or on request, they are those of `check` and, marked as
such, those of that last run: until it has run again. When the text has changed since, what stands in lines that did not
change is shown as of an earlier text.
"""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Iterator, Sequence
from contextlib import suppress
from hashlib import blake2b
from typing import Final

from lsprotocol import types

from elitescript.assist.diagnostics import Problem, diagnostics, kept, quick_diagnostics
from elitescript.assist.document import Document
from elitescript.assist.last_run import LastRun
from elitescript.language.diagnostics import Diagnostic, Outdated, Severity
from elitescript.lint.program import Span
from elitescript.lsp.feature import TAGS, Feature
from elitescript.lsp.positions import Positions
from elitescript.lsp.session import LastFindings, Session
from elitescript.lsp.texts import is_tree
from elitescript.records import NamedTuple
from elitescript.said import parts_of

SOURCE: Final = "elitescript"
"""Name of the tool beside each finding."""

RUN_SOURCE: Final = "elitescript run"
"""The same of what the last run has found."""

PAUSE_S: Final = 0.05
"""Time without a change before the findings of a changed text are looked for, s."""
TOGETHER_S: Final = 0.02
"""Time in which all findings of a text are awaited before those that were found first are sent, s."""

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
    now_by_ran = {same.earlier(line): line for line in range(1, document.line_count + 1)}
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

    __slots__ = ("_session", "_timers")

    def __init__(self, session: Session) -> None:
        self._session = session
        self._timers: dict[str, asyncio.TimerHandle] = {}

    def text_changed(self, uri: str, *, is_new: bool) -> None:
        """Push the findings of a text soon, if this client does not ask for them."""
        if self._session.client.has("text_document.diagnostic"):
            return
        self.forget(uri)
        loop = asyncio.get_running_loop()
        self._timers[uri] = loop.call_later(0.0 if is_new else PAUSE_S, self._begin, uri)

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
        async for found in found_in_turn(self._session, uri, document):
            self._session.text_document_publish_diagnostics(
                types.PublishDiagnosticsParams(uri, found.shown, document.version)
            )


class Found(NamedTuple):
    """Findings of a text and of its last run.

    Attributes:
        shown: as the protocol has them.
        problems: those of the text.
        are_all: False for what needs no values of expressions.
    """

    shown: list[types.Diagnostic]
    problems: tuple[Diagnostic, ...]
    are_all: bool


async def found_in_turn(session: Session, uri: str, document: Document) -> AsyncIterator[Found]:
    """Yield the findings of a version of an open text, at last all; it ends when that is open no more.

    Those that are found first are yielded where the others take longer than `TOGETHER_S`.
    """

    def is_open() -> bool:
        return session.texts.open.get(uri) is document

    if not is_open():
        return
    twin, last, before = session.twin(document), session.last_run(uri), session.last_findings.get(uri)
    try:
        quick = None
        if before is None or before.rows is not document.source.lines:
            quick = await session.in_thread(_found, session, uri, twin, last, before, False)
            if not is_open():
                return
        rest = asyncio.ensure_future(session.in_thread(_found, session, uri, twin, last, None, True))
        # If the client cancels its request, nothing waits for them any more.
        rest.add_done_callback(lambda done: done.cancelled() or done.exception())
        await asyncio.wait({rest}, timeout=TOGETHER_S)
        if quick is not None and not rest.done() and is_open():
            yield quick
        found = await rest
    except Outdated:
        return
    if is_open():
        session.last_findings[uri] = LastFindings(document.source.lines, found.problems)
        yield found


def findings_of(session: Session, uri: str, document: Document, last: LastRun | None = None) -> list[types.Diagnostic]:
    """Return the findings of a text and of its last run; slow.

    Raises:
        Outdated: it is the twin of a version that is open no more.
    """
    return _found(session, uri, document, last, None, True).shown


def _found(
    session: Session,
    uri: str,
    document: Document,
    last: LastRun | None,
    before: LastFindings | None,
    are_all: bool,
) -> Found:
    if is_tree(document):
        from elitescript.lsp import trees

        return Found(trees.findings_of(session, document, SOURCE, are_all=are_all), (), are_all)
    has_related = any(map(session.client.has, _RELATED))
    positions = session.positions(document)
    problems: Sequence[Problem] = diagnostics(document) if are_all else quick_diagnostics(document)
    if before is not None:
        problems = [*problems, *kept(before.rows, before.problems, document)]
    found = [shown(problem, positions, uri, has_related=has_related) for problem in problems]
    if last is not None:
        found += of_last_run(last, positions)
    return Found(found, tuple(problem.diagnostic for problem in problems), are_all)


_QUICK: Final = ".quick"
"""End of the result id of findings that are not all."""


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
    in_turn = found_in_turn(session, params.text_document.uri, document)
    async for found in in_turn:
        if found.are_all:
            return types.RelatedFullDocumentDiagnosticReport(found.shown, result_id=number)
        if session.client.has("workspace.diagnostics.refresh_support"):
            session.begin(_ask_again(session, in_turn))
            return types.RelatedFullDocumentDiagnosticReport(found.shown, result_id=f"{number}{_QUICK}")
    raise Outdated


async def _ask_again(session: Session, in_turn: AsyncIterator[Found]) -> None:
    """Have the client ask for the findings of a text again when all are found."""
    async for _ in in_turn:
        session.refresh(types.WORKSPACE_DIAGNOSTIC_REFRESH)


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
        # One by one, so that findings of open texts go in between. A text that changes meanwhile is asked for again.
        with suppress(Outdated):
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
