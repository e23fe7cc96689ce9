"""Reads frames of rows, by the description of `rows.ts` alone."""

from __future__ import annotations

import struct

from elitescript.conversation.rows import COLUMNS

SIZES = {0: (4, "f"), 1: (8, "d"), 2: (2, "H"), 3: (4, "i")}
"""Bytes and letter of each kind of column."""


def read(frame):
    """Return run, ticks and columns of a frame."""
    magic, run, first, step, rows, count, zero = struct.unpack_from("<4sIIIIHH", frame)
    assert (magic, zero) == (b"ESC1", 0)
    names = [struct.unpack_from("<BB", frame, 24 + 2 * index) for index in range(count)]
    offset = -(-(24 + 2 * count) // 8) * 8
    columns = {}
    for kind, name in names:
        size, code = SIZES[kind]
        columns[COLUMNS[name]] = list(struct.unpack_from(f"<{rows}{code}", frame, offset))
        offset += -(-rows * size // 8) * 8
    assert offset == len(frame)
    ticks = columns.pop("tick", None)
    assert (ticks is not None) == (step == 0)
    return run, ticks or [first + step * row for row in range(rows)], columns


def joints_by_tick(frames):
    """Return the joints of all rows of frames by their ticks."""
    found = {}
    for frame in frames:
        _, ticks, columns = read(frame)
        for index, tick in enumerate(ticks):
            assert tick not in found
            found[tick] = tuple(columns[f"q{joint}"][index] for joint in range(1, 7))
    assert list(found) == sorted(found)
    return found
