"""Going on and going back: steps, `continue`, `pause`, and moments to go to."""

from __future__ import annotations

import ast
from typing import Final

from elitescript.dap.adapter import Adapter, Handler
from elitescript.dap.goals import Goal
from elitescript.dap.messages import REFUSED, Arguments, Body, RequestError
from elitescript.dap.states import BEGUN, STANDING, State, WhileRunning
from elitescript.debugger.api import Position
from elitescript.debugger.session import DebugSession
from elitescript.language.parser import parse
from elitescript.language.text.source import SourceFile
from elitescript.messages.timing import seconds

GOTO_MAX: Final = 20
"""Moments of one line that are offered, the latest ones."""

GRANULARITIES: Final = ("statement", "line", "instruction")


def continue_(adapter: Adapter, arguments: Arguments) -> Body:
    """Go on to the next stop."""
    _thread(adapter, arguments)
    adapter.go(Goal.resume())
    return {"allThreadsContinued": True}


def next_(adapter: Adapter, arguments: Arguments) -> None:
    """Go on to the next statement of the same call."""
    _step(adapter, arguments, "next")


def step_in(adapter: Adapter, arguments: Arguments) -> None:
    """Go on to the next statement, also in a function that is called; in that of `targetId` alone, if it is given."""
    if not arguments.has("targetId"):
        _step(adapter, arguments, "step_in")
        return
    name = adapter.references.get(arguments.number("targetId"))
    if not isinstance(name, str):
        arguments.refuse("targetId", "one of the last `stepInTargets`", arguments.data["targetId"])
    thread = _thread(adapter, arguments)
    adapter.travel(lambda session: adapter.breakpoints.step_into(session, thread, name), thread)


def step_out(adapter: Adapter, arguments: Arguments) -> None:
    """Go on until the present function has been left."""
    _step(adapter, arguments, "step_out")


def step_back(adapter: Adapter, arguments: Arguments) -> None:
    """Go back to the previous statement of the thread, over calls."""
    _granularity(arguments)
    thread = _thread(adapter, arguments)
    adapter.travel(lambda session: session.step_back(thread), thread)


def reverse_continue(adapter: Adapter, arguments: Arguments) -> None:
    """Go back to the last hit of a breakpoint, else to the start."""
    adapter.travel(DebugSession.reverse, _thread(adapter, arguments))


def pause(adapter: Adapter, arguments: Arguments) -> None:
    """Stop at the next statement or tick."""
    arguments.number("threadId", 0)
    if adapter.state is State.RUNNING:
        adapter.pause()


def step_in_targets(adapter: Adapter, arguments: Arguments) -> Body:
    """Return the functions of the program that the statement of a frame calls."""
    frame = adapter.frames.get(arguments.number("frameId"))
    if frame is None:
        arguments.refuse("frameId", "that of a call of the stopped program", arguments.data["frameId"])
    calls = _calls(adapter.debuggee.text_of(frame.source), frame.line, frame.end_line)
    return {"targets": [{"id": adapter.refer_to(name), "label": f"{name}()"} for name in calls]}


def goto_targets(adapter: Adapter, arguments: Arguments) -> Body:
    """Return earlier and later moments at which a line was about to run: going there is going in history."""
    line = adapter.client.line_from(arguments.number("line"))
    found = adapter.debuggee.located(arguments.inner("source"), line)
    if found is None:
        return {"targets": []}
    text, passed = found
    now = adapter.stop.position
    passes = [position for position in adapter.run.passes(passed, text=text) if position != now]
    near = sorted(passes, key=lambda position: abs(position.statement - now.statement))[:GOTO_MAX]
    targets = []
    for position in sorted(near):
        way = "back" if position < now else "forward"
        label = f"{way} to {seconds(position.tick):.3f} s, statement {position.statement}"
        place = adapter.client.place(line, 0)
        targets.append({"id": adapter.refer_to(position), "label": label, **place})
    return {"targets": targets}


def goto(adapter: Adapter, arguments: Arguments) -> None:
    """Go to a moment that `gotoTargets` has offered."""
    thread = _thread(adapter, arguments)
    position = adapter.references.get(arguments.number("targetId"))
    if not isinstance(position, Position):
        arguments.refuse("targetId", "one of the last `gotoTargets`", arguments.data["targetId"])
    adapter.travel(lambda session: session.run_to(position), thread)


def _step(adapter: Adapter, arguments: Arguments, how: str) -> None:
    _granularity(arguments)
    adapter.go(Goal.step(how, adapter.session, _thread(adapter, arguments)))


def _granularity(arguments: Arguments) -> None:
    if (given := arguments.text("granularity", "statement")) not in GRANULARITIES:
        arguments.refuse("granularity", " or ".join(GRANULARITIES), given)


def _thread(adapter: Adapter, arguments: Arguments) -> int:
    number = arguments.number("threadId")
    if number not in adapter.known_threads():
        raise RequestError(REFUSED, f"there is no thread {number}")
    return number


def _calls(text: str, line: int, end_line: int) -> list[str]:
    """Return the names of the program's own functions that are called in some lines, in the order of the text."""
    tree = parse(SourceFile("<program>", text)).tree
    own = {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
    found = [
        (node.lineno, node.col_offset, node.func.id)
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and line <= node.lineno <= (end_line or line)
    ]
    return list(dict.fromkeys(name for _, _, name in sorted(found) if name in own))


HANDLERS: Final = {
    "continue": Handler(continue_, STANDING | {State.RUNNING}),
    "next": Handler(next_, STANDING | {State.RUNNING}),
    "stepIn": Handler(step_in, STANDING | {State.RUNNING}),
    "stepOut": Handler(step_out, STANDING | {State.RUNNING}),
    "stepBack": Handler(step_back, STANDING | {State.RUNNING}),
    "reverseContinue": Handler(reverse_continue, STANDING | {State.RUNNING}),
    "pause": Handler(pause, BEGUN, WhileRunning.ANSWER),
    "stepInTargets": Handler(step_in_targets, STANDING | {State.RUNNING}),
    "gotoTargets": Handler(goto_targets, STANDING | {State.RUNNING}),
    "goto": Handler(goto, STANDING | {State.RUNNING}),
}
