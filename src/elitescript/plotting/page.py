"""The page: one HTML file with its data, its style and its code, which asks no other computer for anything."""

from __future__ import annotations

import html
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from elitescript.controller.trace import TraceRow
from elitescript.language.source import SourceFile
from elitescript.messages.events import Event
from elitescript.models.model import RobotModel
from elitescript.plotting.curves import error_curves, joint_curves, milliseconds, speed_curve, tcp_path, tcp_speeds
from elitescript.plotting.happenings import marks, moves, signals
from elitescript.plotting.line_times import line_times, merged, stretches

STRETCHES_MAX: Final = 4000
SOURCE_TEXT_MAX: Final = 160
"""Characters of a source line on the page."""

_FOLDER: Final = Path(__file__).parent


@dataclass(frozen=True, slots=True)
class Recording:
    """What a page is about.

    Attributes:
        title: what the page is called.
        model: the arm that moved, whose limits are drawn.
        rows: at least one row of a trace.
        source: text of the program; None if only the trace is known.
        events: what happened besides motion; times count like those of the rows.
        state: how the run ended; empty if only the trace is known.
        step_s: time between two rows, s; 0 if only the trace is known.
    """

    title: str
    model: RobotModel
    rows: Sequence[TraceRow]
    source: SourceFile | None = None
    events: Sequence[Event] = ()
    state: str = ""
    step_s: float = 0.0


def page(recording: Recording) -> str:
    """The text of the HTML file."""
    data = json.dumps(page_data(recording), ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    parts = {
        "title": html.escape(recording.title),
        "style": _part("page.css"),
        "code": _part("page.js"),
        # An end tag or a comment in a text of the program must not end the element.
        "data": data.replace("<", "\\u003c"),
    }
    text = _part("page.html")
    pieces = text.split("@@")
    return "".join(parts[piece] if index % 2 else piece for index, piece in enumerate(pieces))


def page_data(recording: Recording) -> dict[str, Any]:
    """What the page's code draws, as JSON has it; SI units."""
    rows, model = recording.rows, recording.model
    start_s, end_s = rows[0].t, rows[-1].t
    speeds = tcp_speeds(rows)
    found = stretches(rows)
    spans = merged(found, STRETCHES_MAX)
    table = line_times(rows)
    traces, signals_left_out = signals(recording.events, start_s)
    shown_marks, marks_left_out = marks(recording.events)
    named = {entry.line for entry in table} | {mark["line"] for mark in shown_marks}
    return {
        "title": recording.title,
        "model": model.name,
        "state": recording.state,
        "start": start_s,
        "end": end_s,
        "arm": [model.arm.d1, model.arm.a2, model.arm.a3, model.arm.d4, model.arm.d5, model.arm.d6],
        "reach": model.reach_m,
        "joints": joint_curves(rows, model),
        "errors": error_curves(rows, model),
        "speed": speed_curve(rows, speeds, model.max_tool_speed),
        "path": tcp_path(rows, speeds),
        "spans": {"t": milliseconds([start_s, *(span.end_s for span in spans)]), "line": [span.line for span in spans]},
        "spans_left_out": len(found) - len(spans),
        "table": [[entry.line, round(entry.moving_s, 6), round(entry.standing_s, 6), entry.visits] for entry in table],
        "source": {} if recording.source is None else _source_lines(recording.source, named),
        "moves": moves(recording.events, end_s),
        "signals": traces,
        "signals_left_out": signals_left_out,
        "marks": shown_marks,
        "marks_left_out": marks_left_out,
    }


def _source_lines(source: SourceFile, numbers: set[int]) -> dict[int, str]:
    return {number: source.line(number).strip()[:SOURCE_TEXT_MAX] for number in sorted(numbers) if number > 0}


def _part(name: str) -> str:
    return (_FOLDER / name).read_text(encoding="utf-8")
