"""What a debugged run tells: events as outputs, alarms as exceptions, log messages with their values."""

from __future__ import annotations

import sys
from collections.abc import Callable

from elitescript.debugger.api import ALARM_FILTER, WARNING_FILTER, ExceptionInfo, Output, Position
from elitescript.debugger.looking import CallFrame, Look
from elitescript.debugger.values import shown
from elitescript.errors import DebugError
from elitescript.messages.events import Alarm, DeviceNoted, Event, Popup, Printed, TextMessage, Warned
from elitescript.runtime.threads.strand import Strand


def output_of(event: Event, position: Position, time_s: float) -> Output | None:
    """Return what an event says to people; None for one that says nothing."""
    if isinstance(event, TextMessage | Printed):
        return Output("stdout", event.text.removesuffix("\n"), event.line, event.thread, position, time_s)
    if isinstance(event, Popup):
        title = f"{event.title}: " if event.title else ""
        return Output("important", f"{title}{event.text}", event.line, event.thread, position, time_s)
    if isinstance(event, Warned):
        code = f"{event.code} " if event.code else ""
        text = f"{code}{event.text}"
        return Output("important", text, event.line, event.thread, position, time_s, severity=event.severity)
    if isinstance(event, Alarm):
        text = f"{event.code} {event.class_name}: {event.text}"
        return Output("stderr", text, event.line, event.thread, position, time_s)
    if isinstance(event, DeviceNoted):
        return Output("console", f"{event.device}: {event.text}", 0, "", position, time_s)
    return None


def running_text(strand: Strand | None) -> str:
    """Return the name of the text that a thread runs, or in which it has just failed; empty for none."""
    if strand is None:
        return ""
    frame, error = strand.script_frame(), sys.exception()
    trace = None if error is None or frame is not None else error.__traceback__
    while trace is not None:
        if strand.is_script_frame(trace.tb_frame):
            frame = trace.tb_frame
        trace = trace.tb_next
    return "" if frame is None else frame.f_code.co_filename


def exception_of(event: Alarm | Warned) -> ExceptionInfo:
    """Return an alarm or a warning as what a run stops at."""
    if isinstance(event, Alarm):
        kind, name, hint = ALARM_FILTER, event.class_name, str(event.details.get("hint", ""))
    else:
        kind, name, hint = WARNING_FILTER, "", event.hint
    return ExceptionInfo(kind, event.code, name, event.text, hint, event.line, event.column, event.thread)


def filled(message: str, value: Callable[[str], str]) -> str:
    """Return a log message with the values of its `{expressions}`; `{{` is a bracket."""
    parts, at = [], 0
    while at < len(message):
        sign = message[at]
        if message[at : at + 2] in ("{{", "}}"):
            parts.append(sign)
            at += 2
        elif sign == "{" and (end := message.find("}", at)) > 0:
            parts.append(value(message[at + 1 : end]))
            at = end + 1
        else:
            parts.append(sign)
            at += 1
    return "".join(parts)


def logged(look: Look, expression: str, call: CallFrame | None) -> str:
    """Return the value of an expression in a log message; why it has none, in angle brackets."""
    try:
        value = look.value(expression, call)
    except DebugError as error:
        return f"<{error}>"
    return value if type(value) is str else shown(value)
