"""Graphical programs that run: what the arm and the outputs do, and the nodes that findings and alarms name."""

from __future__ import annotations

from pathlib import Path

import pytest

from elitescript import VirtualRobot
from elitescript.cli.main import main
from elitescript.environment.program_file import source_of
from elitescript.errors import AlarmError, ProgramError
from elitescript.kinematics.pose import point_dist
from elitescript.program_tree import nodes, task_bytes
from elitescript.program_tree.cells import expression
from elitescript.program_tree.nodes import Node, Position
from elitescript.program_tree.task import Task

HOME = (0.0, -1.2, -1.5, -1.5, 1.57, 0.0)


def written(folder: Path, *children: Node, name: str = "cell", parts: tuple[Node, ...] = ()) -> Path:
    main_task = nodes.MainTask(type_name="Robot Main Task", loops=False, children=children)
    path = folder / f"{name}.task"
    path.write_bytes(task_bytes(Task(name, "inst", "CS66", parts=(nodes.InitVariables(), main_task, *parts))))
    return path


def to(joints: tuple[float, ...], name: str = "W1") -> Node:
    point = nodes.Waypoint(name=name, target=Position(joints))  # type: ignore[arg-type]
    return nodes.Move(type_name="MoveJ", has_joint_positions=True, children=(point,))


def along(axis: str, *untils: Node, acceleration: float = 0.8) -> Node:
    direction = nodes.Direction(axis=axis, children=untils)
    return nodes.Move(movement="linear", speed=0.05, acceleration=acceleration, children=(direction,))


class TestRuns:
    def test_moves_and_outputs(self, tmp_path: Path) -> None:
        path = written(
            tmp_path,
            to(HOME),
            nodes.Loop(kind="count", count=3, variable="Loop_1", children=(nodes.Wait(duration=0.5),)),
            nodes.Set(pin="digital_out[2]"),
            nodes.Assignment(variable="n", value=expression("Loop_1 + 1")),
        )
        robot = VirtualRobot(model="CS66")
        run = robot.run(path)
        assert run.state == "finished"
        assert run.joints == pytest.approx(HOME)
        assert run.signals["standard_digital_out[2]"] is True
        assert run.globals["n"] == 4
        assert [finding.code for finding in run.findings] == ["N225"]

    def test_a_direction_ends_at_its_until(self, tmp_path: Path) -> None:
        """It stops within the tick in which the input is seen, and the way of braking."""
        until = nodes.Until(kind="input", pin="digital_in[3]")
        path = written(tmp_path, to(HOME), along("ZNegative", until), nodes.Set(pin="digital_out[0]"))
        run = VirtualRobot(model="CS66").run(path, until_s=2.9)
        start = run.tcp_pose
        assert run.state == "time_limit"
        robot = VirtualRobot(model="CS66")
        robot.signals["standard_digital_in[3]"] = True
        run = robot.run(path)
        assert run.state == "finished"
        assert run.signals["standard_digital_out[0]"] is True
        first = VirtualRobot(model="CS66").run(written(tmp_path, to(HOME), name="home")).tcp_pose
        assert start[2] < first[2] - 0.01
        assert point_dist(run.tcp_pose, first) < 0.002

    @pytest.mark.parametrize(
        ("axis", "place", "sign"), [("XPositive", 0, 1), ("YNegative", 1, -1), ("ZPositive", 2, 1)]
    )
    def test_axes(self, axis: str, place: int, sign: int, tmp_path: Path) -> None:
        until = nodes.Until(kind="distance", distance=0.04)
        home = VirtualRobot(model="CS66").run(written(tmp_path, to(HOME), name="home")).tcp_pose
        run = VirtualRobot(model="CS66").run(written(tmp_path, to(HOME), along(axis, until)))
        moved = [now - before for now, before in zip(run.tcp_pose[:3], home[:3], strict=True)]
        assert run.state == "finished"
        assert moved.pop(place) * sign == pytest.approx(0.043, abs=0.003)
        assert moved == pytest.approx([0.0, 0.0], abs=1e-6)

    def test_a_direction_that_nothing_ends_is_an_alarm_where_the_arm_cannot_go_on(self, tmp_path: Path) -> None:
        path = written(tmp_path, to(HOME), along("ZPositive", nodes.Until(condition=expression("False"))))
        run = VirtualRobot(model="CS66").run(path)
        home = VirtualRobot(model="CS66").run(written(tmp_path, to(HOME), name="home")).tcp_pose
        assert run.alarms[-1].class_name == "ProtectiveStop"
        assert not [finding for finding in run.findings if finding.code == "W231"]
        assert "the line of movel cannot go on after 0.2280 m" in run.alarms[-1].text
        assert run.tcp_pose[2] - home[2] == pytest.approx(0.2280, abs=1e-3)

    def test_sub_tasks_set_variables_of_the_task(self, tmp_path: Path) -> None:
        grip = nodes.SubTask(name="grip", children=(nodes.Assignment(variable="n", value=expression("n + 1")),))
        call = nodes.CallSubTask(name="grip")
        path = written(tmp_path, nodes.Assignment(variable="n", value=expression("1")), call, call, parts=(grip,))
        assert VirtualRobot().run(path).globals["n"] == 3

    def test_timers_count_seconds(self, tmp_path: Path) -> None:
        path = written(
            tmp_path,
            nodes.Timer(action="reset", variable="t1"),
            nodes.Timer(action="start", variable="t1"),
            nodes.Wait(duration=0.4),
            nodes.Timer(action="stop", variable="t1"),
            nodes.Wait(duration=0.4),
        )
        assert VirtualRobot().run(path).globals["t1"] == pytest.approx(0.4, abs=0.011)


