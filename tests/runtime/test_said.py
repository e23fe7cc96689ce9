"""What a program may say in a tick, and at once; the same in every kind of run."""

import pytest

from elitescript import VirtualRobot
from elitescript.messages.events import Alarm
from elitescript.runtime.threads.said import TEXT_AHEAD, TEXT_MAX, TEXT_PER_TICK, SaidText


def test_text_leaves_tick_by_tick():
    said = SaidText()
    assert said.wait_ticks(0) == 0
    said.add(TEXT_AHEAD, 0)
    assert said.wait_ticks(0) == 0
    said.add(1, 0)
    assert said.wait_ticks(0) == 1
    said.add(3 * TEXT_PER_TICK - 1, 0)
    assert [said.wait_ticks(tick) for tick in range(5)] == [3, 2, 1, 0, 0]
    said.add(10, 100)
    assert said.wait_ticks(100) == 0


@pytest.mark.parametrize(
    "say", ["textmsg(text)", "print(text)", 'popup(text, "t", False, False, False)', "print(text, end='\\n')"]
)
def test_a_program_that_says_more_than_clients_take_is_held_up(say):
    text = f'def p():\n  text = "x" * {TEXT_AHEAD - 1}\n  for n in range(5):\n    {say}\n  end\nend\n'
    run = VirtualRobot().run(text).check()
    texts = [event for event in run.events if type(event).__name__ in ("TextMessage", "Printed", "Popup")]
    assert len(texts) == 5
    # The first is free, each further one waits until the one before has left.
    assert [event.tick for event in texts] == [0, 0, *(n * TEXT_AHEAD // TEXT_PER_TICK for n in (1, 2, 3))]


@pytest.mark.parametrize(
    "say", ["textmsg(text)", "print(text)", 'popup(text, "t", False, False, False)', "print(text, end='')"]
)
def test_a_text_that_no_client_can_take_is_an_alarm_on_its_line(say):
    run = VirtualRobot().run(f'def p():\n  text = "x" * {TEXT_MAX + 1}\n  {say}\nend\n')
    (alarm,) = [event for event in run.events if isinstance(event, Alarm)]
    assert (alarm.code, alarm.line) == ("R104", 3)
    assert f"at most {TEXT_MAX}" in alarm.text


def test_an_alarm_repeats_the_begin_of_a_long_text():
    run = VirtualRobot().run('def p():\n  raise ValueError("x" * 3000000)\nend\n')
    (alarm,) = [event for event in run.events if isinstance(event, Alarm)]
    assert len(alarm.text) < 20_000
    assert "(3000000 characters)" in alarm.text
