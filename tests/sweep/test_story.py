"""A story says what failed with its name, how far it was missed, and each value once."""

from __future__ import annotations

from elitescript import VirtualRobot
from elitescript.sweep.failures.story import tell
from elitescript.sweep.plans.plan import Choices, Failure

PROGRAM = "def cell():\n  sleep(1)\nend\n"


def told(failure: Failure, values: dict[str, float] | None = None) -> tuple[str, ...]:
    run = VirtualRobot("CS66").run(PROGRAM, until_s=5)
    return tell(Choices(0, 1, values or {}, ()), failure, run).lines


def test_an_expression_is_named_and_its_margin_is_said_once():
    failure = Failure("time_s < 0.5", "finished", text="time_s is 1.0, missed by 0.5 s", margin=-0.5)
    assert told(failure)[0] == "`time_s < 0.5` does not hold: time_s is 1.0, missed by 0.5 s."


def test_values_stand_in_the_sentence_alone_if_nothing_went_wrong():
    failure = Failure("no_contact", "finished", text="arm touches table: 19.0 mm deep", t=0.5, margin=-0.019)
    lines = told(failure, {"x": 0.25})
    assert lines == (
        "With x = 0.25; arm touches table: 19.0 mm deep.",
        "    0.500 s  arm touches table: 19.0 mm deep",
    )


def test_a_limit_has_its_margin_in_brackets():
    lines = told(Failure("joint_range(0.05)", "finished", text="joint base is nearest", t=0.5, margin=-0.25))
    assert lines[0] == "Joint base is nearest (by 0.25)."
