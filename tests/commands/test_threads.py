from __future__ import annotations

from functools import partial
from typing import Any

import pytest

from elitescript.errors import ArgumentTypeError, ScriptStateError


def work(*args: Any) -> None:
    raise AssertionError("a command never runs the function itself")


@pytest.mark.parametrize(
    ("args", "kwargs"),
    [
        ((work, (1, 3)), {}),
        ((work, [1, 3]), {}),
        ((work, (1, 3), False), {}),
        ((), {"function": work, "args": (1, 3)}),
        ((), {"fundef": work, "arg": (1, 3)}),
    ],
)
def test_start_thread_takes_both_sets_of_names_and_returns_a_handle(
    call: Any, robot: Any, args: Any, kwargs: Any
) -> None:
    assert call("start_thread", *args, **kwargs) == -81230
    assert robot.asked == [("start_thread", work, (1, 3), "work")]


def test_arguments_keep_their_identity(call: Any, robot: Any) -> None:
    shared: list[int] = []
    call("start_thread", work, (shared,))
    assert robot.asked[0][2][0] is shared


def test_arguments_may_be_left_out_and_functions_may_lack_a_name(call: Any, robot: Any) -> None:
    call("start_thread", partial(work, 1))
    assert robot.asked[0][2:] == ((), "thread")


@pytest.mark.parametrize(("args", "hint"), [(1, "(1,)"), ("ab", "(x,)"), (2.5, "(2.5,)"), ({}, "(x,)")])
def test_one_argument_without_its_comma_gets_a_hint(call: Any, args: Any, hint: str) -> None:
    with pytest.raises(ArgumentTypeError, match=r"^start_thread: args must be a tuple, not ") as caught:
        call("start_thread", work, args)
    assert hint in (caught.value.hint or "")


def test_a_called_function_gets_a_hint(call: Any) -> None:
    with pytest.raises(ArgumentTypeError, match=r"^start_thread: function must be a function, not None") as caught:
        call("start_thread", None, ())
    assert "without parentheses" in (caught.value.hint or "")


def test_too_many_threads_is_refused_by_the_program(call: Any, robot: Any) -> None:
    robot.refusal = ScriptStateError("15 threads run already", code="R121")
    with pytest.raises(ScriptStateError, match=r"^start_thread: 15 threads run already") as caught:
        call("start_thread", work)
    assert caught.value.code == "R121"


def test_handles_are_passed_on_even_when_they_are_none(call: Any, robot: Any) -> None:
    call("stop_thread", 0)
    call("join_thread", -5)
    assert robot.asked == [("stop_thread", 0), ("join_thread", -5)]
