"""The table of input variables: what a package asks of the machine."""

from __future__ import annotations

import math
from typing import Any

import pytest

from elitescript.messages.enums import AnalogDomain
from elitescript.messages.machine import SetAnalogDomain, SetAnalogFraction, SetSpeedScale, WriteSignal
from elitescript.messages.signals import SIGNALS
from elitescript.protocol.rtsi.inputs import EFFECTS, INPUT_ROWS, INPUTS, Arrival, effects_of, requests_of
from tests.protocol.rtsi_client import STANDARD_INPUTS
from tests.protocol.snapshots import six, snapshot

ANALOG = "standard_analog_output"


def asked(values: dict[str, Any], *, known: dict[str, Any] | None = None, signals: Any = None) -> tuple[list[Any], Any]:
    """Requests and problems of a package, after `known` was sent before."""
    known = known or {}
    arrival = Arrival(known | values, known, snapshot(signals=signals), {})
    return list(requests_of(effects_of(tuple(values)), arrival)), arrival.problems


def test_all_names_of_the_interface_are_there() -> None:
    numbered = [f"input_{kind}_register{n}" for kind in ("int", "double") for n in range(48)]
    numbered += [f"input_bit_register{n}" for n in range(64, 128)]
    assert INPUTS.keys() == set(STANDARD_INPUTS) | set(numbered)
    assert all(row.summary and row.evidence for row in INPUT_ROWS)


def test_every_variable_has_an_effect() -> None:
    assert {name for effect in EFFECTS for name in effect.variables} == INPUTS.keys()


@pytest.mark.parametrize(("mask", "expected"), [(0, []), (1, [SetSpeedScale(0.25)])])
def test_the_speed_slider_follows_its_mask(mask: int, expected: list[Any]) -> None:
    assert asked({"speed_slider_mask": mask, "speed_slider_fraction": 0.25}) == (expected, {})


@pytest.mark.parametrize("fraction", [-0.01, 1.01, math.nan, math.inf])
def test_a_speed_outside_its_range_is_refused_with_its_value(fraction: float) -> None:
    requests, problems = asked({"speed_slider_mask": 1, "speed_slider_fraction": fraction})
    assert requests == []
    assert f"got {fraction:g}" in problems["speed_slider_fraction"]


def test_a_speed_outside_its_range_is_no_problem_while_the_mask_is_0() -> None:
    assert asked({"speed_slider_mask": 0, "speed_slider_fraction": math.nan}) == ([], {})


@pytest.mark.parametrize(("place", "size"), [("standard", 16), ("configurable", 8), ("tool", 4)])
def test_digital_outputs_are_set_where_the_mask_says(place: str, size: int) -> None:
    family, levels = f"{place}_digital_out", f"{place}_digital_output"
    for index in range(size):
        high = {f"{levels}_mask": 1 << index, levels: 0xFF if size <= 8 else 0xFFFF}
        low = {f"{levels}_mask": 1 << index, levels: 0}
        assert asked(high) == ([WriteSignal(family, index, True)], {})
        assert asked(low) == ([WriteSignal(family, index, False)], {})
    assert asked({f"{levels}_mask": 0, levels: 0xF}) == ([], {})
    assert asked({f"{levels}_mask": 0b101, levels: 0b001})[0] == [
        WriteSignal(family, 0, True),
        WriteSignal(family, 2, False),
    ]


def test_an_output_that_has_its_level_is_written_again() -> None:
    values = {"standard_digital_output_mask": 2, "standard_digital_output": 2}
    picture = {"standard_digital_out": {1: True}}
    assert asked(values, known=values, signals=picture)[0] == [WriteSignal("standard_digital_out", 1, True)]


def test_mask_bits_without_a_pin_are_reported_and_the_pins_are_set() -> None:
    requests, problems = asked({"tool_digital_output_mask": 0xFF, "tool_digital_output": 0x05})
    assert requests == [WriteSignal("tool_digital_out", index, index in (0, 2)) for index in range(4)]
    assert "0xff" in problems["tool_digital_output_mask"]


def analog(mask: int, domains: int, first: float, second: float) -> dict[str, Any]:
    return {f"{ANALOG}_mask": mask, f"{ANALOG}_type": domains, f"{ANALOG}_0": first, f"{ANALOG}_1": second}


@pytest.mark.parametrize("index", [0, 1])
@pytest.mark.parametrize("domain", AnalogDomain)
def test_an_analog_output_gets_its_domain_then_its_fraction(index: int, domain: AnalogDomain) -> None:
    # A client writes the domain bits of both outputs whichever it sets.
    values = analog(1 << index, 3 if domain else 0, 0.25, 0.75)
    family = "standard_analog_out"
    fraction = (0.25, 0.75)[index]
    expected = [SetAnalogDomain(family, index, domain), SetAnalogFraction(family, index, fraction)]
    assert asked(values) == (expected, {})


