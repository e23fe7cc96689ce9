"""Begin and end of a session: `initialize`, `launch`, `configurationDone`, `restart`, `terminate`, `disconnect`."""

from __future__ import annotations

from typing import Final

from elitescript.dap.adapter import LATER, STOPPED_EXIT, Adapter, Handler
from elitescript.dap.capabilities import CAPABILITIES
from elitescript.dap.client import client_settings
from elitescript.dap.goals import Goal
from elitescript.dap.launch import Launched
from elitescript.dap.messages import DOES_NOT_COMPILE, REFUSED, Arguments, Body, RequestError
from elitescript.dap.states import BEGUN, WITH_PROGRAM, State, WhileRunning
from elitescript.errors import ElitescriptError, ProgramError
from elitescript.language.diagnostics import Diagnostic
from elitescript.shown import shown

SHOWN_PROBLEMS: Final = 3
"""Findings in the text of an error; all of them are events."""


def initialize(adapter: Adapter, arguments: Arguments) -> Body:
    """Read what the client understands; answer with what the adapter can do."""
    adapter.client = client_settings(arguments)
    adapter.state = State.INITIALIZED
    return CAPABILITIES


def launch(adapter: Adapter, arguments: Arguments) -> Body:
    """Compile a program. The run begins, and this is answered, with `configurationDone`."""
    adapter.open(_launched(adapter, arguments))
    return LATER


def attach(adapter: Adapter, arguments: Arguments) -> Body:
    """Debug what runs on a robot that is served; answered with `configurationDone`."""
    # Few sessions attach, and what speaks to a served robot takes time to import.
    from elitescript.dap.attach import NOT_POSSIBLE, Attached

    adapter.open(Attached(arguments, adapter.sources, adapter.heard_output, adapter.heard))
    adapter.event("capabilities", {"capabilities": dict.fromkeys(NOT_POSSIBLE, False)})
    return LATER


def restart(adapter: Adapter, arguments: Arguments) -> None:
    """Begin again with the program's present text, and with other arguments of `launch` if there are some."""
    given, present = arguments.inner("arguments"), adapter.debuggee
    if not isinstance(present, Launched):
        raise RequestError(REFUSED, "a robot that lives cannot begin again")
    launched = _launched(adapter, given if given.data else present.arguments)
    adapter.open(launched, is_restart=True)
    adapter.begin(_start(launched))


def _launched(adapter: Adapter, arguments: Arguments) -> Launched:
    try:
        launched = Launched(arguments, adapter.sources, adapter.report_output, forks=adapter.forks)
    except ProgramError as error:
        program = arguments.text("program")
        adapter.sources.found(program, program)
        for problem in error.problems:
            adapter.event("output", _finding(adapter, program, problem))
        lines = [shown(f"{program}: {problem}") for problem in error.problems[:SHOWN_PROBLEMS]]
        if more := len(error.problems) - len(lines):
            lines.append(f"and {more} more")
        raise RequestError(DOES_NOT_COMPILE, "\n".join(lines), is_shown=True) from None
    except ElitescriptError as error:
        raise RequestError(REFUSED, str(error), is_shown=True) from None
    for text in launched.advice:
        adapter.note(text, "important")
    for problem in launched.problems:
        node = launched.node(launched.name, problem.line)
        adapter.event("output", _finding(adapter, launched.name, problem, f"{node}: " if node else ""))
    return launched


def _finding(adapter: Adapter, program: str, problem: Diagnostic, node: str = "") -> Body:
    """Return a finding of `check` as an `output` event from which the editor can jump to its place."""
    hint = f"\n    hint: {shown(problem.hint)}" if problem.hint else ""
    return {
        "category": "stderr" if problem.is_error else "console",
        "output": f"{shown(node)}{shown(str(problem))}{hint}\n",
        "source": adapter.sources.shown(program),
        **adapter.client.place(problem.line, problem.column),
    }


def configuration_done(adapter: Adapter, _: Arguments) -> None:
    """Begin the run, or debug what runs."""
    debuggee = adapter.debuggee
    if isinstance(debuggee, Launched):
        adapter.begin(_start(debuggee))
    else:
        adapter.begin(Goal.wait(stop_on_entry=debuggee.stop_on_entry))


def _start(launched: Launched) -> Goal:
    return Goal.start(stop_on_entry=launched.stop_on_entry, no_debug=launched.no_debug)


def terminate(adapter: Adapter, _: Arguments) -> None:
    """End the program; the session can be looked at no more."""
    adapter.close(STOPPED_EXIT, terminates=True)


def disconnect(adapter: Adapter, arguments: Arguments) -> None:
    """End the session; a robot that lives goes on unless the client wants otherwise."""
    adapter.close(
        None,
        terminates=arguments.flag("terminateDebuggee"),
        leaves_paused=arguments.flag("suspendDebuggee"),
    )


HANDLERS: Final = {
    "initialize": Handler(initialize, frozenset((State.NEW,))),
    "launch": Handler(launch, frozenset((State.INITIALIZED,))),
    "attach": Handler(attach, frozenset((State.INITIALIZED,))),
    "configurationDone": Handler(configuration_done, frozenset((State.CONFIGURING,))),
    "restart": Handler(restart, BEGUN - {State.ENDED}, WhileRunning.INTERRUPT),
    "terminate": Handler(terminate, WITH_PROGRAM, WhileRunning.INTERRUPT),
    "disconnect": Handler(disconnect, frozenset(State), WhileRunning.INTERRUPT),
}
