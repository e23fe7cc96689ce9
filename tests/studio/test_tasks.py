"""What a page learns of a graphical program: its tree and script, changes by other tools, what is wrong with it."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import pytest

from elitescript.conversation.messages import Save
from elitescript.conversation.trees import with_task
from elitescript.environment.task_files import opened_task
from elitescript.errors import UsageError
from elitescript.studio.files import Programs
from elitescript.studio.live.engine import LiveEngine
from elitescript.studio.live.jobs import Job, job_data, job_of
from elitescript.studio.live.running import run_program
from elitescript.studio.memory import Memory
from elitescript.studio.opened import OpenFile
from elitescript.studio.services import Desk, Place
from tests.studio.live.links import ListLink, no_jail

TASK = """<EliTask name="cell" installationName="inst" robotType="CS66">
  <InitVariables/>
  <MainTask isTaskAlwaysLoops="false" hasInitVariables="true" typeName="Robot Main Task">
    <MoveNode movementType="JOINT_MOVEMENT" positionType="JOINT_ANGLES" typeName="MoveJ">
      <WaypointNode name="W1" positionNodeType="FIXED_POSITION" typeName="Waypoint">
        <internalPosition><jointPositions joints="0.1, -1.5, -1.5, -1.5, 1.5, 0.0"/></internalPosition>
      </WaypointNode>
    </MoveNode>
    <SetNode type="DIGITAL_OUTPUT" typeName="Set"><digitalOutputPinName>digital_out[0]</digitalOutputPinName>
      <digitalOutputPinValue>HIGH</digitalOutputPinValue></SetNode>
    <CompressNode><CompressedNode><HaltNode typeName="Halt"/></CompressedNode></CompressNode>
  </MainTask>
</EliTask>"""
NEVER_TAUGHT = TASK.replace("0.1, -1.5, -1.5, -1.5, 1.5, 0.0", "NaN, NaN, NaN, NaN, NaN, NaN")
VARIABLES = '<VariablesManager><Variable name="speed_1" value="0.15" remarks="" favorite="false"/></VariablesManager>'


class Cell:
    """A folder with a task, and what a page of it was sent."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / "cell.task"
        self.path.write_text(TASK)
        self.said: list[dict[str, Any]] = []
        memory = Memory(folder / "state")
        self.file = OpenFile(Programs(folder), memory, lambda message: self.said.append(dict(message)))
        asyncio.run(self.file.open("cell.task"))

    def changes(self) -> list[dict[str, Any]]:
        """Return what is said of a look at the disk."""
        before = len(self.said)
        asyncio.run(self.file.look())
        return self.said[before:]


@pytest.fixture
def cell(tmp_path: Path) -> Cell:
    return Cell(tmp_path)


