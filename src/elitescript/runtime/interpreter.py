"""Interpreter mode: a program waits in `interpreter_mode()` and runs statements that clients send.

Statements are numbered from 1 in each program and run in the order in which they came, in the main thread, in the
place of the call. They read and change the variables of the function that has made the call and the program globals.
What else they define, functions and variables, is visible to later statements and to the program until it is cleared.

An exception that a statement does not catch ends the session and is raised by the call.

Evidence: queue, numbers, replies and clearing are *documented* (manual 2.14, interpreter mode). *Assumed*: how many
statements run in a tick, that names which are neither local nor global can be used until they are cleared, that a
session which ends with `clearOnEnd=False` discards nothing, and that statements count as cleared which are discarded
before they begin, or whose definitions are forgotten.
"""

from __future__ import annotations

import sys
from collections import deque
from collections.abc import Callable
from types import FrameType
from typing import Any, Final, Protocol

from elitescript.errors import ProgramError, ScriptStateError
from elitescript.language.compiler import Statement, compile_statement
from elitescript.language.text.source import SourceFile
from elitescript.messages.enums import DiscardReason
from elitescript.records import NamedTuple
from elitescript.runtime.alarms import summary_of
from elitescript.runtime.program_globals import ProgramGlobals
from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.runtime.threads.strand import Strand, is_stop
from elitescript.said import said

STATEMENT: Final = "a statement of interpreter mode"
"""Reason of the wait of the main thread."""

STATEMENTS_PER_TICK: Final = 50
"""Most statements in one tick, if they take no time (*assumed*)."""

FILE: Final = "<interpreter>"
"""File of a statement, as places in its code show it."""

BEGUN: Final = "begun"
DONE: Final = "done"
FAILED: Final = "failed"
STOPPED: Final = "stopped"
SKIPPED: Final = "skipped"


class StatementListener(Protocol):
    """Receives the results of statements."""

    def accepted(self, origin: str, number: int, text: str) -> None:
        """Receive a statement that will run, with its number."""

    def discarded(self, origin: str, reason: DiscardReason, text: str, trace: str = "") -> None:
        """Receive a statement that will not run; `trace` is the place and text of a compile error."""

    def executed(self, number: int, step: str, text: str) -> None:
        """Receive a step of a statement, one of the constants above; `text` of a failure is its reason."""


class NoStatementListener:
    """Do nothing."""

    __slots__ = ()

    def _ignore(self, *_: Any, **_options: Any) -> None:
        pass

    accepted = discarded = executed = _ignore


class _Held(NamedTuple):
    origin: str
    text: str
    problem: str


class _Waiting(NamedTuple):
    origin: str
    number: int
    text: str
    statement: Statement


class _Program(NamedTuple):
    """Parts of the running program that statements use."""

    main: Strand
    globals: ProgramGlobals
    execute: Callable[[Statement, Any], None]


