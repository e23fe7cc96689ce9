from __future__ import annotations

import pytest

from tests.lint.checking import body, only


@pytest.mark.parametrize(("firmware", "findings"), [("2.10", ["E302 2:16", "E302 3:3"]), ("2.14", [])])
def test_a_command_of_a_newer_firmware_is_found_wherever_it_is_named(firmware, findings):
    assert body("start_thread(pause, ())", "halt()", firmware=firmware) == findings


def test_the_needed_firmware_is_named():
    problem = only("def job():\n  halt()\nend\n", firmware="2.10")
    assert problem.text == "halt needs firmware 2.14 or newer; the chosen one is 2.10"
    assert problem.hint == "if the robot has it, choose --firmware 2.14"


def test_no_firmware_of_ours_has_it_yet():
    problem = only("def job():\n  set_tool_second_power_on(True)\nend\n")
    assert problem.code == "E302"
    assert problem.hint == "the newest firmware that is simulated is 2.14"


def test_its_arguments_are_not_looked_at():
    assert body("halt(1, 2, 3)", firmware="2.10") == ["E302 2:3"]


def test_a_program_may_bring_its_own():
    assert [f for f in body("def halt():", "  pass", "halt()", firmware="2.10") if f.startswith("E")] == []


def test_a_program_that_catches_name_errors_may_ask():
    assert body("try:", "  halt()", "except NameError:", "  pass", firmware="2.10") == []
