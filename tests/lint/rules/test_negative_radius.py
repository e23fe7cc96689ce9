from elitescript.messages.events import Warned
from elitescript.robot import VirtualRobot
from tests.lint.checking import body, only

LINE = "movej([0, -1.57, 1.57, 0, 1.57, 0], r=-0.0005)"


def test_a_negative_radius_that_the_command_takes_is_found():
    assert body(LINE) == ["W250 2:41"]


def test_a_radius_that_it_refuses_is_the_other_finding():
    assert body(LINE.replace("-0.0005", "-0.5")) == ["E305 2:41"]


def test_a_radius_of_zero_or_more_and_one_that_is_not_known_are_left_alone():
    assert body(LINE.replace("-0.0005", "0")) == []
    assert body(LINE.replace("-0.0005", "get_flag(0) - 0.0005")) == []


def test_the_run_says_the_same():
    text = f"def job():\n  {LINE}\nend\n"
    problem = only(text)
    run = VirtualRobot().run(text)
    (warning,) = [event for event in run.events if isinstance(event, Warned)]
    assert (warning.code, warning.line, warning.text, warning.hint) == (
        problem.code,
        problem.line,
        problem.text,
        problem.hint,
    )
