"""What clients send that fails: the first of a burst are reported one by one, the others counted.

That a line which does not compile is an exception is *documented*. How many exceptions a controller makes of a flood of
them is not known; each delays what others get, so their number is limited (*assumed*).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from elitescript.messages.timing import TICKS_PER_S

REPORTED_MAX: Final = 10
"""Of one client's burst."""
BURST_TICKS: Final = TICKS_PER_S
"""Without one, after which a burst is over."""
REPORT_TICKS: Final = TICKS_PER_S
"""Between two reports of a burst that goes on."""


class BurstLimiter:
    """Counts what fails, for each client.

    Args:
        warn: takes a line for the log.
        noun: what is counted, in the singular.
        clause: says what is wrong with it, behind the noun.
    """

    __slots__ = ("_bursts", "_clause", "_noun", "_warn")

    def __init__(self, warn: Callable[[str], None], noun: str, clause: str) -> None:
        self._warn = warn
        self._noun = noun
        self._clause = clause
        self._bursts: dict[str, _Burst] = {}

    @property
    def is_counting(self) -> bool:
        """Whether the burst of a client goes on."""
        return bool(self._bursts)

    def is_reported(self, origin: str, tick: int) -> bool:
        """Count one of a client; return whether it is to be reported and not only counted."""
        burst = self._bursts.get(origin)
        if burst is None:
            burst = self._bursts[origin] = _Burst(tick)
        burst.last_tick = tick
        if burst.reported < REPORTED_MAX:
            burst.reported += 1
            return True
        burst.left_out += 1
        return False

    def go_on(self, tick: int) -> None:
        """Begin a tick: report bursts that are over, or go on since the last report of `REPORT_TICKS` ago."""
        for origin, burst in list(self._bursts.items()):
            is_over = tick - burst.last_tick >= BURST_TICKS
            if burst.left_out and (is_over or tick - burst.report_tick >= REPORT_TICKS):
                count = f"{burst.left_out} more {self._noun}{'' if burst.left_out == 1 else 's'}"
                self._warn(f"{origin} sent {count} {self._clause}")
                burst.left_out, burst.report_tick = 0, tick
            if is_over:
                del self._bursts[origin]


class _Burst:
    """What a client has sent without a pause."""

    __slots__ = ("last_tick", "left_out", "report_tick", "reported")

    def __init__(self, tick: int) -> None:
        self.last_tick = self.report_tick = tick
        self.reported = self.left_out = 0
