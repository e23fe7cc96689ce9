import pytest

from elitescript.errors import ProgramError, UsageError
from elitescript.mcp.steps import Steps

PROGRAM = """\
def job():
  global parts
  parts = 0
  i = 0
  while i < 3:
    movej([0, -1.2 - 0.1 * i, -1.5, -1.5, 1.5, 0], a=1.4, v=1.05)
    parts = parts + 1
    textmsg("part ", parts)
    i = i + 1
  end
end
"""


@pytest.fixture
def steps():
    made = Steps()
    made.start({"name": "<text>", "text": PROGRAM})
    return made


def go(steps, how, **rest):
    return steps.go({"how": how, **rest})


def test_a_run_begins_before_its_first_statement():
    stop = Steps().start({"name": "<text>", "text": PROGRAM})
    assert (stop["reason"], stop["time_s"], stop["stack"]) == ("entry", 0.0, [{"function": "job", "line": 3}])


def test_a_breakpoint_with_a_condition_stops_and_shows_variables_and_output(steps):
    found = steps.breakpoints({"lines": [{"line": 8, "condition": "i == 1"}, {"line": 99}]})["breakpoints"]
    assert [item["set"] for item in found] == [True, False]
    stop = go(steps, "continue")
    assert (stop["reason"], stop["stack"][0]["line"]) == ("breakpoint", 8)
    assert (stop["variables"]["Locals"]["i"], stop["variables"]["Globals"]["parts"]) == ("1", "2")
    assert [item["text"] for item in stop["output"]] == ["part 1"]


def test_back_and_forth_show_the_same(steps):
    forth = [go(steps, "next") for _ in range(6)]
    back = [go(steps, "back") for _ in range(5)]
    for one, other in zip(forth[-2::-1], back, strict=True):
        assert {**one, "output": 0, "text": 0} == {**other, "output": 0, "text": 0}


def test_the_end_can_be_left_backwards(steps):
    end = go(steps, "continue")
    assert (end["reason"], end["result"], end["stack"]) == ("end", "finished", [])
    assert go(steps, "last_pass", line=6)["variables"]["Locals"]["i"] == "2"


def test_a_time_in_the_middle_of_a_move_shows_the_thread_that_waits(steps):
    stop = go(steps, "to_time", time_s=0.5)
    assert (stop["time_s"], stop["thread"], stop["stack"][0]["line"]) == (0.5, 1, 6)
    assert stop["threads"][0]["waits_for"] == "the end of its move"


def test_expressions_have_values_and_change_nothing(steps):
    go(steps, "next")
    assert steps.evaluate({"expression": "parts + 1"})["value"] == "1"
    with pytest.raises(UsageError, match="set_standard_digital_out"):
        steps.evaluate({"expression": "set_standard_digital_out(1, True)"})
    with pytest.raises(UsageError):
        steps.evaluate({"expression": "1 +"})


def test_history_names_time_line_and_thread(steps):
    go(steps, "continue")
    found = steps.history({"name": "parts"})
    assert [(change["line"], change["old"], change["new"]) for change in found["changes"]] == [
        (3, "", "0"),
        (7, "0", "1"),
        (7, "1", "2"),
        (7, "2", "3"),
    ]
    assert (found["changes"][1]["by"], found["changes_left_out"]) == ("main", 0)


@pytest.mark.parametrize(
    ("how", "rest", "text"),
    [
        ("hop", {}, "none of next, in"),
        ("to_time", {}, "time_s must be given"),
        ("last_pass", {"line": 99}, "has not run"),
        ("next", {"thread": 9}, "thread"),
    ],
)
def test_what_makes_no_sense_is_refused(steps, how, rest, text):
    with pytest.raises(UsageError, match=text):
        go(steps, how, **rest)


@pytest.mark.parametrize(
    ("how", "rest", "text"),
    [
        ("continue", {"line": 3}, "line goes with last_pass, not with continue"),
        ("next", {"time_s": 1.0}, "time_s goes with to_time, not with next"),
        ("reverse", {"thread": 1}, "thread goes with next, in, out, back, not with reverse"),
        ("to_time", {"time_s": -1.0}, "time_s must be"),
        ("to_time", {"time_s": float("nan")}, "time_s must be finite"),
        ("to_time", {"time_s": float("inf")}, "time_s must be finite"),
        ("last_pass", {"line": 0}, "line must be a whole number >= 1"),
        ("next", {"thread": 0}, "thread must be a whole number >= 1"),
        ("next", {"thread": -1}, "thread must be a whole number >= 1"),
    ],
)
def test_arguments_of_moves_are_checked(steps, how, rest, text):
    with pytest.raises(UsageError, match=text):
        go(steps, how, **rest)


def test_a_condition_that_cannot_be_evaluated_is_said(steps):
    steps.breakpoints({"lines": [{"line": 8, "condition": "partss > 1"}]})
    stop = go(steps, "continue")
    assert "there is no variable 'partss' here" in stop["text"]
    assert [item["text"] for item in stop["output"]][-1] == stop["text"]
    assert go(steps, "continue")["reason"] == "end"


def test_large_values_say_what_is_left_out():
    steps = Steps()
    names = "".join(f"  v{n} = {n}\n" for n in range(150))
    text = f"def job():\n  a = list(range(100000))\n{names}  sleep(0.1)\n  b = 1\nend\n"
    steps.start({"name": "<text>", "text": text})
    stop = go(steps, "to_time", time_s=0.05)
    found = stop["variables"]["Locals"]
    assert found["a"].endswith("99, … 99,900 more]") and found["…"] == "… 51 more"
    assert steps.evaluate({"expression": "a"})["value"] == found["a"]


def test_what_does_not_compile_is_refused():
    with pytest.raises(ProgramError):
        Steps().start({"name": "<text>", "text": "def job(:\n"})


def test_without_a_start_there_is_nothing_to_ask():
    with pytest.raises(UsageError, match="no program is debugged"):
        Steps().go({"how": "next"})
