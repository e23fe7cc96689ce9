"""Units that come together: each has its share of a tick, in the order in which they came."""

from __future__ import annotations

import pytest

from elitescript.kernel.unit_order import WAITING_MAX
from elitescript.messages.enums import TaskState
from elitescript.messages.events import TaskStateChanged, Warned
from elitescript.messages.inputs import Do, RunUnit
from elitescript.messages.machine import PauseTask, SetSpeedScale, StopTask, WriteSignal
from tests.kernel.machine import READY, Session


def line(text: str, origin: str = "primary#1") -> RunUnit:
    return RunUnit(origin, "line", text)


def outputs(session: Session) -> list[int]:
    """Numbers of the standard outputs that are on."""
    levels = session.last.snapshot.signals["standard_digital_out"]
    return [number for number, level in enumerate(levels) if level]


def warnings(session: Session) -> list[str]:
    return [event.text for event in session.of(Warned)]


def test_ten_lines_in_one_tick_all_run():
    session = Session(READY)
    session.send(*(line(f"set_standard_digital_out({number}, True)") for number in range(10)))
    assert outputs(session) == [0]
    session.run(0.036)
    assert outputs(session) == list(range(10))
    assert warnings(session) == []


def test_lines_of_several_clients_run_in_the_order_in_which_they_came():
    session = Session(READY)
    session.send(*(line(f"textmsg({number})", f"primary#{number % 3}") for number in range(9)))
    session.send(line("textmsg(9)", "primary#7"))
    session.run(0.1)
    assert session.texts == [str(number) for number in range(10)]


def test_a_unit_runs_to_its_first_wait():
    session = Session(READY)
    session.send(
        RunUnit("primary#1", "program", "def a():\n  textmsg(1)\n  textmsg(2)\n  sync()\n  textmsg(3)\nend\n"),
        line("x = 1"),
    )
    session.run(0.1)
    assert session.texts == ["1", "2"]


def test_a_unit_without_a_wait_runs_to_the_end_of_its_share():
    session = Session(READY)
    session.send(line("while True: pass"), line("textmsg('next')"))
    session.run(0.01)
    assert session.texts == ["next"]


def test_what_does_not_compile_takes_no_turn():
    session = Session(READY)
    session.send(line("textmsg(1)"), line("1 +"), line("2 +"), line("textmsg(2)"))
    session.tick()
    assert session.texts == ["1", "2"]


def test_a_secondary_program_waits_for_its_own_client_alone():
    session = Session(READY)
    second = RunUnit("primary#1", "secondary", "sec s():\n  textmsg('sec')\nend\n")
    session.send(line("textmsg(1)"), line("textmsg(2)"), RunUnit("primary#2", "secondary", second.text), second)
    assert session.texts == ["1", "sec"]
    session.tick()
    assert session.texts == ["1", "sec", "2", "sec"]


def test_a_request_waits_for_the_lines_of_its_client():
    session = Session(READY)
    session.send(line("textmsg(1)"), line("textmsg(2)\n"), Do("primary#1", SetSpeedScale(0.5)), line("textmsg(3)"))
    assert session.last.snapshot.robot.speed_scale == 1.0
    session.tick()
    assert session.last.snapshot.robot.speed_scale == 1.0
    session.tick()
    assert (session.last.snapshot.robot.speed_scale, session.texts) == (0.5, ["1", "2", "3"])


def test_a_stop_of_the_same_client_comes_after_its_line():
    session = Session(READY)
    session.send(line("set_standard_digital_out(0, True); sleep(9)"), Do("primary#1", StopTask()))
    session.run(0.008)
    assert outputs(session) == [0]
    assert session.last.snapshot.robot.task_state is TaskState.STOPPED
    assert warnings(session) == []


def test_a_stop_of_another_client_acts_at_once_and_says_what_did_not_run():
    session = Session(READY)
    session.send(
        line("textmsg(1)"), *(line(f"textmsg({number})", "primary#2") for number in range(2, 40)), Do("ctl", StopTask())
    )
    session.run(0.1)
    assert session.texts == []
    said = warnings(session)
    assert said[0] == "`textmsg(1)` of primary#1 did not run: the task was stopped"
    assert said[1] == "`textmsg(2)` of primary#2 did not run: the task was stopped"
    assert said[-1] == "19 more programs and lines did not run: the task was stopped"


def test_what_waits_does_not_begin_after_an_emergency_stop():
    session = Session(READY)
    session.send(line("textmsg(1)"), line("textmsg(2)"), Do("ctl", WriteSignal("emergency_stop", 0, True)))
    session.run(0.1)
    assert "2" not in session.texts
    assert any(text.startswith("`textmsg(2)` of primary#1 did not run: ") for text in warnings(session))


def test_one_that_is_replaced_before_its_first_statement_says_so():
    session = Session(READY)
    session.send(line("textmsg(1)"), Do("ctl", PauseTask()))
    session.send(line("textmsg(2)", "primary#2"))
    session.tick()
    assert session.texts == ["2"]
    assert warnings(session) == [
        "`textmsg(1)` of primary#1 did not run: `textmsg(2)` of primary#2 came before its first statement"
    ]


def test_the_end_of_a_program_names_what_replaced_it():
    session = Session(READY)
    session.start("sleep(9)", name="p63")
    session.send(RunUnit("primary#2", "program", "def p64():\n  sleep(9)\nend\n"))
    session.send(line("sleep(9)", "primary#3"))
    session.do(StopTask())
    session.tick()
    ends = [(event.name, event.replaced_by) for event in session.of(TaskStateChanged) if event.ending]
    assert ends == [("p63", "`def p64():` of primary#2"), ("p64", "`sleep(9)` of primary#3"), ("", "")]


@pytest.mark.parametrize("more", [1, 5])
def test_what_waits_is_bounded_and_what_is_lost_is_named(more):
    session = Session(READY)
    session.send(*(line(f"x = {number}") for number in range(1 + WAITING_MAX + more)))
    said = warnings(session)
    assert len(said) == more
    assert said[0].startswith(
        f"`x = {WAITING_MAX + 1}` of primary#1 is lost: {WAITING_MAX} programs, lines and commands"
    )
