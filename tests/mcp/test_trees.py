"""Graphical programs for agents: answers name nodes, and what cannot run says where."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("mcp", reason="needs the extra mcp")

from elitescript.environment.task_files import source_of_task
from elitescript.errors import UsageError
from elitescript.mcp import runs
from elitescript.mcp.folder import Folder
from elitescript.mcp.server import _graphical
from elitescript.mcp.steps import Steps

TASK = """<EliTask name="cell" robotType="CS612">
  <MainTask isTaskAlwaysLoops="false" hasInitVariables="false" typeName="Robot Main Task">
    <MoveNode movementType="JOINT_MOVEMENT" positionType="JOINT_ANGLES" typeName="MoveJ">
      <WaypointNode name="W1" positionNodeType="FIXED_POSITION" typeName="Waypoint">
        <internalPosition><jointPositions joints="0.1, -1.5, -1.5, -1.5, 1.5, 0.0"/></internalPosition>
      </WaypointNode>
    </MoveNode>
    <ScriptNode scriptType="LINE_TYPE" typeName="Script"><Expression>
      <ExpressionTokenCell token="x" scriptCode="textmsg('there')"/></Expression></ScriptNode>
  </MainTask>
</EliTask>"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    found = tmp_path / "cell.task"
    found.write_text(TASK)
    return found


def test_the_arm_of_the_task_runs_it_unless_another_is_named(path: Path) -> None:
    text = source_of_task(path).text
    assert _graphical(path, has_arm=False) == {"text": text, "task": str(path), "robot": "CS612"}
    assert "robot" not in _graphical(path, has_arm=True)
    assert Folder(path.parent).programs(10) == (["cell.task"], 1)


def test_a_run_names_nodes_beside_lines(path: Path) -> None:
    found = runs.run({"name": "cell.task", **_graphical(path, has_arm=False)})
    assert found["state"] == "finished"
    assert [(move["kind"], move["node"]) for move in found["moves"]] == [("movej", "2 MoveJ > 3 W1")]
    assert [(message["text"], message["node"]) for message in found["messages"]] == [
        ("there", "1 Robot Main Task > 4 Script")
    ]


def test_a_debugged_run_stands_in_nodes(path: Path) -> None:
    steps = Steps()
    steps.start({"name": "cell.task", **_graphical(path, has_arm=False)})
    line = next(n for n, text in enumerate(source_of_task(path).lines, 1) if text.strip().startswith("movej("))
    found = steps.breakpoints({"lines": [{"line": line}]})
    assert found["breakpoints"][0]["node"] == "2 MoveJ > 3 W1"
    stop = steps.go({"how": "continue"})
    assert (stop["stack"][0]["line"], stop["stack"][0]["node"]) == (line, "2 MoveJ > 3 W1")


def test_what_cannot_run_names_its_node(path: Path) -> None:
    path.write_text(TASK.replace("0.1, -1.5, -1.5, -1.5, 1.5, 0.0", "NaN, NaN, NaN, NaN, NaN, NaN"))
    with pytest.raises(UsageError, match=r"2 MoveJ > 3 W1: .*the waypoint has never been taught"):
        _graphical(path, has_arm=False)
