from __future__ import annotations

import ast

from hypothesis import given
from hypothesis import strategies as st

from elitescript.commands.catalogue import CATALOGUE
from elitescript.errors import ArgumentRangeError, ArgumentTypeError, ScriptError
from elitescript.lint.constants import UNKNOWN, Unknown
from elitescript.lint.refusals import refuse
from tests.lint.checking import problems

CALLABLE = [name for name in sorted(CATALOGUE.names()) if CATALOGUE.get(name).params]


def param(command: str, name: str):
    return next(param for param in CATALOGUE.get(command).params if param.name == name)


def test_the_quantity_itself_refuses():
    error = refuse(param("sleep", "t"), -1)
    assert isinstance(error, ArgumentRangeError)
    assert (error.value, error.limit, error.unit) == (-1, ">= 0", "s")
    assert refuse(param("sleep", "t"), 1) is None


def test_nothing_is_said_about_an_unknown_value():
    assert refuse(param("sleep", "t"), UNKNOWN) is None


def test_the_length_of_a_list_is_certain():
    error = refuse(param("movej", "q"), [Unknown("a"), 0, Unknown("b[0]")])
    assert isinstance(error, ArgumentTypeError)
    assert str(error).endswith("got 3: [a, 0, b[0]]")


def test_so_are_its_known_elements():
    assert "element 1" in str(refuse(param("movej", "q"), [Unknown(), "x", *[Unknown()] * 4]))
    assert refuse(param("movej", "q"), [Unknown(), 0, *[Unknown()] * 4]) is None


def test_a_list_is_no_number_whatever_it_holds():
    assert isinstance(refuse(param("sleep", "t"), [Unknown("x")]), ArgumentTypeError)
    assert isinstance(refuse(param("get_flag", "n"), (Unknown("x"),)), ArgumentTypeError)


def test_elements_with_a_range_get_stand_ins_that_fit():
    """Every list parameter of the catalogue takes a list of unknowns of the right length."""
    for name in CALLABLE:
        for each in CATALOGUE.get(name).params:
            for count in (1, 2, 3, 6):
                error = refuse(each, [Unknown("x")] * count)
                assert error is None or "x" in str(error) or "element" not in str(error), (name, each.name)


VALUES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-3, 300),
    st.sampled_from([0.5, -0.5, 3.0, 1e9]),
    st.sampled_from(["", "a", "stop", "xmlrpc"]),
    st.lists(st.sampled_from([0, 1, 0.5, "a"]), max_size=7),
)


@given(st.sampled_from(CALLABLE), st.lists(VALUES, max_size=6))
def test_check_and_run_never_disagree(name, values):
    """A call of literals has a finding if and only if the command refuses it."""
    command = CATALOGUE.get(name)
    text = f"{name}({', '.join(map(repr, values))})"
    found = [problem.code for problem in problems(text) if problem.code.startswith("E3") and problem.code != "E302"]
    if "E302" in [problem.code for problem in problems(text)]:
        return
    try:
        command.bind(tuple(ast.literal_eval(f"[{', '.join(map(repr, values))}]")), {})
    except ScriptError:
        assert found, text
    else:
        assert found == [], text
