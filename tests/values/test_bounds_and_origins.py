"""What is cut off is unknown, and nothing is found in it; origins that a value may have, and those it must have."""

from __future__ import annotations

import ast

import pytest

from elitescript.values.description import (
    ANY,
    COMPUTED,
    CONSTANTS_MAX,
    DEPTH_MAX,
    LITERAL,
    MEASURED,
    REFERENCES_MAX,
    SIZE_MAX,
    SOME_INT,
    UNKNOWN,
    constant,
    join,
    join_all,
)
from elitescript.values.evaluation import Evaluation
from elitescript.values.program import Values
from elitescript.values.state import GivenUp
from tests.lint.checking import body, found
from tests.values.test_values import described

MANY = "".join(f"if get_flag({n}):\n  x = {n}.5\nend\n" for n in range(CONSTANTS_MAX + 3))


def test_of_many_constants_the_range_stays():
    value = described(f"x = 0.5\n{MANY}textmsg(x)")
    assert value.constants is None
    assert (value.low, value.high) == (0.5, CONSTANTS_MAX + 2.5)


def test_of_a_list_too_long_to_describe_the_elements_stay():
    value = described(f"x = [1, 2.5] * {SIZE_MAX}\ntextmsg(x)")
    assert value.items is None
    assert value.shape.most == 2 * SIZE_MAX
    assert (value.shape.any.low, value.shape.any.high) == (1, 2.5)


def test_what_is_nested_deeper_than_the_bound_is_unknown():
    value = described(f"x = {'[' * (DEPTH_MAX + 2)}1{']' * (DEPTH_MAX + 2)}\ntextmsg(x)")
    while value.shape is not None:
        value = value.shape.any
    assert value.kinds == ANY or value.shape is None
    assert value.constants in ((), None)


def test_of_more_functions_than_are_followed_the_result_is_unknown():
    count = REFERENCES_MAX + 1
    functions = "".join(f"def g{n}():\n  return {n}\nend\n" for n in range(count))
    chosen = "".join(f"if get_flag({n}):\n  h = g{n}\nend\n" for n in range(count))
    assert described(f"{functions}h = g0\n{chosen}textmsg(h())").kinds == ANY
    few = "h = g0\nif get_flag(0):\n  h = g1\nend\n"
    assert set(described(f"{functions}{few}textmsg(h())").constants) == {0, 1}


def test_a_program_that_is_given_up_has_no_findings_of_values(monkeypatch):
    text = "x = get_standard_digital_in(0) == 'True'\n"
    assert found(text) != []

    def give_up(self):
        raise GivenUp

    monkeypatch.setattr(Evaluation, "run", give_up)
    assert found(text) == []


def test_findings_count_only_if_every_evaluation_of_the_place_agrees():
    both = "def is_on(x):\n  return x == 'on'\nend\na = is_on(get_flag(0))\n"
    assert [row.partition(" ")[0] for row in body(*both.splitlines())] == ["W240"]
    assert body(*f"{both}b = is_on(socket_read_string())".splitlines()) == []


def test_what_may_be_and_what_must_be_are_two_things():
    measured = described("textmsg(get_actual_joint_positions()[0])")
    literal, computed = constant(1.0), SOME_INT
    assert (measured.may, measured.must) == (MEASURED, MEASURED)
    for other, origin in ((literal, LITERAL), (computed, COMPUTED)):
        both = join(measured, other)
        assert both.may == MEASURED | origin
        assert both.must == 0
    assert join_all([literal, constant(2)]).must == LITERAL
    assert join(measured, UNKNOWN).must == 0


@pytest.mark.parametrize(
    ("lines", "must"),
    [
        ("x = get_actual_joint_positions()[0] + 1", MEASURED),
        ("x = abs(get_actual_joint_positions()[0])", MEASURED),
        ("x = len(get_actual_joint_positions())", COMPUTED),
        ("x = 2 * 3", LITERAL),
        ("x = random()", COMPUTED),
        ("x = random() + 1", COMPUTED),
        ("x = None\nif get_flag(0):\n  x = get_actual_joint_positions()[0]\nend\nassert x is not None", MEASURED),
        ("x = 0.5\nif get_flag(0):\n  x = get_actual_joint_positions()[0]\nend", 0),
    ],
)
def test_origins(lines, must):
    assert described(f"{lines}\ntextmsg(x)").must == must


def test_the_maximum_of_evaluations_gives_the_program_up(monkeypatch):
    monkeypatch.setattr("elitescript.values.evaluation.EVALUATIONS_MAX", 0)
    from elitescript.language.parser import parse
    from elitescript.language.symbols import Symbols
    from elitescript.language.text.source import SourceFile

    symbols = Symbols(parse(SourceFile("<test>", "x = 1\ntextmsg(x)\n")))
    values = Values(symbols)
    assert not values.is_known
    assert all(values.of(node) is UNKNOWN for node in ast.walk(symbols.parsed.tree) if isinstance(node, ast.expr))
