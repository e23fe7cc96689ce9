"""Tasks, configurations and variables."""

from __future__ import annotations

from typing import Any

import pytest

from elitescript.environment.memory import MemoryEnvironment
from elitescript.messages.enums import TaskState
from elitescript.messages.events import Alarm, TaskStateChanged, Warned
from elitescript.messages.inputs import GetVariable, LoadConfiguration, LoadTask, PlayTask, Reboot, SetVariable
from elitescript.messages.machine import AskSafety, PauseTask, StopTask
from elitescript.messages.outcomes import Done, Refused, ShownValue
from tests.kernel.machine import FOREVER, READY, Session

TREE = b"""<EliTask name="tree" installationName="tree" robotType="CS66"><MainTask isTaskAlwaysLoops="false">
<ScriptNode scriptType="LINE_TYPE"><Expression><ExpressionTokenCell scriptCode="textmsg(greeting)"/></Expression>
</ScriptNode>
</MainTask></EliTask>"""
FILES = {
    "tree.task": TREE,
    "tree.script": b"textmsg('an older one')\n",
    "tree.configuration.variables": b"""<VariablesManager>
<Variable name="greeting" value="&quot;hello&quot;"/></VariablesManager>""",
    "untaught.task": b"<EliTask><MainTask><MoveNode><WaypointNode/></MoveNode></MainTask></EliTask>",
    "beside.task": b"<task/>",
    "beside.script": b"def beside():\n  textmsg('beside')\nend\n",
    "sub/inner.task": b"<task/>",
    "sub/inner.task.script": b"textmsg('inner')\n",
    "empty.task": b"<task/>",
    "broken.script": b"def broken():\n  x = 1 +\nend\n",
    "latin.script": b"textmsg('\xe4')\n",
    "endless.script": b"def endless():\n  while True:\n    sync()\n  end\nend\n",
    "cell.configuration": b"",
    "sub/LOUD.SCRIPT": b"textmsg('loud')\n",
    "loud.task": b"<task/>",
    "loud.Script": b"def p():\n  textmsg('Loud')\nend\n",
}


@pytest.fixture
def session() -> Session:
    return Session(READY, MemoryEnvironment(FILES))


def answer(session: Session, item) -> Any:
    (reply,) = session.send(item).replies
    assert reply.origin == item.origin
    return reply.outcome


def load(session: Session, path: str) -> Any:
    return answer(session, LoadTask("dashboard#1/1", path))


def play(session: Session) -> Any:
    return answer(session, PlayTask("dashboard#1/2"))


class TestLoading:
    @pytest.mark.parametrize(
        "path",
        [
            "tree.task",
            "beside.task",
            "sub/inner.task",
            "beside",
            "beside.script",
            "sub/LOUD.task",
            "sub/LOUD.SCRIPT",
            "loud.task",
        ],
    )
    def test_what_is_loaded_is_shown_as_it_was_sent(self, session, path):
        assert load(session, path) == Done()
        assert session.last.snapshot.task.loaded == path

    @pytest.mark.parametrize(
        ("path", "why"),
        [
            ("empty.task", "has no program"),
            ("no.script", "it holds beside.script, broken.script, endless.script, latin.script, loud.Script"),
            ("no.task", "does not exist"),
            ("../beside.task", "task folder"),
        ],
    )
    def test_what_cannot_be_loaded_is_refused_and_nothing_changes(self, session, path, why):
        load(session, "beside.task")
        assert why in load(session, path).reason
        assert session.last.snapshot.task.loaded == "beside.task"

    def test_nothing_is_loaded_while_a_task_runs(self, session):
        session.start(FOREVER)
        assert load(session, "beside.task") == Refused("a task is running; stop it first")

    def test_a_robot_without_a_folder_has_no_tasks(self):
        assert isinstance(load(Session(READY), "beside.task"), Refused)

    def test_configurations_are_files_too(self, session):
        assert session.tick().snapshot.task.configuration == "default.configuration"
        assert answer(session, LoadConfiguration("dashboard#1/1", "cell.configuration")) == Done()
        assert session.last.snapshot.task.configuration == "cell.configuration"
        assert isinstance(answer(session, LoadConfiguration("dashboard#1/1", "no.configuration")), Refused)


