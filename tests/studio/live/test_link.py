"""What comes from a worker, in which a program of a stranger runs, is bounded before it is read."""

import asyncio
import json
import struct

import pytest

from elitescript.studio.live.link import FRAME_MAX, JSON, SHAPES, framed, message_of, read_frame
from elitescript.untrusted.json_text import json_value

MOMENT = {"t": 1.5, "line": 1, "globals": [{"name": "a", "value": "1"}]}
WHOLE = {
    "problems": {"version": 1, "list": [{"code": "E001"}], "compiles": True},
    "scene": {},
    "notice": {"severity": "error", "text": "why"},
    "code": {"digest": "d", "lines": [1, 2]},
    "same": {"moved": [[1, 2]]},
    "at": {"moment": MOMENT},
    "progress": {"run": 1, "t": 0},
    "run_began": {"run": 1, "version": 1},
    "lines": {"run": 1, "thread": "main", "t": [0.0, 1], "line": [1, 2]},
    "marks": {"run": 1, "t": [0.0, 1], "node": [1, 2]},
    "moves": {"run": 1, "list": [{"line": 1, "start_s": 0.0, "end_s": 1.0}]},
    "events": {"run": 1, "list": [{"type": "log"}, {"type": "warning", "text": "a", "line": 1}]},
    "left_out": {"run": 1, "events": 1, "bytes": 2},
    "contacts": {"run": 1, "list": [{}]},
    "cycle": {"run": 1, "table": [{"line": 1, "visits": 1, "moving_s": 0.5, "standing_s": 0}]},
    "run_ended": {"run": 1, "state": "alarm", "moment": MOMENT, "is_repeatable": True,
                  "alarm": {"line": 1, "code": "R100", "text": "why"}},
    "state": {"run": 1, "ask": 1, "moment": MOMENT},
    "detail_ended": {"run": 1, "ask": 1},
    "recorded": {"ask": 1, "content": ""},
    "refused": {"ask": 1, "text": "why"},
}  # fmt: skip


OPTIONAL = {("events", "text"), ("events", "line"), ("run_ended", "alarm")}


def _places(value, shape, path=()):
    """Yield the way to each value that a shape asks for."""
    if isinstance(shape, list):
        for index, item in enumerate(value):
            yield (*path, index)
            yield from _places(item, shape[0], (*path, index))
    elif isinstance(shape, dict):
        for name, inner in ((field.rstrip("?"), inner) for field, inner in shape.items()):
            if name in value:
                yield (*path, name)
                yield from _places(value[name], inner, (*path, name))


def _bytes_of(message, path, *, without=False):
    """Return a message with `null` at a place, or without it."""
    found = inner = json_value(json.dumps(message))
    for step in path[:-1]:
        inner = inner[step]
    if without:
        del inner[path[-1]]
    else:
        inner[path[-1]] = None
    return json.dumps(found).encode()


@pytest.mark.parametrize("kind", sorted(SHAPES))
def test_a_message_without_what_is_read_of_it_ends_the_worker(kind):
    whole = {"type": kind, **WHOLE[kind]}
    assert message_of(json.dumps(whole).encode()) == whole
    for path in _places(WHOLE[kind], SHAPES[kind]):
        with pytest.raises(EOFError):
            message_of(_bytes_of(whole, path))
        if isinstance(path[-1], str) and (kind, path[-1]) not in OPTIONAL:
            with pytest.raises(EOFError):
                message_of(_bytes_of(whole, path, without=True))


@pytest.mark.parametrize("kind", ["hello", "file", "saved", "answer", "moment", "no such"])
def test_a_worker_says_nothing_that_others_say(kind):
    with pytest.raises(EOFError):
        message_of(json.dumps({"type": kind, "ask": 1, "text": "a", "moment": MOMENT}).encode())


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

    message = {"type": "at", "moment": MOMENT}
    kind, data = asyncio.run(read(framed(message)))
    assert (kind, message_of(data)) == (JSON, message)
    with pytest.raises(EOFError):
        asyncio.run(read(struct.pack("<BI", JSON, FRAME_MAX + 1)))
