"""The figures of docs/explanation/motion.md on what lies between nominal and actual motion."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from elitescript import PlantConfig, VirtualRobot
from elitescript.controller.trace import TraceRow
from tools.motion_runs import HOME, MODEL, program, times_of, traced
from tools.svg_chart import Curve, Panel, drawing

PLANTS: Final = {
    "lag 20 ms": PlantConfig(lag_s=0.02),
    "lag 50 ms": PlantConfig(lag_s=0.05),
    "lag 50 ms, friction": PlantConfig(lag_s=0.05, coulomb_friction=0.1, viscous_friction=0.2),
}
"""Plants that figure and table show."""

TURN: Final = program("sleep(0.1)", f"movej({[1.2, *HOME[1:]]}, a=3, v=1)", "sleep(0.8)")


def plant_rows(plant: PlantConfig) -> list[TraceRow]:
    """A move of the base joint over 1.2 rad with a plant."""
    return traced(TURN, robot=VirtualRobot(MODEL, joints=HOME, plant=plant))


def tracking_errors(rows: list[TraceRow]) -> list[float]:
    """Target less actual of the base joint, rad."""
    return [row.q[0] - (row.q if row.q_actual is None else row.q_actual)[0] for row in rows]


def plant() -> str:
    """Target, actual and the difference for several plants."""
    positions, errors = [], []
    for colour, (name, config) in enumerate(PLANTS.items()):
        rows = plant_rows(config)
        times = times_of(rows)
        if not colour:
            positions.append(Curve("target", times, [row.q[0] for row in rows], 3, True))
        positions.append(Curve(name, times, [(row.q_actual or row.q)[0] for row in rows], colour))
        errors.append(Curve(name, times, [1e3 * error for error in tracking_errors(rows)], colour))
    return drawing(
        "movej over 1.2 rad with a = 3, v = 1, and three plants",
        (Panel("base, rad", tuple(positions)), Panel("behind, mrad", tuple(errors))),
    )


FIGURES: Final[dict[str, Callable[[], str]]] = {
    "plant.svg": plant,
}
"""File name and what draws it."""
