"""One run: its values reach the program, the signals and the world; everything else stays what it was."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from elitescript.errors import ProgramError, UsageError
from elitescript.records import replace
from elitescript.robot import VirtualRobot
from elitescript.sweep.making import make_plan
from elitescript.sweep.plans.plan import Choices, Plan, Row
from elitescript.sweep.plans.plan_json import choices_data, plan_data, row_of
from elitescript.sweep.plans.variations import parse_variation
from elitescript.sweep.single import Runner, job

PROGRAM = """\
def cell():
  global found
  pause_s = 0.5        # varied
  FEEDER = [0.1, d2r(90),
            0.3]
  found = [pause_s, FEEDER, get_standard_digital_in(3), offset]
  sleep(pause_s)
  textmsg("random ", random())
  if pause_s > 0.9:
    x = 1 / 0
  end
end
"""


def plan_with(*texts: str, **settings: Any) -> Plan:
    return Plan(
        settings.pop("program", PROGRAM),
        variations=tuple(map(parse_variation, texts)),
        settings=settings.pop("given", ("offset=2",)),
        **settings,
    )


def found_by(runner: Runner, run: int = 0) -> tuple[Row, Any]:
    row, record = runner.play(runner.choices_of(run))
    assert record is not None
    return row, record.globals.get("found")


def test_values_reach_constants_elements_presets_and_signals() -> None:
    plan = plan_with(
        "pause_s=grid(0.25,1,4)", "FEEDER[1]=choice(7)", "standard_digital_in[3]=choice(true)", "offset=choice(9)"
    )
    runner = Runner(plan)
    row, found = found_by(runner, 1)
    assert found == [0.5, [0.1, 7, 0.3], True, 9]
    assert (row.state, row.time_s, row.failure) == ("finished", 0.5, None)
    assert found_by(Runner(plan_with()))[1] == [0.5, [0.1, pytest.approx(1.5707963), 0.3], False, 2]
    failing = runner.run(runner.choices_of(3))
    assert failing.failure is not None
    assert (failing.failed, failing.failure.code, failing.failure.line) == ("no_alarm", "R100", 10)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("pase_s=uniform(0,1)", r"has no such name; did you mean 'pause_s'\?; it has pause_s, FEEDER"),
        ("found=uniform(0,1)", "line 6 computes the value of found"),
        ("FEEDER[3]=uniform(0,1)", "line 4 FEEDER has 3 elements"),
        ("pause_s[0]=uniform(0,1)", "gives pause_s no list"),
        ("x=uniform(0,1)", "line 10 assigns to x within a loop, a condition or a function"),
        ("offset[1]=uniform(0,1)", "no value of which an element"),
        ("standard_digital_in[99]=choice(true)", r"--vary standard_digital_in\[99\]: True is not possible"),
        ("standard_digital_in[3]=uniform(0,1)", "0 is not possible|takes True or False"),
        ("robot.sped=uniform(0,1)", "did you mean 'speed'"),
        ("robot.speed=uniform(0,2)", "2 is not possible: .*speed must be in"),
        ("rob.speed=uniform(0,1)", "'rob' is no section of a world file"),
        ("tcp.gripper.port=uniform(0,1)", r"the world file has no \[\[tcp\]\]"),
        ("robot=uniform(0,1)", "the program has no such name"),
    ],
)
def test_names_that_lead_nowhere_are_refused_before_the_first_run(text: str, words: str) -> None:
    with pytest.raises(UsageError, match=words) as caught:
        Runner(plan_with(text))
    assert "--vary" in str(caught.value) or "takes" in str(caught.value)


def test_a_program_that_does_not_compile() -> None:
    with pytest.raises(ProgramError, match=r"E001|E102|end"):
        Runner(plan_with(program="def p():\n  sleep(\nend\n"))


WORLD = """\
[robot]
speed = 0.5

[[box]]
name = "table"
size = [1, 1, 0.04]
pose = [0.2, 0.0, -0.6]

[[wire]]
name = "valve"
when = "standard_digital_out[0]"
then = "standard_digital_in[1]"
after_s = 0.1
"""
WAITS = """\
def p():
  set_standard_digital_out(0, True)
  while not get_standard_digital_in(1):
    sync()
  end
end
"""


def test_places_of_the_world_file() -> None:
    texts = (
        "wire.valve.after_s=grid(0.2,0.4,3)",
        "box.table.z=grid(-0.6,-0.6,1)",
        "box.0.size.x=choice(0.5)",
        "robot.speed=choice(1)",
    )
    runner = Runner(plan_with(*texts, program=WAITS, given=(), world=WORLD, world_name="cell.toml"))
    assert [runner.run(runner.choices_of(run)).time_s for run in range(3)] == [0.2, 0.3, 0.4]
    robot = runner.robot(runner.choices_of(0))
    assert robot.options.speed == 1
    assert robot.cell is not None
    for text, words in {
        "wire.valv.after_s=uniform(0,1)": "there is no 'valv'; there are valve",
        "wire.valve=uniform(0,1)": "it is a table; write which of name, when, then, after_s",
        "wire.valve.afters=uniform(0,1)": r"--vary wire.valve.afters: 0 is not possible: cell.toml:9: .* did you mean",
        "wire.valve.after_s=uniform(-1,1)": "-1 is not possible",
        "box.table.q=uniform(0,1)": "did you mean|is not known|q",
    }.items():
        with pytest.raises(UsageError, match=words):
            Runner(plan_with(text, program=WAITS, given=(), world=WORLD, world_name="cell.toml"))


def test_the_network_of_this_computer_is_refused() -> None:
    with pytest.raises(UsageError, match="is not allowed in a sweep"):
        Runner(plan_with(program=WAITS, given=(), world='[world]\nnetwork = "real"\n', world_name="cell.toml"))
    program = 'def p():\n  global found\n  found = socket_open("127.0.0.1", 9)\nend\n'
    assert found_by(Runner(plan_with(program=program, given=())))[1] is False


def test_a_value_that_makes_no_sense_in_one_run_is_a_row() -> None:
    plan = plan_with("wire.valve.after_s=normal(0.3,1)", program=WAITS, given=(), world=WORLD, world_name="cell.toml")
    rows = [Runner(plan).run(Choices(0, 0, {"wire.valve.after_s": value})) for value in (-1.0, 0.3)]
    assert [row.state for row in rows] == ["error", "finished"]
    assert rows[0].failed == "error"
    assert rows[0].failure is not None
    assert "after_s" in rows[0].failure.text


DEVICE = """\
import helper
from elitescript.testing.world import TcpServer

