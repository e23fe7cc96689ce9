"""Rows of a virtual robot as a controller would send them live, with what may happen to them on the way."""

from __future__ import annotations

import random
from collections import ChainMap
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from elitescript.audit.live import DIFFERENCE, Said, Shadow
from elitescript.audit.live_run import Expected
from elitescript.audit.motion import Tolerance
from elitescript.audit.simulation import cell_of
from elitescript.language.text.source import SourceFile
from elitescript.recorder.live import LiveRow
from elitescript.recorder.recording import Message, Recording

FAST = frozenset(
    {
        "timestamp",
        "script_control_line",
        "runtime_state",
        "safety_status",
        "target_joint_positions",
        "target_joint_speeds",
        "actual_digital_input_bits",
        "actual_digital_output_bits",
        "standard_analog_input0",
        "standard_analog_input1",
        "tool_analog_input",
        "speed_scaling",
        "target_speed_fraction",
    }
)


def live_rows(recording: Recording, *, shift_s: float = 0.0) -> Iterator[LiveRow]:
    """The rows of a recording as `LiveSink` gives them."""
    vectors: dict[str, int] = {}
    for column in recording.columns:
        name, _, place = column.partition(".")
        vectors[name] = max(vectors.get(name, 0), int(place or -1) + 1)
    others: dict[str, Any] = {}
    for row, t in enumerate(recording.t):
        values: dict[str, Any] = {}
        for name, size in vectors.items():
            if size:
                values[name] = tuple(recording.columns[f"{name}.{place}"][row] for place in range(size))
            else:
                values[name] = recording.columns[name][row]
        fast = {name: value for name, value in values.items() if name in FAST}
        slow = {name: value for name, value in values.items() if name not in FAST}
        if slow != others:
            others = slow
        yield LiveRow(t + shift_s, recording.arrived_s[row], ChainMap(fast, others))


def disturbed(rows: Iterable[LiveRow], seed: int, *, lost=0.02, doubled=0.05, late=0.02) -> list[LiveRow]:
    """Rows of which some are missing, some come twice, and some behind the next one."""
    draw = random.Random(seed)
    found = [row for row in rows if draw.random() >= lost]
    for place in range(len(found) - 1):
        if draw.random() < late:
            found[place], found[place + 1] = found[place + 1], found[place]
    return [row for row in found for _ in range(1 + (draw.random() < doubled))]


def shadowed(
    rows: Iterable[LiveRow | Message],
    program: str | Path,
    *,
    model: str | None = "CS66",
    world: Path | None = None,
    **expected: Any,
) -> list[Said]:
    """Everything that is said of these rows."""
    said: list[Said] = []
    source: Any = SourceFile("<cell>", program) if isinstance(program, str) else program
    cell = cell_of(source, model, world)
    shadow = Shadow(Expected(cell, expected.pop("tolerance", Tolerance()), **expected), said.append)
    for row in rows:
        shadow.take(row)
    shadow.finish()
    return said


def differences(said: Sequence[Said]) -> list[Said]:
    return [its for its in said if its.kind == DIFFERENCE]
