"""Collects garbage while nobody waits for an answer.

A version of a text that has been replaced is a hundred thousand objects in cycles. Python's collector would begin
where it likes, mostly inside an answer, and take up to 400 ms when many of them have come together.
"""

from __future__ import annotations

import asyncio
import gc
from time import perf_counter
from typing import Final

QUIET_S: Final = 0.2
"""Least time without a message before garbage is collected, s."""
QUIET_RATIO: Final = 20.0
"""The same in units of the time that the last collection took, so that a large workspace rarely waits for one."""
OBJECTS_MIN: Final = 10_000
"""Number of new objects for which a collection is not worth its time."""
OBJECTS_MAX: Final = 300_000
"""Number of new objects with which it is not put off any more: three to six versions of 2,000 lines."""
OBJECTS_PER_S: Final = 1e7
"""The same for each second that the last collection took."""


class Collector:
    """Takes the place of Python's own collection from when it is made on; what lives then is never looked at again."""

    __slots__ = ("_last_s", "_timer")

    def __init__(self) -> None:
        self._last_s = 0.0
        self._timer: asyncio.TimerHandle | None = None
        gc.collect()
        gc.freeze()
        gc.disable()

    def message_came(self) -> None:
        """Put the collection off; called for each message of the client."""
        self.close()
        if gc.get_count()[0] > max(OBJECTS_MAX, OBJECTS_PER_S * self._last_s):
            self.collect()
        quiet_s = max(QUIET_S, QUIET_RATIO * self._last_s)
        self._timer = asyncio.get_running_loop().call_later(quiet_s, self.collect)

    def collect(self) -> None:
        """Collect, unless there is little to be found."""
        if gc.get_count()[0] > OBJECTS_MIN:
            started_s = perf_counter()
            gc.collect()
            self._last_s = perf_counter() - started_s

    def close(self) -> None:
        """Leave out what is due."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
