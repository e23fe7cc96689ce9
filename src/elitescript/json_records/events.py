"""Records of events for `--json`: one table for `run`, `serve` and `replay`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from elitescript.messages import events
from elitescript.messages.events import Event
from elitescript.messages.timing import seconds
from elitescript.said import parts_of

Record = dict[str, Any]


def record_of(event: Event) -> Record | None:
    """Return the record of an event; None if `--json` does not have it."""
    make = RECORDS[type(event)]
    return None if make is None else make(event)


def _fields(kind: str, *names: str) -> Callable[[Event], Record]:
    """Return a maker of records with these fields of an event."""

    def record(event: Event) -> Record:
        return {"type": kind, "t": seconds(event.tick)} | {name: getattr(event, name) for name in names}

    return record


def _popup(event: events.Popup) -> Record:
    return {
        "type": "popup",
        "t": seconds(event.tick),
        "level": event.level,
        "title": event.title,
        "text": event.text,
        "blocking": event.is_blocking,
        "confirmed": event.is_confirmed_at_once,
        "thread": event.thread,
        "line": event.line,
    }


def _warning(event: events.Warned) -> Record:
    given = (name for name in ("code", "hint", "column") if getattr(event, name))
    kind = "note" if event.severity == "note" else "warning"
    record = _fields(kind, "text", "thread", "line", *given, "source")(event)
    if event.code:
        record["severity"] = event.severity
    return record | _parts(event.text, event.hint)


def _device(event: events.DeviceNoted) -> Record:
    level = "warning" if event.is_warning else "info"
    record = {"type": "device", "t": seconds(event.tick), "level": level, "device": event.device, "text": event.text}
    return record | _parts(event.text)


def _alarm(event: events.Alarm) -> Record:
    return {
        "type": "alarm",
        "t": seconds(event.tick),
        "code": event.code,
        "class": event.class_name,
        "text": event.text,
        "line": event.line,
        "column": event.column,
        "thread": event.thread,
        **event.details,
        **_parts(event.text, event.details.get("hint", "")),
    }


def _safety(event: events.SafetyModeChanged) -> Record:
    record = {"type": "safety", "t": seconds(event.tick), "mode": event.mode.name, "text": event.reason}
    return record | _parts(event.reason)


def _parts(text: str, hint: str = "") -> Record:
    """Return template and values of a text, and of a hint if there is one."""
    return parts_of(text) | (parts_of(hint, "hint_") if hint else {})


RECORDS: Final[dict[type, Callable[[Any], Record] | None]] = {
    events.TextMessage: _fields("log", "level", "text", "thread", "line"),
    events.Printed: _fields("print", "text", "thread", "line"),
    events.Popup: _popup,
    events.Warned: _warning,
    events.DeviceNoted: _device,
    events.Alarm: _alarm,
    events.SafetyModeChanged: _safety,
    events.SignalChanged: _fields("signal", "name", "value", "by", "line"),
    events.ChannelActivity: _fields("channel", "channel", "kind", "what", "data", "line", "thread"),
    events.MotionStarted: None,
    events.MotionEnded: None,
    events.TrackingStarted: None,
    events.TrackingEnded: None,
    events.TaskStateChanged: None,
    events.TaskLoaded: None,
    events.RobotModeChanged: None,
    events.LineMarked: None,
    events.YieldingChanged: None,
}
"""Maker of the record of every kind of event; None for those that only `run.events` has."""
