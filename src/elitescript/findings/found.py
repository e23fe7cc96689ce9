"""Makes the one list of findings of a run: equal ones folded, the worst first."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable
from typing import Any, Final

from elitescript.language.diagnostics import Diagnostic
from elitescript.messages.enums import TaskState
from elitescript.messages.events import SOURCES, Alarm, DeviceNoted, Event, TaskStateChanged, Warned
from elitescript.messages.findings import ERROR, NOTE, SEVERITIES, WARNING, Finding
from elitescript.messages.timing import seconds
from elitescript.records import replace
from elitescript.said import parts_of, said

KINDS_MAX: Final = 1000
"""Different findings of a run that are kept; further ones are counted with the first of their code."""

_NUMBERS: Final = re.compile(r"[-+]?\d[\d.]*(?:e[-+]?\d+)?")
_ORDER: Final = {severity: number for number, severity in enumerate(SEVERITIES)}

_REFUSED: Final = {"R101": "E304", "R102": "E305", "R103": "E303"}
"""Codes of `check` by those of the alarms for the same argument, whose value is another text in a run."""

_Key = tuple[object, ...]


class Findings(tuple[Finding, ...]):
    """Findings, by severity and line."""

    __slots__ = ()

    def counts(self) -> dict[str, int]:
        """Return how many there are of each severity: `error`, `warning`, `note`."""
        counted = Counter(finding.severity for finding in self)
        return {severity: counted[severity] for severity in SEVERITIES}

    @property
    def error(self) -> int:
        """How many are errors."""
        return self.counts()[ERROR]

    @property
    def warning(self) -> int:
        """How many are warnings."""
        return self.counts()[WARNING]

    @property
    def note(self) -> int:
        """How many are notes."""
        return self.counts()[NOTE]

    @property
    def is_clean(self) -> bool:
        """Whether there is neither an error nor a warning; notes do not count."""
        return all(finding.severity == NOTE for finding in self)

    @property
    def of_run(self) -> Findings:
        """Those that the run itself has found, perhaps `check` too."""
        return Findings(finding for finding in self if finding.t is not None)

    @property
    def without_alarms(self) -> Findings:
        """Those that are no alarm of a run."""
        return Findings(finding for finding in self if not finding.code.startswith("R"))

    @property
    def words(self) -> str:
        """Numbers by severity, such as `1 error, 3 warnings`; empty without findings."""
        return ", ".join(
            f"{count} {severity}{'' if count == 1 else 's'}" for severity, count in self.counts().items() if count
        )

    def records(self) -> list[dict[str, Any]]:
        """Return them as JSON has them."""
        return [
            {
                "code": row.code,
                "severity": row.severity,
                "line": row.line,
                "column": row.column,
                "text": row.text,
                "hint": row.hint,
                "t": row.t,
                "count": row.count,
                "thread": row.thread,
                "source": row.source,
                **parts_of(row.text),
                **parts_of(row.hint, "hint_"),
            }
            for row in self
        ]


class Found:
    """What a run itself has found so far."""

    __slots__ = ("_rows",)

    def __init__(self) -> None:
        self._rows: dict[_Key, Finding] = {}

    def take(self, event: Warned | DeviceNoted | Alarm, start_tick: int) -> None:
        """Take an event; one that is no finding is left out."""
        found = finding_of(event, start_tick)
        if found is not None:
            self._put(found)

    def _put(self, found: Finding) -> None:
        # What differs in numbers alone is one finding: a loop computes other numbers each time.
        key: _Key = (found.source, found.code, found.line, found.thread, _NUMBERS.sub("#", found.text))
        if key not in self._rows and len(self._rows) >= KINDS_MAX:
            key = (found.code, found.severity)
        known = self._rows.get(key)
        self._rows[key] = found if known is None else replace(known, count=known.count + found.count)

    def listed(self, of_text: Iterable[Diagnostic] = ()) -> Findings:
        """Return all findings.

        Args:
            of_text: what `check` finds in the text. What the run has found too is one row, with the text of `check` and
                with time and number of the run: what has the same line and the same code, and the alarm of a line that
                says what `check` says.
        """
        rows: list[Finding] = []
        in_text: dict[tuple[str, int], int] = {}
        for problem in of_text:
            in_text.setdefault((problem.code, problem.line), len(rows))
            in_text.setdefault((problem.text, problem.line), len(rows))
            if problem.code in _REFUSED.values():
                in_text.setdefault((f"{problem.code} {_argument(problem.text)}", problem.line), len(rows))
            rows.append(finding_of_text(problem))
        for found in self._rows.values():
            at = in_text.get((found.code, found.line)) if found.code else None
            if at is None and found.severity == ERROR:
                text = found.text.partition(": ")[2]
                at = in_text.get((text, found.line))
                if at is None and found.code in _REFUSED:
                    at = in_text.get((f"{_REFUSED[found.code]} {_argument(text)}", found.line))
            if at is None:
                rows.append(found)
            elif rows[at].t is None:
                rows[at] = replace(rows[at], t=found.t, count=found.count, thread=found.thread)
            else:
                rows[at] = replace(rows[at], count=rows[at].count + found.count)
        return in_order(rows)


def _argument(text: str) -> str:
    """Return command and argument, with which the text of a refusal begins."""
    return " ".join(text.split(" ", 2)[:2])


class Tally:
    """Counts what a robot has found since its task began, of its events: for what has no `Run`."""

    __slots__ = ("_found", "_runs")

    def __init__(self) -> None:
        self._found: Found | None = None
        self._runs = False

    def take(self, event: Event) -> None:
        """Take an event."""
        if isinstance(event, TaskStateChanged):
            if not self._runs:
                self._found = None
            self._runs = event.state is not TaskState.STOPPED
        elif isinstance(event, Warned | DeviceNoted):
            self._found = self._found or Found()
            self._found.take(event, 0)

    @property
    def findings(self) -> Findings:
        """All of the task that runs, or has ended last; an alarm is no finding beside the end that it is."""
        return Findings() if self._found is None else self._found.listed()


def in_order(rows: Iterable[Finding]) -> Findings:
    """Return findings in one list: the worst first, then by line."""
    return Findings(sorted(rows, key=_place))


def _place(found: Finding) -> tuple[int, int, int, float]:
    # What no line has caused comes last.
    return _ORDER[found.severity], found.line or 1 << 31, found.column, -1.0 if found.t is None else found.t


def finding_of_text(problem: Diagnostic) -> Finding:
    """Return a finding of `check`."""
    severity = str(problem.severity)
    return Finding(problem.code, severity, problem.line, problem.column, problem.text, problem.hint, source="check")


def finding_of(event: Warned | DeviceNoted | Alarm, start_tick: int = 0) -> Finding | None:
    """Return the finding of an event; None if a device only says something."""
    t = seconds(event.tick - start_tick)
    if isinstance(event, Warned):
        return Finding(
            event.code,
            event.severity,
            event.line,
            event.column,
            event.text,
            event.hint,
            t,
            thread=event.thread,
            source=event.source,
        )
    if isinstance(event, Alarm):
        return Finding(
            event.code,
            ERROR,
            event.line,
            event.column,
            said("{kind}: {text}", kind=event.class_name, text=event.text),
            event.details.get("hint", ""),
            t,
            thread=event.thread,
            source=SOURCES.get(event.code, "run"),
        )
    if not event.is_warning:
        return None
    text = said("{device}: {text}", device=event.device, text=event.text)
    return Finding("", WARNING, 0, 0, text, t=t, source="device")
