"""The same text with the same options is compiled once."""

from __future__ import annotations

import pytest

from elitescript import VirtualRobot
from elitescript.errors import ProgramError
from elitescript.language.compiler import compile_task
from elitescript.language.kept_units import CHARACTERS_MAX, KeptUnits
from elitescript.language.options import Options
from elitescript.language.text.source import SourceFile

TEXT = "def once():\n  global n\n  n = [part for part in {3, 1, 2}]\n  textmsg(n)\nend\n"


def test_a_robot_and_another_one_get_the_same_unit():
    assert VirtualRobot("CS66").compile(TEXT) is VirtualRobot("CS63", firmware="2.10").compile(TEXT)


@pytest.mark.parametrize(
    ("source", "options"),
    [
        (SourceFile("other", TEXT), Options()),
        (SourceFile("<program>", TEXT + " "), Options()),
        (SourceFile("<program>", TEXT, places=("", "1 Move", "", "", "", "")), Options()),
        (SourceFile("<program>", TEXT), Options(strict=True)),
        (SourceFile("<program>", TEXT), Options(kind="script")),
    ],
)
def test_another_name_text_place_or_option_makes_another_unit(source, options):
    first = compile_task(SourceFile("<program>", TEXT), Options())
    other = compile_task(source, options)
    assert other is not first
    assert other.source is source
    assert compile_task(source, options) is other


def test_statements_that_are_counted_are_compiled_for_each_robot():
    options = Options(probes="steps")
    assert compile_task(SourceFile("p", TEXT), options) is not compile_task(SourceFile("p", TEXT), options)


def test_mistakes_are_found_each_time():
    for _ in range(2):
        with pytest.raises(ProgramError):
            compile_task(SourceFile("p", "def job(:\n"))


def test_runs_of_one_unit_know_nothing_of_each_other():
    first, second = (VirtualRobot("CS66").run("global n\nn = [1]\nn.append(len(n))\ntextmsg(n)\n") for _ in range(2))
    assert first.log == second.log
    assert first.events == second.events
    assert first.globals["n"] is not second.globals["n"]


def test_what_was_used_longest_ago_is_let_go():
    kept: KeptUnits[str] = KeptUnits(2, 100)
    kept.put("a", "A", 10)
    kept.put("b", "B", 10)
    assert kept.get("a") == "A"
    kept.put("c", "C", 10)
    assert (kept.get("a"), kept.get("b"), kept.get("c")) == ("A", None, "C")
    assert (len(kept), kept.characters) == (2, 20)


def test_long_texts_push_out_many_and_too_long_ones_none():
    kept: KeptUnits[int] = KeptUnits(50, 100)
    for number in range(20):
        kept.put(number, number, 10)
        assert kept.characters <= 100
    kept.put("long", 1, 95)
    assert (len(kept), kept.characters) == (1, 95)
    kept.put("too long", 1, 101)
    assert kept.get("too long") is None
    kept.put("long", 2, 20)
    assert (kept.get("long"), kept.characters) == (2, 20)
    assert CHARACTERS_MAX < 10**6
