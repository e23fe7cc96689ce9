"""Child processes that do numbered pieces of work: they are given ranges, replaced when they die, ended when they hang."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Final

from elitescript.records import NamedTuple

MAX_WALL_S: Final = 60.0
"""Wall time of one piece of work after which its process is ended, *assumed*."""

HUNG: Final = "hung"
CRASHED: Final = "crashed"


class Result(NamedTuple):
    """What came of one piece of work.

    Attributes:
        number: of it.
        value: what the job returned; None if it did not.
        lost: empty if it did; `hung` if it took too long, `crashed` if its process died twice.
    """

    number: int
    value: Any
    lost: str = ""


class Executor:
    """Starts child processes and gives them work.

    A child imports `job`, `module:function`, calls it once with `description`, and calls what that returns for each
    piece of work: with its number, or with what `result_of` is given. What it returns must be JSON-able.

    Args:
        job: `module:function`.
        description: JSON-able.
        jobs: number of processes.
        max_wall_s: wall time of one piece of work; None for no limit.
        memory_bytes: address space of a child, where the system can limit it.
    """

    def __init__(
        self,
        job: str,
        description: Any,
        *,
        jobs: int,
        max_wall_s: float | None = MAX_WALL_S,
        memory_bytes: int | None = None,
    ) -> None:
        raise NotImplementedError

    def __enter__(self) -> Executor:
        raise NotImplementedError

    def __exit__(self, *_: object) -> None:
        raise NotImplementedError

    def results(self, wanted: Sequence[range]) -> Iterator[list[Result]]:
        """Yield what came of numbered work, a list for each piece: numbers that follow each other, in any order."""
        raise NotImplementedError

    def result_of(self, order: Any) -> Result:
        """Return what came of one piece of work that has no number: `order`, JSON-able, is given to the job."""
        raise NotImplementedError
