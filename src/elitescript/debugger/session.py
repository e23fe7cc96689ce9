"""`DebugSession`: a run that stops at counted statements, goes back and forth in its history, and is looked into."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from elitescript.debugger.api import (
    BreakpointState,
    Change,
    DataBreakpoint,
    DataInfo,
    Frame,
    FunctionBreakpoint,
    LineBreakpoint,
    Output,
    Place,
    Position,
    Scope,
    State,
    Stop,
    ThreadInfo,
    Variable,
)
from elitescript.debugger.source import Source
from elitescript.language.diagnostics import Diagnostic


class DebugSession:
    """A debugged run. Calls that let it go on return the next stop; everything else is answered while it stands.

    Nothing here is called from two threads at once, but for `pause`.

    Args:
        source: what is debugged.
        on_output: receives what the run says, once on each branch of its history.
        forks: whether snapshots of the process may be made, which makes going back in long programs fast: only in a
            process of one thread that may be forked, on POSIX.

    Raises:
        ProgramError: the program does not compile.
        ElitescriptError: the robot, the world or an option is wrong.
    """

    def __init__(
        self, source: Source, on_output: Callable[[Output], None] | None = None, *, forks: bool = False
    ) -> None: ...

    # ---------------------------------------------------------------- going on

    def start(self, *, stop_on_entry: bool = False, no_debug: bool = False) -> Stop:
        """Begin the run; return its first stop: `entry`, before the first statement, or what `resume` returns.

        Args:
            stop_on_entry: stop before the first statement.
            no_debug: run to the end; breakpoints and filters are not heeded.
        """

    def resume(self) -> Stop:
        """Go on to the next breakpoint, exception of a filter, pause, or the end."""

    def next(self, thread: int) -> Stop:
        """Go on until a thread is at its next statement of the same call or of a caller; other threads run, too.

        Over a `movej` that is when it returns. Breakpoints and filters stop earlier.
        """

    def step_in(self, thread: int) -> Stop:
        """Go on to the next statement of a thread, also in a function that it calls."""

    def step_out(self, thread: int) -> Stop:
        """Go on until a thread has left its present function."""

    def step_back(self, thread: int) -> Stop:
        """Go back to the previous statement of a thread, over calls; at its first one to that of its caller.

        Before the first statement of a thread there is the statement that started it, and the start of the run
        (reason `entry`).
        """

    def reverse(self) -> Stop:
        """Go back to the last hit of a breakpoint or filter before the present stop; to the start if there is none."""

    def run_to(self, position: Position) -> Stop:
        """Go to a position, back or forth, without heed of breakpoints."""

    def run_to_tick(self, tick: int) -> Stop:
        """Go to the moment behind a tick, back or forth, without heed of breakpoints."""

    def run_to_time(self, time_s: float) -> Stop:
        """Go to a time in seconds; see `run_to_tick`."""

    def last_pass(self, line: int) -> Stop:
        """Go back to the last time that a line was about to run.

        Raises:
            DebugError: it has not run before.
        """

    def restart(self, *, stop_on_entry: bool = False) -> Stop:
        """Begin again, without the changes that the user has made."""

    def pause(self) -> None:
        """Let the run that goes on stop at its next statement or tick. Called from any thread or signal handler."""

    def close(self) -> None:
        """Drop the run."""

    # ---------------------------------------------------------------- breakpoints

    def set_breakpoints(self, requests: Sequence[LineBreakpoint]) -> tuple[BreakpointState, ...]:
        """Replace the breakpoints of lines."""

    def set_function_breakpoints(self, requests: Sequence[FunctionBreakpoint]) -> tuple[BreakpointState, ...]:
        """Replace the breakpoints of functions and commands."""

    def set_data_breakpoints(self, requests: Sequence[DataBreakpoint]) -> tuple[BreakpointState, ...]:
        """Replace the data breakpoints."""

    def set_exception_filters(self, filters: Sequence[str]) -> None:
        """Replace the filters: `alarm`, `warning`. At first there is `alarm`.

        Raises:
            DebugError: no such filter.
        """

    def breakpoint_locations(self, line: int, end_line: int = 0) -> tuple[Place, ...]:
        """Return the statements that begin in lines, the last one included."""

    def data_breakpoint_info(self, name: str, reference: int = 0, frame: int = 0) -> DataInfo:
        """Return what a data breakpoint can watch.

        Args:
            name: a name, or an expression.
            reference: of the scope or value of which `name` is a child; 0 for an expression.
            frame: in which it was shown.
        """

    # ---------------------------------------------------------------- looking

    @property
    def stop(self) -> Stop:
        """The present stop."""

    @property
    def problems(self) -> tuple[Diagnostic, ...]:
        """What was found in the program before it began."""

    @property
    def furthest(self) -> Position:
        """The furthest position of this branch of history that was reached."""

    def threads(self) -> tuple[ThreadInfo, ...]:
        """Return the script threads in the order of their start."""

    def stack(self, thread: int) -> tuple[Frame, ...]:
        """Return the calls of a thread, the innermost one first; empty before it has begun.

        Raises:
            DebugError: no such thread.
        """

    def scopes(self, frame: int) -> tuple[Scope, ...]:
        """Return the scopes of a frame: `Locals`, `Globals`, `Robot`. With frame 0 without `Locals`."""

    def variables(self, reference: int, *, kind: str = "", start: int = 0, count: int = 0) -> tuple[Variable, ...]:
        """Return what a scope or a value holds.

        Args:
            reference: of the scope or value.
            kind: `named` or `indexed`; both if empty.
            start: index of the first one.
            count: how many; all if 0.
        """

    def evaluate(self, text: str, frame: int = 0, *, may_change: bool = False) -> Variable:
        """Return the value of an expression.

        Args:
            text: an expression; with `may_change` also statements.
            frame: whose variables it sees; 0 for program globals alone.
            may_change: let it change the program and the robot; a change begins a new branch of history.

        Raises:
            DebugError: it has no value, or would change something.
        """

    def set_variable(self, reference: int, name: str, text: str) -> Variable:
        """Set a child of a scope or of a value to the value of an expression; begins a new branch of history."""

    def set_expression(self, target: str, text: str, frame: int = 0) -> Variable:
        """Assign the value of an expression to a variable, an item or a signal; begins a new branch of history."""

    def set_signal(self, name: str, text: str) -> Variable:
        """Set an input, output or register of the robot; begins a new branch of history."""

    def state(self) -> State:
        """Return the robot at this moment."""

    # ---------------------------------------------------------------- history

    def history(self, name: str, *, function: str = "") -> tuple[Change, ...]:
        """Return every change of a variable or signal up to the furthest position of this branch.

        Args:
            name: a signal, a program global, or a variable of `function`.
            function: as `Frame.name`; empty for a global, a signal, or a variable of the program's body.
        """

    def passes(self, line: int) -> tuple[Position, ...]:
        """Return every moment at which a line was about to run, up to the furthest position of this branch."""

    def who_changed(self, name: str, *, function: str = "") -> Change | None:
        """Return the last change of a variable or signal before the present stop; `run_to(change.cause)` goes there."""
