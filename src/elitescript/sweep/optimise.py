"""Values that make a measure as small, or as large, as possible while properties hold: extra `optimise`.

Candidates come from Optuna's TPE with a seed, in batches of a fixed size, and the last ones are steps from the best:
so they depend on the plan alone, not on the number of workers. Each is run as a run of a sweep is, on either engine; if
it is run several times, then with the same seeds, variations and disturbances as every other candidate.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import floor, isfinite, log10
from typing import TYPE_CHECKING, Any, Final

from elitescript.errors import UsageError
from elitescript.extras import require
from elitescript.records import field, record, replace
from elitescript.sweep.engines.engine import Engine
from elitescript.sweep.plans.plan import LOST, Choices, Plan, Row, Variation
from elitescript.sweep.plans.seeds import seed_of_run
from elitescript.sweep.plans.variations import Draw
from elitescript.sweep.single import Runner

if TYPE_CHECKING:
    from optuna.distributions import BaseDistribution
    from optuna.trial import Trial

BATCH: Final = 8
"""Candidates that are asked for at once, whatever the number of workers: with it the result would change."""

OBJECTIVE: Final = "objective"
"""Name of the measure that is made small or large."""

DIGITS: Final = 3
"""Candidates are rounded to so many digits of the width of their range: nobody types seventeen."""

STEP: Final = 0.1
"""Share of its range by which a value is changed alone: by the first steps, and at the end to see what matters."""

LOCAL_SHARE: Final = 0.25
"""Share of the candidates that are steps from the best one, in one value each: TPE ends near an optimum, not in it."""

POINTS_MAX: Final = 10_000
"""Points of a grid: beyond, its values have more digits than `DIGITS` anyway."""

LEAST_STEP: Final = 0.002
"""Share of its range below which a step is no step."""

UNACCEPTABLE: Final = ("alarm", "stuck", *LOST)
"""States that no objective can make good."""


@record
class Search:
    """What is looked for.

    Attributes:
        plan: its variations and disturbances are those that each candidate has to cope with.
        over: what is chosen: `uniform`, `choice` and `grid`.
        objective: a measure.
        is_maximum: whether it is to be large.
        runs: in all, without those of the comparison at the end.
        repeats: runs of each candidate.
        is_worst: whether the worst run of a candidate counts, else their mean.
    """

    plan: Plan
    over: tuple[Variation, ...]
    objective: str
    is_maximum: bool = False
    runs: int = 100
    repeats: int = 1
    is_worst: bool = False

    @property
    def candidates(self) -> int:
        """How many are tried."""
        return self.runs // self.repeats

    @property
    def plain_plan(self) -> Plan:
        """Of the program with its own values."""
        measures = {**self.plan.measures, OBJECTIVE: self.objective}
        return replace(self.plan, measures=measures, has_margins=True)

    @property
    def table_plan(self) -> Plan:
        """Of the candidates: what is chosen is varied there."""
        return replace(self.plain_plan, variations=(*self.plan.variations, *self.over))

    def better(self, best: Candidate | None, candidate: Candidate) -> Candidate | None:
        """Return the better of two candidates: the first one if they are equal, None if neither holds."""
        if not candidate.holds:
            return best
        return candidate if best is None or _cost(self, candidate) < _cost(self, best) else best


@record
class Candidate:
    """Some values, and what came of them.

    Attributes:
        number: from 0; -1 of what is not one of the search.
        values: by name; empty for those of the program.
        rows: of its runs.
        objective: mean or worst of them; None if a run has none.
        failed: first property that did not hold in some run, or the state in which it ended; empty if all is well.
        margins: smallest of each property; None where it has none.
    """

    number: int
    values: Mapping[str, Any]
    rows: tuple[Row, ...]
    objective: float | None
    failed: str
    margins: tuple[float | None, ...]

    @property
    def rows_digest(self) -> tuple[str, ...]:
        """Digests of its runs: equal if nothing differs."""
        return tuple(row.digest for row in self.rows)

    @property
    def holds(self) -> bool:
        """Whether it has an objective and every property holds."""
        return not self.failed and self.objective is not None


@record
class Change:
    """What changing one value of the best candidate does.

    Attributes:
        name: of the value.
        low: the best candidate with a smaller value; None at the end of the range.
        high: the same with a larger one.
        others: the same with each other choice.
    """

    name: str
    low: Candidate | None = None
    high: Candidate | None = None
    others: tuple[Candidate, ...] = ()


@record
class Outcome:
    """What was found.

    Attributes:
        search: what was looked for.
        plain: the program as it is.
        best: None if no candidate holds.
        candidates: in the order in which they were tried.
        changes: of the best one, in the order of `over`.
    """

    search: Search
    plain: Candidate
    best: Candidate | None
    candidates: tuple[Candidate, ...]
    changes: tuple[Change, ...] = field(default_factory=tuple)


def check_search(search: Search) -> Sequence[Any]:
    """Refuse what cannot be searched; return warnings about the program.

    Raises:
        UsageError: the text names the option.
        ProgramError: the program does not compile.
    """
    if not search.over:
        raise UsageError("--minimise, --maximise: say what may change, as --over 'speed=uniform(0.1, 1)'")
    varied = {row.name for row in search.plan.variations}
    for row in search.over:
        if row.kind == "normal":
            raise UsageError(f"--over {row.name}: normal has no ends; write uniform, choice or grid")
        if row.name in varied:
            raise UsageError(f"--over {row.name}: --vary draws it; it cannot be chosen as well")
        if sum(row.name == other.name for other in search.over) > 1:
            raise UsageError(f"--over {row.name}: it is chosen twice")
        if row.kind == "grid" and int(row.arguments[2]) > POINTS_MAX:
            raise UsageError(f"--over {row.name}: {row.arguments[2]} points; write uniform for more than {POINTS_MAX}")
    if not 1 <= search.repeats <= search.runs:
        raise UsageError(f"--repeat {search.repeats}: write a whole number from 1 to --runs, {search.runs}")
    if OBJECTIVE in search.plan.measures:
        raise UsageError(f"--measure {OBJECTIVE}: that is the name of what --minimise or --maximise measures")
    return Runner(search.table_plan).problems


def optimise(
    search: Search, engine: Engine, *, on_candidate: Callable[[Candidate], None] = lambda candidate: None
) -> Outcome:
    """Look for the best values.

    Args:
        search: what is looked for; `check_search` has looked at it.
        engine: entered; does the runs.
        on_candidate: called for each candidate, in their order.

    Raises:
        UsageError: the search or its plan makes no sense, or optuna is missing.
    """
    runner = _Runner(search, engine)
    sampler = _Sampler(search)
    candidates: list[Candidate] = []
    best: Candidate | None = None

    def tried(values: Sequence[Mapping[str, Any]]) -> list[Candidate]:
        nonlocal best
        found = runner.candidates(values, len(candidates))
        for candidate in found:
            best = search.better(best, candidate)
            on_candidate(candidate)
        candidates.extend(found)
        return found

    def sample(until: int) -> None:
        while len(candidates) < until:
            trials = sampler.ask(min(BATCH, until - len(candidates)))
            for (trial, _), candidate in zip(trials, tried([values for _, values in trials]), strict=True):
                sampler.tell(trial, candidate)

    plain = runner.plain()
    sample(search.candidates - int(LOCAL_SHARE * search.candidates))
    step = STEP
    while best is not None and len(candidates) < search.candidates and step >= LEAST_STEP:
        before = best
        known = [candidate.values for candidate in candidates]
        around = [values for _, _, values in _around(search, best, step) if values not in known]
        tried(around[: search.candidates - len(candidates)])
        if best is before:
            step /= 2
    # What no step is fine enough for, and a search in which nothing holds yet, goes on as it began.
    sample(search.candidates)
    changes = tuple(runner.changes(best)) if best is not None else ()
    return Outcome(search, plain, best, tuple(candidates), changes)


def rounded(variation: Variation, value: float) -> float:
    """Return a number near a value, within the range, with few digits."""
    low, high = (float(end) for end in variation.arguments[:2])
    if low == high:
        return low
    digits = DIGITS - floor(log10(high - low))
    return min(max(round(value, digits), low), high)


class _Runner:
    """Runs candidates.

    Args:
        search: of which they are.
        engine: does the runs.
    """

    __slots__ = ("_drawn", "_engine", "_plan", "_search")

    def __init__(self, search: Search, engine: Engine) -> None:
        self._search = search
        self._engine = engine
        self._plan = search.table_plan
        runner = Runner(search.plain_plan)
        self._drawn = [runner.choices_of(repeat) for repeat in range(search.repeats)]

    def plain(self) -> Candidate:
        """Run the program with its own values."""
        choices = [self._choices(repeat, repeat, {}) for repeat in range(self._search.repeats)]
        return self._judged(-1, {}, self._engine.rows_of(self._search.plain_plan, choices))

    def candidates(self, values: Sequence[Mapping[str, Any]], first: int) -> list[Candidate]:
        """Run several candidates; the first one has the number `first`, or all have -1."""
        repeats = self._search.repeats
        choices = [
            self._choices(max(first, 0) * repeats + index, index % repeats, values[index // repeats])
            for index in range(len(values) * repeats)
        ]
        rows = self._engine.rows_of(self._plan, choices)
        return [
            self._judged(first + at if first >= 0 else -1, values[at], rows[at * repeats : (at + 1) * repeats])
            for at in range(len(values))
        ]

    def changes(self, best: Candidate) -> Iterator[Change]:
        """Change one value of the best candidate at a time."""
        asked = list(_around(self._search, best, STEP))
        found = self.candidates([values for _, _, values in asked], -1)
        for row in self._search.over:
            sides: dict[str, list[Candidate]] = {"low": [], "high": [], "other": []}
            for (name, side, _), candidate in zip(asked, found, strict=True):
                if name == row.name:
                    sides[side].append(candidate)
            low, high = (sides[side][0] if sides[side] else None for side in ("low", "high"))
            yield Change(row.name, low, high, tuple(sides["other"]))

    def _choices(self, run: int, repeat: int, values: Mapping[str, Any]) -> Choices:
        """Return the choices of a run: all candidates have the same seed, variations and disturbances in a repeat."""
        drawn = self._drawn[repeat]
        return replace(drawn, run=run, values={**drawn.values, **values})

    def _judged(self, number: int, values: Mapping[str, Any], rows: Sequence[Row]) -> Candidate:
        search = self._search
        measured = [_number(row.measures.get(OBJECTIVE)) for row in rows]
        known = [value for value in measured if value is not None]
        objective: float | None = None
        if len(known) == len(rows):
            worst = min(known) if search.is_maximum else max(known)
            objective = worst if search.is_worst else sum(known) / len(known)
        failed = next((reason for row in rows if (reason := _failure(row))), "")
        if not failed and objective is None:
            failed = f"{search.objective} is no number"
        margins = [
            min((margin for margin in column if margin is not None), default=None)
            for column in zip(*(row.margins for row in rows), strict=False)
        ]
        return Candidate(number, values, tuple(rows), objective, failed, tuple(margins))


def _failure(row: Row) -> str:
    return row.failed or (row.state if row.state in UNACCEPTABLE else "")


def _number(value: Any) -> float | None:
    is_number = isinstance(value, int | float) and isfinite(value)
    return float(value) if is_number else None


def _cost(search: Search, candidate: Candidate) -> float:
    assert candidate.objective is not None
    return -candidate.objective if search.is_maximum else candidate.objective


def _around(search: Search, best: Candidate, step: float) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Yield values that differ from the best ones in one, with its name and to which side it is changed."""
    for row in search.over:
        for side, value in _neighbours(row, best.values[row.name], step):
            yield row.name, side, {**best.values, row.name: value}


