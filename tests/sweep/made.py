"""Rows of sweeps that nobody has run."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from typing import Any

from elitescript.sweep.plans.plan import Choices, Disturbance, Failure, Row, Variation
from elitescript.sweep.results.totals import Totals

BOX = (
    Variation("part_x", "uniform", (-1.0, 1.0)),
    Variation("part_y", "uniform", (-1.0, 1.0)),
    Variation("speed", "choice", ("slow", "fast")),
    Variation("idle", "uniform", (0.0, 1.0)),
)


def row(
    run: int,
    values: Mapping[str, Any],
    failed: str = "",
    time_s: float = 10.0,
    disturbances: tuple[Disturbance, ...] = (),
    margins: tuple[float | None, ...] = (),
    state: str = "finished",
    line: int = 0,
    text: str = "",
    measures: Mapping[str, Any] | None = None,
) -> Row:
    """Make a row."""
    last = disturbances[-1].kind if disturbances else ""
    failure = Failure(failed, state, line=line, disturbance=last, text=text) if failed else None
    return Row(Choices(run, run, values, disturbances), state, time_s, measures or {}, "", failure, margins)


def swept(count: int, of: Callable[[int, dict[str, Any], random.Random], Row], seed: int = 1, **options: Any) -> Totals:
    """Add up rows that a function makes of what was drawn from `BOX`."""
    chance = random.Random(seed)
    totals = Totals(BOX, ("always(ok)",), options.pop("measures", ()), **options)
    for run in range(count):
        values = {
            "part_x": chance.uniform(-1, 1),
            "part_y": chance.uniform(-1, 1),
            "speed": chance.choice(["slow", "fast"]),
            "idle": chance.random(),
        }
        totals.add(of(run, values, chance))
    return totals
