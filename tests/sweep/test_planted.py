"""Planted mistakes are found within few runs, shrunk to what was planted, told, and played again from their cases."""

from __future__ import annotations

from pathlib import Path

import pytest

from elitescript.errors import UsageError
from elitescript.records import replace
from elitescript.sweep.chaos.ground import Ears
from elitescript.sweep.failures.cases import write_case
from elitescript.sweep.failures.findings import Places, case_of_run, plain_values
from elitescript.sweep.failures.shrinking import Shrunk, is_same, shrink
from elitescript.sweep.failures.story import tell
from elitescript.sweep.plans.plan import Choices, Disturbance, Failure, Plan
from elitescript.sweep.replay import Replay, robot_for_case
from elitescript.sweep.single import Runner
from tests.sweep.planted import PLANTED, Planted

RUNS = 60
"""Runs in which each is found with the seed of its plan."""
LONG_RUNS = 1000


def first_failure(runner: Runner, planted: Planted, runs: int) -> tuple[Choices, Failure]:
    for run in range(runs):
        choices = runner.choices_of(run)
        failure = runner.run(choices).failure
        if failure is not None and failure.expression == planted.property:
            return choices, failure
    pytest.fail(f"not found in {runs} runs")


def smallest(runner: Runner, choices: Choices, failure: Failure) -> Shrunk:
    return shrink(choices, lambda one: is_same(runner.run(one).failure, failure), plain=plain_values(runner.plan))


@pytest.mark.parametrize("name", PLANTED)
def test_a_planted_mistake_is_found_shrunk_told_and_played_again(name: str, tmp_path: Path) -> None:
    planted = PLANTED[name]
    runner = Runner(planted.plan)
    choices, failure = first_failure(runner, planted, RUNS)
    found = smallest(runner, choices, failure)
    assert found.is_complete
    assert found.runs <= 100
    assert tuple(item.kind for item in found.choices.disturbances) in planted.kinds

    ears: list[Ears] = []
    row, run = runner.play(found.choices, before=lambda robot: ears.append(Ears(robot)))
    assert run is not None
    assert row.failure is not None
    assert run.unit.source.line(row.failure.line).strip() == planted.line
    story = tell(found.choices, row.failure, run, ears[0].heard, runner.chaos.ground)
    assert any(planted.line in line for line in story.lines)

    (tmp_path / "cell.script").write_text(planted.plan.program, encoding="utf-8")
    world = tmp_path / "cell.toml"
    world.write_text(planted.plan.world, encoding="utf-8")
    places = Places(tmp_path, str(tmp_path / "cell.script"), str(world) if planted.plan.world else "")
    write_case(tmp_path / "CASE.toml", case_of_run(runner, found.choices, row.failure, places), story.lines)
    replay = Replay(tmp_path / "CASE.toml")
    played = replay.play()
    assert played.words == f"the failure came again: {planted.property} does not hold"
    assert played.row.digest == row.digest
    assert not replay.note
    robot, arguments = robot_for_case(tmp_path / "CASE.toml")
    again = robot.run(**arguments)
    assert (again.state, again.time_s) == (run.state, run.time_s)


def test_the_lost_acknowledgement_is_told_with_time_device_message_and_line() -> None:
    planted = PLANTED["a lost acknowledgement"]
    runner = Runner(planted.plan)
    choices, failure = first_failure(runner, planted, RUNS)
    found = smallest(runner, choices, failure).choices
    ears: list[Ears] = []
    row, run = runner.play(found, before=lambda robot: ears.append(Ears(robot)))
    assert run is not None
    assert row.failure is not None
    text = tell(found, row.failure, run, ears[0].heard, runner.chaos.ground).text
    assert text == (
        "at 0.108 s what gripper (port 5000) sent ('ok\\n') was lost; the program waited in line 8 for data on socket "
        "'gripper' for ever"
    )


@pytest.mark.parametrize(
    ("passes", "end"), [(60, "when the run was cut off; with more time it ends at 90.100 s"), (1000, "for ever")]
)
def test_what_would_end_with_more_time_is_not_said_to_last_for_ever(passes: int, end: str) -> None:
    program = f"""
def slow():
  sleep(0.1)
  if get_standard_digital_in(1):
    for n in range({passes}):
      sleep(1.5)
    end
  end
end
"""
    runner = Runner(Plan(program, chaos="inputs"))
    choices = Choices(0, 0, {}, (Disturbance("stuck", "standard_digital_in[1]", 0.0, 1.0, {"value": True}),))
    ears: list[Ears] = []
    row, run = runner.play(choices, before=lambda robot: ears.append(Ears(robot)))
    assert run is not None
    assert row.failure is not None
    story = tell(choices, row.failure, run, ears[0].heard, runner.chaos.ground, runner.ends_s(row))
    assert story.text == (
        "at 0.000 s standard_digital_in[1] was stuck at high for 1 s; the program waited in line 6 " + end
    )


