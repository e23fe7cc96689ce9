"""Recorded conversations as bytes, which a page holds inside; `web/src/source/recording.ts` is the other side.

The bytes are a gzip stream of: `u32` length of the head, the head (JSON in ASCII), then the columns of the rows of each
run, one after the other. Little endian. The head is `{"format": 1, "runs": [run, ...]}`; a run has

- `said`: messages in the order in which a live source says them, from `hello` to `run_ended`, without its rows;
- `first`: the moment before the program began, if it is known;
- `globals`: for each program global `name`, and the times `t`, texts `value` and `type` of its changes;
- `waits`: for each thread `thread`, and the times `t` and texts `value` of what it waits for;
- `rows`: number `count` of rows and their `columns`: `name` as in `rows.COLUMNS`, `step`, `order`.

A column with a `step` is whole multiples of it: their differences of that order (the first ones against zeros), folded
so that small numbers of either sign are small (0, -1, 1, -2 ... are 0, 1, 2, 3 ...), and of these first the lowest byte
of all, then the next ones, four in all. A smooth motion leaves third differences near zero, of which half a byte is
left. A column with the step 0 is floats of 64 bits.
"""

from __future__ import annotations

import gzip
import json
import sys
from array import array
from collections.abc import Mapping, Sequence
from itertools import chain
from operator import sub
from typing import Any, Final

from elitescript.conversation.rows import COLUMNS
from elitescript.errors import UsageError
from elitescript.records import field, record
from elitescript.shown import encodable_json

FORMAT: Final = 1

JOINT_STEP_RAD: Final = 2e-7
POSE_STEP: Final = 4e-7
"""Of positions in m and angles in rad."""
SPEED_STEP: Final = 1e-6

_STEPS: Final[Mapping[str, tuple[float, int]]] = {
    COLUMNS[0]: (1.0, 2),
    **{f"q{joint}": (JOINT_STEP_RAD, 3) for joint in range(1, 7)},
    **{f"qa{joint}": (JOINT_STEP_RAD, 3) for joint in range(1, 7)},
    **{f"qd{joint}": (SPEED_STEP, 2) for joint in range(1, 7)},
    **dict.fromkeys(("x", "y", "z", "rx", "ry", "rz"), (POSE_STEP, 3)),
}
"""Step and order of differences of each column."""

_LARGEST: Final = 1 << 27
"""Differences of third order of smaller numbers fit into 31 bits."""

_GZIP_LEVEL: Final = 6


@record
class RecordedRun:
    """One run as its source has said it.

    Attributes:
        said: messages, from `hello` to `run_ended`.
        ticks: of the rows, ascending.
        columns: of the rows, by name.
        first: the moment before the program began; None if it is unknown.
        globals: changes of each program global: time, s, its value and type as text.
        waits: for each thread the times, s, from which on it waits for something else, and what that is.
    """

    said: Sequence[Mapping[str, Any]]
    ticks: Sequence[int]
    columns: Mapping[str, Sequence[float]]
    first: Mapping[str, Any] | None = None
    globals: Mapping[str, Sequence[tuple[float, str, str]]] = field(default_factory=dict)
    waits: Mapping[str, Sequence[tuple[float, str]]] = field(default_factory=dict)


def recording(runs: Sequence[RecordedRun]) -> bytes:
    """Return runs as the bytes of a recording; the same runs give the same bytes.

    Raises:
        UsageError: a column has an unknown name, or not a value for each row.
    """
    heads, bodies = [], []
    for run in runs:
        columns = []
        for name, values in {COLUMNS[0]: run.ticks, **run.columns}.items():
            if name not in _STEPS or len(values) != len(run.ticks):
                raise UsageError(f"column {name!r} with {len(values)} values cannot be recorded")
            step, order, coded = _coded(values, *_STEPS[name])
            columns.append({"name": name, "step": step, "order": order})
            bodies.append(coded)
        head: dict[str, Any] = {"said": list(run.said)}
        if run.first is not None:
            head["first"] = run.first
        head["globals"] = [
            {
                "name": name,
                "t": [t for t, _, _ in known],
                "value": [v for _, v, _ in known],
                "type": [k for *_, k in known],
            }
            for name, known in run.globals.items()
        ]
        head["waits"] = [
            {"thread": name, "t": [t for t, _ in known], "value": [text for _, text in known]}
            for name, known in run.waits.items()
        ]
        head["rows"] = {"count": len(run.ticks), "columns": columns}
        heads.append(head)
    described = json.dumps({"format": FORMAT, "runs": heads}, separators=(",", ":"), allow_nan=False)
    text = encodable_json(described).encode("ascii")
    return gzip.compress(b"".join([len(text).to_bytes(4, "little"), text, *bodies]), _GZIP_LEVEL, mtime=0)


def _coded(values: Sequence[float], step: float, order: int) -> tuple[float, int, bytes]:
    """Return step, order and bytes of a column."""
    scale = 1.0 / step
    whole: list[int] = []
    try:
        whole = [round(value * scale) for value in values]
        is_large = max(whole, default=0) >= _LARGEST or min(whole, default=0) <= -_LARGEST
    except (OverflowError, ValueError):
        # Infinite, or not a number.
        is_large = True
    if is_large:
        plain = array("d", values)
        if sys.byteorder == "big":
            plain.byteswap()
        return 0.0, 0, plain.tobytes()
    for _ in range(order):
        whole = list(map(sub, whole, chain((0,), whole)))
    folded = array("I", [2 * value if value >= 0 else -2 * value - 1 for value in whole])
    if sys.byteorder == "big":
        folded.byteswap()
    data = folded.tobytes()
    return step, order, b"".join(data[place::4] for place in range(4))
