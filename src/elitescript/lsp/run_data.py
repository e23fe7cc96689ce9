"""What comes of a run, and its record as JSON, between the process that ran it and the server."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from elitescript.assist.last_run import LastRun, LineTime, RunAlarm, RunFinding, ShortenedBlend
from elitescript.records import NamedTuple


class Outcome(NamedTuple):
    """What came of a run.

    Attributes:
        report: how it ended, as JSON.
        last: what editors show of it; None if the program did not run.
        page: text of the page that shows it; empty without one.
    """

    report: dict[str, Any]
    last: LastRun | None
    page: str


def encoded(last: LastRun) -> dict[str, Any]:
    """Return a record as JSON has it: mappings with numbers as keys are lists of pairs."""
    return {
        "text": last.text,
        "duration_s": last.duration_s,
        "moves": list(last.moves.items()),
        "lines": list(last.lines.items()),
        "values": {scope: dict(values) for scope, values in last.values.items()},
        "blends": list(last.blends.items()),
        "alarms": list(last.alarms),
        "findings": list(last.findings),
    }


def decoded(data: Mapping[str, Any]) -> LastRun:
    """Return the record of what `encoded` returned."""
    return LastRun(
        data["text"],
        data["duration_s"],
        {line: LineTime(*time) for line, time in data["moves"]},
        {line: LineTime(*time) for line, time in data["lines"]},
        data["values"],
        {line: ShortenedBlend(*blend) for line, blend in data["blends"]},
        tuple(RunAlarm(*alarm) for alarm in data["alarms"]),
        tuple(RunFinding(*found) for found in data["findings"]),
    )
