"""Schedules, packages, claims and the cache."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import pytest

from elitescript.messages.enums import RobotMode, TaskState
from elitescript.messages.outputs import Output
from elitescript.messages.state import Payload
from elitescript.protocol.rtsi.inputs import INPUTS
from elitescript.protocol.rtsi.recipes import InputClaims, InputRecipe, OutputRecipe, PackageCache, RecipeSchedule
from elitescript.protocol.rtsi.variables import OUTPUTS
from elitescript.records import replace
from tests.protocol.rtsi_client import STANDARD_INPUTS, STANDARD_OUTPUTS, messages, package, values
from tests.protocol.snapshots import output, snapshot


def ticks_due(frequency_hz: float, ticks: range) -> list[int]:
    schedule = RecipeSchedule(frequency_hz)
    due = []
    for tick in ticks:
        announced = schedule.will_be_due(tick)
        if schedule.is_due(tick):
            due.append(tick)
        assert announced == (tick in due[-1:])
    return due


@pytest.mark.parametrize(
    ("frequency_hz", "due"),
    [
        (250.0, [70, 71, 72, 73, 74, 75, 76, 77, 78, 79]),
        (125.0, [70, 72, 74, 76, 78]),
        (100.0, [70, 73, 75, 78]),
        (50.0, [70, 75]),
        (200.0, [70, 72, 73, 74, 75, 77, 78, 79]),
        (1.0, [70]),
    ],
)
def test_the_first_ticks_of_a_schedule(frequency_hz: float, due: list[int]) -> None:
    assert ticks_due(frequency_hz, range(70, 80)) == due


def test_any_frequency_is_exact_and_even() -> None:
    dice = random.Random(30004)
    wanted = [1.0, 3.0, 7.5, 33.3, 60.0, 99.9, 124.9, 249.99, 250.0] + [dice.uniform(1, 250) for _ in range(30)]
    for frequency_hz in wanted:
        start = dice.randrange(10**9)
        due = ticks_due(frequency_hz, range(start, start + 5000))
        spacing = 250 / Fraction(frequency_hz)
        for number, tick in enumerate(due):
            assert 0 <= tick - start - number * spacing < 1
        assert len(due) == 1 + 4999 * Fraction(frequency_hz) // 250


@pytest.mark.parametrize("frequency_hz", [250.0, 125.0, 33.3, 1.0])
def test_what_falls_on_a_tick_is_known_without_asking_for_it(frequency_hz: float) -> None:
    due = ticks_due(frequency_hz, range(70, 1000))
    schedule = RecipeSchedule(frequency_hz)
    assert schedule.is_due(70)
    assert [tick for tick in range(71, 1000) if schedule.falls_on(tick)] == due[1:]
    assert [tick for tick in range(71, 1000) if schedule.is_due(tick)] == due[1:]


def test_a_schedule_does_not_drift_in_a_year() -> None:
    schedule = RecipeSchedule(33.3)
    assert schedule.is_due(0)
    year = 365 * 24 * 3600 * 250
    count = year * Fraction(33.3) // 250
    due = -(-count * 250 // Fraction(33.3))
    assert not schedule.is_due(0)
    assert schedule.is_due(due - 1)
    assert schedule.is_due(due)


def test_missed_packages_are_not_made_up_for() -> None:
    schedule = RecipeSchedule(250.0)
    assert [schedule.is_due(tick) for tick in (5, 6, 100, 100, 101)] == [True, True, True, False, True]


def test_a_schedule_begins_again_after_a_reset_and_when_time_goes_back() -> None:
    schedule = RecipeSchedule(1.0)
    assert [schedule.is_due(tick) for tick in (500, 501)] == [True, False]
    schedule.reset()
    assert [schedule.is_due(tick) for tick in (502, 503, 10, 11, 260)] == [True, False, True, False, True]


def test_the_package_of_52_variables_has_849_bytes() -> None:
    assert len(STANDARD_OUTPUTS) == 52
    recipe = OutputRecipe(7, tuple(STANDARD_OUTPUTS), 250.0)
    whole = recipe.package(recipe.packed(output()))
    assert len(whole) == recipe.size == 849
    assert whole[:4] == bytes([849 >> 8, 849 & 255, ord("U"), 7])


def test_the_package_of_15_inputs_has_98_bytes() -> None:
    assert len(STANDARD_INPUTS) == 15
    assert InputRecipe(1, tuple(STANDARD_INPUTS)).size == 98


def test_an_independent_decoder_reads_every_variable() -> None:
    names = tuple(OUTPUTS)
    tick = output(signals={"output_float_register": {5: -1e-300}, "input_int_register": {9: -(2**31)}})
    recipe = OutputRecipe(1, names, 250.0)
    ((letter, payload),) = messages(recipe.package(recipe.packed(tick)))
    assert letter == "U"
    found = values(payload, [OUTPUTS[name].type.name for name in names])
    assert dict(zip(names, found, strict=True)) == {name: OUTPUTS[name].read(tick.snapshot) for name in names}


def test_an_independent_encoder_is_read_for_every_variable() -> None:
    dice = random.Random(5)
    wanted: dict[str, Any] = {}
    for name, wire in INPUTS.items():
        if wire.name == "BOOL":
            wanted[name] = dice.random() < 0.5
        elif wire.name == "INT32":
            wanted[name] = dice.randrange(-(2**31), 2**31)
        elif wire.name == "DOUBLE":
            wanted[name] = dice.uniform(-1e6, 1e6)
        elif wire.name == "VECTOR6D":
            wanted[name] = tuple(dice.uniform(-1e3, 1e3) for _ in range(6))
        else:
            wanted[name] = dice.randrange(2 ** (8 * wire.size))
    ((_, payload),) = messages(package(3, [wire.name for wire in INPUTS.values()], wanted.values()))
    assert InputRecipe(3, tuple(INPUTS)).values(payload[1:]) == wanted


def test_a_name_may_come_twice() -> None:
    recipe = OutputRecipe(1, ("timestamp", "timestamp"), 250.0)
    assert values(recipe.package(recipe.packed(output()))[3:], ["DOUBLE"] * 2) == [4.0, 4.0]
    ((_, payload),) = messages(package(1, ["INT32"] * 2, [1, 2]))
    assert InputRecipe(1, ("input_int_register0",) * 2).values(payload[1:]) == {"input_int_register0": 2}


def test_an_input_belongs_to_one_client_until_it_goes() -> None:
    claims = InputClaims()
    claims.claim("a", ["x", "y"])
    claims.claim("b", ["z"])
    assert [claims.is_free("a", name) for name in "xyz"] == [True, True, False]
    assert [claims.is_free("b", name) for name in "xyz"] == [False, False, True]
    claims.release("a")
    claims.release("nobody")
    assert [claims.is_free("b", name) for name in "xyz"] == [True, True, True]
    assert not claims.is_free("c", "z")


def test_equal_recipes_are_packed_once_in_a_tick(monkeypatch: pytest.MonkeyPatch) -> None:
    packed: list[tuple[str, ...]] = []
    pack = OutputRecipe.packed
    monkeypatch.setattr(OutputRecipe, "packed", lambda recipe, tick: packed.append(recipe.names) or pack(recipe, tick))
    cache = PackageCache()
    first, same, second = (OutputRecipe(ident, ("timestamp", "robot_mode"), 250.0) for ident in (1, 1, 2))
    other = OutputRecipe(1, ("robot_mode", "timestamp"), 250.0)
    tick = output(1000)
    package = cache.package(first, tick)
    assert cache.package(same, tick) is package
    assert cache.package(second, tick) == package[:3] + b"\x02" + package[4:]
    assert cache.package(other, tick)[4:] != package[4:]
    assert packed == [first.names, other.names]
    later = cache.package(first, output(1001))
    assert later != package
    assert values(later[3:], ["DOUBLE", "INT32"]) == [1001 / 250, 7]


def test_what_rarely_changes_is_read_again_when_it_has_changed() -> None:
    names = tuple(OUTPUTS)
    kept = OutputRecipe(1, names, 250.0)
    before = snapshot(5)
    changes: list[dict[str, Any]] = [
        {},
        {"tool_analog_mode": 3},
        {"tool_pin_modes": (1, 0, 1, 0)},
        {"is_freedrive": True},
        {"tool_current": 0.0},
        {"tool_current": -0.0},
        {"signals": {**before.signals, "standard_digital_out": (True,) * 16}},
        {"signals": {**before.signals, "standard_analog_out": (-0.0, 0.0)}},
        {"robot": replace(before.robot, speed_scale=0.25)},
        {"robot": replace(before.robot, robot_mode=RobotMode.IDLE)},
        {"robot": replace(before.robot, task_state=TaskState.PAUSED)},
        {"robot": replace(before.robot, payload=Payload(2.0, (0.0, 0.0, 0.1)))},
        {},
    ]
    for change in changes:
        output = Output(5, (), (), (), replace(before, **change))
        assert kept.packed(output) == OutputRecipe(1, names, 250.0).packed(output), change
