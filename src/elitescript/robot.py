"""`VirtualRobot`: a robot in virtual time, with the programs it runs and what is around it.

Nothing here reads a clock: a caller who wants real time passes a `pace`, which is called before every tick that is
run.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import cache, partial
from keyword import iskeyword
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal
from weakref import ref

from elitescript.controller.signals.by_name import signal_write
from elitescript.controller.views.signals import Signals
from elitescript.controller.views.trace import Trace
from elitescript.controller.views.trace_signals import SignalRecord, TraceSignals
from elitescript.controller.views.warning_limit import LIMITED, WarningLimit
from elitescript.devices.drain import DRAIN_S, Drain
from elitescript.devices.outside import Outside, OutsideChannels, Place
from elitescript.devices.surroundings import RobotSettings, Surroundings
from elitescript.environment.allowance import TASK_DIR_BYTES
from elitescript.environment.interrupts import interrupts_passed_to
from elitescript.environment.program_file import source_of
from elitescript.errors import UsageError, suggests_keywords
from elitescript.kernel.arm import named_model
from elitescript.kernel.kernel import Kernel
from elitescript.kernel.option_signature import takes_options
from elitescript.kernel.options import (
    DEFAULTS,
    IN_VIRTUAL_TIME,
    RobotOptions,
    check_keywords,
    given_ticks,
    robot_options,
)
from elitescript.language.compiler import CompiledUnit, compile_task, compile_unit
from elitescript.language.hash_order import may_hold_set
from elitescript.language.options import SECONDARY, Options
from elitescript.language.text.source import SourceFile
from elitescript.messages.events import BARRED, UNDELIVERED, Alarm, Event, SignalChanged, Warned
from elitescript.messages.machine import AskSafety, PauseTask, ResumeTask, SetSpeedScale, StopTask
from elitescript.messages.signals import Value
from elitescript.messages.state import RobotState
from elitescript.messages.timing import seconds, ticks_for
from elitescript.models.model import RobotModel
from elitescript.observer import OBSERVATION
from elitescript.run import FINDINGS, NOT_DELIVERED, EndState, Look, ProgramGlobals, Run, record_of
from elitescript.runtime.environment import ProgramEnvironment
from elitescript.runtime.probe import Probe, noted, probed, witness
from elitescript.runtime.threads.strand import is_stop
from elitescript.said import joined, said

if TYPE_CHECKING:
    from typing import Unpack

    from elitescript.environment.network_option import Way
    from elitescript.environment.state_file import StateFile
    from elitescript.kernel.clients import Client, Clients
    from elitescript.kernel.option_keywords import RobotKeywords
    from elitescript.language.diagnostics import Diagnostic
    from elitescript.messages.profile import Profile
    from elitescript.runtime.host import ScriptHost
    from elitescript.runtime.threads.strand import ThreadState
    from elitescript.solids.contacts import Contact, ContactWatch

IDLE_TICKS: Final = ticks_for(1.0)
"""An arm that stands for so long, while nothing else is due, does not get under way by itself any more."""

TRACE_TICKS_MAX: Final = 10_000
"""Rows that are recorded before `pace` is called, or an interrupt is seen."""

_OWN_KEYWORDS: Final = ("model", "task_dir", "world", "lines", "drain_s", "state_file", "on_event", "probe")

Pace = Callable[[int], None]
Watch = Callable[["VirtualRobot"], None]


def _state_file(path: str | Path) -> StateFile:
    from elitescript.environment.state_file import StateFile

    return StateFile(path)


@takes_options
class VirtualRobot:
    """One robot in virtual time, powered on.

    Args:
        model: name of the arm, such as `"CS66"`, the path of a file that describes an arm of one's own, such as
            `"my_arm.toml"`, or a loaded model; that of the world file, else `"CS66"`, if None.
        task_dir: folder that stands for the robot's task folder, or contents of files by their names, as
            `{"points.csv": b"1,2"}`, for one in memory; if None, a program that comes from a file gets that file's
            folder, and a program text gets an empty folder in memory.
        task_dir_limit: bytes that programs may add to the task folder (default *assumed*).
        world: what is around the robot: a `World` of devices (`elitescript.testing.world`), or the path of a TOML file
            that declares one, with options of the robot and levels of signals at the start. Or a folder and a network
            by themselves, instead of `task_dir`.
        lines: what is on the robot's serial ports, as `{"tool": "/dev/ttyUSB0", "box": "socket://127.0.0.1:7000"}`.
        drain_s: how long `run` waits, once a program is over, for bytes and requests that do not get any further.
        state_file: a file with the registers, flags and general Modbus values that the robot remembers: read now,
            written when `run` or `advance` returns. Nothing is remembered if None.
        on_event: receives every event at the moment it happens.
        probe: counts the statements of programs, for a debugger or coverage; see `runtime.probe`.
        **options: the options of the robot, each by its name (docs/reference/options.md). What is not given, or None,
            is what the world file says, else the default.

    Raises:
        UsageError: an argument that makes no sense.
    """

    def __init__(
        self,
        model: str | Path | RobotModel | None = None,
        *,
        task_dir: str | Path | Mapping[str, bytes] | None = None,
        task_dir_limit: int = TASK_DIR_BYTES,
        world: ProgramEnvironment | Surroundings | str | Path | None = None,
        lines: Mapping[str, str] | None = None,
        drain_s: float = DRAIN_S,
        state_file: str | Path | None = None,
        on_event: Callable[[Event], None] | None = None,
        probe: Probe | None = None,
        **options: Unpack[RobotKeywords],
    ) -> None:
        check_keywords(options, _OWN_KEYWORDS)
        settings = RobotSettings()
        if isinstance(world, str | Path):
            from elitescript.world_file import load_world_file

            file = load_world_file(world)
            settings, world = file, file.world
        elif isinstance(world, Surroundings) and world.settings is not None:
            settings = world.settings
        arm = settings.options.get("model", DEFAULTS["model"]) if model is None else model
        self.model, named = (arm, {"model": arm.name}) if isinstance(arm, RobotModel) else named_model(arm)
        self.options = robot_options({**options, **named}, settings.options, **IN_VIRTUAL_TIME)
        self._on_event = on_event
        self.reports_signals = True
        """Whether `on_event` has a use for changes of signals; else a run need not make their events for it."""
        self._outside = Outside(world, task_dir, lines, task_dir_limit, self.options.network)
        self._kernel = Kernel(
            self.options,
            self._outside,
            model=self.model,
            has_network=True,
            on_event=_weakly(self._event),
            on_end=_weakly(self._program_ended),
            probe=probe,
        )
        self.profile = self._kernel.profile
        self.controller = self._kernel.controller
        self._host = self._kernel.host
        self.signals = Signals(self.controller)
        if not drain_s >= 0.0:
            raise UsageError(f"drain_s must be >= 0 s, got {drain_s!r}")
        self._drain_s = drain_s
        self._clients: Clients | None = None
        self._globals: dict[str, Any] | None = None
        """Of a program that is over, while there are clients."""
        self._is_advancing = False
        self._drain: Drain | None = None
        self._run: Run | None = None
        self._limit = WarningLimit()
        self._trace: Trace | None = None
        self.cell = settings.cell
        """Solids beside the robot and on its flange, as the world file has them; None if it has none."""
        self._watch: ContactWatch | None = None
        """Of the present run, where the world has solids."""
        self._interrupted_as: EndState | Literal[""] = ""
        self.next_stop: Callable[[int], int | None] | None = None
        """Returns for a tick the next one that is to run though nothing is due; None for none. For a debugger."""
        self._listener_error: BaseException | None = None
        self._state_file = None if state_file is None else _state_file(state_file)
        kept = {} if self._state_file is None else self._state_file.load()
        self.set_start({**kept, **settings.signals})
        if self._outside.surroundings is not None:
            self._outside.surroundings.begin(self._kernel)
            for request in self._outside.surroundings.input_faults:
                self.controller.put(0, request, "fault")

    def __del__(self) -> None:
        # What the stack of a script thread refers to is never collected, and it refers to the whole machine.
        host = getattr(self, "_host", None)
        if host is not None:
            host.forget_threads()

    # ---------------------------------------------------------------- reading

    @property
    def tick(self) -> int:
        """Ticks of 4 ms since the start."""
        return self.controller.tick

    @property
    def time_s(self) -> float:
        """Virtual time since the start."""
        return seconds(self.controller.tick)

    @property
    def state(self) -> RobotState:
        """The whole machine at this tick."""
        return self.controller.state()

    @property
    def current(self) -> Run | None:
        """The run that is under way, or the last one."""
        return self._run

    @property
    def host(self) -> ScriptHost:
        """What runs its programs."""
        return self._host

    @property
    def surroundings(self) -> Surroundings | None:
        """Devices and wires beside it; None if it has none."""
        return self._outside.surroundings

    def threads(self) -> tuple[Any, ...]:
        """Return every script thread: name, line and what it waits for."""
        return self._host.threads()

    def explained_threads(self) -> tuple[Any, ...]:
        """Return every script thread as `threads` does, with `because`: why it does not go on."""
        return self.threads() if self._run is None else self._explained(self._run)

    def place(self, kind: str, name: str, port: int = 0) -> Place:
        """Return what becomes of a connection that its programs make; see `Outside.place`."""
        return self._outside.place(kind, name, port)

    @property
    def may_be_real(self) -> bool:
        """Whether its programs may reach something outside of their world."""
        return self._outside.may_be_real

    def set_network_by(self, way: Way) -> None:
        """Let texts name the option `network` in a way other than this keyword, before any program runs."""
        self._outside.set_network_by(way)

    def wrap_network(self, wrap: Callable[[OutsideChannels], OutsideChannels]) -> None:
        """Put something before the network of this computer, before any program runs; for a debugger."""
        self._outside.wrap_local(wrap)

    # ---------------------------------------------------------------- changing

    def set_speed(self, fraction: float) -> None:
        """Move the speed slider, 0 to 1."""
        self.controller.request(SetSpeedScale(fraction))

    def set_start(self, levels: Mapping[str, Value]) -> None:
        """Set signals to the levels that they begin with; `on_event` is not called, since nothing has happened yet."""
        listener, self._on_event = self._on_event, None
        try:
            for name, value in levels.items():
                self.signals[name] = value
        finally:
            self._on_event = listener

    def at(self, time_s: float, name: str, value: Value) -> None:
        """Have a signal change at a time, in seconds since the robot's start: the script of a test for inputs."""
        self.controller.put(given_ticks(time_s, "time_s"), signal_write(name, value), "schedule")

    def pause(self) -> None:
        """Pause the task."""
        self.controller.request(PauseTask())

    def resume(self) -> None:
        """Go on after a pause."""
        self.controller.request(ResumeTask())

    def stop(self) -> None:
        """Stop the task; it ends in the next tick."""
        self.controller.request(StopTask())

    def fault(self, kind: str, on: int | str, **settings: Any) -> None:
        """Let something go wrong on a connection, a serial line or at an input, from now on.

        What can go wrong, and where, is in `elitescript.testing.world.Fault`.

        Raises:
            UsageError: there is no such fault, or it makes no sense there.
        """
        request = self._outside.fault(self.tick, kind, on, settings)
        if request is not None:
            self.controller.put(self.tick, request, "fault")

    def protective_stop(self, reason: str = "") -> None:
        """Stop the arm as the safety system does; the program ends with an alarm."""
        self.controller.request(AskSafety("stop_protectively", reason))

    def unlock_protective_stop(self) -> None:
        """Let the arm move again, from 5 s after a protective stop on.

        Raises:
            ScriptStateError: there is none, or it is too early.
        """
        self.controller.request(AskSafety("unlock_protective_stop"))

    def restart_safety(self) -> None:
        """Restart the safety system, which ends violations and faults; the arm is off afterwards."""
        self.controller.request(AskSafety("restart_safety"))

    def interrupt(self, state: EndState = "stopped") -> None:
        """End the run at its next checkpoint, with that state; may be called from a signal handler."""
        self._interrupted_as = state
        self._host.interrupt()

    # ---------------------------------------------------------------- programs

    def compile(self, program: str | Path | SourceFile) -> CompiledUnit:
        """Compile a program text, the file of a path, or a source that was read before.

        Raises:
            ProgramError: the text does not compile; `problems` says where and why.
            UsageError: no such file.
        """
        source = program if isinstance(program, SourceFile) else source_of(program)
        return noted(self._kernel.probe, compile_task(source, self.text_options(source)))

    def text_options(self, source: SourceFile, kind: str | None = None) -> Options:
        """Return the options to compile a text with for this robot, one that is compiled elsewhere too."""
        options = Options(strict=self.options.strict, kind=kind, ignored=self.options.ignored)
        return probed(self._kernel.probe, options, source)

    @suggests_keywords
    def run(
        self,
        program: str | Path | CompiledUnit,
        *,
        until_s: float | None = None,
        presets: Mapping[str, object] | None = None,
        trace: bool | Trace = False,
        trace_step_s: float | None = None,
        trace_signals: str | Iterable[str] | None = None,
        trace_window_s: tuple[float, float] | None = None,
        keep: str | Iterable[str] = "all",
        pace: Pace | None = None,
        watch: Watch | None = None,
    ) -> Run:
        """Run a program to its end, in virtual time.

        Then time goes by until everything that the program gave away has arrived: bytes of sockets and serial ports,
        MODBUS outputs and requests; and until no device has something to do in the next tick, within limits (see
        `devices.drain`). The record says when and where the program ended; its events and signals are those at the
        end of that.

        Args:
            program: program text, path of a file, or what `compile` returned.
            until_s: stop after so much virtual time, with state `time_limit`.
            presets: program globals that have a value before the program begins.
            trace: keep a row for each tick in `Run.trace`, or send them to your own `Trace`.
            trace_step_s: time between rows.
            trace_signals: signals that the rows of `Run.trace` hold, or `all`; those not at their default if None.
            trace_window_s: begin and end of the rows of `Run.trace`, in the time of the robot; all if None.
            keep: kinds of events that `Run.events` keeps: `all`, `none`, or names such as `Alarm`; texts and findings
                have lists of their own.
            pace: called with the tick before it is run.
            watch: called after every tick that was run; may call `interrupt`.

        Raises:
            ProgramError: the text does not compile.
            UsageError: no such file; a limit that is no number of at least 0.
        """
        if until_s is not None:
            given_ticks(until_s, "until_s")  # before anything begins
        run = self.start(
            program,
            presets=presets,
            trace=trace,
            trace_step_s=trace_step_s,
            trace_signals=trace_signals,
            trace_window_s=trace_window_s,
            keep=keep,
        )
        if OBSERVATION.observer is None:
            return self._run_through(run, until_s, pace, watch)
        with OBSERVATION.observer.limits(self, run, until_s) as until_s:
            self._run_through(run, until_s, pace, watch)
        return run

    def _run_through(self, run: Run, until_s: float | None, pace: Pace | None, watch: Watch | None) -> Run:
        limit = None if until_s is None else self.tick + given_ticks(until_s, "until_s")
        try:
            with interrupts_passed_to(self.interrupt):
                self._run_to_end(run, limit, pace, watch)
        except BaseException:
            self._finish("stopped")
            self._conclude()
            self._listener_error = None
            self._remember()
            raise
        self._end_run()
        return run

    def run_started(self, *, until_s: float | None = None, watch: Watch | None = None) -> Run:
        """Run the program that was started to its end, as `run` does, for a caller that may leave it in the middle.

        An exception, or a drop of the greenlet that it runs in, changes nothing any more. Ctrl-C is the caller's.
        """
        run = self._run
        if run is None:
            raise UsageError("no program was started")
        limit = None if until_s is None else self.tick + given_ticks(until_s, "until_s")
        self._run_to_end(run, limit, None, watch)
        self._end_run()
        return run

    def _run_to_end(self, run: Run, limit: int | None, pace: Pace | None, watch: Watch | None) -> None:
        self._advance(limit, pace, watch)
        is_cut_short = bool(self._interrupted_as) and run.state != ""
        self._finish(self._interrupted_as or "time_limit")
        self._interrupted_as = ""
        if not is_cut_short and not self._is_drained():
            self._advance(None, pace, watch)
        self._interrupted_as = ""

    def _end_run(self) -> None:
        self._conclude()
        self._leave_published_tick()
        self._raise_listener_error()
        self._remember()

    @suggests_keywords
    def start(
        self,
        program: str | Path | CompiledUnit,
        *,
        presets: Mapping[str, object] | None = None,
        trace: bool | Trace = False,
        trace_step_s: float | None = None,
        trace_signals: str | Iterable[str] | None = None,
        trace_window_s: tuple[float, float] | None = None,
        keep: str | Iterable[str] = "all",
    ) -> Run:
        """Start a program; `advance` runs it. Its record says where it is.

        No time goes by, unless something that the last program gave away is still under way: that is waited for before.

        Raises:
            ProgramError: the text does not compile.
            ScriptStateError: a program is running; it goes on, and its record too.
        """
        record = record_of(keep)
        unit = program if isinstance(program, CompiledUnit) else self.compile(program)
        values = _checked_presets(presets or {})
        world = self._outside.world_for(unit.source.name)
        self._interrupted_as = ""
        self._drain_last()
        self._leave_published_tick()
        # The record of a program that runs must not become that of one that is refused.
        self.controller.task.require("start")
        self._globals = None
        run = Run(unit, self.tick, _compiler_warnings(unit, self.options.ignored), record)
        run.is_alone = self._outside.is_alone and self._clients is None and not may_hold_set(values.values())
        run.look = lambda: self._look(run)
        run.check_text = cache(partial(_findings_of, unit, self.profile, self.model, tuple(values), self.options))
        self._run = run
        self._choose_record()
        if self.options.power_on and not self.controller.safety.refusal("power_on"):
            self.controller.power_up()
        self._trace = trace if isinstance(trace, Trace) else None
        if trace and self._trace is None:
            # Imported late: few runs keep rows.
            from elitescript.controller.views.trace_rows import TraceRecorder

            self._trace = TraceRecorder(trace_step_s, TraceSignals(trace_signals), trace_window_s, run.trace)
        if self.cell is not None:
            # Imported late: few worlds have solids.
            from elitescript.solids.contacts import ContactWatch

            self._watch = run.watch = ContactWatch(self.cell, self.model, self._contact)
        if OBSERVATION.observer is not None:
            self._trace = OBSERVATION.observer.started(self, run, values, self._trace)
        if unit.kind == SECONDARY:
            self._host.start_secondary(unit, world=world)
        else:
            self.controller.task_started(unit.name)
            self._host.start(unit, values, world=world)
        return run

    def submit_secondary(self, program: str) -> None:
        """Run a `sec` unit beside the program, or alone.

        Raises:
            ProgramError: the text does not compile.
        """
        source = SourceFile("<secondary>", program)
        unit = noted(self._kernel.probe, compile_unit(source, self.text_options(source, SECONDARY)))
        if self._run is not None and unit.shows_hash_order:
            self._run.is_alone = False
        self._host.start_secondary(unit)

    def advance(self, duration_s: float, *, pace: Pace | None = None) -> None:
        """Let virtual time go by, whether a program runs or not."""
        ticks = given_ticks(duration_s, "duration_s")
        self._leave_published_tick()
        self._advance(self.tick + ticks, pace, None, stays=True)
        if self._interrupted_as:
            self._finish(self._interrupted_as)
            self._interrupted_as = ""
        self._remember()

    def connect(self, port: str) -> Client:
        """Connect a client to a port of the robot, in memory and in robot time.

        What the client sends is taken in by the next tick that runs, and what the robot sends in a tick can be received
        after it, as a client of a served robot would. Time goes by in `run` (the client acts in `watch`), in `advance`
        and in `Client.expect`; it does not leap over a tick in which the port sends something by itself, and stops in
        every tick in which a client acts. Programs of clients see the robot's `task_dir`, or an empty folder.

        Args:
            port: `primary`, `secondary`, `realtime`, `readonly`, `rtsi`, `dashboard`, `interpreter`, `query`, `modbus`.

        Raises:
            UsageError: the firmware has no such port.

        Example:
            >>> robot = VirtualRobot("CS66")
            >>> client = robot.connect("dashboard")
            >>> client.expect(b"NAME.\\r\\n")[:25]
            b'EliRobot dashboard shell,'
            >>> client.send(b"robotMode\\n")
            >>> robot.advance(0.004)
            >>> client.receive()
            b'robotMode: RUNNING\\r\\n'
        """
        if self._clients is None:
            from elitescript.kernel.clients import Clients

            self._clients = Clients(self._kernel)
            if self._run is not None:
                self._run.is_alone = False
            self._choose_record()
        client = self._clients.connect(port, self._step)
        if not self._is_advancing:
            # The tick in which a run has ended is not another client's: what follows counts from the next.
            self._leave_published_tick()
        return client

    def _step(self) -> None:
        """Let one tick go by for a client that waits."""
        if self._is_advancing:
            raise UsageError("expect() lets time go by, which it does already; use receive() in `watch` and `on_event`")
        self._leave_published_tick()
        self._advance(self.tick + 1, None, None, stays=True)

    def _leave_published_tick(self) -> None:
        """Go on from a tick that has run, if clients have it: a tick is given to them once."""
        if self._clients is not None and self._clients.are_open and self._kernel.has_run:
            self._kernel.leap(self.tick + 1)

    def _remember(self) -> None:
        if self._state_file is not None:
            self._state_file.save(self.controller.signals.image)

    # ---------------------------------------------------------------- time

    def _advance(self, limit: int | None, pace: Pace | None, watch: Watch | None, *, stays: bool = False) -> None:
        """Run ticks until the program is over and the arm rests, or through the tick `limit`.

        Args:
            stays: go on up to `limit`, which is not run, though nothing happens any more.
        """
        self._leave_published_tick()
        is_outermost, self._is_advancing = not self._is_advancing, True
        try:
            self._run_ticks(limit, pace, watch, stays=stays)
        finally:
            self._is_advancing = not is_outermost

    def _run_ticks(self, limit: int | None, pace: Pace | None, watch: Watch | None, *, stays: bool) -> None:
        kernel, controller, channels = self._kernel, self.controller, self._outside.channels
        surroundings = self._outside.surroundings
        idle_ticks = 0
        idle_from: int | None = None
        """Since when nothing but clients is due."""
        while not (stays and limit is not None and controller.tick >= limit):
            if pace is not None:
                pace(controller.tick)
            for event in channels.arrivals(controller.tick):
                kernel.channel_event(event)
            if self._clients is not None:
                self._clients.take_in()
            kernel.run_tick()
            if self._clients is not None:
                self._clients.publish()
            if surroundings is not None:
                surroundings.settle()
            self._raise_listener_error()
            if watch is not None:
                watch(self)
            if self._interrupted_as:
                return
            run = self._run
            if run is not None and run.state == "" and run.unit.kind == SECONDARY and self._host.is_idle:
                run.state = "finished"
            if run is not None and run.state != "" and (run.is_over or not controller.is_moving):
                self._rest(run)
                if self._is_drained() and not stays:
                    return
            if limit is not None and controller.tick >= limit:
                return
            due, arrives = kernel.due_tick(), channels.next_tick(controller.tick)
            idle_ticks = idle_ticks + 1 if arrives is None and controller.is_idle else 0
            due = _earliest(due, arrives)
            if arrives is not None and run is not None and channels.is_real:
                run.is_paced = True
            if self._drain is not None:
                due = _earliest(due, max(self._drain.end_tick, controller.tick + 1))
            if due is not None:
                idle_from = None
            elif idle_from is None:
                idle_from = controller.tick
            if self._clients is not None and self._clients.are_open:
                due = _earliest(due, self._clients.next_tick(controller.tick))
                if idle_from is not None and watch is None:
                    # What a port sends by itself, at whatever rate, gets nothing under way.
                    idle_ticks = max(idle_ticks, controller.tick - idle_from)
                if watch is not None:
                    # A client that acts in `watch` may end what looks stuck.
                    idle_ticks, due = 0, controller.tick + 1 if due is None else due
            if not stays and (due is None or idle_ticks > IDLE_TICKS):
                if due is None and any(controller.joints().qd_target):
                    # A paused motion is not due again, but still brakes.
                    due = controller.tick + 1
                elif run is not None and run.state == "":
                    self._report_stuck()
                    continue
                elif limit is None:
                    return
            target = limit if due is None or (limit is not None and due > limit) else due
            assert target is not None
            if pace is not None:
                target = controller.tick + 1
            elif self.next_stop is not None and (stop := self.next_stop(controller.tick)) is not None:
                target = min(target, max(stop, controller.tick + 1))
            if self._trace is not None:
                target = min(target, controller.tick + TRACE_TICKS_MAX)
                self._trace.record(controller, target)
            if self._watch is not None:
                target = min(target, controller.tick + TRACE_TICKS_MAX)
                self._watch.record(controller, target)
            kernel.leap(target)

    def _raise_listener_error(self) -> None:
        if self._listener_error is not None:
            error, self._listener_error = self._listener_error, None
            raise error

    def _rest(self, run: Run) -> None:
        """Complete the record of a run whose program and arm have come to rest, once."""
        if run.is_over:
            return
        for event in self._limit.rest(self.tick):
            run.add(event, is_sum=True)
            self._tell(event)
        # A tick that has not run is the next program's: what the arm does in it is not known yet.
        has_run = self._kernel.has_run
        if self._trace is not None:
            if has_run:
                self._trace.finish(self.controller)
            self._trace = None
        if self._watch is not None:
            self._watch.finish(self.controller, has_run=has_run)
            self._watch = None
        run.rest(self._look(run))
        self._drain = Drain(
            self.tick, self._outside.channels, self._host.background, self._outside.surroundings, self._drain_s
        )

    def _is_drained(self) -> bool:
        """Return whether nothing of the program that is over is under way any more; its record is complete then."""
        if self._drain is not None and self._drain.is_over(self.tick):
            self._conclude()
        return self._drain is None

    def _conclude(self) -> None:
        """Give up what has not arrived, and complete the record."""
        drain, self._drain, run = self._drain, None, self._run
        if drain is None or run is None:
            return
        for text in drain.give_up():
            self.controller.emit(Warned(self.tick, said(NOT_DELIVERED, text=text), code=UNDELIVERED))
        if text := self._outside.take_refused():
            self.controller.emit(Warned(self.tick, text, code=BARRED))
        if self._outside.surroundings is not None:
            self._outside.surroundings.run_ended()
            if (observing := witness(self._kernel.probe)) is not None:
                observing.faults(self._outside.surroundings.fault_places(), self._outside.surroundings.faults_so_far())
        run.close(SignalRecord(self.controller.non_default_signals()))
        self._choose_record()

    def _drain_last(self) -> None:
        """Let what the last program gave away arrive, if it was stepped and its caller has not."""
        run = self._run
        if run is None or run.state == "" or run.is_closed:
            return
        self._rest(run)
        if not self._is_drained():
            self._advance(None, None, None)
        self._conclude()

    def _look(self, run: Run) -> Look:
        """Return the run as it stands at this tick."""
        state = self.controller.state()
        return Look(
            seconds(self.tick - run.start_tick),
            state.q_target,
            state.tcp_pose_target,
            SignalRecord(self.controller.non_default_signals()),
            ProgramGlobals(self._globals_of(run)),
        )

    def _globals_of(self, run: Run) -> dict[str, Any]:
        if run.unit.kind == SECONDARY:
            return {}
        return self._host.monitor() if self._globals is None else self._globals

    def _finish(self, state: EndState) -> None:
        """End a program that would go on, and the record of one that is over."""
        run = self._run
        if run is None:
            return
        if run.state == "":
            run.state = state
            run.threads = self._explained(run)
            if state == "time_limit" and (words := self._arm_words()) and run.threads:
                first, *others = run.threads
                because = joined("; ", filter(None, (first.because, words)))
                run.threads = (first._replace(because=because), *others)
            self._host.stop(state)
            self._host.run_tick(self.tick)
            if self._outside.surroundings is not None:
                self._outside.surroundings.settle()
        self._rest(run)

    def _explained(self, run: Run) -> tuple[ThreadState, ...]:
        """Return the script threads with the reason why each does not go on."""
        # Imported late: most runs go on.
        from elitescript.devices.facts import RunFacts

        facts = RunFacts(
            run.record.raw,
            is_whole=run.events_dropped == 0,
            start_tick=run.start_tick,
            surroundings=self._outside.surroundings,
            next_write=self.controller.next_write,
            has_clients=self._clients is not None,
        )
        return self._host.explained_threads(facts, run.start_tick)

    def _contact(self, contact: Contact, tick: int) -> None:
        """Warn of a contact."""
        self._event(Warned(tick, contact.text, "main", contact.line, "W273"))

    def _arm_words(self) -> str:
        """Return what keeps the arm from moving; empty if nothing does."""
        still = "the speed percentage is 0" if self.controller.speed_scale == 0.0 else ""
        return joined("; ", filter(None, (self.controller.safety.obstruction, still)))

    def _report_stuck(self) -> None:
        assert self._run is not None
        threads = self._explained(self._run)
        text = "{thread} (line {line}) {held}"
        waits = [said(text, thread=thread.name, line=thread.line, held=thread.held) for thread in threads]
        waits += filter(None, (self._arm_words(),))
        line = threads[0].line if threads else 0
        source = self._run.unit.source
        text = source.line(line) if line else ""
        alarm = Alarm(
            self.tick,
            "R130",
            "Stuck",
            said("nothing can ever happen again: {waits}", waits=joined("; ", waits)),
            line,
            1,
            "main",
            text,
        )
        self._event(alarm)
        self._finish("stuck")

    def _program_ended(self, state: str) -> None:
        """Note that the program has ended: `finished`, `alarm` or `stopped`."""
        run = self._run
        if run is not None and run.state == "" and run.unit.kind != SECONDARY:
            run.state = state  # type: ignore[assignment]
            if self._clients is not None:
                # A client may start another program before this one has come to rest.
                self._globals = self._host.monitor()

    def _choose_record(self) -> None:
        """Let changes of signals go to the record of the run at once, unless anything else needs their events."""
        run = self._run
        is_heard = self._on_event is not None and self.reports_signals
        is_needed = is_heard or self._clients is not None or self._outside.surroundings is not None
        self._kernel.on_change = None if is_needed or run is None or run.is_closed else run.record.add

    def _event(self, event: Event) -> None:
        if self._outside.surroundings is not None and isinstance(event, SignalChanged):
            self._outside.surroundings.signal_changed(event.name, event.value)
        run = self._run
        if run is None or run.is_closed:
            self._tell(event)
        elif type(event) not in LIMITED or self._limit.takes(event):
            run.add(event)
            if self._clients is not None or self._on_event is not None:
                self._tell(event)
        elif isinstance(event, FINDINGS):
            run.find(event)

    def _tell(self, event: Event) -> None:
        """Pass an event on to clients and listener."""
        if self._clients is not None:
            self._kernel.publish_event(event)
        if self._on_event is None or self._listener_error is not None:
            return
        try:
            self._on_event(event)
        except BaseException as error:
            if is_stop(error):
                raise  # the run was frozen in the listener, and is dropped
            # Scripts must not catch what is wrong with a listener: it leaves through `run`.
            self._listener_error = error
            self._host.interrupt()


