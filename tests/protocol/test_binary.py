"""Packing from tables of fields."""

from __future__ import annotations

import math
import random

import pytest

from elitescript.protocol.binary import (
    BOOL,
    DOUBLE,
    FLOAT,
    INT8,
    INT16,
    INT32,
    INT64,
    UINT8,
    UINT16,
    UINT32,
    UINT64,
    VECTOR3D,
    VECTOR6D,
    VECTOR6INT32,
    VECTOR6UINT32,
    Field,
    FieldList,
    WireType,
    packed_bits,
)

SIZES = {
    BOOL: 1,
    INT8: 1,
    INT16: 2,
    INT32: 4,
    INT64: 8,
    UINT8: 1,
    UINT16: 2,
    UINT32: 4,
    UINT64: 8,
    FLOAT: 4,
    DOUBLE: 8,
    VECTOR3D: 24,
    VECTOR6D: 48,
    VECTOR6INT32: 24,
    VECTOR6UINT32: 24,
}


@pytest.mark.parametrize(("wire", "size"), SIZES.items(), ids=lambda value: getattr(value, "name", ""))
def test_a_type_has_its_size(wire: WireType, size: int) -> None:
    assert wire.size == size
    assert FieldList(Field("x", wire)).size == size


def test_integers_and_floats_are_big_endian_and_without_gaps() -> None:
    fields = FieldList(Field("a", UINT8), Field("b", UINT32), Field("c", BOOL), Field("d", DOUBLE), Field("e", INT16))
    data = fields.pack([1, 0x01020304, True, 1.5, -2])
    assert data == bytes.fromhex("01 01020304 01 3ff8000000000000 fffe")
    assert fields.unpack(data) == (1, 0x01020304, True, 1.5, -2)
    assert fields.offsets() == (0, 1, 5, 6, 14)


def test_vectors_go_in_and_come_out_as_one_value() -> None:
    fields = FieldList(Field("v", VECTOR3D), Field("n", UINT8), Field("w", VECTOR6INT32))
    values = ((1.0, -2.0, math.inf), 7, (1, 2, 3, -4, 5, 6))
    data = fields.pack(values)
    assert len(data) == 24 + 1 + 24
    assert fields.unpack(data) == values
    assert fields.unpack(b"xyz" + data + b"more", 3) == values


def test_random_values_come_back() -> None:
    dice = random.Random(4)
    scalars = {BOOL: lambda: dice.random() < 0.5, DOUBLE: lambda: dice.uniform(-1e9, 1e9)}
    for wire in (INT8, INT16, INT32, INT64, UINT8, UINT16, UINT32, UINT64):
        low = 0 if wire.name.startswith("U") else -(2 ** (8 * wire.size - 1))
        scalars[wire] = lambda low=low, size=wire.size: dice.randrange(low, low + 2 ** (8 * size))
    for _ in range(50):
        wires = [dice.choice(list(scalars)) for _ in range(dice.randrange(1, 12))]
        fields = FieldList(*(Field(f"f{i}", wire) for i, wire in enumerate(wires)))
        values = tuple(scalars[wire]() for wire in wires)
        assert fields.unpack(fields.pack(values)) == values


@pytest.mark.parametrize(
    ("wire", "value"),
    [
        (UINT8, 256),
        (UINT8, -1),
        (INT32, 2**31),
        (UINT32, 1.5),
        (DOUBLE, "x"),
        (VECTOR3D, (1.0, 2.0)),
        (DOUBLE, (1.0,) * 2),
    ],
)
def test_a_value_that_does_not_fit_is_refused_with_the_name_of_its_field(wire: WireType, value: object) -> None:
    fields = FieldList(Field("first", UINT8), Field("second", wire))
    with pytest.raises(ValueError, match=rf"second: .* is no {wire.name}"):
        fields.pack([1, value])  # type: ignore[list-item]


def test_the_number_of_values_must_be_right() -> None:
    with pytest.raises(ValueError, match="2 fields need as many values, not 1"):
        FieldList(Field("a", UINT8), Field("b", UINT8)).pack([1])


@pytest.mark.parametrize("offset", [0, 1, 99])
def test_too_few_bytes_are_refused(offset: int) -> None:
    with pytest.raises(ValueError, match="need 4 bytes"):
        FieldList(Field("a", UINT32)).unpack(b"123", offset)


def test_bits_are_packed_from_the_lowest() -> None:
    assert packed_bits([True, False, 1, 0.0, True]) == 0b10101
    assert packed_bits([]) == 0


def test_a_word_has_no_more_than_64_bits() -> None:
    assert packed_bits([True] * 64) == 2**64 - 1
    with pytest.raises(ValueError, match="64 bits, not 65"):
        packed_bits([False] * 65)
