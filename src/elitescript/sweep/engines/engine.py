"""What runs the runs of a plan: processes of this computer, or a cluster."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final, Protocol

from elitescript.sweep.engines.executor import Result
from elitescript.sweep.plans.plan import HUNG, Choices, Failure, Plan, Row
from elitescript.sweep.plans.plan_json import choices_of, row_of
from elitescript.sweep.plans.seeds import seed_of_run
from elitescript.sweep.plans.variations import Draw

JOB: Final = "elitescript.sweep.single:job"
"""What a child process does for either engine."""


class Engine(Protocol):
    """Runs a plan. Rows depend on the plan alone, never on the engine, its number of workers, or the order of work.

    Used as a context manager: leaving it ends what it has started.
    """

    @property
    def workers(self) -> int:
        """How many runs are made at the same time, at least one."""

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

    def rows_of(self, plan: Plan, choices: Sequence[Choices]) -> list[Row]:
        """Return the rows of runs with choices that were not drawn, in their order: of a search for better values."""

    def row(self, plan: Plan, choices: Choices) -> Row:
        """Return the row of one such run: of a case, or on the way to a smaller one."""


def row_of_result(plan: Plan, draw: Draw, result: Result) -> Row:
    """Return the row of a run by its number.

    Args:
        plan: of the sweep.
        draw: of its variations.
        result: what came of the run.
    """
    if not result.lost:
        return row_of(result.value)
    if result.value is not None:
        return lost_row(choices_of(result.value), result.lost)
    run = result.number
    return lost_row(Choices(run, seed_of_run(plan.seed, run), draw.values(run)), result.lost)


def rows_of_results(choices: Sequence[Choices], results: Sequence[Result]) -> list[Row]:
    """Return the rows of runs with given choices."""
    pairs = zip(choices, results, strict=True)
    return [lost_row(one, result.lost) if result.lost else row_of(result.value) for one, result in pairs]


def lost_row(choices: Choices, state: str) -> Row:
    """Return the row of a run that did not come back.

    Args:
        choices: of the run.
        state: `hung` or `crashed`.
    """
    text = "it did not come back within --max-wall" if state == HUNG else "its process died, twice"
    return Row(choices, state, None, failure=Failure(state, state, text=text))
