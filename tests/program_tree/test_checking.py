"""What `check` finds in trees: each rule on the node it is about, once."""

from __future__ import annotations

from pathlib import Path

import pytest

from elitescript import VirtualRobot
from elitescript.cli.main import main
from elitescript.environment.program_file import source_of
from elitescript.errors import UsageError
from elitescript.language.diagnostics import Diagnostic
from elitescript.lint.engine import check_source
from elitescript.messages.profile import DEFAULT_FIRMWARE, profile
from elitescript.models.model import load_model
from elitescript.program_tree import nodes, task_bytes
from elitescript.program_tree.cells import Expression, VariableCell, expression
from elitescript.program_tree.nodes import Node, Position
from elitescript.program_tree.task import Task

HOME = (0.0, -1.2, -1.5, -1.5, 1.57, 0.0)
AT_HOME = tuple(load_model("CS66").arm.forward(HOME)[9:])
TOOL = (
    '<ToolsManager Active="u"><TcpTool name="gripper" uuid="u"><ToolShape value="0.0, 0.0, 0.2, 0.0, 0.0, 0.0"/>'
    '</TcpTool><TcpTool name="flange" uuid="f"><ToolShape value="0.0, 0.0, 0.0, 0.0, 0.0, 0.0"/></TcpTool>'
    "</ToolsManager>"
)


def home_pose(tool_m: float = 0.0, *, x: float = 0.0, turned: float = 0.0) -> tuple[float, ...]:
    """Return where HOME is, by an own chain of transforms, moved along x of the base and turned about its z."""
    from elitescript.kinematics.transforms import compose, pose_from_transform, transform_from_pose

    reached = compose(load_model("CS66").arm.forward(HOME), transform_from_pose((0, 0, tool_m, 0, 0, 0)))
    pose = pose_from_transform(reached)
    turn = transform_from_pose((0, 0, 0, 0, 0, turned))
    new = pose_from_transform(compose(turn, transform_from_pose((0, 0, 0, *pose[3:]))))
    return pose[0] + x, pose[1], pose[2], *new[3:]


def found(
    folder: Path,
    *children: Node,
    robot: str = "CS66",
    configuration: str = "",
    variables: str = "",
    parts: tuple[Node, ...] = (),
) -> list[tuple[str, str]]:
    """Return code and node of what is found in a task."""
    return [
        (row.code, place)
        for row, place in findings(
            folder, *children, robot=robot, configuration=configuration, variables=variables, parts=parts
        )
    ]


def findings(
    folder: Path,
    *children: Node,
    robot: str = "CS66",
    configuration: str = "",
    variables: str = "",
    parts: tuple[Node, ...] = (),
) -> list[tuple[Diagnostic, str]]:
    main_task = nodes.MainTask(type_name="Robot Main Task", loops=False, children=children)
    path = folder / "cell.task"
    path.write_bytes(task_bytes(Task("cell", "inst", robot, parts=(nodes.InitVariables(), main_task, *parts))))
    (folder / "inst.configuration").write_text(f"<ConfigurationSettings>{configuration}</ConfigurationSettings>")
    (folder / "inst.configuration.variables").write_text(f"<VariablesManager>{variables}</VariablesManager>")
    source = source_of(path)
    problems = check_source(source, profile(DEFAULT_FIRMWARE), arm=load_model("CS66"))
    return [(row, source.place(row.line)) for row in problems]


def move(*points: Node, kind: str = "linear", **given: object) -> Node:
    return nodes.Move(movement=kind, children=points, **given)  # type: ignore[arg-type]


def at(pose: tuple[float, ...] | None, joints: tuple[float, ...] = HOME) -> Node:
    return nodes.Waypoint(name="W1", target=Position(joints, pose))  # type: ignore[arg-type]


def of(name: str, *, is_global: bool) -> Expression:
    return Expression((VariableCell(name, is_global),))


