"""A debugged run: steps, breakpoints of each kind in both directions, looking, changes, and what it leaves behind."""

from __future__ import annotations

import contextlib
import gc
import hashlib
import os
import pickle
import sys
import weakref
from linecache import getline

import pytest

from elitescript.debugger.api import (
    AT_END,
    DataBreakpoint,
    FunctionBreakpoint,
    LineBreakpoint,
)
from elitescript.debugger.engine import Engine
from elitescript.errors import DebugError
from elitescript.robot import VirtualRobot
from tests.debugger.sessions import at_entry, debugging, everything, lines, variables

PICK = """def job():
  global total
  total = 0
  def pick(n):
    global total
    total = total + n
    movej([0.1 * n, -1.57, -1.57, -1.57, 1.57, 0])
    return n
  end
  def work():
    for k in range(3):
      set_standard_digital_out(k, True)
      sleep(0.1)
    end
  end
  start_thread(work, ())
  for n in range(3):
    pick(n)
  end
  textmsg("total ", total)
end
"""


class TestSteps:
    def test_next_goes_over_calls_and_moves(self):
        with at_entry(PICK) as session:
            stops = [session.next(1) for _ in range(7)]
            assert lines(stops) == [4, 10, 16, 17, 18, 18, 18]
            assert stops[-1].time_s > 0.5  # two moves
            assert variables(session)["n"] == "2"

    def test_step_in_and_out(self):
        with at_entry(PICK) as session:
            session.set_breakpoints([LineBreakpoint(18)])
            session.resume()
            assert session.step_in(1).line == 6
            assert [frame.name for frame in session.stack(1)] == ["pick", "job"]
            stop = session.step_out(1)
            assert stop.line == 18 and [frame.name for frame in session.stack(1)] == ["job"]

    def test_back_is_over_calls_and_at_the_first_statement_to_the_caller(self):
        with at_entry(PICK) as session:
            session.set_breakpoints([LineBreakpoint(6, condition="n == 1")])
            here = session.resume()
            assert lines([session.step_back(1) for _ in range(4)]) == [18, 18, 17, 16]
            session.run_to(here.position)
            assert session.step_back(1).line == 18

    def test_a_thread_steps_while_another_one_moves(self):
        with at_entry(PICK) as session:
            session.set_breakpoints([LineBreakpoint(12)])
            stop = session.resume()
            assert stop.thread == 2
            session.set_breakpoints([])
            stops = [session.next(2) for _ in range(5)]
            assert lines(stops) == [13, 12, 13, 12, 13]
            assert {stop.thread for stop in stops} == {2}
            assert stops[-1].time_s == pytest.approx(0.2)
            main = session.threads()[0]
            assert (main.line, main.waits_for != "") == (7, True)

    def test_the_end_of_a_thread_ends_its_step(self):
        with at_entry(PICK) as session:
            session.set_breakpoints([LineBreakpoint(13, condition="k == 2")])
            session.resume()
            session.set_breakpoints([])
            stop = session.next(2)
            assert stop.thread == 1 and "thread 2 has ended" in stop.text

    def test_back_from_the_end(self):
        with debugging(PICK) as session:
            end = session.start()
            assert (end.reason, end.result, end.position.kind) == ("end", "finished", AT_END)
            assert session.threads() == ()
            assert session.step_back(1).line == 20
            assert session.resume() == end

    def test_secondary_programs_are_threads(self):
        text = 'def job():\n  exec("a = 1")\n  sync()\n  textmsg(1)\nend\n'
        with at_entry(text) as session:
            assert [thread.name for thread in session.threads()] == ["main"]
        with at_entry(
            "sec one():\n  set_standard_digital_out(1, True)\n  set_standard_digital_out(2, True)\nend\n"
        ) as sec:
            assert [(thread.name, thread.is_secondary) for thread in sec.threads()] == [("sec one", True)]
            assert sec.next(1).line == 3

    def test_to_a_time_and_back(self):
        with at_entry(PICK) as session:
            stop = session.run_to_time(1.0)
            assert (stop.time_s, stop.position.kind, stop.thread) == (1.0, "tick", 0)
            joints = session.state().joints
            assert abs(joints[2]) > 0.0 and session.stack(1)[0].name.startswith("pick (waits for ")
            session.run_to_time(2.0)
            session.run_to_time(1.0)
            assert session.state().joints == joints
            assert session.step_back(1).line == 7

    def test_passes_and_the_last_one(self):
        with debugging(PICK) as session:
            session.start()
            passes = session.passes(6)
            assert len(passes) == 3
            assert session.last_pass(6).position == passes[2]
            assert session.last_pass(6).position == passes[1]
            with pytest.raises(DebugError, match="line 99"):
                session.last_pass(99)

    def test_pause_stops_at_the_next_statement(self):
        with at_entry("n = 0\nwhile True:\n  n = n + 1\nend\n") as session:
            session.pause()
            stop = session.resume()
            assert stop.reason == "pause"
            assert session.next(1).line in (2, 3)
            session.pause()
            assert session.resume().line in (2, 3)

    def test_a_pause_that_comes_while_the_program_is_made_to_go_on_is_not_lost(self):
        with at_entry("n = 0\nfor i in range(1000):\n  n = n + 1\nend\n") as session:
            session.next(1)
            paused = []

            def trace(frame, event, argument):
                if frame.f_code is not Engine._install.__code__:
                    return None
                if event == "line" and "[take] * " in getline(frame.f_code.co_filename, frame.f_lineno) and not paused:
                    # As another thread might, when `_install` has looked whether a pause was asked for.
                    paused.append(session.pause())
                return trace

            outer = sys.gettrace()
            sys.settrace(trace)
            try:
                stop = session.resume()
            finally:
                sys.settrace(outer)
            assert paused == [None]
            assert stop.reason == "pause"
            assert stop.position.statement <= 3

    def test_no_debug_does_not_stop(self):
        with debugging(PICK + "\n") as session:
            session.set_breakpoints([LineBreakpoint(6)])
            assert session.start(no_debug=True).result == "finished"


