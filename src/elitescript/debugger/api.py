"""What a debugged run shows and takes: frozen records. No protocol, no object of the run itself.

Lines and columns count from 1, columns in characters, ends are exclusive. Times are seconds of robot time since the
start of the robot; a tick is 4 ms. Threads and breakpoints have positive numbers; 0 stands for none.
"""

from __future__ import annotations

from typing import Final

from elitescript.messages.motion import Six
from elitescript.records import NamedTuple, record

# ---------------------------------------------------------------- where

BEFORE_STATEMENT: Final = "statement"
"""Stopped before a statement; possibly in the middle of a tick."""
IN_STATEMENT: Final = "event"
"""Stopped in a statement that has just raised an alarm or a warning."""
AFTER_TICK: Final = "tick"
"""Stopped behind a tick; no statement runs."""
AT_END: Final = "end"
"""The run is over."""


ALL: Final = 2**53
"""`Position.statement` at the end of a run."""


class Position(NamedTuple):
    """A place in the history of a run.

    Attributes:
        statement: statements of all threads that have begun, with the one that is next at a stop before it; `ALL` at
            the end. A run without breakpoints may not be counted: what it says has the position behind its tick, and 0.
        events: alarms and warnings so far.
        tick: of the robot.
        kind: `BEFORE_STATEMENT`, `IN_STATEMENT`, `AFTER_TICK` or `AT_END`.
    """

    statement: int
    events: int
    tick: int
    kind: str

    def is_before(self, other: Position) -> bool:
        """Return whether the run comes to this position before another one."""
        return self._order < other._order

    @property
    def _order(self) -> tuple[int, int, int, int]:
        return self.statement, self.events, self.tick, _ORDER.index(self.kind)


_ORDER: Final = (BEFORE_STATEMENT, IN_STATEMENT, AFTER_TICK, AT_END)


# ---------------------------------------------------------------- stops

ENTRY: Final = "entry"
STEP: Final = "step"
BREAKPOINT: Final = "breakpoint"
FUNCTION_BREAKPOINT: Final = "function breakpoint"
DATA_BREAKPOINT: Final = "data breakpoint"
EXCEPTION: Final = "exception"
PAUSE: Final = "pause"
GOTO: Final = "goto"
END: Final = "end"
"""The run is over; one can go back from there."""

REASONS: Final = (ENTRY, STEP, BREAKPOINT, FUNCTION_BREAKPOINT, DATA_BREAKPOINT, EXCEPTION, PAUSE, GOTO, END)

ALARM_FILTER: Final = "alarm"
WARNING_FILTER: Final = "warning"
EXCEPTION_FILTERS: Final = (ALARM_FILTER, WARNING_FILTER)


@record
class Change:
    """A change of a variable or a signal.

    Attributes:
        name: as it was asked for.
        old, new: values as text; empty for none.
        position: stop before the first statement that saw the new value, or behind the tick that did.
        cause: stop before the statement that made it; None if no statement did (a device, a schedule, the arm).
        thread: number of the thread that made it; 0 if none did.
        thread_name: its name; else what made it, such as `schedule`.
        line: that made it; 0 if none did.
        tick, time_s: when.
    """

    name: str
    old: str
    new: str
    position: Position
    cause: Position | None
    thread: int
    thread_name: str
    line: int
    tick: int
    time_s: float


@record
class ExceptionInfo:
    """An alarm or a warning at which a run has stopped.

    Attributes:
        filter: `alarm` or `warning`.
        code: such as `R101`; empty for a warning without one.
        name: class of the exception, such as `KinematicsError`.
        text: what happened.
        hint: what helps; may be empty.
        line, column: place.
        thread_name: script thread.
    """

    filter: str
    code: str
    name: str
    text: str
    hint: str
    line: int
    column: int
    thread_name: str


class Unevaluated(NamedTuple):
    """A breakpoint that stops, once until it is set again, since its condition or what it watches cannot be evaluated.

    Attributes:
        breakpoint: its number.
        text: why.
        is_given_up: whether it took too long, and is not evaluated any more.
    """

    breakpoint: int
    text: str
    is_given_up: bool


@record
class Stop:
    """Where a run has stopped, and why.

    Attributes:
        reason: one of `REASONS`.
        text: one sentence for people; for a data breakpoint with old and new value and what made the change.
        thread: number of the thread that stopped; 0 if none did, as behind a tick and at the end.
        position: for `run_to` and comparisons.
        time_s: robot time.
        hits: ids of the breakpoints that are hit here.
        changes: of the data breakpoints that are hit.
        exception: at which it stopped, if it did.
        line: of `thread`; 0 without one.
        result: at the end `finished`, `alarm`, `stopped`, `time_limit` or `stuck`; empty before.
        unevaluated: breakpoints that stop here since they cannot be evaluated.
    """

    reason: str
    text: str
    thread: int
    position: Position
    time_s: float
    hits: tuple[int, ...] = ()
    changes: tuple[Change, ...] = ()
    exception: ExceptionInfo | None = None
    line: int = 0
    result: str = ""
    unevaluated: tuple[Unevaluated, ...] = ()


# ---------------------------------------------------------------- breakpoints


@record
class LineBreakpoint:
    """A request to stop at a line.

    Args:
        line: moved down to the next line that begins a statement.
        column: 0 for the first statement of the line.
        condition: expression without effects; stops only where it is true, and once where it cannot be evaluated.
        hit_condition: `3` (the third time), `>= 3`, `> 3`, `<= 3`, `< 3`, `== 3`, or `% 3` (each third time). Passes
            where the condition cannot be evaluated do not count.
        log_message: text with `{expression}`, written instead of a stop.
    """

    line: int
    column: int = 0
    condition: str = ""
    hit_condition: str = ""
    log_message: str = ""


