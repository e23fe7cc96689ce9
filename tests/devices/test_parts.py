"""Parts on a conveyor: when they come, who sees them, who takes them."""

from __future__ import annotations

from itertools import pairwise

import pytest

from elitescript.errors import UsageError
from elitescript.messages.events import SignalChanged
from elitescript.testing.world import Parts, Wire
from tests.devices.programs import run

SENSOR = "standard_digital_in[3]"


def belt(**settings):
    """10 cm/s, a part of 5 cm every 20 cm, seen at 30 cm."""
    usual = {"counts_per_m": 1000, "speed_m_s": 0.1, "pitch_m": 0.2, "sensor": SENSOR, "sensor_m": 0.3, "end_m": 0.6}
    return Parts(**{**usual, **settings})


def seen(parts, body="sleep(8)", **rest):
    events = run(body, parts, **rest).events
    return [(event.tick, event.value) for event in events if isinstance(event, SignalChanged) and event.name == SENSOR]


def test_parts_pass_the_sensor_one_after_the_other():
    parts = belt()
    expected = [(750, True), (875, False), (1250, True), (1375, False), (1750, True), (1875, False)]
    assert seen(parts) == expected
    assert seen(belt(), steps=True) == expected
    assert (parts.released, parts.missed, parts.taken) == (5, 2, 0)


def test_the_encoder_turns_with_the_belt():
    found = run("global v\nsleep(1)\n", belt())
    assert found.signals["encoder_speed[0]"] == 100.0


def test_a_belt_that_stands_brings_nothing_and_goes_on_where_it_stood():
    parts = belt(runs_when="not standard_digital_out[2]")
    body = "sleep(1)\nset_standard_digital_out(2, True)\nsleep(5)\nset_standard_digital_out(2, False)\nsleep(3)"
    # It stops and starts a tick after the output; what it lost is the time between.
    assert seen(parts, body)[:2] == [(2000, True), (2125, False)]


def test_a_belt_may_be_driven_by_somebody_else():
    parts = belt(speed_m_s=0)
    drive = Wire(when="standard_digital_out[0]", then="encoder_speed[0]", value=200.0)
    found = run("set_standard_digital_out(0, True)\nsleep(2)", parts, drive)
    first = next(event.tick for event in found.events if isinstance(event, SignalChanged) and event.name == SENSOR)
    assert first == 1 + 375


def test_parts_by_the_clock_do_not_pile_up():
    parts = belt(pitch_m=0, every_s=0.25, length_m=0.05)
    run("sleep(2)", parts)
    fronts = parts.fronts_m
    assert all(ahead - behind >= 0.05 - 1e-9 for ahead, behind in pairwise(fronts))
    assert parts.released == 4


def test_jitter_follows_the_seed():
    assert seen(belt(jitter_m=0.05), seed=3) == seen(belt(jitter_m=0.05), seed=3)
    assert seen(belt(jitter_m=0.05), seed=3) != seen(belt(jitter_m=0.05), seed=4)


def test_a_part_within_reach_is_taken_and_the_gripper_says_so():
    parts = belt(
        pick="standard_digital_out[0]",
        pick_from_m=0.35,
        pick_to_m=0.45,
        picked="standard_digital_in[4]",
        picked_after_s=0.1,
    )
    body = """
set_standard_digital_out(0, True)
sleep(0.5)
textmsg("nothing there: ", get_standard_digital_in(4))
set_standard_digital_out(0, False)
while not get_standard_digital_in(3):
  sync()
end
sleep(1)
set_standard_digital_out(0, True)
sleep(0.2)
textmsg("holds it: ", get_standard_digital_in(4))
set_standard_digital_out(0, False)
sleep(0.2)
textmsg("let go: ", get_standard_digital_in(4))
"""
    found = run(body, parts)
    assert found.log == ["nothing there: False", "holds it: True", "let go: False"]
    assert (parts.taken, parts.missed) == (1, 0)


def test_so_many_parts_and_no_more():
    parts = belt(count=2)
    run("sleep(30)", parts)
    assert (parts.released, parts.missed) == (2, 2)


@pytest.mark.parametrize(
    "settings, words",
    [
        ({"counts_per_m": 0}, "counts_per_m: must be in"),
        ({"pitch_m": 0}, "pitch_m: give either pitch_m or every_s"),
        ({"every_s": 1}, "pitch_m: give either pitch_m or every_s"),
        ({"pitch_m": 0.01}, "pitch_m: parts of 0.05 m would overlap"),
        ({"sensor": "standard_analog_in[0]"}, "sensor: standard_analog_in\\[0\\] is no digital signal"),
        ({"sensor": "nothing"}, "sensor: no signal"),
        ({"sensor_m": 9}, "sensor_m: must be in"),
        ({"pick": "standard_digital_out[0]"}, "pick_to_m: must be beyond pick_from_m"),
        ({"picked": "standard_digital_in[0]"}, "picked: goes with pick"),
        ({"runs_when": "?"}, "runs_when: .*is no expression"),
        ({"runs_when": "flag[0]", "speed_m_s": 0}, "runs_when: goes with speed_m_s"),
        ({"released": 4}, "released: is not known"),
    ],
)
def test_settings_that_make_no_sense_are_refused(settings, words):
    with pytest.raises(UsageError, match=words):
        belt(**settings)
