"""A run as notebooks show it: verdict, findings, and a picture of its time, in a few kilobytes of HTML.

There is no script and no style sheet in it, and the picture is an image, in which nothing can act: notebooks that
others wrote show it too. All texts are escaped.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable, Iterator, Sequence
from html import escape
from pathlib import PurePath
from typing import TYPE_CHECKING, Final

from elitescript.messages.events import Event, MotionEnded, MotionStarted, SignalChanged
from elitescript.messages.findings import ERROR, NOTE, Finding
from elitescript.messages.timing import seconds
from elitescript.records import NamedTuple
from elitescript.shown import shown

if TYPE_CHECKING:
    from elitescript.controller.views.trace_rows import TraceRows

FINDINGS_MAX: Final = 20
TEXT_MAX: Final = 300
"""Characters of a text."""
LANES_MAX: Final = 8
"""Digital signals that are drawn, those first that change first."""
POINTS_MAX: Final = 300
"""Points of a curve."""

_WIDTH, _LEFT, _RIGHT, _CURVES, _LANE = 720, 150, 24, 130, 16
_COLORS: Final = ("#4e79a7", "#f28e2b", "#59a14f", "#b07aa1", "#9c755f", "#e15759")
"""Of the joints; they are told apart on light and dark grounds."""
_GREY: Final = "#888"
GOOD, DOUBTFUL, BAD = "#2e7d32", "#b26a00", "#c62828"
"""Colours of verdicts."""


class Shown(NamedTuple):
    """What is shown of a run.

    Attributes:
        name: of the program.
        verdict: how it ended and what was found, in words.
        is_clean: whether it finished without errors and warnings.
        is_bad: whether it ended by an alarm.
        why: why it did not finish; empty if it did.
        time_s: its duration.
        start_tick: its first tick.
        findings: of text and run, the worst first.
        events: what happened.
        rows: of its trace; empty without one.
    """

    name: str
    verdict: str
    is_clean: bool
    is_bad: bool
    why: str
    time_s: float
    start_tick: int
    findings: Sequence[Finding]
    events: Sequence[Event]
    rows: TraceRows


def html_of(run: Shown) -> str:
    """Return a run as HTML."""
    color = GOOD if run.is_clean else BAD if run.is_bad else DOUBTFUL
    head = (
        f'<b style="color:{color}">{_text(run.verdict)}</b> after {run.time_s:.3f} s: {_text(PurePath(run.name).name)}'
    )
    parts = [f"<div>{head}</div>"]
    if run.why:
        parts.append(f"<div>{_text(run.why)}</div>")
    if run.findings:
        parts.append("".join(_table(run.findings)))
    picture = b64encode("".join(_picture(run)).encode()).decode()
    parts.append(f'<img alt="time line of the run" src="data:image/svg+xml;base64,{picture}">')
    return "<div>" + "".join(parts) + "</div>"


def _text(text: str) -> str:
    """Return a text in which nothing acts."""
    return escape(shown(text if len(text) <= TEXT_MAX else f"{text[: TEXT_MAX - 3]}..."))


def _table(findings: Sequence[Finding]) -> Iterator[str]:
    yield '<table style="text-align:left">'
    for found in findings[:FINDINGS_MAX]:
        color = BAD if found.severity == ERROR else _GREY if found.severity == NOTE else DOUBTFUL
        when = "" if found.t is None else f"{found.t:.3f} s"
        times = f" ({found.count} times)" if found.count > 1 else ""
        hint = f'<br><span style="color:{_GREY}">{_text(found.hint)}</span>' if found.hint else ""
        cells = (
            (f'<span style="color:{color}">{_text(f"{found.severity} {found.code}")}</span>', "nowrap"),
            (f"line {found.line}" if found.line else "", "nowrap"),
            (when, "nowrap"),
            (f"{_text(found.text)}{times}{hint}", "normal"),
        )
        yield (
            "<tr>"
            + "".join(f'<td style="text-align:left;white-space:{space}">{cell}</td>' for cell, space in cells)
            + "</tr>"
        )
    yield "</table>"
    if len(findings) > FINDINGS_MAX:
        yield f"<div>and {len(findings) - FINDINGS_MAX} more</div>"


# ---------------------------------------------------------------- picture


def _picture(run: Shown) -> Iterator[str]:
    """Yield an SVG image: joints if there is a trace, moves, digital signals, and where findings are."""
    span_s = max(run.time_s, 0.004)
    scale = (_WIDTH - _LEFT - _RIGHT) / span_s
    first_s = seconds(run.start_tick)
    moves = list(_moves(run))
    lanes = _lanes(run)
    top = (_CURVES + 10) * (len(run.rows) > 0)
    height = top + _LANE * (len(lanes) + bool(moves)) + 26
    size = f'width="{_WIDTH}" height="{height}" font-family="sans-serif" font-size="10"'
    yield f'<svg xmlns="http://www.w3.org/2000/svg" {size}>'
    if top:
        yield from _curves(run.rows, first_s, scale)
    y = top + 4
    if moves:
        yield _label("moves", y)
        for begin_s, end_s, line in moves:
            width = max(1.0, (end_s - begin_s) * scale - 0.5)
            yield f'<rect x="{_LEFT + begin_s * scale:.1f}" y="{y}" width="{width:.1f}" height="9" fill="{_COLORS[0]}">'
            yield f"<title>line {line}</title></rect>"
        y += _LANE
    for name, stretches in lanes.items():
        yield _label(name, y)
        for begin_s, end_s in stretches:
            x, width = _LEFT + begin_s * scale, max(0.5, (end_s - begin_s) * scale)
            yield f'<rect x="{x:.1f}" y="{y}" width="{width:.1f}" height="9" fill="{_COLORS[2]}"/>'
        y += _LANE
    yield from _axis(span_s, scale, y)
    for found in run.findings[:FINDINGS_MAX]:
        if found.t is not None and found.severity != NOTE:
            x, color = _LEFT + found.t * scale, BAD if found.severity == ERROR else DOUBTFUL
            yield f'<path d="M{x:.1f} 0V{y}" stroke="{color}" stroke-dasharray="3 2"/>'
    yield "</svg>"


def _label(text: str, y: int) -> str:
    return f'<text x="{_LEFT - 6}" y="{y + 8}" text-anchor="end" fill="{_GREY}">{_text(text)}</text>'


def _curves(rows: TraceRows, first_s: float, scale: float) -> Iterator[str]:
    """Yield target joint positions over time."""
    every = max(1, len(rows) // POINTS_MAX)
    times = rows.times[::every]
    columns = [rows.column(f"q{joint}")[::every] for joint in range(1, 7)]
    low, high = min(map(min, columns)), max(map(max, columns))
    height = (_CURVES - 14) / (high - low or 1.0)
    for y, value in ((8, high), (_CURVES, low)):
        yield f'<text x="{_LEFT - 6}" y="{y}" text-anchor="end" fill="{_GREY}">{value:.2f} rad</text>'
    for joint, (column, color) in enumerate(zip(columns, _COLORS, strict=True), 1):
        points = " ".join(
            f"{_LEFT + (t - first_s) * scale:.1f},{4 + (high - q) * height:.1f}"
            for t, q in zip(times, column, strict=True)
        )
        yield f'<polyline points="{points}" fill="none" stroke="{color}"/>'
        yield f'<text x="4" y="{16 * joint + 12}" fill="{color}">joint {joint}</text>'


def _moves(run: Shown) -> Iterator[tuple[float, float, int]]:
    """Yield begin, end and line of each motion; those that take less than a pixel are one with the next."""
    begun: MotionStarted | None = None
    least, last_s, kept = run.time_s / _WIDTH, -1.0, 0
    for event in run.events:
        if isinstance(event, MotionStarted):
            begun = event
        elif isinstance(event, MotionEnded) and begun is not None:
            begin_s, end_s = (seconds(its.tick - run.start_tick) for its in (begun, event))
            if end_s - last_s >= least and kept < _WIDTH:
                yield begin_s, end_s, begun.line
                last_s, kept = end_s, kept + 1
            begun = None


def _lanes(run: Shown) -> dict[str, list[tuple[float, float]]]:
    """Return when the first digital signals that change are on; pulses within a pixel are one."""
    lanes: dict[str, list[tuple[float, float]]] = {}
    on: dict[str, float] = {}
    least = run.time_s / _WIDTH
    for event in run.events:
        if not isinstance(event, SignalChanged) or not isinstance(event.value, bool):
            continue
        if event.name not in lanes and len(lanes) == LANES_MAX:
            continue
        t = max(0.0, seconds(event.tick - run.start_tick))
        lane = lanes.setdefault(event.name, [])
        if event.value:
            on.setdefault(event.name, t)
        else:
            _join(lane, on.pop(event.name, 0.0 if not lane else t), t, least)
    for name, t in on.items():
        _join(lanes[name], t, run.time_s, least)
    return lanes


def _join(lane: list[tuple[float, float]], begin_s: float, end_s: float, least_s: float) -> None:
    if lane and begin_s - lane[-1][1] < least_s:
        begin_s = lane.pop()[0]
    lane.append((begin_s, end_s))


def _axis(span_s: float, scale: float, y: int) -> Iterator[str]:
    """Yield the axis of time with some round marks."""
    yield f'<path d="M{_LEFT} {y}H{_WIDTH - _RIGHT}" stroke="{_GREY}"/>'
    for t in _marks(span_s):
        x = _LEFT + t * scale
        yield f'<path d="M{x:.1f} {y}v4" stroke="{_GREY}"/>'
        yield f'<text x="{x:.1f}" y="{y + 15}" text-anchor="middle" fill="{_GREY}">{t:g} s</text>'


def _marks(span_s: float) -> Iterable[float]:
    """Return round times, five to ten of them."""
    step = 10.0 ** len(f"{span_s:.0f}")
    while span_s / step < 4:
        step /= 2 if f"{step:.0e}"[0] in "15" else 2.5
        step = float(f"{step:.3g}")
    return [round(step * number, 9) for number in range(int(span_s / step) + 1)]
