from __future__ import annotations

import pytest

from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.foreign import FOREIGN
from tests.lint.checking import body, found, marked, only, repaired


def test_a_call_of_nothing_is_found():
    assert body("gripper_shut(40)") == ["E301 2:3"]
    assert marked("def job():\n  x = 1 + gripper_shut(40)\nend\n") == "gripper_shut"


def test_a_slip_is_recognised_and_can_be_repaired():
    text = "def job():\n  set_standard_digital_output(1, True)\nend\n"
    assert only(text).hint == "is `set_standard_digital_out` meant?"
    assert repaired(text) == "def job():\n  set_standard_digital_out(1, True)\nend\n"


def test_the_programs_own_functions_are_candidates_too():
    text = "def job():\n  def open_gripper():\n    pass\n  end\n  open_griper()\nend\n"
    assert only(text).hint == "is `open_gripper` meant?"


def test_capital_letters_are_a_slip():
    assert only("def job():\n  MoveJ([0, 0, 0, 0, 0, 0])\nend\n").hint == "is `movej` meant?"


@pytest.mark.parametrize(("name", "meant"), FOREIGN.items())
def test_names_of_other_languages_lead_to_commands_that_exist(name, meant):
    assert CATALOGUE.get(name) is None
    assert CATALOGUE.get(meant) is not None
    assert only(f"def job():\n  {name}(1)\nend\n").hint == f"here the command is called {meant}"


def test_a_reserved_word_is_said_to_be_one():
    assert "reserved" in only("def job():\n  set_tool_output_mode(1)\nend\n").hint


@pytest.mark.parametrize(
    "lines",
    [
        ("def f():", "  pass", "f()"),
        ("f = lambda: 1", "f()"),
        ("class Box:", "  pass", "Box()"),
        ("from math import gcd", "gcd(4, 6)"),
        ("def f(g):", "  g()", "f(print)"),
        ("d = rpc_factory('xmlrpc', 'http://127.0.0.1:9')", "d.anything()"),
        ("textmsg(str(len([1])))",),
        ("try:", "  new_thing()", "except NameError:", "  pass"),
    ],
    ids=str,
)
def test_what_is_defined_can_be_called(lines):
    assert body(*lines) == []


def test_a_secondary_program_may_call_functions_of_the_running_program():
    assert found("sec lamp():\n  switch_lamp(1)\nend\n") == []
    assert found("sec lamp():\n  set_digital_out(1, True)\nend\n") == ["E301 2:3"]
    assert found("sec lamp():\n  textmgs(1)\nend\n") == ["E301 2:3"]


def test_a_bare_script_may_call_what_the_pendant_makes():
    assert found("subTask_1()\n") == []


def test_names_of_python_2_have_their_own_code():
    assert body("xrange(3)") == ["W209 2:3"]
