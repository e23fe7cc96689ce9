"""The control period. Time is counted in ticks of it; seconds are computed, never summed."""

from __future__ import annotations

from math import ceil, isnan
from typing import Final

from elitescript.errors import UsageError

PERIOD_S: Final = 0.004
"""Length of one tick, `get_steptime()`; *observed* (250 Hz streams of the vendor's SDK and pages)."""

TICKS_PER_S: Final = 250

RPC_TIMEOUT_S: Final = 60.0
"""How long a remote procedure call waits for its answer, unless configured (*assumed*)."""

WORK_PER_TICK: Final = 2_000
"""Checkpoints of one thread in one tick (*assumed*): so few that a served loop of mere polling keeps up with time."""

TICK_MAX: Final = 2**50
"""No tick of a message lies behind it: its time in microseconds has a place in every packet."""

_ROUNDING_TICKS: Final = 1e-9
"""A duration this little above a whole number of ticks is that number: it is rounding, not time."""


def seconds(tick: int) -> float:
    """Return the time of a tick."""
    return tick / TICKS_PER_S


LONGEST_S: Final = 1e12
"""Waits that are longer than this, some thirty thousand years, last as long as this."""


def ticks_for(duration_s: float) -> int:
    """Return ticks that a wait of `duration_s` takes: rounded up, a wait never ends early.

    Raises:
        UsageError: not a number.
    """
    if isnan(duration_s):
        raise UsageError("a duration must be a number of seconds, not nan")
    return max(0, ceil(min(duration_s, LONGEST_S) * TICKS_PER_S - _ROUNDING_TICKS))
