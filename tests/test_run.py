"""The record of a run: what it keeps of a very long one."""

from __future__ import annotations

import pytest

from elitescript import VirtualRobot
from elitescript.errors import UsageError
from elitescript.language.compiler import compile_unit
from elitescript.language.text.source import SourceFile
from elitescript.messages.events import TextMessage
from elitescript.run import RECORDS_MAX, Run


def test_a_long_run_keeps_what_came_last_and_counts_what_went() -> None:
    run = Run(compile_unit(SourceFile("<text>", "pass\n")), 0)
    count = 3 * RECORDS_MAX
    for tick in range(count):
        run.add(TextMessage(tick, str(tick), "main", 1))
        assert len(run.events) <= 1.1 * RECORDS_MAX
    assert len(run.events) >= RECORDS_MAX
    assert run.events_dropped == count - len(run.events)
    assert run.events[-1] == TextMessage(count - 1, str(count - 1), "main", 1)
    assert [event.tick for event in run.events] == list(range(run.events_dropped, count))
    assert run.log == [event.text for event in run.events]


def test_a_run_of_usual_length_keeps_everything() -> None:
    run = Run(compile_unit(SourceFile("<text>", "pass\n")), 0)
    for tick in range(RECORDS_MAX):
        run.add(TextMessage(tick, "", "main", 1))
    assert (len(run.events), run.events_dropped) == (RECORDS_MAX, 0)


def test_warnings_of_the_compiler_are_hidden_as_those_of_check_are() -> None:
    text = "def f():\n  print 'a'{}\nend\n"
    assert len(VirtualRobot().run(text.format("")).warnings) == 1
    assert VirtualRobot().run(text.format("  # check: ignore[E106]")).warnings == []


MOVES = """set_standard_digital_out(0, True)
textmsg("a")
movej([0, -1.4, -1.7, -1.6, 1.57, 0])
textmsg("b")
"""


@pytest.mark.parametrize(
    ("keep", "kinds"),
    [
        ("none", set()),
        ("TextMessage", {"TextMessage"}),
        ("TextMessage, SignalChanged", {"TextMessage", "SignalChanged"}),
        (["MotionEnded"], {"MotionEnded"}),
    ],
)
def test_a_run_keeps_the_events_that_are_asked_for(keep: str | list[str], kinds: set[str]) -> None:
    whole, part = (VirtualRobot("CS66").run(MOVES, keep=kept) for kept in ("all", keep))
    chosen = [event for event in whole.events if type(event).__name__ in kinds]
    assert part.events == chosen
    assert part.events_dropped == len(whole.events) - len(chosen)
    assert part.events_dropped > 0
    assert (part.log, part.state, part.joints) == (whole.log, whole.state, whole.joints)


def test_an_unknown_kind_of_event_is_refused_before_the_run() -> None:
    robot = VirtualRobot("CS66")
    with pytest.raises(UsageError, match=r"no kind of event is called 'Alarms'.*Alarm.*all, none, or some of Text"):
        robot.run(MOVES, keep="Alarms")
    assert robot.tick == 0