class TestPoseAndJoints:
    HERE = ("W226", "3 MoveL > 4 W1")

    @pytest.mark.parametrize(
        ("pose", "is_told"),
        [
            (home_pose(), False),
            (home_pose(x=0.0009), False),
            (home_pose(x=0.0011), True),
            (home_pose(turned=0.0009), False),
            (home_pose(turned=0.0011), True),
            (home_pose(turned=3.1), True),
            (None, False),
            ((0.0,) * 6, False),
        ],
    )
    def test_apart(self, pose: tuple[float, ...] | None, is_told: bool, tmp_path: Path) -> None:
        assert found(tmp_path, move(at(pose))) == ([self.HERE] if is_told else [])

    def test_the_tool_of_the_installation_counts(self, tmp_path: Path) -> None:
        assert found(tmp_path, move(at(home_pose(0.2))), configuration=TOOL) == []
        assert found(tmp_path, move(at(home_pose())), configuration=TOOL) == [self.HERE]

    def test_the_tool_of_the_move_counts(self, tmp_path: Path) -> None:
        assert found(tmp_path, move(at(home_pose()), tcp="flange"), configuration=TOOL) == []
        assert found(tmp_path, move(at(home_pose(0.2)), tcp="flange"), configuration=TOOL) == [self.HERE]

    def test_in_joint_moves_and_circles_and_untaught(self, tmp_path: Path) -> None:
        pose = home_pose(x=0.002)
        assert found(tmp_path, move(at(pose), kind="joint")) == [("W226", "3 MoveJ > 4 W1")]
        circle = nodes.Arc(children=(at(home_pose(x=0.1)), at(home_pose(x=0.05))))
        where = [row for row in found(tmp_path, move(circle, kind="process")) if row[0] == "W226"]
        assert where == [("W226", "4 ArcMotion > 5 W1"), ("W226", "4 ArcMotion > 6 W1")]
        assert found(tmp_path, move(at(home_pose(), (float("nan"),) * 6))) == []

    def test_of_another_arm_and_of_none(self, tmp_path: Path) -> None:
        """It is the arm of the task that counts, not the one that runs it."""
        assert ("W226", "3 MoveL > 4 W1") in found(tmp_path, move(at(home_pose())), robot="CS612")
        assert found(tmp_path, move(at(home_pose(x=0.1))), robot="") == []

    def test_a_missing_configuration_is_the_hint(self, tmp_path: Path) -> None:
        path = tmp_path / "cell.task"
        main_task = nodes.MainTask(type_name="Robot Main Task", loops=False, children=(move(at(home_pose(0.2))),))
        path.write_bytes(task_bytes(Task("cell", "inst", "CS66", parts=(main_task,))))
        (told,) = [row for row in source_of(path).notes if row.code == "W226"]
        assert "200.0 mm and 0.0000 rad apart" in told.text
        assert "put it beside the task" in told.hint


class TestVariables:
    @pytest.mark.parametrize("variables", ["", '<Variable name="go" value=""/>', '<Variable name="Go" value="1"/>'])
    def test_of_the_installation(self, variables: str, tmp_path: Path) -> None:
        branch = nodes.If(condition=of("go", is_global=True), children=(nodes.Wait(duration=0.1),))
        assert found(tmp_path, branch, branch, variables=variables) == [("W227", "2 Robot Main Task > 3 If")]

    def test_with_a_value(self, tmp_path: Path) -> None:
        branch = nodes.If(condition=of("go", is_global=True), children=(nodes.Wait(duration=0.1),))
        assert found(tmp_path, branch, variables='<Variable name="go" value="True"/>') == []
        given = nodes.Assignment(variable="go", is_global=True, value=expression("True"))
        assert found(tmp_path, given, branch) == []

    def test_of_a_waypoint(self, tmp_path: Path) -> None:
        point = nodes.Waypoint(position="variable", variable="p", is_global=True)
        assert found(tmp_path, move(point)) == [("W227", "3 MoveL > 4 p")]

    def test_of_the_task(self, tmp_path: Path) -> None:
        branch = nodes.If(condition=of("go", is_global=False), children=(nodes.Wait(duration=0.1),))
        assert found(tmp_path, branch) == [("W206", "2 Robot Main Task > 3 If")]
        point = nodes.Waypoint(position="variable", variable="p")
        assert found(tmp_path, move(point)) == [("W206", "3 MoveL > 4 p")]


class TestEmptyBranches:
    @pytest.mark.parametrize("inside", [(), (nodes.Placeholder(),), (nodes.Comment(text="later"),)])
    def test_condition_and_loop(self, inside: tuple[Node, ...], tmp_path: Path) -> None:
        loop = nodes.Loop(kind="count", count=2, variable="n", children=inside)
        assert found(tmp_path, nodes.If(condition=expression("1 < 2"), children=inside), loop) == [
            ("N227", "2 Robot Main Task > 3 If"),
            ("N227", f"2 Robot Main Task > {4 + len(inside)} Loop 2 times"),
        ]

    def test_a_suppressed_node_is_nothing(self, tmp_path: Path) -> None:
        inside = (nodes.Halt(is_suppressed=True),)
        branch = nodes.If(condition=expression("1 < 2"), children=inside)
        assert found(tmp_path, branch) == [("N227", "2 Robot Main Task > 3 If")]

    def test_branches_of_a_condition_and_cases(self, tmp_path: Path) -> None:
        wait = nodes.Wait(duration=0.1)
        branch = nodes.If(condition=expression("1 < 2"), children=(wait,), branches=(nodes.Else(),))
        switch = nodes.Switch(
            value=expression("1"), children=(nodes.Case(name="case_1"), nodes.Case(name="default case"))
        )
        assert [row for row in found(tmp_path, branch, switch) if row[0] == "N227"] == [
            ("N227", "3 If > 5 Else"),
            ("N227", "6 Switch > 7 case_1"),
        ]


