"""Ticks of a run against the wall clock: `--realtime`."""

from __future__ import annotations

import time
from typing import Final

from elitescript.messages.timing import PERIOD_S

LATE_S: Final = PERIOD_S
"""A tick that begins this much after its time is counted as an overrun."""


class Pacer:
    """Holds each tick back until its time has come; never skips one.

    Attributes:
        overruns: ticks that began late by a period or more.
    """

    __slots__ = ("_first_tick", "_start_s", "overruns")

    def __init__(self) -> None:
        self._start_s = 0.0
        self._first_tick = -1
        self.overruns = 0

    def __call__(self, tick: int) -> None:
        """Wait for the time of `tick`."""
        now_s = time.perf_counter()
        if self._first_tick < 0:
            self._first_tick, self._start_s = tick, now_s
        due_s = self._start_s + (tick - self._first_tick) * PERIOD_S
        if now_s < due_s:
            time.sleep(due_s - now_s)
        elif now_s - due_s >= LATE_S:
            self.overruns += 1
