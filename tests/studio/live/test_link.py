"""What comes from a worker, in which a program of a stranger runs, is bounded before it is read."""

import asyncio
import struct

import pytest

from elitescript.studio.live.link import FRAME_MAX, JSON, framed, message_of, read_frame


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"{",
        b"[1]",
        b"7",
        b"{}",
        b'{"type": 7}',
        b"\xff",
        b"[" * 100_000,
        b'{"type": "at", "moment": ' + b"[" * 100_000 + b"]" * 100_000 + b"}",
        b'{"type": "at", "moment": ' + b"9" * 5000 + b"}",
    ],
)
def test_what_is_no_message_ends_the_worker_as_if_it_were_gone(data):
    with pytest.raises(EOFError):
        message_of(data)


def test_a_frame_has_a_largest_size():
    async def read(data):
        reader = asyncio.StreamReader()
        reader.feed_data(data)
        return await read_frame(reader)

    message = {"type": "at", "moment": {"t": 1.5}}
    kind, data = asyncio.run(read(framed(message)))
    assert (kind, message_of(data)) == (JSON, message)
    with pytest.raises(EOFError):
        asyncio.run(read(struct.pack("<BI", JSON, FRAME_MAX + 1)))
