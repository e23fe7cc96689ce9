"""What editors show of the last run of a text: times of moves, values, blends, alarms.

Made elsewhere from a run; here it is only read, and mapped to a text that was changed since.
"""

from __future__ import annotations

from collections.abc import Mapping

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


@record
class LastRun:
    """What is kept of a run.

    Attributes:
        text: the text that ran.
        duration_s: of the run, virtual time, s.
        moves: times of moves, by line.
        calls: calls of the program's own functions and the time spent in them, by line of the `def`.
        values: last values of variables as text, by scope: `""` for globals and the body of the program, else the name
            of the function.
        blends: radii that were shortened, by line.
        alarms: what stopped it.
    """

    text: str
    duration_s: float = 0.0
    moves: Mapping[int, LineTime] = field(default_factory=dict)
    calls: Mapping[int, LineTime] = field(default_factory=dict)
    values: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    blends: Mapping[int, ShortenedBlend] = field(default_factory=dict)
    alarms: tuple[RunAlarm, ...] = ()
