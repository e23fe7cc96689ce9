"""Expressions: `evaluate`, `setVariable`, `setExpression`, `completions`."""

from __future__ import annotations

import re
from typing import Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.dap.adapter import Adapter, Handler
from elitescript.dap.messages import Arguments, Body
from elitescript.dap.requests.inspection import about
from elitescript.dap.states import STANDING, State
from elitescript.debugger.api import Variable
from elitescript.messages.signals import SIGNALS

COMPLETIONS_MAX: Final = 200
CONTEXTS_THAT_CHANGE: Final = ("repl",)

_WORD: Final = re.compile(r"[^\W\d]\w*\Z")


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
    """Return names that continue what is typed into the console: variables in sight, commands, signals."""
    lines = arguments.text("text").splitlines() or [""]
    line = adapter.client.line_from(arguments.number("line")) if arguments.has("line") else 1
    column = adapter.client.column_from(arguments.number("column"))
    typed = lines[min(max(line, 1), len(lines)) - 1][: max(column - 1, 0)]
    word = _WORD.search(typed)
    begin = word.group() if word else ""
    kinds = dict.fromkeys(CATALOGUE.names(), "function") | dict.fromkeys(SIGNALS, "value")
    for scope in adapter.session.scopes(arguments.number("frameId", 0)):
        if scope.name != "Robot":
            kinds |= {one.name: "variable" for one in adapter.session.variables(scope.reference)}
    names = sorted(name for name in kinds if name.startswith(begin) and name.isidentifier())[:COMPLETIONS_MAX]
    return {"targets": [{"label": name, "type": kinds[name], "length": len(begin)} for name in names]}


HANDLERS: Final = {
    "evaluate": Handler(evaluate, STANDING | {State.RUNNING}),
    "setVariable": Handler(set_variable, STANDING | {State.RUNNING}),
    "setExpression": Handler(set_expression, STANDING | {State.RUNNING}),
    "completions": Handler(completions, STANDING | {State.RUNNING}),
}
