"""Expressions as properties and measures of runs: what watches one run, its verdict in words."""

from __future__ import annotations

from collections.abc import Collection
from math import isfinite
from typing import Final

from elitescript.messages.signals import Value
from elitescript.properties.grammar import Clause, Parsed, Record, parse
from elitescript.properties.over_time import FUNCTIONS_OVER_TIME, Watched
from elitescript.properties.pieces import ANY, LEVEL, NUMBER, TRUTH, MarginKey, number, shown, truth
from elitescript.properties.places import wrong_at
from elitescript.properties.units import unit_text
from elitescript.properties.verdicts import Moment, Needs, Undefined, Verdict, plain
from elitescript.run import Run

UNDEFINED: Final = (Undefined, ArithmeticError, ValueError, TypeError)


class _Expression:
    """Base of a property and of a measure."""

    __slots__ = ("_parsed",)

    def __init__(self, parsed: Parsed) -> None:
        self._parsed = parsed

    @property
    def text(self) -> str:
        """The expression as it was written."""
        return self._parsed.text

    @property
    def needs(self) -> Needs:
        """What its watches are shown."""
        return self._parsed.needs


class ExpressionProperty(_Expression):
    """An expression that is true or false. Implements `Property`.

    Args:
        text: as written.
        program_globals: names of the globals that the program has; any name is taken if None.

    Raises:
        UsageError: it is no expression, or is neither true nor false; with the place.
    """

    __slots__ = ()

    def __init__(self, text: str, program_globals: Collection[str] | None = None) -> None:
        parsed = parse(text, program_globals)
        if parsed.piece.kind not in (TRUTH, LEVEL, ANY):
            raise wrong_at(
                parsed.text, parsed.piece.node, f"this is {parsed.piece.kind}, not true or false: compare it"
            )
        super().__init__(parsed)

    def watch(self) -> PropertyWatch:
        """Return what watches one run."""
        return PropertyWatch(self._parsed)


class ExpressionMeasure(_Expression):
    """An expression that is a number. Implements `Measure`.

    Args:
        text: as written.
        program_globals: names of the globals that the program has; any name is taken if None.

    Raises:
        UsageError: it is no expression, or no number; with the place.
    """

    __slots__ = ()

    def __init__(self, text: str, program_globals: Collection[str] | None = None) -> None:
        parsed = parse(text, program_globals)
        if parsed.piece.kind not in (NUMBER, LEVEL, ANY):
            hint = (
                ": a property is given with --ensure; a number is 1 if ... else 0" if parsed.piece.kind == TRUTH else ""
            )
            raise wrong_at(
                parsed.text, parsed.piece.node, f"a measure is a number, and this is {parsed.piece.kind}{hint}"
            )
        super().__init__(parsed)

    def watch(self) -> ExpressionMeasureWatch:
        """Return what watches one run."""
        return ExpressionMeasureWatch(self._parsed)


class _ExpressionWatch:
    """Base of what watches one run for an expression."""

    __slots__ = ("_parsed", "_watched", "see")

    def __init__(self, parsed: Parsed) -> None:
        self._parsed = parsed
        self._watched: list[Watched] = [FUNCTIONS_OVER_TIME[call.name].make(*call.parts) for call in parsed.calls]
        self.see = self._watched[0].see if len(self._watched) == 1 else self._see_all
        """Takes in a moment."""

    def _see_all(self, moment: Moment) -> None:
        for watched in self._watched:
            watched.see(moment)

    def _finished(self, run: Run, end_tick: int) -> Record:
        for watched in self._watched:
            watched.finish(end_tick)
        return Record(run, self._watched)


class ExpressionMeasureWatch(_ExpressionWatch):
    """Watches one run for a measure. Implements `MeasureWatch`."""

    __slots__ = ("reason",)

    def __init__(self, parsed: Parsed) -> None:
        super().__init__(parsed)
        self.reason = ""

    def value(self, run: Run, end_tick: int) -> Value | None:
        """Return the number of that run; None if it has none."""
        try:
            return number(self._parsed.piece.value(self._finished(run, end_tick)), self._parsed.text)  # type: ignore[no-any-return]
        except UNDEFINED as error:
            self.reason = _reason(error, self._parsed.text)
            return None


class PropertyWatch(_ExpressionWatch):
    """Watches one run for a property. Implements `Watch`."""

    __slots__ = ()

    def verdict(self, run: Run, end_tick: int) -> Verdict:
        """Return what came of it."""
        record, text = self._finished(run, end_tick), self._parsed.text
        try:
            holds = truth(self._parsed.piece.value(record), text)
        except UNDEFINED as error:
            return Verdict(False, t=self._time(self._failed(record)), words=_reason(error, text))
        clause = Clause(self._parsed.piece, range(len(self._watched)), ()) if holds else self._failed(record)
        t, margins = self._time(clause), self._margins(record)
        words = "" if holds else self._words(clause, record)
        if len(margins) != 1:
            return Verdict(holds, None, "", t, words, {_key_text(key): margin for key, margin in margins.items()})
        ((key, margin),) = margins.items()
        its_unit = unit_text(key.unit)
        if not holds:
            words += f", missed by {abs(margin):.6g}{' ' if its_unit else ''}{its_unit}"
            if t is not None and any(self._parsed.calls[index].name in _WORST for index in clause.calls):
                words += f" at {t:.3f} s, the worst moment"
        return Verdict(holds, margin, its_unit, t, words)

    def _margins(self, record: Record) -> dict[MarginKey, float]:
        """Return the finite margins by their keys."""
        found: dict[MarginKey, float] = {}
        for key, margin in self._parsed.piece.margins.items():
            try:
                value = margin(record)
            except UNDEFINED:
                continue  # a part that `and` and `or` did not come to
            if isfinite(value):
                # No -0.0: at the edge there is one number.
                found[key] = value + 0.0
        return found

    def _failed(self, record: Record) -> Clause:
        """Return the first clause that does not hold or has no value."""
        for clause in self._parsed.clauses:
            try:
                if not clause.piece.value(record):
                    return clause
            except UNDEFINED:
                return clause
        return self._parsed.clauses[0]

    def _time(self, clause: Clause) -> float | None:
        """Return when a clause was decided, if one function over time did it, s."""
        return self._watched[clause.calls[0]].t if len(clause.calls) == 1 else None

    def _words(self, clause: Clause, record: Record) -> str:
        """Return why a clause does not hold."""
        found = [self._watched[index].words() for index in clause.calls]
        for side in dict.fromkeys(clause.sides):
            try:
                found.append(f"{side.text} is {shown(plain(side.value(record)))}")
            except UNDEFINED as error:
                found.append(_reason(error, side.text))
        return "; ".join(dict.fromkeys(found)) or f"{self._parsed.text} is false"


_WORST: Final = frozenset({"always", "eventually"})


def _key_text(key: MarginKey) -> str:
    """Return what a margin is measured in: its unit, or what is compared if that has none."""
    return unit_text(key.unit) or key.of


def _reason(error: Exception, text: str) -> str:
    """Return why an expression has no value."""
    return str(error) if isinstance(error, Undefined) else f"{text} has no value: {error}"
