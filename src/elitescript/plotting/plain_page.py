"""Writes the plain page, which needs no front end: one HTML file with its data, style and code."""

from __future__ import annotations

import html
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from elitescript.controller.views.trace_rows import TraceRows
from elitescript.language.text.source import SourceFile
from elitescript.plotting.channel_lanes import channel_lanes
from elitescript.plotting.curves import error_curves, joint_curves, speed_curve, tcp_path, tcp_speeds
from elitescript.plotting.events import marks, moves
from elitescript.plotting.line_times import line_times, merged, stretches
from elitescript.plotting.packing import milliseconds, shown_text
from elitescript.plotting.recording import Recording
from elitescript.plotting.signal_lanes import signal_lanes, signal_lanes_of_rows

STRETCHES_MAX: Final = 4000
THREAD_STRETCHES_MAX: Final = 800
"""Stretches of one thread beside the main one."""

THREADS_MAX: Final = 16
"""Threads beside the main one whose lines are shown: those that began first."""

SOURCE_TEXT_MAX: Final = 400
"""Characters of a source line on the page."""

SOURCE_MAX: Final = 150_000
"""Characters of the program on the page; of a longer one only lines that are referred to follow."""

_FOLDER: Final = Path(__file__).parent


def plain_page(recording: Recording) -> str:
    """Return the text of the HTML file."""
    data = json.dumps(page_data(recording), ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    parts = {
        "title": html.escape(shown_text(recording.title)),
        "style": _part("page.css"),
        "code": _part("page.js"),
        # An end tag or a comment in a text of the program must not end the element.
        "data": data.replace("<", "\\u003c"),
    }
    pieces = _part("page.html").split("@@")
    return "".join(parts[piece] if index % 2 else piece for index, piece in enumerate(pieces))


def page_data(recording: Recording) -> dict[str, Any]:
    """Return what the page's code draws, as JSON has it; SI units."""
    rows, model = TraceRows.of(recording.rows), recording.model
    start_s, end_s = rows.times[0], rows.times[-1]
    speeds = tcp_speeds(rows)
    found = stretches(rows)
    spans = merged(found, STRETCHES_MAX)
    table = line_times(rows)
    events = recording.events
    shown_marks, marks_left_out = marks(events)
    shown_moves = moves(events, end_s)
    signals = signal_lanes(events, start_s) if recording.source is not None else signal_lanes_of_rows(rows)
    channels = channel_lanes(events)
    threads = [
        {
            "name": shown_text(name),
            "t": milliseconds([shown[0].start_s, *(span.end_s for span in shown)]),
            "line": [span.line for span in shown],
        }
        for name, known in list(recording.thread_lines.items())[:THREADS_MAX]
        if (shown := merged(known, THREAD_STRETCHES_MAX))
    ]
    named = {entry.line for entry in table} | {mark["line"] for mark in shown_marks}
    named.update(line for _, _, _, line in shown_moves)
    named.update(line for _, line in signals["causes"])
    named.update(line for lane in channels["lanes"] for line in lane["line"])
    named.update(line for thread in threads for line in thread["line"])
    return {
        "title": shown_text(recording.title),
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
        "source_lines": 0 if recording.source is None else len(_lines(recording.source)),
        "threads": threads,
        "threads_left_out": max(0, len(recording.thread_lines) - THREADS_MAX),
        "moves": shown_moves,
        "signals": signals,
        "channels": channels,
        "marks": shown_marks,
        "marks_left_out": marks_left_out,
    }


def _source_lines(source: SourceFile, named: set[int]) -> dict[int, str]:
    """Return the text of the program by line; of a very long one its begin and the lines in `named`."""
    lines: dict[int, str] = {}
    size = 0
    for number, text in enumerate(_lines(source), 1):
        shown = shown_text(text.rstrip(), SOURCE_TEXT_MAX)
        size += len(shown) + 8
        if size <= SOURCE_MAX or number in named:
            lines[number] = shown
    return lines


def _lines(source: SourceFile) -> Sequence[str]:
    """Return the lines without the empty one after the last line end."""
    return source.lines[:-1] if source.lines and not source.lines[-1] else source.lines


def _part(name: str) -> str:
    return (_FOLDER / name).read_text(encoding="utf-8")
