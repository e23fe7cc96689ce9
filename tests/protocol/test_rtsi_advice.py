"""What the log says of recipes that are refused or have no effect."""

from __future__ import annotations

import pytest

from elitescript.messages.inputs import AddLog
from elitescript.protocol.rtsi.advice import NAMES_MAX, RELATED
from elitescript.protocol.rtsi.connection import RtsiConnection
from elitescript.protocol.rtsi.inputs import INPUTS
from elitescript.protocol.rtsi.recipes import RtsiPort
from elitescript.protocol.rtsi.variables import OUTPUTS
from tests.protocol.rtsi_client import STANDARD_INPUTS, STANDARD_OUTPUTS, input_recipe, output_recipe, package
from tests.protocol.snapshots import description, output


def connect(origin: str = "rtsi#1", port: RtsiPort | None = None) -> RtsiConnection:
    return RtsiConnection(origin, description(), port or RtsiPort())


def logged(client: RtsiConnection, data: bytes, tick: int = 1000) -> list[str]:
    """Warnings in the log when a client sends something."""
    found = client.receive(data, output(tick))
    return [item.text for item in found if isinstance(item, AddLog) and item.is_warning]


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("actual_q", "is actual_joint_positions meant?"),
        ("actual_qd", "is actual_joint_speeds meant?"),
        ("actual_tcp_pose", "is actual_TCP_pose meant?"),
        ("standard_analog_output_0", "that is an input"),
        ("output_double_register_24", "is output_double_register24 meant?"),
        ("output_int_register48", "they go from 0 to 47"),
        ("output_bit_register63", "they go from 64 to 127"),
        ("qqqq", ""),
        ("x" * 60_000, ""),
    ],
)
def test_an_unknown_output_is_named_with_the_nearest(name: str, meant: str) -> None:
    (text,) = logged(connect(), output_recipe(125.0, ["timestamp", name]))
    assert text.startswith(f"rtsi#1: a recipe is refused, since there is no RTSI output `{name[:60]}")
    assert text.endswith(f" ({meant})" if meant else ("`" if len(name) < 60 else "...`"))


def test_an_unknown_input_is_named_too() -> None:
    (text,) = logged(connect(), input_recipe(["standard_digital_outputs", "actual_joint_positions"]))
    assert text == (
        "rtsi#1: a recipe is refused, since there is no RTSI input `standard_digital_outputs` (is "
        "standard_digital_output meant?), `actual_joint_positions` (that is an output)"
    )


def test_every_related_name_is_known_here() -> None:
    assert set(RELATED.values()) <= OUTPUTS.keys()
    assert not RELATED.keys() & OUTPUTS.keys()


def test_many_unknown_names_are_counted() -> None:
    (text,) = logged(connect(), output_recipe(125.0, [f"no_such_thing_{n}" for n in range(20)]))
    assert text.endswith(f"{20 - NAMES_MAX} more")


def test_it_is_said_once_a_client_and_once_a_second() -> None:
    port = RtsiPort()
    recipe = output_recipe(125.0, ["actual_q"])
    first = connect("rtsi#1", port)
    assert len(logged(first, recipe)) == 1
    assert logged(first, recipe, tick=5000) == []
    assert logged(connect("rtsi#2", port), recipe, tick=1010) == []
    assert len(logged(connect("rtsi#3", port), recipe, tick=1250)) == 1


def test_a_claimed_input_names_its_owner() -> None:
    port = RtsiPort()
    assert logged(connect("rtsi#1", port), input_recipe(["speed_slider_mask", "speed_slider_fraction"])) == []
    (text,) = logged(connect("rtsi#2", port), input_recipe(["speed_slider_fraction"]))
    assert text == ("rtsi#2: a recipe is refused: speed_slider_fraction belongs to rtsi#1, until that client closes")


@pytest.mark.parametrize(
    ("recipes", "values", "text"),
    [
        (
            [["standard_digital_output"]],
            [4],
            "standard_digital_output has no effect: standard_digital_output_mask is in",
        ),
        (
            [["standard_digital_output_mask"]],
            [4],
            "standard_digital_output_mask has no effect: standard_digital_output",
        ),
        ([["speed_slider_fraction"]], [0.5], "speed_slider_fraction has no effect: speed_slider_mask is in none of"),
        (
            [["standard_analog_output_1"]],
            [0.5],
            "standard_analog_output_1 has no effect: standard_analog_output_mask and standard_analog_output_type are",
        ),
        ([["standard_digital_output_mask"], ["standard_digital_output"]], [4], ""),
        ([["standard_analog_output_mask", "standard_analog_output_type", "standard_analog_output_0"]], [1, 1, 0.5], ""),
        ([["input_int_register3"]], [7], ""),
    ],
)
def test_levels_without_their_mask_are_named_once(recipes: list[list[str]], values: list[float], text: str) -> None:
    client = connect()
    for names in recipes:
        assert logged(client, input_recipe(names)) == []
    data = package(len(recipes), [INPUTS[name].name for name in recipes[-1]], values)
    said = logged(client, data)
    assert [line.startswith(f"rtsi#1: {text}") for line in said] == ([True] if text else [])
    assert logged(client, data, tick=9000) == []


def test_the_recipes_of_the_vendor_are_silent() -> None:
    client = connect()
    assert logged(client, output_recipe(250.0, STANDARD_OUTPUTS) + input_recipe(STANDARD_INPUTS)) == []
