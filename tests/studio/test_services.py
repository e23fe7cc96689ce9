"""What the editor of the page is answered: for the newest text, as JSON, and without holding anything up."""

from __future__ import annotations

import asyncio
import json
import re
from pathlib import Path
from typing import Any

import pytest

from elitescript.assist.document import Document, Settings
from elitescript.assist.last_run import LastRun, LineTime
from elitescript.conversation.messages import SERVICES
from elitescript.environment.program_file import source_of
from elitescript.errors import UsageError
from elitescript.models.model import model_names
from elitescript.robot import VirtualRobot
from elitescript.studio import services
from elitescript.studio.last_runs import LastRuns
from elitescript.studio.services import EXAMPLES, Desk, EditorServices, Place

ROOT = Path(__file__).resolve().parents[2]

TEXT = """def cell():
  LIFT = 0.1
  def up(height):
    movel([0.4, 0.1, height, 3.14, 0, 0], a=1.2, v=0.25)
  end
  up(LIFT)
  movej([0, -1.57, -1.57, -1.57, 1.57, 0])
end
"""


@pytest.fixture
def desk() -> Desk:
    made = Desk({})
    made.put(1, TEXT, Settings())
    return made


def ask(desk: Desk, service: str, line: int = 0, column: int = 0, version: int = 1, **arguments: Any) -> Any:
    answer = desk.answer(service, version, Place(line, column, arguments))
    assert json.loads(json.dumps(answer)) == answer
    return answer


class TestOfTheText:
    def test_completion_and_what_is_known_of_an_offer(self, desk: Desk) -> None:
        offers = {offer["label"]: offer for offer in ask(desk, "completion", 7, 5)}
        offer = offers["movej"]
        assert (offer["kind"], offer["span"]) == ("command", {"line": 7, "column": 3, "end_line": 7, "end_column": 8})
        assert offers["LIFT"]["kind"] == "constant"
        given = {name: offer[name] for name in ("label", "kind", "source")}
        assert "joint" in ask(desk, "resolve", **given)["documentation"]

    def test_hover_and_signature(self, desk: Desk) -> None:
        found = ask(desk, "hover", 7, 4)
        assert found["span"] == {"line": 7, "column": 3, "end_line": 7, "end_column": 8}
        assert "movej(" in found["markdown"]
        assert ask(desk, "hover", 5, 1) is None
        found = ask(desk, "signature", 6, 6)
        assert (found["label"], found["active"]) == ("up(height)", 0)
        assert ask(desk, "signature", 5, 1) is None

    def test_where_a_name_comes_from_and_where_it_is_used(self, desk: Desk) -> None:
        assert ask(desk, "definition", 6, 4) == [{"line": 3, "column": 7, "end_line": 3, "end_column": 9}]
        found = ask(desk, "references", 3, 7)
        assert [(item["span"]["line"], item["is_definition"]) for item in found] == [(3, True), (6, False)]

    def test_rename(self, desk: Desk) -> None:
        assert ask(desk, "rename", 6, 4)["name"] == "up"
        edits = ask(desk, "rename", 6, 4, new_name="lift")["edits"]
        assert [(edit["line"], edit["column"], edit["text"]) for edit in edits] == [(3, 7, "lift"), (6, 3, "lift")]
        assert "movej" in ask(desk, "rename", 6, 4, new_name="movej")["refusal"]
        with pytest.raises(UsageError, match="new_name: must be a text, got 3"):
            ask(desk, "rename", 6, 4, new_name=3)

    def test_actions_name_the_findings_that_they_mend(self) -> None:
        desk = Desk({})
        desk.put(1, "def p():\n  movej([0, -90, 0, -90, 0, 0])\nend\n", Settings())
        found = ask(desk, "actions", 2, 1, end_line=2, end_column=30)
        assert found and all(isinstance(code, str) for action in found for code in action["problems"])
        assert any(action["edits"] for action in found)
        with pytest.raises(UsageError, match="must be whole numbers"):
            ask(desk, "actions", 2, 1, end_line="x")

    def test_format_of_the_text_and_of_some_lines(self) -> None:
        desk = Desk({})
        desk.put(1, "def p():\n   sleep( 1 )\n   sleep( 2 )\nend\n", Settings())
        assert {edit["line"] for edit in ask(desk, "format")} == {2, 3}
        assert {edit["line"] for edit in ask(desk, "format", 3, 1, end_line=3, end_column=2)} == {3}

    def test_tokens_are_rows_of_five_numbers(self, desk: Desk) -> None:
        found = ask(desk, "tokens")
        rows = [tuple(found["rows"][at : at + 5]) for at in range(0, len(found["rows"]), 5)]
        words = {
            TEXT.split("\n")[line - 1][column - 1 : column - 1 + length]: kind for line, column, length, kind, _ in rows
        }
        assert found["types"][words["movej"]] == "command"
        assert found["types"][words["up"]] == "function"
        some = ask(desk, "tokens", 7, 1, end_line=7, end_column=2)
        assert some["rows"] == [number for row in rows if row[0] == 7 for number in row]

    def test_folding_and_outline(self, desk: Desk) -> None:
        assert {(fold["line"], fold["end_line"]) for fold in ask(desk, "folding")} >= {(1, 8), (3, 5)}
        (program,) = ask(desk, "outline")
        assert (program["name"], [child["name"] for child in program["children"]]) == ("cell", ["up"])

    def test_hints_show_the_last_run(self, desk: Desk) -> None:
        assert [hint["kind"] for hint in ask(desk, "hints", 7, 1, end_line=8, end_column=1)] == ["unit"]
        desk.last_run = LastRun(TEXT, 3.0, moves={7: LineTime(1, 2.5)}, lines={7: LineTime(1, 2.5)})
        _, hint = ask(desk, "hints", 7, 1, end_line=8, end_column=1)
        assert (hint["kind"], hint["label"]) == ("time", "2.5 s")

    def test_another_version_is_refused(self, desk: Desk) -> None:
        with pytest.raises(UsageError, match="it is version 1, not 2"):
            ask(desk, "hover", 7, 4, version=2)
        desk.put(0, "older", Settings())
        assert ask(desk, "hover", 7, 4) is not None