class TestFile:
    def test_the_tree_comes_with_the_script(self, cell: Cell) -> None:
        (message,) = cell.said
        assert (message["type"], message["name"]) == ("file", "cell.task")
        assert message["text"].startswith("def cell():\n")
        tree = message["tree"]
        assert [(row["level"], row["kind"], row["name"], row["is_suppressed"]) for row in tree["rows"]] == [
            (0, "Initial variables", "", False),
            (0, "Main task", "", False),
            (1, "MoveJ", "", False),
            (2, "Waypoint", "W1", False),
            (1, "Set", "", False),
            (1, "Halt", "", True),
        ]
        assert tree["rows"][4]["summary"] == "digital_out[0] = high"
        lines = message["text"].split("\n")
        move = next(number for number, line in enumerate(lines) if line.strip().startswith("movej("))
        assert tree["lines"][move] == 4
        assert tree["places"][4] == "3 MoveJ > 4 W1"
        assert set(tree["lines"]) == {0, 2, 3, 4, 5}

    def test_what_another_tool_writes_is_told_with_its_tree(self, cell: Cell) -> None:
        assert cell.changes() == []
        cell.path.write_text(TASK.replace('name="W1"', 'name="Above"'))
        (message,) = cell.changes()
        assert (message["type"], message["tree"]["rows"][3]["name"]) == ("file_changed", "Above")
        assert cell.file.task is not None and cell.file.task.source.text == message["text"]
        assert cell.changes() == []

    def test_the_configuration_beside_it_counts_as_the_file(self, cell: Cell) -> None:
        variables = cell.path.parent / "inst.configuration.variables"
        variables.write_text(VARIABLES)
        (message,) = cell.changes()
        assert "speed_1 = 0.15" in message["text"]
        variables.write_text(VARIABLES.replace("0.15", "0.25"))
        (message,) = cell.changes()
        assert "speed_1 = 0.25" in message["text"]

    def test_a_file_that_is_gone_for_a_moment_is_still_what_it_was(self, cell: Cell) -> None:
        cell.path.rename(cell.path.parent / "away")
        assert cell.changes() == [{"type": "file_changed", "name": "cell.task", "digest": ""}]
        assert cell.file.task is not None
        (cell.path.parent / "away").rename(cell.path)
        (message,) = cell.changes()
        assert message["digest"] == cell.said[0]["digest"]

    def test_a_file_that_is_no_task_is_shown_as_it_is(self, cell: Cell) -> None:
        cell.path.write_text(TASK.replace("</MoveNode>", "</MoveNod>"))
        (message,) = cell.changes()
        assert message["text"].startswith("<EliTask")
        assert message["tree"] == {"rows": [], "lines": [], "places": [""]}
        assert cell.file.task is not None
        (error,) = cell.file.task.errors
        assert (error.code, error.line, error.text) == ("E004", 8, "no XML: mismatched tag")

    def test_a_broken_file_beside_it_is_named_itself(self, cell: Cell) -> None:
        (cell.path.parent / "inst.configuration.variables").write_text("<VariablesManager>\n<Variable")
        cell.changes()
        assert cell.file.task is not None
        (error,) = cell.file.task.errors
        assert (error.line, error.column) == (1, 1)
        assert error.text.startswith("inst.configuration.variables:2:1: no XML")

    def test_it_is_not_written_and_has_no_drafts(self, cell: Cell) -> None:
        cell.file.edited("mine")
        asyncio.run(cell.file.save(Save(7, "mine", cell.said[0]["digest"], force=True)))
        assert cell.said[-1]["type"] == "refused"
        assert "generated from cell.task: the tree is the source" in cell.said[-1]["text"]
        asyncio.run(cell.file.close())
        assert cell.path.read_text() == TASK
        assert cell.file._memory.drafts(cell.path) == []


class TestRun:
    def test_what_is_known_of_the_tree_stands_before_what_check_finds(self, tmp_path: Path) -> None:
        task = opened_task(Cell(tmp_path).path)
        checked = {"type": "problems", "version": 3, "list": [{"code": "W201"}], "compiles": True}
        found = with_task(checked, task)
        assert [row["code"] for row in found["list"]] == ["N225", "W201"]
        assert found["compiles"] is True

    def test_a_task_that_cannot_be_generated_does_not_run_and_says_where(self, tmp_path: Path) -> None:
        cell = Cell(tmp_path)
        cell.path.write_text(NEVER_TAUGHT)
        task = opened_task(cell.path)
        found = with_task({"type": "problems", "version": 3, "list": [], "compiles": True, "start": {}}, task)
        assert found["compiles"] is False
        assert "start" not in found
        (error,) = [row for row in found["list"] if row["severity"] == "error"]
        assert task.source.place(error["line"]) == "3 MoveJ > 4 W1"
        engine = LiveEngine(None, None)  # type: ignore[arg-type]
        engine.task = task
        assert engine._task_of(task.source.text) is task
        assert engine._task_of("def other():\nend\n") is None

    def test_nodes_are_reported_when_they_begin_and_named_in_findings(self, tmp_path: Path) -> None:
        cell = Cell(tmp_path)
        cell.path.write_text(TASK.replace("0.1, -1.5", "7.1, -1.5"))
        source = opened_task(cell.path).source
        job = job_of(job_data(Job("cell.task", source.text, places=source.places)))
        assert job.source.name == "cell.task"
        link = ListLink()
        request = {"job": job_data(job), "run": 1, "version": 1, "options": {}, "until_s": 60.0, "wall_s": 60.0}
        run_program(link, request | {"known": None}, no_jail)
        marks = link.of("marks")
        assert [node for message in marks for node in message["node"]] == [2, 3, 4]
        assert link.one("run_ended")["alarm"]["line"] in [
            line for line in range(1, 99) if source.place(line) == "3 MoveJ > 4 W1"
        ]


@pytest.mark.parametrize("service", ["references", "rename", "format"])
def test_services_of_edits_say_where_the_source_is(service: str) -> None:
    desk = Desk({})
    desk.put(1, "a = 1\n", desk._document.settings, "cell.task.script")
    with pytest.raises(UsageError, match=r"generated from cell\.task: the tree is the source"):
        desk.answer(service, 1, Place(1, 1, {}))
    desk.put(2, "a = 1\n", desk._document.settings)
    assert desk.answer("references", 2, Place(1, 1, {})) is not None