class Interpreter:
    """Queues and runs the statements of one host.

    Args:
        scheduler: runs the main thread.
        limit: most statements in the queue.

    Attributes:
        answers: receives the result of each statement.
        is_running: whether a session runs.
        last_accepted: number of the last statement that was accepted.
        last_executed: number of the statement that runs or ran last.
        last_cleared: number of the last statement that was discarded before it began, or forgotten.
    """

    __slots__ = (
        "_held",
        "_is_clearing",
        "_is_ending",
        "_limit",
        "_program",
        "_queue",
        "_scheduler",
        "_skips_held",
        "answers",
        "is_running",
        "last_accepted",
        "last_cleared",
        "last_executed",
    )

    def __init__(self, scheduler: Scheduler, limit: int) -> None:
        self._scheduler = scheduler
        self._limit = limit
        self._program: _Program | None = None
        self._queue: deque[_Waiting] = deque()
        self._held: deque[_Held] = deque()
        self._skips_held = 0
        self._is_clearing = False
        self._is_ending = False
        self.answers: StatementListener = NoStatementListener()
        self.is_running = False
        self.last_accepted = self.last_executed = self.last_cleared = 0

    # ---------------------------------------------------------------- calls of clients

    def submit(self, origin: str, text: str, problem: str = "") -> None:
        """Accept or discard a statement; an accepted one runs after those before it.

        After `clear_interpreter()` was accepted, further statements wait unanswered until it has been executed.

        Args:
            origin: connection that sent it.
            text: the statement.
            problem: reason why it is invalid; empty if there is none.
        """
        if len(self._queue) + len(self._held) >= self._limit:
            self.answers.discarded(origin, DiscardReason.TOO_MANY, text)
        elif self._is_clearing:
            self._held.append(_Held(origin, text, problem))
        else:
            self._accept(_Held(origin, text, problem))

    def skip(self) -> None:
        """Discard every statement that has not begun; unanswered ones are first accepted, in their order."""
        self._skips_held = len(self._held)
        if self._drop_queue():
            # A clearing statement was among them: nothing waits for its execution.
            self._release_held()

    @property
    def unexecuted(self) -> int:
        """Accepted statements that have not begun."""
        return len(self._queue)

    def _accept(self, held: _Held) -> None:
        program, (origin, text, problem) = self._program, held
        if problem:
            self.answers.discarded(origin, DiscardReason.COMPILE_ERROR, text, problem)
            return
        if program is None:
            self.answers.discarded(origin, DiscardReason.INVALID_STATE, text)
            return
        try:
            statement = compile_statement(SourceFile(FILE, text), program.globals.has)
        except ProgramError as error:
            first = next(found for found in error.problems if found.is_error)
            trace = said("line {line}, column {column}, {text}", line=first.line, column=first.column, text=first.text)
            self.answers.discarded(origin, DiscardReason.COMPILE_ERROR, text, trace)
            return
        if "start_thread" in statement.calls:
            self.answers.discarded(origin, DiscardReason.COMPILE_ERROR, text, "a statement may not start threads")
            return
        self._is_clearing = _clears(statement)
        self.last_accepted += 1
        self._queue.append(_Waiting(origin, self.last_accepted, text, statement))
        self.answers.accepted(origin, self.last_accepted, text)
        self._wake()

    def _wake(self) -> None:
        program = self._program
        if self.is_running and program is not None and program.main.waits_for == STATEMENT:
            self._scheduler.wake(program.main)

    # ---------------------------------------------------------------- the life of a program

    def begin_program(
        self, main: Strand, program_globals: ProgramGlobals, execute: Callable[[Statement, Any], None]
    ) -> None:
        """Take statements for a program that begins; numbers begin anew.

        Args:
            main: its main thread.
            program_globals: its globals.
            execute: runs a statement with the mapping of its variables.
        """
        self._program = _Program(main, program_globals, execute)
        self.last_accepted = self.last_executed = self.last_cleared = 0

    def end_program(self) -> None:
        """Discard waiting statements and end the session: the program is over."""
        self._discard_queue(DiscardReason.CLEARED_AT_END)
        self.last_cleared = self.last_accepted
        self._program = None
        self.is_running = False
        self._release_held()
        self._skips_held = 0

    # ---------------------------------------------------------------- calls of programs

    def run(self, *, clears_queue: bool, clears_at_end: bool) -> None:
        """Run statements until one of them, or another thread, ends the session.

        Raises:
            ScriptStateError: not the main thread, or a session runs already.
            BaseException: raised by a statement.
        """
        program, scheduler = self._program, self._scheduler
        strand = scheduler.current
        if program is None or strand is not program.main:
            raise ScriptStateError("only the main thread of a program may enter interpreter mode")
        if self.is_running:
            raise ScriptStateError("interpreter mode is entered already")
        if clears_queue:
            self._discard_queue(DiscardReason.CLEARED_BEFORE)
            self._release_held()
        self._is_ending = False
        self.is_running = True
        frame = strand.script_frame()
        assert frame is not None
        names = _Names(frame, program.globals)
        tick, count = scheduler.now, 0
        is_stopped = False
        try:
            while not self._is_ending:
                if scheduler.now != tick:
                    tick, count = scheduler.now, 0
                waiting = self._next()
                if waiting is None:
                    scheduler.wait(STATEMENT)
                elif count >= STATEMENTS_PER_TICK:
                    self._queue.appendleft(waiting)
                    scheduler.wait("the next tick", scheduler.now + 1)
                else:
                    count += 1
                    self._execute(program, waiting, names)
        except BaseException as error:
            is_stopped = is_stop(error)
            raise
        finally:
            self.is_running = False
            if clears_at_end and not is_stopped:
                self._discard_queue(DiscardReason.CLEARED_AT_END)
                self._forget(program)

    def end(self) -> None:
        """End the session, if there is one, after the statement that runs."""
        if self.is_running:
            self._is_ending = True
            self._wake()

    def clear(self) -> None:
        """Discard the waiting statements, and delete the names that statements have defined."""
        if self._program is not None:
            self._discard_queue(DiscardReason.CLEARED)
            self._forget(self._program)

    def _next(self) -> _Waiting | None:
        return self._queue.popleft() if self._queue else None

    def _execute(self, program: _Program, waiting: _Waiting, names: _Names) -> None:
        number, text = waiting.number, waiting.text
        self.last_executed = number
        self.answers.executed(number, BEGUN, text)
        try:
            program.execute(waiting.statement, names)
        except BaseException as error:
            if is_stop(error):
                self.answers.executed(number, STOPPED, text)
            else:
                self.answers.executed(number, FAILED, summary_of(error))
            raise
        self.answers.executed(number, DONE, text)
        if _clears(waiting.statement) and not self._queue:
            # It may have ended without clearing.
            self._release_held()

    def _forget(self, program: _Program) -> None:
        self.last_cleared = self.last_accepted
        program.globals.forget_defined()
        self._release_held()

    def _release_held(self) -> None:
        """Accept the statements that were held back, up to the next one that clears."""
        self._is_clearing = False
        while self._held and not self._is_clearing:
            self._accept(self._held.popleft())
            if self._skips_held:
                self._skips_held -= 1
                if self._drop_queue():
                    self._is_clearing = False

    def _drop_queue(self) -> bool:
        """Discard the queue without replies; return whether one of its statements clears."""
        queue, self._queue = self._queue, deque()
        for waiting in queue:
            self.last_cleared = waiting.number
            self.answers.executed(waiting.number, SKIPPED, waiting.text)
        return any(_clears(waiting.statement) for waiting in queue)

    def _discard_queue(self, reason: DiscardReason) -> None:
        queue, self._queue = self._queue, deque()
        for waiting in queue:
            self.last_cleared = waiting.number
            self.answers.discarded(waiting.origin, reason, waiting.text)