def both_ways(text, set_up, **options):
    """Stops on the way to the end, which have to be those on the way back."""
    with debugging(text, **options) as session:
        set_up(session)
        there = [session.start()]
        while there[-1].position.kind != AT_END:
            there.append(session.resume())
        back = [session.reverse()]
        while back[-1].reason != "entry":
            back.append(session.reverse())
        assert back[:-1] == there[-2::-1]
        return there[:-1]


class TestBreakpoints:
    def test_a_line_moves_down_to_a_statement(self):
        with at_entry(PICK) as session:
            states = session.set_breakpoints([LineBreakpoint(5), LineBreakpoint(9), LineBreakpoint(21)])
            assert [(state.verified, state.line) for state in states] == [(True, 6), (True, 10), (False, 0)]
            assert [(place.line, place.column) for place in session.breakpoint_locations(4, 6)] == [(4, 3), (6, 5)]

    @pytest.mark.parametrize(
        ("request_", "expected"),
        [
            (LineBreakpoint(6), 3),
            (LineBreakpoint(6, condition="n > 0"), 2),
            (LineBreakpoint(6, condition="total > 100"), 0),
            (LineBreakpoint(6, hit_condition="2"), 1),
            (LineBreakpoint(6, hit_condition=">= 2"), 2),
            (LineBreakpoint(6, hit_condition="% 3"), 1),
            (LineBreakpoint(6, condition="n > 0", hit_condition="2"), 1),
        ],
    )
    def test_lines(self, request_, expected):
        stops = both_ways(PICK, lambda session: session.set_breakpoints([request_]))
        assert lines(stops) == [6] * expected

    def test_hits_are_counted_from_the_start_wherever_they_are_asked_for(self):
        with at_entry(PICK) as session:
            session.set_breakpoints([LineBreakpoint(6)])
            session.resume()
            session.set_breakpoints([LineBreakpoint(6, hit_condition="3")])
            session.resume()
            assert variables(session)["n"] == "2"

    @pytest.mark.parametrize(("name", "expected"), [("pick", [6, 6, 6]), ("movej", [7, 7, 7]), ("textmsg", [20])])
    def test_functions_and_commands(self, name, expected):
        stops = both_ways(PICK, lambda session: session.set_function_breakpoints([FunctionBreakpoint(name)]))
        assert lines(stops) == expected

    @pytest.mark.parametrize(
        ("data_id", "expected"),
        [
            ("total", [("", "0", 3), ("0", "1", 6), ("1", "3", 6)]),
            ("standard_digital_out[1]", [("False", "True", 12)]),
            ("total > 0", [("False", "True", 6)]),
        ],
    )
    def test_data(self, data_id, expected):
        stops = both_ways(PICK, lambda session: session.set_data_breakpoints([DataBreakpoint(data_id)]))
        found = [(change.old, change.new, change.line) for stop in stops for change in stop.changes]
        assert found == expected
        assert all(stop.hits and stop.reason == "data breakpoint" for stop in stops)

    def test_an_expression_where_names_of_functions_are_typed(self):
        wanted = [FunctionBreakpoint("pick()"), FunctionBreakpoint(" total > 0"), FunctionBreakpoint("total >")]
        with at_entry(PICK) as session:
            states = session.set_function_breakpoints(wanted)
            assert [state.verified for state in states] == [True, True, False]
            assert states[2].message
            picked, reached = states[0].id, states[1].id
            assert [session.resume().hits for _ in range(3)] == [(picked,), (picked,), (reached,)]
            session.set_function_breakpoints(())
            assert session.resume().reason == "end"
            session.set_function_breakpoints(wanted[1:])
            stop = session.reverse()
            assert (stop.reason, stop.text) == ("data breakpoint", "total > 0 is true by main in line 6")

    def test_the_arm_in_the_middle_of_a_move(self):
        down = "movel(pose_trans(get_target_tcp_pose(), [0,0,0.1,0,0,0]))"
        text = f"def job():\n  movej([0,-1.57,-1.57,-1.57,1.57,0])\n  {down}\nend\n"
        stops = both_ways(text, lambda session: session.set_data_breakpoints([DataBreakpoint("tcp.z < 0.45")]))
        (stop,) = stops
        assert stop.position.kind == "tick"
        with debugging(text) as session:
            session.run_to(stop.position)
            assert 0.44 < session.state().tcp_pose[2] < 0.45
            session.run_to_tick(stop.position.tick - 1)
            assert session.state().tcp_pose[2] >= 0.45

    def test_inputs_of_the_robot(self):
        with at_entry("def job():\n  sleep(1)\n  textmsg(1)\nend\n") as session:
            session.set_signal("standard_digital_in[0]", "True")
            assert session.evaluate("standard_digital_in[0]").value == "True"
            assert session.evaluate("safety").value == "'normal'"
            session.set_signal("safeguard_stop", "True")
            assert session.evaluate("safety").value != "'normal'"

    def test_what_cannot_be_watched_or_counted_says_why(self):
        with at_entry(PICK) as session:
            states = session.set_data_breakpoints([DataBreakpoint("1 +"), DataBreakpoint("standard_digital_in[99]")])
            assert [state.verified for state in states] == [False, False] and all(state.message for state in states)
            (state,) = session.set_breakpoints([LineBreakpoint(6, hit_condition="often")])
            assert not state.verified and "often" in state.message
            (state,) = session.set_function_breakpoints([FunctionBreakpoint("nothing")])
            assert not state.verified

    @pytest.mark.parametrize(
        ("data_id", "reason"),
        [
            ("total", ""),
            ("total > 0 and standard_digital_out[1] and tcp.z < 1", ""),
            ("any(x > 0 for x in joints)", ""),
            ("parts", ""),
            ("totl", "there is no program global or signal 'totl'; did you mean 'total'?"),
            ("totl > 0", "there is no program global or signal 'totl'; did you mean 'total'?"),
            ("n", "n is a local variable: only program globals and signals are watched"),
            ("tick", "tick is a value of the robot: write an expression of it, such as tcp.z < 0.1"),
            ("sleep", "there is no program global or signal 'sleep'"),
        ],
    )
    def test_names_that_can_never_be_there_are_not_watched(self, data_id, reason):
        text = f"{PICK.rstrip().removesuffix('end')}  textmsg(parts)\nend\n"
        with debugging(text) as session:
            (state,) = session.set_data_breakpoints([DataBreakpoint(data_id)])
            assert (state.verified, state.message) == (not reason, reason)
            info = session.data_breakpoint_info(data_id)
            assert (info.data_id is None) == bool(reason)

    def test_log_messages_once_on_each_branch(self):
        said = []
        with debugging(PICK, said) as session:
            session.set_breakpoints([LineBreakpoint(6, log_message="n={n} {total + 1} {{x}} {nothing}")])
            session.start()
            session.reverse()
            session.resume()
        logs = [output.text for output in said if output.category == "console"]
        assert [text.partition(" <")[0] for text in logs] == ["n=0 1 {x}", "n=1 1 {x}", "n=2 2 {x}"]
        assert [output.text for output in said if output.category == "stdout"] == ["total 3"]

    def test_alarms_stop_before_the_stack_unwinds(self):
        text = "def job():\n  def f(n):\n    m = n + 1\n    return 1 / n\n  end\n  f(0)\nend\n"
        with debugging(text) as session:
            stop = session.start()
            assert (stop.reason, stop.line, stop.exception.code) == ("exception", 4, "R100")
            assert [(frame.name, frame.line) for frame in session.stack(1)] == [("f", 4), ("job", 6)]
            assert variables(session) == {"n": "0", "m": "1"}
            assert session.resume().result == "alarm"
            assert session.reverse().exception == stop.exception
            session.set_exception_filters([])
            session.restart()
            assert session.stop.reason == "end"

    def test_warnings(self):
        stops = both_ways(
            "def job():\n  textmsg(0)\n  set_tool_voltage(12)\n  movej([9,-1.57,0,0,0,0])\nend\n",
            lambda session: session.set_exception_filters(["alarm", "warning"]),
        )
        assert [stop.exception.filter for stop in stops][-1] == "alarm"

    def test_a_deadlock_shows_what_each_thread_waits_for(self):
        text = """def job():
  import threading
  a = threading.Lock()
  b = threading.Lock()
  def other():
    with b:
      sleep(0.1)
      with a:
        textmsg("never")
      end
    end
  end
  start_thread(other, ())
  with a:
    sleep(0.1)
    with b:
      textmsg("never")
    end
  end
end
"""
        with debugging(text) as session:
            stop = session.start()
            assert stop.exception.code == "R130"
            assert [(thread.name, thread.line) for thread in session.threads()] == [("main", 16), ("other", 8)]
            waits = [thread.waits_for for thread in session.threads()]
            assert waits == ["lock b, held by other", "lock a, held by main"]
            names = [session.stack(thread.id)[0].name for thread in session.threads()]
            assert names == [f"job (waits for {waits[0]})", f"other (waits for {waits[1]})"]
            assert session.evaluate("a", session.stack(1)[0].id).value == "<lock, held by main>"
            assert session.step_back(2).line == 8

    def test_a_lock_names_the_thread_that_holds_it_also_the_waiting_one_and_one_that_has_ended(self):
        text = """import threading
a = threading.Lock()
b = threading.Lock()
def taker():
  b.acquire()
end
start_thread(taker, ())
sleep(0.1)
def waiter():
  b.acquire()
end
start_thread(waiter, ())
a.acquire()
a.acquire()
"""
        with debugging(text) as session:
            session.start()
            waits = {thread.name: thread.waits_for for thread in session.threads()}
            assert waits == {
                "main": "lock a, which it holds itself",
                "waiter": "lock b, held by taker, which has ended",
            }


