"""Runs a source forward, from its beginning, to counted places; shows it where it stands.

An engine knows no way back: a session goes back with another engine, or with a copy that was made earlier. What it
takes and returns are frozen records, so that it may live in another process.

The run is in a `Freezer`: the hook before a statement, a listener of events and the end of a tick freeze it in the
middle of whatever it does. Of statements that do not stop the engine learns nothing; it loads as many true values into
the list of steps as may run at once, and the entries of statements that it is interested in lead to a list of false
ones (`language.probes`).
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Sequence
from typing import Any, Final

from elitescript.debugger.api import (
    AFTER_TICK,
    ALARM_FILTER,
    ALL,
    AT_END,
    BEFORE_STATEMENT,
    BREAKPOINT,
    DATA_BREAKPOINT,
    END,
    EXCEPTION,
    GOTO,
    IN_STATEMENT,
    PAUSE,
    STEP,
    WARNING_FILTER,
    Change,
    ExceptionInfo,
    Frame,
    Output,
    Picture,
    Position,
    Scope,
    State,
    Stop,
    ThreadInfo,
    Unevaluated,
    Variable,
)
from elitescript.debugger.inputs import Input, apply_input
from elitescript.debugger.looking import RESULT, CallFrame, Look, Names
from elitescript.debugger.places import CountedText, Places
from elitescript.debugger.rules import (
    NO_RULES,
    CodeRule,
    DataRule,
    Rules,
    Watch,
    hit_condition,
    unevaluated,
)
from elitescript.debugger.source import Source
from elitescript.debugger.telling import exception_of, filled, logged, output_of, running_text
from elitescript.debugger.values import shown, type_name
from elitescript.errors import DebugError
from elitescript.language.compiler import CompiledUnit
from elitescript.language.hooks import STEP as STEP_HOOK
from elitescript.language.hooks import STEPS as STEPS_HOOK
from elitescript.language.options import Options
from elitescript.language.probes import STEPS_PROBES
from elitescript.language.text.source import SourceFile
from elitescript.messages.events import (
    Alarm,
    Event,
    RobotModeChanged,
    SafetyModeChanged,
    SignalChanged,
    Warned,
)
from elitescript.messages.timing import seconds
from elitescript.records import record, replace
from elitescript.runtime.threads.strand import Freezer, Strand
from elitescript.values.concrete import TooLong, short

LOAD_MAX: Final = 2000
"""Statements that run without a look at the goal; few enough for snapshots at regular intervals."""
_LOOSE: Final = 100_000
"""Statements that may run uncounted, in changes of the user and while a run is dropped."""
_TRAPS: Final = (False,) * 1000
_GO: Final = (1).__bool__
"""What a statement calls that goes on."""

OVER: Final = "over"
INTO: Final = "into"
OUT: Final = "out"


@record
class Goal:
    """How far a run goes.

    Attributes:
        position: goes no further; None for the end.
        heeds: whether breakpoints and filters stop it.
        step: `over`, `into` or `out`; empty for none.
        thread: that steps.
        depth: calls above the outermost one of that thread, where the step begins; -1 before it has begun.
        line: stops before statements of these numbers, of any thread.
        last: does not stop, but remembers where it last would have stopped before `position`.
        collects: does not stop before `numbers`, but remembers all positions.
        functions: those on the stack of the thread that steps, as file and qualified name; found out if empty.
    """

    position: Position | None = None
    heeds: bool = False
    step: str = ""
    thread: int = 0
    depth: int = 0
    numbers: frozenset[int] = frozenset()
    last: bool = False
    collects: bool = False
    functions: frozenset[tuple[str, str]] = frozenset()


class Engine:
    """One execution of a source, which is let go on and looked at.

    Args:
        source: what runs.
        rules: breakpoints.
        inputs: what the user has changed, in the order of the history.
        on_output: receives what it says, with its number in the history; 0 for log messages of breakpoints.
        is_counted: whether it counts statements. If not, it is as fast as a run without a debugger, and can only be
            stopped behind ticks, at events and at the end.

    Attributes:
        outputs: how much it has said.
        is_heard: whether `on_output` is called.
        collected: see `Goal.collects`.
        count: statements that have begun, with the next one at a stop before it.
        is_counted: see above.
        pulse: called now and then between two statements of a run that goes on.
        is_pulse_due: asked behind each tick whether it is to be called.
    """

    def __init__(
        self,
        source: Source,
        rules: Rules = NO_RULES,
        inputs: Sequence[Input] = (),
        on_output: Callable[[int, Output], None] | None = None,
        *,
        is_counted: bool = True,
    ) -> None:
        self._rules = rules
        self._inputs = list(inputs)
        self._on_output = on_output
        self.is_counted = is_counted
        self.outputs = 0
        self.is_heard = False
        self.pulse: Callable[[], None] | None = None
        self.is_pulse_due: Callable[[], bool] | None = None
        self._events = 0
        self._base = 0
        self._loaded = 0
        self._steps: list[bool] = [False]
        self._trap: list[bool] = list(_TRAPS)
        self._table: list[Callable[[], bool]] = []
        self._traps: frozenset[int] | None = frozenset()
        """Statements of interest; None for all."""
        self.places = Places()
        self._kind = ""
        self._number = -1
        self._strand: Strand | None = None
        self._is_pausing = False
        self._is_soon = False
        self._result = ""
        self._exception: ExceptionInfo | None = None
        self._error: BaseException | None = None
        self._goal = Goal()
        self._found: Stop | None = None
        self._candidates: frozenset[int] = frozenset()
        self._hits: dict[int, int] = {}
        self._conditions: dict[int, Callable[[int], bool]] = {}
        self._slow: dict[int, DebugError] = {}
        """Of breakpoints whose condition took too long since the run goes on, by their numbers."""
        self._watches: list[tuple[DataRule, Watch]] = []
        self._values: list[str] = []
        self._cause: tuple[int, str, int] = (0, "", 0)
        """Thread, name and line of the last change of a signal."""
        self._begun: dict[int, tuple[int, int]] = {}
        """Of each thread the count and the number of its last statement, as far as all are looked at."""
        self._last_strand: Strand | None = None
        self._freezes = False
        self._is_changing = False
        self._step_has_ended = False
        self._recorder: Recorder | None = None
        self.collected: list[Position] = []
        self.execution = source.begin(
            self if is_counted else None, on_event=self._event, after_tick=self._after_tick, next_stop=self._next_stop
        )
        self._controller = self.execution.controller
        self._scheduler = self.execution.host.scheduler
        self._freezer = Freezer(self.execution.run)
        self.set_rules(rules)
        self._look = self._new_look()

    # ---------------------------------------------------------------- the probe of its robot

    def options(self, options: Options, source: SourceFile) -> Options:
        """See `runtime.probe.Probe`."""
        return replace(options, probes=STEPS_PROBES, first_probe=len(self._table))

    def compiled(self, unit: CompiledUnit) -> None:
        """See `runtime.probe.Probe`."""
        self.places.add(unit)
        entry = self._trap.pop if self._traps is None else self._steps.pop
        self._table += [entry] * unit.probes.size
        self._keep_pause()

    def hooks(self) -> dict[str, object]:
        """See `runtime.probe.Probe`."""
        return {STEPS_HOOK: self._table, STEP_HOOK: self._freezer.freeze}

    # ---------------------------------------------------------------- reading

    @property
    def count(self) -> int:
        """Statements that have begun."""
        return self._base + self._loaded + 1 - len(self._steps)

    @property
    def position(self) -> Position:
        """Where it stands."""
        count = ALL if self._kind == AT_END else self.count
        return Position(count, self._events, self._controller.tick, self._kind or AFTER_TICK)

    @property
    def is_over(self) -> bool:
        """Whether the run has ended."""
        return self._freezer.is_over

    def state(self) -> State:
        """See `DebugSession.state`."""
        state = self._controller.state()
        return State(state.time_s, state.tick, state.q_target, state.tcp_pose_target)

    def picture(self) -> Picture:
        """See `DebugSession.picture`; in the middle of a tick the arm is where it was behind the last one."""
        controller, look = self._controller, self._look
        tick = controller.tick
        q = controller.joints_at(tick + (self._kind != BEFORE_STATEMENT)).q_target
        threads = look.threads()
        calls = [look.calls(look.strand(thread.id)) for thread in threads]
        values = self.execution.host.monitor().items()
        return Picture(
            seconds(tick),
            tick,
            next((thread.line for thread in threads if not thread.is_secondary), 0),
            q,
            controller.tcp_pose(q),
            tuple(Variable(name, shown(value), type_name(value)) for name, value in values),
            tuple(controller.non_default_signals().items()),
            threads,
            tuple(self.places.function_name(stack[0].frame.f_code.co_qualname) if stack else "" for stack in calls),
        )

    def threads(self) -> tuple[ThreadInfo, ...]:
        """See `DebugSession.threads`."""
        return self._look.threads()

    def stack(self, thread: int) -> tuple[Frame, ...]:
        """See `DebugSession.stack`."""
        return self._look.stack(thread)

    def scopes(self, frame: int) -> tuple[Scope, ...]:
        """See `DebugSession.scopes`."""
        return self._look.scopes(frame)

    def variables(self, reference: int, kind: str, start: int, count: int) -> tuple[Variable, ...]:
        """See `DebugSession.variables`."""
        return self._look.variables(reference, kind, start, count)

    def child(self, reference: int, name: str) -> Variable:
        """Return the child of a scope or a value by its name."""
        return self._look.child(reference, name)

    def evaluate(self, text: str, frame: int) -> Variable:
        """Return the value of an expression, without any effect; see `DebugSession.evaluate`."""
        look = self._look
        call = look.call(frame)
        return look.variable(text, look.value(text, call), call, text, way=(RESULT, text, frame))

    def place_of(self, frame: int) -> tuple[int, int]:
        """Return thread and depth of a frame; twice 0 for frame 0."""
        return _place_of(self._look.call(frame))

    def expression_of(self, reference: int, name: str) -> tuple[str, tuple[int, int]]:
        """Return the expression of a child, and thread and depth of the frame in which it is one."""
        expression, call = self._look.expression_of(reference, name)
        return expression, _place_of(call)

    def functions_of(self, thread: int) -> tuple[frozenset[tuple[str, str]], int]:
        """Return the functions on the stack of a thread, as `Goal.functions`, and the depth of its innermost call."""
        calls = self._look.calls(self._look.strand(thread))
        found = frozenset((call.frame.f_code.co_filename, call.frame.f_code.co_qualname) for call in calls)
        return found, len(calls) - 1

    def function_of(self, frame: int, name: str) -> str:
        """See `DebugSession.function_of`."""
        call = self._look.call(frame)
        is_local = call is not None and name in self._look.locals_of(call)
        return self.places.function_name(call.frame.f_code.co_qualname) if call is not None and is_local else ""

    def texts(self) -> tuple[CountedText, ...]:
        """Return what is counted of each text that is known; the program is the first one."""
        return tuple(CountedText(unit.source.name, unit.source.text, unit.probes) for unit in self.places.units)

    def _new_look(self) -> Look:
        return Look(self._controller, self.execution.host, self.places, self._error)

    @property
    def _running(self) -> Strand | None:
        """The thread that runs, where the run stands in one."""
        return self._strand if self._kind in (BEFORE_STATEMENT, IN_STATEMENT) else None

    # ---------------------------------------------------------------- rules

    def set_rules(self, rules: Rules) -> None:
        """Replace the breakpoints. Numbers of hits are those since the start only if they were set there."""
        self._rules = rules
        self._conditions = {rule.id: hit_condition(rule.hit_condition) for rule in rules.code}
        self._conditions |= {rule.id: hit_condition(rule.hit_condition) for rule in rules.data}
        self._watches = [(rule, Watch(rule.data_id)) for rule in rules.data]
        self._values = self._watched()

    def _watched(self) -> list[str]:
        if not self._watches:
            return []
        host = self.execution.host
        names = Names(self._controller, host, self._new_look(), None)
        program = host.program
        globals_ = None if program is None else program.globals
        given_up = self._rules.given_up
        return [
            "" if rule.id in given_up else watch.text(self._controller, globals_, names)
            for rule, watch in self._watches
        ]

    # ---------------------------------------------------------------- going on

    def pause(self) -> None:
        """Stop at the next statement or tick; may be called from any thread."""
        self._is_pausing = True
        self._keep_pause()

    def run(self, goal: Goal) -> Stop | None:
        """Go on until the goal stops it; return the stop. With `last`, go to its position and return the last hit."""
        self._goal, self._found = goal, None
        self._step_has_ended = False
        self._slow.clear()
        if goal.step and goal.step != INTO:
            self._candidates = self._numbers_of_stack(goal)
        if goal.step:
            self._watch_end(goal.thread)
        self._traps = self._interesting(goal)
        self._exception = None
        if goal.heeds:
            self._values = self._watched()
        stop = None
        while stop is None and not self.is_over:
            self._install()
            value = self._go_on()
            if self.is_over:
                self._result = value
                self._kind, self._strand = AT_END, None
                self._collect_pause()
                stop = Stop(END, _END_TEXTS.get(value, value), 0, self.position, self._time_s, result=value)
            else:
                stop = self._stop_at(value)
                if stop is None and self.pulse is not None:
                    self.pulse()
        self._look = self._new_look()
        if stop is None:
            stop = Stop(END, _END_TEXTS.get(self._result, ""), 0, self.position, self._time_s, result=self._result)
        return self._found if goal.last else stop

    @property
    def _time_s(self) -> float:
        return seconds(self._controller.tick)

    def _collect_pause(self) -> None:
        self._is_pausing = False

    def _interesting(self, goal: Goal) -> frozenset[int] | None:
        """Return the statements at which the hook is called; None for all."""
        if self._recorder is not None:
            return None
        found = set(goal.numbers)
        if goal.heeds or self._rules.count_hits:
            if any(watch.is_polled for _, watch in self._watches) and goal.heeds:
                return None
            for rule in self._rules.code:
                found |= rule.numbers
        if goal.step == INTO:
            return None
        if goal.step:
            found |= self._candidates
        return frozenset(found)

    def _numbers_of_stack(self, goal: Goal) -> frozenset[int]:
        if goal.functions:
            return frozenset(self.places.numbers_in(set(goal.functions)))
        calls = self._look.calls(self._look.strand(goal.thread))
        return frozenset(
            self.places.numbers_in({(call.frame.f_code.co_filename, call.frame.f_code.co_qualname) for call in calls})
        )

    def _watch_end(self, thread: int) -> None:
        goal = self._goal

        def ended() -> None:
            if self._goal is goal:
                self._step_has_ended = True
                self._soon()

        if not goal.last:
            self._look.strand(thread).at_end.append(ended)

    def _soon(self) -> None:
        """Have the next statement of any thread call the hook."""
        self._is_soon = True
        self._table[:] = [self._trap.pop] * len(self._table)

    def _keep_pause(self) -> None:
        """Let a pause act that has come, from another thread, before or while the table was filled."""
        if self._is_pausing:
            self._table[:] = [self._trap.pop] * len(self._table)

    def _install(self) -> None:
        take, trap = self._steps.pop, self._trap.pop
        if len(self._trap) < len(_TRAPS) // 2:
            self._trap[:] = _TRAPS
        if self._traps is None or self._is_soon or self._is_pausing:
            self._table[:] = [trap] * len(self._table)
        else:
            self._table[:] = [take] * len(self._table)
            for number in self._traps:
                self._table[number] = trap
        count, load = self.count, LOAD_MAX
        target = self._target_count()
        if target is not None and target > count:
            load = min(load, target - count - 1)
        self._base, self._loaded = count, load
        self._steps[:] = [False, *[True] * load]
        self._keep_pause()

    def _target_count(self) -> int | None:
        """Return the count of the next statement at which the hook has to be called."""
        counts = [
            position.statement
            for position in (self._goal.position, self._inputs[0].position if self._inputs else None)
            if position is not None and position.kind == BEFORE_STATEMENT and position.statement > self.count
        ]
        return min(counts, default=None)

    def _go_on(self) -> Any:
        if self._recorder is None and self._traps is not None:
            self._begun.clear()
        strand = self._strand
        self._kind, self._strand, self._number, self._error = "", None, -1, None
        self._freezes = True
        try:
            return self._freezer.go_on(strand, _GO)
        finally:
            self._freezes = False

    def _stop_at(self, value: Any) -> Stop | None:
        """Return the stop for what the run was frozen with; None if it goes on."""
        if type(value) is int:
            return self._at_statement(value)
        kind, strand, found = value
        self._kind, self._strand = kind, strand
        if kind == AFTER_TICK:
            self._last_strand = None
        return self._decided(found)

    def _at_statement(self, number: int) -> Stop | None:
        if self._steps:
            self._steps.pop()  # a trap does not take the step
        strand = self._scheduler.current
        self._kind, self._strand, self._number = BEFORE_STATEMENT, strand, number
        self._is_soon = False
        previous = self._last_strand
        self._last_strand = strand
        if strand is None:
            return None
        found = []
        if self._recorder is not None:
            self._record(previous)
        if self._is_pausing:
            self._is_pausing = False
            found.append(self._stop(PAUSE, "paused"))
        if self._goal.heeds or self._rules.count_hits:
            found += self._data_stops(previous)
            found += self._code_stops(number, strand)
        goal = self._goal
        if number in goal.numbers and goal.collects:
            self.collected.append(self.position)
        elif number in goal.numbers:
            found.append(self._stop(GOTO, "reached"))
        if goal.step and self._steps_to(strand, number):
            found.append(self._stop(STEP, "stepped"))
        elif self._step_has_ended and goal.step:
            found.append(self._stop(STEP, f"thread {goal.thread} has ended"))
        self._begun[strand.order] = self.count, number
        self._apply_inputs()
        return self._decided(found)

    def _decided(self, found: list[Stop]) -> Stop | None:
        """Return the stop of all that was found; with `last`, only remember it."""
        goal = self._goal
        is_there = goal.position is not None and self._is_at(goal.position)
        if goal.last:
            if found and not is_there:
                self._found = _merged(found)
            return self._stop(GOTO, "") if is_there else None
        if is_there:
            found = [*found, self._stop(GOTO, "reached")]
        return _merged(found) if found else None

    def _is_at(self, position: Position) -> bool:
        here = self.position
        if position.kind == BEFORE_STATEMENT:
            return here.kind == BEFORE_STATEMENT and here.statement >= position.statement
        if position.kind == AFTER_TICK:
            return here.kind == AFTER_TICK and here.tick >= position.tick and here.statement >= position.statement
        return here.kind == position.kind and here.events >= position.events

    def _stop(self, reason: str, text: str, **more: Any) -> Stop:
        strand = self._running
        thread = 0 if strand is None else strand.order + 1
        line = 0
        if strand is not None:
            line = self.places.statement(self._number).line if self._number >= 0 else strand.line
        return Stop(reason, text, thread, self.position, self._time_s, line=line, **more)

    # ---------------------------------------------------------------- steps

    def _steps_to(self, strand: Strand, number: int) -> bool:
        goal = self._goal
        if strand.order != goal.thread - 1:
            return False
        if goal.step == INTO:
            return True
        if number not in self._candidates:
            return False
        depth = _depth(strand)
        return depth <= goal.depth if goal.step == OVER else depth < goal.depth

    # ---------------------------------------------------------------- breakpoints

    def _code_stops(self, number: int, strand: Strand) -> list[Stop]:
        found = []
        for rule in self._rules.code:
            if number not in rule.numbers or rule.id in self._rules.given_up:
                continue
            try:
                if not self._holds(rule, strand) or not self._counts(rule.id):
                    continue
            except DebugError as error:
                what = f"the condition of line {self.places.statement(number).line}"
                found += self._unevaluated(rule, rule.reason, what, rule.condition, error)
                continue
            if rule.log_message:
                if self._goal.heeds and not self._goal.last:
                    self._log(rule, strand)
            elif self._goal.heeds:
                found.append(self._stop(rule.reason, f"{rule.reason} {rule.id}", hits=(rule.id,)))
        return found

    def _counts(self, rule: int) -> bool:
        self._hits[rule] = self._hits.get(rule, 0) + 1
        return self._conditions[rule](self._hits[rule])

    def _holds(self, rule: CodeRule | DataRule, strand: Strand | None) -> bool:
        if not rule.condition:
            return True
        if rule.id in self._slow:
            raise self._slow[rule.id]
        look = self._new_look()
        try:
            return look.holds(rule.condition, self._innermost(look, strand))
        except TooLong as error:
            self._slow[rule.id] = error
            raise

    def _unevaluated(
        self, rule: CodeRule | DataRule, reason: str, what: str, text: str, error: DebugError
    ) -> list[Stop]:
        """Return the stop of a breakpoint that cannot be evaluated; none if it was said. See `rules.unevaluated`."""
        if rule.id in self._rules.said or not self._goal.heeds:
            return []
        text = unevaluated(what, text, error)
        found = Unevaluated(rule.id, text, isinstance(error, TooLong))
        return [self._stop(reason, text, hits=(rule.id,), unevaluated=(found,))]

    @staticmethod
    def _innermost(look: Look, strand: Strand | None) -> CallFrame | None:
        if strand is None:
            return None
        calls = look.calls(strand)
        return calls[0] if calls else None

    def _log(self, rule: CodeRule, strand: Strand) -> None:
        look = self._new_look()
        call = self._innermost(look, strand)
        text = filled(rule.log_message, lambda expression: logged(look, expression, call))
        line = self.places.statement(self._number).line
        source = self.places.unit_of(self._number).source.name
        self._say(Output("console", text, line, strand.name, self.position, self._time_s, source), is_log=True)

    def _data_stops(self, previous: Strand | None) -> list[Stop]:
        if not self._watches:
            return []
        values, before = self._watched(), self._values
        self._values = values
        found = []
        for (rule, watch), old, new in zip(self._watches, before, values, strict=True):
            if rule.id in self._rules.given_up:
                continue
            if watch.error is not None:
                what = "what the data breakpoint watches"
                found += self._unevaluated(rule, DATA_BREAKPOINT, what, watch.data_id, watch.error)
                continue
            if old == new or (watch.stops_when_true and new != "True"):
                continue
            try:
                if not self._holds(rule, self._running) or not self._counts(rule.id):
                    continue
            except DebugError as error:
                what = f"the condition of {short(watch.data_id)}"
                found += self._unevaluated(rule, DATA_BREAKPOINT, what, rule.condition, error)
                continue
            if not self._goal.heeds:
                continue
            change = self._change(watch, old, new, previous)
            by = f" by {change.thread_name}" if change.thread_name else ""
            place = f" in line {change.line}" if change.line else ""
            text = f"{watch.data_id} is true" if watch.stops_when_true else f"{watch.data_id} was {old or 'not there'}"
            text += "" if watch.stops_when_true else f" and is {new or 'not there'}"
            stop = self._stop(DATA_BREAKPOINT, f"{text}{by}{place}", hits=(rule.id,), changes=(change,))
            found.append(stop)
        return found

    def _change(self, watch: Watch, old: str, new: str, previous: Strand | None) -> Change:
        if watch.is_polled:
            return self._caused(watch.data_id, old, new, previous)
        thread, name, line = self._cause
        self._cause = 0, "", 0
        tick = self._controller.tick
        return Change(watch.data_id, old, new, self.position, None, thread, name, line, tick, seconds(tick))

    def _caused(self, name: str, old: str, new: str, previous: Strand | None) -> Change:
        """Return a change by the last statement of the thread that has run since the last look."""
        thread, thread_name, line, cause = 0, "", 0, None
        strand = self._author(name, previous)
        tick = self._controller.tick
        if strand is not None and strand.order in self._begun:
            count, number = self._begun[strand.order]
            thread, thread_name, line = strand.order + 1, strand.name, self.places.statement(number).line
            cause = Position(count, self._events, tick, BEFORE_STATEMENT)
        return Change(name, old, new, self.position, cause, thread, thread_name, line, tick, seconds(tick))

    def _author(self, name: str, previous: Strand | None) -> Strand | None:
        """Return which thread has changed a variable: the last one that began a statement, or one that went on."""
        present = self._strand
        if previous is None and present is not None and present.order in self._begun:
            return present  # it has gone on in this tick
        if present is None or present is previous or previous is None or present.order not in self._begun:
            return previous
        word = re.compile(rf"\b{re.escape(name.split('[')[0].split('.')[0])}\b")
        return present if word.search(self._text_of(present)) and not word.search(self._text_of(previous)) else previous

    def _text_of(self, strand: Strand) -> str:
        if strand.order not in self._begun:
            return ""
        number = self._begun[strand.order][1]
        row = self.places.statement(number)
        source = self.places.unit_of(number).source
        return "\n".join(source.line(line) for line in range(row.line, row.end_line + 1))

    # ---------------------------------------------------------------- ticks and events

    def _next_stop(self, tick: int) -> int | None:
        """Return the next tick that has to run; see `Source.begin`."""
        if not self._freezes:
            return None
        if self._goal.heeds and any(watch.is_of_motion for _, watch in self._watches):
            return tick + 1
        if self._is_pausing:
            return tick + 1
        ticks = [
            position.tick
            for position in (self._goal.position, self._inputs[0].position if self._inputs else None)
            if position is not None and position.kind == AFTER_TICK and position.tick > tick
        ]
        return min(ticks, default=None)

    def _after_tick(self) -> None:
        """Freeze behind a tick that was run, if anything asks for it."""
        if not self._freezes:
            return
        position, watches = self._goal.position, self._watches
        is_wanted = (
            (position is not None and position.kind == AFTER_TICK and self._controller.tick >= position.tick)
            or (self._inputs and self._inputs[0].position.kind == AFTER_TICK)
            or self._is_pausing
            or (watches and self._goal.heeds)
            or (self._recorder is not None)
            or (self.is_pulse_due is not None and self.is_pulse_due())
        )
        if is_wanted:
            self._freezer.freeze((AFTER_TICK, None, self._at_tick()))

    def _at_tick(self) -> list[Stop]:
        self._kind, self._strand = AFTER_TICK, None
        found = []
        if self._recorder is not None:
            self._record(self._last_strand)
        if self._is_pausing:
            self._is_pausing = False
            found.append(self._stop(PAUSE, "paused"))
        if self._goal.heeds:
            found += self._data_stops(self._last_strand)
        self._apply_inputs()
        return found

    def _event(self, event: Event) -> None:
        """Take note of an event; freeze at an alarm or a warning that stops the run."""
        if not self._freezes:
            if self._is_changing and (said := output_of(event, self.position, self._time_s)) is not None:
                self._say(said)
            return
        strand = self._scheduler.current
        if strand is not None and not strand.is_running:
            strand = None
        if isinstance(event, SignalChanged):
            self._signal_changed(event, strand)
            return
        if isinstance(event, RobotModeChanged | SafetyModeChanged) and self._watches:
            self._cause = 0, "", 0
            self._soon()
            return
        is_alarm, is_warning = isinstance(event, Alarm), isinstance(event, Warned)
        if is_alarm or is_warning:
            self._events += 1
        self._kind = IN_STATEMENT if self.is_counted else AFTER_TICK
        output = output_of(event, self.position, self._time_s)
        self._kind = ""
        if output is not None:
            self._say(replace(output, source=running_text(strand)) if output.line and self.is_heard else output)
        if isinstance(event, Alarm | Warned):
            self._freeze_in(event, strand, ALARM_FILTER if is_alarm else WARNING_FILTER)

    def _freeze_in(self, event: Alarm | Warned, strand: Strand | None, kind: str) -> None:
        goal = self._goal
        position, pending = goal.position, self._inputs
        is_hit = goal.heeds and kind in self._rules.filters
        is_target = position is not None and position.kind == IN_STATEMENT and self._events >= position.events
        is_input = bool(pending) and pending[0].position.kind == IN_STATEMENT
        if not (is_hit or is_target or is_input):
            return
        self._kind, self._strand = IN_STATEMENT, strand
        self._error = sys.exception() if strand is not None and isinstance(event, Alarm) else None
        info = exception_of(event)
        if is_input:
            self._apply_inputs()
        found = []
        if is_hit or is_target:
            stop = self._stop(EXCEPTION, info.text, exception=info)
            found.append(replace(stop, line=event.line))
        self._freezer.freeze((IN_STATEMENT, strand, found))

    def _signal_changed(self, event: SignalChanged, strand: Strand | None) -> None:
        recorder = self._recorder
        if recorder is not None and event.name == recorder.signal:
            self._cause = (0, event.by, 0) if strand is None else (strand.order + 1, strand.name, event.line)
        for _, watch in self._watches:
            if watch.data_id == event.name:
                by = (0, event.by, 0) if strand is None else (strand.order + 1, strand.name, event.line)
                self._cause = by
                self._soon()

    def _say(self, output: Output, *, is_log: bool = False) -> None:
        self.outputs += not is_log
        if self._on_output is not None and self.is_heard:
            self._on_output(0 if is_log else self.outputs, output)

    # ---------------------------------------------------------------- history

    def changes(self, name: str, function: str, until: Position) -> tuple[Change, ...]:
        """Run to a position; return all changes of a variable or signal on the way. See `DebugSession.history`."""
        self._recorder = Recorder(name, function)
        try:
            self.run(Goal(until))
            return tuple(self._recorder.changes)
        finally:
            self._recorder = None

    def _record(self, previous: Strand | None) -> None:
        recorder = self._recorder
        assert recorder is not None
        key, new = self._recorded(recorder)
        if key is None:
            return
        if recorder.signal and not recorder.values:
            recorder.values[key] = new
        old = recorder.values.get(key, "")
        if new == old:
            return
        recorder.values[key] = new
        if recorder.signal:
            change = self._signal_change(recorder, old, new)
        else:
            change = self._caused(recorder.name, old, new, previous)
        recorder.changes.append(change)

    def _recorded(self, recorder: Recorder) -> tuple[object, str]:
        """Return whose value it is, and the value as text; None for nobody's."""
        host = self.execution.host
        if recorder.signal:
            return 0, recorder.watch.text(self._controller, None, None)
        program = host.program
        if program is not None and not recorder.function and recorder.name in program.globals.own():
            return 0, shown(program.globals.values[recorder.name])
        if self._strand is None:
            return None, ""
        for call in self._new_look().calls(self._strand):
            code = call.frame.f_code
            name = self.places.function_name(code.co_qualname)
            if name == recorder.function or (not recorder.function and "." not in code.co_qualname):
                found = call.frame.f_locals
                if recorder.name in found:
                    return (self._strand.order, call.depth), shown(found[recorder.name])
        return None, ""

    def _signal_change(self, recorder: Recorder, old: str, new: str) -> Change:
        thread, name, line = self._cause
        self._cause = 0, "", 0
        cause = None
        if thread - 1 in self._begun:
            cause = Position(self._begun[thread - 1][0], self._events, self._controller.tick, BEFORE_STATEMENT)
        tick = self._controller.tick
        return Change(recorder.name, old, new, self.position, cause, thread, name, line, tick, seconds(tick))

    # ---------------------------------------------------------------- changes by the user

    def _apply_inputs(self) -> None:
        """Make the changes that belong here, behind what stops here: the stop came before the user could make them."""
        while self._inputs and self._is_at(self._inputs[0].position):
            self.apply(self._inputs.pop(0))
            self._values = self._watched()

    def set_inputs(self, inputs: Sequence[Input]) -> None:
        """Replace the changes that are to be made later."""
        self._inputs = list(inputs)

    def change(self, change: Input, name: str) -> Variable:
        """Carry out what the user has changed, here; return the value under a name.

        Raises:
            DebugError: it cannot be done; the run may be in between then, and is to be dropped.
        """
        handles = self.handles()
        value = self.apply(change)
        self._look = self._new_look()
        self._look.show_again(handles)
        return self._look.variable(name, value)

    def handles(self) -> Any:
        """Return what the numbers of frames and values stand for at this stop."""
        return self._look.handles()

    def show_again(self, handles: Any) -> None:
        """Give numbers that were shown at this stop by another execution the same meaning."""
        self._look.show_again(handles)

    def apply(self, change: Input) -> Any:
        """Carry out what the user has changed, here; return the value.

        Raises:
            DebugError: it cannot be done; the run may be in between then, and is to be dropped.
        """
        look = self._new_look()
        loose = [True] * _LOOSE
        table, self._table[:] = list(self._table), [loose.pop] * len(self._table)
        fuel = list(self._scheduler.fuel)
        self._is_changing = True
        try:
            return apply_input(change, look, self._controller, self.execution.host)
        finally:
            self._is_changing = False
            self._scheduler.fuel[:] = fuel
            self._table[:] = table

    # ---------------------------------------------------------------- the end

    def close(self) -> None:
        """Drop the run where it stands."""
        self._freezes = False
        loose = [True] * _LOOSE
        self._table[:] = [loose.pop] * len(self._table)
        self._error = None
        self._strand = self._last_strand = None
        self._look = self._new_look()
        self._freezer.drop()
        self.execution.close()


