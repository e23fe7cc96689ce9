"""Debugging a robot that lives, in memory: requests are inputs at ticks."""

from __future__ import annotations

import json
from typing import Any

import pytest

from elitescript.debugger.living_breakpoints import digest_of
from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.enums import TaskState
from elitescript.messages.events import TextMessage
from elitescript.messages.inputs import Debug, Do, Input, RunUnit
from elitescript.messages.machine import PauseTask, ResumeTask, StopTask, WriteSignal
from elitescript.messages.outcomes import Debugged, Refused
from elitescript.services.debugging import debugging

COUNT = """def count():
  global n
  n = 0
  while True:
    n = n + 1
    textmsg(n)
    sleep(0.1)
  end
end
"""


class Living:
    """A robot with a debugger."""

    def __init__(self, **options: Any) -> None:
        self.kernel = Kernel(RobotOptions(power_on=True, **options), debugging=debugging())
        self.events: list[dict[str, Any]] = []
        self.said: list[str] = []
        self.last: Any = None
        self._count = 0

    def tick(self, *inputs: Input, count: int = 1) -> None:
        for _ in range(count):
            self.last = self.kernel.tick_and_snapshot(inputs)
            inputs = ()
            self.said += [event.text for event in self.last.events if isinstance(event, TextMessage)]
            for reply in self.last.replies:
                if reply.origin == "ctl#1" and isinstance(reply.outcome, Debugged):
                    self.events.append(json.loads(reply.outcome.text))

    def run(self, text: str = COUNT, origin: str = "primary#1", kind: str = "program") -> None:
        self.tick(RunUnit(origin, kind, text))

    def ask(self, do: str, session: str = "ctl#1", **arguments: Any) -> Any:
        """Ask, in one tick; return the result, or the refusal as a text that begins with `refused: `."""
        self._count += 1
        origin = f"{session}/{self._count}"
        self.tick(Debug(origin, session, json.dumps({"do": do, **arguments})))
        (outcome,) = (reply.outcome for reply in self.last.replies if reply.origin == origin)
        return f"refused: {outcome.reason}" if isinstance(outcome, Refused) else json.loads(outcome.text)["result"]

    def until(self, event: str, ticks: int = 2000) -> dict[str, Any]:
        """Run to the next event of a kind, and forget those before."""
        for _ in range(ticks):
            while self.events:
                found = self.events.pop(0)
                if found["event"] == event:
                    return found
            self.tick()
        raise AssertionError(f"no event {event!r} within {ticks} ticks")

    def stop(self) -> dict[str, Any]:
        stop: dict[str, Any] = self.until("stopped")["stop"]
        return stop

    def rests(self) -> bool:
        """Whether the arm stands for a while."""
        before = self.kernel.controller.joints()
        self.tick(count=20)
        return before == self.kernel.controller.joints()

    @property
    def task(self) -> TaskState:
        return self.kernel.controller.task_state

    @property
    def n(self) -> int:
        return int(self.kernel.host.monitor()["n"])


def test_a_line_breakpoint_pauses_the_task_before_the_line() -> None:
    living = Living()
    living.run()
    states = living.ask("set_breakpoints", requests=[{"line": 6}])
    assert [(state["verified"], state["line"]) for state in states] == [(True, 6)]
    stop = living.stop()
    assert (stop["reason"], stop["thread"], stop["line"], stop["hits"]) == ("breakpoint", 1, 6, [1])
    assert living.task is TaskState.PAUSED
    n, said = living.n, list(living.said)
    living.tick(count=500)
    assert (living.n, living.said) == (n, said)
    assert living.ask("resume") is None
    stop = living.stop()
    assert (living.n, stop["line"], living.said) == (n + 1, 6, [*said, str(n)])


def test_steps() -> None:
    living = Living()
    living.run()
    living.ask("pause")
    assert living.stop()["reason"] == "pause"
    lines = []
    for _ in range(6):
        living.ask("next", thread=1)
        stop = living.stop()
        assert stop["reason"] == "step"
        lines.append(stop["line"])
    assert lines == [4, 5, 6, 7, 4, 5]


def stops(living: Living, count: int) -> list[dict[str, Any]]:
    """The next stops, with `resume` after each but the last one."""
    found = [living.stop()]
    while len(found) < count:
        living.ask("resume")
        found.append(living.stop())
    return found


