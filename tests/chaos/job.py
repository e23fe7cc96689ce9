"""What a process of `make chaos` does: plays the session of a number, or one that it is given.

python -m tests.chaos.job SEED ...     prints the digests of what the sessions of some seeds said, as JSON
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from typing import Any

from tests.chaos.playing import digest_of, verdict_of
from tests.chaos.sessions import drawn


def job(first_seed: Any) -> Callable[[Any], Any]:
    """Return what plays sessions: the number of one counts from `first_seed`."""

    def played(order: Any) -> list[Any]:
        """Return the fields of a verdict."""
        return list(verdict_of(order if isinstance(order, dict) else drawn(int(first_seed) + order)))

    return played


if __name__ == "__main__":
    print(json.dumps([digest_of(drawn(int(seed))) for seed in sys.argv[1:]]))
