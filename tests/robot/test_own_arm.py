"""An arm of one's own, from its file to the pose that programs and clients see."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from elitescript import VirtualRobot
from elitescript.cli.main import main
from elitescript.kernel import Kernel, RobotOptions

LONGER = 'base = "CS66"\nname = "CS66 long"\n[arm]\nd6 = 0.095\n'
WHERE = "global pose\npose = get_actual_tcp_pose()\n"


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "my_arm.toml"
    path.write_text(LONGER, encoding="utf-8")
    return path


def pose_of(robot: VirtualRobot) -> list[float]:
    return list(robot.run(WHERE).check().globals["pose"])


def test_programs_run_on_it(file: Path) -> None:
    """At home the tool points down: a flange that is 3 mm further out is 3 mm lower."""
    nominal, longer = pose_of(VirtualRobot("CS66")), pose_of(VirtualRobot(file))
    assert longer[2] == pytest.approx(nominal[2] - 0.003, abs=1e-9)
    assert longer[:2] == pytest.approx(nominal[:2], abs=1e-9)
    assert pose_of(VirtualRobot(str(file))) == longer


def test_its_joints_are_limited_as_it_says(file: Path) -> None:
    file.write_text('base = "CS66"\n[joints]\nq_max_deg = [90, 360, 360, 360, 360, 360]\n', encoding="utf-8")
    run = VirtualRobot(file).run("movej([1.6, -1.57, -1.57, -1.57, 1.57, 0])")
    assert [alarm.code for alarm in run.alarms] == ["R110"]


def test_its_plant_is_the_robots_unless_another_is_given(file: Path) -> None:
    file.write_text('base = "CS66"\n[plant]\nlag_s = 0.02\n', encoding="utf-8")
    assert not VirtualRobot(file).controller.is_plant_ideal
    world = file.with_name("cell.toml")
    world.write_text("[plant]\nlag_s = 0.0\n", encoding="utf-8")
    assert VirtualRobot(file, world=world).controller.is_plant_ideal


def test_run_takes_its_file(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program = file.with_name("cell.script")
    program.write_text(WHERE, encoding="utf-8")
    assert main(["run", str(program), "--robot", str(file), "--json"]) == 0
    end = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert end["tcp_pose"][2] == pytest.approx(pose_of(VirtualRobot(file))[2])


def test_a_mistake_in_it_is_told_with_file_and_key(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file.write_text('base = "CS66"\n[arm]\nd66 = 0.095\n', encoding="utf-8")
    program = file.with_name("cell.script")
    program.write_text(WHERE, encoding="utf-8")
    assert main(["run", str(program), "--robot", str(file)]) == 2
    assert "my_arm.toml: arm.d66: unknown key; did you mean 'arm.d6'?" in capsys.readouterr().err


def test_a_served_robot_gets_it_as_text() -> None:
    """The process of a served robot reads no files, and a journal is played again without them."""
    config = RobotOptions(model="my_arm.toml", model_text=LONGER)
    described = Kernel(config).description
    assert described.model == "CS66 long"
    assert described.dh_d[5] == 0.095
    assert Kernel(replace(config, model="CS66", model_text="")).description.dh_d[5] == 0.092