def test_conditions_and_hit_counts() -> None:
    living = Living()
    living.run()
    living.ask("set_breakpoints", requests=[{"line": 6, "condition": "n % 5 == 0", "hit_condition": ">= 2"}])
    seen = []
    for _ in range(2):
        living.stop()
        seen.append(living.n)
        living.ask("resume")
    assert seen == [10, 15]


def test_a_log_message_stops_nothing() -> None:
    living = Living()
    living.run()
    living.ask("set_breakpoints", requests=[{"line": 6, "log_message": "n is {n}, {{x}} {y}"}])
    texts = []
    while len(texts) < 2:
        output = living.until("output")["output"]
        texts += [output["text"]] if output["category"] == "console" else []
    n = living.n
    assert texts == [
        f"n is {n - 1}, {{x}} <there is no variable 'y' here>",
        f"n is {n}, {{x}} <there is no variable 'y' here>",
    ]
    assert living.task is TaskState.PLAYING


FUNCTIONS = """def job():
  def pick(k):
    set_standard_digital_out(k, True)
    return k
  end
  k = 0
  while True:
    k = (k + 1) % 4
    pick(k)
    sleep(0.1)
    set_standard_digital_out(k, False)
  end
end
"""


def test_functions_and_commands() -> None:
    living = Living()
    living.run(FUNCTIONS)
    living.ask("set_function_breakpoints", requests=[{"name": "pick", "condition": "k == 2"}])
    stop = living.stop()
    assert (stop["reason"], stop["line"]) == ("function breakpoint", 3)
    living.ask("set_function_breakpoints", requests=[{"name": "set_standard_digital_out"}, {"name": "nothing"}])
    lines = []
    for _ in range(3):
        living.ask("resume")
        lines.append(living.stop()["line"])
    assert lines == [11, 3, 11]


def test_looking_at_a_stop() -> None:
    living = Living()
    living.run(FUNCTIONS)
    living.ask("set_breakpoints", requests=[{"line": 4}])
    living.stop()
    living.events.clear()
    frames = living.ask("stack", thread=1)
    assert [(frame["name"].partition(" ")[0], frame["line"]) for frame in frames] == [("pick", 4), ("job", 9)]
    scopes = living.ask("scopes", frame=frames[0]["id"])
    assert [scope["name"] for scope in scopes] == ["Locals", "Globals", "Robot"]
    (variable,) = living.ask("variables", reference=scopes[0]["reference"])
    assert (variable["name"], variable["type"]) == ("k", "int")
    value = living.ask("evaluate", text="k * 10", frame=frames[0]["id"])
    assert value["value"] == str(int(variable["value"]) * 10)
    assert living.ask("evaluate", text="get_standard_digital_out(k)", frame=frames[1]["id"])["value"] == "True"
    assert living.ask("evaluate", text="set_standard_digital_out(7, True)").startswith("refused: ")
    assert living.kernel.controller.read("standard_digital_out", 7) is False
    assert living.ask("stack", thread=9) == "refused: there is no thread 9"


def test_nothing_of_a_stop_is_shown_while_the_program_runs() -> None:
    living = Living()
    living.run()
    assert living.ask("stack", thread=1) == "refused: the program runs; pause it first"
    assert [thread["name"] for thread in living.ask("threads")] == ["main"]
    assert living.ask("evaluate", text="n > 0")["value"] == "True"
    assert living.ask("state")["tick"] == living.kernel.controller.tick
    assert living.ask("resume") == "refused: the program is not stopped"
    assert living.ask("next", thread=1) == "refused: the program is not stopped"


def test_a_change_of_a_signal_by_the_program() -> None:
    living = Living()
    living.run(FUNCTIONS)
    living.ask("set_data_breakpoints", requests=[{"data_id": "standard_digital_out[2]"}])
    stop = living.stop()
    assert (stop["reason"], stop["line"]) == ("data breakpoint", 4)
    (change,) = stop["changes"]
    assert (change["old"], change["new"], change["line"], change["thread_name"]) == ("False", "True", 3, "main")


def test_a_change_of_an_input_by_a_client() -> None:
    living = Living()
    living.run("def job():\n  movej([1, -1.5, 1.5, -1.5, 1.5, 0], a=1, v=0.2)\nend\n")
    living.ask("set_data_breakpoints", requests=[{"data_id": "standard_digital_in[2]"}])
    living.tick(count=20)
    living.tick(Do("client", WriteSignal("standard_digital_in", 2, True)))
    stop = living.stop()
    assert (stop["reason"], stop["changes"][0]["thread_name"], stop["line"]) == ("data breakpoint", "client", 2)
    assert living.task is TaskState.PAUSED


