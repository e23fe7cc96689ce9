"""An answer among all that a serial line brings."""

from __future__ import annotations

import random

import pytest

from elitescript.modbus.frames import pdu
from elitescript.modbus.frames.pdu import ExceptionResponse
from elitescript.modbus.frames.rtu import rtu_frame
from elitescript.modbus.rtu_exchange import RtuExchange, gap_s

EXCHANGES = [
    (pdu.read(1, 3, 9), pdu.bits_read(1, [1] * 9), (1,) * 9),
    (pdu.read(2, 3, 1), pdu.bits_read(2, [0]), (0,)),
    (pdu.read(3, 3, 2), pdu.registers_read(3, [1, 65535]), (1, 65535)),
    (pdu.read(4, 3, 125), pdu.registers_read(4, list(range(125))), tuple(range(125))),
    (pdu.write_coil(3, 1), pdu.write_coil(3, 1), ()),
    (pdu.write_register(3, 7), pdu.write_register(3, 7), ()),
    (pdu.write_coils(3, [1] * 9), pdu.write_coils(3, [1] * 9)[:5], ()),
    (pdu.write_registers(3, [1, 2]), pdu.write_registers(3, [1, 2])[:5], ()),
]

exchanges = pytest.mark.parametrize(("request_pdu", "answer", "values"), EXCHANGES)


def test_silence_is_three_and_a_half_characters_but_never_less_than_the_standard_says():
    assert gap_s(0.001) == 0.0035
    assert gap_s(0.0001) == 0.00175


@exchanges
def test_the_answer_is_found_as_soon_as_it_is_complete(request_pdu, answer, values):
    exchange, frame = RtuExchange(17, request_pdu), rtu_frame(17, answer)
    assert exchange.frame == rtu_frame(17, request_pdu)
    for size in range(len(frame)):
        assert exchange.answer(frame[:size]) is None
    assert exchange.answer(frame) == values


@exchanges
def test_a_refusal_is_found(request_pdu, answer, values):
    with pytest.raises(ExceptionResponse, match="exception 4"):
        RtuExchange(17, request_pdu).answer(rtu_frame(17, pdu.exception(request_pdu[0], 4)))


@exchanges
def test_noise_around_does_no_harm(request_pdu, answer, values):
    draw = random.Random(5)
    exchange, frame = RtuExchange(17, request_pdu), rtu_frame(17, answer)
    for _ in range(300):
        noise = draw.randbytes(draw.randrange(40)) + bytes((17, request_pdu[0]))[: draw.randrange(3)]
        assert exchange.answer(noise + frame + draw.randbytes(3)) == values


@exchanges
def test_one_wrong_bit_is_one_too_many(request_pdu, answer, values):
    exchange, frame = RtuExchange(17, request_pdu), rtu_frame(17, answer)
    for bit in range(8 * len(frame)):
        wrong = bytearray(frame)
        wrong[bit // 8] ^= 1 << bit % 8
        assert exchange.answer(wrong) is None


@exchanges
def test_what_others_say_is_no_answer(request_pdu, answer, values):
    exchange = RtuExchange(17, request_pdu)
    assert exchange.answer(rtu_frame(18, answer)) is None
    assert exchange.answer(rtu_frame(17, pdu.registers_read(23, [5]))) is None
    assert not exchange.has_begun(rtu_frame(18, answer))


@exchanges
def test_the_echo_is_told_from_the_answer_where_that_is_possible(request_pdu, answer, values):
    exchange = RtuExchange(17, request_pdu)
    assert exchange.repeats == (exchange.answer(exchange.frame) is not None)
    assert exchange.echo_end(b"~" + exchange.frame + b"more") == 1 + len(exchange.frame)
    assert exchange.echo_end(exchange.frame[:-1]) == 0


def test_the_answer_to_an_earlier_request_is_another_one():
    exchange = RtuExchange(1, pdu.read(3, 0, 1))
    late = rtu_frame(1, pdu.registers_read(3, [1, 2]))
    assert exchange.answer(late) is None
    assert not exchange.has_begun(late)
    assert exchange.answer(late + rtu_frame(1, pdu.registers_read(3, [7]))) == (7,)


def test_what_was_written_elsewhere_is_no_answer():
    exchange = RtuExchange(1, pdu.write_registers(4, [1]))
    elsewhere = rtu_frame(1, pdu.write_registers(5, [1])[:5])
    assert exchange.answer(elsewhere) is None
    assert exchange.answer(elsewhere + rtu_frame(1, pdu.write_registers(4, [1])[:5])) == ()


@pytest.mark.parametrize("size", [2, 3, 5, 6])
def test_an_answer_that_is_cut_short_has_begun(size):
    frame = rtu_frame(1, pdu.registers_read(3, [7]))
    assert RtuExchange(1, pdu.read(3, 0, 1)).has_begun(b"~" + frame[:size])


def test_an_answer_with_a_wrong_checksum_has_begun():
    frame = rtu_frame(1, pdu.registers_read(3, [7]))
    assert RtuExchange(1, pdu.read(3, 0, 1)).has_begun(frame[:-1] + b"\x00")
    assert not RtuExchange(1, pdu.read(3, 0, 1)).has_begun(b"\x01")
