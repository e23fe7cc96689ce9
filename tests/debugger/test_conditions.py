"""Breakpoints that cannot be evaluated: they stop once, with the reason, and are heard as an output."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest

from elitescript.debugger.api import (
    BREAKPOINT,
    DATA_BREAKPOINT,
    END,
    ENTRY,
    FUNCTION_BREAKPOINT,
    STEP,
    BreakpointState,
    DataBreakpoint,
    FunctionBreakpoint,
    LineBreakpoint,
    Output,
    Stop,
)
from elitescript.debugger.session import DebugSession
from tests.debugger.sessions import debugging
from tests.debugger.test_living import Living

TEXT = """def job():
  global count
  def add(k):
    set_standard_digital_out(k, True)
  end
  count = 0
  x = 1
  for i in range(4):
    count = count + 1
    add(i)
    x = x + i
  end
end
"""
LOOP = 11
"""A line that runs four times, with x and i."""

UNKNOWN = {
    "xx > 1": "there is no variable 'xx' here",
    "1 / 0": "ZeroDivisionError",
    "x > 0 and nosuch": "there is no variable 'nosuch' here",
    "x.foo": "'foo' of a int",
    "len(x) > 2": "TypeError",
    "[1, 2][x + 5] > 1": "IndexError",
    "get_actual_tcp_pose()[9] > 1": "IndexError",
    "get_standard_digital_in(99)": "99",
    "set_standard_digital_out(7, True)": "it may change nothing: set_standard_digital_out() changes something",
    "add(1)": "it may change nothing: add() is a function of the program",
    "sleep(10)": "it may change nothing",
    "sum(i for i in range(10 ** 12))": "too long",
    "[a for a in range(1000) for b in range(1000)]": "takes too long",
    "standard_digital_in": "is a group",
    "(y := 3)": "it may change nothing",
}
"""Conditions of line 11, and what is said of them; typed by hand."""


@contextmanager
def heard(text: str = TEXT, *, forks: bool = False) -> Iterator[tuple[DebugSession, list[Output]]]:
    outputs: list[Output] = []
    with debugging(text, outputs, forks=forks) as session:
        yield session, outputs


def said(outputs: list[Output]) -> list[str]:
    """What was said of breakpoints that cannot be evaluated."""
    return [item.text for item in outputs if "cannot be evaluated" in item.text]


@pytest.mark.parametrize(("condition", "reason"), UNKNOWN.items())
def test_it_stops_once_and_says_why(condition: str, reason: str) -> None:
    with heard() as (session, outputs):
        (state,) = session.set_breakpoints([LineBreakpoint(LOOP, condition=condition)])
        assert state.verified
        stop = session.start()
        assert (stop.reason, stop.line, stop.hits) == (BREAKPOINT, LOOP, (state.id,))
        assert "the condition of line 11 cannot be evaluated" in stop.text and reason in stop.text
        assert said(outputs) == [stop.text]
        assert [(item.category, item.line) for item in outputs if item.text == stop.text] == [("important", LOOP)]
        assert session.resume().reason == END
        assert said(outputs) == [stop.text]


ON_OTHERS: dict[str, Callable[[DebugSession], tuple[BreakpointState, ...]]] = {
    FUNCTION_BREAKPOINT: lambda it: it.set_function_breakpoints([FunctionBreakpoint("add", condition="kk > 1")]),
    f"{FUNCTION_BREAKPOINT} of a command": lambda it: it.set_function_breakpoints(
        [FunctionBreakpoint("set_standard_digital_out", condition="1 / 0")]
    ),
    DATA_BREAKPOINT: lambda it: it.set_data_breakpoints([DataBreakpoint("count", condition="nosuch > 1")]),
    f"{DATA_BREAKPOINT} of a signal": lambda it: it.set_data_breakpoints(
        [DataBreakpoint("standard_digital_out[2]", condition="1 / 0")]
    ),
    f"{DATA_BREAKPOINT} of an expression": lambda it: it.set_data_breakpoints([DataBreakpoint("len(count) > 2")]),
    f"{DATA_BREAKPOINT} where functions are typed": lambda it: it.set_function_breakpoints(
        [FunctionBreakpoint("1 / count > 2 and count.foo > 3")]
    ),
    f"{BREAKPOINT} with a number of hits": lambda it: it.set_breakpoints(
        [LineBreakpoint(LOOP, condition="xx", hit_condition="3")]
    ),
    f"{BREAKPOINT} with a message": lambda it: it.set_breakpoints(
        [LineBreakpoint(LOOP, condition="xx", log_message="x is {x}")]
    ),
}


@pytest.mark.parametrize("forks", [False, True])
@pytest.mark.parametrize("kind", ON_OTHERS)
def test_each_kind_of_breakpoint_does(kind: str, forks: bool) -> None:
    with heard(forks=forks) as (session, outputs):
        (state,) = ON_OTHERS[kind](session)
        assert state.verified, state.message
        stop = session.start()
        assert stop.reason == kind.partition(" of ")[0].partition(" with ")[0].partition(" where ")[0]
        assert "cannot be evaluated" in stop.text and stop.hits == (state.id,)
        assert [item.breakpoint for item in stop.unevaluated] == [state.id]
        assert said(outputs) == [stop.text]
        assert session.resume().reason == END
        assert len(said(outputs)) == 1


def test_a_condition_that_can_be_evaluated_again_stops_where_it_is_true() -> None:
    with heard() as (session, _):
        session.set_breakpoints([LineBreakpoint(LOOP, condition="6 / i > 2.5")])
        first = session.start()
        assert "ZeroDivisionError" in first.text
        assert [session.resume().text for _ in range(2)] == ["breakpoint 1", "breakpoint 1"]
        assert session.resume().reason == END


def test_passes_that_cannot_be_evaluated_are_no_hits() -> None:
    with heard() as (session, _):
        session.set_breakpoints([LineBreakpoint(LOOP, condition="6 / i > 0", hit_condition="2")])
        assert "ZeroDivisionError" in session.start().text
        stop = session.resume()
        assert session.evaluate("i", session.stack(1)[0].id).value == "2"
        assert not stop.unevaluated


def test_set_again_it_stops_again() -> None:
    with heard() as (session, outputs):
        for _ in range(2):
            session.set_breakpoints([LineBreakpoint(LOOP, condition="xx")])
            assert session.resume().reason == BREAKPOINT
        assert session.resume().reason == END
        assert len(said(outputs)) == 2


def test_others_that_are_set_do_not_make_it_stop_again() -> None:
    with heard() as (session, outputs):
        session.set_breakpoints([LineBreakpoint(LOOP, condition="xx")])
        session.start()
        session.set_function_breakpoints([FunctionBreakpoint("nosuch")])
        session.set_exception_filters(["warning"])
        assert session.resume().reason == END
        assert len(said(outputs)) == 1


def test_begun_again_it_stops_again() -> None:
    with heard() as (session, outputs):
        session.set_breakpoints([LineBreakpoint(LOOP, condition="xx")])
        first = session.start()
        assert session.restart().text == first.text
        assert len(said(outputs)) == 2


@pytest.mark.parametrize("forks", [False, True])
def test_backwards_it_stops_once_at_the_last_pass(forks: bool) -> None:
    with heard(forks=forks) as (session, outputs):
        assert session.start().reason == END
        session.set_breakpoints([LineBreakpoint(LOOP, condition="xx")])
        stop = session.reverse()
        assert (stop.reason, stop.line) == (BREAKPOINT, LOOP) and "there is no variable 'xx'" in stop.text
        assert session.evaluate("i", session.stack(1)[0].id).value == "3"
        assert said(outputs) == [stop.text]
        assert session.reverse().reason == ENTRY
        assert session.resume().reason == END
        assert len(said(outputs)) == 1


def test_going_back_and_on_over_it_is_silent() -> None:
    with heard() as (session, outputs):
        session.set_breakpoints([LineBreakpoint(LOOP, condition="xx")])
        stop = session.start()
        assert session.step_back(1).reason == STEP
        assert session.next(1).position == stop.position
        session.run_to_tick(0)
        assert session.resume().reason == END
        assert len(said(outputs)) == 1


def test_a_step_that_meets_it_says_so() -> None:
    with heard() as (session, _):
        session.start(stop_on_entry=True)
        session.set_breakpoints([LineBreakpoint(9, condition="xx")])
        stop: Stop = session.next(1)
        while stop.line < 9:
            stop = session.next(1)
        assert stop.reason == BREAKPOINT and "'xx'" in stop.text


def test_two_at_one_line_are_both_said() -> None:
    with heard() as (session, outputs):
        session.set_breakpoints([LineBreakpoint(LOOP, condition="xx"), LineBreakpoint(LOOP, condition="yy")])
        stop = session.start()
        assert "'xx'" in stop.text and "'yy'" in stop.text and len(stop.unevaluated) == 2
        assert len(said(outputs)) == 2


def test_a_variable_that_is_not_there_yet_is_no_mistake_of_a_data_breakpoint() -> None:
    with heard() as (session, outputs):
        session.set_data_breakpoints([DataBreakpoint("count > 2")])
        assert session.start().text.startswith("count > 2 is true")
        assert said(outputs) == []


def test_classes_of_the_program_do_not_decide() -> None:
    text = """class Box():
  def __bool__(self):
    textmsg("asked")
    return True
  end
