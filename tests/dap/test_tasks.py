"""Graphical programs in a debugger: what is seen is the script, what is marked may be a line of the file."""

from __future__ import annotations

from pathlib import Path

import pytest

from elitescript.environment.task_files import opened_task
from elitescript.environment.task_places import FileSpan, TaskPlaces
from tests.dap.client import Failed, MemoryClient

TASK = """<EliTask name="cell" robotType="CS66">
  <InitVariables/>
  <MainTask isTaskAlwaysLoops="false" hasInitVariables="true" typeName="Robot Main Task">
    <LoopNode type="LOOP_X_TIMES" loopCount="2" typeName="Loop">
      <TaskVariable name="Loop_1" type="Loop"/>
      <Expression/>
      <children>
        <MoveNode movementType="JOINT_MOVEMENT" positionType="JOINT_ANGLES" typeName="MoveJ">
          <WaypointNode name="W1" positionNodeType="FIXED_POSITION" typeName="Waypoint">
            <internalPosition><jointPositions joints="0.1, -1.5, -1.5, -1.5, 1.5, 0.0"/></internalPosition>
          </WaypointNode>
        </MoveNode>
        <CompressNode><CompressedNode><HaltNode typeName="Halt"/></CompressedNode></CompressNode>
        <WaitNode type="WAIT_TIME" typeName="Wait"><waitTime value="0.5" unit="S"/></WaitNode>
      </children>
    </LoopNode>
  </MainTask>
</EliTask>"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    found = tmp_path / "cell.task"
    found.write_text(TASK)
    return found


@pytest.fixture
def client():
    found = MemoryClient()
    yield found
    found.request("disconnect")
    found.check_answers()


class TestPlaces:
    def test_a_line_of_the_file_is_about_the_node_that_begins_there_or_is_around_it(self, path: Path) -> None:
        places = TaskPlaces(opened_task(path))
        found = [row.number if (row := places.row_at(line)) else 0 for line in range(1, 20)]
        assert found == [0, 1, 2, 3, 3, 3, 3, 4, 5, 5, 5, 4, 6, 7, 3, 3, 2, 0, 0]
        assert places.spans[4] == FileSpan(9, 11, 11, 26)
        assert (places.script_line(2), places.script_line(13)) == (0, 0)
        line = places.script_line(10)
        assert places.task.source.line(line).strip() == '$ LINE: (5, "W1", "after")'
        assert (places.file_line(line), places.file_line(line + 1), places.file_line(1)) == (9, 9, 1)


class TestSession:
    def test_a_breakpoint_in_the_file_stops_at_the_node_in_the_script(self, client: MemoryClient, path: Path) -> None:
        client.initialize()
        launch = client.launch(path)
        bodies = client.set_breakpoints(path, 10, 13, 18)
        assert [(body["verified"], body["line"]) for body in bodies] == [(True, 9), (False, 13), (False, 18)]
        assert [body.get("message") for body in bodies] == [
            None,
            "6 Halt writes no line of the script",
            "no node of the tree stands here",
        ]
        client.request("configurationDone")
        client.answer(launch)
        stop = client.stop()["body"]
        assert stop["reason"] == "breakpoint"
        assert stop["hitBreakpointIds"] == [bodies[0]["id"]]
        (frame,) = client.stack()
        assert frame["name"].startswith("4 MoveJ > 5 W1: cell")
        source = frame["source"]
        assert source["name"] == "cell.task.script"
        assert "path" not in source
        text = client.request("source", sourceReference=source["sourceReference"], source=source)["content"]
        assert text.split("\n")[frame["line"] - 1].strip().startswith("movej(")

        # Steps go by the statements of the script; each says its node.
        client.go("next")
        (frame,) = client.stack()
        assert frame["name"].startswith("3 Loop 2 times > 7 Wait: cell")
        client.go("stepBack")
        assert client.stack()[0]["name"].startswith("4 MoveJ > 5 W1: cell")

        # Breakpoints of the script and of the file do not take each other away.
        line = next(number for number, row in enumerate(text.split("\n"), 1) if row.strip().startswith("sleep("))
        found = client.request("setBreakpoints", source=source, breakpoints=[{"line": line}])["breakpoints"]
        assert found[0]["verified"]
        assert client.go("continue")["body"]["hitBreakpointIds"] == [found[0]["id"]]
        assert client.go("continue")["body"]["hitBreakpointIds"] == [bodies[0]["id"]]

    def test_lines_at_which_nodes_begin_can_have_breakpoints(self, client: MemoryClient, path: Path) -> None:
        client.initialize()
        client.launch(path)
        found = client.request("breakpointLocations", source={"path": str(path)}, line=1, endLine=20)["breakpoints"]
        assert [place["line"] for place in found] == [3, 4, 8, 9, 14]

    def test_a_finding_names_the_node(self, client: MemoryClient, path: Path) -> None:
        path.write_text(TASK.replace('"0.1, -1.5', '"9.1, -1.5'))
        client.initialize()
        client.launch(path)
        outputs = [body for body in client.bodies("output") if "4 MoveJ > 5 W1: " in body["output"]]
        assert outputs, client.outputs()
        assert outputs[0]["source"]["name"] == "cell.task.script"

    @pytest.mark.parametrize(
        ("old", "new", "line", "text"),
        [
            ("0.1, -1.5, -1.5, -1.5, 1.5, 0.0", "NaN, NaN, NaN, NaN, NaN, NaN", 9, "4 MoveJ > 5 W1: the waypoint has"),
            ("</LoopNode>", "</LoopNod>", 16, "no XML: mismatched tag"),
        ],
    )
    def test_a_task_that_cannot_run_says_where_in_its_file(
        self, client: MemoryClient, path: Path, old: str, new: str, line: int, text: str
    ) -> None:
        path.write_text(TASK.replace(old, new))
        client.initialize()
        with pytest.raises(Failed) as refused:
            client.launch(path)
        assert f"cell.task: line {line}, " in refused.value.text
        assert text in refused.value.text
        (output,) = [body for body in client.bodies("output") if text in body["output"]]
        assert (output["source"]["path"], output["line"]) == (str(path), line)