class TestNodesAreNamed:
    def test_alarm(self, tmp_path: Path) -> None:
        path = written(
            tmp_path, nodes.Folder(name="Pick", children=(nodes.ScriptLine(statement=expression("x = [1][3]")),))
        )
        run = VirtualRobot().run(path)
        with pytest.raises(AlarmError, match=r"cell\.task: 3 Pick > 4 Script \(script line 23\): IndexError"):
            run.check()

    def test_a_waypoint_that_was_never_taught_is_refused(
        self, tmp_path: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        path = written(tmp_path, nodes.Move(type_name="MoveJ", children=(nodes.Waypoint(name="Above"),)))
        with pytest.raises(ProgramError, match="the waypoint has never been taught"):
            source_of(path)
        for command in ("run", "check"):
            assert main([command, str(path)]) == 3
            said = capsys.readouterr()
            assert ": 3 MoveJ > 4 Above (script line 22): error E004: the waypoint" in said.out + said.err

    def test_check_names_the_node(self, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        path = written(
            tmp_path, nodes.ScriptLine(type_name="Script", statement=expression("set_standard_digital_out(99, True)"))
        )
        assert main(["check", str(path)]) == 3
        assert "cell.task: 2 Robot Main Task > 3 Script (script line 22): error E305" in capsys.readouterr().out
        assert main(["check", str(path), "--json"]) == 3
        assert '"node": "2 Robot Main Task > 3 Script"' in capsys.readouterr().out.replace('":"', '": "')

    def test_what_stands_beside_is_read(self, tmp_path: Path) -> None:
        point = nodes.Waypoint(position="variable", variable="home", is_global=True)
        path = written(tmp_path, nodes.Move(children=(point,)))
        (tmp_path / "inst.configuration.variables").write_text(
            f'<VariablesManager><Variable name="home" value="{list(HOME)}" remarks=""/></VariablesManager>'
        )
        run = VirtualRobot(model="CS66").run(path)
        assert run.joints == pytest.approx(HOME)
        (note,) = [finding for finding in run.findings if finding.code == "N225"]
        assert "inst.configuration is not beside the task" in note.text

    def test_a_broken_file_has_its_place(self, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        path = tmp_path / "cell.task"
        path.write_bytes(b"<EliTask>\n  <MainTask>\n</EliTask>")
        assert main(["check", str(path)]) == 3
        assert "cell.task:3:3: error E004: no XML: mismatched tag" in capsys.readouterr().out


def test_the_formatter_leaves_trees_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path, nodes.Halt())
    before = path.read_bytes()
    assert main(["fmt", str(path)]) == 0
    assert path.read_bytes() == before
    assert "1 file with a tree left: their scripts are generated" in capsys.readouterr().err


@pytest.mark.parametrize(
    "call", [("task", "cell.task", "-o"), ("run", "cell.task", "--trace"), ("plot", "cell.task", "-o")]
)
def test_no_output_takes_the_place_of_a_configuration(
    call: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    written(tmp_path, nodes.Halt())
    path = tmp_path / "inst.configuration.variables"
    path.write_text("<VariablesManager/>")
    assert main([*call, path.name]) == 2
    assert "a configuration beside the task" in capsys.readouterr().err
    assert path.read_text() == "<VariablesManager/>"
