"""Requests and answers as bytes."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from elitescript.errors import UsageError
from elitescript.modbus.frames import pdu

ADDRESS = st.integers(0, 65535)
WORD = st.integers(0, 65535)


@pytest.mark.parametrize(
    ("request_bytes", "wire"),
    [
        # The examples of the specification, chapters 6.1 to 6.17.
        (pdu.read(1, 0x13, 0x13), "0100130013"),
        (pdu.read(2, 0xC4, 0x16), "0200c40016"),
        (pdu.read(3, 0x6B, 3), "03006b0003"),
        (pdu.read(4, 8, 1), "0400080001"),
        (pdu.write_coil(0xAC, True), "0500acff00"),
        (pdu.write_coil(0xAC, False), "0500ac0000"),
        (pdu.write_register(1, 3), "0600010003"),
        (pdu.write_coils(0x13, [1, 0, 1, 1, 0, 0, 1, 1, 1, 0]), "0f0013000a02cd01"),
        (pdu.write_registers(1, [0x0A, 0x102]), "100001000204000a0102"),
        (pdu.read_write_registers(3, 6, 14, [255, 255, 255]), "1700030006000e00030600ff00ff00ff"),
        (pdu.custom(8, b"\0\0\xa5\x37"), "080000a537"),
    ],
)
def test_requests_look_as_the_specification_shows_them(request_bytes: bytes, wire: str) -> None:
    assert request_bytes.hex() == wire


@pytest.mark.parametrize(
    ("request_bytes", "answer", "values"),
    [
        (pdu.read(1, 0x13, 0x13), "0103cd6b05", (1, 0, 1, 1, 0, 0, 1, 1, 1, 1, 0, 1, 0, 1, 1, 0, 1, 0, 1)),
        (pdu.read(3, 0x6B, 3), "0306022b00000064", (555, 0, 100)),
        (pdu.read(4, 8, 1), "0402000a", (10,)),
        (pdu.write_coil(0xAC, True), "0500acff00", ()),
        (pdu.write_coils(0x13, [1] * 10), "0f0013000a", ()),
        (pdu.write_registers(1, [1, 2]), "1000010002", ()),
        (pdu.read_write_registers(3, 2, 14, [255]), "170400fe0acd", (254, 2765)),
        (pdu.custom(65, b"ab"), "41ffff", ()),
    ],
)
def test_answers_give_the_values_of_the_specification(
    request_bytes: bytes, answer: str, values: tuple[int, ...]
) -> None:
    assert pdu.values_of(request_bytes, bytes.fromhex(answer)) == values


@pytest.mark.parametrize(
    ("build", "limit"),
    [
        (lambda count: pdu.read(1, 0, count), 2000),
        (lambda count: pdu.read(2, 0, count), 2000),
        (lambda count: pdu.read(3, 0, count), 125),
        (lambda count: pdu.read(4, 0, count), 125),
        (lambda count: pdu.write_coils(0, [1] * count), 1968),
        (lambda count: pdu.write_registers(0, [1] * count), 123),
        (lambda count: pdu.read_write_registers(0, count, 0, [1]), 125),
        (lambda count: pdu.read_write_registers(0, 1, 0, [1] * count), 121),
    ],
)
def test_counts_end_where_the_specification_says(build, limit: int) -> None:  # type: ignore[no-untyped-def]
    assert len(build(limit)) <= pdu.PDU_MAX
    for count in (0, limit + 1):
        with pytest.raises(UsageError, match=f"1 to {limit} of them, got {count}"):
            build(count)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: pdu.read(5, 0, 1), "function 5 does not read"),
        (lambda: pdu.read(3, 65536, 1), "0 to 65535, got 65536"),
        (lambda: pdu.read(3, 65535, 2), "go beyond the last address"),
        (lambda: pdu.write_register(0, 65536), "0 to 65535, got 65536"),
        (lambda: pdu.write_registers(0, [1, -1]), "0 to 65535, got -1"),
        (lambda: pdu.custom(128, b""), "1 to 127, got 128"),
        (lambda: pdu.custom(0, b""), "1 to 127, got 0"),
        (lambda: pdu.custom(6, bytes(253)), "at most 252"),
    ],
)
def test_what_cannot_be_asked_is_refused(call, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(UsageError, match=message):
        call()


@given(st.sampled_from([1, 2, 3, 4]), ADDRESS, st.integers(1, 125))
def test_requests_that_read_come_apart_again(function: int, address: int, count: int) -> None:
    count = min(count, 65536 - address)
    assert pdu.request_of(pdu.read(function, address, count)) == (function, address, count, (), 0)


@given(ADDRESS, st.lists(st.booleans(), min_size=1, max_size=1968))
def test_coils_come_apart_again(address: int, levels: list[bool]) -> None:
    levels = levels[: 65536 - address]
    request = pdu.write_coils(address, levels)
    assert pdu.request_of(request) == (15, address, len(levels), tuple(map(int, levels)), 0)
    assert pdu.values_of(request, pdu.written(request)) == ()


@given(ADDRESS, st.lists(WORD, min_size=1, max_size=121), ADDRESS, st.integers(1, 125))
def test_registers_come_apart_again(address: int, words: list[int], other: int, count: int) -> None:
    words, count = words[: 65536 - address], min(count, 65536 - other)
    assert pdu.request_of(pdu.write_registers(address, words)) == (16, address, len(words), tuple(words), 0)
    both = pdu.read_write_registers(other, count, address, words)
    assert pdu.request_of(both) == (23, other, count, tuple(words), address)
    assert pdu.values_of(both, pdu.registers_read(23, words[:1] * count)) == tuple(words[:1] * count)


@given(st.sampled_from([1, 2]), st.lists(st.booleans(), min_size=1, max_size=2000))
def test_bits_that_were_read_arrive(function: int, levels: list[bool]) -> None:
    answer = pdu.bits_read(function, levels)
    assert pdu.values_of(pdu.read(function, 0, len(levels)), answer) == tuple(map(int, levels))


@given(st.binary(max_size=260))
def test_any_bytes_are_a_request_or_refused_with_a_code(data: bytes) -> None:
    try:
        request = pdu.request_of(data)
    except pdu.ExceptionResponse as error:
        assert error.code in (1, 2, 3)
    else:
        assert request.address + request.quantity <= 65536
        assert request.write_address + len(request.values) <= 65536 or request.function != 23


@pytest.mark.parametrize(
    ("wire", "code"),
    [
        ("", 1),
        ("07", 1),
        ("83", 1),
        ("0300000000", 3),
        ("030000007e", 3),
        ("03000000", 3),
        ("0300000001ff", 3),
        ("03ffff0002", 2),
        ("01000007d1", 3),
        ("0500000001", 3),
        ("0500ac", 3),
        ("0f00000009010f", 3),
        ("0f0000000a02cd", 3),
        ("0f0000", 3),
        ("100000000000", 3),
        ("10ffff00020400010002", 2),
        ("1700000001000000010200", 3),
        ("17000000010000007af4" + "00" * 244, 3),
        ("17ffff0002000000010200ff", 2),
        ("170000000100ff", 3),
    ],
)
def test_bad_requests_have_the_exception_of_the_specification(wire: str, code: int) -> None:
    with pytest.raises(pdu.ExceptionResponse) as caught:
        pdu.request_of(bytes.fromhex(wire))
    assert caught.value.code == code


@pytest.mark.parametrize("code", [1, 2, 3, 4, 5, 6, 7, 8, 10, 11, 77])
def test_a_refusal_carries_its_code(code: int) -> None:
    with pytest.raises(pdu.ExceptionResponse, match=f"exception {code}: ") as caught:
        pdu.values_of(pdu.read(3, 0, 1), pdu.exception(3, code))
    assert (caught.value.code, caught.value.function) == (code, 3)


@pytest.mark.parametrize(
    "answer",
    ["", "03", "04020001", "8402", "8302ff", "0304", "0302000100", "030400010002", "0303000100"],
)
def test_an_answer_to_something_else_is_none(answer: str) -> None:
    with pytest.raises(pdu.AnswerError):
        pdu.values_of(pdu.read(3, 0, 1), bytes.fromhex(answer))


@pytest.mark.parametrize("answer", ["06000200ff", "0600010100", "0600"])
def test_a_write_has_to_be_repeated_by_its_answer(answer: str) -> None:
    with pytest.raises(pdu.AnswerError):
        pdu.values_of(pdu.write_register(1, 0xFF), bytes.fromhex(answer))
