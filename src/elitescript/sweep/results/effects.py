"""Which variations matter: for failing, for measures and for time; and where in their box runs fail.

Two questions, each answered with what chance alone would do held against it:

- An effect: do runs differ between the low and the high values of a variation, or with and without a disturbance? The
  test of Kruskal and Wallis on ranks finds any dependence, not only a rising or falling one. Its probability is
  multiplied by the number of tests that were made (Bonferroni).
- A region: which few conditions are met by runs that fail and not by those that hold? A beam search over half of the
  sample proposes them, and the other half tests them (Fisher), so that the search cannot deceive itself.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from typing import Final

from elitescript.messages.signals import Value
from elitescript.records import NamedTuple, record, replace
from elitescript.sweep.results.sketches import mixed
from elitescript.sweep.results.statistics import at_least_so_many, groups_differ, rank_correlation, ranks
from elitescript.sweep.results.totals import SAMPLE, Kept, Totals

LEVEL: Final = 0.01
"""Probability, corrected for the number of tests, below which something is reported."""

LEAST: Final = 5
"""Failing runs below which nothing is said about what they have in common."""

KINDS: Final = 5
"""Most frequent kinds of failures for which a region is looked for."""

_GROUPS: Final = 8
_CUTS: Final = 24
"""Places between the values of a variation at which a region may end."""
_BEAM: Final = 12
_DEPTH: Final = 3
_WORTH: Final = 10.83
"""A further condition must raise the likelihood ratio by this: chi squared with one degree of freedom at 0.001."""


@record
class Effect:
    """How one variation or disturbance moves one outcome.

    Attributes:
        outcome: `failing`, `time_s`, or the name of a measure.
        of: name of the variation, or of the disturbance.
        is_disturbance: whether it is one.
        p: probability that chance alone does as much, corrected for the number of tests.
        share: of the variance of the ranks of the outcome that it explains, 0 to 1.
        correlation: of ranks, -1 to 1; None if the values have no order.
        low: mean of the outcome (share of failing runs) in the lowest values, or without the disturbance.
        high: the same for the highest values, or with it; for choices, of the value with the largest mean.
        lowest: text of the values of `low`.
        highest: text of the values of `high`.
    """

    outcome: str
    of: str
    is_disturbance: bool
    p: float
    share: float
    correlation: float | None
    low: float
    high: float
    lowest: str
    highest: str


@record
class Condition:
    """One condition of a region.

    Attributes:
        of: name of the variation or disturbance.
        relation: `<=`, `>`, `==`, `!=`; `with` or `without` a disturbance.
        value: that is compared with; None for disturbances.
    """

    of: str
    relation: str
    value: Value | str | None = None

    def __str__(self) -> str:
        if self.value is None:
            return self.of if self.relation == "with" else f"no {self.of}"
        value = f"{self.value:.6g}" if isinstance(self.value, float) else str(self.value)
        return f"{self.of} {self.relation} {value}"


@record
class Region:
    """Where in the box of variations and disturbances runs fail.

    Attributes:
        kind: place in `alike` of the kind of failure that it is about.
        conditions: which hold together.
        failing: runs of the sample inside that fail in this way.
        inside: runs of the sample inside.
        failing_in_all: runs of the sample that fail in this way.
        in_all: runs of the sample: those that hold, and those that fail in this way.
        p: probability that chance does as much, by the half of the sample in which it was not looked for.
    """

    kind: int
    conditions: tuple[Condition, ...]
    failing: int
    inside: int
    failing_in_all: int
    in_all: int
    p: float

    def __str__(self) -> str:
        return " and ".join(map(str, self.conditions))

    def words(self) -> str:
        """Return the region with its counts, for people."""
        beyond = self.in_all - self.inside
        return (
            f"with {self}: {self.failing:,} of {self.inside:,} runs fail so,"
            f" {self.failing_in_all - self.failing:,} of {beyond:,} elsewhere"
        )


class _Candidate(NamedTuple):
    condition: Condition
    rows: int
    """As bits: in which rows of the sample it holds."""


# ---------------------------------------------------------------- effects


def effects_of(totals: Totals) -> tuple[Effect, ...]:
    """Return the effects that are no chance, for each outcome the strongest first."""
    # A page keeps more rows than are needed here.
    holding, one_in_holding = totals.holding_sample.at_most(SAMPLE)
    failing, one_in_failing = totals.failing_sample.at_most(SAMPLE)
    found: list[Effect] = []
    tests = 0
    both = sorted([*holding, *failing], key=lambda kept: kept.run)
    if len(failing) >= LEAST and len(holding) >= LEAST:
        weights = [float(one_in_failing if kept.kind >= 0 else one_in_holding) for kept in both]
        tests += _effects(totals, "failing", both, [float(kept.kind >= 0) for kept in both], weights, found)
    one_in = max(one_in_holding, one_in_failing)
    even = [kept for kept in both if not mixed(kept.run) & (one_in - 1)]
    # The time of a run that was cut off says nothing of the cycle.
    timed = [(kept, kept.time_s) for kept in even if kept.state == "finished" and kept.time_s is not None]
    tests += _effects(totals, "time_s", [kept for kept, _ in timed], [time_s for _, time_s in timed], [], found)
    for index, name in enumerate(totals.measures):
        pairs = [(kept, number) for kept in even if (number := _number(kept.measures[index])) is not None]
        tests += _effects(totals, name, [kept for kept, _ in pairs], [number for _, number in pairs], [], found)
    order = {name: index for index, name in enumerate(("failing", "time_s", *totals.measures))}
    corrected = [replace(effect, p=min(1.0, effect.p * tests)) for effect in found]
    return tuple(
        sorted(
            (effect for effect in corrected if effect.p < LEVEL),
            key=lambda effect: (order[effect.outcome], -effect.share, effect.of),
        )
    )


def _effects(
    totals: Totals,
    outcome: str,
    rows: Sequence[Kept],
    values: Sequence[float],
    weights: Sequence[float],
    found: list[Effect],
) -> int:
    """Test every variation and disturbance against an outcome; return how many tests that were."""
    if len(rows) < 2 * LEAST or min(values) == max(values):
        return 0
    ranked = ranks(values)
    weights = weights or [1.0] * len(rows)
    # Each group needs some rows of the rarer outcome, or the approximation by chi squared is none.
    rarer = len(rows) if outcome != "failing" else min(sum(values), len(values) - sum(values))
    groups_max = max(2, min(_GROUPS, int(rarer // LEAST)))
    tests = 0
    for index, variation in enumerate(totals.variations):
        tests += 1
        effect = _effect_of_variation(
            outcome, variation.name, [row.values[index] for row in rows], values, ranked, weights, groups_max
        )
        if effect is not None:
            found.append(effect)
    for name in _disturbances(rows):
        tests += 1
        groups = [int(name in row.disturbances) for row in rows]
        p, share = groups_differ(groups, ranked)
        low, high = (_mean(values, weights, groups, group) for group in (0, 1))
        found.append(Effect(outcome, name, True, p, share, None, low, high, f"without {name}", f"with {name}"))
    return tests


def _effect_of_variation(
    outcome: str,
    name: str,
    drawn: Sequence[Value | str | None],
    values: Sequence[float],
    ranked: Sequence[float],
    weights: Sequence[float],
    groups_max: int,
) -> Effect | None:
    numbers = [_number(value) for value in drawn]
    if all(number is not None for number in numbers) and not any(isinstance(value, bool) for value in drawn):
        ordered = [number for number in numbers if number is not None]
        rank_of = ranks(ordered)
        n = len(ordered)
        groups = [min(groups_max - 1, int(groups_max * (rank - 0.5) / n)) for rank in rank_of]
        numbered = {group: index for index, group in enumerate(sorted(set(groups)))}
        groups = [numbered[group] for group in groups]
        last = len(numbered) - 1
        if last < 1:
            return None
        p, share = groups_differ(groups, ranked)
        ends = [[number for number, group in zip(ordered, groups, strict=True) if group == end] for end in (0, last)]
        low, high = (_mean(values, weights, groups, end) for end in (0, last))
        lowest = _range_text(name, "<=", max(ends[0]))
        highest = _range_text(name, ">=", min(ends[1]))
        return Effect(outcome, name, False, p, share, rank_correlation(rank_of, ranked), low, high, lowest, highest)
    words = [_word(value) for value in drawn]
    known = sorted(set(words))
    if len(known) < 2:
        return None
    groups = [known.index(word) for word in words]
    p, share = groups_differ(groups, ranked)
    means = [(_mean(values, weights, groups, group), word) for group, word in enumerate(known)]
    (low, lowest), (high, highest) = min(means), max(means)
    return Effect(outcome, name, False, p, share, None, low, high, f"{name} == {lowest}", f"{name} == {highest}")


def _mean(values: Sequence[float], weights: Sequence[float], groups: Sequence[int], wanted: int) -> float:
    chosen = [
        (value * weight, weight)
        for value, weight, group in zip(values, weights, groups, strict=True)
        if group == wanted
    ]
    whole = math.fsum(weight for _, weight in chosen)
    return math.fsum(value for value, _ in chosen) / whole if whole else math.nan


def _range_text(name: str, relation: str, value: float) -> str:
    return f"{name} {relation} {value:.4g}"


def _number(value: Value | str | None) -> float | None:
    return float(value) if isinstance(value, int | float) and math.isfinite(value) else None


def _word(value: Value | str | None) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def _disturbances(rows: Sequence[Kept]) -> list[str]:
    """Return the names of disturbances that some rows have and others do not."""
    names: dict[str, int] = {}
    for row in rows:
        for name in row.disturbances:
            names[name] = names.get(name, 0) + 1
    return sorted(name for name, count in names.items() if LEAST <= count <= len(rows) - LEAST)


# ---------------------------------------------------------------- regions


def regions_of(totals: Totals) -> tuple[Region, ...]:
    """Return where runs fail: for the most frequent kinds of failures, most frequent first."""
    holding, _ = totals.holding_sample.at_most(SAMPLE)
    failing, _ = totals.failing_sample.at_most(SAMPLE)
    numbers = [{group.number for group in groups} for groups in totals.alike()[:KINDS]]
    found = [_region(totals, place, kinds, holding, failing) for place, kinds in enumerate(numbers)]
    return tuple(region for region in found if region is not None)


def _region(
    totals: Totals, place: int, kinds: Collection[int], holding: Sequence[Kept], failing: Sequence[Kept]
) -> Region | None:
    failing = [kept for kept in failing if kept.kind in kinds]
    if len(failing) < LEAST or len(holding) < LEAST:
        return None
    rows = sorted([*holding, *failing], key=lambda kept: kept.run)
    everything = (1 << len(rows)) - 1
    bad = _bits([kept.kind >= 0 for kept in rows])
    # Another bit of the hash than those that thin the sample.
    training = _bits([bool(mixed(kept.run) >> 40 & 1) for kept in rows])
    if (bad & training).bit_count() < 2 or (bad & ~training & everything).bit_count() < 2:
        return None
    candidates = _candidates(totals, rows)
    rule = _searched(candidates, bad & training, training)
    if not rule:
        return None
    inside = everything
    for candidate in rule:
        inside &= candidate.rows
    tested = everything & ~training
    hits = (inside & bad & tested).bit_count()
    drawn = (inside & tested).bit_count()
    p = at_least_so_many(hits, drawn, (bad & tested).bit_count(), tested.bit_count())
    p = min(1.0, p * KINDS)
    if p >= LEVEL:
        return None
    conditions = tuple(candidate.condition for candidate in rule)
    return Region(place, conditions, (inside & bad).bit_count(), inside.bit_count(), bad.bit_count(), len(rows), p)


def _searched(candidates: Sequence[_Candidate], bad: int, all_rows: int) -> tuple[_Candidate, ...]:
    """Return the conditions with the best likelihood ratio, by a beam search; none if nothing is worth one."""
    beam: list[tuple[float, tuple[_Candidate, ...], int]] = [(0.0, (), all_rows)]
    best_score = 0.0
    best: tuple[_Candidate, ...] = ()
    for _depth in range(_DEPTH):
        grown: dict[int, tuple[float, tuple[_Candidate, ...], int]] = {}
        for _, rule, rows in beam:
            for candidate in candidates:
                inside = rows & candidate.rows
                if inside == rows or inside in grown:
                    continue
                found = _score(inside, bad, all_rows)
                if found > 0.0:
                    grown[inside] = (found, (*rule, candidate), inside)
        if not grown:
            break
        beam = sorted(grown.values(), key=lambda entry: -entry[0])[:_BEAM]
        if beam[0][0] < best_score + _WORTH:
            break
        best_score, best = beam[0][0], beam[0][1]
    return best


def _score(inside: int, bad: int, all_rows: int) -> float:
    """Return the likelihood ratio of failing inside against outside; below 0 if it fails less inside."""
    n, k = inside.bit_count(), (inside & bad).bit_count()
    everything, failing = all_rows.bit_count(), bad.bit_count()
    m, j = everything - n, failing - k
    if n == 0 or m == 0:
        return 0.0
    ratio = 2.0 * (_likelihood(k, n) + _likelihood(j, m) - _likelihood(failing, everything))
    return ratio if k * m > j * n else -ratio


def _likelihood(k: int, n: int) -> float:
    return (k * math.log(k / n) if k else 0.0) + ((n - k) * math.log((n - k) / n) if n > k else 0.0)


def _candidates(totals: Totals, rows: Sequence[Kept]) -> list[_Candidate]:
    found: list[_Candidate] = []
    for index, variation in enumerate(totals.variations):
        drawn = [row.values[index] for row in rows]
        numbers = [_number(value) for value in drawn]
        if any(number is None for number in numbers) or any(isinstance(value, bool) for value in drawn):
            for word in sorted({_word(value) for value in drawn}):
                bits = _bits([_word(value) == word for value in drawn])
                found.append(_Candidate(Condition(variation.name, "==", word), bits))
                found.append(_Candidate(Condition(variation.name, "!=", word), ~bits & ((1 << len(rows)) - 1)))
            continue
        ordered = [number for number in numbers if number is not None]
        bad = [number for number, row in zip(ordered, rows, strict=True) if row.kind >= 0]
        for cut in _cuts(sorted(set(ordered)), sorted(bad)):
            bits = _bits([number <= cut for number in ordered])
            found.append(_Candidate(Condition(variation.name, "<=", cut), bits))
            found.append(_Candidate(Condition(variation.name, ">", cut), ~bits & ((1 << len(rows)) - 1)))
    for name in _disturbances(rows):
        bits = _bits([name in row.disturbances for row in rows])
        found.append(_Candidate(Condition(name, "with"), bits))
        found.append(_Candidate(Condition(name, "without"), ~bits & ((1 << len(rows)) - 1)))
    return found


def _cuts(values: Sequence[float], bad: Sequence[float]) -> list[float]:
    """Return places between neighbouring values, in few digits: beside the ends of the failing ones, and evenly."""
    if len(values) < 2:
        return []
    position = {value: index for index, value in enumerate(values)}
    wanted = {round(step * (len(values) - 2) / _CUTS) for step in range(_CUTS + 1)}
    for step in range(_CUTS + 1):
        place = position[bad[round(step * (len(bad) - 1) / _CUTS)]]
        wanted |= {place - 1, place}
    return [_between(values[place], values[place + 1]) for place in sorted(wanted) if 0 <= place < len(values) - 1]


def _between(low: float, high: float) -> float:
    """Return the number with the fewest digits that is at least `low` and below `high`."""
    middle = low + (high - low) / 2.0
    for digits in range(1, 17):
        rounded = float(f"{middle:.{digits}g}")
        if low <= rounded < high:
            return rounded
    return low


def _bits(truths: Sequence[bool]) -> int:
    return int("".join("1" if truth else "0" for truth in reversed(truths)) or "0", 2)
