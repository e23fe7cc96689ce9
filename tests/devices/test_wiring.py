"""Wires and schedules: levels, edges, pulses, expressions, time."""

from __future__ import annotations

import pytest

from elitescript.errors import UsageError
from elitescript.messages.events import SignalChanged
from elitescript.testing.world import Schedule, Wire
from tests.devices.programs import run

OUT, IN = "standard_digital_out[0]", "standard_digital_in[1]"


def changes(body, *devices, of=IN, **rest):
    """Tick and value of every change of a signal."""
    events = run(body, *devices, **rest).events
    return [(event.tick, event.value) for event in events if isinstance(event, SignalChanged) and event.name == of]


TOGGLE = """
sleep(0.1)
set_standard_digital_out(0, True)
sleep(0.2)
set_standard_digital_out(0, False)
sleep(1)
"""


@pytest.mark.parametrize(
    "settings, expected",
    [
        ({}, [(26, True), (76, False)]),
        ({"after_s": 0.3}, [(100, True), (150, False)]),
        ({"inverted": True}, [(0, True), (26, False), (76, True)]),
        ({"edge": "rising"}, [(26, True)]),
        ({"edge": "falling", "inverted": True}, [(76, True)]),
        ({"edge": "rising", "pulse_s": 0.04}, [(26, True), (35, False)]),
        ({"edge": "falling", "pulse_s": 0.04}, [(76, True), (85, False)]),
        ({"pulse_s": 0.04, "after_s": 0.08}, [(45, True), (55, False), (95, True), (105, False)]),
    ],
)
def test_a_wire_follows_its_source(settings, expected):
    assert changes(TOGGLE, Wire(when=OUT, then=IN, **settings)) == expected
    assert changes(TOGGLE, Wire(when=OUT, then=IN, **settings), steps=True) == expected


def test_a_pulse_shorter_than_the_wire_arrives_all_the_same():
    body = "set_standard_digital_out(0, True)\nsync()\nset_standard_digital_out(0, False)\nsleep(1)"
    assert changes(body, Wire(when=OUT, then=IN, after_s=0.1)) == [(25, True), (26, False)]


def test_conditions_over_two_signals():
    body = """
set_standard_digital_out(0, True)
sleep(0.1)
set_standard_digital_out(1, True)
sleep(0.1)
set_standard_digital_out(0, False)
sleep(0.1)
"""
    both = Wire(when="standard_digital_out[0] and standard_digital_out[1]", then=IN)
    assert changes(body, both) == [(26, True), (51, False)]


def test_a_threshold_of_an_analog_output():
    body = "for n in range(5):\n  set_standard_analog_out(0, n / 4)\n  sleep(0.1)\nend"
    assert changes(body, Wire(when="2 < standard_analog_out[0] < 6", then=IN)) == [(26, True), (76, False)]


def test_a_number_is_passed_on_and_a_level_becomes_a_value():
    body = "set_standard_analog_out(0, 0.5)\nset_standard_digital_out(0, True)\nsleep(0.1)"
    copied = Wire(when="standard_analog_out[0] * 0.5 + 1", then="standard_analog_in[1]")
    assert changes(body, copied, of="standard_analog_in[1]") == [(0, 1.0), (1, 3.5)]
    valued = Wire(when=OUT, then="input_int_register[3]", value=7, otherwise=-1)
    assert changes(body, valued, of="input_int_register[3]") == [(0, -1), (1, 7)]


def test_a_chain_of_wires_takes_a_tick_for_each():
    chain = [Wire(when=OUT, then=IN), Wire(when=IN, then="standard_digital_in[2]")]
    assert changes("set_standard_digital_out(0, True)\nsleep(1)", *chain, of="standard_digital_in[2]") == [(2, True)]


def test_a_wire_that_disturbs_itself_swings_and_does_not_hang():
    swing = Wire(when=IN, then=IN, inverted=True, after_s=0.1)
    assert changes("sleep(0.45)", swing)[:3] == [(0, True), (25, False), (50, True)]


@pytest.mark.parametrize(
    "settings, words",
    [
        ({"when": "nothing[0]"}, "when: .*no signal is called 'nothing'"),
        ({"when": "1 + 1"}, "when: '1 \\+ 1' names no signal"),
        ({"when": ""}, "when: write an expression"),
        ({"then": "standard_digital_in[99]"}, "then: .*indices 0 to 15, not 99"),
        ({"then": 3}, "then: must be a text"),
        ({"after_s": -0.1}, "after_s: must be in"),
        ({"edge": "up"}, "edge: must be one of both, rising, falling"),
        ({"value": 3}, "value: .*takes True or False, not 3"),
        ({"otherwise": True}, "otherwise: goes with value"),
        ({"then": "standard_analog_in[0]", "pulse_s": 1}, "pulse_s: needs a value"),
        ({"then": "standard_analog_in[0]", "inverted": True}, "inverted: needs a value"),
        ({"colour": "red"}, "colour: is not known; settings are name, when, then"),
    ],
)
def test_a_wire_that_makes_no_sense_is_refused(settings, words):
    with pytest.raises(UsageError, match=words):
        Wire(**{"when": OUT, "then": IN, **settings})


def test_a_schedule_happens_once_or_again_and_again():
    once = Schedule(signal=IN, at=[(0.1, True), (0.3, False)])
    assert changes("sleep(1)", once) == [(25, True), (75, False)]
    again = Schedule(signal=IN, at=[(0.0, True), (0.1, False)], every_s=0.4)
    assert changes("sleep(1)", again)[:5] == [(0, True), (25, False), (100, True), (125, False), (200, True)]


@pytest.mark.parametrize(
    "settings, words",
    [
        ({"signal": "x"}, "signal: no signal is called 'x'"),
        ({"at": []}, "at: write rows of time and value"),
        ({"at": "soon"}, "at: write rows"),
        ({"at": [3]}, "at: a row is a time and a value"),
        ({"at": [(-1, True)]}, "at: must be in"),
        ({"at": [(0, 7)]}, "at: .*takes True or False, not 7"),
        ({"every_s": 1.0, "at": [(1.0, True)]}, "at: a time must be less than every_s, 1 s, got 1 s"),
        ({"every_s": 1e-12}, "every_s: must be one control period at least"),
    ],
)
def test_a_schedule_that_makes_no_sense_is_refused(settings, words):
    with pytest.raises(UsageError, match=words):
        Schedule(**{"signal": IN, "at": [(0.1, True)], **settings})
