"""Long programs of clients are compiled elsewhere, and begin in the tick in which they come back."""

from __future__ import annotations

import re

import pytest

from elitescript.environment.memory import MemoryFiles
from elitescript.environment.request_channels import RequestEnvironment
from elitescript.kernel import Kernel, RobotOptions
from elitescript.kernel.compiling import CompilesHere, Job
from elitescript.kernel.options import IN_VIRTUAL_TIME
from elitescript.language import limits
from elitescript.language.limits import LINES_MAX, LONG_TEXT
from elitescript.lint.engine import CheckResult
from elitescript.messages.events import Alarm, TaskStateChanged, TextMessage, Warned
from elitescript.messages.inputs import Compiled, Do, LoadTask, PlayTask, Reboot, RunUnit
from elitescript.messages.machine import AskSafety, StopTask
from elitescript.messages.outcomes import Done, Refused
from elitescript.services.compiler.jobs import job_bytes, read_job

FILLER = "\n".join(f"  x = {number}" for number in range(LONG_TEXT // 8))


def program(name: str, body: str = "textmsg('{name} runs')\n  while True:\n    sync()\n  end") -> str:
    return f"def {name}():\n{FILLER}\n  {body.format(name=name)}\nend"


LONG = program("long")
SHORT = "def short():\n  textmsg('short runs')\n  while True:\n    sync()\n  end\nend"
SEC = f"sec beside():\n{FILLER}\n  textmsg('beside runs')\nend"


class Shelf:
    """A workshop that keeps what it gets until the test says that it is back."""

    def __init__(self) -> None:
        self.jobs: list[Job] = []
        self.dropped: list[int] = []
        self.here: CompilesHere | None = None

    def begin(self, job: Job) -> None:
        self.jobs.append(job)
        assert self.here is not None
        self.here.begin(job)

    def result(self, number: int) -> CheckResult | None:
        assert self.here is not None
        return self.here.result(number)

    def drop(self, number: int) -> None:
        self.dropped.append(number)


class Robot:
    """A kernel, and what has happened in it."""

    def __init__(self, files: dict[str, bytes] | None = None, **options) -> None:
        self.shelf = Shelf()
        chosen = {**IN_VIRTUAL_TIME, "compiles_elsewhere": True, **options}
        environment = RequestEnvironment(MemoryFiles(files or {}))
        self.kernel = Kernel(RobotOptions(**chosen), environment, workshop=self.shelf)
        self.shelf.here = CompilesHere(self.kernel.profile, self.kernel.model, RobotOptions(**chosen).ignored)
        self.said: list[str] = []
        self.replies: list[tuple[str, object]] = []
        self.alarms: list[str] = []

    def tick(self, *inputs, count: int = 1) -> list[str]:
        """Run ticks, the first with inputs; return what was said in them."""
        before = len(self.said)
        for at in range(count):
            result = self.kernel.tick(inputs if at == 0 else ())
            for event in result.events:
                if isinstance(event, TextMessage | Warned):
                    self.said.append(event.text)
                elif isinstance(event, TaskStateChanged):
                    self.said.append(f"{event.state.name} {event.name}".lower())
                elif isinstance(event, Alarm):
                    self.alarms.append(f"{event.code} {event.line}: {event.text}")
            self.replies += [(reply.origin, reply.outcome) for reply in result.replies]
        return self.said[before:]


def sent(text: str, kind: str = "program", origin: str = "primary#1") -> RunUnit:
    return RunUnit(origin, kind, text)


def test_begins_in_the_tick_in_which_it_comes_back_and_the_robot_goes_on_meanwhile():
    robot = Robot()
    assert robot.tick(sent(SHORT, origin="primary#2")) == ["playing short", "short runs"]
    assert robot.tick(sent(LONG), count=20) == []
    assert robot.kernel.due_tick() == robot.kernel.next_tick
    assert robot.tick(Compiled("compiler", robot.shelf.jobs[0].number)) == [
        "stopped short",
        "playing long",
        "long runs",
    ]


def test_a_short_text_and_any_text_without_the_option_are_compiled_at_once():
    assert "long runs" in Robot(compiles_elsewhere=False).tick(sent(LONG))
    robot = Robot()
    assert "short runs" in robot.tick(sent(SHORT))
    assert robot.shelf.jobs == []


def test_does_not_compile_is_an_alarm_when_it_comes_back_and_leaves_the_running_program_alone():
    robot = Robot()
    robot.tick(sent(SHORT))
    robot.tick(sent(program("bad", "x = (")))
    assert robot.tick(Compiled("compiler", robot.shelf.jobs[0].number)) == []
    assert [alarm.split(":")[0] for alarm in robot.alarms] == [f"E001 {FILLER.count(chr(10)) + 3}"]
    assert robot.kernel.host.is_running


def test_what_could_not_be_compiled_is_refused_with_the_reason():
    robot = Robot()
    robot.tick(sent(LONG))
    robot.tick(Compiled("compiler", robot.shelf.jobs[0].number, "its compiler was killed"))
    assert robot.alarms == ["E001 1: its compiler was killed"]
    assert robot.shelf.dropped == [robot.shelf.jobs[0].number]
    assert not robot.kernel.host.is_running


def test_too_many_lines_are_refused_in_the_tick_in_which_they_come():
    robot = Robot()
    robot.tick(sent(f"def long():\n{'  a = 1' + chr(10)}" + "  a = 1\n" * LINES_MAX + "end"))
    assert robot.alarms == ["E001 200001: the program has 200,003 lines, at most 200,000 are read"]
    assert robot.shelf.jobs == []


def test_too_many_words_and_signs_are_refused_before_the_text_comes_back(monkeypatch):
    monkeypatch.setattr(limits, "SYMBOLS_MAX", 2_000)
    monkeypatch.setattr(limits, "_CHUNK", 4_000)
    robot = Robot()
    robot.tick(sent(SHORT))
    parts = -(-len(LONG) // 4_000)
    assert parts > 2
    robot.tick(sent(LONG), count=parts)
    assert robot.alarms == []
    robot.tick()
    (alarm,) = robot.alarms
    assert re.fullmatch(r"E001 \d+: the program has 3,\d+ words and signs, at most 2,000 are read", alarm)
    assert robot.shelf.dropped == [robot.shelf.jobs[0].number]
    assert robot.kernel.host.is_running
    assert "long runs" not in robot.tick(Compiled("compiler", robot.shelf.jobs[0].number), count=3)


@pytest.mark.parametrize(
    ("inputs", "why"),
    [
        ([Do("dashboard#1", StopTask())], "the task was stopped"),
        ([sent("set_standard_digital_out(0, True)", "line")], "another program was started"),
        ([sent(SHORT, origin="primary#2")], "another program was started"),
        ([Do("ctl", AskSafety("violate", ""))], "the safety system has stopped the robot"),
        ([Reboot("dashboard#1")], "the controller was started anew"),
    ],
)
def test_what_ends_or_replaces_a_program_ends_one_that_is_being_compiled(inputs, why):
    robot = Robot()
    robot.tick(sent(LONG))
    said = robot.tick(*inputs, count=3)
    number = robot.shelf.jobs[0].number
    assert f"the program `long` from primary#1 does not begin: {why} while it was being compiled" in said
    assert robot.shelf.dropped == [number]
    assert "long runs" not in robot.tick(Compiled("compiler", number), count=3)


def test_a_secondary_program_begins_beside_whatever_runs_then():
    robot = Robot()
    robot.tick(sent(SEC, "secondary"))
    robot.tick(sent(SHORT))
    assert "beside runs" in robot.tick(Compiled("compiler", robot.shelf.jobs[0].number), count=3)
    assert robot.kernel.host.is_running


def test_two_at_once_come_back_in_order_and_the_later_one_replaces_the_earlier():
    robot = Robot()
    robot.tick(sent(LONG), sent(program("second"), origin="primary#2"))
    first, second = (job.number for job in robot.shelf.jobs)
    assert robot.tick(Compiled("compiler", first)) == ["playing long", "long runs"]
    assert robot.tick(Compiled("compiler", second)) == ["stopped long", "playing second", "second runs"]
    assert robot.shelf.dropped == []


def test_so_many_may_wait_and_no_more():
    robot = Robot()
    robot.tick(*(sent(program(f"p{number}")) for number in range(5)))
    assert len(robot.shelf.jobs) == 4
    assert robot.alarms == ["E001 1: 4 programs are being compiled already"]


def test_says_after_two_seconds_that_it_is_being_compiled():
    robot = Robot()
    robot.tick(sent(LONG))
    assert robot.tick(count=499) == []
    lines = LONG.count("\n") + 1
    told = [f"the program `long` from primary#1 is being compiled: {lines:,} lines, {len(LONG):,} characters"]
    assert robot.tick(count=600) == told


class TestTasks:
    def playing(self) -> Robot:
        robot = Robot({"long.script": LONG.encode()})
        robot.tick(LoadTask("d/1", "long.script"))
        robot.tick(PlayTask("d/2"))
        robot.replies.clear()
        return robot

    def test_the_reply_comes_when_it_begins(self):
        robot = self.playing()
        robot.tick(count=10)
        assert robot.replies == []
        assert "playing long" in robot.tick(Compiled("compiler", robot.shelf.jobs[0].number))
        robot.tick()
        assert robot.replies == [("d/2", Done())]

    def test_or_after_two_seconds_and_what_comes_of_it_is_in_the_log(self):
        robot = self.playing()
        robot.tick(count=501)
        assert robot.replies == [("d/2", Done())]
        robot.tick(Do("ctl", AskSafety("violate", "")))
        assert not robot.kernel.host.is_running
        robot.tick(Compiled("compiler", robot.shelf.jobs[0].number), count=2)
        assert robot.replies == [("d/2", Done())]

    def test_a_stop_is_its_refusal(self):
        robot = self.playing()
        robot.tick(Do("d/3", StopTask()), count=2)
        assert robot.replies == [("d/2", Refused("the task was stopped before its program was compiled"))]
        assert robot.tick(Compiled("compiler", robot.shelf.jobs[0].number), count=2) == []

    def test_nothing_else_is_loaded_or_played_meanwhile(self):
        robot = self.playing()
        robot.tick(PlayTask("d/3"), LoadTask("d/4", "long.script"))
        assert robot.replies == [
            ("d/3", Refused("the program of the task is being compiled")),
            ("d/4", Refused("the program of the task is being compiled; stop it first")),
        ]


def test_compiled_here_it_is_the_same_as_at_once():
    """As a replay does it."""
    plain = Robot(compiles_elsewhere=False)
    robot = Robot()
    robot.tick(sent(LONG))
    assert robot.tick(Compiled("compiler", 1), count=5) == plain.tick(sent(LONG), count=5)


def test_findings_with_ignored_codes_are_left_out_of_long_and_short_texts():
    long, short = program("long", "get_flag(0)"), "def short():\n  get_flag(0)\nend"
    for options, expected in (({}, 2), ({"ignore": "W219"}, 0)):
        robot = Robot(**options)
        robot.tick(sent(short))
        robot.tick(sent(long))
        robot.tick(Compiled("compiler", robot.shelf.jobs[0].number))
        assert sum("only gives a value" in text for text in robot.said) == expected


def test_a_long_graphical_program_is_generated_elsewhere_too():
    """Nothing of its tree is read between two ticks; the reply comes when the program begins."""
    step = '<WaitNode type="WAIT_TIME"><waitTime value="0.5" unit="S"/></WaitNode>'
    steps = step * (LONG_TEXT // len(step) + 1)
    text = f'<EliTask name="cell" installationName="i"><MainTask isTaskAlwaysLoops="false">{steps}</MainTask></EliTask>'
    files = {"cell.task": text.encode(), "i.configuration.variables": b"<VariablesManager/>"}
    robot = Robot(files, power_on=True)
    robot.tick(LoadTask("dashboard#1/1", "cell.task"))
    robot.tick(PlayTask("dashboard#1/2"), count=3)
    (job,) = robot.shelf.jobs
    assert job.is_tree
    assert "i.configuration.variables" in job.text
    assert read_job(job_bytes(job)) == job
    assert [origin for origin, _ in robot.replies] == ["dashboard#1/1"]
    assert "playing cell" in robot.tick(Compiled("compiler", job.number))
    assert robot.replies[-1] == ("dashboard#1/2", Done())
    assert robot.kernel.host.source.place(26) == "1 Robot Main Task > 4 Wait"