def test_a_change_of_a_global_and_an_expression() -> None:
    living = Living()
    living.run()
    living.ask("set_data_breakpoints", requests=[{"data_id": "n"}, {"data_id": "n >= 5"}])
    lines = [(stop["line"], stop["hits"]) for stop in stops(living, 5)]
    assert lines[0] == (6, [1]) and (6, [1, 2]) in lines


def test_the_arm_below_a_height_while_it_moves() -> None:
    living = Living()
    living.run("def job():\n  p = get_target_tcp_pose()\n  p[2] = p[2] - 0.2\n  movel(p, a=1, v=0.1)\nend\n")
    z = living.kernel.controller.poses().target[2]
    living.ask("set_data_breakpoints", requests=[{"data_id": f"tcp.z < {z - 0.1}"}])
    stop = living.stop()
    assert stop["reason"] == "data breakpoint" and stop["line"] == 4
    assert living.kernel.controller.poses().target[2] == pytest.approx(z - 0.1, abs=0.001)
    living.tick(count=200)
    assert living.rests()
    assert living.kernel.controller.poses().target[2] == pytest.approx(z - 0.1, abs=0.02)


def test_an_alarm_stops_with_its_frames_before_the_program_ends() -> None:
    living = Living()
    living.ask("set_exception_filters", filters=["alarm"])
    living.run("def job():\n  def f(n):\n    return 1 / n\n  end\n  f(0)\nend\n")
    stop = living.stop()
    assert (stop["reason"], stop["line"], stop["exception"]["name"]) == ("exception", 3, "ZeroDivisionError")
    assert living.task is TaskState.PAUSED
    frames = living.ask("stack", thread=1)
    assert [frame["line"] for frame in frames] == [3, 5]
    assert living.ask("evaluate", text="n + 1", frame=frames[0]["id"])["value"] == "1"
    living.ask("resume")
    assert living.until("ended")["result"] == "alarm"
    assert living.task is TaskState.STOPPED


def test_a_warning_stops_before_the_next_statement() -> None:
    living = Living()
    living.ask("set_exception_filters", filters=["warning"])
    assert living.ask("set_exception_filters", filters=["what"]).startswith("refused: a filter is one of")
    code = "def job():\n  x = 100\n  sync()\n  set_tcp([0, 0, x, 0, 0, 0])\n  a = 1\n  b = 2\nend\n"
    living.run(code)
    stop = living.stop()
    assert (stop["reason"], stop["line"], stop["exception"]["code"]) == ("exception", 4, "W231")
    assert living.ask("stack", thread=1)[0]["line"] == 5


SECONDARY = "sec one():\n  global m\n  m = 1\n  m = 2\nend\n"


def test_a_secondary_program_is_held_however_long() -> None:
    living = Living()
    living.run()
    living.ask("set_breakpoints", requests=[{"line": 4}], digest=digest_of(SECONDARY))
    living.run(SECONDARY, origin="primary#2", kind="secondary")
    stop = living.stop()
    assert (stop["line"], [thread["name"] for thread in living.ask("threads")]) == (4, ["main", "sec one"])
    assert living.task is TaskState.PAUSED
    living.tick(count=1000)
    assert living.kernel.host.monitor()["m"] == 1
    living.ask("resume")
    living.tick()
    assert living.kernel.host.monitor()["m"] == 2
    assert living.task is TaskState.PLAYING


def test_a_secondary_program_without_a_program() -> None:
    living = Living()
    living.ask("set_breakpoints", requests=[{"line": 4}], digest=digest_of(SECONDARY))
    living.run(SECONDARY, kind="secondary")
    assert living.stop()["line"] == 4
    living.tick(count=1000)
    assert len(living.ask("threads")) == 1
    living.ask("next", thread=1)
    living.tick(count=3)
    assert living.ask("threads") == []


