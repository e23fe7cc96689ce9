"""The engine that runs a plan in this process, one run after the other: for functions that no other process has."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from elitescript.sweep.plans.plan import Choices, Plan, Row
from elitescript.sweep.single import Runner


class HereEngine:
    """Runs the plan of a runner. Implements `Engine`; a run that hangs, hangs this process.

    Args:
        runner: of the plan.
    """

    workers = 1

    def __init__(self, runner: Runner) -> None:
        self._runner = runner

    def __enter__(self) -> HereEngine:
        return self

    def __exit__(self, *_: object) -> None:
        """Nothing was started."""

    def rows(self, _plan: Plan, wanted: Sequence[range]) -> Iterator[list[Row]]:
        """Yield the rows of runs one by one; see `Engine`."""
        for numbers in wanted:
            for number in numbers:
                yield [self._runner.run(self._runner.choices_of(number))]

    def rows_of(self, plan: Plan, choices: Sequence[Choices]) -> list[Row]:
        """Return the rows of runs with given choices, in their order; see `Engine`."""
        return [self.row(plan, one) for one in choices]

    def row(self, _plan: Plan, choices: Choices) -> Row:
        """Return the row of one such run; see `Engine`."""
        return self._runner.run(choices)