class TestScriptFiles:
    NODE = nodes.ScriptFile(type_name="Script", path="lib/a.script", text="sync()\n")

    @pytest.mark.parametrize(
        ("content", "is_told"),
        [
            ("sync()\n", False),
            ("sync()", False),
            ("sync()\r\n", False),
            ("\ufeffsync()\n", False),
            ("sleep(1)\n", True),
        ],
    )
    def test_beside_the_task(self, content: str, is_told: bool, tmp_path: Path) -> None:
        (tmp_path / "lib").mkdir()
        (tmp_path / "lib/a.script").write_bytes(content.encode())
        assert found(tmp_path, self.NODE) == ([("W228", "2 Robot Main Task > 3 Script")] if is_told else [])

    @pytest.mark.parametrize("path", ["lib/a.script", "../a.script", "/etc/passwd", "a\0b", "C:\\a.script"])
    def test_nothing_outside_is_read(self, path: str, tmp_path: Path) -> None:
        (tmp_path / "a.script").write_text("other")
        (tmp_path / "x").mkdir()
        if "\0" not in path:
            assert found(tmp_path / "x", nodes.ScriptFile(path=path, text="sync()\n")) == []


class TestOutOfReach:
    @pytest.mark.parametrize(
        "point",
        [
            move(at((3.0, 0.0, 0.2, 0.0, 0.0, 0.0))),
            move(at((3.0, 0.0, 0.2, 0.0, 0.0, 0.0)), kind="joint"),
            move(at(None, (6.28318, 0.0, 9.0, 0.0, 0.0, 0.0)), kind="joint", has_joint_positions=True),
        ],
    )
    def test_fixed(self, point: Node, tmp_path: Path) -> None:
        codes = {row[0] for row in found(tmp_path, point)}
        assert codes & {"W236", "W230"}

    def test_variable(self, tmp_path: Path) -> None:
        point = nodes.Waypoint(position="variable", variable="p", is_global=True)
        value = '<Variable name="p" value="[3.0, 0.0, 0.2, 0.0, 0.0, 0.0]"/>'
        assert found(tmp_path, move(point), variables=value) == [("W236", "3 MoveL > 4 p")]


class TestOtherArm:
    def task(self, folder: Path, robot: str) -> Path:
        path = folder / "cell.task"
        parts = (nodes.MainTask(loops=False, children=(nodes.Wait(duration=0.1),)),)
        path.write_bytes(task_bytes(Task("cell", "", robot, parts=parts)))
        return path

    def test_a_run_on_another_arm_is_told_once(self, tmp_path: Path) -> None:
        run = VirtualRobot("CS66").run(self.task(tmp_path, "CS612"))
        assert [(row.code, row.text) for row in run.findings] == [
            ("W229", "the graphical program was made for a CS612, and this is a CS66")
        ]
        assert VirtualRobot("CS612").run(self.task(tmp_path, "CS612")).findings == ()

    def test_the_command_line_takes_the_arm_of_the_task(
        self, tmp_path: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        path = str(self.task(tmp_path, "CS612"))
        for given, is_told in (((), False), (("--robot", "CS612"), False), (("--robot", "CS66"), True)):
            for command in ("run", "check"):
                assert main([command, path, *given]) == 0
                said = capsys.readouterr()
                assert (said.out + said.err).count("W229") == is_told
        (tmp_path / "world.toml").write_text('[robot]\nmodel = "CS66"\n')
        assert main(["run", path, "--world", str(tmp_path / "world.toml")]) == 0
        assert capsys.readouterr().err.count("W229") == 1

    def test_an_arm_that_is_not_known(self, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        assert main(["run", str(self.task(tmp_path, "EC66"))]) == 0
        assert "made for a EC66, and this is a CS66" in capsys.readouterr().err


def test_a_file_of_a_path_that_is_a_folder(tmp_path: Path) -> None:
    (tmp_path / "cell.task").mkdir()
    with pytest.raises(UsageError):
        source_of(tmp_path / "cell.task")
