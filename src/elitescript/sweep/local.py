"""The engine that runs a plan in processes of this computer."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from elitescript.sweep.executor import MAX_WALL_S, Executor, Result
from elitescript.sweep.plan import Choices, Failure, Plan, Row
from elitescript.sweep.plan_json import choices_data, plan_data, row_of
from elitescript.sweep.seeds import seed_of_run
from elitescript.sweep.variations import Draw

JOB: Final = "elitescript.sweep.single:job"


class LocalEngine:
    """Runs plans in processes of this computer. Implements `Engine`.

    Args:
        jobs: number of processes.
        max_wall_s: wall time of one run, after which it is given up; None for no limit.
        memory_bytes: address space of a process; None for no limit.
    """

    def __init__(
        self, jobs: int, *, max_wall_s: float | None = MAX_WALL_S, memory_bytes: int | None = None
    ) -> None:
        self._jobs = jobs
        self._max_wall_s = max_wall_s
        self._memory_bytes = memory_bytes
        self._plan: Plan | None = None
        self._executor: Executor | None = None

    def __enter__(self) -> LocalEngine:
        return self

    def __exit__(self, *_: object) -> None:
        if self._executor is not None:
            self._executor.__exit__()
            self._executor = None

    def rows(self, plan: Plan, wanted: Sequence[range]) -> Iterator[list[Row]]:
        """Yield the rows of runs as they come; see `Engine`."""
        draw = Draw(plan.variations, plan.seed)
        for results in self._executor_of(plan).results(wanted):
            yield [_row(plan, draw, result) for result in results]

    def row(self, plan: Plan, choices: Choices) -> Row:
        """Return the row of one run with given choices; see `Engine`."""
        result = self._executor_of(plan).result_of(choices_data(choices))
        return lost_row(choices, result.lost) if result.lost else row_of(result.value)

    def _executor_of(self, plan: Plan) -> Executor:
        if self._executor is None or plan is not self._plan:
            self.__exit__()
            self._plan = plan
            self._executor = Executor(
                JOB, plan_data(plan), jobs=self._jobs, max_wall_s=self._max_wall_s, memory_bytes=self._memory_bytes
            )
        return self._executor


def _row(plan: Plan, draw: Draw, result: Result) -> Row:
    if not result.lost:
        return row_of(result.value)
    run = result.number
    return lost_row(Choices(run, seed_of_run(plan.seed, run), draw.values(run)), result.lost)


def lost_row(choices: Choices, state: str) -> Row:
    """Return the row of a run that did not come back.

    Args:
        choices: of the run.
        state: `hung` or `crashed`.
    """
    text = "it did not come back within --max-wall" if state == "hung" else "its process died, twice"
    return Row(choices, state, None, failure=Failure(state, state, text=text))
