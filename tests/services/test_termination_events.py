"""The events that clients get in the place of a robot that was replaced."""

from __future__ import annotations

from dataclasses import replace

import pytest

from elitescript.messages.enums import TaskState
from elitescript.messages.events import Alarm, TaskStateChanged
from elitescript.messages.inputs import AddLog, Input, PlayTask, RunUnit
from elitescript.messages.snapshot import Snapshot
from elitescript.services.child.supervision import HINT, Failure, termination_events
from tests.protocol.snapshots import output

PROGRAM = RunUnit("primary#1", "program", "def job(a=1):\n  sum(range(10**12))\nend\n")
LINE = RunUnit("primary#1", "line", "sum(range(10**12))")
SECONDARY = RunUnit("primary#1", "secondary", "sec s():\n  sum(range(10**12))\nend\n")
HERE = ("<primary#1>", 2)


def picture(state: TaskState = TaskState.STOPPED, running: str = "", loaded: str = "folder/day.task") -> Snapshot:
    found = output(5, task_state=state, line=7).snapshot
    return replace(found, task=replace(found.task, running=running, loaded=loaded))


def states(last: Snapshot | None, *lost: Input, where: tuple[str, int] | None = None) -> list[tuple[str, str]]:
    """States of the task and their programs, with `!` in the place of the alarm."""
    events = termination_events(9, Failure("it hung", where), last, lost)
    return [(event.state.name, event.name) if isinstance(event, TaskStateChanged) else ("!", "") for event in events]


@pytest.mark.parametrize("where", [HERE, None])
def test_a_program_of_the_lost_tick_has_a_start_and_an_end(where: tuple[str, int] | None) -> None:
    assert states(picture(), PROGRAM, where=where) == [("PLAYING", "job"), ("!", ""), ("STOPPED", "job")]
    assert states(picture(), LINE, where=where) == [("PLAYING", ""), ("!", ""), ("STOPPED", "")]


def test_it_has_ended_the_one_before() -> None:
    assert states(picture(TaskState.PLAYING, "old"), PROGRAM, where=HERE) == [
        ("STOPPED", "old"),
        ("PLAYING", "job"),
        ("!", ""),
        ("STOPPED", "job"),
    ]


def test_so_has_the_program_of_a_task() -> None:
    play = PlayTask("dashboard#1")
    assert states(picture(), play, where=("folder/day.script", 2)) == [
        ("PLAYING", "folder/day"),
        ("!", ""),
        ("STOPPED", "folder/day"),
    ]
    assert states(picture(), play, where=("<query>", 1)) == [("!", "")]


def test_a_program_that_ran_before_has_ended() -> None:
    assert states(picture(TaskState.PLAYING, "old"), where=HERE) == [("!", ""), ("STOPPED", "old")]
    assert states(picture(TaskState.PAUSED, "old"), PlayTask("dashboard#1")) == [("!", ""), ("STOPPED", "old")]


def test_nothing_has_begun_with_a_secondary_program_or_elsewhere() -> None:
    assert states(picture(), SECONDARY, where=HERE) == [("!", "")]
    assert states(picture(), PROGRAM, where=("<primary#2>", 2)) == [("!", "")]
    assert states(picture(), AddLog("ctl", "x")) == [("!", "")]
    assert states(None) == [("!", "")]


def test_the_alarm_says_where_and_what_to_do() -> None:
    (alarm,) = termination_events(9, Failure("it hung", HERE), picture())
    assert isinstance(alarm, Alarm)
    assert (alarm.tick, alarm.code, alarm.line, alarm.text) == (9, "R132", 2, "the controller was restarted: it hung")
    assert alarm.details == {"program": "<primary#1>", "hint": HINT}
    (alarm,) = termination_events(9, Failure("it is gone", None), picture(), last_line=7)
    assert isinstance(alarm, Alarm)
    assert (alarm.line, alarm.details) == (7, {})