class Camera(TcpServer):
    count = 0

    def __init__(self, name):
        super().__init__(port=5000, name=name)

    def received(self, connection, data):
        Camera.count += 1
        connection.send(f"({Camera.count + helper.OFFSET},)\\n".encode())
"""
ASKS = """\
def p():
  global found
  socket_open("192.168.1.20", 5000)
  socket_send_line("shot")
  found = socket_read_ascii_float(1)
end
"""


def test_devices_of_python_files_are_new_in_each_run_and_find_what_is_beside_them(tmp_path: Path) -> None:
    (tmp_path / "cell.py").write_text(DEVICE)
    (tmp_path / "helper.py").write_text("OFFSET = 40\n")
    (tmp_path / "other.py").write_text("1 / 0\n")
    (tmp_path / "cell.toml").write_text('[[tcp]]\nclass = "cell.py:Camera"\nname = "camera"\n')
    (tmp_path / "p.script").write_text(ASKS)
    plan = make_plan(tmp_path / "p.script", world=tmp_path / "cell.toml")
    assert sorted(plan.python) == ["cell.py", "helper.py"]
    for path in tmp_path.iterdir():
        path.unlink()
    runner = Runner(plan)
    assert [found_by(runner, run)[1] for run in range(3)] == [[1, 41.0]] * 3


def test_the_task_folder_is_a_copy_for_each_run(tmp_path: Path) -> None:
    (tmp_path / "n.txt").write_text("4")
    (tmp_path / "out.csv.part").write_text("a journal")
    (tmp_path / "p.script").write_text(
        "def p():\n  global found\n  f = open('n.txt', 'r+')\n  found = f.read()\n  f.write('5')\n  f.close()\nend\n"
    )
    plan = make_plan(tmp_path / "p.script", without_files=[tmp_path / "out.csv.part"])
    assert sorted(plan.files) == ["n.txt", "p.script"]
    runner = Runner(plan)
    assert [found_by(runner, run)[1] for run in range(2)] == ["4", "4"]
    assert (tmp_path / "n.txt").read_text() == "4"
    (tmp_path / "large").write_bytes(b"\0" * 10_000_001)
    with pytest.raises(UsageError, match="more than 10 MB"):
        make_plan(tmp_path / "p.script")
    (tmp_path / "p.script").write_text("def p():\n  # open the file\n  textmsg('open the gripper')\nend\n")
    assert make_plan(tmp_path / "p.script").files == {}
    (tmp_path / "large").unlink()
    for text in ("from math import pi", "exec('f = op' + 'en(name)')", "x = read_file_of('n')"):
        (tmp_path / "p.script").write_text(f"def p():\n  {text}\nend\n")
        assert sorted(make_plan(tmp_path / "p.script", without_files=[tmp_path / "out.csv.part"]).files) != []


def test_a_row_is_that_of_the_same_run_alone() -> None:
    runner = Runner(plan_with("pause_s=uniform(0,0.8)"))
    choices = runner.choices_of(4)
    row, record = runner.play(choices)
    robot = VirtualRobot("CS66", seed=choices.seed)
    text = PROGRAM.replace("0.5  ", repr(choices.values["pause_s"]))
    alone = robot.run(text, presets={"offset": 2})
    assert record is not None
    assert (alone.log, alone.time_s) == (record.log, row.time_s)
    assert runner.run(choices) == row
    others = [runner.run(runner.choices_of(run)).digest for run in range(5)]
    assert len(set(others)) == 5


def test_the_job_of_a_child_takes_numbers_and_choices() -> None:
    plan = plan_with("pause_s=uniform(0,1)")
    runner, work = Runner(plan), job(plan_data(plan))
    row = runner.run(runner.choices_of(2))
    assert row_of(work(2)) == row
    assert row_of(work(choices_data(row.choices))) == row


def test_properties_measures_and_margins() -> None:
    plan = plan_with(
        "pause_s=grid(0.25,0.75,3)", ensure=("time_s < 0.5", "never_stuck"), measures={"twice": "2 * time_s"}
    )
    rows = [Runner(plan).run(Runner(plan).choices_of(run)) for run in range(3)]
    assert [row.failed for row in rows] == ["", "time_s < 0.5", "time_s < 0.5"]
    assert [row.margins[0] for row in rows] == [0.248, 0.0, -0.252]
    assert [row.measures["twice"] for row in rows] == [0.504, 1.0, 1.504]
    with pytest.raises(UsageError, match="tim_s"):
        Runner(replace(plan, ensure=("tim_s < 1",)))


def test_a_measure_that_no_table_takes_is_none() -> None:
    plan = Plan("def p():\n  global x\n  x = 10 ** 400\nend\n", measures={"m": 'globals["x"]', "i": "1e308 * 1e10"})
    runner = Runner(plan)
    assert runner.run(runner.choices_of(0)).measures == {"m": None, "i": None}