def test_both_analog_outputs_at_once_have_each_their_domain() -> None:
    requests, _ = asked(analog(3, 0b10, 0.0, 1.0))
    assert requests == [
        SetAnalogDomain("standard_analog_out", 0, AnalogDomain.CURRENT),
        SetAnalogFraction("standard_analog_out", 0, 0.0),
        SetAnalogDomain("standard_analog_out", 1, AnalogDomain.VOLTAGE),
        SetAnalogFraction("standard_analog_out", 1, 1.0),
    ]


def test_an_analog_fraction_outside_its_range_is_refused_and_leaves_the_domain() -> None:
    requests, problems = asked(analog(1, 3, 1.5, math.nan))
    assert requests == []
    assert list(problems) == [f"{ANALOG}_0"]


def test_a_value_of_an_earlier_package_counts() -> None:
    known = {"standard_digital_output_mask": 1, "standard_digital_output": 0}
    assert asked({"standard_digital_output": 1}, known=known)[0] == [WriteSignal("standard_digital_out", 0, True)]


def test_what_was_never_sent_has_no_effect() -> None:
    assert asked({"standard_digital_output_mask": 1}) == ([], {})
    assert asked({f"{ANALOG}_mask": 1, f"{ANALOG}_0": 0.5}) == ([], {})


@pytest.mark.parametrize("first", [0, 32])
def test_a_word_writes_its_registers_in_order(first: int) -> None:
    name = f"input_bit_registers{first}_to_{first + 31}"
    requests, _ = asked({name: 0x80000001})
    assert requests == [WriteSignal("input_bool_register", first + bit, bit in (0, 31)) for bit in range(32)]


def test_of_a_word_that_repeats_itself_only_what_differs_is_written() -> None:
    name = "input_bit_registers0_to_31"
    same = {"input_bool_register": {0: True, 5: True}}
    assert asked({name: 0b100001}, known={name: 0b100001}, signals=same) == ([], {})
    changed = asked({name: 0b000011}, known={name: 0b100001}, signals=same)[0]
    assert changed == [WriteSignal("input_bool_register", 1, True), WriteSignal("input_bool_register", 5, False)]
    # Somebody else has changed register 5 in between.
    other = {"input_bool_register": {0: True}}
    assert asked({name: 0b100001}, known={name: 0b100001}, signals=other)[0] == [
        WriteSignal("input_bool_register", 5, True)
    ]


def test_two_words_within_a_tick_end_at_the_second() -> None:
    # The snapshot does not know of the first yet.
    name = "input_bit_registers0_to_31"
    assert asked({name: 0}, known={name: 1})[0] == [WriteSignal("input_bool_register", 0, False)]


REGISTERS = [("input_int_register", "int", 47, -5), ("input_float_register", "double", 0, 2.5)]


@pytest.mark.parametrize(("family", "kind", "index", "value"), REGISTERS)
def test_a_register_is_written_unless_it_has_the_value_already(family: str, kind: str, index: int, value: Any) -> None:
    name = f"input_{kind}_register{index}"
    write = [WriteSignal(family, index, value)]
    there = {family: {index: value}}
    assert asked({name: value}) == (write, {})
    assert asked({name: value}, known={name: value}, signals=there) == ([], {})
    assert asked({name: value}, known={name: value}) == (write, {})
    assert asked({name: value}, known={name: value * 2}, signals=there) == (write, {})


def test_a_bit_register_gets_a_bool() -> None:
    ((request,), _) = asked({"input_bit_register64": True})
    assert request == WriteSignal("input_bool_register", 64, True)
    assert type(request.value) is bool


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_register_takes_no_value_that_is_no_number(value: float) -> None:
    requests, problems = asked({"input_double_register3": value})
    assert requests == []
    assert "finite" in problems["input_double_register3"]


def test_a_wrench_is_six_writes() -> None:
    assert SIGNALS["external_force_torque"].size == 6
    wrench = six(20.0)
    expected = [WriteSignal("external_force_torque", index, value) for index, value in enumerate(wrench)]
    assert asked({"external_force_torque": wrench}) == (expected, {})
    there = {"external_force_torque": dict(enumerate(wrench))}
    known = {"external_force_torque": wrench}
    assert asked(known, known=known, signals=there) == ([], {})


def test_a_wrench_with_a_nan_is_refused_as_a_whole() -> None:
    requests, problems = asked({"external_force_torque": (0.0, 1.0, math.nan, 0.0, 0.0, 0.0)})
    assert requests == []
    assert "external_force_torque" in problems


def test_effects_are_those_of_the_variables_held() -> None:
    assert effects_of(()) == ()
    assert [effect.variables for effect in effects_of(("input_int_register3", "speed_slider_mask"))] == [
        ("speed_slider_mask", "speed_slider_fraction"),
        ("input_int_register3",),
    ]