end
box = Box()
x = 1
"""
    with heard(text) as (session, outputs):
        session.set_breakpoints([LineBreakpoint(8, condition="box")])
        assert "__bool__ of Box may run code of the program" in session.start().text
        assert session.resume().reason == END
        assert [item.text for item in outputs if item.category == "stdout"] == []


REFUSED = {
    "0": "count from 1",
    "== 0": "count from 1",
    "< 1": "count from 1",
    "<= 0": "count from 1",
    "% 0": "count from 1",
    "-1": "no number of hits",
    "2.5": "no number of hits",
    "often": "no number of hits",
    "1e3": "no number of hits",
    "nan": "no number of hits",
    "³": "no number of hits",
    "٣": "no number of hits",
    "3 3": "no number of hits",
    "= 3": "no number of hits",
    "9" * 13: "no number of hits",
}


@pytest.mark.parametrize(("text", "reason"), REFUSED.items())
def test_numbers_of_hits_that_cannot_come_are_refused(text: str, reason: str) -> None:
    with heard() as (session, _):
        states = [
            *session.set_breakpoints([LineBreakpoint(LOOP, hit_condition=text)]),
            *session.set_function_breakpoints([FunctionBreakpoint("add", hit_condition=text)]),
            *session.set_data_breakpoints([DataBreakpoint("count", hit_condition=text)]),
        ]
        assert [state.verified for state in states] == [False] * 3
        assert all(reason in state.message for state in states)
        assert session.start().reason == END


@pytest.mark.parametrize("condition", ["x =", "x > ", "if x", "x; y", "\x00", "(" * 1000])
def test_what_is_no_expression_is_refused(condition: str) -> None:
    with heard() as (session, _):
        states = [
            *session.set_breakpoints([LineBreakpoint(LOOP, condition=condition)]),
            *session.set_function_breakpoints([FunctionBreakpoint("add", condition=condition)]),
            *session.set_data_breakpoints([DataBreakpoint("count", condition=condition)]),
        ]
        assert [state.verified for state in states] == [False] * 3
        assert all("is no expression" in state.message for state in states)


def test_blanks_are_no_condition() -> None:
    with heard() as (session, _):
        session.set_breakpoints([LineBreakpoint(LOOP, condition="  ", hit_condition=" ")])
        assert session.start().text == "breakpoint 1"


# ---------------------------------------------------------------- a robot that lives


def outputs_of(living: Living) -> list[str]:
    return [item["output"]["text"] for item in living.events if item["event"] == "output"]


LIVING = {
    "a line": ("set_breakpoints", {"line": LOOP, "condition": "xx > 1"}),
    "hits": ("set_breakpoints", {"line": LOOP, "condition": "xx > 1", "hit_condition": "2"}),
    "a message": ("set_breakpoints", {"line": LOOP, "condition": "xx > 1", "log_message": "{x}"}),
    "a function": ("set_function_breakpoints", {"name": "add", "condition": "xx > 1"}),
    "a command": ("set_function_breakpoints", {"name": "set_standard_digital_out", "condition": "xx > 1"}),
    "data": ("set_data_breakpoints", {"data_id": "count", "condition": "xx > 1"}),
    "an expression": ("set_data_breakpoints", {"data_id": "count.foo > 1"}),
    "effects": ("set_breakpoints", {"line": LOOP, "condition": "set_standard_digital_out(7, True)"}),
    "a long one": ("set_breakpoints", {"line": LOOP, "condition": "[a for a in range(300) for b in range(300)]"}),
}


@pytest.mark.parametrize("kind", LIVING)
def test_on_a_robot_that_lives_it_stops_once_and_says_why(kind: str) -> None:
    living = Living()
    do, request = LIVING[kind]
    living.ask(do, requests=[request])
    living.run(TEXT)
    for _ in range(200):
        if any(item["event"] == "stopped" for item in living.events):
            break
        living.tick()
    (stop,) = [item["stop"] for item in living.events if item["event"] == "stopped"]
    assert "cannot be evaluated" in stop["text"] and outputs_of(living) == [stop["text"]]
    assert living.ask("resume") is None
    assert living.until("ended")["result"] == "finished"
    assert living.kernel.controller.read("standard_digital_out", 7) is False
    living.events.clear()
    living.run(TEXT)
    assert living.until("ended")["result"] == "finished"


def test_on_a_robot_that_lives_what_makes_no_sense_is_refused_alone() -> None:
    living = Living()
    living.run()
    rows = [{"line": 6, "hit_condition": "0"}, {"line": 6, "condition": "n ="}, {"line": 5}]
    states = living.ask("set_breakpoints", requests=rows)
    assert [state["verified"] for state in states] == [False, False, True]
    assert "count from 1" in states[0]["message"] and "is no expression" in states[1]["message"]
    assert living.stop()["line"] == 5


def test_on_a_robot_that_lives_a_variable_that_never_comes_is_said() -> None:
    living = Living()
    rows = [{"data_id": "countt"}, {"data_id": "countt > 1"}, {"data_id": "count > 100"}]
    assert all(state["verified"] for state in living.ask("set_data_breakpoints", requests=rows))
    for texts in (["countt", "countt > 1"], []):
        living.run(TEXT)
        while not any(item["event"] == "ended" for item in living.events):
            living.tick()
        assert outputs_of(living) == [
            f"the data breakpoint {name} has watched nothing: the program had no such variable" for name in texts
        ]
        living.events.clear()
