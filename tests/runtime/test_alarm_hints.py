"""Hints of alarms name what is commonly meant."""

from __future__ import annotations

import pytest

from elitescript import VirtualRobot


def alarm(*lines):
    text = "def p():\n" + "".join(f"  {line}\n" for line in lines) + "end\n"
    found = VirtualRobot("CS66").run(text, until_s=5).alarms[0]
    return found.text, found.details["hint"]


@pytest.mark.parametrize("command", ["stop_thread", "join_thread"])
def test_a_function_is_no_handle(command):
    text, hint = alarm("def blink():", "  sync()", "end", f"{command}(blink)")
    assert text == f"{command}: thread_id must be an int, not function blink"
    assert hint == f"{command} takes what start_thread has returned: h = start_thread(blink, ())"