def test_a_pause_brakes_the_arm_in_the_middle_of_a_move() -> None:
    living = Living()
    living.run("def job():\n  movej([1, -1.5, 1.5, -1.5, 1.5, 0], a=2, v=1)\n  a = 1\n  b = 2\nend\n")
    living.tick(count=100)
    living.ask("pause")
    stop = living.stop()
    assert (stop["reason"], stop["line"]) == ("pause", 2)
    living.tick(count=200)
    assert living.rests()
    assert living.ask("stack", thread=1)[0]["line"] == 2
    living.ask("next", thread=1)
    stop = living.stop()
    assert (stop["reason"], stop["line"]) == ("step", 3)
    assert living.kernel.controller.joints().q_target[0] == pytest.approx(1.0)


def test_a_pause_without_a_program_stops_at_the_first_statement_of_the_next_one() -> None:
    living = Living()
    living.ask("pause")
    living.run()
    assert (living.stop()["line"], living.task) == (3, TaskState.PAUSED)


def test_steps_into_and_out_of_functions() -> None:
    living = Living()
    living.run(FUNCTIONS)
    living.ask("set_breakpoints", requests=[{"line": 9}])
    living.stop()
    lines = []
    for step in ("step_in", "next", "step_out", "next", "next", "step_in", "next"):
        living.ask("set_breakpoints", requests=[])
        living.ask(step, thread=1)
        lines.append(living.stop()["line"])
    assert lines == [3, 4, 10, 11, 7, 8, 9]


THREADS = """def job():
  def other():
    k = 0
    while True:
      k = k + 1
      sync()
    end
  end
  start_thread(other, ())
  movej([1, -1.5, 1.5, -1.5, 1.5, 0], a=1, v=0.5)
  a = 1
  movej([0, -1.5, 1.5, -1.5, 1.5, 0], a=1, v=0.5)
end
"""


def test_a_step_of_one_thread_while_another_one_moves() -> None:
    living = Living()
    living.run(THREADS)
    living.tick(count=10)
    living.ask("pause")
    living.stop()
    lines = []
    for _ in range(4):
        living.ask("next", thread=2)
        stop = living.stop()
        assert stop["thread"] == 2
        lines.append(stop["line"])
    assert lines == [4, 5, 6, 4]
    living.ask("next", thread=1)
    stop = living.stop()
    assert (stop["thread"], stop["line"]) == (1, 11)
    assert living.kernel.controller.joints().q_target[0] == pytest.approx(1.0)


def test_whoever_resumes_the_task_lets_the_program_go_on() -> None:
    living = Living()
    living.run()
    living.ask("set_breakpoints", requests=[{"line": 6}])
    living.stop()
    n = living.n
    living.tick(Do("dashboard#1", ResumeTask()))
    assert living.until("continued") == {"event": "continued"}
    assert living.stop()["line"] == 6
    assert living.n == n + 1


def test_a_task_that_a_client_has_paused_can_be_stopped_and_resumed() -> None:
    living = Living()
    living.run()
    living.tick(Do("dashboard#1", PauseTask()))
    living.ask("pause")
    assert living.stop()["reason"] == "pause"
    living.ask("resume")
    assert living.task is TaskState.PLAYING


def test_a_program_that_is_stopped_may_be_ended() -> None:
    living = Living()
    living.run()
    living.ask("set_breakpoints", requests=[{"line": 6}])
    living.stop()
    living.tick(Do("ctl#2", StopTask()))
    assert living.until("ended")["result"] == "stopped"
    assert living.ask("resume") == "refused: the program is not stopped"
    living.run()
    assert living.stop()["line"] == 6


def test_new_programs_get_the_breakpoints() -> None:
    living = Living()
    text = COUNT.replace("\n", "  \r\n")
    (state,) = living.ask(
        "set_breakpoints", requests=[{"line": 5}], path="/home/me/count.script", digest=digest_of(text)
    )
    assert (state["verified"], state["message"]) == (False, "no program has it yet")
    living.run("def other():\n  a = 1\n  sync()\n  a = 2\n  a = 3\n  a = 4\nend\n")
    living.tick(count=20)
    assert not any(event["event"] == "stopped" for event in living.events)
    living.run()
    assert living.until("breakpoint")["state"]["line"] == 5
    assert living.stop()["line"] == 5
    names = [source["name"] for source in living.ask("sources")]
    assert names == ["<primary#1> (2)", "<primary#1>"]
    assert living.ask("source_text", name=names[0], start=4) == {"text": COUNT[4:], "size": len(COUNT)}
    assert living.ask("source_text", name="what").startswith("refused: there is no program")