@record
class FunctionBreakpoint:
    """A request to stop before a function of the program begins, or before a command is called.

    Args:
        name: of a function (`pick`, `outer.inner`) or of a command (`movej`); or what a data breakpoint on an
            expression or a signal takes (`tcp.z < 0.1`).
        condition, hit_condition: as in `LineBreakpoint`; for a function its parameters have their values.
    """

    name: str
    condition: str = ""
    hit_condition: str = ""


@record
class DataBreakpoint:
    """A request to stop when something has changed: behind the statement, or the tick, that changed it.

    Args:
        data_id: `standard_digital_out[3]` (any signal or register), a program global, `robot mode`, `safety`, or an
            expression such as `tcp.z < 0.1`, which stops when it becomes true. In expressions `tcp` is the pose of the
            TCP (`x y z rx ry rz`), `joints` the joint positions, `t` the time, beside signals and program globals.
        condition, hit_condition: as in `LineBreakpoint`.
    """

    data_id: str
    condition: str = ""
    hit_condition: str = ""


@record
class BreakpointState:
    """What became of a breakpoint.

    Attributes:
        id: its number.
        verified: whether it can be hit.
        message: why not.
        line, column, end_line, end_column: where it is now; 0 for none.
    """

    id: int
    verified: bool
    message: str = ""
    line: int = 0
    column: int = 0
    end_line: int = 0
    end_column: int = 0


@record
class DataInfo:
    """What a data breakpoint can be set on.

    Attributes:
        data_id: None if there is nothing of that name that can be watched.
        description: what is watched, or why nothing is.
    """

    data_id: str | None
    description: str


class Place(NamedTuple):
    """A statement in the text."""

    line: int
    column: int
    end_line: int
    end_column: int


# ---------------------------------------------------------------- looking


@record
class ThreadInfo:
    """A script thread.

    Attributes:
        id: its number: its place in the order of start, from 1.
        name: `main`, that of a thread, or `sec NAME`.
        is_secondary: whether it is a secondary program.
        waits_for: reason of its wait, such as `lock pallet, held by main`; empty while it does not wait.
        line: innermost line of program text; 0 before it has begun.
        because: why it does not go on, such as the condition of its loop; empty if that is not known.
    """

    id: int
    name: str
    is_secondary: bool
    waits_for: str
    line: int
    because: str = ""


@record
class Frame:
    """A call on the stack of a thread.

    Attributes:
        id: for `scopes` and `evaluate`; valid until the run goes on.
        thread: number of its thread.
        name: of the function; the innermost one says what its thread waits for.
        source: name of the text, as of the program.
        line, column, end_line, end_column: of the statement.
    """

    id: int
    thread: int
    name: str
    source: str
    line: int
    column: int
    end_line: int
    end_column: int


@record
class Scope:
    """A group of variables of a frame: `Locals`, `Globals`, `Robot`, in this order.

    Attributes:
        name: one of them.
        reference: for `variables`.
        count: number of variables.
    """

    name: str
    reference: int
    count: int


@record
class Variable:
    """A value with a name.

    Attributes:
        name: a variable, `[2]` of a list, a key, `x` of a pose, `base` of joints.
        value: as text, the same in every execution: no addresses.
        type: of the language, such as `list` or `pose`.
        reference: for `variables`, of what it holds; 0 if nothing can be expanded.
        named, indexed: how many children of either kind it has.
        evaluate_name: expression that gives it in its frame; empty if none does.
        data_id: for a data breakpoint; empty if it cannot be watched.
        is_settable: whether `set_variable` takes it.
    """

    name: str
    value: str
    type: str
    reference: int = 0
    named: int = 0
    indexed: int = 0
    evaluate_name: str = ""
    data_id: str = ""
    is_settable: bool = False


@record
class State:
    """The robot at the stopped moment: `elitescript/state`."""

    t: float
    tick: int
    joints: Six
    tcp_pose: Six


@record
class Picture:
    """Everything that a page shows of the stopped moment at once.

    Attributes:
        t, tick: robot time.
        line: innermost line of the main thread; 0 without one.
        joints, tcp_pose: as the row of a trace has them at this tick: behind its motion, as far as it has run.
        globals: names that are declared `global`.
        signals: those that are not at their default, by name.
        threads: script threads in the order of their start.
        functions: innermost function of each thread; empty before it has begun.
    """

    t: float
    tick: int
    line: int
    joints: Six
    tcp_pose: Six
    globals: tuple[Variable, ...]
    signals: tuple[tuple[str, bool | int | float], ...]
    threads: tuple[ThreadInfo, ...]
    functions: tuple[str, ...]


@record
class Output:
    """Something that a run has said. Each is reported once on each branch of history.

    Attributes:
        category: `stdout` (print, textmsg), `console` (log messages, notes of devices), `stderr` (alarms),
            `important` (warnings, popups).
        text: without a line end.
        line: that caused it; 0 for none.
        thread_name: script thread; empty for none.
        position: where in the history.
        time_s: robot time.
        source: name of the text whose line it is; empty if that is not known.
        severity: `warning` or `note` of a finding; empty for anything else.
    """

    category: str
    text: str
    line: int
    thread_name: str
    position: Position
    time_s: float
    source: str = ""
    severity: str = ""
