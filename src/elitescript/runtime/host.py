"""Hosts a program and its secondary programs.

One host runs one program at a time. Secondary programs run beside it, one after the other, with its globals; without a
program they get an empty namespace. Results go to the machine as events.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from elitescript.commands.definition.context import Machine
from elitescript.errors import ScriptStateError
from elitescript.language.compiler import CompiledUnit
from elitescript.language.text.source import SourceFile
from elitescript.messages.events import Alarm, Warned
from elitescript.messages.profile import Profile
from elitescript.messages.timing import HELD_UP_MAX_S, RPC_TIMEOUT_S, WORK_PER_TICK
from elitescript.runtime.alarms import abandoned, held_up, summary_of
from elitescript.runtime.connections.background import Background
from elitescript.runtime.environment import EmptyEnvironment, ProgramEnvironment
from elitescript.runtime.interpreter import Interpreter
from elitescript.runtime.move_waits import MoveWaits
from elitescript.runtime.names.context import POPUP
from elitescript.runtime.program import Program
from elitescript.runtime.queries import Queries, QueryAnswer
from elitescript.runtime.secondary import Secondaries
from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.runtime.threads.strand import STOP, Strand, ThreadState, state_of
from elitescript.runtime.watchdogs import Watchdogs
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.messages.inputs import ChannelEvent
    from elitescript.runtime.connections.connection import Receiver
    from elitescript.runtime.probe import Probe
    from elitescript.runtime.threads.meter import Meter
    from elitescript.runtime.why.facts import Facts
    from elitescript.runtime.why.reasons import Reasons

FINISHED: Final = "finished"
ALARM: Final = "alarm"
STOPPED: Final = "stopped"

_FRAMES_OF_A_CHANGE: Final = 8
"""Frames of a plain write from `caller_line` up to the function that the script has called. No change of a signal that
a script causes has fewer, so that the walk to its line passes them in one step."""

LATE_HINT: Final = "do less in one call, or do it before the arm moves"
_FOR_EVER_US: Final = 1 << 62
HELD_UP_HINT: Final = "do less in one call, with sync() between the parts, or compute it once and keep the result"

SECONDARY_WARNING: Final = "[SEC] Exception: "


class ScriptHost:
    """Runs programs. Implements the controller's `ProgramPort`.

    Args:
        machine: the controller.
        profile: the firmware.
        world: environment; an empty one by default.
        seed: of the random numbers of every program.
        on_end: called with `finished`, `alarm` or `stopped` when a program is over.
        confirms_popups: whether a blocking popup is confirmed at once; if not, `confirm_popup` does it.
        work_per_tick: checkpoints that a thread may pass in one tick.
        held_up_max_s: for how long calls may hold up the robot where a wall clock rules; 0 for ever.
        rpc_timeout_s: how long a remote procedure call waits for its answer; 0 and less wait for ever.
        is_rtsi_input: whether clients can send an input of that name.
        probe: counts the statements of its programs.
        meter: ends the program phase of ticks, where a wall clock rules.

    Attributes:
        result: end of the last program; empty while one runs and before the first.
        alarm: the alarm that ended it, if any.
        background: MODBUS signals and serial lines, which outlive a program.
        interpreter: statements of interpreter mode.
        moves: threads that wait for moves.
        rpc_timeout_s: see above.
        spend_event: charges the running thread a part of its tick for an event.
        connections: receiver of each open channel.
        watchdogs: on RTSI inputs.
    """

    __slots__ = (
        "_cleanup",
        "_confirms_popups",
        "_ending",
        "_has_warned",
        "_machine",
        "_main",
        "_on_end",
        "_probe",
        "_profile",
        "_program",
        "_queries",
        "_scheduler",
        "_secondaries",
        "_seed",
        "_unit",
        "_world",
        "alarm",
        "background",
        "connections",
        "interpreter",
        "moves",
        "result",
        "rpc_timeout_s",
        "spend_event",
        "watchdogs",
    )

    def __init__(
        self,
        machine: Machine,
        *,
        profile: Profile,
        world: ProgramEnvironment | None = None,
        seed: int = 0,
        on_end: Callable[[str], None] = lambda state: None,
        confirms_popups: bool = True,
        work_per_tick: int = WORK_PER_TICK,
        held_up_max_s: float = HELD_UP_MAX_S,
        rpc_timeout_s: float = RPC_TIMEOUT_S,
        is_rtsi_input: Callable[[str], bool] = lambda name: True,
        probe: Probe | None = None,
        meter: Meter | None = None,
    ) -> None:
        self._machine = machine
        self._profile = profile
        self._world: ProgramEnvironment = EmptyEnvironment() if world is None else world
        self._seed = seed
        self._on_end = on_end
        self._probe = probe
        self._confirms_popups = confirms_popups
        self._scheduler = Scheduler(
            work_per_tick=work_per_tick,
            meter=meter,
            on_end=self._strand_ended,
            on_abandoned=self._strand_abandoned,
            on_late=self._held_up,
        )
        self.spend_event = self._scheduler.spend
        if meter is not None:
            meter.held_up_max_us = round(1_000_000 * held_up_max_s) or _FOR_EVER_US
        self._has_warned = False
        """Whether the program was warned of a call that has held up the robot."""
        self._program: Program | None = None
        self._cleanup: frozenset[int] | None = None
        """Lines of its `except` and `finally` blocks; None if that was not asked."""
        self._unit: CompiledUnit | None = None
        """Of the program that runs, or ran last."""
        self._main: Strand | None = None
        self._ending = ""
        self._secondaries = Secondaries(self._scheduler, self._begin_secondary, self._warn_secondary)
        self._queries = Queries(self._scheduler, self._namespace, self._spawn)
        self.interpreter = Interpreter(self._scheduler, profile.interpreter_queue_limit)
        self.watchdogs = Watchdogs(machine, is_rtsi_input)
        self.rpc_timeout_s = rpc_timeout_s
        self.moves = MoveWaits(machine, self._scheduler)
        self.connections: dict[int, Receiver] = {}
        self.background = Background(machine, self._scheduler, self.connections)
        self.result = ""
        self.alarm: Alarm | None = None

    # ---------------------------------------------------------------- programs

    def start(
        self, unit: CompiledUnit, presets: dict[str, object] | None = None, *, world: ProgramEnvironment | None = None
    ) -> None:
        """Start a program; it runs from the next `run_tick` on.

        Args:
            unit: a program, script or line.
            presets: initial values of program globals.
            world: new environment; as before if None.

        Raises:
            ScriptStateError: a program is running.
        """
        if self.is_running:
            raise ScriptStateError("a program is running; stop it first")
        if world is not None:
            self._world = world
        self._unit, self._cleanup = unit, None
        self._program = program = self._new_program(presets or {})
        self.result, self.alarm, self._ending = "", None, ""
        if (meter := self._scheduler.meter) is not None:
            meter.begin_program()
        # Secondary programs run without a program, too.
        self._forget_late()
        self._main = self._spawn(program, "main", program.body_of(unit))
        program.main = self._main
        self.interpreter.begin_program(self._main, program.globals, program.execute)

    def start_secondary(self, unit: CompiledUnit, *, world: ProgramEnvironment | None = None) -> None:
        """Run a secondary program as soon as those before it are over.

        Args:
            unit: the secondary program.
            world: new environment; as before if None.

        Raises:
            ScriptStateError: too many wait.
        """
        if world is not None:
            self._world = world
        self._secondaries.put(unit)

    def query(self, text: str, answer: QueryAnswer) -> None:
        """Evaluate an expression as a secondary program.

        Args:
            text: the expression.
            answer: called once, in this tick or a later one.

        Raises:
            ProgramError: it is no expression.
            ScriptStateError: too many wait.
        """
        self._queries.ask(text, answer)

    def prolong_secondary(self, ticks: int) -> None:
        """Let the secondary program that runs take so much longer: a debugger has held it."""
        self._secondaries.prolong(ticks)

    def abort_move(self) -> None:
        """End the `movej` or `movel` that a thread waits for; other motions go on (*documented*)."""
        self.moves.abort()

    def pause(self) -> None:
        """Suspend the threads of the program; virtual time goes on, and their waits are longer by the pause."""
        if self.is_running:
            self._scheduler.pause()

    def resume(self) -> None:
        """Let the threads go on."""
        self._scheduler.resume()
        self.watchdogs.restart(self._machine.tick)

    def stop(self, reason: str) -> None:
        """End the program in the `run_tick` that runs or in the next one; secondary programs go on.

        Args:
            reason: not used; the result is `stopped`.
        """
        self._end(STOPPED)

    def forget_threads(self) -> None:
        """Drop the stacks of all threads, once nobody can run them any more."""
        self._scheduler.forget()

    def end_now(self, tick: int) -> None:
        """End the program at once, in the inbox phase of a tick, so that another one can start in this tick."""
        if self._main is None or self._program is None:
            return
        self._scheduler.begin_tick(tick)
        try:
            self._end(STOPPED)
            self._end_program(self._program)
        finally:
            self._scheduler.end_tick()

    def fail(self, alarm: Alarm) -> None:
        """End the program as `stop` does, with an alarm that it cannot catch."""
        if self._program is not None and self._main is not None and not self._ending:
            self.alarm = self._program.shown(alarm)
            self._machine.emit(self.alarm)
            self._end(ALARM)

    def interrupt(self) -> None:
        """Bring control back from `run_tick` at the next checkpoint; may be called from a signal handler."""
        self._scheduler.interrupt()

    def confirm_popup(self) -> None:
        """Confirm the popups that threads wait for."""
        for strand in self._scheduler.strands:
            if strand.waits_for == POPUP:
                self._scheduler.wake(strand)

    # ---------------------------------------------------------------- reading

    @property
    def scheduler(self) -> Scheduler:
        """What runs its threads."""
        return self._scheduler

    @property
    def program(self) -> Program | None:
        """The program that runs or ran last."""
        return self._program

    @property
    def source(self) -> SourceFile | None:
        """The text of the program that runs or ran last."""
        return None if self._unit is None else self._unit.source

    @property
    def is_running(self) -> bool:
        """Whether a program runs; a paused one does."""
        return self._main is not None

    @property
    def has_begun(self) -> bool:
        """Whether the program that runs has come to its first statement."""
        return self._main is not None and self._main.activations > 0

    @property
    def is_paused(self) -> bool:
        """Whether the program is paused."""
        return self._scheduler.is_paused

    @property
    def is_idle(self) -> bool:
        """Whether nothing is left to run."""
        return self._main is None and self._secondaries.is_idle and self._queries.is_idle

    @property
    def line(self) -> int:
        """Line of the main thread; 0 without a program."""
        return 0 if self._main is None else self._main.line

    @property
    def caller(self) -> tuple[str, int]:
        """Name and line of the running thread; an empty name and 0 while none runs."""
        strand = self._scheduler.current
        return ("", 0) if strand is None else (strand.name, strand.line)

    @property
    def caller_line(self) -> int:
        """Line of the running thread; 0 while none runs."""
        strand = self._scheduler.current
        return 0 if strand is None else strand.line_behind(_FRAMES_OF_A_CHANGE)

    def is_cleanup(self, line: int) -> bool:
        """See `controller.tasks.ProgramPort.is_cleanup`."""
        if self._unit is None:
            return False
        if self._cleanup is None:
            # Imported late: few runs ask for it.
            from elitescript.language.cleanup import cleanup_lines

            self._cleanup = cleanup_lines(self._unit.source)
        return line in self._cleanup

    def monitor(self) -> dict[str, Any]:
        """Return the globals of the program that runs or ran last, in the order of first assignment."""
        return {} if self._program is None else self._program.monitor()

    def threads(self) -> tuple[ThreadState, ...]:
        """Return the states of the script threads, the main one first."""
        return tuple(map(state_of, self._scheduler.strands))

    def explained_threads(self, facts: Facts | None = None, start_tick: int = 0) -> tuple[ThreadState, ...]:
        """Return what `threads` returns, with the reason why each does not go on.

        Args:
            facts: what is known beside the threads; None for nothing.
            start_tick: tick from which the times in it are counted.
        """
        reasons = self.reasons(facts, start_tick, is_paused=self.is_paused)
        if reasons is None:
            return self.threads()
        return tuple(state_of(strand)._replace(because=reasons.of(strand)) for strand in self._scheduler.strands)

    def reasons(self, facts: Facts | None = None, start_tick: int = 0, *, is_paused: bool = False) -> Reasons | None:
        """Return what says why threads do not go on, for as long as time stands; None before the first program.

        Args:
            facts: what is known beside the threads; None for nothing.
            start_tick: tick from which the times in it are counted.
            is_paused: whether it is a pause that they wait for.
        """
        if self._unit is None:
            return None
        # Imported late: most programs go on.
        from elitescript.runtime.why.facts import Facts
        from elitescript.runtime.why.reasons import Reasons

        strands, connections = self._scheduler.strands, self.connections.values()
        return Reasons(
            self._unit, self._program, strands, connections, facts or Facts(), start_tick, is_paused=is_paused
        )

    # ---------------------------------------------------------------- time

    def run_tick(self, tick: int) -> None:
        """Run every thread that is due, until each waits or has used up its work of this tick."""
        scheduler = self._scheduler
        scheduler.begin_tick(tick)
        self.background.run_tick(tick, is_running=self.is_running)
        if not self.is_paused:
            self.watchdogs.look(tick)
        try:
            self._settle()
            # Many ticks are due for the arm alone.
            while scheduler.has_work or self._ending:
                scheduler.run_ready()
                if not self._settle():
                    break
        finally:
            scheduler.end_tick()

    def next_tick(self, tick: int) -> int | None:
        """Return the earliest tick after `tick` at which a thread is due; None while all wait for something else."""
        if self._ending:
            return tick + 1
        due = self._scheduler.next_tick(tick)
        if due == tick + 1:
            return due
        for at in (
            self._secondaries.next_tick(tick),
            self._queries.next_tick(tick),
            None if self.is_paused else self.watchdogs.next_tick(),
            self.background.next_tick(tick, is_running=self.is_running),
        ):
            if at is not None and (due is None or at < due):
                due = at
        return due

    def motion_ended(self, move: int, is_complete: bool) -> None:
        """Let the threads that wait for a move go on at the next `run_tick`: it is over."""
        self.moves.ended(move)

    def channel_event(self, event: ChannelEvent) -> None:
        """Hand an event of a channel to its receiver; threads that wait for it go on at the next `run_tick`."""
        if (connection := self.connections.get(event.channel)) is not None:
            connection.take(event)

    def set_lag(self, ticks: int) -> None:
        """Set how many ticks robot time is behind the wall clock from now on."""
        self._scheduler.lag_ticks = ticks

    def _settle(self) -> bool:
        """End and begin programs between two strands; return whether anything was done."""
        scheduler = self._scheduler
        has_changed = scheduler.needs_attention
        scheduler.needs_attention = False
        if self._ending and self._program is not None:
            self._end_program(self._program)
            has_changed = True
        has_secondary, has_query = self._secondaries.settle(), self._queries.settle()
        return has_secondary or has_query or has_changed

    # ---------------------------------------------------------------- the life of a program

    def _new_program(self, presets: dict[str, object]) -> Program:
        return Program(
            machine=self._machine,
            scheduler=self._scheduler,
            profile=self._profile,
            world=self._world,
            seed=self._seed,
            port=self,
            presets=presets,
            probe=self._probe,
        )

    def _spawn(
        self, program: Program, name: str, function: Callable[[], None], *, is_secondary: bool = False
    ) -> Strand:
        def body() -> None:
            try:
                function()
            except STOP:
                pass
            except SystemExit:
                self._left(program)
            except KeyboardInterrupt:
                raise
            except BaseException as error:
                self._failed(error, program)

        return self._scheduler.spawn(name, body, program.builtins, is_secondary=is_secondary)

    def _end(self, state: str) -> None:
        """Request the end of the program with a state; the first one counts."""
        if self._main is not None and not self._ending:
            self._ending = state
        self._scheduler.call_attention()

    def _end_program(self, program: Program) -> None:
        """End every thread of the program, in the order of their start, and report its end."""
        main = self._main
        self._main = None
        # A thread that is stopped may start none, so one pass over them is enough.
        for strand in [strand for strand in self._scheduler.strands if not strand.is_secondary]:
            self._scheduler.kill(strand)
        self._scheduler.forget_pause()
        self._forget_late()
        self.interpreter.end_program()
        self.watchdogs.clear()
        if main is not None:
            program.close()
            self.background.program_ended()
        self.result, self._ending = self._ending, ""
        self._on_end(self.result)

    def _strand_ended(self, strand: Strand) -> None:
        if strand is self._main:
            self._end(STOPPED if strand.is_dying else FINISHED)
        else:
            self._secondaries.ended(strand)
            self._queries.ended(strand)

    def _held_up(self, strand: Strand, late_ms: int) -> None:
        """Warn of the first call of a program that has held up the robot, and end the program when they are too much.

        The line of the warning is where the thread has come to behind the call. From then on the times of statements
        are noted, so the alarm has the line of the call itself, unless a debugger watches the program.
        """
        meter = self._scheduler.meter
        assert meter is not None
        if meter.held_up_us > meter.held_up_max_us and not strand.is_secondary:
            line = meter.late_line or strand.line or strand.started_line
            self.fail(held_up(strand, self._machine.tick, line, late_ms, meter.held_up_max_us / 1000, HELD_UP_HINT))
        elif not self._has_warned:
            self._has_warned = True
            what = said("one call, or a few on end, took {late_ms} ms too long", late_ms=late_ms)
            text = said("{what}: no stop acts and no stream goes on meanwhile", what=what)
            line = strand.line or strand.started_line
            self._machine.emit(Warned(self._machine.tick, text, strand.name, line, "", LATE_HINT))
            if meter.notes_statements and not self._scheduler.watchers:
                self._scheduler.watch(self._note_statement)

    def _forget_late(self) -> None:
        """Warn again, and note no statements."""
        self._has_warned = False
        if self._note_statement in self._scheduler.watchers:
            self._scheduler.watch(None)

    def _note_statement(self, strand: Strand, number: int) -> None:
        meter = self._scheduler.meter
        assert meter is not None
        # Near to the limit of the depth of calls nothing is noted; the program meets it later.
        with suppress(RecursionError):
            meter.note_statement(strand.line)

    def _strand_abandoned(self, strand: Strand) -> None:
        self._machine.emit(abandoned(strand, self._machine.tick))

    def _failed(self, error: BaseException, program: Program) -> None:
        """Report an exception that has left a strand; one of a stopped strand is ignored."""
        strand = self._scheduler.current
        if strand is None or strand.is_dying:
            return
        if strand.is_secondary:
            self._warn_secondary(summary_of(error), strand, program.alarm(error, strand).line)
        elif not self._ending:
            self.alarm = program.alarm(error, strand)
            self._machine.emit(self.alarm)
            self._end(ALARM)

    def _left(self, program: Program) -> None:
        """End the program after `raise SystemExit`."""
        program.context.warn("SystemExit ends the program like halt()")
        self._end(STOPPED)

    # ---------------------------------------------------------------- secondary programs

    def _namespace(self) -> tuple[Program, Program | None]:
        """Return the running program and None, or twice an empty one."""
        if self._program is not None and self._main is not None:
            return self._program, None
        own = self._new_program({})
        return own, own

    def _begin_secondary(self, unit: CompiledUnit) -> tuple[Strand, Program | None]:
        program, own = self._namespace()
        name = said("sec {unit}", unit=unit.name) if unit.name else "sec"
        return self._spawn(program, name, program.body_of(unit), is_secondary=True), own

    def _warn_secondary(self, text: str, strand: Strand, line: int | None = None) -> None:
        place = strand.line if line is None else line
        self._machine.emit(Warned(self._machine.tick, SECONDARY_WARNING + text, strand.name, place, is_exception=True))

    # ---------------------------------------------------------------- calls of contexts

    def spawn_thread(self, function: Callable[..., Any], args: tuple[Any, ...], name: str) -> Strand:
        """Start a thread of the program."""
        program = self._program
        assert program is not None
        starter = self._scheduler.current
        strand = self._spawn(program, name, lambda: function(*args))
        strand.started_line = 0 if starter is None else starter.line
        return strand

    def thread_count(self) -> int:
        """Return the number of threads of the program besides its main one."""
        return sum(1 for strand in self._scheduler.strands if not strand.is_secondary and strand is not self._main)

    def halt(self) -> None:
        """Stop the program as soon as the calling strand is suspended."""
        self._end(STOPPED)

    def thread_failed(self, error: BaseException) -> None:
        """Report an exception that has left the function of a `threading.Thread`."""
        if isinstance(error, KeyboardInterrupt):
            raise error
        if self._program is not None:
            if isinstance(error, SystemExit):
                self._left(self._program)
            else:
                self._failed(error, self._program)

    def wait_for_confirmation(self) -> bool:
        """Return whether a blocking popup is confirmed at once."""
        return self._confirms_popups
