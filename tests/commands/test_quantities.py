from __future__ import annotations

from math import inf, nan
from typing import Any

import pytest

from elitescript.commands.definition.quantities import (
    JOINTS,
    Anything,
    Boolean,
    Choice,
    Either,
    Integer,
    Number,
    Octets,
    Optionally,
    Quantity,
    Text,
    Vector,
    shown,
    signal_index,
)
from elitescript.errors import ArgumentRangeError, ArgumentTypeError
from elitescript.messages.signals import SIGNALS


@pytest.mark.parametrize(
    ("quantity", "value", "result"),
    [
        (Number(), 3, 3.0),
        (Number(), True, 1.0),
        (Number(low=0.0), 0, 0.0),
        (Number(allows_non_finite=True), inf, inf),
        (Integer(0, 7), True, 1),
        (Integer(), -(10**30), -(10**30)),
        (Choice(0, 1), True, 1),
        (Choice("a", "b"), "b", "b"),
        (Boolean(), 2, True),
        (Boolean(), 0, False),
        (Text(), "", ""),
        (Octets(), bytearray(b"ab"), b"ab"),
        (Vector(Integer(), 2), (True, 2), (1, 2)),
        (Vector(Number(), None), [], ()),
        (Vector(Number(), 3), [1.5, -0.0, 2.0], (1.5, -0.0, 2.0)),
        (Vector(Number(), 3), (1.5, True, 2), (1.5, 1.0, 2.0)),
        (Either(Boolean(), Vector(Boolean(), None)), [1, 0], (True, False)),
        (Either(Boolean(), Vector(Boolean(), None)), 5, True),
        (Either(Integer(), Text()), "a", "a"),
        (Optionally(Number()), None, None),
        (Optionally(Number()), "", None),
        (Optionally(Number(), "a"), "a", None),
        (Optionally(Number(), "a"), 2, 2.0),
        (Anything(), [1], [1]),
    ],
)
def test_value_is_taken(quantity: Quantity, value: Any, result: Any) -> None:
    coerced = quantity.coerce(value)
    assert coerced == result
    assert type(coerced) is type(result)


@pytest.mark.parametrize(
    ("quantity", "value", "message"),
    [
        (Number("s"), "5", "must be a number, not str '5'"),
        (Number("s"), nan, "must be a finite number, got nan"),
        (Number("s"), 10**400, "must be a number that fits a float, got 1000"),
        (Number("s", 0.0), -1, "must be >= 0 s, got -1"),
        (Number("m", 0.0, is_low_open=True), 0, "must be > 0 m, got 0"),
        (Number("", 0.0, 1.0, is_low_open=True), 1.5, "must be in (0, 1], got 1.5"),
        (Number("", high=1.0), 2, "must be <= 1, got 2"),
        (Integer(0, 15), 16, "must be in [0, 15], got 16"),
        (Integer(0, 15), 1.0, "must be an int, not float 1.0"),
        (Choice(0, 12, 24, unit="V"), 5, "must be one of 0, 12, 24 V, got 5"),
        (Choice("a", "b"), 1, "must be str, not int 1"),
        (Boolean(), "on", "must be True or False, not str 'on'"),
        (Text(), b"a", "must be a str, not bytes b'a'"),
        (JOINTS, [0.0] * 5, "must have 6 elements [base, shoulder, elbow, wrist1, wrist2, wrist3], got 5: [0.0, 0.0"),
        (JOINTS, "home", "must be a list of 6 numbers, not str 'home'"),
        (JOINTS, [0, 0, "x", 0, 0, 0], "element 2 must be a number, not str 'x'"),
        (JOINTS, [0, 0, 0, 0, 0, inf], "element 5 must be a finite number, got inf"),
        (Vector(Boolean(), None), 1, "must be a list of bools, not int 1"),
        (Either(Number(), Vector(Number(), None)), "x", "must be float or list[float], not str 'x'"),
        (Either(Number(), Vector(Number(), None)), ["x"], "element 0 must be a number, not str 'x'"),
        (Vector(Number(), 2), [1.0, float("nan")], "element 1 must be a finite number, got nan"),
        (Vector(Number("m", 0.0), 2), [1.0, -1.0], "element 1 must be >= 0 m, got -1.0"),
        (Either(Integer(0, 255), Text()), 256, "must be in [0, 255], got 256"),
        (Optionally(JOINTS), [1], "must have 6 elements"),
    ],
)
def test_value_is_refused_in_plain_words(quantity: Quantity, value: Any, message: str) -> None:
    with pytest.raises((ArgumentTypeError, ArgumentRangeError)) as caught:
        quantity.coerce(value)
    assert str(caught.value).startswith(message)


def test_an_element_of_a_vector_has_the_unit_of_the_vector() -> None:
    with pytest.raises(ArgumentRangeError) as caught:
        JOINTS.coerce([nan] * 6)
    assert caught.value.unit == "rad"
    assert caught.value.value is not None


def test_wrong_values_are_shown_short_and_safely() -> None:
    class Broken:
        def __repr__(self) -> str:
            raise RuntimeError

    assert len(shown([0] * 1000)) == 80
    assert shown(Broken()) == "<Broken>"
    assert shown(10**5000) == "<int>"


@pytest.mark.parametrize("name", SIGNALS)
def test_indices_follow_the_table_of_signals(name: str) -> None:
    index = signal_index(name)
    assert index.coerce(SIGNALS[name].size - 1) == SIGNALS[name].size - 1
    with pytest.raises(ArgumentRangeError):
        index.coerce(SIGNALS[name].size)
