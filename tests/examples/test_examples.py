"""Every example runs, passes the checker, and does what its golden trace says."""

from __future__ import annotations

import difflib

import pytest

from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.messages.events import Alarm, Warned
from elitescript.messages.profile import PROFILES, profile
from tools.record_golden import GOLDEN, golden_file, programs, render, run_example

PROGRAMS = programs()


def by_name(path):
    return path.stem


def has_faults(program):
    world = program.with_suffix(".toml")
    return world.exists() and "[[fault]]" in world.read_text(encoding="utf-8")


def test_there_are_enough_to_choose_from():
    assert len(PROGRAMS) >= 8


def test_every_trace_has_its_program():
    assert {path.stem for path in GOLDEN.glob("*.events")} == {path.stem for path in PROGRAMS}


@pytest.mark.parametrize("program", PROGRAMS, ids=by_name)
class TestExample:
    def test_does_what_its_trace_says(self, program):
        found = render(run_example(program))
        wanted = golden_file(program).read_text(encoding="utf-8")
        if found != wanted:
            rows = difflib.unified_diff(wanted.splitlines(), found.splitlines(), "golden", "now", lineterm="", n=2)
            pytest.fail("the trace changed; if it should, run `make golden`\n" + "\n".join(list(rows)[:60]))

    def test_ends_well(self, program):
        run = run_example(program)
        assert run.state == "finished"
        # What goes wrong on a channel is a warning; nothing else in an example may be worth one.
        unwanted = Alarm if has_faults(program) else (Alarm, Warned)
        found = [event for event in run.events if isinstance(event, unwanted)]
        # A note says what a sound program may have.
        assert [event for event in found if not (isinstance(event, Warned) and event.severity == "note")] == []
        assert run.log

    @pytest.mark.parametrize("firmware", PROFILES)
    def test_the_checker_has_nothing_to_say(self, program, firmware):
        source = SourceFile(program.name, program.read_text(encoding="utf-8"))
        problems = check_source(source, profile(firmware), strict=True)
        newer = [problem for problem in problems if problem.code == "E302"]
        assert [str(problem) for problem in problems if problem not in newer] == []
        assert firmware == "2.10" or not newer

    def test_says_what_it_is_about(self, program):
        text = program.read_text(encoding="utf-8")
        head = [line for line in text.splitlines()[:6] if line.startswith("# ")]
        assert len(head) >= 2
        assert f"def {program.stem}():" in text
