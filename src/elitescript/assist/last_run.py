"""What editors show of the last run of a text: times of moves, values, blends, alarms.

Made elsewhere from a run; here it is only read, and mapped to a text that was changed since.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from elitescript.assist.same_lines import SameLines, same_lines
from elitescript.language.text.source import SourceFile
from elitescript.records import NamedTuple, field, record


class LineTime(NamedTuple):
    """Time that a line took.

    Attributes:
        times: how often.
        total_s: in all, s.
    """

    times: int
    total_s: float


class ShortenedBlend(NamedTuple):
    """A blend radius that was lowered: what was asked for and what was used, m."""

    asked_m: float
    used_m: float


class RunAlarm(NamedTuple):
    """An alarm that stopped the run."""

    line: int
    code: str
    text: str


class RunFinding(NamedTuple):
    """What the run has found, and `check` does not find in the text."""

    line: int
    column: int
    """From 1; 0 if unknown."""
    severity: str
    """`error`, `warning` or `note`."""
    code: str
    text: str
    hint: str
    t: float
    """Robot time of the first time, s."""
    times: int

    def __str__(self) -> str:
        """Say text and time."""
        times = f"{self.times} times, first " if self.times > 1 else ""
        return f"{self.text} ({times}at {self.t:.3f} s)"


@record
class LastRun:
    """What is kept of a run. Lines are those of the text that ran.

    Attributes:
        text: the text that ran.
        duration_s: of the run, virtual time, s.
        moves: times of moves, by line.
        lines: time that the program stayed in a line, moving or not, by line; `times` is how often it ran, 0 if that is
            not known.
        values: last values of variables as text, by scope: `""` for globals and the body of the program, else the name
            of the function.
        blends: radii that were shortened, by line.
        alarms: what stopped it.
        findings: what it has found.
        ended: when that was, on the clock of this computer, as text.
    """

    text: str
    duration_s: float = 0.0
    moves: Mapping[int, LineTime] = field(default_factory=dict)
    lines: Mapping[int, LineTime] = field(default_factory=dict)
    values: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    blends: Mapping[int, ShortenedBlend] = field(default_factory=dict)
    alarms: tuple[RunAlarm, ...] = ()
    findings: tuple[RunFinding, ...] = ()
    ended: str = ""

    def same_lines(self, rows: Sequence[str]) -> SameLines:
        """Return which lines of the text now are those that ran."""
        return same_lines(SourceFile("", self.text).lines, rows)