class TestPlaying:
    @pytest.mark.parametrize(("path", "text"), [("beside.task", "beside"), ("sub/inner.task", "inner")])
    def test_the_program_beside_the_task_runs(self, session, path, text):
        load(session, path)
        assert play(session) == Done()
        assert session.texts == [text]

    def test_the_script_of_a_graphical_program_runs_whatever_stands_beside_it(self, session):
        load(session, "tree.task")
        assert play(session) == Done()
        assert session.texts == ["hello"]

    def test_a_graphical_program_that_cannot_be_generated_is_refused(self, session):
        load(session, "untaught.task")
        assert "the waypoint has never been taught" in play(session).reason

    def test_the_snapshot_of_the_answer_shows_that_it_runs(self, session):
        load(session, "endless.task")
        play(session)
        snapshot = session.last.snapshot
        assert (snapshot.robot.task_state, snapshot.task.running) == (TaskState.PLAYING, "endless")

    def test_a_paused_task_goes_on(self, session):
        load(session, "endless.task")
        play(session)
        session.do(PauseTask())
        assert play(session) == Done()
        assert session.last.snapshot.robot.task_state is TaskState.PLAYING

    def test_what_runs_is_not_played_again(self, session):
        load(session, "endless.task")
        play(session)
        assert play(session) == Refused("a task is running; stop it first")

    def test_without_a_task_there_is_nothing_to_play(self, session):
        assert play(session) == Refused("no task is loaded")

    def test_the_arm_needs_its_power(self):
        session = Session(world=MemoryEnvironment(FILES))
        load(session, "beside.task")
        assert play(session) == Refused("the arm cannot move: the arm is switched off; power on and release the brakes")

    def test_a_stop_of_the_safety_system_is_named(self, session):
        load(session, "beside.task")
        session.do(AskSafety("stop_protectively", "a test"))
        assert "unlock" in play(session).reason

    @pytest.mark.parametrize("path", ["broken.task", "latin.task"])
    def test_a_program_that_does_not_compile_is_refused_and_reported(self, session, path):
        load(session, path)
        assert play(session).reason.startswith("the program does not compile: line ")
        assert len(session.of(Alarm)) == 1
        assert session.last.snapshot.robot.task_state is TaskState.STOPPED


class TestVariables:
    def put(self, session, name, value):
        return answer(session, SetVariable("dashboard#1/3", name, value))

    def get(self, session, name):
        return answer(session, GetVariable("dashboard#1/4", name))

    def test_a_value_waits_for_the_next_program(self, session):
        assert self.put(session, "speed", "[1, 2.5]") == Done()
        assert self.get(session, "speed") == ShownValue("[1, 2.5]")
        session.start("textmsg(speed)")
        assert session.texts == ["[1, 2.5]"]

    def test_globals_of_the_program_are_read_while_it_runs_and_afterwards(self, session):
        session.start("global n", "n = 7", FOREVER)
        assert self.get(session, "n") == ShownValue("7")
        session.do(StopTask())
        assert self.get(session, "n") == ShownValue("7")

    @pytest.mark.parametrize("value", ["", "open(", "__import__('os')", "(" * 500])
    def test_only_literals_are_values(self, session, value):
        assert self.put(session, "n", value).reason.startswith("its value must be a literal")

    @pytest.mark.parametrize("name", ["", "1a", "if", "__builtins__"])
    def test_only_names_are_names(self, session, name):
        assert self.put(session, name, "1") == Refused("it cannot be the name of a variable")

    def test_they_are_bounded(self, session):
        for number in range(1000):
            session.kernel.tick([SetVariable("x", f"n{number}", "1")])
        assert self.put(session, "n1000", "1") == Refused("1000 variables wait already")

    def test_they_are_not_set_while_a_program_runs(self, session):
        session.start(FOREVER)
        assert self.put(session, "n", "1").reason.startswith("a task is running")

    def test_an_unknown_one_is_refused(self, session):
        assert self.get(session, "n") == Refused("there is no such variable")

    def test_a_value_that_cannot_be_shown_is_refused(self, session):
        lines = ("class C:", "  def __repr__(self):", "    movej([0, 0, 0, 0, 0, 0])", "    while True:", "      pass")
        session.start(*lines, "global n", "n = C()", FOREVER)
        assert self.get(session, "n") == Refused("its value cannot be shown")

    def test_a_long_value_is_cut(self, session):
        session.start("global n", "n = 'x' * 100000", FOREVER)
        text = self.get(session, "n").text
        assert text.endswith("...") and len(text) < 5000

    def test_a_reboot_forgets_everything(self, session):
        load(session, "beside.task")
        self.put(session, "n", "1")
        session.send(Reboot("ctl"))
        assert session.last.snapshot.task.loaded == ""
        assert isinstance(self.get(session, "n"), Refused)