def _neighbours(row: Variation, value: Any, step: float) -> Iterator[tuple[str, Any]]:
    """Yield what a value is changed into, by this share of its range, and to which side of it that lies."""
    if row.kind == "choice":
        for other in row.arguments:
            if other != value:
                yield "other", other
        return
    if row.kind == "grid":
        points = Draw((row,), 0)
        every = [points.values(at)[row.name] for at in range(int(row.arguments[2]))]
        at = every.index(value)
        if at > 0:
            yield "low", every[at - 1]
        if at + 1 < len(every):
            yield "high", every[at + 1]
        return
    low, high = (float(end) for end in row.arguments)
    width = step * (high - low)
    for side, other in (("low", rounded(row, value - width)), ("high", rounded(row, value + width))):
        if other != value:
            yield side, other


class _Sampler:
    """Proposes values, and learns from what came of them.

    Args:
        search: what is looked for.

    Raises:
        UsageError: optuna is missing.
    """

    __slots__ = ("_distributions", "_grids", "_search", "_study")

    def __init__(self, search: Search) -> None:
        require("optimise")
        import optuna

        optuna.logging.set_verbosity(optuna.logging.ERROR)
        self._search = search
        self._grids: dict[str, Draw] = {}
        self._distributions = {row.name: self._distribution(row) for row in search.over}
        self._study = optuna.create_study(
            direction="maximize" if search.is_maximum else "minimize",
            sampler=optuna.samplers.TPESampler(seed=seed_of_run(search.plan.seed, 0) % (1 << 32)),
        )

    def ask(self, count: int) -> list[tuple[Trial, dict[str, Any]]]:
        """Return so many candidates, all before any of them is told."""
        trials = [self._study.ask(self._distributions) for _ in range(count)]
        return [
            (trial, {row.name: self._value(row, trial.params[row.name]) for row in self._search.over})
            for trial in trials
        ]

    def tell(self, trial: Trial, candidate: Candidate) -> None:
        """Note what came of a candidate.

        A margin below 0 is how far a property is from holding; without one, a failure counts as 1. The objective of a
        candidate that fails is not looked at, so it may be any number.
        """
        for index, margin in enumerate(candidate.margins):
            if margin is not None:
                trial.set_constraint(f"property {index}", -margin)
        has_violation = any(margin is not None and margin < 0 for margin in candidate.margins)
        trial.set_constraint("failed", 1.0 if candidate.failed and not has_violation else 0.0)
        self._study.tell(trial, 0.0 if candidate.objective is None else candidate.objective)

    def _distribution(self, row: Variation) -> BaseDistribution:
        from optuna.distributions import CategoricalDistribution, FloatDistribution, IntDistribution

        if row.kind == "uniform":
            low, high = row.arguments
            return FloatDistribution(float(low), float(high))
        if row.kind == "grid":
            self._grids[row.name] = Draw((row,), 0)
            return IntDistribution(0, int(row.arguments[2]) - 1)
        # By their numbers: choices may be lists.
        return CategoricalDistribution(list(range(len(row.arguments))))

    def _value(self, row: Variation, proposed: Any) -> Any:
        if row.kind == "uniform":
            return rounded(row, proposed)
        if row.kind == "grid":
            return self._grids[row.name].values(proposed)[row.name]
        return row.arguments[proposed]
