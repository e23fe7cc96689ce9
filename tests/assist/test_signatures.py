"""Signatures at marked places, with the parameter that is active."""

from __future__ import annotations

import pytest

from elitescript.assist.signatures import signature_help
from tests.assist.reading import marked

OWN = "def f(a, b=1, *more, c=2):\n  # Adds.\n  return a\nend\n"

# Text with a cursor, begin of the signature, the active parameter; "" for none.
TABLE = [
    ("movej(¦", "movej(q, a=1.396263", "q"),
    ("movej(¦)", "movej(", "q"),
    ("movej(q, ¦)", "movej(", "a=1.396263"),
    ("movej(q,¦a)", "movej(", "a=1.396263"),
    ("movej(q, 1, 2, 3, ¦", "movej(", "r=0"),
    ("movej(q, 1, 2, 3, 4, ¦", "movej(", ""),
    ("movej(q, v=¦", "movej(", "v=1.047197"),
    ("movej(q, v=1¦, a=2)", "movej(", "v=1.047197"),
    ("movej(q, v = ¦", "movej(", "v=1.047197"),
    ("movej(v=1, ¦", "movej(", "q"),
    ("movej(q, speed=¦", "movej(", ""),
    ("movej([0, ¦", "movej(", "q"),
    ("movej([0, 1, 2, 3, 4, 5], ¦", "movej(", "a=1.396263"),
    ("movej([0, (1, 2), ¦", "movej(", "q"),
    ("movej(get_inverse_kin(¦", "get_inverse_kin(p", "p"),
    ("movej(get_inverse_kin(p, ¦), a=1)", "get_inverse_kin(p", "qnear=''"),
    ("movej(get_inverse_kin(p), ¦", "movej(", "a=1.396263"),
    ("movej(¦get_inverse_kin(p))", "movej(", "q"),
    ('socket_send_line("a, b", ¦', "socket_send_line(", "linefeed_type=0"),
    ('socket_send_line("a, ¦', "socket_send_line(", "str"),
    ('socket_send_line("a, ¦b", 1)', "socket_send_line(", "str"),
    ("x = movej(q, # a, b, c\n  ¦", "movej(", "a=1.396263"),
    ("movel(p,\n  a=1,\n  v=¦\n)", "movel(", "v=0.25"),
    ("textmsg(1, 2, 3, ¦", "textmsg(", "s2=''"),
    ("if movej(q, ¦:\n  x = 1", "movej(", "a=1.396263"),
    (OWN + "f(¦", "f(a, b=1, *more, c=2)", "a"),
    (OWN + "f(1, ¦)", "f(", "b=1"),
    (OWN + "f(1, 2, 3, 4, ¦)", "f(", "*more"),
    (OWN + "f(1, c=¦)", "f(", "c=2"),
    (OWN + "x = (f(1, [2, ¦", "f(", "b=1"),
    ("class A:\n  def __init__(self, x, y=1):\n    self.x = x\n  end\nend\nA(1, ¦)", "A(x, y=1)", "y=1"),
    ("class A:\n  def go(self, far):\n    pass\n  end\nend\na = A()\na.go(¦)", "a.go(far)", "far"),
    ("import math\nmath.atan2(1, ¦", "math.atan2(y, x)", "x"),
    ("s = 'a'\ns.replace(¦", "s.replace(old, new", "old"),
    ("len(¦", "len(obj)", "obj"),
    ("print(1, 2, ¦", "print(*args", "*args"),
    ("start_thread(f, (1, ¦", "start_thread(", "args=()"),
]

NOTHING = [
    "movej¦(q)",
    "movej(q)¦",
    "f(¦",
    "x = (1, ¦",
    "x = [1, ¦",
    "def f(a, ¦",
    "def movej(¦",
    "# movej(¦",
    "x = 'movej(¦",
    "movej(q)\n¦",
    "movej = 3\nmovej(¦",
    "¦",
]


@pytest.mark.parametrize(("text", "label", "active"), TABLE)
def test_signature_and_active_parameter(text, label, active):
    found = signature_help(*marked(text))
    assert found is not None
    assert found.label.startswith(label)
    shown = "" if found.active is None else found.parameters[found.active]
    assert (shown and found.label[shown.start : shown.end]) == active


@pytest.mark.parametrize("text", NOTHING)
def test_where_there_is_none(text):
    assert signature_help(*marked(text)) is None


def test_unit_and_range_are_bold():
    found = signature_help(*marked("movej(q, v=¦"))
    assert found is not None
    assert found.parameters[2].markdown.startswith("`v`: **float, >= 0** **[rad/s]**, default `1.047197`")
    assert found.markdown.startswith("Move straight in joint space")


def test_the_element_of_a_list_is_named():
    found = signature_help(*marked("movel([0.4, 0.2, ¦"))
    assert found is not None
    assert found.parameters[0].markdown.startswith("**z [m]** of `p`")
    found = signature_help(*marked("movel([0.4, 0.2, 0.3, ¦"))
    assert found is not None
    assert found.parameters[0].markdown.startswith("**Rx [rad]** of `p`")


def test_an_own_function_shows_its_comment():
    found = signature_help(*marked(OWN + "f(¦"))
    assert found is not None
    assert found.markdown == "Adds."


def test_what_a_stranger_wrote_is_text_and_no_link() -> None:
    document, line, column = marked('def go(a):\n  """[run](command:a.b) <b>"""\n  sleep(1)\nend\ngo(¦)\n')
    found = signature_help(document, line, column)
    assert found is not None
    assert found.markdown == r"\[run\](command:a.b) \<b\>"