LOOK = """def job():
  global total
  import math
  import random
  class Part:
    def __init__(self):
      self.weight = 2.5
    def __eq__(self, other):
      raise ValueError("touched")
    def __repr__(self):
      raise ValueError("touched")
    def heavy(self):
      return self.weight
    end
  end
  def change():
    global total
    total = total + 1
    return total
  end
  total = 1
  items = [3, 1, 2]
  part = Part()
  where = {"a": [1, 2], "b": "text"}
  textmsg(total)
  textmsg(random.random())
end
"""


@pytest.fixture
def looking():
    with debugging(LOOK) as session:
        session.set_breakpoints([LineBreakpoint(25)])
        session.start()
        yield session


def digest(session):
    """All of the state that can be read, the work that was used up, and the generator of random numbers."""
    engine = session._engine
    program = engine.execution.host.program
    scheduler = engine._scheduler
    generator = program.generator().getstate()
    state = everything(session), len(scheduler.fuel), [(s.work, s.state) for s in scheduler.strands], generator
    record = engine.execution._robot.current
    return hashlib.sha256(repr((state, record.events, record.log, engine.outputs)).encode()).hexdigest()


class TestLooking:
    @pytest.mark.parametrize(
        ("text", "value"),
        [
            ("total + 1", "2"),
            ("items[0] * 2", "6"),
            ("sorted(items)", "[1, 2, 3]"),
            ("[q * 2 for q in items if q > 1]", "[6, 4]"),
            ("f'{total:03d}'", "'001'"),
            ("math.sqrt(16)", "4.0"),
            ("part.weight", "2.5"),
            ("where['a'][1]", "2"),
            ("'b' in where and len(where)", "2"),
            ("standard_digital_in[3]", "False"),
            ("get_standard_digital_in(3)", "False"),
            ("tcp.z > 0", "True"),
            ("tcp[2] == tcp.z and q[0] == joints.base == q.base", "True"),
            ("max(q) == max(joints) and len(tcp) == 6 and tcp_speed >= 0 and len(qd) == 6", "True"),
            ("d2r(180)", "3.141592653589793"),
            ("part", "<Part>"),
            ("change", "function change"),
        ],
    )
    def test_values(self, looking, text, value):
        frame = looking.stack(1)[0].id
        before = digest(looking)
        assert looking.evaluate(text, frame).value == value
        assert digest(looking) == before

    @pytest.mark.parametrize(
        "text",
        [
            "change()",
            "items.append(4)",
            "items.sort()",
            "set_standard_digital_out(0, True)",
            "random()",
            "random.random()",
            "movej(items)",
            "sleep(1)",
            "textmsg(1)",
            "print(1)",
            "part == 1",
            "[part] == [1]",
            "part in items",
            "str(part)",
            "f'{part}'",
            "part.heavy()",
            "(lambda: 1)()",
            "(total := 5)",
            "exec('total = 5')",
            "eval('1')",
            "open('x')",
            "part.__class__",
            "''.format(1)",
            "10 ** 10 ** 10",
            "'a' * 10 ** 9",
            "[0] * 10 ** 9",
            "list(range(10 ** 9))",
            "[1 for a in range(10000) for b in range(10000)]",
            "nothing",
            "total +",
            "total = 5",
            "items[99]",
        ],
    )
    def test_what_is_refused_changes_nothing(self, looking, text):
        frame = looking.stack(1)[0].id
        before = digest(looking)
        with pytest.raises(DebugError):
            looking.evaluate(text, frame)
        assert digest(looking) == before

    def test_looking_moves_no_time(self):
        def run(looks):
            with debugging(LOOK, work_per_tick=40) as session:
                session.set_breakpoints([LineBreakpoint(line) for line in range(1, 27)])
                stop = session.start()
                stops = [stop]
                while stop.position.kind != AT_END:
                    if looks:
                        everything(session)
                        session.evaluate("[q for q in range(1900)]")
                    stop = session.resume()
                    stops.append(stop)
                return stops

        assert run(True) == run(False)

    def test_the_present_motion_and_the_move_that_waits_for_its_end(self):
        first, second = "movej([0.5,-1.57,-1.57,-1.57,1.57,0], r=0.2)", "movej([0.5,-1,-1.57,-1.57,1.57,0])"
        with debugging(f"def job():\n  {first}\n  sleep(0.02)\n  {second}\n  textmsg(1)\nend\n") as session:
            session.set_breakpoints([LineBreakpoint(4)])
            called = session.start().position.tick
            seen = []
            for tick in (called - 1, called + 5, called + 250):
                session.run_to_tick(tick)
                scope = session.scopes(0)[-1]
                robot = {one.name: one.value for one in session.variables(scope.reference)}
                seen.append((robot["motion"], robot["next_motion"]))
            assert seen == [
                ("'move of line 2'", "''"),
                ("'move of line 2'", "'move of line 4'"),
                ("'move of line 4'", "''"),
            ]

    def test_scopes_and_pages(self, looking):
        frame = looking.stack(1)[0].id
        scopes = looking.scopes(frame)
        assert [scope.name for scope in scopes] == ["Locals", "Globals", "Robot"]
        local = {child.name: child for child in looking.variables(scopes[0].reference)}
        assert local["items"].indexed == 3 and local["items"].value == "[3, 1, 2]"
        children = looking.variables(local["items"].reference, kind="indexed", start=1, count=1)
        assert [(child.name, child.value, child.evaluate_name) for child in children] == [("[1]", "1", "items[1]")]
        part = looking.variables(local["part"].reference)
        assert [(child.name, child.value) for child in part] == [("weight", "2.5")]
        robot = {child.name: child for child in looking.variables(scopes[2].reference)}
        assert [child.name for child in looking.variables(robot["tcp"].reference)] == ["x", "y", "z", "rx", "ry", "rz"]
        assert looking.variables(robot["joints"].reference)[0].name == "base"
        assert "0x" not in str(everything(looking))

    def test_references_end_with_the_stop(self, looking):
        frame = looking.stack(1)[0].id
        looking.next(1)
        with pytest.raises(DebugError, match="gone on"):
            looking.scopes(frame)

    def test_all_that_is_shown_can_be_sent_to_another_process(self, looking):
        shown = (looking.stop, looking.threads(), looking.stack(1), looking.history("total"), looking.scopes(1))
        assert pickle.loads(pickle.dumps(shown)) == shown


