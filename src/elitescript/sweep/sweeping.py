"""A sweep from its plan to its table: rows go into the journal as they come, and from there in order to all else."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from elitescript.sweep.engines.engine import Engine
from elitescript.sweep.plans.plan import Plan, Row
from elitescript.sweep.results.journal import Journal
from elitescript.sweep.results.tables import write_table

Progress = Callable[[int, int], None]
"""Called with the number of runs that are done, and of those that failed."""


class Sweeping:
    """One sweep: what it does, and how far it is.

    Args:
        plan: what is run.
        runs: how often.
        journal: where rows are kept.
        first: number of the first run; those before it are left out.

    Attributes:
        plan: see above.
        runs: see above.
        journal: see above.
        done: number of runs whose rows are there.
        failed: how many of them failed.
    """

    def __init__(self, plan: Plan, runs: int, journal: Journal, first: int = 0) -> None:
        self.plan = plan
        self.runs = runs
        self.journal = journal
        self._first = first
        self.done = self.failed = 0
        for row in self.rows():
            self._count(row)

    def go(
        self, engine: Engine, progress: Progress | None = None, in_order: Callable[[Row], None] | None = None
    ) -> None:
        """Run what is missing.

        Args:
            engine: runs it.
            progress: called after each piece of work.
            in_order: called with each row, in the order of numbers, as soon as all before it are there.
        """
        shown = self._shown_in_order(in_order) if in_order is not None else None
        missing = [range(max(numbers.start, self._first), numbers.stop) for numbers in self.journal.missing(self.runs)]
        if shown is not None:
            next(shown)
        if not missing:
            return
        for rows in engine.rows(self.plan, missing):
            self.journal.add(rows)
            for row in rows:
                self._count(row)
            if progress is not None:
                progress(self.done, self.failed)
            if shown is not None:
                next(shown)

    def rows(self) -> Iterator[Row]:
        """Yield the rows that are there, in the order of their numbers."""
        return self.journal.rows(self.runs)

    def finish(self, out: Path | None, look: Callable[[Row], None] | None = None) -> None:
        """Write the table; every row is looked at on the way.

        Args:
            out: the table; None for none.
            look: called with each row, in the order of numbers.
        """

        def looked_at() -> Iterator[Row]:
            for row in self.rows():
                if look is not None:
                    look(row)
                yield row

        if out is None:
            for _ in looked_at():
                pass
        else:
            write_table(out, self.plan, looked_at())

    def _count(self, row: Row) -> None:
        self.done += 1
        self.failed += row.failure is not None

    def _shown_in_order(self, show: Callable[[Row], None]) -> Iterator[None]:
        """Show the rows of the journal as far as none is missing; each step goes on from there."""
        at = self._first
        while True:
            for row in self.journal.rows_from(at, self.runs):
                show(row)
                at = row.choices.run + 1
            yield


def is_random(plan: Plan) -> bool:
    """Return whether anything but the seed of `random()` is drawn at random."""
    return bool(plan.chaos) or any(row.kind != "grid" for row in plan.variations) or "random" in plan.program
