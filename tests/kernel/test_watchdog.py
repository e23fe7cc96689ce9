"""`rtsi_set_watchdog` with its three actions."""

from __future__ import annotations

import pytest

from elitescript.messages.enums import TaskState
from elitescript.messages.events import Alarm, Warned
from elitescript.messages.inputs import VariablesArrived
from elitescript.messages.machine import ResumeTask
from tests.kernel.machine import FOREVER, Session

NAME = "speed_slider_mask"


def watched(action: str) -> Session:
    session = Session()
    session.start(f"rtsi_set_watchdog('{NAME}', 10, '{action}')", FOREVER)
    return session


def feed(session: Session, ticks: int, every: int) -> None:
    for tick in range(ticks):
        session.send(*([VariablesArrived("rtsi#1", (NAME, "other"))] if tick % every == 0 else []))


@pytest.mark.parametrize(
    ("action", "state"),
    [("ignore", TaskState.PLAYING), ("pause", TaskState.PAUSED), ("stop", TaskState.STOPPED)],
)
def test_silence_is_ignored_pauses_or_stops(action, state):
    session = watched(action)
    session.run(0.2)
    assert session.last.snapshot.robot.task_state is state
    assert [NAME in event.text for event in session.of(Warned)] == [True] * (action != "ignore")


def test_the_rate_is_enough_while_the_input_comes():
    session = watched("stop")
    feed(session, 200, every=25)
    assert session.last.snapshot.robot.task_state is TaskState.PLAYING
    feed(session, 100, every=40)
    assert session.last.snapshot.robot.task_state is TaskState.STOPPED


def test_other_inputs_do_not_count():
    session = watched("stop")
    for _ in range(40):
        session.send(VariablesArrived("rtsi#1", ("other",)))
    assert session.last.snapshot.robot.task_state is TaskState.STOPPED


def test_a_pause_does_not_count():
    session = watched("pause")
    session.run(1.0)
    session.do(ResumeTask())
    session.run(0.09)
    assert session.last.snapshot.robot.task_state is TaskState.PLAYING
    session.run(0.1)
    assert session.last.snapshot.robot.task_state is TaskState.PAUSED


def test_it_ends_with_the_program():
    session = watched("stop")
    session.start(FOREVER)
    session.run(1.0)
    assert session.last.snapshot.robot.task_state is TaskState.PLAYING


def test_an_unknown_input_is_an_alarm():
    session = Session()
    session.start("rtsi_set_watchdog('no_such_input', 10, 'stop')")
    (alarm,) = session.of(Alarm)
    assert (alarm.code, alarm.line) == ("R104", 2)
