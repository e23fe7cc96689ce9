from __future__ import annotations

import pytest

from tests.lint.checking import body, marked, only


@pytest.mark.parametrize(
    ("call", "column"),
    [
        ("sleep('1')", 9),
        ("sleep(t=None)", 11),
        ("movej([0, -1.57, 1.57, 0, 0])", 9),
        ("movej([0, -1.57, get_flag(1), 0, 0])", 9),
        ("movej([0, 'a', 0, 0, 0, 0])", 9),
        ("movej(5)", 9),
        ("movej(get_flag(1))", 9),
        ("stop_thread(print)", 15),
        ("movej(socket_read_ascii_float(3))", 9),
        ("sleep(socket_read_string())", 9),
        ("sleep(movej([0, 0, 0, 0, 0, 0]))", 9),
        ("socket_send_string(b'ab')", 22),
        ("set_standard_digital_out(1.0, True)", 28),
        ("set_standard_digital_out(1, 'on')", 31),
        ("x = str_len(5)", 15),
        ("start_thread('work', ())", 16),
        ("set_tcp([0, 0, 0.1])", 11),
        ("sleep([get_steptime()])", 9),
    ],
)
def test_a_literal_of_the_wrong_type_is_found_at_the_argument(call, column):
    assert body(call) == [f"E304 2:{column}"]


@pytest.mark.parametrize(
    "lines",
    [
        ("sleep(1)", "sleep(True)", "set_standard_digital_out(0, 1)"),
        ("movej((0, 0, 0, 0, 0, 0))",),
        ("movej([0, d2r(-90), get_steptime(), 0, 0, 0])",),
        ("x = eval('1')", "sleep(x)", "movej(x)", "movej([x, *[1, 2, 3], 0])"),
        ("textmsg(None, [1, 2])",),
        ("x = get_inverse_kin([0.4, 0, 0.3, 0, 0, 0], qnear='')",),
        ("def f(*given):", "  pass", "start_thread(f, ())", "start_thread(f, [])", "start_thread(f, (f, 1))"),
        ("x = length('abc') + length([1, 'a', get_flag(1)])",),
    ],
    ids=str,
)
def test_what_may_fit_is_left_alone(lines):
    assert [finding for finding in body(*lines) if finding.startswith("E")] == []


def test_a_value_that_a_name_always_has_counts():
    assert body("HOME = [0, -1.57, 0, 0, 0]", "movej(HOME)") == ["E304 3:9"]


def test_a_tuple_of_one_that_lacks_its_comma_gets_a_hint():
    problem = only("def job():\n  def f(n):\n    pass\n  end\n  start_thread(f, (1))\nend\n")
    assert (problem.code, problem.line, problem.column) == ("E304", 5, 20)
    assert problem.hint == "a tuple of one element needs a comma: (1,)"


def test_the_text_is_that_of_the_alarm():
    assert only("def job():\n  sleep('1')\nend\n").text == "sleep: t must be a number, not str '1'"


def test_uncertain_elements_are_shown_as_they_are_written():
    problem = only("def job():\n  x = get_steptime()\n  movej([0, x, d2r(90)])\nend\n")
    assert "got 3: [0, x, 1.57" in problem.text


def test_the_argument_is_underlined():
    assert marked("def job():\n  sleep(t = '1' )\nend\n") == "'1'"