class TestChanges:
    def test_a_variable_is_kept_on_the_way_back_and_there(self):
        with at_entry(PICK) as session:
            session.set_breakpoints([LineBreakpoint(6, condition="n == 1")])
            here = session.resume()
            frame = session.stack(1)[0].id
            assert session.set_expression("n", "10", frame).value == "10"
            assert session.set_expression("total", "n * 10", session.stack(1)[0].id).value == "100"
            assert session.next(1).line == 7
            assert session.evaluate("total").value == "110"
            session.reverse()
            session.run_to(here.position)
            assert variables(session)["n"] == "10"
            assert session.resume().result == "finished"
            assert session.evaluate("total").value == "112"

    def test_a_new_change_cuts_off_what_came_later(self):
        with at_entry(PICK) as session:
            session.set_breakpoints([LineBreakpoint(6)])
            first = session.resume()
            session.resume()
            session.set_expression("total", "500")
            session.run_to(first.position)
            session.set_expression("total", "7")
            assert session.furthest == first.position
            session.set_breakpoints([])
            session.resume()
            assert session.evaluate("total").value == "10"

    def test_items_attributes_and_signals(self, looking):
        frame = looking.stack(1)[0].id
        looking.set_expression("items[1]", "9", frame)
        looking.set_expression("part.weight", "1.5", looking.stack(1)[0].id)
        looking.set_signal("standard_digital_in[2]", "True")
        frame = looking.stack(1)[0].id
        assert looking.evaluate("items", frame).value == "[3, 9, 2]"
        assert looking.evaluate("part.weight", frame).value == "1.5"
        scope = looking.scopes(frame)[0].reference
        assert looking.set_variable(scope, "total" if False else "items", "[1]").value == "[1]"
        looking.next(1)
        looking.step_back(1)
        frame = looking.stack(1)[0].id
        assert looking.evaluate("items", frame).value == "[1]"
        assert looking.evaluate("standard_digital_in[2]", frame).value == "True"

    def test_the_console_may_change_if_it_is_allowed_to(self, looking):
        frame = looking.stack(1)[0].id
        assert looking.evaluate("change()", frame, may_change=True).value == "2"
        looking.evaluate("items = [total]", looking.stack(1)[0].id, may_change=True)
        looking.evaluate("set_standard_digital_out(4, True)", may_change=True)
        looking.next(1)
        looking.step_back(1)
        frame = looking.stack(1)[0].id
        assert looking.evaluate("total").value == "2" and looking.evaluate("items", frame).value == "[2]"
        assert looking.evaluate("standard_digital_out[4]").value == "True"

    @pytest.mark.parametrize("text", ["sleep(1)", "total = 1 / 0", "while True: ; pass ; end", "def"])
    def test_what_fails_in_the_console_leaves_nothing(self, looking, text):
        before = digest(looking)
        with pytest.raises(DebugError):
            looking.evaluate(text, looking.stack(1)[0].id, may_change=True)
        assert digest(looking) == before

    def test_restart_forgets_changes(self):
        with at_entry(PICK) as session:
            session.set_breakpoints([LineBreakpoint(6)])
            session.resume()
            session.set_expression("total", "500")
            session.set_breakpoints([])
            session.restart()
            assert session.evaluate("total").value == "3"


