"""The record of a run: what it keeps of a very long one."""

from __future__ import annotations

from elitescript import VirtualRobot
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
