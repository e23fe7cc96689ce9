"""What is kept of the rows of a sweep while they come: counts, sketches, first failures, smallest margins, a sample."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Final

from elitescript.messages.signals import Value
from elitescript.records import NamedTuple
from elitescript.sweep.plans.plan import Disturbance, Row, Variation
from elitescript.sweep.results.sketches import Sample, Sketch

KINDS_MAX: Final = 500
"""Kinds of failures that are told apart; the rest are counted together."""

ROWS_OF_KIND: Final = 10
"""First failing rows of each kind that are kept."""

WORDS_MAX: Final = 30
"""Different values of a measure that is no number; the rest are counted together."""

SAMPLE: Final = 8192
"""Rows that hold, and as many that fail, from which it is worked out which variations matter."""

OTHERS: Final = "(others)"
"""Stands for the values beyond `WORDS_MAX`, and for what belongs to no kept kind."""


class Kept(NamedTuple):
    """A row of the sample.

    Attributes:
        run: its number.
        values: of the variations, in their order; None where a row has none.
        disturbances: names of its disturbances, each once.
        state: of the run.
        time_s: virtual time, s; None if it did not come back.
        measures: in their order.
        margins: of the properties in their order.
        kind: number of the kind of its failure; -1 if it holds.
    """

    run: int
    values: tuple[Value | str | None, ...]
    disturbances: tuple[str, ...]
    state: str
    time_s: float | None
    measures: tuple[Value | str | None, ...]
    margins: tuple[float | None, ...]
    kind: int


class Nearest(NamedTuple):
    """The run in which a property held, or failed, by the smallest margin."""

    margin: float
    run: int


class Group:
    """Failures of one kind.

    Attributes:
        number: of the kind, in the order of their first failures.
        kind: expression, alarm code, line and last disturbance.
        count: of its failures.
        rows: the first `ROWS_OF_KIND` of them.
    """

    __slots__ = ("count", "kind", "number", "rows")

    def __init__(self, number: int, kind: tuple[str, str, int, str]) -> None:
        self.number = number
        self.kind = kind
        self.count = 0
        self.rows: list[Row] = []


class Totals:
    """Adds up rows. Add them in the order of their numbers: first failures are the first that are added.

    Args:
        variations: of the plan.
        properties: their texts, in the order of `Row.margins`.
        measures: their names.
        sample: rows of either sort that are kept as a sample.
    """

    __slots__ = (
        "failing", "failing_sample", "groups", "holding_sample", "measures", "nearest", "nearest_rows", "other_kinds",
        "properties", "runs", "states", "times", "variations", "warned", "words", "worst",
    )  # fmt: skip

    def __init__(
        self,
        variations: Sequence[Variation],
        properties: Sequence[str] = (),
        measures: Sequence[str] = (),
        sample: int = SAMPLE,
    ) -> None:
        self.variations = tuple(variations)
        self.properties = tuple(properties)
        self.runs = 0
        self.warned = 0
        """Runs that have found warnings of their own."""
        self.failing: Counter[str] = Counter()
        """Failures by property."""
        self.states: Counter[str] = Counter()
        self.times: dict[str, Sketch] = {}
        """Virtual times by the state in which the runs ended."""
        self.measures = {name: Sketch() for name in measures}
        self.words: dict[str, Counter[str]] = {name: Counter() for name in measures}
        """Values of measures that are no numbers."""
        self.groups: dict[tuple[str, str, int, str], Group] = {}
        self.other_kinds = 0
        """Failures of kinds beyond `KINDS_MAX`."""
        self.nearest: list[Nearest | None] = [None] * len(self.properties)
        """By property: the smallest margin of runs in which it held."""
        self.nearest_rows: list[Row | None] = [None] * len(self.properties)
        self.worst: list[Nearest | None] = [None] * len(self.properties)
        """By property: the smallest margin of all runs, below 0 if it failed."""
        self.holding_sample: Sample[Kept] = Sample(sample)
        self.failing_sample: Sample[Kept] = Sample(sample)

    def add(self, row: Row) -> None:
        """Add a row."""
        self.runs += 1
        self.warned += row.is_warned
        self.states[row.state] += 1
        if row.time_s is not None:
            self.times.setdefault(row.state, Sketch()).add(row.time_s)
        for name, sketch in self.measures.items():
            value = row.measures.get(name)
            if isinstance(value, int | float) and not isinstance(value, bool):
                sketch.add(float(value))
            elif value is not None:
                counts = self.words[name]
                word = str(value).lower() if isinstance(value, bool) else str(value)
                counts[word if word in counts or len(counts) < WORDS_MAX else OTHERS] += 1
        self._add_margins(row)
        kind = -1 if row.failure is None else self._add_failure(row)
        sample = self.holding_sample if row.failure is None else self.failing_sample
        sample.add(row.choices.run, lambda: self._kept(row, kind))

    @property
    def failed(self) -> int:
        """Number of failing runs."""
        return self.failing.total()

    def alike(self) -> list[list[Group]]:
        """Return the kinds of failures, those together that differ in the last disturbance alone; most frequent first.

        Many disturbances show one mistake of a program.
        """
        found: dict[tuple[str, str, int], list[Group]] = {}
        for group in self.groups.values():
            found.setdefault(group.kind[:3], []).append(group)
        return sorted(found.values(), key=lambda groups: (-sum(group.count for group in groups), groups[0].number))

    def _add_margins(self, row: Row) -> None:
        for index, margin in enumerate(row.margins[: len(self.properties)]):
            if margin is None:
                continue
            worst = self.worst[index]
            if worst is None or (margin, row.choices.run) < worst:
                self.worst[index] = Nearest(margin, row.choices.run)
            nearest = self.nearest[index]
            if row.failure is None and (nearest is None or (margin, row.choices.run) < nearest):
                self.nearest[index] = Nearest(margin, row.choices.run)
                self.nearest_rows[index] = row

    def _add_failure(self, row: Row) -> int:
        """Count a failure; return the number of its kind, `KINDS_MAX` for those that are not told apart."""
        failure = row.failure
        assert failure is not None
        self.failing[failure.expression] += 1
        group = self.groups.get(failure.kind)
        if group is None:
            if len(self.groups) >= KINDS_MAX:
                self.other_kinds += 1
                return KINDS_MAX
            group = self.groups[failure.kind] = Group(len(self.groups), failure.kind)
        group.count += 1
        if len(group.rows) < ROWS_OF_KIND:
            group.rows.append(row)
        return group.number

    def _kept(self, row: Row, kind: int) -> Kept:
        choices = row.choices
        return Kept(
            choices.run,
            tuple(choices.values.get(variation.name) for variation in self.variations),
            tuple(dict.fromkeys(map(name_of, choices.disturbances))),
            row.state,
            row.time_s,
            tuple(row.measures.get(name) for name in self.measures),
            row.margins,
            kind,
        )


def name_of(disturbance: Disturbance) -> str:
    """Return a disturbance in two or three words: its kind, and where."""
    return disturbance.kind if disturbance.on == "" else f"{disturbance.kind} on {disturbance.on}"
