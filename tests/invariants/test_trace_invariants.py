"""Rows that are sampled together are those that are sampled one by one, to the last bit and sign."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import Any

import pytest

from elitescript import PlantConfig, VirtualRobot
from elitescript.controller.views.trace import Trace
from elitescript.controller.views.trace_signals import TraceSignals
from elitescript.messages.machine import PauseTask, ResumeTask, SetSpeedScale, StopTask
from elitescript.runtime.environment import EmptyEnvironment
from tests.findings import Finding
from tests.invariants.cases import CASES
from tests.invariants.random_programs import random_program
from tests.invariants.row_by_row import RowByRow

EXAMPLES = Path(__file__).parents[2] / "examples"

PLANTS = (None, None, None, PlantConfig(lag_s=0.02), PlantConfig(noise_rad=1e-5, seed=2))

TOOLS = ("", "", "set_tcp([0, 0, 0.145, 0, 0, 0])", "set_tcp([0.03, -0.1, 0.2, 0.4, -1.2, 2])")


def recorded(trace: Any, seed: int, step_s: float | None) -> tuple[list[str], str]:
    """The rows of a random program to which something happens from outside, as text with all digits and signs."""
    chance = Random(f"trace {seed}")
    program = random_program(chance).replace("count = 0", f"count = 0\n  {chance.choice(TOOLS)}", 1)
    robot = VirtualRobot("CS66", seed=seed, world=EmptyEnvironment(), plant=PLANTS[seed % len(PLANTS)])
    robot.set_speed(chance.choice((1.0, 1.0, 0.5, 0.13)))
    for _ in range(chance.randrange(0, 4)):
        robot.controller.put(chance.randrange(0, 800), SetSpeedScale(chance.choice((0.0, 0.3, 0.63, 1.0))))
    if chance.random() < 0.5:
        tick = chance.randrange(0, 500)
        robot.controller.put(tick, PauseTask())
        robot.controller.put(tick + chance.randrange(0, 200), ResumeTask())
    if chance.random() < 0.2:
        robot.controller.put(chance.randrange(0, 700), StopTask())
    if chance.random() < 0.1:
        robot.at(chance.uniform(0.0, 3.0), "standard_digital_in[0]", True)
    rows: list[Any] = []
    if trace is True:
        rows = robot.run(program, until_s=20.0, trace=True, trace_step_s=step_s).trace  # type: ignore[assignment]
    else:
        robot.run(program, until_s=20.0, trace=trace(rows.append, step_s, TraceSignals()))
    return [f"{tuple(row[:7])!r} {dict(row.signals)!r}" for row in rows], program


@pytest.mark.invariants
@pytest.mark.parametrize("seed", range(max(CASES, 10)))
def test_spans_of_rows_equal_rows_one_by_one(seed: int, finding: Finding) -> None:
    step_s = Random(f"step {seed}").choice((None, None, 0.012, 0.052))
    expected, program = recorded(RowByRow, seed, step_s)
    assert expected
    for trace in (Trace, True):
        found, _ = recorded(trace, seed, step_s)
        assert len(found) == len(expected), program
        for mine, theirs in zip(found, expected, strict=True):
            assert mine == theirs, program
    finding("rows in spans against rows one by one", f"{max(CASES, 10)} programs", "the same rows to the last bit")


@pytest.mark.parametrize(
    "name", ["pick_and_place", "glue_seam", "circles", "palletising", "belt_picking", "polishing", "seam_tracking"]
)
def test_examples_have_the_rows_that_they_have_one_by_one(name: str) -> None:
    found: list[Any] = []
    expected: list[Any] = []
    for trace, rows in ((Trace, found), (RowByRow, expected)):
        robot = VirtualRobot("CS66", task_dir=EXAMPLES)
        robot.signals["encoder_speed[0]"] = 2000.0
        robot.run(EXAMPLES / f"{name}.script", until_s=12.0, trace=trace(rows.append))
    assert len(found) > 500
    assert list(map(repr, found)) == list(map(repr, expected))
