"""Hints of alarms name what is commonly meant."""

from __future__ import annotations

import pytest

from elitescript import VirtualRobot
from elitescript.devices.kinds.replies import DeclaredTcp
from elitescript.testing.world import World


def alarm(*lines, devices=()):
    text = "def p():\n" + "".join(f"  {line}\n" for line in lines) + "end\n"
    found = VirtualRobot("CS66", world=World(devices=devices)).run(text, until_s=5).alarms[0]
    return found.text, found.details["hint"]


def test_twelve_numbers_are_joined_lists():
    _, hint = alarm("q = get_target_tcp_pose()", "movel(q + [0, 0, 0.1, 0, 0, 0])")
    assert hint.startswith("12 numbers are lists that were joined: `+` puts one behind the other")
    _, hint = alarm("movel([1, 2])")
    assert hint.startswith("it is called as movel(")


@pytest.mark.parametrize("command", ["stop_thread", "join_thread"])
def test_a_function_is_no_handle(command):
    text, hint = alarm("def blink():", "  sync()", "end", f"{command}(blink)")
    assert text == f"{command}: thread_id must be an int, not function blink"
    assert hint == f"{command} takes what start_thread has returned: h = start_thread(blink, ())"


READ = ('socket_open("h", 5000)', 'socket_send_line("where?")', 'r = socket_read_ascii_float(2, "socket_0", 0.1)')


def test_nan_says_which_reading_gave_it():
    camera = DeclaredTcp(port=5000, otherwise="(0.4)")
    _, hint = alarm(*READ, "x = r[2] + 0.1", "movel([r[1], x, 0.4, 3.14, 0, 0])", devices=[camera])
    assert hint == "nan comes from `r`, the reading of line 4: 1 of 2 numbers had arrived; ask r[0] == 2 before"


def test_nan_of_anything_else_names_no_variable():
    _, hint = alarm("movel([float('nan'), 0, 0.4, 3.14, 0, 0])")
    assert hint == "nan stands for a number that a reading did not get: ask its first element, how many arrived"
