"""Events as records of `--json`: one table for `run`, `serve` and `replay`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from elitescript.messages import events
from elitescript.messages.events import Event
from elitescript.messages.timing import seconds

Record = dict[str, Any]


def record_of(event: Event) -> Record | None:
    """Return the record of an event; None if `--json` does not have it."""
    make = RECORDS[type(event)]
    return None if make is None else make(event)


def _log(event: events.TextMessage) -> Record:
    return {
        "type": "log",
        "t": seconds(event.tick),
        "level": event.level,
        "text": event.text,
        "thread": event.thread,
        "line": event.line,
    }


def _print(event: events.Printed) -> Record:
    return {"type": "print", "t": seconds(event.tick), "text": event.text, "thread": event.thread, "line": event.line}


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
    record = {
        "type": "warning",
        "t": seconds(event.tick),
        "text": event.text,
        "thread": event.thread,
        "line": event.line,
    }
    record |= {name: value for name in ("code", "hint", "column") if (value := getattr(event, name))}
    return record | {"severity": event.severity} if event.code else record


def _device(event: events.DeviceNoted) -> Record:
    level = "warning" if event.is_warning else "info"
    return {"type": "device", "t": seconds(event.tick), "level": level, "device": event.device, "text": event.text}


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
    }


def _safety(event: events.SafetyModeChanged) -> Record:
    return {"type": "safety", "t": seconds(event.tick), "mode": event.mode.name, "text": event.reason}


def _signal(event: events.SignalChanged) -> Record:
    return {
        "type": "signal",
        "t": seconds(event.tick),
        "name": event.name,
        "value": event.value,
        "by": event.by,
        "line": event.line,
    }


def _channel(event: events.ChannelActivity) -> Record:
    return {
        "type": "channel",
        "t": seconds(event.tick),
        "channel": event.channel,
        "kind": event.kind,
        "what": event.what,
        "data": event.data,
        "line": event.line,
        "thread": event.thread,
    }


RECORDS: Final[dict[type, Callable[[Any], Record] | None]] = {
    events.TextMessage: _log,
    events.Printed: _print,
    events.Popup: _popup,
    events.Warned: _warning,
    events.DeviceNoted: _device,
    events.Alarm: _alarm,
    events.SafetyModeChanged: _safety,
    events.SignalChanged: _signal,
    events.ChannelActivity: _channel,
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
"""What makes the record of every kind of event; None for those that only `run.events` has."""
