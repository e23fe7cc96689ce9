"""Requests of our own: the robot at the stopped moment, any moment, and what has changed a name."""

from __future__ import annotations

from typing import Final

from elitescript.dap.adapter import Adapter, Handler
from elitescript.dap.messages import WRONG_ARGUMENTS, Arguments, Body, RequestError
from elitescript.dap.states import STANDING, State
from elitescript.debugger.api import BEFORE_STATEMENT, Change, Position


def state(adapter: Adapter, _: Arguments) -> Body:
    """Return time, tick, joints and TCP pose of the stopped moment."""
    now = adapter.session.state()
    return {"t": now.t, "tick": now.tick, "joints": list(now.joints), "tcp_pose": list(now.tcp_pose)}


def goto(adapter: Adapter, arguments: Arguments) -> None:
    """Go to a moment, back or forth: the end of a tick, a time in s, or before the statement of a number."""
    given = [name for name in ("tick", "t", "statement") if arguments.has(name)]
    if len(given) != 1:
        raise RequestError(WRONG_ARGUMENTS, "elitescript/goto: give one of tick, t and statement")
    if given == ["tick"]:
        tick = arguments.number("tick")
        adapter.travel(lambda session: session.run_to_tick(tick))
    elif given == ["t"]:
        time_s = arguments.real("t")
        if not 0.0 <= time_s <= 1e9:
            arguments.refuse("t", "a time in s, 0 or more", time_s)
        adapter.travel(lambda session: session.run_to_time(time_s))
    else:
        statement = arguments.number("statement", least=1)
        position = Position(statement, 0, 0, BEFORE_STATEMENT)
        adapter.travel(lambda session: session.run_to(position))


def last_pass(adapter: Adapter, arguments: Arguments) -> None:
    """Go back to the last time that a line was about to run."""
    line = adapter.client.line_from(arguments.number("line"))
    text, passed = adapter.debuggee.located(arguments.inner("source"), line) or ("", line)
    adapter.travel(lambda session: session.last_pass(passed, text=text))


def history(adapter: Adapter, arguments: Arguments) -> Body:
    """Return every change of a variable or a signal, with what has made it.

    A local variable is named with its `function`, or with the `frameId` of a call of it.
    """
    name, function = arguments.text("name"), arguments.text("function", "")
    if not function and (frame := arguments.number("frameId", 0)):
        function = adapter.run.function_of(frame, name)
    changes = adapter.run.history(name, function=function)
    return {"changes": [_change(adapter, change) for change in changes]}


def _change(adapter: Adapter, change: Change) -> Body:
    body: Body = {
        "name": change.name,
        "old": change.old,
        "new": change.new,
        "t": change.time_s,
        "tick": change.tick,
        "thread": change.thread_name,
        "statement": change.position.statement,
    }
    if change.line:
        body["source"] = adapter.sources.shown(adapter.debuggee.name)
        body.update(adapter.client.place(change.line, 0))
    if change.cause is not None:
        body["cause"] = _position(change.cause)
    return body


def _position(position: Position) -> Body:
    return {"statement": position.statement, "tick": position.tick}


HANDLERS: Final = {
    "elitescript/state": Handler(state, STANDING | {State.RUNNING}),
    "elitescript/goto": Handler(goto, STANDING | {State.RUNNING}),
    "elitescript/lastPass": Handler(last_pass, STANDING | {State.RUNNING}),
    "elitescript/history": Handler(history, STANDING | {State.RUNNING}),
}
