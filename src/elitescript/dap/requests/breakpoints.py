"""Breakpoints of lines, functions, data and exceptions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final

from elitescript.dap.adapter import Adapter, Handler
from elitescript.dap.breakpoints import DATA, FUNCTIONS, LINES, Apply
from elitescript.dap.messages import WRONG_ARGUMENTS, Arguments, Body, RequestError
from elitescript.dap.states import WITH_PROGRAM, State, WhileRunning
from elitescript.debugger.api import EXCEPTION_FILTERS, DataBreakpoint, FunctionBreakpoint, LineBreakpoint
from elitescript.errors import did_you_mean

OTHER_TEXT: Final = "this file is not the program that is debugged"


def set_breakpoints(adapter: Adapter, arguments: Arguments) -> Body:
    """Replace the breakpoints of one text; only the program's can be hit."""
    source, items = arguments.inner("source"), arguments.items("breakpoints")
    lines = arguments.data.get("lines")
    if not items and isinstance(lines, list):
        # The older form.
        items = [Arguments({"line": line}, f"setBreakpoints: lines[{at}]") for at, line in enumerate(lines)]
    client = adapter.client
    requests = [
        LineBreakpoint(
            client.line_from(item.number("line")),
            client.column_from(item.number("column")) if item.has("column") else 0,
            item.text("condition", ""),
            item.text("hitCondition", ""),
            item.text("logMessage", ""),
        )
        for item in items
    ]
    key = f"{LINES}{source.text('path', '')}#{source.number('sourceReference', 0)}"
    bodies = adapter.breakpoints.set(
        adapter.debuggee, client, key, requests, lambda debuggee, requests: debuggee.set_lines(source, requests)
    )
    if bodies is None:
        return {"breakpoints": [{"verified": False, "message": OTHER_TEXT, "reason": "failed"} for _ in requests]}
    return {"breakpoints": [{**body, "source": source.data} for body in bodies]}


def breakpoint_locations(adapter: Adapter, arguments: Arguments) -> Body:
    """Return the statements that begin in some lines."""
    source, client = arguments.inner("source"), adapter.client
    line = client.line_from(arguments.number("line"))
    end_line = client.line_from(arguments.number("endLine")) if arguments.has("endLine") else line
    places = adapter.debuggee.places(source, line, end_line)
    return {"breakpoints": [client.place(*place) for place in places]}


def set_function_breakpoints(adapter: Adapter, arguments: Arguments) -> Body:
    """Replace the breakpoints of functions and commands."""
    requests = [
        FunctionBreakpoint(item.text("name"), item.text("condition", ""), item.text("hitCondition", ""))
        for item in arguments.items("breakpoints")
    ]
    return _set(adapter, FUNCTIONS, requests, lambda it, requests: it.session.set_function_breakpoints(requests))


def data_breakpoint_info(adapter: Adapter, arguments: Arguments) -> Body:
    """Say under which id something can be watched."""
    info = adapter.session.data_breakpoint_info(
        arguments.text("name"), arguments.number("variablesReference", 0), arguments.number("frameId", 0)
    )
    body: Body = {"dataId": info.data_id, "description": info.description}
    if info.data_id is not None:
        # The id is a name, which means the same in the next session.
        body |= {"accessTypes": ["write"], "canPersist": True}
    return body


def set_data_breakpoints(adapter: Adapter, arguments: Arguments) -> Body:
    """Replace the data breakpoints."""
    requests = []
    for item in arguments.items("breakpoints"):
        if (access := item.text("accessType", "write")) != "write":
            item.refuse("accessType", "'write': reading changes nothing", access)
        requests.append(DataBreakpoint(item.text("dataId"), item.text("condition", ""), item.text("hitCondition", "")))
    return _set(adapter, DATA, requests, lambda it, requests: it.session.set_data_breakpoints(requests))


def _set(adapter: Adapter, key: str, requests: Sequence[Any], apply: Apply) -> Body:
    return {"breakpoints": adapter.breakpoints.set(adapter.debuggee, adapter.client, key, requests, apply)}


def set_exception_breakpoints(adapter: Adapter, arguments: Arguments) -> Body:
    """Replace the filters of exceptions."""
    options = arguments.items("filterOptions")
    for item in options:
        if item.text("condition", "").strip():
            item.refuse("condition", "left out: a filter has none", item.data["condition"])
    filters = [*arguments.texts("filters"), *(item.text("filterId") for item in options)]
    for name in filters:
        if name not in EXCEPTION_FILTERS:
            near = did_you_mean(name, EXCEPTION_FILTERS)
            raise RequestError(WRONG_ARGUMENTS, f"setExceptionBreakpoints: there is no filter {name!r}{near}")
    adapter.session.set_exception_filters(filters)
    adapter.breakpoints.filters = filters
    return {"breakpoints": [{"verified": True} for _ in filters]}


def _kept(answer: Callable[[Adapter, Arguments], Body]) -> Handler:
    return Handler(answer, WITH_PROGRAM, WhileRunning.INTERRUPT)


HANDLERS: Final = {
    "setBreakpoints": _kept(set_breakpoints),
    "breakpointLocations": _kept(breakpoint_locations),
    "setFunctionBreakpoints": _kept(set_function_breakpoints),
    "dataBreakpointInfo": Handler(
        data_breakpoint_info, frozenset((State.CONFIGURING, State.STOPPED)), WhileRunning.REFUSE
    ),
    "setDataBreakpoints": _kept(set_data_breakpoints),
    "setExceptionBreakpoints": _kept(set_exception_breakpoints),
}
