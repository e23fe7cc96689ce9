"""MODBUS RTU: checksums, lengths, frames out of a stream."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from elitescript.modbus.frames import pdu
from elitescript.modbus.frames.rtu import (
    UNKNOWN,
    RtuSplitter,
    answer_length,
    crc16,
    request_length,
    rtu_frame,
)

REQUESTS = st.one_of(
    st.builds(pdu.read, st.sampled_from([1, 2, 3, 4]), st.integers(0, 60000), st.integers(1, 125)),
    st.builds(pdu.write_coil, st.integers(0, 65535), st.booleans()),
    st.builds(pdu.write_register, st.integers(0, 65535), st.integers(0, 65535)),
    st.builds(pdu.write_coils, st.integers(0, 60000), st.lists(st.booleans(), min_size=1, max_size=1968)),
    st.builds(pdu.write_registers, st.just(0), st.lists(st.integers(0, 65535), min_size=1, max_size=123)),
    st.builds(
        pdu.read_write_registers,
        st.just(0),
        st.integers(1, 125),
        st.just(9),
        st.lists(st.integers(0, 65535), min_size=1, max_size=121),
    ),
)
ANSWERS = st.one_of(
    st.builds(pdu.bits_read, st.sampled_from([1, 2]), st.lists(st.booleans(), min_size=1, max_size=2000)),
    st.builds(
        pdu.registers_read, st.sampled_from([3, 4, 23]), st.lists(st.integers(0, 65535), min_size=1, max_size=125)
    ),
    st.builds(pdu.exception, st.sampled_from([1, 6, 16, 65]), st.integers(1, 11)),
    st.builds(pdu.write_register, st.integers(0, 65535), st.integers(0, 65535)),
)


@pytest.mark.parametrize(
    ("data", "crc"),
    [(b"123456789", 0x4B37), (b"\x02\x07", 0x1241), (b"", 0xFFFF), (bytes.fromhex("010300000001"), 0x0A84)],
)
def test_the_checksum_is_that_of_the_specification(data: bytes, crc: int) -> None:
    assert crc16(data) == crc


def test_the_checksum_follows_low_byte_first() -> None:
    assert rtu_frame(1, pdu.read(3, 0, 1)).hex() == "010300000001840a"


@given(st.integers(0, 247), REQUESTS)
def test_the_length_of_a_request_is_told_by_its_begin(unit: int, request: bytes) -> None:
    frame = rtu_frame(unit, request)
    lengths = [request_length(frame[:size]) for size in range(len(frame) + 1)]
    assert set(lengths) <= {None, len(frame)}
    assert lengths[11 if len(frame) > 11 else -1] == len(frame)


@given(st.integers(0, 247), ANSWERS)
def test_the_length_of_an_answer_is_told_by_three_bytes(unit: int, answer: bytes) -> None:
    frame = rtu_frame(unit, answer)
    assert answer_length(frame[:3]) == len(frame)
    assert answer_length(frame[:1]) is None


def test_an_unknown_function_has_no_length() -> None:
    assert request_length(b"\1\x41") == answer_length(b"\1\x41") == UNKNOWN


@given(st.booleans(), st.lists(st.tuples(st.integers(0, 247), st.data()), max_size=4), st.integers(1, 9))
def test_frames_arrive_however_they_are_chopped(
    is_slave: bool, drawn: list[tuple[int, st.DataObject]], size: int
) -> None:
    frames = [(unit, data.draw(REQUESTS if is_slave else ANSWERS)) for unit, data in drawn]
    stream = b"".join(rtu_frame(*frame) for frame in frames)
    splitter = RtuSplitter(is_slave=is_slave)
    found = []
    for begin in range(0, len(stream), size):
        found += splitter.feed(stream[begin : begin + size])
    assert found == frames
    assert (splitter.waiting, splitter.dropped) == (0, 0)


@given(st.binary(max_size=40), REQUESTS)
def test_silence_finds_the_frame_behind_noise(noise: bytes, request: bytes) -> None:
    splitter = RtuSplitter(is_slave=True)
    found = splitter.feed(noise) + splitter.silence()
    found += splitter.feed(rtu_frame(9, request)) + splitter.silence()
    assert found[-1] == (9, request)
    assert splitter.waiting == 0


def test_a_wrong_checksum_is_no_frame() -> None:
    splitter = RtuSplitter(is_slave=False)
    frame = bytearray(rtu_frame(1, pdu.registers_read(3, [1])))
    frame[3] ^= 1
    assert splitter.feed(bytes(frame)) + splitter.silence() == []
    assert splitter.dropped == len(frame)
    assert splitter.feed(rtu_frame(1, pdu.registers_read(3, [1]))) == [(1, pdu.registers_read(3, [1]))]


def test_a_frame_of_an_unknown_function_ends_with_silence() -> None:
    splitter = RtuSplitter(is_slave=True)
    frame = rtu_frame(3, b"\x41hello")
    assert splitter.feed(frame) == []
    assert splitter.silence() == [(3, b"\x41hello")]


@given(st.booleans(), st.lists(st.binary(max_size=400), max_size=8))
def test_garbage_neither_breaks_it_nor_piles_up(is_slave: bool, chunks: list[bytes]) -> None:
    splitter = RtuSplitter(is_slave=is_slave)
    total = 0
    for chunk in chunks:
        total += sum(len(frame.pdu) + 3 for frame in splitter.feed(chunk))
        assert splitter.waiting <= 256
    total += sum(len(frame.pdu) + 3 for frame in splitter.silence())
    assert splitter.waiting == 0
    assert total + splitter.dropped == sum(map(len, chunks))