class TestHistory:
    def test_changes_of_a_global_a_local_and_a_signal(self):
        with debugging(PICK) as session:
            session.start()
            found = [(row.old, row.new, row.line, row.thread_name) for row in session.history("total")]
            assert found == [("", "0", 3, "main"), ("0", "1", 6, "main"), ("1", "3", 6, "main")]
            assert [(row.new, row.line) for row in session.history("k", function="work")] == [
                ("0", 11),
                ("1", 13),
                ("2", 13),
            ]
            (row,) = session.history("standard_digital_out[2]")
            assert (row.old, row.new, row.line, row.thread_name) == ("False", "True", 12, "work")
            session.run_to(row.cause)
            assert session.stop.line == 12 and session.evaluate("standard_digital_out[2]").value == "False"

    def test_who_changed_it(self):
        with debugging(PICK) as session:
            session.set_breakpoints([LineBreakpoint(7, condition="n == 2")])
            session.start()
            change = session.who_changed("total")
            assert (change.old, change.new, change.line) == ("1", "3", 6)
            session.run_to(change.cause)
            assert session.evaluate("total").value == "1"
            assert session.who_changed("nothing_of_it") is None


class TestAfterwards:
    def test_a_closed_session_is_freed(self):
        robots = []
        for _ in range(5):
            with debugging(PICK) as session:
                session.set_breakpoints([LineBreakpoint(12)])
                session.start()
                session.resume()
                session.step_back(1)
                robots.append(weakref.ref(session._engine.execution._robot))
                session.close()
            del session
        gc.collect()
        assert [robot() for robot in robots] == [None] * 5

    def test_a_dropped_run_does_nothing_more(self):
        said = []
        text = 'def job():\n  try:\n    sleep(1)\n    sleep(1)\n  finally:\n    textmsg("end")\nend\njob()\n'
        with debugging(text, said) as session:
            session.start(stop_on_entry=True)
            session.next(1)
            session.step_in(1)
            session.next(1)
            assert session.next(1).line == 4
        assert said == []

    def test_the_run_is_that_of_the_robot(self):
        with debugging(PICK) as session:
            end = session.start()
            assert (end.time_s, session.state().joints) == ((run := VirtualRobot().run(PICK)).time_s, run.joints)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
