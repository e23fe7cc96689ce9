"""`DebugSession`: a run that stops at counted statements, goes back and forth in its history, and is looked into."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from typing import Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.debugger.api import (
    AFTER_TICK,
    ALARM_FILTER,
    AT_END,
    BEFORE_STATEMENT,
    BREAKPOINT,
    ENTRY,
    EXCEPTION_FILTERS,
    FUNCTION_BREAKPOINT,
    IN_STATEMENT,
    STEP,
    BreakpointState,
    Change,
    DataBreakpoint,
    DataInfo,
    Frame,
    FunctionBreakpoint,
    LineBreakpoint,
    Output,
    Picture,
    Place,
    Position,
    Scope,
    State,
    Stop,
    ThreadInfo,
    Variable,
)
from elitescript.debugger.calls import calls_by_statement
from elitescript.debugger.engine import INTO, OUT, OVER, Engine, Goal
from elitescript.debugger.inputs import Input
from elitescript.debugger.looking import ROBOT_VALUES
from elitescript.debugger.rules import CodeRule, DataRule, Rules, Watch, checked
from elitescript.debugger.snapshots import snapshots
from elitescript.debugger.source import Source
from elitescript.errors import DebugError, did_you_mean
from elitescript.language.diagnostics import Diagnostic
from elitescript.language.parser import parse
from elitescript.language.probes import CountedStatement
from elitescript.language.scopes import Resolution
from elitescript.language.symbols import Symbols
from elitescript.language.text.lexer import MARKS
from elitescript.language.text.source import SourceFile
from elitescript.messages.signals import SIGNALS
from elitescript.messages.timing import ticks_for
from elitescript.records import replace

REAL_NETWORK: Final = "going back does not reach the peers of real connections: what they have sent is used again"
"""Said at the start of a program that may connect to something outside the simulation."""
WRITTEN_FILES: Final = "going back does not reach files: what the program has written stays in its task folder"
"""Said at the start of a program that opens files."""
WINDOW: Final = 2000
"""Statements before the present stop in which a search for an earlier one begins."""
WINDOW_OF_SNAPSHOTS: Final = 50
_WIDER: Final = 50
_WIDE_ENOUGH: Final = 5
"""A search may begin at a copy that stands so many times the width before the present stop."""
_NAME: Final = re.compile(rf"[\w.{MARKS}]*(\(\))?")
"""Of a function or a command."""


class DebugSession:
    """A debugged run. Calls that let it go on return the next stop; everything else is answered while it stands.

    Nothing here is called from two threads at once, but for `pause`.

    Args:
        source: what is debugged.
        on_output: receives what the run says, once on each branch of its history.
        forks: whether snapshots of the process may be made, which makes going back in long programs fast: only in a
            process of one thread that may be forked, on POSIX.
        keeps_end: whether it can go back from the end of the run. If not, a run without breakpoints that comes to its
            end need not be counted.

    Raises:
        ProgramError: the program does not compile.
        ElitescriptError: the robot, the world or an option is wrong.
    """

    def __init__(
        self,
        source: Source,
        on_output: Callable[[Output], None] | None = None,
        *,
        forks: bool = False,
        keeps_end: bool = True,
    ) -> None:
        self._source = source
        self._on_output = on_output
        self._keeps_end = keeps_end
        self._rules = Rules()
        self._inputs: list[Input] = []
        self._heard = 0
        self._logged: Position | None = None
        self._furthest = Position(0, 0, 0, BEFORE_STATEMENT)
        self._next_id = 1
        self._is_closed = False
        self._is_pausing = False
        self._lines: dict[tuple[str, str], list[CodeRule]] = {}
        """By the name of the text."""
        self._functions: list[CodeRule] = []
        self._data: list[DataRule] = []
        self._typed: list[DataRule] = []
        """Of expressions that stand where names of functions are typed."""
        self._filters: frozenset[str] = frozenset((ALARM_FILTER,))
        self._has_stale_hits = False
        self._snapshots = snapshots(self._hear, forks=forks and source.may_fork)
        self._engine = self._new_engine(is_heard=True)
        self._texts = self._engine.texts()
        self._stop = Stop(ENTRY, "not begun", 0, self._engine.position, 0.0)

    # ---------------------------------------------------------------- going on

    def start(self, *, stop_on_entry: bool = False, no_debug: bool = False) -> Stop:
        """Begin the run; return its first stop: `entry`, before the first statement, or what `resume` returns.

        Args:
            stop_on_entry: stop before the first statement.
            no_debug: run to the end; breakpoints and filters are not heeded.
        """
        limits = ((not self._source.may_fork, REAL_NETWORK), (self._source.may_write, WRITTEN_FILES))
        for is_so, text in limits:
            if is_so and not no_debug and self._on_output is not None:
                self._on_output(Output("console", text, 0, "", self._engine.position, 0.0))
        if no_debug:
            return self._run_plainly(frozenset())
        if stop_on_entry:
            return self._to_entry()
        return self.resume()

    def resume(self) -> Stop:
        """Go on to the next breakpoint, exception of a filter, pause, or the end."""
        if self._can_be_plain and not self._is_pausing:
            if not self._snapshots.forks:
                return self._run_plainly(self._filters)
            if not self._keeps_end and not self._source.may_write:
                return self._run_in_company()
        self._count_hits_again()
        return self._arrived(self._engine.run(Goal(heeds=True)))

    def next(self, thread: int) -> Stop:
        """Go on until a thread is at its next statement of the same call or of a caller; other threads run, too.

        Over a `movej` that is when it returns. Breakpoints and filters stop earlier.
        """
        return self._step(OVER, thread)

    def step_in(self, thread: int) -> Stop:
        """Go on to the next statement of a thread, also in a function that it calls."""
        return self._step(INTO, thread)

    def step_in_back(self, thread: int) -> Stop:
        """Go back to the previous statement of a thread, also in a function that it called: undoes `step_in`.

        Before its first one there is the start of the run (reason `entry`).
        """
        bound = self._stop.position
        found = self._last(Goal(bound, step=INTO, thread=thread, last=True), bound)
        if found is None:
            return self._to_entry()
        return self._go_to(found.position, replace(found, reason=STEP, text="stepped back"))

    def step_out(self, thread: int) -> Stop:
        """Go on until a thread has left its present function."""
        return self._step(OUT, thread)

    def step_back(self, thread: int) -> Stop:
        """Go back to the previous statement of a thread, over calls; at its first one to that of its caller.

        Before the first statement of a thread there is the statement that started it, and the start of the run
        (reason `entry`).
        """
        bound = self._stop.position
        if bound.kind == AT_END:
            found = self._last_of_all(bound)
        else:
            functions, depth = self._engine.functions_of(thread)
            goal = Goal(bound, step=OVER, thread=thread, depth=depth, last=True, functions=functions)
            found = self._last(goal, bound) if functions else None
            if found is None:
                found = self._last_of_all(bound)
        if found is None:
            return self._to_entry()
        return self._go_to(found.position, replace(found, reason=STEP, text="stepped back"))

    def reverse(self) -> Stop:
        """Go back to the last hit of a breakpoint or filter before the present stop; to the start if there is none."""
        bound = self._stop.position
        found = self._last(Goal(bound, heeds=True, last=True), bound)
        if found is None:
            return self._to_entry()
        return self._go_to(found.position, found)

    def run_to(self, position: Position) -> Stop:
        """Go to a position, back or forth, without heed of breakpoints."""
        return self._go_to(position, None)

    def run_to_tick(self, tick: int) -> Stop:
        """Go to the moment behind a tick, back or forth, without heed of breakpoints."""
        here = self._engine.position
        if here.kind == AFTER_TICK and here.tick == tick:
            return self._stop
        is_back = tick < here.tick or (tick == here.tick and here.kind == AT_END)
        if not self._rules.count_hits and self._snapshots.tick_before(tick) > (-1 if is_back else here.tick):
            self._replace_engine(self._engine_from(self._snapshots.before_tick(tick)))
        elif is_back:
            self._replace_engine(self._new_engine(is_heard=True))
        stop = self._engine.run(Goal(Position(0, 0, tick, AFTER_TICK)))
        return self._arrived(stop)

    def run_to_time(self, time_s: float) -> Stop:
        """Go to a time in seconds; see `run_to_tick`."""
        return self.run_to_tick(max(0, ticks_for(time_s)))

    def last_pass(self, line: int, *, text: str = "") -> Stop:
        """Go back to the last time that a line of a text was about to run; see `set_breakpoints`.

        Raises:
            DebugError: it has not run before.
        """
        numbers = self._numbers_at(line, text)
        bound = self._stop.position
        found = self._last(Goal(bound, numbers=numbers, last=True), bound) if numbers else None
        if found is None:
            raise DebugError(f"line {line} has not run before")
        return self._go_to(found.position, found)

    def restart(self, *, stop_on_entry: bool = False) -> Stop:
        """Begin again, without the changes that the user has made."""
        self._snapshots.forget_from(Position(0, 0, 0, BEFORE_STATEMENT))
        self._inputs.clear()
        self._heard = 0
        self._logged = None
        self._furthest = Position(0, 0, 0, BEFORE_STATEMENT)
        self._rules = replace(self._rules, said=frozenset(), given_up=frozenset())
        self._replace_engine(self._new_engine(is_heard=True))
        return self._to_entry() if stop_on_entry else self.resume()

    def pause(self) -> None:
        """Let the run that goes on stop at its next statement or tick. Called from any thread or signal handler."""
        self._is_pausing = True
        self._engine.pause()

    def close(self) -> None:
        """Drop the run."""
        if not self._is_closed:
            self._is_closed = True
            self._engine.close()
            self._snapshots.close()

    # ---------------------------------------------------------------- breakpoints

    def set_breakpoints(
        self, requests: Sequence[LineBreakpoint], *, text: str = "", group: str = ""
    ) -> tuple[BreakpointState, ...]:
        """Replace the breakpoints of lines of one text.

        Args:
            requests: in their order.
            text: its name, as `Frame.source`; that of the program if empty.
            group: of breakpoints that replace each other, where a text has several, as those set in another file.
        """
        rules, states = [], []
        for request in requests:
            rule, state = self._line_rule(request, self._rows(text))
            rules += [rule] if rule is not None else []
            states.append(state)
        self._lines[text or self._source.name, group] = rules
        self._set_rules()
        return tuple(states)

    def set_function_breakpoints(
        self, requests: Sequence[FunctionBreakpoint], *, are_known: bool = False
    ) -> tuple[BreakpointState, ...]:
        """Replace the breakpoints of functions and commands.

        A name that is an expression, such as `tcp.z < 0.1`, stops when it becomes true, as a data breakpoint does:
        editors let people type the names of functions, but not what data breakpoints watch.

        Args:
            requests: in their order.
            are_known: whether the first ones are those that are set, as they are; what was said of them is not again.
        """
        before: list[CodeRule | DataRule] = [*self._functions, *self._typed]
        self._functions, self._typed, states = [], [], []
        for request in requests:
            if _NAME.fullmatch(request.name.strip()):
                rule, state = self._function_rule(request)
                self._functions += [rule] if rule is not None else []
            else:
                watched = DataBreakpoint(request.name, request.condition, request.hit_condition)
                typed, state = self._data_rule(watched)
                self._typed += [typed] if typed is not None else []
            states.append(state)
        if are_known:
            self._keep_said(before)
        self._set_rules()
        return tuple(states)

    def _keep_said(self, before: Sequence[CodeRule | DataRule]) -> None:
        """Give breakpoints of functions that are set anew what was said of the same ones before."""
        numbers = {_without_number(rule): rule.id for rule in before}
        rows: list[CodeRule | DataRule] = [*self._functions, *self._typed]
        now = [(rule.id, numbers.get(_without_number(rule), 0)) for rule in rows]
        rules = self._rules
        said = rules.said | {number for number, known in now if known in rules.said}
        given_up = rules.given_up | {number for number, known in now if known in rules.given_up}
        self._rules = replace(rules, said=said, given_up=given_up)

    def set_data_breakpoints(self, requests: Sequence[DataBreakpoint]) -> tuple[BreakpointState, ...]:
        """Replace the data breakpoints."""
        self._data, states = [], []
        for request in requests:
            rule, state = self._data_rule(request)
            self._data += [rule] if rule is not None else []
            states.append(state)
        self._set_rules()
        return tuple(states)

    def _data_rule(self, request: DataBreakpoint) -> tuple[DataRule | None, BreakpointState]:
        identity = self._new_id()
        try:
            checked(request)
            watch = self._watch(request.data_id)
        except DebugError as error:
            return None, BreakpointState(identity, False, str(error))
        rule = DataRule(identity, watch.data_id, request.condition.strip(), request.hit_condition)
        return rule, BreakpointState(identity, True)

    def _watch(self, data_id: str) -> Watch:
        """Return what a data breakpoint watches.

        Raises:
            DebugError: that can never be there: a name that is misspelt, or of a local variable.
        """
        watch = Watch(data_id)
        names = watch.variables
        if not names:
            return watch
        known, local = self._names
        if watch.stops_when_true:
            # A local variable hides a value of the robot: the condition would be about another one than is meant.
            names -= (ROBOT_VALUES.keys() - local) | SIGNALS.keys()
        for name in sorted(names - known):
            if name in local:
                raise DebugError(f"{name} is a local variable: only program globals and signals are watched")
            if name in ROBOT_VALUES:
                raise DebugError(f"{name} is a value of the robot: write an expression of it, such as tcp.z < 0.1")
            near = did_you_mean(name, known | SIGNALS.keys())
            raise DebugError(f"there is no program global or signal {name!r}{near}")
        return watch

    @cached_property
    def _names(self) -> tuple[frozenset[str], frozenset[str]]:
        """The names of program globals, and of other variables; a long text takes a second."""
        return _global_names([(text.name, text.text) for text in self._texts])

    def set_exception_filters(self, filters: Sequence[str]) -> None:
        """Replace the filters: `alarm`, `warning`. At first there is `alarm`.

        Raises:
            DebugError: no such filter.
        """
        for name in filters:
            if name not in EXCEPTION_FILTERS:
                raise DebugError(f"there are the filters {', '.join(EXCEPTION_FILTERS)}, not {name!r}")
        self._filters = frozenset(filters)
        self._set_rules()

    def breakpoint_locations(self, line: int, end_line: int = 0, *, text: str = "") -> tuple[Place, ...]:
        """Return the statements that begin in lines of a text, the last one included; see `set_breakpoints`."""
        last = max(line, end_line)
        places = (Place(row.line, row.column, row.end_line, row.end_column) for row in self._rows(text))
        return tuple(dict.fromkeys(place for place in places if line <= place.line <= last))

    def data_breakpoint_info(self, name: str, reference: int = 0, frame: int = 0) -> DataInfo:
        """Return what a data breakpoint can watch.

        Args:
            name: a name, or an expression.
            reference: of the scope or value of which `name` is a child; 0 for an expression.
            frame: in which it was shown.
        """
        try:
            if reference:
                data_id = self._engine.child(reference, name).data_id
                if not data_id:
                    return DataInfo(
                        None, f"{name} cannot be watched: only signals, program globals, robot mode, safety"
                    )
            else:
                data_id = name
            watch = self._watch(data_id)
        except DebugError as error:
            return DataInfo(None, str(error))
        return DataInfo(watch.data_id, f"{watch.data_id} becomes true" if watch.stops_when_true else watch.data_id)

    # ---------------------------------------------------------------- looking

    @property
    def stop(self) -> Stop:
        """The present stop."""
        return self._stop

    @property
    def problems(self) -> tuple[Diagnostic, ...]:
        """What was found in the program before it began."""
        return self._source.problems

    @property
    def furthest(self) -> Position:
        """The furthest position of this branch of history that was reached."""
        return self._furthest

    def threads(self) -> tuple[ThreadInfo, ...]:
        """Return the script threads in the order of their start."""
        return self._engine.threads()

    def stack(self, thread: int) -> tuple[Frame, ...]:
        """Return the calls of a thread, the innermost one first; empty before it has begun.

        Raises:
            DebugError: no such thread.
        """
        return self._engine.stack(thread)

    def scopes(self, frame: int) -> tuple[Scope, ...]:
        """Return the scopes of a frame: `Locals`, `Globals`, `Robot`. With frame 0 without `Locals`."""
        return self._engine.scopes(frame)

    def variables(self, reference: int, *, kind: str = "", start: int = 0, count: int = 0) -> tuple[Variable, ...]:
        """Return what a scope or a value holds.

        Args:
            reference: of the scope or value.
            kind: `named` or `indexed`; both if empty.
            start: index of the first one.
            count: how many; if 0, those that there is room for. What is left out is counted in a last row.
        """
        return self._engine.variables(reference, kind, start, count)

    def evaluate(self, text: str, frame: int = 0, *, may_change: bool = False) -> Variable:
        """Return the value of an expression.

        Args:
            text: an expression; with `may_change` also statements.
            frame: whose variables it sees; 0 for program globals alone.
            may_change: let it change the program and the robot; a change begins a new branch of history.

        Raises:
            DebugError: it has no value, or would change something.
        """
        try:
            return self._engine.evaluate(text, frame)
        except DebugError:
            if not may_change:
                raise
        return self._changed(Input(self._stop.position, *self._engine.place_of(frame), "", text), text)

    def set_variable(self, reference: int, name: str, text: str) -> Variable:
        """Set a child of a scope or of a value to the value of an expression; begins a new branch of history."""
        expression, place = self._engine.expression_of(reference, name)
        return self._changed(Input(self._stop.position, *place, expression, text), name)

    def set_expression(self, target: str, text: str, frame: int = 0) -> Variable:
        """Assign the value of an expression to a variable, an item or a signal; begins a new branch of history."""
        return self._changed(Input(self._stop.position, *self._engine.place_of(frame), target, text), target)

    def set_signal(self, name: str, text: str) -> Variable:
        """Set an input, output or register of the robot; begins a new branch of history."""
        return self.set_expression(name, text)

    def state(self) -> State:
        """Return the robot at this moment."""
        return self._engine.state()

    def picture(self) -> Picture:
        """Return what a page shows of this moment. At the same time the arm is always in the same place.

        That is where the row of a trace has it, behind the motion of the tick. Before a statement, in the middle of a
        tick, that is not known yet: another execution, or a copy of this one, goes on to there.
        """
        picture = self._engine.picture()
        if self._engine.position.kind not in (BEFORE_STATEMENT, IN_STATEMENT):
            return picture
        engine = self._snapshots.copy_of(self._engine) or self._new_engine()
        try:
            engine.run(Goal(Position(0, 0, picture.tick, AFTER_TICK)))
            later = engine.picture()
        finally:
            engine.close()
        return replace(picture, joints=later.joints, tcp_pose=later.tcp_pose)

    # ---------------------------------------------------------------- history

    def history(self, name: str, *, function: str = "") -> tuple[Change, ...]:
        """Return every change of a variable or signal up to the furthest position of this branch.

        Args:
            name: a signal, a program global, or a variable of `function`.
            function: as `Frame.name`; empty for a global, a signal, or a variable of the program's body.
        """
        engine = self._new_engine()
        try:
            return engine.changes(name, function, self._furthest)
        finally:
            engine.close()

    def function_of(self, frame: int, name: str) -> str:
        """Return the function whose local variable a name is in a frame, as `history` takes it; empty for none."""
        return self._engine.function_of(frame, name)

    def passes(self, line: int, *, text: str = "") -> tuple[Position, ...]:
        """Return every moment at which a line was about to run, up to the furthest position of this branch."""
        numbers = self._numbers_at(line, text)
        if not numbers:
            return ()
        engine = self._new_engine()
        try:
            engine.run(Goal(self._furthest, numbers=numbers, collects=True))
            return tuple(engine.collected)
        finally:
            engine.close()

    def who_changed(self, name: str, *, function: str = "") -> Change | None:
        """Return the last change of a variable or signal before the present stop; `run_to(change.cause)` goes there."""
        here = self._stop.position
        engine = self._new_engine()
        try:
            found = engine.changes(name, function, here)
        finally:
            engine.close()
        return found[-1] if found else None

    # ---------------------------------------------------------------- internal

    def _new_engine(self, *, is_heard: bool = False) -> Engine:
        return self._snapshots.first(
            lambda hear: Engine(self._source, self._rules, self._inputs, hear), is_heard=is_heard
        )

    @property
    def _can_be_plain(self) -> bool:
        """Whether nothing can stop the run but an event of a filter, and it has not begun."""
        rules = self._rules
        return self._engine.count <= 1 and not (rules.code or rules.data or self._inputs or self._engine.is_over)

    def _run_plainly(self, filters: frozenset[str]) -> Stop:
        """Run without counting, at full speed; come to a stop before the end once more, with all counted."""
        rules = Rules(filters=filters)
        engine = Engine(self._source, rules, (), self._hear, is_counted=False)
        self._replace_engine(engine)
        stop = engine.run(Goal(heeds=True))
        assert stop is not None
        if stop.result:
            return self._arrived(stop)
        self._is_pausing = False
        again = self._new_engine()
        self._replace_engine(again)
        arrived = again.run(Goal(stop.position))
        assert arrived is not None
        return self._arrived(replace(arrived, reason=stop.reason, text=stop.text))

    def _run_in_company(self) -> Stop:
        """Run counted, so that there are snapshots at an alarm and a pause; an uncounted run may end it earlier."""
        rules = self._rules
        engine, stop = self._snapshots.run(
            self._engine, Goal(heeds=True), lambda hear: _heard(Engine(self._source, rules, (), hear, is_counted=False))
        )
        if engine is not self._engine:
            self._replace_engine(engine)
        return self._arrived(stop)

    def _replace_engine(self, engine: Engine) -> None:
        self._engine.close()
        self._engine = engine
        engine.is_heard = True
        if self._is_pausing:
            engine.pause()

    def _hear(self, number: int, output: Output) -> None:
        """Pass on what the run says for the first time on this branch."""
        if self._on_output is None:
            return
        if number == 0:
            if self._logged is None or self._logged.is_before(output.position):
                self._logged = output.position
                self._on_output(output)
        elif number > self._heard:
            self._heard = number
            self._on_output(output)

    def _arrived(self, stop: Stop | None) -> Stop:
        assert stop is not None
        self._is_pausing = False
        self._stop = stop
        self._say_unevaluated(stop)
        if self._furthest.is_before(stop.position):
            self._furthest = stop.position
        return stop

    def _say_unevaluated(self, stop: Stop) -> None:
        """Say of each breakpoint that cannot be evaluated why it has stopped; it does not again."""
        if not stop.unevaluated:
            return
        if self._on_output is not None:
            names = {thread.id: thread.name for thread in self._engine.threads()}
            name = names.get(stop.thread, "")
            for item in stop.unevaluated:
                self._on_output(Output("important", item.text, stop.line, name, stop.position, stop.time_s))
        said = self._rules.said | {item.breakpoint for item in stop.unevaluated}
        given_up = self._rules.given_up | {item.breakpoint for item in stop.unevaluated if item.is_given_up}
        self._rules = replace(self._rules, said=said, given_up=given_up)
        self._engine.set_rules(self._rules)

    def _to_entry(self) -> Stop:
        """Go to the stop before the first statement."""
        if self._engine.count > 0 or self._engine.is_over:
            self._replace_engine(self._new_engine())
        stop = self._engine.run(Goal(Position(1, 0, 0, BEFORE_STATEMENT)))
        assert stop is not None
        return self._arrived(replace(stop, reason=ENTRY, text="the start of the run") if not stop.result else stop)

    def _go_to(self, position: Position, stop: Stop | None) -> Stop:
        """Go to a position; the stop is that one, or says that it was gone to."""
        here = self._engine.position
        if here != position:
            if not here.is_before(position):
                self._replace_engine(self._engine_before(position))
            arrived = self._engine.run(Goal(position))
        else:
            arrived = self._stop
        assert arrived is not None
        if stop is not None and arrived.position == stop.position:
            arrived = stop
        return self._arrived(arrived)

    def _engine_before(self, position: Position) -> Engine:
        """Return an engine that stands before a position: a copy of one that came by there, or one at the start."""
        return self._engine_from(None if self._rules.count_hits else self._snapshots.before(position))

    def _engine_from(self, near: tuple[Engine, Position] | None) -> Engine:
        """Return the engine of a copy, with the present rules and inputs; one at the start if there is none."""
        if near is None:
            return self._new_engine(is_heard=True)
        engine, at = near
        engine.set_rules(self._rules)
        engine.set_inputs([change for change in self._inputs if at.is_before(change.position)])
        engine.is_heard = True
        return engine

    def _step(self, kind: str, thread: int) -> Stop:
        if self._engine.is_over:
            return self._stop
        self._count_hits_again()
        _, depth = self._engine.functions_of(thread)
        return self._arrived(self._engine.run(Goal(heeds=True, step=kind, thread=thread, depth=depth)))

    # ---------------------------------------------------------------- back

    def _last(self, goal: Goal, bound: Position) -> Stop | None:
        """Return where a goal would last have stopped before a position: first looked for shortly before it."""
        width = WINDOW if not self._snapshots.forks else WINDOW_OF_SNAPSHOTS
        end = self._count_at_end() if bound.kind == AT_END else bound.statement
        while True:
            start = 0 if self._rules.count_hits and goal.heeds else max(0, end - width)
            if start > 0 and width in (WINDOW, WINDOW_OF_SNAPSHOTS):
                near = self._snapshots.nearest(bound)
                if end - _WIDE_ENOUGH * width <= near < end:
                    start = max(0, near)
            engine = self._engine_before(Position(start + 1, 0, 0, BEFORE_STATEMENT))
            engine.is_heard = False
            try:
                if start > engine.count:
                    engine.run(Goal(Position(start, 0, 0, BEFORE_STATEMENT)))
                    self._snapshots.keep(engine)
                found = engine.run(goal)
            finally:
                engine.close()
            if found is not None or start <= 0:
                self._snapshots.thin(bound)
                return found
            width *= _WIDER

    def _count_at_end(self) -> int:
        """Return how many statements the whole run has."""
        if self._engine.is_over and self._engine.is_counted:
            return self._engine.count
        engine = self._new_engine()
        try:
            engine.run(Goal())
            return engine.count
        finally:
            engine.close()

    def _last_of_all(self, bound: Position) -> Stop | None:
        """Return the last statement of any thread before a position."""
        everything = frozenset(row.number for text in self._texts for row in text.probes.statements)
        return self._last(Goal(bound, numbers=everything, last=True), bound)

    # ---------------------------------------------------------------- changes

    def _changed(self, change: Input, name: str) -> Variable:
        """Make a change here, and begin a new branch of history."""
        if self._engine.is_over:
            raise DebugError("the run is over: go back to change something")
        if self._snapshots.forks and self._source.may_connect(change.text):
            self._leave_copies()
        handles, heard, requests = self._engine.handles(), self._heard, self._source.requests
        # What it says itself is new, also where an earlier branch has said something.
        self._heard = self._engine.outputs
        try:
            value = self._engine.change(change, name)
        except DebugError:
            self._heard = heard
            self._source.forget_requests(requests)
            self._again()
            self._engine.show_again(handles)
            raise
        here = change.position
        self._inputs = [*(item for item in self._inputs if not here.is_before(item.position)), change]
        self._furthest = here
        self._heard = self._engine.outputs
        self._logged = here
        self._engine.set_inputs(())
        self._snapshots.forget_from(here)
        return value

    def _leave_copies(self) -> None:
        """Go on in this process: copies would share a connection, or make it anew."""
        handles = self._engine.handles()
        self._snapshots.close()
        self._snapshots = snapshots(self._hear, forks=False)
        self._again()
        self._engine.show_again(handles)
        if self._on_output is not None:
            self._on_output(Output("console", REAL_NETWORK, 0, "", self._stop.position, self._stop.time_s))

    def _again(self) -> None:
        """Come to the present stop anew, since something has been done that does not count."""
        position = self._stop.position
        self._replace_engine(self._engine_before(position))
        self._engine.run(Goal(position))

    # ---------------------------------------------------------------- rules

    def _new_id(self) -> int:
        self._next_id += 1
        return self._next_id - 1

    def _set_rules(self) -> None:
        lines = [rule for rules in self._lines.values() for rule in rules]
        code, data = (*lines, *self._functions), (*self._data, *self._typed)
        # Breakpoints that are set again have new numbers.
        self._rules = Rules(code, data, self._filters, self._rules.said, self._rules.given_up)
        self._engine.set_rules(self._rules)
        self._has_stale_hits = self._rules.count_hits and self._engine.count > 0

    def _count_hits_again(self) -> None:
        """Run again up to here, so that hits are counted from the start of the run."""
        if self._has_stale_hits:
            self._has_stale_hits = False
            self._again()

    def _numbers_at(self, line: int, text: str = "") -> frozenset[int]:
        rows = [row for row in self._rows(text) if row.line == line]
        return frozenset(row.number for row in rows if row.column == rows[0].column)

    def _rows(self, text: str = "") -> list[CountedStatement]:
        """Return the statements of a text, as often as it was compiled; those of the program if it has no name."""
        name = text or self._source.name
        same = {known.text for known in self._texts if known.name == name}
        return [row for known in self._texts if known.text in same for row in known.probes.statements]

    def _line_rule(
        self, request: LineBreakpoint, rows: Sequence[CountedStatement]
    ) -> tuple[CodeRule | None, BreakpointState]:
        identity = self._new_id()
        below = [row for row in rows if row.line >= request.line]
        if not below:
            return None, BreakpointState(identity, False, "there is no statement in this line or below it")
        try:
            checked(request)
        except DebugError as error:
            return None, BreakpointState(identity, False, str(error))
        first = min(row.line for row in below)
        same = [row for row in below if row.line == first]
        row = same[0]
        if request.column and first == request.line:
            row = next((item for item in same if item.column >= request.column), same[-1])
        rule = CodeRule(
            identity,
            BREAKPOINT,
            frozenset(item.number for item in same if item.column == row.column),
            request.condition.strip(),
            request.hit_condition,
            request.log_message,
        )
        return rule, BreakpointState(identity, True, "", row.line, row.column, row.end_line, row.end_column)

    def _function_rule(self, request: FunctionBreakpoint) -> tuple[CodeRule | None, BreakpointState]:
        identity = self._new_id()
        name = request.name.strip().removesuffix("()")
        functions = [function for text in self._texts for function in text.probes.functions]
        own = [function for function in functions if name in (function.name, function.name.rpartition(".")[2])]
        try:
            checked(request)
        except DebugError as error:
            return None, BreakpointState(identity, False, str(error))
        numbers = frozenset(function.number for function in own if function.number >= 0)
        line = own[0].line if own else 0
        if not own:
            if CATALOGUE.get(name) is None:
                return None, BreakpointState(identity, False, f"there is no function or command {name!r}")
            for text in self._texts:
                numbers |= calls_by_statement(text.name, text.text, text.probes.statements).get(name, frozenset())
        if not numbers:
            return None, BreakpointState(identity, False, f"no statement of the program calls {name!r}")
        rule = CodeRule(identity, FUNCTION_BREAKPOINT, numbers, request.condition.strip(), request.hit_condition)
        return rule, BreakpointState(identity, True, "", line)


def _heard(engine: Engine) -> Engine:
    engine.is_heard = True
    return engine


def _without_number(rule: CodeRule | DataRule) -> CodeRule | DataRule:
    return replace(rule, id=0)


def _global_names(texts: Iterable[tuple[str, str]]) -> tuple[frozenset[str], frozenset[str]]:
    """Return the names of program globals in texts, and of their other variables.

    A name that is bound nowhere in its text may have got its value before the start.
    """
    found: set[str] = set()
    local: set[str] = set()
    for name, text in texts:
        symbols = Symbols(parse(SourceFile(name, text)))
        found |= symbols.global_names
        for scope in symbols.scopes:
            local |= scope.bindings.keys()
            free = {read for read in scope.reads if scope.resolve(read) is Resolution.BUILTIN}
            found |= {read for read in free if CATALOGUE.get(read) is None}
    return frozenset(found), frozenset(local)
