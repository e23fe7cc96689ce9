"""Looking at a stopped program: threads, calls, variables, alarms."""

from __future__ import annotations

from typing import Final

from elitescript.dap.adapter import Adapter, Handler
from elitescript.dap.client import ClientSettings
from elitescript.dap.messages import REFUSED, Arguments, Body, RequestError
from elitescript.dap.states import BEGUN, STANDING, State, WhileRunning
from elitescript.debugger.api import ALARM_FILTER, END, Frame, Variable
from elitescript.shown import shown

FILTERS: Final = ("", "named", "indexed")


def threads(adapter: Adapter, _: Arguments) -> Body:
    """Return the script threads in the order of their start."""
    return {"threads": [{"id": number, "name": name} for number, name in adapter.known_threads().items()]}


def stack_trace(adapter: Adapter, arguments: Arguments) -> Body:
    """Return the calls of a thread, the innermost one first, or a part of them."""
    start, levels = arguments.number("startFrame", 0), arguments.number("levels", 0)
    thread = arguments.number("threadId")
    frames = () if adapter.stop.reason == END else adapter.session.stack(thread)
    adapter.frames |= {frame.id: frame for frame in frames}
    shown = frames[start : start + levels if levels else None]
    return {"stackFrames": [_frame(adapter, frame) for frame in shown], "totalFrames": len(frames)}


def _frame(adapter: Adapter, frame: Frame) -> Body:
    place = adapter.client.place(frame.line, frame.column, frame.end_line, frame.end_column)
    # Required by the protocol, also of a call without a place.
    name = frame.name
    if frame.source and (node := adapter.debuggee.node(frame.source, frame.line)):
        name = f"{shown(node)}: {name}"
    body: Body = {"id": frame.id, "name": name, "line": 0, "column": 0, **place}
    if frame.source:
        body["source"] = adapter.sources.shown(frame.source)
    return body


def scopes(adapter: Adapter, arguments: Arguments) -> Body:
    """Return the groups of variables of a frame: Locals, Globals, Robot."""
    hints = {"Locals": "locals", "Globals": "globals"}
    found = []
    for scope in adapter.session.scopes(arguments.number("frameId")):
        body: Body = {"name": scope.name, "variablesReference": scope.reference, "expensive": False}
        body["namedVariables"] = scope.count
        if scope.name in hints:
            body["presentationHint"] = hints[scope.name]
        found.append(body)
    return {"scopes": found}


def variables(adapter: Adapter, arguments: Arguments) -> Body:
    """Return what a scope or a value holds, or a part of it."""
    kind = arguments.text("filter", "")
    if kind not in FILTERS:
        arguments.refuse("filter", "'named' or 'indexed'", kind)
    found = adapter.session.variables(
        arguments.number("variablesReference", least=1),
        kind=kind,
        start=arguments.number("start", 0),
        count=arguments.number("count", 0),
    )
    return {"variables": [{"name": one.name, "value": one.value, **about(one, adapter.client)} for one in found]}


def about(variable: Variable, client: ClientSettings) -> Body:
    """Return what responses say of a value besides its text."""
    body: Body = {"variablesReference": variable.reference}
    if variable.reference:
        body |= {"namedVariables": variable.named, "indexedVariables": variable.indexed}
    if client.has_types:
        body["type"] = variable.type
    if variable.evaluate_name:
        body["evaluateName"] = variable.evaluate_name
    if not variable.is_settable:
        body["presentationHint"] = {"attributes": ["readOnly"]}
    return body


def exception_info(adapter: Adapter, arguments: Arguments) -> Body:
    """Return the alarm or the warning at which the program has stopped."""
    arguments.number("threadId")
    found = adapter.stop.exception
    if found is None:
        raise RequestError(REFUSED, "the program has not stopped at an alarm or a warning")
    text = f"{found.text}\nhint: {found.hint}" if found.hint else found.text
    return {
        "exceptionId": found.code or found.name,
        "description": text,
        # An alarm stops the program if it is not caught, a warning wherever it comes up.
        "breakMode": "unhandled" if found.filter == ALARM_FILTER else "always",
        "details": {
            "message": found.text,
            "typeName": found.name,
            "fullTypeName": found.name,
            "stackTrace": f"line {found.line}, thread {found.thread_name}",
        },
    }


HANDLERS: Final = {
    "threads": Handler(threads, BEGUN | {State.CONFIGURING}, WhileRunning.ANSWER),
    "stackTrace": Handler(stack_trace, STANDING | {State.RUNNING}),
    "scopes": Handler(scopes, STANDING | {State.RUNNING}),
    "variables": Handler(variables, STANDING | {State.RUNNING}),
    "exceptionInfo": Handler(exception_info, STANDING | {State.RUNNING}),
}
