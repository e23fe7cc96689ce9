"""What pages are sent of a robot, a text and a run."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from elitescript.conversation import describe
from elitescript.conversation.describe import Moment, Thread, Variable
from elitescript.conversation.limits import FINDINGS_BYTES_MAX, FINDINGS_MAX, FIX_BYTES_MAX, TEXT_MAX, EventBudget
from elitescript.conversation.messages import RunOptions, SignalInput
from elitescript.json_records.events import record_of
from elitescript.language.diagnostics import Edit, Fix, diagnostic
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.lint.registry import all_rules
from elitescript.messages.events import Alarm
from elitescript.messages.findings import Finding
from elitescript.messages.motion import MoveJ, MoveL
from elitescript.messages.profile import DEFAULT_FIRMWARE, PROFILES
from elitescript.models.model import load_model
from elitescript.robot import VirtualRobot
from elitescript.solids.contacts import Contact
from elitescript.solids.scene import scene

CONTRACT = Path(__file__).parents[2] / "web/src/source/messages.ts"
SIX = (0.0, 1.0, 0.0, 0.0, 0.0, 0.5)


def interface(name):
    """Return the fields of an interface of the page, by name; whether each may be missing."""
    text = CONTRACT.read_text(encoding="utf-8")
    body = re.split(rf"export interface {name} ", text)[1].split("\n}")[0].partition("{")[2].partition("}\n")[0]
    body = re.sub(r"/\*\*.*?\*/", "", body, flags=re.DOTALL)
    body = re.sub(r"\{[^{}]*\}", "X", body)
    return {field: bool(mark) for field, mark in re.findall(r"readonly (\w+)(\??):", body)}


def message(kind):
    """Return the fields of a message to the page."""
    text = CONTRACT.read_text(encoding="utf-8").partition("export type FromSource =")[2]
    body = re.sub(r"/\*\*.*?\*/", "", text, flags=re.DOTALL).partition(f'type: "{kind}"')[2].partition("}\n")[0]
    body = re.sub(r"\{[^{}]*\}", "X", body.split("\n  |")[0])
    return {"type": False} | {field: bool(mark) for field, mark in re.findall(r"readonly (\w+)(\??):", body)}


def assert_has_form(found, fields):
    json.dumps(found, allow_nan=False)
    assert set(found) <= set(fields)
    assert {name for name, is_optional in fields.items() if not is_optional} <= set(found)


MOMENT = Moment(
    1.25,
    4,
    SIX,
    SIX,
    (Variable("a", "3", "int", True),),
    {"flag[0]": True, "standard_analog_in[0]": float("nan")},
    (Thread("main", 4, "", "p"),),
    "7",
    SIX,
)


class TestForms:
    """Each message has the fields that the page's types have."""

    @pytest.mark.parametrize(
        "found",
        [
            describe.hello("live", "elitescript 0", describe.LIVE_ABILITIES, "a.script", programs=["a"], settings={}),
            describe.hello("recorded", "elitescript 0", (), "a.script"),
            describe.problems(1, [diagnostic("W206", 1, 1, "text")], compiles=True),
            describe.run_began(1, 2, RunOptions(until_s=3.0)),
            describe.progress(1, 0.5),
            describe.events(1, [], EventBudget()),
            describe.left_out(1, EventBudget()),
            describe.lines(1, "main", [(0.0, 1)]),
            describe.moves(1, []),
            describe.cycle(1, []),
            describe.run_ended(1, "killed", MOMENT, alarm={}, killed="why", refused_connections=["here"]),
            describe.run_ended(1, "finished", MOMENT),
            describe.run_ended(1, "finished", MOMENT, findings=[Finding("W280", "warning", 3, 0, "text", t=1.0)]),
            describe.state(1, 2, MOMENT),
            describe.refused("no", 3, {"text": "", "digest": ""}),
            describe.refused("no"),
            describe.notice("warning", "text"),
        ],
        ids=lambda found: found["type"],
    )
    def test_messages(self, found):
        assert_has_form(found, message(found["type"]))

    def test_scene(self):
        found = scene(load_model("CS63"), urdf="arm.urdf")
        assert_has_form(found, interface("Scene"))
        assert set(found["limits"]) == {"position_min", "position_max", "speed", "acceleration", "tcp_speed", "reach"}

    def test_moment(self):
        assert_has_form(describe.moment(MOMENT), interface("Moment"))
        assert_has_form(describe.moment(Moment(0.0, 0, SIX, SIX)), interface("Moment"))
        assert_has_form(describe.moment(MOMENT)["globals"][0], interface("VariableState"))
        assert_has_form(describe.moment(MOMENT)["threads"][0], interface("ThreadState"))

    def test_problem(self):
        fix = Fix("Remove it", (Edit(1, 2, 1, 3, ""),), True)
        found = describe.problem(diagnostic("W206", 1, 2, "text", hint="do", fix=fix))
        assert_has_form(found, interface("Problem"))
        assert_has_form(found["fix"]["edits"][0], interface("TextEdit"))

    def test_alarm(self):
        found = describe.alarm_report(
            Alarm(5, "R110", "MotionError", "text", 2, 3, "main", "", {"limit": "< 1", "value": 2.0}),
            MoveJ(SIX, 1.0, 1.0),
        )
        assert_has_form(found, interface("AlarmReport"))

    def test_contacts(self):
        touch = Contact(1.0, 2.0, 4, "tool", "table", -0.01, 1.5, True, ((0.0, 0.0, 0.0), (0.0, 0.0, 0.01)))
        assert_has_form(describe.contacts(1, [touch])["list"][0], interface("Contact"))
        assert_has_form(describe.contacts(1, [touch]), message("contacts"))

    def test_cycle(self):
        assert_has_form(describe.cycle(1, [(3, 1.0, 0.5, 2)])["table"][0], interface("CycleRow"))
        assert_has_form(describe.moves(1, [(0.0, 1.0, "movej", 2)])["list"][0], interface("Move"))


