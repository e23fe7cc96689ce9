"""What happened besides motion: moves as bars, signals as traces, messages and alarms as marks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from elitescript.messages.events import (
    Alarm,
    Event,
    MotionEnded,
    MotionStarted,
    Popup,
    Printed,
    SafetyModeChanged,
    SignalChanged,
    TextMessage,
    Warned,
)
from elitescript.messages.signals import Value, parse_signal_name
from elitescript.messages.timing import seconds
from elitescript.plotting.decimation import extremes

SIGNALS_MAX: Final = 32
"""Signals with a trace of their own; those that changed first."""

CHANGES_MAX: Final = 400
MOVES_MAX: Final = 2000
MARKS_MAX: Final = 800
TEXT_MAX: Final = 300


def moves(events: Sequence[Event], end_s: float) -> list[list[Any]]:
    """Start, end, kind and line of every move that took time, s."""
    found: list[list[Any]] = []
    under_way: MotionStarted | None = None
    for event in events:
        if isinstance(event, MotionStarted):
            _close(found, under_way, seconds(event.tick))
            under_way = event
        elif isinstance(event, MotionEnded):
            _close(found, under_way, seconds(event.tick))
            under_way = None
    _close(found, under_way, end_s)
    while len(found) > MOVES_MAX:
        found = [_joined(found[index : index + 2]) for index in range(0, len(found), 2)]
    return found


def signals(events: Sequence[Event], start_s: float) -> tuple[list[dict[str, Any]], int]:
    """The signals that changed, each with its changes from the start on; and how many more there were."""
    changes: dict[str, list[tuple[float, Value]]] = {}
    for event in events:
        if isinstance(event, SignalChanged):
            entry = changes.setdefault(event.name, [(start_s, _value_before(event))])
            if entry[-1][0] == seconds(event.tick):
                entry[-1] = (entry[-1][0], event.value)
            else:
                entry.append((seconds(event.tick), event.value))
    shown = list(changes.items())[:SIGNALS_MAX]
    traces = []
    for name, steps in sorted(shown, key=lambda item: _order(item[0])):
        kept = extremes([time for time, _ in steps], [float(value) for _, value in steps], CHANGES_MAX)
        signal, _ = parse_signal_name(name)
        traces.append(
            {
                "name": name,
                "kind": signal.kind,
                "unit": signal.unit,
                "left_out": len(steps) - len(kept),
                "t": [round(steps[index][0], 3) for index in kept],
                "v": [_short(steps[index][1]) for index in kept],
            }
        )
    return traces, len(changes) - len(shown)


def marks(events: Sequence[Event]) -> tuple[list[dict[str, Any]], int]:
    """Messages, warnings and alarms with time, line and text; and how many more there were.

    Alarms are all kept, and of the rest the first.
    """
    found = [mark for event in events if (mark := _mark(event)) is not None]
    kept = found[:MARKS_MAX]
    kept += [mark for mark in found[MARKS_MAX:] if mark["kind"] == "alarm"]
    return kept, len(found) - len(kept)


def _mark(event: Event) -> dict[str, Any] | None:
    if isinstance(event, TextMessage):
        return _entry("message", event.tick, event.text, event.line)
    if isinstance(event, Printed):
        return _entry("print", event.tick, event.text.rstrip("\n"), event.line)
    if isinstance(event, Popup):
        return _entry("popup", event.tick, f"{event.title}: {event.text}" if event.title else event.text, event.line)
    if isinstance(event, Warned):
        return _entry("warning", event.tick, event.text, event.line)
    if isinstance(event, SafetyModeChanged):
        text = f"safety: {event.mode.name}" + (f": {event.reason}" if event.reason else "")
        return _entry("warning", event.tick, text, 0)
    if isinstance(event, Alarm):
        return _entry("alarm", event.tick, f"{event.code} {event.class_name}: {event.text}", event.line)
    return None


def _entry(kind: str, tick: int, text: str, line: int) -> dict[str, Any]:
    shown = text if len(text) <= TEXT_MAX else text[: TEXT_MAX - 1] + "…"
    return {"kind": kind, "t": seconds(tick), "text": shown, "line": line}


def _close(found: list[list[Any]], move: MotionStarted | None, end_s: float) -> None:
    if move is not None and end_s > seconds(move.tick) and move.duration_s > 0.0:
        found.append([seconds(move.tick), end_s, type(move.request).__name__.lower(), move.line])


def _joined(pair: Sequence[list[Any]]) -> list[Any]:
    first, last = pair[0], pair[-1]
    return [first[0], last[1], first[2] if first[2] == last[2] else "moves", first[3]]


def _value_before(event: SignalChanged) -> Value:
    if isinstance(event.value, bool):
        return not event.value
    return parse_signal_name(event.name)[0].default


def _order(name: str) -> tuple[bool, str, int]:
    signal, index = parse_signal_name(name)
    return signal.is_input, signal.name, index


def _short(value: Value) -> int | float:
    return int(value) if isinstance(value, (bool, int)) else float(f"{value:.6g}")
