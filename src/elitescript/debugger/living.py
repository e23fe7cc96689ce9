"""Debugs the programs of a robot that lives: forward only, while its ports are served.

A stop is a pause of the task: the arm brakes, clients see a paused task, time goes on. The thread that stops stays
before its statement, the others stay where they are; secondary programs run on, as in any pause. Whoever resumes the
task lets the program go on.

What a debugger asks for comes as inputs (`messages.inputs.Debug`), the text of which is an object of JSON: `do` names a
method of `LivingDebugger`, the rest are its arguments. One debugger is attached at a time. What happens meanwhile goes
to it as replies to its session, objects with `event`.
"""

from __future__ import annotations

import contextlib
import json
import sys
from collections.abc import Callable, Sequence
from math import inf
from typing import Any, Final

from elitescript.controller.controller import Controller
from elitescript.debugger import wire
from elitescript.debugger.api import (
    AFTER_TICK,
    BEFORE_STATEMENT,
    BREAKPOINT,
    DATA_BREAKPOINT,
    EXCEPTION,
    EXCEPTION_FILTERS,
    FUNCTION_BREAKPOINT,
    PAUSE,
    STEP,
    BreakpointState,
    Change,
    DataBreakpoint,
    DataInfo,
    ExceptionInfo,
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
    Unevaluated,
    Variable,
)
from elitescript.debugger.inputs import Input as UserChange
from elitescript.debugger.inputs import apply_input
from elitescript.debugger.living_breakpoints import Breakpoint, LivingBreakpoints, Text
from elitescript.debugger.looking import CallFrame, Look, Names
from elitescript.debugger.places import Places
from elitescript.debugger.rules import Watch, unevaluated
from elitescript.debugger.telling import exception_of, filled, logged, output_of
from elitescript.errors import DebugError, ScriptError, UsageError
from elitescript.language.compiler import CompiledUnit
from elitescript.messages.enums import TaskState
from elitescript.messages.events import (
    Alarm,
    Event,
    SignalChanged,
    TaskStateChanged,
    Warned,
)
from elitescript.messages.inputs import Debug
from elitescript.messages.machine import PauseTask, ResumeTask
from elitescript.messages.outcomes import Debugged, Outcome, Refused
from elitescript.messages.timing import seconds
from elitescript.records import NamedTuple, record
from elitescript.runtime.host import ScriptHost
from elitescript.runtime.threads.scheduler import DEBUGGER
from elitescript.runtime.threads.strand import Strand
from elitescript.untrusted.json_text import JsonError, json_value
from elitescript.values.concrete import TooLong, short

STEPS_MAX: Final = 10_000
"""Most nodes of an expression: the robot waits meanwhile."""
TEXTS_MAX: Final = 100
"""Texts that are kept while a debugger is attached; more than secondary programs can wait."""
PART_MAX: Final = 200_000
"""Characters of a text that are sent at once."""


@record
class SourceInfo:
    """The text of a program.

    Attributes:
        name: as of `Frame.source`.
        size: characters.
        digest: see `digest_of`.
    """

    name: str
    size: int
    digest: str


@record
class SourcePart:
    """A part of a text; `size` is that of the whole."""

    text: str
    size: int


class Step(NamedTuple):
    """A step that is under way: it ends at the next statement of a thread that is not deeper than a depth."""

    strand: Strand
    depth: float
    statements: frozenset[int] | None
    """Of the functions that the thread is in; None for those of all."""


class _News(NamedTuple):
    """Why the program is to stop."""

    reason: str
    text: str
    breakpoint: int = 0
    change: Change | None = None
    exception: ExceptionInfo | None = None
    unevaluated: str = ""
    """Why the breakpoint cannot be evaluated, if that is it."""


