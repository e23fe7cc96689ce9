"""What runs the runs of a plan: processes of this computer, or a cluster."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Protocol

from elitescript.sweep.plan import Choices, Plan, Row


class Engine(Protocol):
    """Runs a plan. Rows depend on the plan alone, never on the engine, its number of workers, or the order of work.

    Used as a context manager: leaving it ends what it has started.
    """

    def __enter__(self) -> Engine:
        """Begin to start workers."""

    def __exit__(self, *_: object) -> None:
        """End every worker at once; what they were at is dropped."""

    def rows(self, plan: Plan, wanted: Sequence[range]) -> Iterator[list[Row]]:
        """Yield the rows of runs as they come, a list for each piece of work: numbers that follow each other.

        Pieces come in any order; each run of `wanted` is in exactly one of them. A run that does not come back has the
        state `hung`, one whose process has died twice `crashed`. What is not asked for by the caller is not begun
        without limit: few pieces wait at any time.

        Args:
            plan: of the sweep.
            wanted: numbers of runs, without overlap.

        Raises:
            UsageError: the plan cannot be run there; the text names the worker if it is one.
        """

    def row(self, plan: Plan, choices: Choices) -> Row:
        """Return the row of one run with choices that were not drawn: of a case, or on the way to a smaller one."""
