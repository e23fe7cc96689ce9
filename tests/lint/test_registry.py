from __future__ import annotations

import pytest

from elitescript.errors import CODES, InternalError
from elitescript.language.parser import parse
from elitescript.language.text.source import SourceFile
from elitescript.lint import rules
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import all_rules, rule, rules_for
from elitescript.messages.profile import profile

REPORTED_ELSEWHERE = {"W210", "W222", "N225", "W226", "W227", "W228", "W229", "N227"}
"""What the language package reports while it reads the text, and the environment while it reads a task."""

OF_RUNS = ("W27", "W28", "W29", "N28", "N29")
"""Begin of the codes of what only a run can find."""


OF_TEXTS = frozenset(("N287", "W276", "W277", "W278", "W279"))
"""Codes between them that `check` finds, N287 beside the run."""


def test_every_code_of_the_checker_has_one_rule():
    codes = [each.code for each in all_rules()]
    wanted = {code for code in CODES if code[:2] in ("W2", "E3", "N2") and code[:3] not in OF_RUNS} - REPORTED_ELSEWHERE
    assert len(codes) == len(set(codes))
    assert set(codes) == wanted | OF_TEXTS


@pytest.mark.parametrize("each", all_rules(), ids=lambda each: each.code)
def test_a_rule_explains_itself_with_an_example(each):
    lines = each.explanation.split("\n")
    assert lines[0].endswith(".")
    assert any(line.startswith("    ") and each.code in line for line in lines), "no example"
    assert each.check.__doc__


@pytest.mark.parametrize("each", all_rules(), ids=lambda each: each.code)
def test_a_rule_has_a_file_of_its_own(each):
    assert [other.code for other in all_rules() if other.check.__module__ == each.check.__module__] == [each.code]
    assert each.check.__module__.startswith(f"{rules.__name__}.")


def test_rules_come_in_the_order_of_their_codes():
    codes = [each.code for each in all_rules()]
    assert codes == sorted(codes)


@pytest.mark.parametrize("code", ["W201", "X999"])
def test_a_code_that_is_taken_or_unknown_is_a_mistake_of_ours(code):
    with pytest.raises(InternalError, match=code):
        rule(code=code, since="0.1")(lambda program: [])


def test_codes_that_a_rule_replaces_exist():
    assert {code for each in all_rules() for code in each.instead_of} <= set(CODES)


def test_a_short_text_needs_few_rules():
    assert len(rules_for('textmsg("hello")')) <= len(all_rules()) * 2 // 3


@pytest.mark.parametrize("each", all_rules(), ids=lambda each: each.code)
def test_the_words_of_a_rule_are_in_its_own_example(each):
    example = "\n".join(line for line in each.explanation.split("\n") if line.startswith("    "))
    assert each in rules_for(example)


def test_a_rule_that_is_not_loaded_finds_nothing():
    """In the examples of all rules, and in programs that name little."""
    texts = [
        "\n".join(line[4:] for line in each.explanation.split("\n") if line.startswith("    ")) for each in all_rules()
    ]
    texts += ["def job():\n  stopj(200)\nend\n", "sec s():\n  sleep(1)\nend\n", "stopl(9000)", "x = y"]
    for text in texts:
        program = AnalysedProgram(parse(SourceFile("<example>", text)), profile())
        needed = rules_for(text)
        for each in all_rules():
            # Of a function beside a program W214 says more.
            assert each in needed or each.code == "N228" or list(each.check(program)) == [], (each.code, text)