class TestProcesses:
    def test_all_works_in_processes_of_its_own(self):
        said = []
        with debugging(PICK, said, forks=True) as session:
            session.set_breakpoints([LineBreakpoint(6, condition="n == 1")])
            here = session.start()
            frame = session.stack(1)[0].id
            assert session.evaluate("n + 1", frame).value == "2"
            with pytest.raises(DebugError, match="refused"):
                session.evaluate("pick(1)", frame)
            session.set_expression("n", "10", frame)
            assert session.step_back(1).line == 18
            session.run_to(here.position)
            assert variables(session)["n"] == "10"
            end = session.resume()
            assert [row.new for row in session.history("total")] == ["0", "10", "12"]
            assert len(session.passes(6)) == 3
            assert session.reverse().position == here.position and session.resume() == end
        assert [output.text for output in said] == ["total 12"]

    def test_pause_and_the_end_of_all_processes(self):
        with debugging("n = 0\nwhile True:\n  n = n + 1\nend\n", forks=True) as session:
            session.start(stop_on_entry=True)
            session.pause()
            assert session.resume().reason == "pause"
            process = session._engine._process
        for _ in range(1000):
            try:
                os.kill(process, 0)
            except ProcessLookupError:
                break
            with contextlib.suppress(ChildProcessError):
                os.waitpid(process, 0)
        with pytest.raises(ProcessLookupError):
            os.kill(process, 0)


