from __future__ import annotations

from typing import Any

import pytest

from elitescript.errors import ArgumentRangeError, ArgumentTypeError


def test_bits_come_least_significant_first(call: Any) -> None:
    assert call("binary_list_to_integer", [True, False, True]) == 5
    assert call("binary_list_to_integer", []) == 0
    assert call("binary_list_to_integer", [1, 0, 7]) == 5


def test_the_32nd_bit_is_the_sign_and_later_ones_do_not_count(call: Any) -> None:
    assert call("binary_list_to_integer", [False] * 31 + [True]) == -(2**31)
    assert call("binary_list_to_integer", [True] * 32) == -1
    assert call("binary_list_to_integer", [False] * 32 + [True] * 8) == 0
    assert call("binary_list_to_integer", [True] * 31) == 2**31 - 1


@pytest.mark.parametrize("number", [0, 1, -1, 11, 2**31 - 1, -(2**31), -12345])
def test_bits_go_both_ways(call: Any, number: int) -> None:
    bits = call("integer_to_binary_list", number)
    assert type(bits) is list
    assert len(bits) == 32
    assert {type(bit) for bit in bits} == {bool}
    assert call("bit_list_to_integer", bits) == number


def test_numbers_of_more_than_32_bits_are_refused(call: Any) -> None:
    assert call("integer_to_bit_list", 2**32 - 1) == [True] * 32
    for number in (2**32, -(2**31) - 1):
        with pytest.raises(ArgumentRangeError, match=r"^integer_to_byte_list: x must be in"):
            call("integer_to_byte_list", number)


def test_lengths(call: Any) -> None:
    assert call("get_list_length", [[1, 2], "a", None]) == 3
    assert call("length", (1, 2)) == 2
    assert call("length", "häß") == 3
    assert call("length", []) == 0
    with pytest.raises(ArgumentTypeError, match=r"^length: v must be str or list"):
        call("length", 5)
    with pytest.raises(ArgumentTypeError, match=r"^get_list_length: v must be a list"):
        call("get_list_length", "text")