class TestEdits:
    @pytest.mark.parametrize(
        ("old", "new"),
        [
            ("", ""),
            ("", "a"),
            ("a", ""),
            ("a\nb\nc", "a\nc"),
            ("a\nb\nc", "a\nx\ny\nc"),
            ("a\na\na", "a\na"),
            ("a\na", "a\na\na\na"),
            ("a\n", "\na\n"),
            ("x\ny\n", "p\nq\nr\n"),
            ("🤖 a\nb", "🤖 位\nb"),
        ],
    )
    def test_the_next_text_is_that_of_the_page(self, old: str, new: str) -> None:
        assert Document("", old).edited(services._edits(Document("", old), new), 2).text == new

    def test_texts_with_marks_that_a_page_does_not_have(self) -> None:
        desk = Desk({})
        for version, text in enumerate(("\ufeff", "\ufeff\ud83d", "a\rb", "a\r\nb\n", "a\nb\n", "\ufeffa\nb\n")):
            desk.put(version, text, Settings())
            assert desk._document.text == text
            assert ask(desk, "hover", 1, 5, version=version) is None

    def test_a_change_of_one_line_is_one_line(self) -> None:
        (edit,) = services._edits(Document("", "a\nb\nc\nd"), "a\nb\nx\nd")
        assert edit == (3, 1, 3, 2, "x")


class TestOfTheProduct:
    def test_codes(self, desk: Desk) -> None:
        found = ask(desk, "explain", code="e303")
        assert found["markdown"].startswith("wrong number or names of arguments\n\n*Error.")
        with pytest.raises(UsageError, match="there is no code 'E999'"):
            ask(desk, "explain", code="E999")

    def test_commands(self, desk: Desk) -> None:
        assert {"movej", "movel", "set_tcp"} < {command["name"] for command in ask(desk, "commands")}
        assert ask(desk, "commands", name="movej")["signature"].startswith("movej(q")
        assert ask(desk, "commands", name="move") is None

    def test_robots(self) -> None:
        found = ask(Desk({"model": "CS612"}), "robots", version=0)
        assert [row["name"] for row in found["robots"]] == list(model_names())
        assert found["robots"][1] == {"name": "CS66", "reach_m": 0.914, "payload_kg": 6.0}
        assert found["defaults"]["robot"] == "CS612"
        assert found["defaults"]["firmware"] in found["firmwares"]

    def test_signals(self, desk: Desk) -> None:
        found = {row["name"]: row for row in ask(desk, "signals")}
        row = found["standard_analog_in"]
        assert (row["kind"], row["size"], row["is_input"]) == ("float", 2, True)
        assert (row["low"], row["high"], row["unit"], row["default"]) == (0.0, 10.0, "V or A", 0.0)
        assert found["flag"]["default"] is False

    def test_no_urdf(self, desk: Desk) -> None:
        with pytest.raises(UsageError, match="started without --urdf"):
            ask(desk, "mesh")

    def test_every_service_is_answered_and_its_result_described(self) -> None:
        assert set(services._SERVICES) == set(SERVICES)
        described = (ROOT / "web" / "src" / "source" / "services.ts").read_text().partition("interface Results {")[2]
        assert re.findall(r"^  (\w+):", described, re.MULTILINE) == [*dict.fromkeys(SERVICES)]

    def test_what_follows_from_a_character(self) -> None:
        desk = Desk({})
        desk.put(1, "def p():\n  if True:\n\nend\n", Settings())
        edits = ask(desk, "typing", 3, 1, typed="\n")
        assert [edit["line"] for edit in edits] and any("end" in edit["text"] for edit in edits)


