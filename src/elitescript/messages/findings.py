"""Findings of a run: what its text, the run itself and what is beside the robot have shown, in one form."""

from __future__ import annotations

from typing import Final

from elitescript.records import record

ERROR: Final = "error"
WARNING: Final = "warning"
NOTE: Final = "note"
SEVERITIES: Final = (ERROR, WARNING, NOTE)
"""By harm, the worst first. A note says what a sound program may have too, and spoils no verdict."""


@record
class Finding:
    """One thing that was found in a text or in its run; equal ones are one finding with their number."""

    code: str
    """Row of `errors.CODES`; empty for a warning that has none."""
    severity: str
    """`error`, `warning` or `note`."""
    line: int
    """Of the program; 0 if no line has caused it."""
    column: int
    """From 1, in characters; 0 if unknown."""
    text: str
    hint: str = ""
    """What to do about it; empty if there is nothing to advise."""
    t: float | None = None
    """Robot time of the first time, s; None if it was known before the run."""
    count: int = 1
    """How often it was found."""
    thread: str = ""
    """Name of the thread of the first time; empty if there is none."""
    source: str = "run"
    """What has found it: `check` (the text), `run`, `device` (beside the robot), `contact`, `limit` (joint and safety
    limits) or `end` (of the program); in an audit `audit` (a difference)."""

    def __str__(self) -> str:
        """Place, severity, code and text in one line."""
        place = f"line {self.line}" + (f", column {self.column}" if self.column else "") if self.line else ""
        text = f"{self.text} ({self.count} times)" if self.count > 1 else self.text
        return ": ".join(part for part in (place, f"{self.severity} {self.code}".rstrip(), text) if part)
