"""Where the program phase of a tick was ended because the share of the tick was used up."""

from __future__ import annotations

from typing import Final

from elitescript.records import NamedTuple

LOOKS_MAX: Final = 1 << 24
"""No tick has more looks at the clock, and no number of a cut is larger."""


class Cut(NamedTuple):
    """How far the threads of a robot came in a tick, counted in looks at the clock; see `runtime.threads.meter`."""

    looks: int
    """Number of the look, from 1, behind which no thread of a program runs on in this tick; 0 if all came to their
    ends."""
    cleanups: int
    """Number of the step of clean-up, from 1, at which stopped threads were given up; 0 if none was."""
    late_ms: int = 0
    """By how much the call before that look was too long; 0 where none was by much."""
    late_line: int = 0
    """Line of the statement with that call, where lines are noted; 0 elsewhere."""


WHOLE: Final = Cut(0, 0)
"""No cut: every thread ran until it waited or had used up its work."""
