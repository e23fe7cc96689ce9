"""Mistakes that are planted into sound programs are told; the page of kinds is that of the kinds there are."""

from __future__ import annotations

import ast
import re

import pytest

from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.messages.profile import profile
from tests.mistakes.__main__ import judged
from tests.mistakes.judging import FIRMWARE, Places, Setting
from tests.mistakes.page import COUNT, PAGE, cases_table, rows_of
from tests.mistakes.planting import KINDS, Edit, Program, misspelt, plant
from tests.mistakes.sources import everything, own, sound

SOME = 40
TEXT = """def job():
  limit = 3
  def half(part):
    return part / 2
  end
  for n in range(limit):
    sleep(half(0.5))
  end
end
"""


@pytest.fixture(scope="module")
def small():
    """Programs that take little time."""
    names = ("camera.script", "orders.script", "workers.script", "drive.script", "scale.script")
    made = [sound(*row) for row in own() if row[0] in names]
    assert None not in made
    return tuple(made)


def test_of_some_planted_mistakes_nearly_all_are_told_at_the_right_line(small):
    rows, _ = judged(small, SOME, 7)
    told = [row for row in rows if row[1].is_told]
    assert len(rows) == SOME
    assert [(mistake.kind, mistake.now) for mistake, what in rows if what.is_wrong] == []
    assert len(told) >= SOME - 1, [(mistake.kind, mistake.now) for mistake, what in rows if not what.is_told]


@pytest.mark.slow
def test_of_all_planted_mistakes_nearly_all_are_told():
    rows, _ = judged(everything(), COUNT, 2)
    assert sum(what.is_told for _, what in rows) >= 0.95 * len(rows)


def test_the_same_seed_plants_the_same(small):
    programs = [row.program for row in small]
    first, again, other = (plant(programs, 30, seed)[0] for seed in (1, 1, 2))
    assert first == again != other
    assert len({mistake.text for mistake in first}) == 30


class TestPage:
    def test_its_kinds_are_those_that_there_are(self):
        rows = rows_of(PAGE.read_text(encoding="utf-8"))
        assert list(rows) == [kind.name for kind in KINDS], "run `make mistakes`"

    def test_its_numbers_add_up(self):
        text = PAGE.read_text(encoding="utf-8")
        rows = rows_of(text)
        assert all(row[0] == sum(row[1:]) for row in rows.values())
        told = sum(row[1] + row[2] for row in rows.values())
        assert sum(row[0] for row in rows.values()) == COUNT
        assert f"**{told} of {COUNT} are told" in text
        assert told >= 0.97 * COUNT

    def test_its_table_of_programs_is_up_to_date(self):
        is_same = PAGE.read_text(encoding="utf-8").endswith(cases_table())
        assert is_same, "docs/explanation/mistakes.md is out of date; run `make mistakes`"


class TestPlanting:
    @pytest.fixture
    def program(self):
        return Program("job", TEXT)

    def node(self, program, text):
        return next(node for node in program.every(ast.expr) if program.source(node) == text)

    def test_the_text_is_changed_at_one_place(self, program):
        mistake = program.planted("kind", Edit(self.node(program, "0.5"), "500"))
        assert mistake.text == TEXT.replace("0.5", "500")
        assert (mistake.lines, mistake.was, mistake.now) == ({7}, "0.5", "500")

    def test_names_to_which_the_value_goes(self, program):
        assert program.planted("kind", Edit(self.node(program, "0.5"), "500")).names == {"part"}
        assert program.planted("kind", Edit(self.node(program, "3"), "4")).names == {"limit"}
        assert program.planted("kind", Edit(self.node(program, "2"), "4")).names == {"half"}

    def test_what_means_the_same_is_no_mistake(self, program):
        assert program.planted("kind", Edit(self.node(program, "3"), "(3)")) is None

    def test_no_mistake_is_planted_into_a_line_that_is_not_run(self):
        program = Program("job", TEXT, frozenset({2}))
        assert {node.lineno for node in program.every(ast.Constant)} == {2}

    @pytest.mark.parametrize(
        ("line", "text", "place"),
        [
            (2, "anything", "at"),
            (5, "anything, see line 2", "at"),
            (5, "`limit` is 3", "at"),
            (6, "anything", "at"),
            (7, "anything", "elsewhere"),
        ],
    )
    def test_where_a_report_stands(self, program, line, text, place):
        from elitescript.messages.findings import Finding

        mistake = program.planted("kind", Edit(self.node(program, "3"), "4"))
        assert Places(mistake).of(Finding("W000", "warning", line, 1, text)) == place

    def test_where_a_value_arrives(self, program):
        from elitescript.messages.findings import Finding

        text = TEXT.replace("    sleep(half(0.5))\n", "    pause = half(limit)\n    sleep(pause)\n")
        program = Program("job", text)
        mistake = program.planted("kind", Edit(self.node(program, "3"), "4"))
        assert Places(mistake).of(Finding("W000", "warning", 8, 1, "anything")) == "arrives"

    @pytest.mark.parametrize(("name", "wrong"), [("count", "cuont"), ("aab", "aba"), ("x", "xx")])
    def test_misspelt_names(self, name, wrong):
        assert misspelt(name) == wrong


def test_the_programs_that_were_written_for_it_are_sound():
    texts = list(own())
    assert len(texts) > 10
    for name, text, setting in texts:
        assert isinstance(setting, Setting)
        problems = check_source(SourceFile(name, text), profile(FIRMWARE))
        assert [str(problem) for problem in problems] == []


def test_kinds_have_names_of_their_own():
    assert len({kind.name for kind in KINDS}) == len(KINDS)
    assert not [kind.name for kind in KINDS if re.search(r"[|\n]", kind.name)]
