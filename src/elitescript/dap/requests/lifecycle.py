"""Begin and end of a session: `initialize`, `launch`, `configurationDone`, `restart`, `terminate`, `disconnect`."""

from __future__ import annotations

from typing import Final

from elitescript.dap.adapter import STOPPED_EXIT, Adapter
from elitescript.dap.client import client_settings
from elitescript.dap.handler import BEGUN, LATER, WITH_PROGRAM, Handler, State, WhileRunning
from elitescript.dap.launch import Launch
from elitescript.dap.messages import DOES_NOT_COMPILE, REFUSED, Arguments, Body, RequestError
from elitescript.errors import ElitescriptError, ProgramError

SHOWN_PROBLEMS: Final = 3
"""Findings in the text of an error; all of them are events."""


def initialize(adapter: Adapter, arguments: Arguments) -> Body:
    """Read what the client understands; answer with what the adapter can do."""
    adapter.client = client_settings(arguments)
    adapter.state = State.INITIALIZED
    return adapter.capabilities()


def launch(adapter: Adapter, arguments: Arguments) -> Body:
    """Compile a program. The run begins, and this is answered, with `configurationDone`."""
    _open(adapter, arguments, is_restart=False)
    return LATER


def restart(adapter: Adapter, arguments: Arguments) -> None:
    """Begin again with the program's present text, and with other arguments of `launch` if there are some."""
    given = arguments.inner("arguments")
    assert adapter.launch is not None
    _open(adapter, given if given.data else adapter.launch.arguments, is_restart=True)
    adapter.begin()


def _open(adapter: Adapter, arguments: Arguments, *, is_restart: bool) -> None:
    try:
        opened = Launch(arguments)
        for text in opened.advice:
            adapter.event("output", {"category": "important", "output": f"{text}\n"})
        adapter.open(opened, is_restart=is_restart)
    except ProgramError as error:
        program = arguments.text("program")
        for problem in error.problems:
            adapter.event("output", adapter.finding(program, problem))
        lines = [f"{program}: {problem}" for problem in error.problems[:SHOWN_PROBLEMS]]
        if more := len(error.problems) - len(lines):
            lines.append(f"and {more} more")
        raise RequestError(DOES_NOT_COMPILE, "\n".join(lines), is_shown=True) from None
    except ElitescriptError as error:
        raise RequestError(REFUSED, str(error), is_shown=True) from None


def configuration_done(adapter: Adapter, _: Arguments) -> None:
    """Begin the run."""
    adapter.begin()


def terminate(adapter: Adapter, _: Arguments) -> None:
    """End the program; the session can be looked at no more."""
    adapter.close(STOPPED_EXIT)


def disconnect(adapter: Adapter, arguments: Arguments) -> None:
    """End the session."""
    arguments.flag("terminateDebuggee", True)
    adapter.close(None)


HANDLERS: Final = {
    "initialize": Handler(initialize, frozenset((State.NEW,))),
    "launch": Handler(launch, frozenset((State.INITIALIZED,))),
    "configurationDone": Handler(configuration_done, frozenset((State.CONFIGURING,))),
    "restart": Handler(restart, BEGUN - {State.ENDED}, WhileRunning.INTERRUPT),
    "terminate": Handler(terminate, WITH_PROGRAM, WhileRunning.INTERRUPT),
    "disconnect": Handler(disconnect, frozenset(State), WhileRunning.INTERRUPT),
}