class LivingDebugger:
    """Debugs the programs of one robot. Implements `kernel.debugging.Debugger`.

    Args:
        controller: the machine.
        host: runs its programs.
        reply: sends an outcome to an origin.
    """

    def __init__(self, controller: Controller, host: ScriptHost, reply: Callable[[str, Outcome], None]) -> None:
        self._controller = controller
        self._host = host
        self._scheduler = host.scheduler
        self._reply = reply
        self._session = ""
        self._texts: dict[int, Text] = {}
        self._breakpoints = LivingBreakpoints()
        self._filters: frozenset[str] = frozenset()
        self._step: Step | None = None
        self._awaits_statement = False
        """Whether a pause was asked for while no program ran: the next statement stops."""
        self._news: list[_News] = []
        """What has happened that stops the program as soon as it may."""
        self._stop: Stop | None = None
        self._held: Strand | None = None
        """The thread that waits before a statement."""
        self._held_tick = 0
        self._has_paused = False
        """Whether the task was paused for the present stop."""
        self._looks = 0
        """Statements that were looked at."""
        self._last: Strand | None = None
        """The thread whose statement was looked at last; None behind a tick."""
        self._last_line = 0
        self._causes: dict[str, tuple[int, str, int]] = {}
        """Thread, name and line that have changed a signal since the last look, by its name."""
        self._error: BaseException | None = None
        """With which the thread that is held has failed."""
        self._look_now: Look | None = None
        """What the present stop shows."""
        self._places = Places()
        self._looked_at: frozenset[int] | None = frozenset()
        """Statements that are looked at; None for all."""
        self._watched_places = Places()
        """Of the programs that `_looked_at` was made for."""

    # ---------------------------------------------------------------- `kernel.debugging.Debugger`

    @property
    def is_attached(self) -> bool:
        """Whether a debugger is there."""
        return bool(self._session)

    def take(self, item: Debug) -> None:
        """Do what is asked, and answer."""
        self._refresh()
        try:
            if self._session and item.session != self._session:
                raise DebugError(f"another debugger is attached: {self._session}")
            name, arguments = _request_of(item.text)
            if not self._session:
                if name == "detach":
                    raise DebugError("no debugger is attached")
                self._session = item.session
                for unit in () if self._host.program is None else self._host.program.units:
                    self._note(unit)
            result = getattr(self, name)(**wire.arguments_of(getattr(LivingDebugger, name), arguments))
        except (DebugError, ScriptError, UsageError) as error:
            self._reply(item.origin, Refused(str(error)))
        except Exception as error:
            # A robot does not end by a mistake of its debugger.
            self._reply(item.origin, Refused(f"a mistake of ours, please report it: {type(error).__name__}: {error}"))
        else:
            answer = json.dumps({"result": wire.written(result)})
            is_too_long = len(answer) > wire.TEXT_MAX
            outcome = Refused("the answer is too long; ask for a part") if is_too_long else Debugged(answer)
            self._reply(item.origin, outcome)
        self._watch()

    def arrived(self, unit: CompiledUnit) -> None:
        """Take note of a unit that will run, and find its statements for the breakpoints."""
        text = self._note(unit)
        self._tell("source", source=_info(text))
        for state in self._breakpoints.add(text):
            self._tell("breakpoint", state=state)
        self._watch()

    def event(self, event: Event) -> None:
        """Tell what programs say; stop at what a filter or a data breakpoint names."""
        if (output := output_of(event, self._position(AFTER_TICK), self._time_s)) is not None:
            self._tell("output", output=output)
        if isinstance(event, TaskStateChanged) and event.state is TaskState.STOPPED:
            self._say_missing()
            self._let_go()
            self._set_step(None)
            self._news.clear()
            self._tell("ended", result=event.ending)
        elif isinstance(event, SignalChanged):
            self._signal_changed(event)
        elif isinstance(event, Alarm | Warned):
            self._exception(event)

    def after_tick(self) -> None:
        """See whether somebody else has resumed the task; stop for what has happened beside the programs."""
        self._refresh()
        self._look_at_data(None)
        news, self._news = self._news, []
        if self._stop is None and news and self._controller.task_state is TaskState.PLAYING:
            self._controller.request(PauseTask())
            self._has_paused = True
            self._stopped(news, None)
        self._watch()

    def next_tick(self, tick: int) -> int | None:
        """Return the next tick while values are watched that change with time; see `Debugger.next_tick`."""
        return tick + 1 if self._breakpoints.data and self._stop is None else None

    # ---------------------------------------------------------------- going on

    def attach(self) -> None:
        """Attach, as the first request of a session does, whatever it is."""

    def detach(self, leaves_paused: bool = False) -> None:
        """Remove all breakpoints, let a program that was stopped go on, and forget the debugger.

        Args:
            leaves_paused: leave it paused; whoever resumes the task lets it go on.
        """
        self._session = ""
        self._breakpoints = LivingBreakpoints()
        self._filters, self._awaits_statement = frozenset(), False
        self._set_step(None)
        self._news.clear()
        if self._stop is not None:
            with contextlib.suppress(ScriptError):
                # What the safety system refuses stays paused, as any task does then.
                if not leaves_paused:
                    self._resume_task()
            self._let_go()

    def pause(self) -> None:
        """Pause the task; if none runs, stop before the first statement of the next program."""
        if self._stop is not None:
            raise DebugError("the program is stopped already")
        if not self._host.is_running:
            self._awaits_statement = True
            return
        if self._controller.task_state is TaskState.PLAYING:
            self._controller.request_from(PauseTask(), "client")
        self._has_paused = True
        self._stopped([_News(PAUSE, "paused")], None)

    def resume(self) -> None:
        """Let the program go on to the next stop."""
        self._go_on(None)

    def next(self, thread: int) -> None:
        """Go on until a thread is at its next statement of the same call or of a caller; other threads run, too."""
        strand = self._strand(thread)
        self._go_on(Step(strand, _depth(strand), self._statements_around(strand)))

    def step_in(self, thread: int) -> None:
        """Go on to the next statement of a thread, also in a function that it calls."""
        self._go_on(Step(self._strand(thread), inf, None))

    def step_out(self, thread: int) -> None:
        """Go on until a thread has left its present function."""
        strand = self._strand(thread)
        self._go_on(Step(strand, _depth(strand) - 1, self._statements_around(strand)))

    def _statements_around(self, strand: Strand) -> frozenset[int]:
        """Return the statements of all functions that a thread is in."""
        codes = [frame.f_code for frame in strand.script_frames()]
        return frozenset(self._places.numbers_in({(code.co_filename, code.co_qualname) for code in codes}))

    def _go_on(self, step: Step | None) -> None:
        if self._stop is None:
            raise DebugError("the program is not stopped")
        self._resume_task()
        self._set_step(step)
        self._let_go()

    def _set_step(self, step: Step | None) -> None:
        """Begin a step, or end the one that is under way."""
        if self._step is not None and self._thread_ended in self._step.strand.at_end:
            self._step.strand.at_end.remove(self._thread_ended)
        self._step = step
        if step is not None:
            step.strand.at_end.append(self._thread_ended)

    def _thread_ended(self) -> None:
        """Stop at the next statement of any thread: the one that has taken the step has ended."""
        if (step := self._step) is not None:
            self._step = None
            self._news.append(_News(STEP, f"thread {step.strand.name!r} has ended"))
            self._watch()

    def _resume_task(self) -> None:
        """Resume the task, if it was paused for the debugger.

        Raises:
            ScriptError: the safety system refuses it.
        """
        if self._has_paused and self._controller.task_state is TaskState.PAUSED:
            self._controller.request_from(ResumeTask(), "client")

    # ---------------------------------------------------------------- breakpoints

    def set_breakpoints(
        self, requests: Sequence[LineBreakpoint], path: str = "", digest: str = ""
    ) -> tuple[BreakpointState, ...]:
        """Replace the breakpoints of lines in one text.

        Args:
            requests: in their order.
            path: of its file, or its name; empty for any.
            digest: of the text, see `digest_of`; empty for any.
        """
        return self._breakpoints.set_lines(path, digest, requests, self._texts.values())

    def set_function_breakpoints(self, requests: Sequence[FunctionBreakpoint]) -> tuple[BreakpointState, ...]:
        """Replace the breakpoints of functions and commands."""
        return self._breakpoints.set_functions(requests, self._texts.values())

    def set_exception_filters(self, filters: Sequence[str]) -> None:
        """Replace the filters: `alarm`, `warning`. At first there is none."""
        for name in filters:
            if name not in EXCEPTION_FILTERS:
                raise DebugError(f"a filter is one of {', '.join(EXCEPTION_FILTERS)}, not {name!r}")
        self._filters = frozenset(filters)

    def breakpoint_locations(self, line: int, end_line: int = 0, path: str = "", digest: str = "") -> tuple[Place, ...]:
        """Return the statements that begin in lines of a text, the last line included."""
        for text in reversed(self._texts.values()):
            if text.is_of(path, digest):
                return tuple(
                    Place(item.line, item.column, item.end_line, item.end_column)
                    for item in text.unit.statements
                    if line <= item.line <= max(line, end_line)
                )
        return ()

    def set_data_breakpoints(self, requests: Sequence[DataBreakpoint]) -> tuple[BreakpointState, ...]:
        """Replace the data breakpoints."""
        items = self._breakpoints.set_data(requests)
        for item in self._breakpoints.data:
            item.value = self._watched(item)
        return tuple(item.state for item in items)

    def data_breakpoint_info(self, name: str, reference: int = 0, frame: int = 0) -> DataInfo:
        """Return what a data breakpoint can watch: a name, an expression, or a child of a scope or of a value."""
        if reference:
            name = self._stopped_look.child(reference, name).data_id
            if not name:
                return DataInfo(None, "only signals, program globals, the robot mode and the safety mode are watched")
        try:
            return DataInfo(Watch(name).data_id, f"changes of {name}")
        except DebugError as error:
            return DataInfo(None, str(error))

    # ---------------------------------------------------------------- looking

    @property
    def _stopped_look(self) -> Look:
        if self._look_now is None:
            raise DebugError("the program runs; pause it first")
        return self._look_now

    def stack(self, thread: int) -> tuple[Frame, ...]:
        """Return the calls of a thread, the innermost one first; empty before it has begun."""
        return self._stopped_look.stack(thread)

    def scopes(self, frame: int) -> tuple[Scope, ...]:
        """Return the scopes of a frame: `Locals`, `Globals`, `Robot`. With frame 0 without `Locals`."""
        return self._stopped_look.scopes(frame)

    def variables(self, reference: int, kind: str = "", start: int = 0, count: int = 0) -> tuple[Variable, ...]:
        """Return what a scope or a value holds, the `named` or the `indexed` ones if so asked; 1000 at most.

        Without `count` there are those of a scope, and 100 of a value. What is left out is counted in a last row.
        """
        return self._stopped_look.variables(reference, kind, max(start, 0), max(count, 0))

    def evaluate(self, text: str, frame: int = 0, may_change: bool = False) -> Variable:
        """Return the value of an expression; without a frame and changes also while the program runs.

        Args:
            text: an expression; with `may_change` also statements.
            frame: whose variables it sees; 0 for program globals alone.
            may_change: let it change the program and the robot. Nothing in it may wait.
        """
        look = self._stopped_look if frame or may_change else self._look_now or self._fresh_look()
        call = look.call(frame)
        try:
            value = look.value(text, call)
        except DebugError:
            if not may_change:
                raise
            return self._changed_variable(text, self._change_by(call, "", text))
        return look.variable(text, value, call, text)

    def set_variable(self, reference: int, name: str, text: str) -> Variable:
        """Set a child of a scope or of a value to the value of an expression."""
        target, call = self._stopped_look.expression_of(reference, name)
        return self._changed_variable(name, self._change_by(call, target, text))

    def set_expression(self, target: str, text: str, frame: int = 0) -> Variable:
        """Assign the value of an expression to a variable, an item or a signal; without a frame at any time."""
        look = self._stopped_look if frame else self._look_now or self._fresh_look()
        return self._changed_variable(target, self._change_by(look.call(frame), target, text))

    def set_signal(self, name: str, text: str) -> Variable:
        """Set an input, output or register of the robot, at any time."""
        return self.set_expression(name, text)

    def _change_by(self, call: CallFrame | None, target: str, text: str) -> Any:
        """Make a change; return the value.

        Commands that move or wait are refused before they begin, as in a secondary program.
        """
        strand = None if call is None else call.strand
        thread, depth = (0, 0) if call is None else (call.strand.order + 1, call.depth)
        change = UserChange(self._position(AFTER_TICK), thread, depth, target, text)
        scheduler = self._scheduler
        fuel, is_secondary = list(scheduler.fuel), strand is not None and strand.is_secondary
        if strand is not None:
            strand.is_secondary = True
        try:
            return apply_input(change, self._look_now or self._fresh_look(), self._controller, self._host)
        finally:
            scheduler.fuel[:] = fuel
            if strand is not None:
                strand.is_secondary = is_secondary

    def _changed_variable(self, name: str, value: Any) -> Variable:
        """Return a value behind a change, which ends what was shown before it."""
        if self._look_now is not None:
            self._look_now = self._fresh_look()
        return (self._look_now or self._fresh_look()).variable(name, value)

    def threads(self) -> tuple[ThreadInfo, ...]:
        """Return the script threads in the order of their start."""
        return (self._look_now or self._fresh_look()).threads()

    def state(self) -> State:
        """Return the robot at this moment."""
        controller = self._controller
        joints = controller.joints()
        return State(seconds(controller.tick), controller.tick, joints.q_actual, controller.tcp_pose(joints.q_actual))

    def sources(self) -> tuple[SourceInfo, ...]:
        """Return the texts of programs, the newest first."""
        return tuple(map(_info, reversed(self._texts.values())))

    def source_text(self, name: str, start: int = 0) -> SourcePart:
        """Return a part of the text of a program.

        Raises:
            DebugError: no text has that name.
        """
        for text in self._texts.values():
            if text.name == name:
                source, start = text.unit.source.text, max(start, 0)
                return SourcePart(source[start : start + PART_MAX], len(source))
        raise DebugError(f"there is no program {name!r}")

    # ---------------------------------------------------------------- statements

    def _look(self, strand: Strand, number: int) -> None:
        """Look at the next statement of the running thread; returns when it may run."""
        try:
            self._look_at_statement(strand, number)
        except RecursionError:
            # So near to the limit nothing can be looked at; the program meets it by itself.
            pass
        except Exception as error:
            # A program does not get an exception by a mistake of its debugger.
            text = f"a mistake of ours, please report it: {type(error).__name__}: {error}"
            position = self._position(BEFORE_STATEMENT)
            self._tell("output", output=Output("important", text, 0, strand.name, position, self._time_s))

    def _look_at_statement(self, strand: Strand, number: int) -> None:
        self._refresh()
        self._looks += 1
        if self._stop is not None or not self._places.has(number):
            # A secondary program beside a program that is stopped, or one that has waited for long in a queue.
            return
        self._look_at_data(strand)
        news, self._news = self._news, []
        self._last_line = self._places.statement(number).line
        step = self._step
        if step is not None and step.strand is strand and _depth(strand) <= step.depth:
            news.append(_News(STEP, "step"))
        if self._awaits_statement:
            news.append(_News(PAUSE, "paused"))
        for item in self._breakpoints.at.get(number, ()):
            self._reached(item, strand, news)
        if news:
            self._hold(strand, news)

    def _reached(self, item: Breakpoint, strand: Strand, news: list[_News]) -> None:
        """Add a stop to the news if a breakpoint stops here, or write its message."""
        try:
            is_hit = self._holds(item, strand) and item.is_hit()
        except DebugError as error:
            what = f"the condition of line {self._last_line}"
            self._unevaluated(item, what, item.condition, error, strand, news)
            return
        if is_hit:
            if item.log_message:
                self._log(item, strand, self._last_line)
            else:
                news.append(_News(item.reason, f"{item.reason} {item.id}", item.id))

    def _hold(self, strand: Strand, news: list[_News]) -> None:
        """Pause the task, and hold the running thread until it goes on."""
        self._has_paused = self._controller.task_state is TaskState.PLAYING
        if self._has_paused:
            self._controller.request(PauseTask())
        self._held, self._held_tick = strand, self._controller.tick
        self._stopped(news, strand)
        try:
            if strand.is_secondary:
                self._scheduler.wait(DEBUGGER)
            else:
                self._scheduler.give_way(DEBUGGER)
        finally:
            if self._held is strand:
                self._held = None

    def _stopped(self, news: list[_News], strand: Strand | None) -> None:
        """Tell the debugger that the program stands.

        Args:
            news: why; the most particular reason is shown.
            strand: the thread that has stopped before a statement; None if none has.
        """
        first = min(news, key=lambda item: _WEIGHT.index(item.reason))
        shown = strand or self._main
        self._set_step(None)
        self._awaits_statement = False
        text = "; ".join(dict.fromkeys((first.text, *(item.unevaluated for item in news if item.unevaluated))))
        self._stop = Stop(
            first.reason,
            text,
            0 if shown is None else shown.order + 1,
            self._position(AFTER_TICK if strand is None else BEFORE_STATEMENT),
            seconds(self._controller.tick),
            tuple(item.breakpoint for item in news if item.breakpoint),
            tuple(item.change for item in news if item.change is not None),
            next((item.exception for item in news if item.exception is not None), None),
            first.exception.line if first.exception is not None else 0 if shown is None else shown.line,
            unevaluated=tuple(
                Unevaluated(item.breakpoint, item.unevaluated, False) for item in news if item.unevaluated
            ),
        )
        self._look_now = self._fresh_look()
        self._tell("stopped", stop=self._stop)

    def _refresh(self) -> None:
        """Follow whoever else has resumed the task."""
        if self._stop is None or self._controller.task_state is not TaskState.PLAYING:
            return
        self._let_go()
        self._tell("continued")

    def _let_go(self) -> None:
        """Forget the stop; a secondary program that was held goes on."""
        self._stop = self._look_now = None
        if (strand := self._held) is not None:
            self._held = None
            if strand.is_secondary:
                self._host.prolong_secondary(self._controller.tick - self._held_tick)
                self._scheduler.wake(strand)

    def _watch(self) -> None:
        """Look at statements only while something may stop at one, and only at those."""
        step = self._step
        looked_at: frozenset[int] | None = frozenset(self._breakpoints.at)
        if self._awaits_statement or self._news or self._breakpoints.data or (step and step.statements is None):
            looked_at = None
        elif step is not None and step.statements is not None:
            looked_at = frozenset((*self._breakpoints.at, *step.statements))
        if looked_at == self._looked_at and self._places is self._watched_places:
            return
        self._looked_at, self._watched_places = looked_at, self._places
        if looked_at == frozenset():
            self._scheduler.watch(None)
        else:
            self._scheduler.watch(self._look, () if looked_at is None else self._places.others(looked_at))

    # ---------------------------------------------------------------- what has happened

    def _exception(self, event: Alarm | Warned) -> None:
        """Stop at an alarm or a warning of a thread, if a filter names it.

        An alarm stops where the exception has left the program, before its end; a warning before the next statement:
        it may come from the middle of a command.
        """
        info, strand = exception_of(event), self._scheduler.current
        if info.filter not in self._filters or self._stop is not None or strand is None or not strand.is_running:
            return
        news = _News(EXCEPTION, info.text, exception=info)
        if isinstance(event, Warned):
            self._news.append(news)
            self._watch()
        elif next(strand.script_frames(), None) is None:
            self._error = sys.exception()
            try:
                self._hold(strand, [news])
            finally:
                self._error = None

    def _signal_changed(self, event: SignalChanged) -> None:
        strand = self._scheduler.current
        if strand is not None and strand.is_running:
            cause = strand.order + 1, strand.name, event.line
        else:
            cause = 0, event.by, 0
        self._causes[event.name] = cause

    def _look_at_data(self, strand: Strand | None) -> None:
        """Compare what data breakpoints watch with what it was; what stops is added to the news.

        Args:
            strand: the thread that runs; None behind a tick.
        """
        last, self._last = self._last, strand
        can_stop = strand is not None or self._controller.task_state is TaskState.PLAYING
        for item in self._breakpoints.data:
            old, new = item.value, self._watched(item)
            item.value = new
            assert item.watch is not None
            if item.watch.error is not None and can_stop:
                what = "what the data breakpoint watches"
                self._unevaluated(item, what, item.watch.data_id, item.watch.error, strand, self._news)
                continue
            if old == new or (item.watch.stops_when_true and new != "True") or self._stop is not None:
                continue
            if not can_stop and item.condition:
                continue
            try:
                is_hit = self._holds(item, strand) and item.is_hit()
            except DebugError as error:
                what = f"the condition of {short(item.watch.data_id)}"
                self._unevaluated(item, what, item.condition, error, strand, self._news)
                continue
            if is_hit:
                change = self._change(item.watch.data_id, old, new, last)
                self._news.append(_News(DATA_BREAKPOINT, _changed(change, item.watch), item.id, change))
        self._causes.clear()

    def _change(self, name: str, old: str, new: str, last: Strand | None) -> Change:
        """Return a change with what made it: the cause of a signal, else the thread that has run."""
        by = (0, "", 0) if last is None else (last.order + 1, last.name, self._last_line)
        thread, thread_name, line = self._causes.get(name, by)
        tick = self._controller.tick
        position = self._position(AFTER_TICK)
        return Change(name, old, new, position, None, thread, thread_name, line, tick, seconds(tick))

    def _watched(self, item: Breakpoint) -> str:
        """Return the present value of what a data breakpoint watches, as text."""
        assert item.watch is not None
        if item.is_given_up:
            item.watch.error = None
            return ""
        program = self._host.program
        names = Names(self._controller, self._host, self._fresh_look(), None)
        return item.watch.text(self._controller, None if program is None else program.globals, names, STEPS_MAX)

    def _say_missing(self) -> None:
        """Say which variables that are watched were never there in a program that has ended; once each."""
        for item in self._breakpoints.data:
            watch = item.watch
            if watch is None or watch.was_there or watch.error is not None or item.is_said:
                continue
            item.is_said = True
            text = f"the data breakpoint {short(watch.data_id)} has watched nothing: the program had no such variable"
            self._tell("output", output=Output("important", text, 0, "", self._position(AFTER_TICK), self._time_s))

    def _holds(self, item: Breakpoint, strand: Strand | None) -> bool:
        if not item.condition or item.is_given_up:
            return not item.is_given_up
        look = self._fresh_look()
        return look.holds(item.condition, _innermost(look, strand))

    def _unevaluated(
        self, item: Breakpoint, what: str, text: str, error: DebugError, strand: Strand | None, news: list[_News]
    ) -> None:
        """Stop at a breakpoint that cannot be evaluated, and say why; once. See `rules.unevaluated`."""
        if item.is_said or self._stop is not None:
            return
        item.is_said, item.is_given_up = True, isinstance(error, TooLong)
        text = unevaluated(what, text, error)
        name, line = ("", 0) if strand is None else (strand.name, self._last_line)
        self._tell("output", output=Output("important", text, line, name, self._position(AFTER_TICK), self._time_s))
        news.append(_News(item.reason, text, item.id, unevaluated=text))

    def _log(self, item: Breakpoint, strand: Strand, line: int) -> None:
        """Write the message of a breakpoint."""
        look = self._fresh_look()
        call = _innermost(look, strand)
        text = filled(item.log_message, lambda expression: logged(look, expression, call))
        position = self._position(BEFORE_STATEMENT)
        self._tell("output", output=Output("console", text, line, strand.name, position, self._time_s))

    # ---------------------------------------------------------------- internal

    @property
    def _main(self) -> Strand | None:
        return next((strand for strand in self._scheduler.strands if not strand.is_secondary), None)

    def _strand(self, thread: int) -> Strand:
        return self._fresh_look().strand(thread)

    def _fresh_look(self) -> Look:
        look = _Look(self._controller, self._host, self._places, self._error)
        look.failed = self._held
        return look

    @property
    def _time_s(self) -> float:
        return seconds(self._controller.tick)

    def _position(self, kind: str) -> Position:
        return Position(self._looks, 0, self._controller.tick, kind)

    def _note(self, unit: CompiledUnit) -> Text:
        """Take note of the text of a unit."""
        name = unit.source.name
        names = {text.name for text in self._texts.values()}
        number = 2
        while name in names:
            name = f"{unit.source.name} ({number})"
            number += 1
        text = self._texts[unit.probes.first] = Text(name, unit)
        if len(self._texts) > TEXTS_MAX:
            running = {unit.probes.first for unit in (self._host.program.units if self._host.program else ())}
            del self._texts[next(first for first in self._texts if first not in running)]
        # Frames know their text by the name of its source: the newest one of each name.
        newest = {text.unit.source.name: text.unit for text in self._texts.values()}
        self._places = Places()
        for item in sorted(newest.values(), key=lambda unit: unit.probes.first):
            self._places.add(item)
        return text

    def _tell(self, event: str, **content: Any) -> None:
        """Tell the debugger what happens."""
        if self._session:
            values = {name: wire.written(value) for name, value in content.items()}
            self._reply(self._session, Debugged(json.dumps({"event": event, **values})))