def _clears(statement: Statement) -> bool:
    return "clear_interpreter" in statement.calls


class _Names:
    """Names of statements: variables of the function that has entered interpreter mode, then those of the program."""

    __slots__ = ("_frame", "_globals", "_variables")

    def __init__(self, frame: FrameType, program_globals: ProgramGlobals) -> None:
        code = frame.f_code
        self._frame = frame
        self._globals = program_globals
        self._variables = frozenset((*code.co_varnames, *code.co_cellvars, *code.co_freevars))

    def __getitem__(self, name: str) -> Any:
        if name in self._variables:
            return self._frame.f_locals[name]
        raise KeyError(name)

    def __setitem__(self, name: str, value: Any) -> None:
        if name not in self._variables:
            self._globals.assign(name, value)
            return
        self._frame.f_locals[name] = value
        _store_variables(self._frame)

    def __delitem__(self, name: str) -> None:
        if name in self._variables:
            raise ScriptStateError(said("a statement cannot delete {name!r}, a variable of the program", name=name))
        self._globals.delete(name)


def _store() -> Callable[[FrameType], None]:
    if sys.version_info >= (3, 13):
        # There, the mapping of a frame's variables writes through.
        return lambda frame: None

    def store(frame: FrameType) -> None:
        from ctypes import c_int, py_object, pythonapi

        pythonapi.PyFrame_LocalsToFast(py_object(frame), c_int(0))

    return store


_store_variables: Final = _store()
