"""The verdict of an audit: its differences, and what was found in the simulated program and its run, in one list."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from elitescript.findings.found import Findings, in_order
from elitescript.messages.findings import WARNING, Finding
from elitescript.records import replace
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.audit.findings import AuditedRun, AuditFindings

SOURCE: Final = "audit"
"""`Finding.source` of what differs; that of all others is in the simulated program and its run."""


def findings_of(audit: AuditFindings) -> Findings:
    """Return the findings of all runs, equal ones once with their number."""
    rows: dict[tuple[object, ...], Finding] = {}
    for found in _all(audit):
        key = (found.source, found.code, found.line, found.column, found.severity, found.text)
        known = rows.get(key)
        if known is None:
            rows[key] = found
        elif found.t is not None:
            rows[key] = replace(known, count=known.count + found.count)
    return in_order(rows.values())


def verdict_of(audit: AuditFindings) -> str:
    """Return the verdict in words: `differs, 2 warnings`."""
    state = "differs" if not audit.agrees else "agrees" if audit.is_complete else "agrees as far as it is recorded"
    counted = findings_of(audit).words
    return f"{state}, {counted}" if counted else state


def _all(audit: AuditFindings) -> Iterator[Finding]:
    for run in audit.runs:
        yield from run.simulated.run.findings
        yield from _differences(run)
    if not audit.is_complete:
        text = said("the recording does not show the whole program")
        yield Finding("", WARNING, 0, 0, text, source=SOURCE)
    for its in audit.arm:
        if its.is_geometry:
            text = said(
                "the arm of the recording has {name} {recorded:.7g} {unit}, the model {model:.7g} {unit}",
                name=its.name,
                recorded=its.recorded,
                unit=its.unit,
                model=its.model,
            )
            yield Finding("", WARNING, 0, 0, text, source=SOURCE)


def _differences(run: AuditedRun) -> Iterator[Finding]:
    """Yield the differences of a run; those in one line with one cause are one, with the words of the first."""
    kinds: dict[tuple[int, str], Finding] = {}
    for its in run.comparison.findings:
        key = (its.line, its.cause)
        known = kinds.get(key)
        if known is None:
            text = said("recorded: {what}", what=its.what)
            kinds[key] = Finding("", WARNING, its.line, 0, text, t=its.t, source=SOURCE)
        else:
            kinds[key] = replace(known, count=known.count + 1)
    yield from kinds.values()
