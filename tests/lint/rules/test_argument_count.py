from __future__ import annotations

import pytest

from tests.lint.checking import body, marked, only, repaired


@pytest.mark.parametrize(
    ("call", "column"),
    [
        ("set_standard_digital_out(1)", 3),
        ("sleep()", 3),
        ("sleep(1, 2)", 12),
        ("sync(1)", 8),
        ("movel([0, 0, 0, 0, 0, 0], speed=0.1)", 29),
        ("sleep(1, t=1)", 12),
        ("x = d2r()", 7),
        ("movel(pose=[0, 0, 0, 0, 0, 0], p=[0, 0, 0, 0, 0, 0])", 34),
    ],
)
def test_a_call_that_cannot_be_made_is_found_at_what_is_wrong(call, column):
    assert body(call) == [f"E303 2:{column}"]


@pytest.mark.parametrize(
    "call",
    [
        "movej([0, 0, 0, 0, 0, 0], 1, 1, 0, 0)",
        "movej(q=[0, 0, 0, 0, 0, 0], v=1)",
        "movel(pose=[0, 0, 0, 0, 0, 0])",
        "textmsg('a', 'b', 'c')",
        "textmsg('a')",
        "args = (1, True); set_standard_digital_out(*args)",
        "args = {'n': 1, 'b': True}; set_standard_digital_out(**args)",
        "sync()",
    ],
)
def test_what_binds_is_left_alone(call):
    assert body(call) == []


def test_names_are_certain_even_beside_spread_arguments():
    assert body("args = (1,)", "sleep(*args, seconds=2)") == ["E303 3:16"]


def test_a_misspelt_name_is_not_reported_as_missing_too():
    assert body("set_standard_digital_out(1, value=True)") == ["E303 2:31"]


@pytest.mark.parametrize(
    ("call", "text"),
    [
        ("sleep()", "sleep misses the argument `t`"),
        ("set_flag()", "set_flag misses the arguments `n`, `b`"),
        ("sleep(1, 2)", "sleep takes 1 argument, got 2"),
        ("sync(1)", "sync takes no arguments, got 1"),
        ("popup(1, 2, 3, 4, 5, 6)", "popup takes at most 5 arguments, got 6"),
        ("sleep(seconds=2)", "sleep has no argument `seconds`; its arguments: t"),
        ("sleep(1, t=1)", "sleep gets the argument `t` twice"),
    ],
)
def test_the_text_says_what_is_wrong(call, text):
    problem = only(f"def job():\n  {call}\nend\n")
    assert problem.text == text
    assert problem.hint.startswith("it is called as ")


def test_a_keyword_is_underlined_with_its_value():
    assert marked("def job():\n  sleep(seconds=2)\nend\n") == "seconds=2"


def test_a_function_of_the_program_is_not_the_command():
    assert [f for f in body("def sleep(a1, b1):", "  pass", "sleep(1, 2)") if f.startswith("E")] == []
    assert [f for f in body("def f(sleep):", "  sleep(1, 2)", "f(max)") if f.startswith("E")] == []


def test_a_misspelt_keyword_is_repaired_by_hand_only():
    text = "def job():\n  socket_close(socket_nam='a')\nend\n"
    problem = only(text)
    assert problem.fix is not None
    assert not problem.fix.safe
    assert repaired(text) == text.replace("socket_nam=", "socket_name=")
    assert only("def job():\n  socket_close(wrong='a')\nend\n").fix is None


OWN = ("def f(a, b=1, *, c=2):", "  textmsg(a, b + c)", "end")


@pytest.mark.parametrize(
    ("call", "words"),
    [
        ("f()", "f misses the argument 'a'"),
        ("f(1, 2, 3)", "f takes 2 arguments, and gets 3"),
        ("f(1, d=2)", "f has no argument 'd'"),
        ("f(1, a=2)", "f gets 'a' twice"),
        ("h = start_thread(f, ())", "f misses the argument 'a'"),
        ("h = start_thread(f, (1, 2, 3))", "f takes 2 arguments, and gets 3"),
    ],
)
def test_a_function_of_the_program_is_called_with_its_arguments(call, words):
    problem = only("def job():\n" + "".join(f"  {line}\n" for line in (*OWN, call)) + "end\n")
    assert (problem.code, problem.line, problem.text) == ("E303", 5, words)
    assert problem.hint == "line 2 has def f(a, b=1, *, c=2)"


def test_calls_that_may_fit_are_left_alone():
    calls = ("f(1)", "f(1, 2, c=3)", "x = [1]", "f(*x)", "y = {}", "f(**y)", "h = start_thread(f, (1,))")
    assert body(*OWN, *calls) == []
    assert body("def f(*a, **k):", "  sync()", "end", "f()", "f(1, 2)", "f(x=1)") == []
    assert (
        body("def f(a):", "  sync()", "end", "if get_flag(0):", "  def f():", "    sync()", "  end", "end", "f()") == []
    )