def _findings_of(
    unit: CompiledUnit, firmware: Profile, arm: RobotModel, presets: tuple[str, ...], options: RobotOptions
) -> tuple[Diagnostic, ...]:
    """Return what `check` finds in the text of a program."""
    if unit.findings is not None:
        return unit.findings
    # Imported late: a run itself needs no rules.
    from elitescript.lint.engine import check_source

    return check_source(unit.source, firmware, strict=options.strict, presets=presets, arm=arm, ignored=options.ignored)


def _compiler_warnings(unit: CompiledUnit, ignored: frozenset[str]) -> Iterable[Diagnostic]:
    """Return what the compiler warns of, without what comments or options hide."""
    if not unit.diagnostics:
        return ()
    # Imported late: most texts have none.
    from elitescript.lint.suppression import without_suppressed

    return without_suppressed(unit.diagnostics, unit.source, ignored)


def _weakly(method: Any) -> Callable[[Any], None]:
    """Return a function that calls a method while its object lives, so that the machine does not keep its robot."""
    reference, function = ref(method.__self__), method.__func__

    def call(argument: Any) -> None:
        robot = reference()
        if robot is not None:
            function(robot, argument)

    return call


def _earliest(tick: int | None, other: int | None) -> int | None:
    return other if tick is None else tick if other is None else min(tick, other)


def _checked_presets(presets: Mapping[str, object]) -> dict[str, object]:
    """Return program globals that are given from outside.

    Raises:
        UsageError: a name that no program could give to a global.
    """
    for name in presets:
        if name.startswith("@"):
            # Of a constant that is varied: no text of a program can have such a name.
            continue
        if not name.isidentifier() or iskeyword(name) or name.startswith("__"):
            raise UsageError(f"{name!r} cannot be the name of a global")
    return dict(presets)