def _info(text: Text) -> SourceInfo:
    return SourceInfo(text.name, len(text.unit.source.text), text.digest)


def _innermost(look: Look, strand: Strand | None) -> CallFrame | None:
    return None if strand is None else next(iter(look.calls(strand)), None)


def _changed(change: Change, watch: Watch) -> str:
    """Return a change in words."""
    by = f" by {change.thread_name}" if change.thread_name else ""
    place = f" in line {change.line}" if change.line else ""
    if watch.stops_when_true:
        return f"{change.name} is true{by}{place}"
    return f"{change.name} was {change.old or 'not there'} and is {change.new or 'not there'}{by}{place}"


class _Look(Look):
    """What a living robot shows, a thread that has failed included, which waits meanwhile."""

    failed: Strand | None = None
    steps_max = condition_steps_max = STEPS_MAX

    def _is_failed(self, strand: Strand) -> bool:
        return self._error is not None and strand is self.failed


def _depth(strand: Strand) -> int:
    """Return the number of calls of script code that a thread is in."""
    return sum(1 for _ in strand.script_frames())


def _request_of(text: str) -> tuple[str, dict[str, Any]]:
    """Return the name of a method and its arguments.

    Raises:
        DebugError: the text is no request.
    """
    try:
        data = json_value(text)
    except JsonError:
        data = None
    if not isinstance(data, dict) or data.get("do") not in REQUESTS:
        raise DebugError(f'a request is an object of JSON in which "do" is one of {", ".join(REQUESTS)}')
    return data.pop("do"), data