class TestExamples:
    PATHS = sorted(EXAMPLES.glob("*.script"))

    def test_there_are_three(self, desk: Desk) -> None:
        found = ask(desk, "examples")
        assert [row["name"] for row in found] == [path.stem for path in self.PATHS]
        assert len(found) == 3
        assert found[0]["title"] == "First moves: joints, straight lines, a rounded corner"
        assert all(row["text"] == path.read_text() for row, path in zip(found, self.PATHS, strict=True))

    @pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
    def test_nothing_is_wrong_with_them(self, path: Path) -> None:
        assert Document(path.name, path.read_text()).problems == ()
        for model in model_names():
            robot = VirtualRobot(model)
            run = robot.run(robot.compile(source_of(path)), until_s=60.0)
            assert (run.state, run.alarms) == ("finished", [])
            assert 4.0 < run.time_s < 30.0

    def test_the_one_that_waits_goes_on_with_its_input(self) -> None:
        robot = VirtualRobot()
        robot.set_start({"standard_digital_in[0]": True})
        (path,) = (path for path in self.PATHS if "wait" in path.stem)
        run = robot.run(robot.compile(source_of(path)), until_s=60.0)
        assert run.globals["part_is_here"] is True


class TestThread:
    def test_the_newest_text_and_its_options_count(self, tmp_path: Path) -> None:
        world = tmp_path / "world.toml"
        world.write_text('[robot]\nfirmware = "2.14"\n[[tcp]]\naddress = "192.168.0.7:5000"\n')

        async def steps() -> list[Any]:
            made = EditorServices({"model": "CS63"})
            try:
                made.put(1, TEXT, {}, None)
                hover = await made.answer("hover", 1, Place(7, 4, {}))
                made.put(2, 'def p():\n  socket_open("")\nend\n', {"firmware": "2.10"}, world)
                offers = await made.answer("completion", 2, Place(2, 16, {}))
                made.put(3, "def p():\n  sleep(1)\nend\n", {"model": "no such arm"}, None)
                tokens = await made.answer("tokens", 3, Place(0, 0, {}))
                with pytest.raises(UsageError, match="it is version 3"):
                    await made.answer("hover", 2, Place(1, 1, {}))
                return [hover, [offer["label"] for offer in offers], tokens["rows"]]
            finally:
                made.close()

        hover, offers, tokens = asyncio.run(steps())
        assert "movej(" in hover["markdown"]
        assert "192.168.0.7" in " ".join(offers)
        assert tokens

    def test_the_last_run_reaches_the_desk(self) -> None:
        async def steps() -> Any:
            made = EditorServices({})
            made.put(1, TEXT, {}, None)
            made.ran(LastRun(TEXT, 3.0, moves={7: LineTime(1, 2.5)}, lines={7: LineTime(1, 2.5)}))
            try:
                return await made.answer("hints", 1, Place(7, 1, {"end_line": 8, "end_column": 1}))
            finally:
                made.close()

        assert [hint["kind"] for hint in asyncio.run(steps())] == ["unit", "time"]


class TestLastRuns:
    MOMENT = {"t": 2.0, "globals": [{"name": "count", "value": "3", "type": "int", "changed": False}]}  # noqa: RUF012

    def test_it_is_gathered_from_the_messages(self) -> None:
        ran: list[LastRun] = []
        runs = LastRuns(ran.append)
        runs.program(4, TEXT)
        for message in (
            {"type": "problems", "version": 4, "list": []},
            {"type": "run_began", "run": 9, "version": 4},
            {
                "type": "moves",
                "run": 9,
                "list": [
                    {"start_s": 0.0, "end_s": 0.5, "kind": "movej", "line": 7},
                    {"start_s": 0.5, "end_s": 1.5, "kind": "movej", "line": 7},
                ],
            },
            {"type": "cycle", "run": 8, "table": [{"line": 1, "moving_s": 1.0, "standing_s": 0.0, "visits": 1}]},
            {
                "type": "cycle",
                "run": 9,
                "table": [
                    {"line": 7, "moving_s": 1.5, "standing_s": 0.25, "visits": 2},
                    {"line": 2, "moving_s": 0.1, "standing_s": 0.4, "visits": 1},
                ],
            },
            {"type": "run_ended", "run": 8, "state": "finished", "moment": self.MOMENT},
            {
                "type": "run_ended",
                "run": 9,
                "state": "alarm",
                "moment": self.MOMENT,
                "alarm": {"line": 7, "code": "R201", "text": "too far"},
            },
        ):
            runs.take(message)
        (last,) = ran
        assert (last.text, last.duration_s) == (TEXT, 2.0)
        assert last.moves == {7: LineTime(2, 1.5)}
        assert last.lines == {7: LineTime(2, 1.75), 2: LineTime(1, 0.5)}, "the tail of a blend is no move of its line"
        assert last.values == {"": {"count": "3"}}
        assert last.alarms == ((7, "R201", "too far"),)

    def test_a_run_of_an_older_text_is_left_out(self) -> None:
        ran: list[LastRun] = []
        runs = LastRuns(ran.append)
        runs.program(4, TEXT)
        runs.program(5, "newer")
        runs.take({"type": "run_began", "run": 9, "version": 4})
        runs.take({"type": "run_ended", "run": 9, "state": "finished", "moment": self.MOMENT})
        assert ran == []
