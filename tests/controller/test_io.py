import pytest

from elitescript.controller.signals.image import SignalImage
from elitescript.errors import ArgumentRangeError, ScriptStateError
from elitescript.messages.enums import AnalogDomain, RunstateChoice, ToolPinMode
from elitescript.messages.machine import (
    SetAnalogDomain,
    SetAnalogFraction,
    SetInputAction,
    SetRunstateChoice,
    SetToolPin,
)


@pytest.fixture
def changes():
    return []


@pytest.fixture
def image(changes):
    return SignalImage(lambda name, index, value, before: changes.append((name, index, value)))


def test_a_change_is_told_once(image, changes):
    image.write("standard_digital_out", 3, True)
    image.write("standard_digital_out", 3, True)
    assert changes == [("standard_digital_out", 3, True)]
    assert image.non_defaults() == {"standard_digital_out[3]": True}


@pytest.mark.parametrize("value", [2**31, -(2**31) - 1])
def test_an_integer_register_has_32_bits(image, changes, value):
    with pytest.raises(ArgumentRangeError, match="output_int_register\\[0\\]"):
        image.write("output_int_register", 0, value)
    assert changes == []


@pytest.mark.parametrize(
    ("domain", "fraction", "level"),
    [
        (AnalogDomain.VOLTAGE, 0.0, 0.0),
        (AnalogDomain.VOLTAGE, 1.0, 10.0),
        (AnalogDomain.VOLTAGE, 1.5, 10.0),
        (AnalogDomain.CURRENT, 0.0, 0.004),
        (AnalogDomain.CURRENT, 1.0, 0.020),
        (AnalogDomain.CURRENT, -3.0, 0.004),
    ],
)
def test_a_fraction_becomes_the_level_of_the_domain(image, domain, fraction, level):
    image.set_analog_domain(SetAnalogDomain("standard_analog_out", 1, domain))
    image.set_analog_fraction(SetAnalogFraction("standard_analog_out", 1, fraction))
    assert image.read("standard_analog_out", 1) == pytest.approx(level, abs=1e-12)


def test_an_output_keeps_its_fraction_when_the_domain_changes(image):
    image.set_analog_fraction(SetAnalogFraction("standard_analog_out", 0, 0.5))
    image.set_analog_domain(SetAnalogDomain("standard_analog_out", 0, AnalogDomain.CURRENT))
    assert image.read("standard_analog_out", 0) == pytest.approx(0.012)


def test_an_input_level_outside_its_domain_is_refused(image):
    image.set_analog_domain(SetAnalogDomain("standard_analog_in", 0, AnalogDomain.CURRENT))
    with pytest.raises(ArgumentRangeError, match=r"\[0, 0\.02\] A"):
        image.write("standard_analog_in", 0, 5.0)


@pytest.mark.parametrize(
    ("choice", "stopped", "running"),
    [
        (RunstateChoice.KEEP, True, True),
        (RunstateChoice.LOW_WHEN_STOPPED, False, False),
        (RunstateChoice.HIGH_WHEN_STOPPED, True, True),
        (RunstateChoice.FOLLOW, False, True),
    ],
)
def test_a_start_moves_only_outputs_that_are_tied_to_both_states(image, choice, stopped, running):
    image.write("configurable_digital_out", 0, True)
    image.set_runstate(SetRunstateChoice("configurable_digital_out", 0, choice))
    assert image.read("configurable_digital_out", 0) is stopped
    image.set_running(True)
    assert image.read("configurable_digital_out", 0) is running
    image.set_running(False)
    assert image.read("configurable_digital_out", 0) is stopped


def test_what_is_commanded_while_stopped_has_no_effect_and_is_told_once():
    told = []
    image = SignalImage(lambda *change: None, lambda *write: told.append(write))
    image.set_runstate(SetRunstateChoice("standard_digital_out", 0, RunstateChoice.HIGH_WHEN_STOPPED))
    for level in (True, False, False):
        image.write("standard_digital_out", 0, level)
    assert told == [("standard_digital_out", 0, True)]
    image.set_running(True)
    assert image.read("standard_digital_out", 0) is True
    image.write("standard_digital_out", 0, False)
    assert image.read("standard_digital_out", 0) is False
    image.set_running(False)
    assert image.read("standard_digital_out", 0) is True
    image.write("standard_digital_out", 0, False)
    assert len(told) == 2


def test_an_analog_output_follows_the_run_state_in_its_domain(image):
    image.set_analog_domain(SetAnalogDomain("tool_analog_out", 0, AnalogDomain.CURRENT))
    image.set_runstate(SetRunstateChoice("tool_analog_out", 0, RunstateChoice.FOLLOW))
    assert image.read("tool_analog_out") == 0.004
    image.set_running(True)
    assert image.read("tool_analog_out") == 0.020


def test_a_tool_pin_reads_what_its_direction_says(image):
    image.write("tool_digital_out", 0, True)
    image.write("tool_digital_in", 2, True)
    assert [image.tool_pin(index) for index in range(4)] == [True, False, True, False]


@pytest.mark.parametrize(("is_enabled", "words"), [(True, "is an input"), (False, "is disabled")])
def test_only_an_enabled_output_pin_is_driven(image, is_enabled, words):
    image.set_tool_pin(SetToolPin(1, ToolPinMode.NPN, is_enabled=is_enabled, is_output=not is_enabled))
    with pytest.raises(ScriptStateError, match=words) as caught:
        image.write("tool_digital_out", 1, True)
    assert caught.value.code == "R122"
    assert image.non_defaults() == {}


def test_a_high_input_asks_for_hand_guiding_as_long_as_it_is_bound_to_it(image):
    image.write("standard_digital_in", 4, True)
    assert image.freedrive_point is None
    image.set_input_action(SetInputAction("standard_digital_in", 4, is_freedrive=True))
    assert image.freedrive_point == "standard_digital_in[4]"
    image.write("standard_digital_in", 4, False)
    assert image.freedrive_point is None
    image.write("standard_digital_in", 4, True)
    image.set_input_action(SetInputAction("standard_digital_in", 4, is_freedrive=False))
    assert image.freedrive_point is None


def test_a_new_domain_gives_an_output_that_nobody_set_the_lowest_level(image):
    image.set_analog_domain(SetAnalogDomain("standard_analog_out", 1, AnalogDomain.CURRENT))
    assert image.read("standard_analog_out", 1) == 0.004
    image.set_runstate(SetRunstateChoice("standard_analog_out", 1, RunstateChoice.LOW_WHEN_STOPPED))
    image.set_analog_domain(SetAnalogDomain("standard_analog_out", 1, AnalogDomain.VOLTAGE))
    assert image.read("standard_analog_out", 1) == 0.0


def test_an_input_keeps_its_level_if_the_new_domain_has_it_and_its_fraction_if_not(image):
    image.write("standard_analog_in", 0, 0.012)
    image.write("standard_analog_in", 1, 5.0)
    for index in (0, 1):
        image.set_analog_domain(SetAnalogDomain("standard_analog_in", index, AnalogDomain.CURRENT))
    assert image.read("standard_analog_in", 0) == 0.012
    assert image.read("standard_analog_in", 1) == pytest.approx(0.012)


def test_an_image_shares_what_has_not_changed_with_the_one_before():
    image = SignalImage(lambda name, index, value, before: None)
    before = image.image
    image.write("flag", 3, True)
    after = image.image
    assert image.image is after
    assert before["flag"][3] is False
    assert after["flag"][3] is True
    assert [name for name in before if before[name] is not after[name]] == ["flag"]
    assert list(before) == list(after)
    image.write("flag", 3, True)
    assert image.image is after
