"""Expressions: `evaluate`, `setVariable`, `setExpression`, `completions`."""

from __future__ import annotations

from typing import Final

from elitescript.assist import completion as assist
from elitescript.assist.completion import Completion, ItemKind
from elitescript.assist.document import Document
from elitescript.dap.adapter import Adapter, Handler
from elitescript.dap.messages import Arguments, Body
from elitescript.dap.requests.inspection import about
from elitescript.dap.states import STANDING, State
from elitescript.debugger.api import Variable
from elitescript.debugger.looking import ROBOT_VALUES
from elitescript.messages.signals import SIGNALS

COMPLETIONS_MAX: Final = 1000
"""Offers of one answer; a client narrows them down itself while more is typed."""
CONTEXTS_THAT_CHANGE: Final = ("repl",)

_OF_THE_CALL: Final = (ItemKind.ARGUMENT, ItemKind.VALUE)

_TYPES: Final = {
    ItemKind.COMMAND: "function",
    ItemKind.CONSTANT: "variable",
    ItemKind.ARGUMENT: "property",
    ItemKind.NAME: "value",
}
"""Types of the protocol that are not called as ours."""


def evaluate(adapter: Adapter, arguments: Arguments) -> Body:
    """Return the value of an expression. Only what is typed into the console may change anything."""
    may_change = arguments.text("context", "") in CONTEXTS_THAT_CHANGE
    found = adapter.session.evaluate(
        arguments.text("expression"), arguments.number("frameId", 0), may_change=may_change
    )
    if may_change:
        adapter.changed("variables", "stacks", "threads")
    return {"result": found.value, **about(found, adapter.client)}


def set_variable(adapter: Adapter, arguments: Arguments) -> Body:
    """Set a variable; begins a new branch of history."""
    found = adapter.session.set_variable(
        arguments.number("variablesReference", least=1), arguments.text("name"), arguments.text("value")
    )
    return _set(adapter, found)


def set_expression(adapter: Adapter, arguments: Arguments) -> Body:
    """Assign to an expression; begins a new branch of history."""
    found = adapter.session.set_expression(
        arguments.text("expression"), arguments.text("value"), arguments.number("frameId", 0)
    )
    return _set(adapter, found)


def _set(adapter: Adapter, found: Variable) -> Body:
    adapter.changed("variables")
    return {"value": found.value, **about(found, adapter.client)}


def completions(adapter: Adapter, arguments: Arguments) -> Body:
    """Return what continues the text that is typed into the console: as in an editor, and what the program has there.

    Values and arguments of the call around the cursor come first, then variables in sight, then everything else.
    """
    text = arguments.text("text")
    lines = text.splitlines() or [""]
    line = adapter.client.line_from(arguments.number("line")) if arguments.has("line") else 1
    line = min(max(line, 1), len(lines))
    column = min(max(adapter.client.column_from(arguments.number("column")), 1), len(lines[line - 1]) + 1)
    offers = [item for item in assist.completions(Document("<console>", text), line, column) if not item.is_missing]
    found: dict[str, Body] = {}
    for item in offers:
        if item.kind in _OF_THE_CALL:
            _offer(found, item, lines[line - 1], column)
    if any(item.kind is ItemKind.COMMAND for item in offers):
        # A name may stand here.
        span = next(item.span for item in offers if item.kind is ItemKind.COMMAND)
        for name, kind in _names(adapter, arguments.number("frameId", 0)).items():
            _offer(found, Completion(name, kind, span, name), lines[line - 1], column)
    for item in offers:
        if item.kind is not ItemKind.SNIPPET:
            _offer(found, item, lines[line - 1], column)
    targets = list(found.values())[:COMPLETIONS_MAX]
    return {"targets": [{**target, "sortText": f"{at:03}"} for at, target in enumerate(targets)]}


def _names(adapter: Adapter, frame: int) -> dict[str, ItemKind]:
    """Return the names that only the console has: variables in sight, values of the robot, signals."""
    found: dict[str, ItemKind] = {}
    for scope in adapter.session.scopes(frame):
        if scope.name != "Robot":
            names = sorted(one.name for one in adapter.session.variables(scope.reference))
            found |= dict.fromkeys(filter(str.isidentifier, names), ItemKind.VARIABLE)
    return found | dict.fromkeys([*ROBOT_VALUES, *sorted(SIGNALS)], ItemKind.VALUE)


def _offer(found: dict[str, Body], item: Completion, line: str, column: int) -> None:
    """Add an item, if it continues what stands before the cursor and nothing has its name yet."""
    begin = line[item.span.column - 1 : column - 1]
    if item.text.startswith(begin) and item.label not in found:
        body: Body = {"label": item.label, "type": _TYPES.get(item.kind, str(item.kind)), "length": len(begin)}
        if item.text != item.label:
            body["text"] = item.text
        found[item.label] = body


HANDLERS: Final = {
    "evaluate": Handler(evaluate, STANDING | {State.RUNNING}),
    "setVariable": Handler(set_variable, STANDING | {State.RUNNING}),
    "setExpression": Handler(set_expression, STANDING | {State.RUNNING}),
    "completions": Handler(completions, STANDING | {State.RUNNING}),
}
