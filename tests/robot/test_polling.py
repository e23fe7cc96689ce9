"""Threads that read or write signals in every tick: what each access costs in calls, and the line of each change."""

from __future__ import annotations

import sys

import pytest

from elitescript import VirtualRobot
from elitescript.cli.main import main
from elitescript.kernel import kernel
from elitescript.messages.events import SignalChanged, event_of

TICKS = 50


def polling(body, ticks=TICKS):
    """A program with a thread that does something in every tick."""
    lines = "\n".join(f"      {line}" for line in body)
    return f"""def job():
  global n
  n = 0
  def poll():
    global n
    while True:
      n = n + 1
{lines}
      sync()
    end
  end
  start_thread(poll, ())
  sleep({ticks * 0.004})
end
"""


def calls_of(program):
    """Calls of Python functions that a run takes: a measure of work that a busy computer does not change."""
    robot = VirtualRobot("CS66")
    unit = robot.compile(program)
    robot.run(unit).check()
    count = 0

    def note(_frame, event, _argument):
        nonlocal count
        count += event == "call"

    # The program has run before, so that nothing is loaded or evaluated for the first time.
    sys.setprofile(note)
    try:
        robot.run(unit)
    finally:
        sys.setprofile(None)
    return count


@pytest.mark.parametrize(
    ("line", "most"),
    [
        ("get_standard_digital_in({})", 7.1),
        ("read_input_integer_register({})", 7.1),
        ("write_output_float_register({}, 1.5)", 8.1),
        ("write_output_integer_register({}, 7)", 8.1),
        ("set_standard_digital_out({}, True)", 8.1),
        ("write_output_integer_register({}, n)", 15.2),
    ],
)
def test_an_access_takes_a_few_calls(line, most):
    accesses = 10
    idle = calls_of(polling([]))
    busy = calls_of(polling([line.format(index) for index in range(accesses)]))
    # Each tick runs the thread once; the first run leaves levels that the second one finds.
    assert (busy - idle) / (accesses * TICKS) <= most


def test_a_tick_in_which_a_thread_polls_takes_few_calls():
    assert (calls_of(polling([], 3 * TICKS)) - calls_of(polling([]))) / (2 * TICKS) <= 68


@pytest.mark.parametrize(("options", "count"), [([], 0), (["--log", "signals"], 3), (["--json"], 3)])
def test_run_makes_events_of_changes_only_if_it_shows_them(options, count, tmp_path, monkeypatch, capsys):
    made = []
    monkeypatch.setattr(kernel, "event_of", lambda change: made.append(change) or event_of(change))
    program = tmp_path / "job.script"
    program.write_text("for i in range(4):\n  write_output_integer_register(0, i)\nend\n")
    assert main(["run", str(program), *options]) == 0
    shown = [line for line in capsys.readouterr().out.splitlines() if "N285" not in line]
    assert len(made) == "".join(shown).count("output_int_register[0]") - bool("--json" in options) == count


CHANGES = [
    "set_standard_digital_out(1, True)",
    "set_configurable_digital_out(1, True)",
    "set_tool_digital(0, True)",
    "set_tool_voltage(12)",
    "set_standard_analog_out(0, 0.5)",
    "write_output_boolean_register(1, True)",
    "write_output_integer_register(1, 5)",
    "write_output_float_register(1, 0.5)",
    "set_flag(1, True)",
    "write_port_register(256, 5)",
    "write_port_bit(60, True)",
    "set_runstate_standard_digital_output_to_value(2, 3)",
]


@pytest.mark.parametrize("call", CHANGES)
@pytest.mark.parametrize(
    ("before", "after", "line"),
    [
        ("", "", 3),
        ("def f():\n    {}\n  end\n  f()", None, 3),
        ("def f(): {}\n  [f() for i in [1]]", None, 2),
        ("eval('{}')", None, 2),
        ("exec('\\n\\n{}')", None, 2),
        ("(lambda: {})()", None, 2),
        ("def f():\n    {}\n  end\n  start_thread(f, ())\n  sync()", None, 3),
        ("sorted([1], key=lambda x: [{}, 1][1])", None, 2),
    ],
)
def test_a_change_carries_the_line_of_its_statement(call, before, after, line):
    text = f"  pass\n  {call}" if after == "" else "  " + before.format(call)
    run = VirtualRobot("CS66").run(f"def job():\n{text}\nend\n").check()
    changes = [event for event in run.events if isinstance(event, SignalChanged) and event.line]
    assert {event.line for event in changes} == {line}