def test_the_corner_keeps_the_values_that_it_needs() -> None:
    planted = PLANTED["a corner of the box"]
    runner = Runner(planted.plan)
    values = smallest(runner, *first_failure(runner, planted, RUNS)).choices.values
    x, y = float(values["x"]), float(values["y"])
    assert x > 0.41
    assert y > 0.31
    assert not runner.run(Choices(0, 0, {"x": x, "y": 0.31})).failed
    assert not runner.run(Choices(0, 0, {"x": 0.41, "y": y})).failed


def test_a_mended_program_holds_in_its_case(tmp_path: Path) -> None:
    planted = PLANTED["a race of two threads"]
    runner = Runner(planted.plan)
    choices, failure = first_failure(runner, planted, RUNS)
    program = tmp_path / "cell.script"
    program.write_text(planted.plan.program.replace("sleep(0.6)", "join_thread(worker)"), encoding="utf-8")
    (tmp_path / "cell.toml").write_text(planted.plan.world, encoding="utf-8")
    case = case_of_run(runner, choices, failure, Places(tmp_path, str(program), str(tmp_path / "cell.toml")))
    write_case(tmp_path / "CASE.toml", replace(case, digest="0" * 16))
    replay = Replay(tmp_path / "CASE.toml")
    assert replay.note == f"{program} has changed since the case was written"
    played = replay.play()
    if played.row.failure is not None:
        assert played.row.failure.expression != "no_alarm"


@pytest.mark.slow
@pytest.mark.parametrize("name", PLANTED)
@pytest.mark.parametrize("seed", range(10))
def test_a_planted_mistake_is_found_within_a_thousand_runs_of_any_seed(name: str, seed: int) -> None:
    planted = PLANTED[name]
    runner = Runner(replace(planted.plan, seed=seed))
    choices, failure = first_failure(runner, planted, LONG_RUNS)
    found = smallest(runner, choices, failure)
    assert tuple(item.kind for item in found.choices.disturbances) in planted.kinds


BROKEN = """
from elitescript.testing.world import TcpServer


class Bad(TcpServer):
    port = 5000

    def line_received(self, connection, line):
        raise RuntimeError("broken")
"""


def test_a_case_of_a_run_whose_device_failed_can_be_played(tmp_path: Path) -> None:
    (tmp_path / "bad.py").write_text(BROKEN, encoding="utf-8")
    (tmp_path / "cell.toml").write_text('[[tcp]]\nclass = "bad.py:Bad"\n', encoding="utf-8")
    program = tmp_path / "cell.script"
    program.write_text(_ASKS, encoding="utf-8")
    file = tmp_path / "CASE.toml"
    file.write_text('program = "cell.script"\nworld = "cell.toml"\n[expect]\nproperty = "error"\nstate = "error"\n')
    played = Replay(file).play()
    assert played.words.startswith("the failure came again: bad.py:9: device Bad: RuntimeError: broken")
    program.write_text("def p():\n  sleep(0.1)\nend\n", encoding="utf-8")
    assert Replay(file).play().words == "the failure did not come again: the run comes to its end now"
    file.write_text(file.read_text().replace('"error"', '"no_alarm"', 1))
    program.write_text(_ASKS, encoding="utf-8")
    assert Replay(file).play().words.startswith("it failed in another way: bad.py:9")


_ASKS = 'def p():\n  socket_open("10.0.0.1", 5000)\n  socket_send_line("go")\n  sleep(1)\nend\n'


@pytest.mark.parametrize(
    ("rows", "refused"),
    [
        ('[[fault]]\nkind = "drop"\non = 6001\n', "disturbance 1: on: no device of this world is at 6001"),
        ('[options]\nmodel = "CS67"\n', "there is no robot model 'CS67'"),
        ("[set]\nwidth = 3\n", "--vary width: the program has no such name"),
    ],
)
def test_what_makes_no_sense_in_a_case_is_refused_with_the_name_of_the_case(
    tmp_path: Path, rows: str, refused: str
) -> None:
    (tmp_path / "cell.script").write_text(_ASKS, encoding="utf-8")
    (tmp_path / "cell.toml").write_text("[[tcp]]\nport = 5000\n", encoding="utf-8")
    file = tmp_path / "CASE.toml"
    file.write_text(f'program = "cell.script"\nworld = "cell.toml"\n{rows}[expect]\nproperty = "no_alarm"\n')
    with pytest.raises(UsageError) as caught:
        Replay(file)
    assert str(caught.value).startswith(f"{file}: {refused}")
