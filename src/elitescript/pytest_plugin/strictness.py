"""What is found in the programs and runs of a test, for `elitescript_findings` and `--script-strict`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import pytest

from elitescript.findings.found import Findings
from elitescript.language.diagnostics import Diagnostic
from elitescript.language.options import Options
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import compile_checked
from elitescript.messages.findings import ERROR, NOTE, WARNING, Finding
from elitescript.pytest_plugin.script_program import RETURNED
from elitescript.pytest_plugin.watching import WatchedRun

NOTHING_RUNS: Final = "W214"
LEVELS: Final = {"off": (), "error": (ERROR,), "warning": (ERROR, WARNING)}
"""Severities that fail a test, by the value of `elitescript_findings`."""


def findings_of(watched: Iterable[WatchedRun], level: str) -> list[str]:
    """Return the findings of text and run that a level refuses, each once.

    Raises:
        pytest.UsageError: no such level.
    """
    if level not in LEVELS:
        raise pytest.UsageError(f"elitescript_findings must be {', '.join(LEVELS)}, got {level!r}")
    refused = LEVELS[level]
    return [text for text, finding in _found(watched if refused else ()).items() if finding.severity in refused]


def findings_in_words(watched: Iterable[WatchedRun]) -> str:
    """Return how many errors and warnings text and runs have: `1 error, 2 warnings`; empty without any."""
    return Findings(finding for finding in _found(watched).values() if finding.severity != NOTE).words


def findings_as_json(watched: Iterable[WatchedRun]) -> str:
    """Return errors and warnings of text and runs as JSON has them, with their templates and values."""
    from json import dumps

    found = Findings(finding for finding in _found(watched).values() if finding.severity != NOTE)
    return dumps(found.records()[:FINDINGS_MAX])


FINDINGS_MAX: Final = 100
"""Findings of one test that its report carries."""


def _found(watched: Iterable[WatchedRun]) -> dict[str, Finding]:
    """Return the findings of text and run by what is said of them, each once."""
    found: dict[str, Finding] = {}
    for watch in watched:
        of_tests = RETURNED in watch.unit.global_names
        for finding in watch.findings:
            # Nothing in a file of tests calls them.
            if not (of_tests and finding.code == NOTHING_RUNS):
                found[_with_place(finding, watch.unit.source)] = finding
    return found


def _with_place(found: Finding | Diagnostic, source: SourceFile) -> str:
    """Return a finding with the name of its text; of a graphical program, with its node."""
    if not (source.places and found.line):
        return f"{source.name}: {found}"
    return f"{source.where(found.line)}: {found.severity} {found.code}: {found.text}"


def warnings_of(watched: Iterable[WatchedRun]) -> list[str]:
    """Return what `check` finds in the programs of these runs, and what the runs have warned about; each once."""
    found: dict[str, None] = {}
    for watch in watched:
        unit = watch.unit
        options = Options(strict=watch.is_strict, kind=unit.kind, ignored=watch.ignored)
        checked = compile_checked(unit.source, watch.profile, options, presets=watch.presets, arm=watch.model)
        problems = list(checked.problems)
        if RETURNED in unit.global_names:
            # Nothing in a file of tests calls them.
            problems = [problem for problem in problems if problem.code != NOTHING_RUNS]
        known = set(map(str, problems))
        for problem in problems:
            found[_with_place(problem, unit.source)] = None
        for text in watch.warnings:
            if text not in known:
                found[f"{unit.source.name}: {text}"] = None
    return list(found)
