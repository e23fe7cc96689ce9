"""How long a child that owes an answer may be silent.

One that has worked for `PATIENCE_S` without saying anything is in a call that does not come back. Its own processor
time counts, so that a busy computer does not look like such a call; one that does not work either, because it sleeps,
is given up after `ABSENCE_MAX_S`. Reading a long program and its questions about files are no such calls: see
`compile_s` and `FILES_MAX_S`.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Final

PATIENCE_S: Final = 0.7
"""Processor time without a word after which a child is given up; wall time where processor time is not known."""
FIRST_PATIENCE_S: Final = 3.0
"""The same before the first output of a fresh child, which has its robot to make."""
ABSENCE_MAX_S: Final = 5.0
"""Wall time without a word after which a child is given up, whatever it does."""
COMPILE_S_PER_BYTE: Final = 40e-6
"""Added for every byte of program text; checking and compiling lines of `movel` takes a fifth of it (*measured*)."""
COMPILE_MAX_S: Final = 160.0
"""Added at most."""
FILES_MAX_S: Final = 10.0
"""How long questions about files in one tick count as being heard."""
PATIENCE_TICKS: Final = 20
"""Ticks that have gone by as well: whoever was away himself has no reason to complain."""


def compile_s(size: int) -> float:
    """How much longer a child may be silent that has so many bytes of program text to compile."""
    return min(size * COMPILE_S_PER_BYTE, COMPILE_MAX_S)


class HangWatchdog:
    """Watches one child after the other.

    Args:
        patience_s: silence after which a child is given up, in its own processor time.
    """

    __slots__ = ("_since_s", "_worked_s", "patience_s")

    def __init__(self, patience_s: float) -> None:
        self.patience_s = patience_s
        self._since_s = 0.0
        self._worked_s: float | None = None

    def begin(self, worked_s: float | None) -> None:
        """The child was heard, or is asked and owed nothing before.

        Args:
            worked_s: processor time that it has used so far; None if it is not known.
        """
        self._since_s = time.monotonic()
        self._worked_s = worked_s

    def silent_s(self) -> float:
        """How long it has not been heard."""
        return time.monotonic() - self._since_s

    def is_over(self, ticks: int, worked_s: Callable[[], float | None], *, is_fresh: bool, more_s: float = 0.0) -> bool:
        """Whether the child is to be given up.

        Args:
            ticks: that have gone by since it was asked what it has not answered.
            worked_s: tells its processor time.
            is_fresh: it has not answered anything yet.
            more_s: how much longer it may be silent than others.
        """
        silent_s = self.silent_s()
        patience_s = (max(self.patience_s, FIRST_PATIENCE_S) if is_fresh else self.patience_s) + more_s
        if silent_s < patience_s or ticks < PATIENCE_TICKS:
            return False
        now_s = worked_s()
        if now_s is None or self._worked_s is None:
            return True
        return now_s - self._worked_s >= patience_s or silent_s >= max(ABSENCE_MAX_S, patience_s)