class Recorder:
    """Collects the changes of a variable or signal.

    Args:
        name: of it.
        function: whose variable it is; empty for a signal, a program global or a variable of the body.
    """

    __slots__ = ("changes", "function", "name", "signal", "values", "watch")

    def __init__(self, name: str, function: str) -> None:
        self.watch = Watch(name)
        self.signal = "" if self.watch.is_polled else self.watch.data_id
        self.name = self.signal or name.strip()
        self.function = function
        self.values: dict[object, str] = {}
        self.changes: list[Change] = []


def _place_of(call: CallFrame | None) -> tuple[int, int]:
    return (0, 0) if call is None else (call.strand.order + 1, call.depth)


def _depth(strand: Strand) -> int:
    return sum(1 for _ in strand.script_frames()) - 1


def _merged(stops: list[Stop]) -> Stop:
    """Return one stop for all reasons that apply: the first one of most weight, with the hits of all."""
    best = min(stops, key=lambda stop: _WEIGHT.get(stop.reason, 0))
    hits = tuple(hit for stop in stops for hit in stop.hits)
    changes = tuple(change for stop in stops for change in stop.changes)
    problems = tuple(problem for stop in stops for problem in stop.unevaluated)
    text = "; ".join(dict.fromkeys((best.text, *(problem.text for problem in problems))))
    return replace(best, text=text, hits=hits, changes=changes, unevaluated=problems) if len(stops) > 1 else best


_WEIGHT: Final = {EXCEPTION: 0, BREAKPOINT: 1, DATA_BREAKPOINT: 1, STEP: 3, GOTO: 4, PAUSE: 5}
"""A pause comes last: where something else stops the run too, that is what its caller waits for."""

_END_TEXTS: Final = {
    "finished": "the program has finished",
    "alarm": "the program has ended with an alarm",
    "stopped": "the program was stopped",
    "time_limit": "the time is up",
    "stuck": "nothing can ever happen again",
}
