"""Turns events into lanes: moves as bars, signals as levels, connections, messages and alarms as marks."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any, Final

from elitescript.messages.events import (
    Alarm,
    DeviceNoted,
    Event,
    MotionEnded,
    MotionStarted,
    Popup,
    Printed,
    SafetyModeChanged,
    TextMessage,
    Warned,
)
from elitescript.messages.timing import seconds
from elitescript.plotting.packing import shown_text
from elitescript.records import NamedTuple

MOVES_MAX: Final = 2000
MARKS_MAX: Final = 800


class TimedMove(NamedTuple):
    """A move that took time."""

    start_s: float
    end_s: float
    kind: str
    """`movej`, `movel` ..."""
    line: int


def moves(events: Sequence[Event], end_s: float) -> list[list[Any]]:
    """Return start, end, kind and line of every move that took time, s; of a long run neighbours become one."""
    found: list[list[Any]] = [list(move) for move in timed_moves(events, end_s)]
    while len(found) > MOVES_MAX:
        found = [_joined(found[index : index + 2]) for index in range(0, len(found), 2)]
    return found


def timed_moves(events: Iterable[Event], end_s: float) -> Iterator[TimedMove]:
    """Yield every move that took time.

    Args:
        events: of a run.
        end_s: end of the run, s: a move that is under way lasts until then.
    """
    under_way: MotionStarted | None = None
    for event in events:
        if isinstance(event, MotionStarted):
            yield from _closed(under_way, seconds(event.tick))
            under_way = event
        elif isinstance(event, MotionEnded):
            yield from _closed(under_way, seconds(event.tick))
            under_way = None
    yield from _closed(under_way, end_s)


def marks(events: Sequence[Event]) -> tuple[list[dict[str, Any]], int]:
    """Return messages, warnings and alarms with time, line, text and hints; and how many were left out.

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
        return _entry("warning", event.tick, f"{event.code} {event.text}".lstrip(), event.line) | _hints(event.hint)
    if isinstance(event, DeviceNoted):
        kind = "warning" if event.is_warning else "device"
        return _entry(kind, event.tick, f"{event.device}: {event.text}", 0)
    if isinstance(event, SafetyModeChanged):
        text = f"safety: {event.mode.name}" + (f": {event.reason}" if event.reason else "")
        return _entry("warning", event.tick, text, 0)
    if isinstance(event, Alarm):
        entry = _entry("alarm", event.tick, f"{event.code} {event.class_name}: {event.text}", event.line)
        if event.thread not in ("", "main"):
            entry["thread"] = shown_text(event.thread)
        return entry | _hints(event.details.get("hint", ""), *event.details.get("hints", ()))
    return None


def _hints(*hints: str) -> dict[str, Any]:
    found = [shown_text(hint) for hint in hints if hint]
    return {"hints": found} if found else {}


def _entry(kind: str, tick: int, text: str, line: int) -> dict[str, Any]:
    return {"kind": kind, "t": seconds(tick), "text": shown_text(text), "line": line}


def _closed(move: MotionStarted | None, end_s: float) -> Iterator[TimedMove]:
    if move is not None and end_s > seconds(move.tick) and move.duration_s > 0.0:
        yield TimedMove(seconds(move.tick), end_s, type(move.request).__name__.lower(), move.line)


def _joined(pair: Sequence[list[Any]]) -> list[Any]:
    first, last = pair[0], pair[-1]
    return [first[0], last[1], first[2] if first[2] == last[2] else "moves", first[3]]
