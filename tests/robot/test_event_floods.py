"""A loop that only writes messages or signals keeps up with time, and loses nothing."""

from __future__ import annotations

from collections import Counter

import pytest

from elitescript.robot import VirtualRobot

CALLS = {
    "textmsg": ('textmsg("flood")', "TextMessage"),
    "print": ('print("flood")', "Printed"),
    "a register": ("write_output_integer_register(0, i)", "SignalChanged"),
    "an output": ("set_standard_digital_out(0, i % 2 == 1)", "SignalChanged"),
}


@pytest.mark.parametrize("name", CALLS)
def test_a_tick_has_room_for_a_hundred_events_of_a_thread(name: str) -> None:
    call, kind = CALLS[name]
    run = VirtualRobot().run(f"def job():\n  i = 0\n  while i < 1000:\n    i = i + 1\n    {call}\n  end\nend\n")
    found = Counter(event.tick for event in run.events if type(event).__name__ == kind)
    assert sum(found.values()) == 1000
    assert max(found.values()) <= 100
    assert run.time_s < 0.1


def test_a_handful_of_events_costs_no_time() -> None:
    body = "".join(f'  textmsg("line {n}")\n  write_output_integer_register({n}, 1)\n' for n in range(20))
    run = VirtualRobot().run(f"def job():\n{body}end\n")
    assert {event.tick for event in run.events if type(event).__name__ == "TextMessage"} == {0}