_WEIGHT: Final = (EXCEPTION, BREAKPOINT, FUNCTION_BREAKPOINT, DATA_BREAKPOINT, PAUSE, STEP)
"""Reasons of stops; the first one that applies is shown."""

EVENTS: Final = {
    "stopped": ("`stop`", "The program is stopped."),
    "continued": ("", "Somebody else has resumed the task."),
    "output": ("`output`", "A program has said something, or a breakpoint with a message was passed."),
    "source": ("`source`", "A program has arrived."),
    "breakpoint": ("`state`", "A breakpoint has found its place in a program that has arrived."),
    "ended": (
        "`result`",
        "The program is over; `finished`, `alarm` or `stopped`. The next one gets the breakpoints, too.",
    ),
    "detached": ("`reason`", "The robot's process was replaced; the next request attaches anew."),
}
"""What a debugger is told: by name, what comes with it, and when."""

REQUESTS: Final = (
    "attach",
    "detach",
    "pause",
    "resume",
    "next",
    "step_in",
    "step_out",
    "set_breakpoints",
    "set_function_breakpoints",
    "set_exception_filters",
    "set_data_breakpoints",
    "breakpoint_locations",
    "data_breakpoint_info",
    "stack",
    "scopes",
    "variables",
    "evaluate",
    "set_variable",
    "set_expression",
    "set_signal",
    "threads",
    "state",
    "sources",
    "source_text",
)
"""What can be asked."""