def test_a_thread_that_was_looked_at_in_its_turn_waits_at_its_present_line():
    with debugging("a = 1\nsleep(1)\n") as session:
        session.start(stop_on_entry=True)
        (strand,) = session._engine.execution.host.scheduler.strands
        assert strand.line == 1
        session.run_to_tick(10)
        assert strand.line == 2


COMPARED = """
log = []
class Part:
  def __eq__(self, other):
    log.append(other)
    return True
  end
  def __hash__(self):
    return 1
  end
  def __len__(self):
    log.append(0)
    return 1
  end
  def __repr__(self):
    log.append(0)
    return ""
  end
end
part = Part()
parts = {part: 2}
keys = parts.keys()
held = {1: part}
values = held.values()
items = held.items()
sync()
sync()
"""


@pytest.mark.parametrize(
    "text",
    [
        *("1 in values", "(1, 2) in items", "1 in keys", "keys & {1}", "max(values)", "str(values)", "f'{items}'"),
        *("parts[1]", "set(items)"),
    ],
)
def test_no_code_of_the_program_runs_through_a_view_or_a_key(text):
    with debugging(COMPARED) as session:
        session.run_to_tick(1)
        frame = session.stack(1)[0].id
        with pytest.raises(DebugError, match="refused"):
            session.evaluate(text, frame)
        assert session.evaluate("held[1]", frame).value == "<Part>"
        assert session.evaluate("log", frame).value == "[]"


@pytest.mark.parametrize(
    "text",
    [
        *("math.factorial(10**9)", "math.comb(10**9, 10**8)", "math.prod(range(1, 10**6))", "pow(2, 10**11)"),
        *("0.5 in range(10**12)", "[*range(10**12)]", "{1}.isdisjoint(range(2, 10**12))", "round(5, -10**10)"),
        *("range(10**12).index(0.5)", "bytes(10**11)", "[items * 10000 for n in range(100000)]"),
    ],
)
def test_an_expression_that_would_not_end_or_fill_the_memory_is_refused(text):
    with debugging("import math\nitems = [1] * 100\nsleep(1)\n") as session:
        session.run_to_tick(1)
        frame = session.stack(1)[0].id
        with pytest.raises(DebugError, match="too "):
            session.evaluate(text, frame)


HOLDING = """
items = [1, [2, 3]]
print("first")
sync()
print("last")
sync()
"""


@pytest.mark.parametrize("forks", [False, True] if hasattr(os, "fork") else [False])
@pytest.mark.parametrize("text", ["items[0] = 5", "items.append(nothing)", "no program", "stop_thread(0)"])
def test_numbers_of_frames_and_values_stay_valid_when_something_is_changed(text, forks):
    with debugging(HOLDING, forks=forks) as session:
        session.set_breakpoints([LineBreakpoint(4)])
        session.start()
        frame = session.stack(1)[0].id
        scope = session.scopes(frame)[0].reference
        (items,) = session.variables(scope)
        inner = session.evaluate("items[1]", frame)
        with contextlib.suppress(DebugError):
            session.evaluate(text, frame, may_change=True)
        assert [child.value for child in session.variables(items.reference)][1] == "[2, 3]"
        assert [child.value for child in session.variables(inner.reference)] == ["2", "3"]
        assert session.evaluate("items", frame).value == session.variables(scope)[0].value
        session.set_variable(items.reference, "[0]", "8")
        assert session.evaluate("items[0]", frame).value == "8"


