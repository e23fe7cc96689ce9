from __future__ import annotations

from math import pi
from typing import Any

import pytest

from elitescript.commands.maths import pow
from elitescript.errors import InvalidValueError
from elitescript.records import replace


def test_atan2_takes_the_numerator_first(call: Any) -> None:
    assert call("atan2", 1, 0) == pytest.approx(pi / 2)
    assert call("atan2", 0, -1) == pytest.approx(pi)


def test_log_takes_the_base_first(call: Any) -> None:
    assert call("log", 10, 1000) == pytest.approx(3)


@pytest.mark.parametrize(("name", "value"), [("ceil", 2.1), ("floor", 3.9)])
def test_rounding_gives_an_int(call: Any, name: str, value: float) -> None:
    assert call(name, value) == 3
    assert type(call(name, value)) is int


@pytest.mark.parametrize("call_text", ["pow(2.0, 3)", "pow(2, -1)", "sqrt(4)", "norm(-10)", "d2r(180)", "sin(0)"])
def test_other_functions_give_a_float(script: Any, call_text: str) -> None:
    assert type(script(call_text)) is float


@pytest.mark.parametrize(
    ("call_text", "expected"),
    [
        ("pow(2, 3)", 8),
        ("pow(-3, 3)", -27),
        ("pow(True, 2)", 1),
        ("pow(7, 0)", 1),
        ("pow(10, 22)", 10**22),
        ("pow(3, 40)", 3**40),
    ],
)
def test_powers_of_whole_numbers_are_whole_as_in_the_manual(script: Any, call_text: str, expected: int) -> None:
    assert script(f"repr({call_text})") == repr(expected)


def test_powers_of_whole_numbers_can_be_indices(script: Any) -> None:
    assert script("list(range(pow(2, 2)))[pow(1, 5):]") == [1, 2, 3]


def test_powers_that_fit_no_float_are_refused(call: Any) -> None:
    with pytest.raises(InvalidValueError, match=r"^pow: 2 to the power of 5000 is too large for a float"):
        call("pow", 2, 5000)


def test_the_profile_says_whether_powers_are_whole(robot: Any) -> None:
    older = replace(robot.profile, are_powers_whole=False)
    assert type(pow(older, 2, 3)) is float
    assert pow(older, 2, 3) == 8.0
    assert type(pow(robot.profile, 2, 3)) is int


def test_norm_of_a_pose_mixes_metres_and_radians(call: Any) -> None:
    assert call("norm", [3, 0, 0, 0, 0, 4]) == 5.0
    assert call("norm", (1, 2, 2)) == 3.0
    assert call("norm", []) == 0.0


def test_results_too_large_for_a_float_are_refused(call: Any) -> None:
    for name, arguments in (("norm", [[1.7e308, 1.7e308]]), ("r2d", [1.7e308]), ("normalize", [[1.7e308, 1.7e308]])):
        with pytest.raises(InvalidValueError, match=f"^{name}: .* too large for a float"):
            call(name, *arguments)


def test_normalize_keeps_its_direction_whatever_the_length(call: Any) -> None:
    assert call("normalize", [3e-200, 4e-200]) == pytest.approx([0.6, 0.8])
    assert call("normalize", [-2]) == [-1.0]


def test_random_follows_the_seed_of_the_program(call: Any, robot: Any) -> None:
    numbers = [call("random") for _ in range(50)]
    assert all(0 <= number < 1 for number in numbers)
    assert len(set(numbers)) == 50
    same_seed = type(robot)()
    assert numbers == [same_seed.random() for _ in range(50)]
