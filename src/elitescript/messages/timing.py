"""The control period: time is counted in ticks; seconds are computed from them, never summed."""

from __future__ import annotations

from math import ceil, isnan
from typing import Final

from elitescript.errors import UsageError

PERIOD_S: Final = 0.004
"""Length of one tick, `get_steptime()`; *observed* (250 Hz streams of the vendor's SDK and pages)."""

TICKS_PER_S: Final = 250

RPC_TIMEOUT_S: Final = 60.0
"""Timeout of remote procedure calls, unless configured (*assumed*)."""

WORK_PER_TICK: Final = 2_000
"""Checkpoints of one thread in one tick (*assumed*): few enough that a served polling loop keeps up with time."""

HELD_UP_MAX_S: Final = 0.25
"""Time for which long calls may hold up a served robot, unless configured (*assumed*); see `runtime.threads.meter`."""

TICK_MAX: Final = 2**50
"""Largest tick of a message: its time in microseconds fits into every packet."""

_ROUNDING_TICKS: Final = 1e-9
"""A duration this little above a whole number of ticks is that number: the rest is rounding."""


def seconds(tick: int) -> float:
    """Return the time of a tick."""
    return tick / TICKS_PER_S


LONGEST_S: Final = 1e12
"""Upper bound of a wait, some thirty thousand years; longer ones are cut to it."""


def ticks_for(duration_s: float) -> int:
    """Return the ticks of a wait of `duration_s`, rounded up: a wait never ends early.

    Raises:
        UsageError: not a number.
    """
    if isnan(duration_s):
        raise UsageError("a duration must be a number of seconds, not nan")
    return max(0, ceil(min(duration_s, LONGEST_S) * TICKS_PER_S - _ROUNDING_TICKS))