def test_one_debugger_at_a_time() -> None:
    living = Living()
    living.run()
    assert living.ask("threads") != []
    assert living.ask("threads", session="ctl#2") == "refused: another debugger is attached: ctl#1"
    assert living.ask("detach", session="ctl#2") == "refused: another debugger is attached: ctl#1"
    assert living.ask("detach") is None
    assert living.ask("threads", session="ctl#2") != []
    assert living.ask("threads") == "refused: another debugger is attached: ctl#2"


@pytest.mark.parametrize("leaves_paused", [False, True])
def test_a_debugger_that_leaves(leaves_paused: bool) -> None:
    living = Living()
    living.run()
    living.ask("set_breakpoints", requests=[{"line": 6}])
    living.stop()
    assert living.ask("detach", leaves_paused=leaves_paused) is None
    assert living.task is (TaskState.PAUSED if leaves_paused else TaskState.PLAYING)
    if leaves_paused:
        living.tick(Do("dashboard#1", ResumeTask()))
    n = living.n
    living.tick(count=100)
    assert living.n > n + 3
    assert living.kernel._debugging is not None and living.kernel._debugging.debugger is None


def test_a_resume_that_the_safety_system_refuses() -> None:
    living = Living()
    living.run()
    living.ask("set_breakpoints", requests=[{"line": 6}])
    living.stop()
    living.tick(Do("ctl", WriteSignal("safeguard_stop", 0, True)))
    answer = living.ask("resume")
    assert answer.startswith("refused: ") and "safeguard" in answer
    assert living.ask("stack", thread=1)[0]["line"] == 6
    living.tick(Do("ctl", WriteSignal("safeguard_stop", 0, False)))
    assert living.task is TaskState.PAUSED
    living.ask("resume")
    assert living.stop()["line"] == 6


def test_a_debugger_that_leaves_while_the_safeguard_is_open() -> None:
    living = Living()
    living.run()
    living.ask("set_breakpoints", requests=[{"line": 6}])
    living.stop()
    living.tick(Do("ctl", WriteSignal("safeguard_stop", 0, True)))
    assert living.ask("detach") is None
    assert living.task is TaskState.PAUSED
    living.tick(Do("ctl", WriteSignal("safeguard_stop", 0, False)), Do("ctl", ResumeTask()))
    n = living.n
    living.tick(count=100)
    assert living.n > n + 3


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{",
        '{"do": "take"}',
        '{"do": "__init__"}',
        '{"do": 3}',
        '{"do": "next"}',
        '{"do": "next", "thread": "1"}',
        '{"do": "stack", "thread": 1, "more": 2}',
        '{"do": "set_breakpoints", "requests": [{"line": 0.5}]}',
        "[" * 10_000,
    ],
)
def test_requests_that_make_no_sense_are_refused(text: str) -> None:
    living = Living()
    living.tick(Debug("ctl#1/1", "ctl#1", text))
    (reply,) = living.last.replies
    assert isinstance(reply.outcome, Refused) and reply.outcome.reason


def test_changes_at_a_stop() -> None:
    living = Living()
    living.run(FUNCTIONS)
    living.ask("set_breakpoints", requests=[{"line": 4}])
    living.stop()
    (inner, outer) = living.ask("stack", thread=1)
    (scope, *_) = living.ask("scopes", frame=inner["id"])
    assert living.ask("set_variable", reference=scope["reference"], name="k", text="40 + 2")["value"] == "42"
    (inner, outer) = living.ask("stack", thread=1)
    assert living.ask("evaluate", text="k", frame=inner["id"])["value"] == "42"
    assert living.ask("set_expression", target="k", text="2", frame=outer["id"])["value"] == "2"
    (inner, outer) = living.ask("stack", thread=1)
    assert living.ask("evaluate", text="set_standard_digital_out(6, True)", frame=inner["id"], may_change=True)
    assert living.kernel.controller.read("standard_digital_out", 6) is True
    assert living.task is TaskState.PAUSED
    living.ask("resume")
    stop = living.stop()
    (inner, _) = living.ask("stack", thread=1)
    assert (stop["line"], living.ask("evaluate", text="k", frame=inner["id"])["value"]) == (4, "3")


