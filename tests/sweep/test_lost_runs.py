"""Runs that do not come back: their rows have what was drawn for them, and their cases can be played."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from elitescript.sweep.engines.engine import row_of_result
from elitescript.sweep.engines.executor import Result
from elitescript.sweep.engines.here import HereEngine
from elitescript.sweep.failures.cases import read_case
from elitescript.sweep.failures.findings import Places, find, remembered
from elitescript.sweep.making import make_plan
from elitescript.sweep.plans.plan import CRASHED, HUNG, Choices, Disturbance, Failure, Plan, Row
from elitescript.sweep.plans.plan_json import choices_data, plan_data, row_of
from elitescript.sweep.plans.variations import Draw, parse_variation
from elitescript.sweep.replay import Replay
from elitescript.sweep.single import Runner, job

PROGRAM = "def p():\n  n = 1\n  sleep(0.1)\nend\n"
VARIED = (parse_variation("n=grid(0, 2, 3)"),)


def test_a_row_has_the_values_and_the_disturbances_of_its_run() -> None:
    plan = Plan(PROGRAM, variations=VARIED)
    draw = Draw(plan.variations, plan.seed)
    choices = Choices(1, 5953918811640664, {"n": 1}, (Disturbance("push", "", 0.5),))
    row = row_of_result(plan, draw, Result(1, choices_data(choices), HUNG))
    assert (row.choices, row.state, row.time_s, row.failed) == (choices, "hung", None, "hung")
    # What ended every process before it could say anything: at least what its number says.
    assert row_of_result(plan, draw, Result(1, None, CRASHED)).choices == Choices(1, 5953918811640664, {"n": 1})


def test_a_child_says_what_is_drawn_for_a_run_before_it() -> None:
    plan = Plan(PROGRAM, variations=VARIED)
    assert job(plan_data(plan)).about(2) == choices_data(Runner(plan).choices_of(2))


def test_a_mistake_of_the_product_costs_one_run(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    work = job(plan_data(Plan(PROGRAM, variations=VARIED)))
    run = Runner.run

    def fails(runner: Runner, choices: Choices) -> Row:
        return run(runner, choices) if choices.run else [][choices.run]

    monkeypatch.setattr(Runner, "run", fails)
    first, second = row_of(work(0)), row_of(work(1))
    assert first.failure == Failure(
        "crashed", "crashed", text="elitescript has failed: IndexError: list index out of range"
    )
    assert (first.choices.values, second.state) == ({"n": 0}, "finished")
    assert "Traceback" in capsys.readouterr().err


@pytest.mark.parametrize("state", ["hung", "crashed", "error"])
def test_the_case_of_a_lost_run_can_be_played(state: str, tmp_path: Path) -> None:
    program = tmp_path / "p.script"
    program.write_text(PROGRAM)
    plan = make_plan(program, variations=VARIED)
    runner = Runner(plan)
    choices = runner.choices_of(2)
    row = Row(choices, state, None, failure=Failure(state, state, text="it is lost"))
    engine: Any = HereEngine(runner)
    (found,) = find([row], runner, engine, Places(tmp_path, str(program)))
    assert read_case(found.case).failure.state == state
    assert Replay(found.case).play().words == "the failure did not come again: the run comes to its end now"


def test_a_case_that_cannot_be_read_is_said_and_left_out(tmp_path: Path) -> None:
    program = tmp_path / "p.script"
    program.write_text(PROGRAM)
    places = Places(tmp_path, str(program))
    runner = Runner(make_plan(program, variations=VARIED))
    engine: Any = HereEngine(runner)
    row = Row(runner.choices_of(2), "crashed", None, failure=Failure("crashed", "crashed", text="it is lost"))
    first, second = (find([row], runner, engine, places)[0].case for _ in range(2))
    first.write_text("program = 3\n")
    notes: list[str] = []
    assert [case.path for case in remembered(runner, engine, places, notes.append)] == [second]
    assert len(notes) == 1
    assert notes[0].startswith(f"{first}:1: expect: is missing")
    assert notes[0].endswith("; this case is not played")
