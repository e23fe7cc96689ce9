"""The engine that runs a plan in processes of this computer."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from elitescript.sweep.engines.engine import JOB, row_of_result, rows_of_results
from elitescript.sweep.engines.executor import MAX_WALL_S, Executor
from elitescript.sweep.plans.plan import Choices, Plan, Row
from elitescript.sweep.plans.plan_json import choices_data, plan_data
from elitescript.sweep.plans.variations import Draw


class LocalEngine:
    """Runs plans in processes of this computer. Implements `Engine`.

    Args:
        jobs: number of processes.
        max_wall_s: wall time of one run, after which it is given up; None for no limit.
        memory_bytes: address space of a process; None for no limit.
    """

    def __init__(self, jobs: int, *, max_wall_s: float | None = MAX_WALL_S, memory_bytes: int | None = None) -> None:
        self._jobs = jobs
        self._max_wall_s = max_wall_s
        self._memory_bytes = memory_bytes
        self._plan: Plan | None = None
        self._executor: Executor | None = None

    @property
    def workers(self) -> int:
        """Number of processes; see `Engine`."""
        return self._jobs

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
            yield [row_of_result(plan, draw, result) for result in results]

    def rows_of(self, plan: Plan, choices: Sequence[Choices]) -> list[Row]:
        """Return the rows of runs with given choices, in their order; see `Engine`."""
        results = self._executor_of(plan).results_of([choices_data(one) for one in choices])
        return rows_of_results(choices, results)

    def row(self, plan: Plan, choices: Choices) -> Row:
        """Return the row of one such run; see `Engine`."""
        return self.rows_of(plan, [choices])[0]

    def _executor_of(self, plan: Plan) -> Executor:
        if self._executor is None or plan is not self._plan:
            self.__exit__()
            self._plan = plan
            self._executor = Executor(
                JOB, plan_data(plan), jobs=self._jobs, max_wall_s=self._max_wall_s, memory_bytes=self._memory_bytes
            )
        return self._executor
