"""Collects garbage while nobody waits for an answer.

A version of a text that has been replaced is 80,000 objects in cycles. Python's collector would begin where it likes,
mostly inside an answer, and take up to 400 ms when many of them have come together.
"""

from __future__ import annotations

import asyncio
import gc
import sys
from typing import Final

QUIET_S: Final = 0.05
"""Time without a message, and with nothing to do, before garbage is collected, s."""
OBJECTS_MIN: Final = 20_000
"""Number of new objects below which a collection is not worth its time."""
OBJECTS_MAX: Final = 300_000
"""Number of new objects with which it is not put off any more: about four versions of 2,000 lines."""

BLOCKS_OF_OBJECT: Final = 2
"""Blocks of memory for an object that a collection looks at, about."""


class Collector:
    """Takes the place of Python's own collection from when it is made on; what lives then is never looked at again.

    A collection goes through all that lives, so there must have come up a share of that before the next one.
    """

    __slots__ = ("_due_s", "_frozen", "_live", "_timer")

    def __init__(self) -> None:
        gc.collect()
        gc.freeze()
        gc.disable()
        self._frozen = sys.getallocatedblocks()
        """Blocks of memory of what is never looked at."""
        self._live = 0
        """Number of objects that the last collection has left, about."""
        self._due_s = 0.0
        self._timer: asyncio.TimerHandle | None = None

    def message_came(self) -> None:
        """Put the collection off; called for each message of the client."""
        if gc.get_count()[0] > max(OBJECTS_MAX, self._live // 2):
            self._collect()
        self._wait()

    def close(self) -> None:
        """Leave out what is due."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _wait(self) -> None:
        self.close()
        loop = asyncio.get_running_loop()
        self._due_s = loop.time() + QUIET_S
        self._timer = loop.call_at(self._due_s, self._pause)

    def _pause(self) -> None:
        if asyncio.get_running_loop().time() > self._due_s + QUIET_S:
            # An answer has taken all the time since; the next message may be on its way.
            self._wait()
        elif gc.get_count()[0] > max(OBJECTS_MIN, self._live // 4):
            self._collect()

    def _collect(self) -> None:
        gc.collect()
        # Not `gc.get_objects`: a tuple that another thread is filling must not be referred to.
        self._live = (sys.getallocatedblocks() - self._frozen) // BLOCKS_OF_OBJECT
