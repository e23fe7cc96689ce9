"""Reports of `run --format github` and `sarif`: the findings of text and run as `check` writes them."""

from __future__ import annotations

import sys
from collections.abc import Collection, Iterable

from elitescript.cli.output.check_formats import FORMATS, CheckedFile
from elitescript.cli.output.report import TextRunReport
from elitescript.language.diagnostics import Diagnostic, Severity
from elitescript.language.text.source import SourceFile
from elitescript.messages.findings import Finding
from elitescript.run import ENDINGS, Run


class FindingsReport(TextRunReport):
    """Prints messages as text on standard error, and at the end all findings on standard output.

    Args:
        form: `github` or `sarif`.
        logs: further events to print.
    """

    def __init__(self, form: str, logs: Collection[str] = ()) -> None:
        super().__init__(sys.stderr, sys.stderr, logs)
        self._form = FORMATS[form](sys.stdout)
        self._problems: tuple[Diagnostic, ...] = ()
        self._unfinished: tuple[int, str] | None = None
        """Line and reason of a run that the time limit has ended: it has no finding."""

    def problems(self, problems: Iterable[Diagnostic], source: SourceFile | None) -> None:
        """Report the findings before the run, which are those of a program that is refused."""
        self._problems = tuple(problems)
        super().problems(self._problems, source)

    def end(self, run: Run, *, is_interrupted: bool, overruns: int | None, is_strict: bool = False) -> None:
        """Report the end of a run, and take its findings."""
        super().end(run, is_interrupted=is_interrupted, overruns=overruns, is_strict=is_strict)
        columns = {(problem.code, problem.line, problem.column): problem for problem in self._problems}
        self._problems = tuple(
            columns[key]
            if found.t is None and (key := (found.code, found.line, found.column)) in columns
            # What has a repair, or an end, has it in `check` alone.
            else diagnostic_of(found)
            for found in run.findings
        )
        self._source = run.unit.source
        if run.state == "time_limit":
            line = run.threads[0].line if run.threads else 0
            self._unfinished = line, f"{ENDINGS[run.state]} after {run.time_s:.3f} s: {run.why}"

    def finish(self) -> None:
        """Write the findings."""
        checked = CheckedFile(self._source.name, self._source, self._problems)
        self._form.file(checked)
        if self._unfinished is not None:
            self._form.unfinished(checked, *self._unfinished)
        self._form.end()


def diagnostic_of(found: Finding) -> Diagnostic:
    """Return a finding of a run as one of a text; what has no place has the first."""
    line, column = max(1, found.line), max(1, found.column)
    times = f"{found.count} times, first " if found.count > 1 else ""
    when = "" if found.t is None else f" ({times}at {found.t:.3f} s)"
    severity = Severity(found.severity)
    return Diagnostic(found.code, severity, line, column, line, column + 1, f"{found.text}{when}", found.hint)
