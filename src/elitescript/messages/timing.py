"""The control period. Time is counted in ticks of it; seconds are computed, never summed."""

from __future__ import annotations

from math import ceil
from typing import Final

PERIOD_S: Final = 0.004
"""Length of one tick, `get_steptime()`; *observed* (250 Hz streams of the vendor's SDK and pages)."""

TICKS_PER_S: Final = 250

_ROUNDING_TICKS: Final = 1e-9
"""A duration this little above a whole number of ticks is that number: it is rounding, not time."""


def seconds(tick: int) -> float:
    """The time of a tick."""
    return tick / TICKS_PER_S


def ticks_for(duration_s: float) -> int:
    """Ticks that a wait of `duration_s` takes: rounded up, a wait never ends early."""
    return max(0, ceil(duration_s * TICKS_PER_S - _ROUNDING_TICKS))