class TestProblems:
    def test_they_are_those_of_check_with_safe_fixes_only(self):
        text = "def p():\n  print 3\n  x = 5\nend\n"
        found = check_source(SourceFile("p", text), PROFILES[DEFAULT_FIRMWARE])
        made = describe.problems(4, found, compiles=False)
        assert [(item["code"], item["line"], item["column"]) for item in made["list"]] == [
            (item.code, item.line, item.column) for item in found
        ]
        assert ["fix" in item for item in made["list"]] == [item.fix is not None and item.fix.safe for item in found]
        assert found
        assert made["rules"] == len(all_rules())

    def test_too_many_are_counted_and_errors_come_first(self):
        warnings = [diagnostic("W206", line, 1, "text") for line in range(1, FINDINGS_MAX + 1)]
        errors = [diagnostic("E301", line, 1, "text") for line in (5000, 5001)]
        made = describe.problems(1, [*warnings, *errors], compiles=False)
        assert [item["line"] for item in made["list"]] == [*range(1, FINDINGS_MAX - 1), 5000, 5001]
        assert made["left_out"] == {"warning": 2}
        assert_has_form(made, message("problems"))

    def test_their_texts_are_cut_and_bounded_together(self):
        text = "x" * 100_000
        long = [diagnostic("E301", line, 1, text, hint=text) for line in range(1, 501)]
        made = describe.problems(1, long, compiles=False)
        assert {(len(item["text"]), len(item["hint"])) for item in made["list"]} == {(TEXT_MAX + 1, TEXT_MAX + 1)}
        assert len(made["list"]) + made["left_out"]["error"] == 500
        assert len(json.dumps(made, ensure_ascii=False)) < FINDINGS_BYTES_MAX * 1.1

    def test_a_long_repair_is_left_out_whole(self):
        fix = Fix("replace", (Edit(1, 1, 1, 2, "x" * FIX_BYTES_MAX),), safe=True)
        (item,) = describe.problems(1, [diagnostic("E301", 1, 1, "text", fix=fix)], compiles=False)["list"]
        assert "fix" not in item


