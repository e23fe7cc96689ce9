from __future__ import annotations

import pytest

from elitescript.commands.catalogue import CATALOGUE
from tests.lint.checking import body, only


@pytest.fixture(autouse=True)
def _zeroing_is_not_simulated(monkeypatch):
    monkeypatch.setattr(CATALOGUE.get("zero_ftsensor"), "is_simulated", False)


def test_a_command_that_will_refuse_is_named():
    problem = only("def job():\n  zero_ftsensor()\nend\n")
    assert (problem.code, problem.severity) == ("W260", "warning")
    assert problem.text == "zero_ftsensor is not simulated: the program ends with an alarm (R106) when it is reached"


def test_wherever_it_is_named():
    assert body("start_thread(zero_ftsensor, ())", "zero_ftsensor()") == ["W260 2:16", "W260 3:3"]


def test_commands_that_are_simulated_are_not():
    assert body("path_offset_enable()", "movej([0, 0, 0, 0, 0, 0])") == []


def test_a_firmware_without_the_command_has_another_problem(monkeypatch):
    monkeypatch.setattr(CATALOGUE.get("halt"), "is_simulated", False)
    assert body("halt()", firmware="2.10") == ["E302 2:3"]