def test_nothing_that_a_user_runs_may_wait() -> None:
    living = Living()
    living.run()
    living.ask("set_breakpoints", requests=[{"line": 6}])
    living.stop()
    (frame,) = living.ask("stack", thread=1)
    for text in ("sleep(1)", "movej([0, -1.5, 0, -1.5, 0, 0])", "[0 for k in iter(int, 1)]", "sync()"):
        answer = living.ask("evaluate", text=text, frame=frame["id"], may_change=True)
        assert str(answer).startswith("refused: "), text
        (frame,) = living.ask("stack", thread=1)
    assert living.rests()
    living.ask("resume")
    assert living.stop()["line"] == 6


@pytest.mark.parametrize(
    "text",
    [
        "raise SystemExit",
        "raise GeneratorExit",
        "class E(BaseException):\n  pass\nend\nraise E()",
        "class E(Exception):\n  def __str__(self):\n    while True:\n      pass\n    end\n  end\nend\nraise E()",
    ],
)
def test_no_exception_of_a_user_ends_the_robot(text) -> None:
    living = Living()
    living.run()
    living.ask("set_breakpoints", requests=[{"line": 6}])
    living.stop()
    (frame,) = living.ask("stack", thread=1)
    answer = living.ask("evaluate", text=text, frame=frame["id"], may_change=True)
    assert str(answer).startswith("refused: "), answer
    living.ask("resume")
    assert living.stop()["line"] == 6


def test_signals_are_set_at_any_time() -> None:
    living = Living()
    assert living.ask("set_signal", name="standard_digital_in[3]", text="True")["value"] == "True"
    assert living.kernel.controller.read("standard_digital_in", 3) is True
    assert living.ask("set_signal", name="standard_digital_in[99]", text="True").startswith("refused: ")
    living.run()
    assert living.ask("set_signal", name="input_float_register[1]", text="1.5")["value"] == "1.5"
    assert living.task is TaskState.PLAYING


def test_what_can_be_watched() -> None:
    living = Living()
    living.run()
    assert living.ask("data_breakpoint_info", name="standard_digital_in[3]")["data_id"] == "standard_digital_in[3]"
    assert living.ask("data_breakpoint_info", name="n >")["data_id"] is None
    living.ask("pause")
    scopes = living.ask("scopes", frame=0)
    assert living.ask("data_breakpoint_info", name="n", reference=scopes[0]["reference"])["data_id"] == "n"


def test_breakpoint_locations() -> None:
    living = Living()
    assert living.ask("breakpoint_locations", line=5) == []
    living.run()
    places = living.ask("breakpoint_locations", line=5, end_line=6)
    assert [(place["line"], place["column"]) for place in places] == [(5, 5), (6, 5)]


def test_a_secondary_program_in_a_task_that_a_client_has_paused() -> None:
    living = Living()
    living.run()
    living.ask("set_breakpoints", requests=[{"line": 4}], digest=digest_of(SECONDARY))
    living.tick(Do("dashboard#1", PauseTask()))
    living.run(SECONDARY, origin="primary#2", kind="secondary")
    assert living.stop()["line"] == 4
    living.ask("resume")
    living.tick()
    assert (living.kernel.host.monitor()["m"], living.task) == (2, TaskState.PAUSED)


def test_a_step_at_the_end_of_a_thread() -> None:
    living = Living()
    living.ask("set_breakpoints", requests=[{"line": 3}])
    living.run(
        "def job():\n  def other():\n    a = 1\n  end\n  start_thread(other, ())\n"
        "  while True:\n    sync()\n  end\nend\n"
    )
    assert living.stop()["thread"] == 2
    living.ask("next", thread=2)
    stop = living.stop()
    assert (stop["reason"], stop["text"], stop["thread"]) == ("step", "thread 'other' has ended", 1)


def test_long_lists_come_in_parts() -> None:
    living = Living()
    living.run("def job():\n  global items\n  items = list(range(5000))\n  sleep(1)\n  a = 1\nend\n")
    living.ask("pause")
    (group, _) = living.ask("scopes", frame=0)
    (items,) = living.ask("variables", reference=group["reference"])
    assert items["indexed"] == 5000
    *part, more = living.ask("variables", reference=items["reference"])
    assert (len(part), more["name"], more["value"]) == (100, "…", "… 4,900 more")
    *part, more = living.ask("variables", reference=items["reference"], count=3000)
    assert (len(part), more["value"]) == (1000, "… 4,000 more")
    (last,) = living.ask("variables", reference=items["reference"], kind="indexed", start=4999, count=3)
    assert (last["name"], last["value"]) == ("[4999]", "4999")