class TestRun:
    def test_events_are_those_of_json(self):
        run = VirtualRobot("CS66").run('def p():\n  textmsg("a")\n  set_standard_digital_out(1, True)\nend\n')
        records = [record for event in run.events if (record := record_of(event)) is not None]
        assert describe.events(3, run.events, EventBudget()) == {"type": "events", "run": 3, "list": records}
        assert [record["type"] for record in records] == ["log", "signal"]

    def test_options_are_as_the_page_gives_them(self):
        options = RunOptions(robot="CS63", inputs=(SignalInput("flag[0]", True, 0.0),))
        assert describe.run_began(1, 2, options)["options"] == {
            "robot": "CS63",
            "inputs": [{"name": "flag[0]", "value": True, "at_s": 0.0}],
        }

    def test_changed_globals_are_marked(self):
        before = Moment(0.0, 1, SIX, SIX, (Variable("a", "1", "int"), Variable("b", "1", "int")))
        after = Moment(
            0.1, 2, SIX, SIX, (Variable("a", "1", "int"), Variable("b", "2", "int"), Variable("c", "1", "int"))
        )
        assert [item.changed for item in describe.with_changes(after, before).globals] == [False, True, True]
        assert describe.with_changes(after, None) is after

    def test_no_program_has_no_row_in_the_cycle(self):
        assert describe.cycle(1, [(0, 0.0, 1.0, 1), (4, 1.0, 0.0, 1)])["table"] == [
            {"line": 4, "moving_s": 1.0, "standing_s": 0.0, "visits": 1}
        ]


def alarm_of(text):
    robot = VirtualRobot("CS66")
    run = robot.run(text, until_s=10.0)
    (alarm,) = run.alarms
    return describe.alarm_report(alarm, describe.asked_motion(alarm, robot.controller.motion.refused, run.events))


class TestAlarm:
    def test_joints_outside_their_range(self):
        found = alarm_of("def p():\n  movej([0, -1.5, 0, 0, 0, 9])\nend\n")
        assert found["asked_joints"] == [0, -1.5, 0, 0, 0, 9]
        assert found["limit"] == "9 rad, allowed [-6.28319, 6.28319] rad"
        assert (found["t"], found["line"], found["code"]) == (0.0, 2, "R110")

    def test_pose_out_of_reach(self):
        found = alarm_of("def p():\n  movej([0, -1.5, 0.5, -1.5, 0, 0])\n  movel([2, 0.2, 0.3, 0, 0, 0])\nend\n")
        assert found["asked_pose"] == [2, 0.2, 0.3, 0, 0, 0]
        assert found["line"] == 3

    def test_pose_of_the_inverse(self):
        found = alarm_of("def p():\n  movej(get_inverse_kin([9, 0, 0, 0, 0, 0.5]))\nend\n")
        assert found["asked_pose"] == [9, 0, 0, 0, 0, 0.5]
        assert found["hints"] == ["9 looks like millimetres: 9 mm are 0.009 m"]

    def test_limit_of_an_argument(self):
        found = alarm_of("def p():\n  set_standard_digital_out(99, True)\nend\n")
        assert found["limit"].startswith("n: 99, allowed ")
        assert "asked_pose" not in found

    def test_move_that_a_stop_has_ended(self):
        down, stopped = MoveL(SIX, 1.0, 0.1), Alarm(60, "R140", "ProtectiveStop", "text", 3, 0, "main")
        run = VirtualRobot("CS66").run("def p():\n  movej([0, -1.5, 0.5, -1.5, 0, 0])\nend\n")
        events = [event for event in run.events if type(event).__name__ == "MotionStarted"]
        assert describe.asked_motion(stopped, None, events) == events[0].request
        assert describe.asked_motion(stopped, (60, 3, down), events) is down
        assert describe.asked_motion(stopped, (59, 3, down), run.events[:0]) is None

    def test_a_caught_refusal_is_not_the_one_of_a_later_alarm(self):
        found = alarm_of(
            "def p():\n  try:\n    movej([0, -1.5, 0, 0, 0, 9])\n  except:\n    textmsg(1)\n  end\n"
            "  sleep(1)\n  a = 1 / 0\nend\n"
        )
        assert "asked_joints" not in found
