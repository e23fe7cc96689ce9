"""What a process of `make chaos` does: plays the session of a number, or one that it is given."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from tests.chaos.playing import failure_of
from tests.chaos.sessions import drawn


def job(first_seed: Any) -> Callable[[Any], Any]:
    """Return what plays sessions: the number of one counts from `first_seed`."""

    def played(order: Any) -> list[Any]:
        """Return what does not hold, the ticks of the first play, and those of all of them."""
        return list(failure_of(order if isinstance(order, dict) else drawn(int(first_seed) + order)))

    return played
