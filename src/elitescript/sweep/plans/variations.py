"""`--vary NAME=KIND(...)`: how a value is written, and which one a run gets."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isfinite
from typing import Any, Final

from elitescript.environment.start_values import literal_of
from elitescript.errors import UsageError, did_you_mean
from elitescript.sweep.plans.plan import Variation
from elitescript.sweep.plans.seeds import fraction, normal_quantile

FORMS: Final = {
    "uniform": "uniform(a, b)",
    "normal": "normal(mean, deviation)",
    "choice": "choice(a, b, ...)",
    "grid": "grid(a, b, points)",
}
"""Kinds of variations, and how each is written."""

LARGEST: Final = 1e300
"""Size of a number: distances and spreads are finite too."""

GRID_MAX: Final = 10**12
"""Points of all grids together at most."""


def parse_variation(text: str, option: str = "--vary") -> Variation:
    """Return the variation of `NAME=KIND(...)`.

    Args:
        text: as it was written.
        option: before it, for messages.

    Raises:
        UsageError: not of this form; the text says where.
    """
    name, equals, rest = text.partition("=")
    name, rest = name.strip(), rest.strip()
    kind, bracket, inside = rest.partition("(")
    kind = kind.strip()
    forms = ", ".join(FORMS.values())
    if not equals or not name:
        raise UsageError(f"{option} {text}: write NAME=KIND(...), such as NAME=uniform(0, 1); kinds are {forms}")
    if kind not in FORMS:
        near = did_you_mean(kind, FORMS)
        raise UsageError(f"{option} {text}: {kind or rest!r} is no kind of variation{near}; there are {forms}")
    if not bracket or not inside.endswith(")"):
        raise UsageError(f"{option} {text}: write {FORMS[kind]}, with both brackets")
    arguments = [literal_of(part, f"{option} {text}", has_words=True) for part in _parts(inside[:-1])]
    return checked(Variation(name, kind, tuple(arguments)), f"{option} {text}")


def _parts(text: str) -> list[str]:
    """Return what commas outside of brackets and quotes separate."""
    parts, depth, quote = [""], 0, ""
    for letter in text:
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "'\"":
            quote = letter
        elif letter in "([{":
            depth += 1
        elif letter in ")]}":
            depth -= 1
        if letter == "," and not depth and not quote:
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts] if text.strip() else []


def checked(variation: Variation, called: str) -> Variation:
    """Return a variation whose arguments make sense.

    Args:
        variation: to be checked.
        called: what the user calls it, for messages.

    Raises:
        UsageError: they do not.
    """
    kind = variation.kind
    arguments: tuple[Any, ...] = variation.arguments
    if kind not in FORMS:
        raise UsageError(f"{called}: {kind!r} is no kind of variation{did_you_mean(kind, FORMS)}")
    if kind == "choice":
        if not arguments:
            raise UsageError(f"{called}: there is nothing to choose from: {FORMS[kind]}")
        for value in arguments:
            if not _is_value(value):
                raise UsageError(f"{called}: {value!r} is neither a number, a text, true or false, nor a list of them")
        return variation
    form = f"write {FORMS[kind]}"
    if len(arguments) != (3 if kind == "grid" else 2):
        raise UsageError(f"{called}: {len(arguments)} value{'' if len(arguments) == 1 else 's'} given; {form}")
    for value in arguments:
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        if is_number and LARGEST < abs(value) < inf:
            raise UsageError(f"{called}: a number is too large; at most {LARGEST:g} makes sense")
        if not is_number or not isfinite(value):
            raise UsageError(f"{called}: {value!r} is no number; {form}")
    a, b = arguments[:2]
    if kind == "uniform" and not a <= b:
        raise UsageError(f"{called}: {a!r} is above {b!r}; {form} with a <= b")
    if kind == "normal" and b < 0:
        raise UsageError(f"{called}: the deviation is {b!r}; it must be >= 0")
    if kind == "grid" and not (isinstance(arguments[2], int) and arguments[2] >= 1):
        raise UsageError(f"{called}: {arguments[2]!r} points; {form} with a whole number >= 1")
    return variation


def _is_value(value: Any) -> bool:
    if isinstance(value, list | tuple):
        return all(map(_is_value, value))
    return isinstance(value, bool | int | float | str)


def check_names(variations: Sequence[Variation]) -> None:
    """Refuse a name that is varied twice, and grids that never end.

    Raises:
        UsageError: there is one.
    """
    names = [row.name for row in variations]
    for name in names:
        if names.count(name) > 1:
            raise UsageError(f"--vary {name}: it is varied twice")
    if grid_size(variations) > GRID_MAX:
        raise UsageError(f"--vary: the grids have {grid_size(variations)} points; at most {GRID_MAX} make sense")


def grid_size(variations: Sequence[Variation]) -> int:
    """Return the number of points of all grids together; 1 without any."""
    size = 1
    for row in variations:
        if row.kind == "grid":
            size *= int(row.arguments[2])
    return size


class Draw:
    """Draws the values of the runs of one sweep.

    Args:
        variations: of the sweep.
        seed: of the sweep.
    """

    __slots__ = ("_grids", "_seed", "_variations")

    def __init__(self, variations: Sequence[Variation], seed: int) -> None:
        self._variations = variations
        self._seed = seed
        # The last grid goes on with every run, the first one after all others: as nested loops do.
        self._grids: dict[str, int] = {}
        step = 1
        for row in reversed(variations):
            if row.kind == "grid":
                self._grids[row.name] = step
                step *= int(row.arguments[2])

    def values(self, run: int) -> dict[str, Any]:
        """Return the value of each variation in a run, by name."""
        return {row.name: self._value(row, run) for row in self._variations}

    def _value(self, row: Variation, run: int) -> Any:
        arguments: Any = row.arguments
        if row.kind == "grid":
            a, b, points = arguments
            return _grid_point(a, b, points, run // self._grids[row.name] % points)
        drawn = fraction(self._seed, run, row.name)
        if row.kind == "choice":
            return arguments[int(drawn * len(arguments))]
        if row.kind == "uniform":
            a, b = arguments
            return min(a + (b - a) * drawn, float(b))
        mean, deviation = arguments
        return mean + deviation * normal_quantile(max(drawn, 2.0**-54))


def _grid_point(a: float, b: float, points: int, at: int) -> float:
    """Return a point of a grid, from 0: all are whole numbers if ends and distance are."""
    if points == 1:
        return a
    if isinstance(a, int) and isinstance(b, int) and (b - a) % (points - 1) == 0:
        return a + (b - a) // (points - 1) * at
    return float(b) if at == points - 1 else a + (b - a) * at / (points - 1)


def extremes(variation: Variation) -> tuple[Any, ...]:
    """Return values of a variation that are tried before the first run: its ends, or all of its choices."""
    if variation.kind == "normal":
        return (variation.arguments[0],)
    return variation.arguments[:2] if variation.kind in ("uniform", "grid") else variation.arguments


def plain_value(variation: Variation) -> Any:
    """Return the simplest value of a variation: the middle, the mean, the first choice or the first point."""
    arguments: Any = variation.arguments
    return (arguments[0] + arguments[1]) / 2 if variation.kind == "uniform" else arguments[0]


def variation_text(variation: Variation) -> str:
    """Return a variation as it is written behind `--vary`."""
    return f"{variation.name}={variation.kind}({', '.join(map(repr, variation.arguments))})"


def uniform(a: float, b: float) -> Variation:
    """Return a variation, without its name yet: evenly distributed from `a` to `b`."""
    return checked(Variation("", "uniform", (a, b)), "uniform")


def normal(mean: float, deviation: float) -> Variation:
    """Return a variation, without its name yet: normally distributed."""
    return checked(Variation("", "normal", (mean, deviation)), "normal")


def choice(*values: Any) -> Variation:
    """Return a variation, without its name yet: one of some values, each as likely."""
    return checked(Variation("", "choice", values), "choice")


def grid(a: float, b: float, points: int) -> Variation:
    """Return a variation, without its name yet: `points` values from `a` to `b`, one after the other."""
    return checked(Variation("", "grid", (a, b, points)), "grid")
