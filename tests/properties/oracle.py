"""Random expressions over time, each with what it comes to over the rows of every tick, computed the slow way."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import inf, isfinite

from elitescript.kinematics.jacobian import jacobian

UNITS = {"t": "s", "q": "rad", "qd": "rad/s", "tcp_speed": "m/s"}


@dataclass
class Formula:
    """True or false at a row.

    Attributes:
        text: as written.
        holds: its answer for a row.
        margins: by unit, for a row; infinite where a part without numbers of that unit decides.
        units: in it.
    """

    text: str
    holds: object
    margins: object
    units: frozenset


def comparison(text, sign, edge, value, unit):
    """Return a comparison of a number with a literal."""
    signs = {">": lambda a: a > edge, ">=": lambda a: a >= edge, "<": lambda a: a < edge, "<=": lambda a: a <= edge}

    def margin(row):
        distance = value(row) - edge if ">" in sign else edge - value(row)
        return {unit: distance}

    return Formula(f"{text} {sign} {edge}", lambda row: signs[sign](value(row)), margin, frozenset({unit}))


def level(index):
    """Return whether an output is on."""
    name = f"standard_digital_out[{index}]"
    return Formula(f'signal("{name}")', lambda row: bool(row.signals[name]), lambda row: {}, frozenset())


def of_unit(formula, row, unit):
    """Return the margin of a part for a unit; infinite by its answer if it has no number of that unit."""
    if unit in formula.units:
        return formula.margins(row)[unit]
    return inf if formula.holds(row) else -inf


def joined(word, parts):
    """Return `a and b`, `a or b`."""
    units = frozenset().union(*(part.units for part in parts))
    one = all if word == "and" else any
    extreme = min if word == "and" else max
    return Formula(
        "(" + f" {word} ".join(part.text for part in parts) + ")",
        lambda row: one(part.holds(row) for part in parts),
        lambda row: {unit: extreme(of_unit(part, row, unit) for part in parts) for unit in units},
        units,
    )


def negated(part):
    """Return `not a`."""
    return Formula(
        f"not {part.text}" if part.text.startswith(("(", "signal")) else f"not ({part.text})",
        lambda row: not part.holds(row),
        lambda row: {unit: -margin for unit, margin in part.margins(row).items()},
        part.units,
    )


def random_number(rng, arm, end_s):
    """Return text, value of a row, unit, and a range of edges that it may cross."""
    kind = rng.choice(("t", "q", "qd", "tcp", "tcp_speed", "line"))
    index = rng.randrange(6)
    if kind == "t":
        return "t", lambda row: row.t, "s", (0.0, end_s * 1.2)
    if kind == "q":
        return f"q[{index}]", lambda row: row.q[index], "rad", (-2.0, 2.0)
    if kind == "qd":
        return f"abs(qd[{index}])", lambda row: abs(row.qd[index]), "rad/s", (0.0, 1.0)
    if kind == "tcp":
        return f"tcp[{index}]", lambda row: row.tcp_pose[index], "m" if index < 3 else "rad", (-0.8, 0.8)
    if kind == "line":
        return "line", lambda row: row.line, "line", (0, 40)
    return "tcp_speed", lambda row: tcp_speed(arm, row), "m/s", (0.0, 0.8)


def tcp_speed(arm, row):
    """Return the speed of the TCP of a row, by its Jacobian, m/s."""
    lengths = [sum(entry * speed for entry, speed in zip(line, row.qd, strict=True)) for line in jacobian(arm, row.q)]
    return sum(part * part for part in lengths[:3]) ** 0.5


def random_formula(rng, arm, end_s, depth=0):
    """Return something that is true or false at a row."""
    kind = rng.random()
    if depth < 2 and kind < 0.35:
        parts = [random_formula(rng, arm, end_s, depth + 1) for _ in range(rng.randrange(2, 4))]
        return joined(rng.choice(("and", "or")), parts)
    if depth < 2 and kind < 0.45:
        return negated(random_formula(rng, arm, end_s, depth + 1))
    if kind < 0.6:
        return level(rng.randrange(3))
    text, value, unit, (low, high) = random_number(rng, arm, end_s)
    edge = rng.randrange(low, high) if unit == "line" else round(rng.uniform(low, high), 2)
    return comparison(text, rng.choice((">", ">=", "<", "<=")), edge, value, unit)


def first_time(formula, rows):
    """Return the time of the first row at which something holds, or None."""
    return next((row.t for row in rows if formula.holds(row)), None)


def expected_margins(name, formula, rows):
    """Return the finite margins of `always` and `eventually` by unit."""
    extreme = min if name == "always" else max
    found = {unit: extreme(of_unit(formula, row, unit) for row in rows) for unit in formula.units}
    return {unit: margin for unit, margin in found.items() if isfinite(margin)}


def expected_number(name, formula, rows):
    """Return what `first`, `duration` and `count` come to."""
    answers = [formula.holds(row) for row in rows]
    if name == "first":
        return first_time(formula, rows)
    if name == "duration":
        return sum(later.t - row.t for (row, later), holds in zip(pairwise(rows), answers, strict=False) if holds)
    return sum(now and not before for before, now in pairwise([False, *answers]))
