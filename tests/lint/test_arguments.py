from __future__ import annotations

import ast

import pytest
from hypothesis import given
from hypothesis import strategies as st

from elitescript.commands.catalogue import CATALOGUE
from elitescript.errors import ArgumentCountError, ScriptError
from elitescript.lint.arguments import arrange

NAMES = sorted(CATALOGUE.names())


def arranged(text: str):
    call = ast.parse(text, mode="eval").body
    assert isinstance(call, ast.Call)
    assert isinstance(call.func, ast.Name)
    return arrange(CATALOGUE.get(call.func.id), call, {})


def given_values(text: str) -> dict[str, str]:
    return {param.name: ast.unparse(node) for param, node in arranged(text).given}


def test_arguments_go_to_their_parameters():
    assert given_values("movej(x, 1, v=2, t=3)") == {"q": "x", "a": "1", "v": "2", "t": "3"}


def test_other_spellings_go_to_the_same_parameter():
    assert given_values("movel(pose=x)") == {"p": "x"}


def test_behind_a_spread_list_only_names_are_certain():
    assert given_values("movej(*x, v=2)") == {"v": "2"}
    assert arranged("movej(*x)").misfits == ()
    assert arranged("movej(**x)").misfits == ()


def test_surplus_arguments_of_commands_that_take_more_are_fine():
    assert arranged("textmsg(1, 2, 3, 4)").misfits == ()


@pytest.mark.parametrize(
    ("text", "node"),
    [("sleep(1, a)", "a"), ("sleep(1, t=b)", "b"), ("sleep(s=c)", "c"), ("sleep()", "sleep")],
)
def test_a_misfit_points_at_what_is_wrong(text, node):
    (misfit,) = arranged(text).misfits
    assert ast.unparse(misfit.node.value if isinstance(misfit.node, ast.keyword) else misfit.node) == node


@given(
    st.sampled_from(NAMES),
    st.integers(0, 7),
    st.lists(st.tuples(st.integers(0, 9), st.integers(0, 3)), max_size=4, unique_by=lambda pair: pair[0]),
)
def test_a_call_fits_before_the_run_if_and_only_if_it_fits_in_it(name, count, picks):
    """The check and `Command.bind` have the same rules."""
    command = CATALOGUE.get(name)
    keywords = []
    for index, spelling in picks:
        if index < len(command.params):
            param = command.params[index]
            keywords.append((param.name, *param.spellings)[spelling % (1 + len(param.spellings))])
        else:
            keywords.append(f"unknown_{index}")
    text = f"{name}({', '.join([*['x'] * count, *[f'{keyword}=x' for keyword in keywords]])})"
    fits = not arranged(text).misfits
    try:
        command.bind((object(),) * count, dict.fromkeys(keywords, object()))
    except ArgumentCountError:
        assert not fits
    except ScriptError:
        assert fits
    else:
        assert fits
