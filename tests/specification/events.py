"""Translates events into the words of an `expect` block."""

from __future__ import annotations

from elitescript.messages.enums import TaskState
from elitescript.messages.events import (
    Alarm,
    Event,
    LineMarked,
    MotionStarted,
    Printed,
    TaskStateChanged,
    TextMessage,
    Warned,
)
from elitescript.messages.timing import seconds
from tests.specification.pages import CaseOutcome


def note_event(outcome: CaseOutcome, event: Event) -> None:
    """Add an event to the outcome of a case."""
    if isinstance(event, TextMessage) and event.level != "warning":
        outcome.lists["out"].append(event.text)
    elif isinstance(event, Printed):
        outcome.lists["print"].append(event.text.removesuffix("\n"))
    elif isinstance(event, TextMessage | Warned):
        outcome.log_warnings.append(event.text)
    elif isinstance(event, Alarm):
        if event.code != "R130":
            outcome.lists["alarm"].append(f"{event.code} {event.class_name} line {event.line}")
    elif isinstance(event, LineMarked):
        outcome.node = f"{event.number} {event.label}"
    elif isinstance(event, MotionStarted):
        outcome.moves += 1
    elif isinstance(event, TaskStateChanged) and event.state is TaskState.STOPPED:
        outcome.time_s = seconds(event.tick)