class TestTrees:
    """Graphical programs of the task folder."""

    STEP = (
        '<ScriptNode scriptType="LINE_TYPE" typeName="Script"><Expression><ExpressionTokenCell scriptCode="{}"/>'
        "</Expression></ScriptNode>"
    )

    def tree(self, *lines: str, name: str = "cell", given: str = "") -> bytes:
        steps = "".join(self.STEP.format(line) for line in lines)
        body = f'<MainTask isTaskAlwaysLoops="false" typeName="Robot Main Task">{steps}</MainTask>'
        return f'<EliTask name="{name}" {given}>{body}</EliTask>'.encode()

    def test_alarms_and_findings_name_the_node(self):
        session = Session(READY, MemoryEnvironment({"a.task": self.tree("x = [1][3]")}))
        load(session, "a.task")
        play(session)
        (alarm,) = session.of(Alarm)
        assert alarm.details["node"] == "1 Robot Main Task > 2 Script"
        (found,) = [event for event in session.of(Warned) if event.code == "W265"]
        assert found.text.startswith("1 Robot Main Task > 2 Script: `[1]` has")

    def test_a_node_that_cannot_be_generated_is_named(self):
        session = Session(READY, MemoryEnvironment({"a.task": self.tree("")}))
        load(session, "a.task")
        assert "1 Robot Main Task > 2 Script (script line " in play(session).reason
        (alarm,) = session.of(Alarm)
        assert alarm.text.startswith("1 Robot Main Task > 2 Script (script line ")

    def test_a_broken_file_has_its_place(self):
        session = Session(READY, MemoryEnvironment({"a.task": b"<EliTask>\n<MainTask>\n</EliTask>"}))
        load(session, "a.task")
        assert "no XML" in play(session).reason
        (alarm,) = session.of(Alarm)
        assert (alarm.code, alarm.line) == ("E004", 3)

    def test_names_in_chinese_and_folders(self):
        variables = '<VariablesManager><Variable name="问候" value="&quot;好&quot;"/></VariablesManager>'.encode()
        files = {
            "单元/取料.task": self.tree(
                "textmsg(问候)", name="取料", given='installationName="安装" installationDirectory="/配置/一"'
            ),
            "配置/一/安装.configuration.variables": variables,
        }
        session = Session(READY, MemoryEnvironment(files))
        assert load(session, "单元/取料.task") == Done()
        assert play(session) == Done()
        assert session.texts == ["好"]
        name = session.of(TaskStateChanged)[0].name
        assert name == "取料"
        assert answer(session, GetVariable("dashboard#1/4", "问候")) == ShownValue("'好'")

    def test_what_is_in_the_file_when_it_is_played_runs(self):
        environment = MemoryEnvironment({"a.task": self.tree("textmsg(1)")})
        session = Session(READY, environment)
        load(session, "a.task")
        with environment.files.open("a.task", "wb", None, None) as file:
            file.write(self.tree("textmsg(2)"))
        play(session)
        assert session.texts == ["2"]
