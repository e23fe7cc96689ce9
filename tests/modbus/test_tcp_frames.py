"""MODBUS TCP: frames out of a stream."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from elitescript.modbus.frames.pdu import read
from elitescript.modbus.frames.tcp import TcpSplitter, tcp_frame

FRAMES = st.lists(st.tuples(st.integers(0, 65535), st.integers(0, 255), st.binary(min_size=1, max_size=253)))


def test_a_frame_is_the_request_behind_a_header() -> None:
    assert tcp_frame(0x1501, 255, read(3, 4, 1)).hex() == "150100000006ff0300040001"


@given(FRAMES, st.lists(st.integers(1, 20), min_size=1))
def test_frames_arrive_however_they_are_chopped(frames: list[tuple[int, int, bytes]], sizes: list[int]) -> None:
    stream = b"".join(tcp_frame(*frame) for frame in frames)
    splitter, found = TcpSplitter(), []
    while stream:
        size = sizes[len(found) % len(sizes)]
        found += splitter.feed(stream[:size])
        stream = stream[size:]
    assert found == frames
    assert splitter.waiting == 0


def test_one_byte_at_a_time_is_enough() -> None:
    splitter = TcpSplitter()
    stream = tcp_frame(1, 2, b"\x03\x02\0\1") + tcp_frame(2, 2, b"\x83\x02")
    found = [frame for byte in stream for frame in splitter.feed(bytes((byte,)))]
    assert found == [(1, 2, b"\x03\x02\0\1"), (2, 2, b"\x83\x02")]


def test_what_is_left_of_a_frame_waits() -> None:
    splitter = TcpSplitter()
    assert splitter.feed(tcp_frame(1, 1, b"\x83\x02") + b"\0\2\0") == [(1, 1, b"\x83\x02")]
    assert splitter.waiting == 3
    assert not splitter.is_lost


def test_frames_of_another_protocol_are_left_out() -> None:
    splitter = TcpSplitter()
    foreign = bytes.fromhex("0001000700030101aa")
    assert splitter.feed(foreign + tcp_frame(5, 1, b"\x83\x02")) == [(5, 1, b"\x83\x02")]
    assert splitter.foreign == 1


@pytest.mark.parametrize("length", [0, 1, 255, 256, 65535])
def test_an_absurd_length_loses_the_stream(length: int) -> None:
    splitter = TcpSplitter()
    good = tcp_frame(1, 1, b"\x83\x02")
    bad = b"\0\2\0\0" + length.to_bytes(2, "big") + b"\1\3"
    assert splitter.feed(good + bad + good) == [(1, 1, b"\x83\x02")]
    assert splitter.is_lost
    assert splitter.feed(good) == []
    assert splitter.waiting == 0


@given(st.lists(st.binary(max_size=300), max_size=10))
def test_garbage_neither_breaks_it_nor_piles_up(chunks: list[bytes]) -> None:
    splitter = TcpSplitter()
    for chunk in chunks:
        for frame in splitter.feed(chunk):
            assert 1 <= len(frame.pdu) <= 253
        assert splitter.waiting < 260