@pytest.mark.parametrize("target", ["joints[0]", "tcp.x", "items[:][0]", "sorted(items)[0]", "[1][0]"])
def test_a_copy_cannot_be_set(target):
    with debugging("items = [1]\nsleep(1)\n") as session:
        session.run_to_tick(1)
        with pytest.raises(DebugError, match="cannot be set"):
            session.set_expression(target, "5", session.stack(1)[0].id)


def test_what_a_change_prints_is_shown_once():
    outputs = []
    with debugging(HOLDING, outputs) as session:
        session.set_breakpoints([LineBreakpoint(4)])
        stop = session.start()
        session.resume()
        session.run_to(stop.position)
        frame = session.stack(1)[0].id
        session.evaluate('print("typed")', frame, may_change=True)
        with contextlib.suppress(DebugError):
            session.evaluate("1 / 0", frame, may_change=True)
        session.resume()
        session.run_to(stop.position)
        session.resume()
    assert [output.text for output in outputs] == ["first", "last", "typed", "last"]


class TestValuesThatAreLarge:
    """Looking takes the time of the robot that serves, so that it has to be bounded whatever a program holds."""

    TEXT = """def job():
  a = [0] * 100
  for n in range(8):
    a = [a] * 100
  end
  s = set([frozenset([1, 2]), 3])
  r = range(10 ** 30)
  long = [0] * 3000
  sleep(0.1)
end
"""

    def test_they_are_shown_in_part(self):
        with debugging(self.TEXT) as session:
            session.start(stop_on_entry=True)
            session.set_breakpoints([LineBreakpoint(9)])
            session.resume()
            frame = session.stack(1)[0].id
            found = {item.name: item for item in session.variables(session.scopes(frame)[0].reference)}
            assert 2000 <= len(found["a"].value) < 2200 and found["a"].value.endswith("… 99 more]")
            assert found["s"].value == "{3, {1, 2}}"
            assert (found["r"].value, found["r"].reference) == (f"range(0, {10**30})", 0)
            part = session.variables(found["long"].reference, kind="indexed", start=2999, count=5)
            assert [(item.name, item.value) for item in part] == [("[2999]", "0")]
            assert session.evaluate("r[5]", frame).value == "5"
            assert session.evaluate("set(long + [2])", frame).value == "{0, 2}"

    @pytest.mark.parametrize(
        "text",
        [
            "0.5 in r",
            "sum(r)",
            "[*r]",
            "pow(3, 10 ** 9)",
            "math.factorial(10 ** 9)",
            "('a' * 10 ** 6).replace('a', 'b' * 10 ** 6)",
            "(5).to_bytes(length=10 ** 9, byteorder='big')",
            "('x' * 10 ** 4).join(['x'] * 10 ** 4)",
        ],
    )
    def test_what_would_take_too_long_is_refused(self, text):
        with at_entry("import math\nr = range(10 ** 12)\nsleep(1)\n") as session:
            session.next(1)
            session.next(1)
            with pytest.raises(DebugError, match="too l"):
                session.evaluate(text, session.stack(1)[0].id)


@pytest.mark.parametrize("text", ["9" * 5000, "str(10 ** 5000)", "int('9' * 5000)", "f'{10 ** 5000}'"])
def test_too_many_digits_are_said_in_plain_words(text):
    with at_entry("sleep(1)\n") as session, pytest.raises(DebugError, match="a number has too many digits") as raised:
        session.evaluate(text)
    assert "sys." not in str(raised.value) and len(str(raised.value)) < 200


class TestWhyThreadsWait:
    def test_is_said_where_time_stands(self):
        text = "def f():\n  sleep(0.1)\n  while not get_standard_digital_in(3):\n    sleep(0.1)\n  end\nend\n"
        with at_entry(text) as session:
            session.run_to_time(0.35)
            (thread,) = session.threads()
            assert thread.because == (
                "`not get_standard_digital_in(3)` in line 3 has been true since 0.1 s: standard_digital_in[3] is False"
            )
            assert session.picture().threads == (thread,)
            session.step_in(1)
            assert session.threads()[0].because == ""
