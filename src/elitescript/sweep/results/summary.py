"""Says what a sweep has found: for people on one screen, and as JSON."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

from elitescript.records import record
from elitescript.sweep.plans.plan import Failure, Row
from elitescript.sweep.results.effects import Effect, Region, effects_of, regions_of
from elitescript.sweep.results.sketches import Distribution
from elitescript.sweep.results.statistics import share_interval
from elitescript.sweep.results.totals import ROWS_OF_KIND, SAMPLE, Group, Nearest, Totals

KINDS_SHOWN: Final = 5
RUNS_SHOWN: Final = 5
AFTER_SHOWN: Final = 4
"""Last disturbances of a kind."""
EFFECTS_SHOWN: Final = 3
"""Of each outcome."""

MEASURES_SHOWN: Final = 8


@record
class Kind:
    """Failures that are alike: the same property, alarm and line.

    Attributes:
        first: the first of them.
        count: how many there are.
        rows: the first ones, in the order of their runs.
        after: how many there are by their last disturbance; the text is empty for those without one.
        region: where they lie; None if nothing was found.
        where: the line of their alarm in words; empty if there is none.
    """

    first: Failure
    count: int
    rows: tuple[Row, ...]
    after: Mapping[str, int]
    region: Region | None
    where: str = ""

    def title(self) -> str:
        """Return the kind in a few words: property, alarm, line, last disturbances."""
        first = self.first
        title = first.expression
        if first.code:
            title += f": alarm {first.code}"
        elif first.state != "finished":
            title += f": {first.state}"
        if self.where:
            title += f" in {self.where}"
        after = [f"{name} {count:,}\N{MULTIPLICATION SIGN}" for name, count in _most(self.after, AFTER_SHOWN) if name]
        if len(after) == 1 and len(self.after) == 1:
            after = list(self.after)
        return (
            f"{title}, after {', '.join(after)}{', ...' if len(self.after) > AFTER_SHOWN else ''}" if after else title
        )


@record
class Summary:
    """What a sweep has found.

    Attributes:
        runs: number of rows.
        failed: how many failed.
        warned: how many have found warnings of their own, whether they hold or not.
        interval: 95 % interval of the probability to fail; None where nothing is drawn at random.
        states: number of runs by their state.
        times: virtual times by state, s.
        measures: distributions by name; None of a measure that gave no number.
        words: counts of the values of measures that are no numbers.
        properties: texts.
        failing: failures by property.
        nearest: by property, the smallest margin where it held.
        worst: by property, the smallest margin of all.
        kinds: of failures, the most frequent first.
        other_kinds: failures of kinds that were not told apart.
        effects: of variations and disturbances.
        sampled: rows from which effects and regions are known.
    """

    runs: int
    failed: int
    warned: int
    interval: tuple[float, float] | None
    states: Mapping[str, int]
    times: Mapping[str, Distribution | None]
    measures: Mapping[str, Distribution | None]
    words: Mapping[str, Mapping[str, int]]
    properties: tuple[str, ...]
    failing: Mapping[str, int]
    nearest: tuple[Nearest | None, ...]
    worst: tuple[Nearest | None, ...]
    kinds: tuple[Kind, ...]
    other_kinds: int
    effects: tuple[Effect, ...]
    sampled: int

    def lines(self) -> list[str]:
        """Return the words for people."""
        return [*self._head(), *self._failures(), *self._matters()]

    def as_json(self) -> dict[str, Any]:
        """Return the summary as JSON has it; SI units."""
        return {
            "runs": self.runs,
            "hold": self.runs - self.failed,
            "failed": self.failed,
            "warned": self.warned,
            "failing_interval": None if self.interval is None else list(self.interval),
            "states": dict(self.states),
            "time_s": {state: _json_of(found) for state, found in self.times.items()},
            "measures": {name: _json_of(found) for name, found in self.measures.items()},
            "values": {name: dict(counts) for name, counts in self.words.items() if counts},
            "properties": [
                {
                    "property": text,
                    "failed": self.failing.get(text, 0),
                    "nearest": None if nearest is None else nearest._asdict(),
                    "worst": None if worst is None else worst._asdict(),
                }
                for text, nearest, worst in zip(self.properties, self.nearest, self.worst, strict=True)
            ],
            "failures": [_json_of_kind(kind) for kind in self.kinds],
            "other_failures": self.other_kinds,
            "effects": [_json_of_effect(effect) for effect in self.effects],
            "sampled": self.sampled,
        }

    def _head(self) -> list[str]:
        holding = self.runs - self.failed
        if self.failed == 0:
            first = (
                f"all {_count(self.runs, 'run')} hold" if self.runs > 1 else "the run holds" if self.runs else "no run"
            )
        else:
            share = _percent(self.failed / self.runs)
            first = f"{holding:,} of {_count(self.runs, 'run')} hold, {self.failed:,} fail ({share})"
        if self.warned:
            first += f"; {_count(self.warned, 'run')} found warnings" if self.runs > 1 else ", but has warnings"
        if self.interval is not None and self.runs:
            low, high = self.interval
            bound = f"below {_percent(high)}" if self.failed == 0 else f"{_percent(low)} to {_percent(high)}"
            first += f"; the probability to fail is {bound} (95 %)"
        lines = [first]
        others = {state: count for state, count in self.states.items() if state != "finished"}
        if others:
            lines.append("ended: " + ", ".join(f"{count:,} {state}" for state, count in self.states.items()))
        finished = self.times.get("finished")
        if finished is not None:
            lines.append(f"cycle time: {_words_of(finished, ' s')}")
        for name, distribution in list(self.measures.items())[:MEASURES_SHOWN]:
            counts = self.words[name]
            values = ", ".join(f"{word} {count:,}\N{MULTIPLICATION SIGN}" for word, count in _most(counts, 4))
            parts = [*([_words_of(distribution)] if distribution is not None else []), *([values] if values else [])]
            lines.append(f"{name}: {'; '.join(parts) or 'no value'}")
        if len(self.measures) > MEASURES_SHOWN:
            lines.append(f"({len(self.measures) - MEASURES_SHOWN} more measures)")
        for text, nearest in zip(self.properties, self.nearest, strict=True):
            # An equality that holds has a margin of 0 in every run: that says nothing.
            if nearest is not None and nearest.margin > 0.0:
                lines.append(f"nearest to failing: run {nearest.run}, {_number(nearest.margin)} left of {text}")
        return lines

    def _failures(self) -> list[str]:
        if not self.kinds:
            return []
        lines = ["", f"{_count(self.failed, 'failure')} of {_count(len(self.kinds), 'kind')}:"]
        for kind in self.kinds[:KINDS_SHOWN]:
            shown = [str(row.choices.run) for row in kind.rows[:RUNS_SHOWN]]
            runs = ", ".join(shown) + (", ..." if kind.count > RUNS_SHOWN else "")
            of = f"run{'s' if kind.count > 1 else ''} {runs}"
            lines.append(f"  {kind.count:,}\N{MULTIPLICATION SIGN} {kind.title()} ({of})")
            if kind.first.text:
                lines.append(f"     {_one_line(kind.first.text)}")
            if kind.region is not None:
                lines.append(f"     {kind.region.words()}")
        rest = sum(kind.count for kind in self.kinds[KINDS_SHOWN:]) + self.other_kinds
        if rest:
            lines.append(f"  {rest:,}\N{MULTIPLICATION SIGN} of other kinds")
        return lines

    def _matters(self) -> list[str]:
        if not self.effects:
            return []
        outcomes: dict[str, list[Effect]] = {}
        for effect in self.effects:
            outcomes.setdefault(effect.outcome, []).append(effect)
        lines = ["", "what matters:"]
        for outcome, effects in outcomes.items():
            for effect in effects[:EFFECTS_SHOWN]:
                lines.append(f"  {_effect_words(effect)}")
            if len(effects) > EFFECTS_SHOWN:
                lines.append(f"  {_outcome_words(outcome)}: {len(effects) - EFFECTS_SHOWN} more")
        if self.sampled < self.runs:
            lines.append(f"  (effects and regions are from a sample of {self.sampled:,} runs)")
        return lines


def summary_of(totals: Totals, is_random: bool = True, line_words: Callable[[int], str] = "line {}".format) -> Summary:
    """Work out what a sweep has found.

    Args:
        totals: of its rows.
        is_random: whether anything is drawn: without, the share of failures is no estimate of a probability.
        line_words: returns a line of the program in words.
    """
    regions = {region.kind: region for region in regions_of(totals)}
    return Summary(
        runs=totals.runs,
        failed=totals.failed,
        warned=totals.warned,
        interval=share_interval(totals.failed, totals.runs) if is_random else None,
        states=dict(sorted(totals.states.items(), key=lambda item: (-item[1], item[0]))),
        times={state: sketch.distribution() for state, sketch in sorted(totals.times.items())},
        measures={name: sketch.distribution() for name, sketch in totals.measures.items()},
        words={name: dict(counts) for name, counts in totals.words.items()},
        properties=totals.properties,
        failing=dict(totals.failing),
        nearest=tuple(totals.nearest),
        worst=tuple(totals.worst),
        kinds=tuple(_kind_of(groups, regions.get(place), line_words) for place, groups in enumerate(totals.alike())),
        other_kinds=totals.other_kinds,
        effects=effects_of(totals),
        sampled=sum(len(kept.at_most(SAMPLE)[0]) for kept in (totals.holding_sample, totals.failing_sample)),
    )


def _kind_of(groups: Sequence[Group], region: Region | None, line_words: Callable[[int], str]) -> Kind:
    rows = sorted((row for group in groups for row in group.rows), key=lambda row: row.choices.run)[:ROWS_OF_KIND]
    first = rows[0].failure
    assert first is not None
    after = {group.kind[3]: group.count for group in groups}
    return Kind(first, sum(after.values()), tuple(rows), after, region, line_words(first.line) if first.line else "")


def _effect_words(effect: Effect) -> str:
    lowest, highest = (text if effect.is_disturbance else f"where {text}" for text in (effect.lowest, effect.highest))
    if effect.outcome == "failing":
        # The worse side first.
        sides = [(effect.high, highest), (effect.low, lowest)]
        (worse, where), (better, there) = sorted(sides, key=lambda side: -side[0])
        return f"failing: {_percent(worse)} of runs {where}, {_percent(better)} {there}"
    unit = " s" if effect.outcome == "time_s" else ""
    name = _outcome_words(effect.outcome)
    share = f"{_percent(effect.share)} of its spread"
    means = f"{_number(effect.low)}{unit} {lowest}, {_number(effect.high)}{unit} {highest}"
    return f"{name}: {share} by {effect.of}; mean {means}"


def _outcome_words(outcome: str) -> str:
    return "cycle time" if outcome == "time_s" else outcome


def _words_of(distribution: Distribution, unit: str = "") -> str:
    if distribution.least == distribution.most:
        return f"{_number(distribution.least)}{unit} in each run"
    text = (
        f"{_number(distribution.least)} to {_number(distribution.most)}{unit}, median {_number(distribution.median)},"
        f" 95 % at most {_number(distribution.p95)}"
    )
    return text if not distribution.others else f"{text}; {distribution.others:,} not finite"


def _json_of(distribution: Distribution | None) -> dict[str, Any] | None:
    if distribution is None:
        return None
    names = ("count", "least", "p05", "p25", "median", "p75", "p95", "most", "mean", "error", "others")
    return {name: getattr(distribution, name) for name in names}


def _json_of_kind(kind: Kind) -> dict[str, Any]:
    first = kind.first
    return {
        "property": first.expression,
        "state": first.state,
        "code": first.code,
        "line": first.line,
        "text": first.text,
        "count": kind.count,
        "after": dict(kind.after),
        "runs": [row.choices.run for row in kind.rows],
        "region": None if kind.region is None else _json_of_region(kind.region),
    }


def _json_of_region(region: Region) -> dict[str, Any]:
    return {
        "conditions": [
            {"of": condition.of, "relation": condition.relation, "value": condition.value}
            for condition in region.conditions
        ],
        "text": str(region),
        "failing": region.failing,
        "inside": region.inside,
        "failing_in_all": region.failing_in_all,
        "in_all": region.in_all,
        "p": region.p,
    }


def _json_of_effect(effect: Effect) -> dict[str, Any]:
    names = ("outcome", "of", "is_disturbance", "p", "share", "correlation", "low", "high", "lowest", "highest")
    return {name: getattr(effect, name) for name in names}


def _most(counts: Mapping[str, int], most: int) -> Sequence[tuple[str, int]]:
    return sorted(counts.items(), key=lambda item: (-item[1], item[0]))[:most]


def _count(count: int, of: str) -> str:
    return f"{count:,} {of}{'' if count == 1 else 's'}"


def _percent(share: float) -> str:
    """Return a share with two digits, and at least one decimal below 10 %."""
    percent = 100.0 * share
    return f"{percent:.0f} %" if percent >= 10.0 or percent == 0.0 else f"{percent:.2g} %"


def _number(value: float) -> str:
    return f"{value:.4g}" if abs(value) < 1e4 else f"{value:.6g}"


def _one_line(text: str, most: int = 200) -> str:
    line = " ".join("".join(letter if letter.isprintable() else " " for letter in text).split())
    return line if len(line) <= most else f"{line[: most - 3]}..."
