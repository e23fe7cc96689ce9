"""`elitescript run`: runs a program to its end, with a report as text or JSON lines."""

from __future__ import annotations

import signal
import sys
import time
from contextlib import ExitStack
from pathlib import Path
from types import FrameType
from typing import Any, Final, Literal

from elitescript.cli.output.report import JsonRunReport, RunReport, TextRunReport, parse_logs
from elitescript.cli.output.screen import CALLS, Progress, progress_on
from elitescript.cli.output.trace_file import TraceFile
from elitescript.cli.robot_options import options_from
from elitescript.cli.settings import parse_size
from elitescript.cli.watched import watch_for_crashes
from elitescript.controller.views.trace import Trace, step_ticks
from elitescript.controller.views.trace_signals import TraceSignals
from elitescript.environment.network_option import COMMAND_LINE
from elitescript.environment.process import limit_memory
from elitescript.environment.program_file import refused_source, source_of
from elitescript.environment.start_values import check_presets, parse_settings
from elitescript.errors import ElitescriptError, ProgramError, UsageError
from elitescript.kernel.options import UNTIL, accepted
from elitescript.language.parser import parse
from elitescript.messages.events import DeviceNoted
from elitescript.paths import real_path
from elitescript.robot import VirtualRobot
from elitescript.run import EXIT_CODES, record_of
from elitescript.shown import shown

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

FAILED: Final = 1
"""The program was run, and ended by an alarm or a device that has failed."""
DOES_NOT_COMPILE: Final = 3
NO_FILE: Final = "FILE is missing: name a program"

HINT_AFTER_S: Final = 5.0
"""Interval of wall time after which a run without a status line reports its place."""

STOP_LIMIT_S: Final = 1.0
"""Time for a program or a device to end after Ctrl-C, before a message about a second one is printed."""


def run(options: argparse.Namespace) -> int:
    """Run the program of the command line; return the exit code."""
    if watch_for_crashes():
        limit_memory(parse_size(options.memory_limit, "--memory-limit"))
    if options.json and options.format not in (None, "json"):
        raise UsageError(f"--json and --format {options.format} contradict each other")
    options.json = options.json or options.format == "json"
    record_of(options.keep)  # refused before anything is read or written
    report = _report(options)
    code = _run(options, report)
    report.finish()
    return code


def _report(options: argparse.Namespace) -> RunReport:
    logs = parse_logs(options.log)
    if options.json:
        return JsonRunReport(sys.stdout)
    if options.format in ("github", "sarif"):
        # Imported late: a run for people needs no other form.
        from elitescript.cli.output.run_formats import FindingsReport

        return FindingsReport(options.format, logs)
    return TextRunReport(sys.stdout, sys.stderr, logs)


def _run(options: argparse.Namespace, report: RunReport) -> int:
    if options.case is not None:
        return _run_case(options, report)
    if options.file is None:
        raise UsageError(NO_FILE)
    path = Path(options.file)
    levels, presets = parse_settings(options.set)
    robot = VirtualRobot(
        task_dir=options.task_dir or real_path(path).parent,
        task_dir_limit=parse_size(options.task_dir_limit, "--task-dir-limit"),
        world=options.world,
        lines=_lines(options.serial),
        state_file=options.state,
        on_event=report.event,
        **options_from(options),
    )
    robot.set_network_by(COMMAND_LINE)
    robot.reports_signals = options.json or "signals" in parse_logs(options.log)
    robot.set_start(levels)
    for name, value in (("--until", options.until), ("--max-wall", options.max_wall)):
        if value is not None:
            accepted(UNTIL, value, name)
    try:
        source = (
            source_of(path, options.task_dir, is_generated=options.generated)
            if options.parsed is None
            else options.parsed.source
        )
    except ProgramError as error:
        report.problems(error.problems, refused_source(path))
        return DOES_NOT_COMPILE
    from elitescript.lint.engine import check_parsed

    language = robot.text_options(source)
    parsed = (options.parsed or parse(source, language))._replace(options=language)
    checked = check_parsed(parsed, robot.profile, presets=presets, arm=robot.model)
    report.problems(checked.problems, source)
    unit = checked.unit
    if unit is None or checked.is_refused:
        return DOES_NOT_COMPILE
    check_presets(presets, source.text)
    if errors := sum(problem.is_error for problem in checked.problems):
        report.goes_on(errors)
    with ExitStack() as stack:
        trace = _trace(options, robot, stack)
        report.start()
        progress = None if options.json else progress_on(sys.stderr, robot.time_s)
        watch = _Watch(report, options.max_wall, progress)
        pace = _pacer() if options.realtime else None
        with _InterruptHandler(robot) as interrupted:
            try:
                result = robot.run(
                    unit,
                    until_s=options.until,
                    presets=presets,
                    trace=trace,
                    keep=options.keep,
                    pace=pace,
                    watch=watch,
                )
            except ElitescriptError as error:
                from elitescript.devices.agenda import DeviceError

                # A device beside the robot has failed: readers of records need that event, and the end.
                if options.json and robot.current is not None:
                    report.event(DeviceNoted(robot.tick, "world", str(error), is_warning=True))
                    report.end(robot.current, is_interrupted=False, overruns=None)
                if not isinstance(error, DeviceError):
                    raise
                print(f"elitescript run: {shown(str(error))}", file=sys.stderr)
                return FAILED
    overruns, strict = None if pace is None else pace.overruns, robot.options.strict
    report.end(result, is_interrupted=bool(interrupted.number), overruns=overruns, is_strict=strict)
    return interrupted.exit_code or result.exit_code(is_strict=strict)


def _run_case(options: argparse.Namespace, report: RunReport) -> int:
    """Play a run of a sweep again; return the exit code, which is that of its end."""
    # Imported late: runs without a case need nothing of sweeps.
    from elitescript.cli.case import CaseReport, replay_of

    try:
        replay = replay_of(options)
    except ProgramError as error:
        report.problems(error.problems, refused_source(Path(error.file)) if error.file else None)
        return DOES_NOT_COMPILE
    report.problems(replay.runner.problems, source_of(replay.program))
    with ExitStack() as stack:
        trace = _trace(options, replay.robot(), stack)
        report.start()
        handlers: list[_InterruptHandler] = []

        def before(robot: VirtualRobot) -> None:
            handlers.append(stack.enter_context(_InterruptHandler(robot)))

        played = replay.play(trace=trace or None, on_event=report.event, before=before)
        stopped = handlers[0].exit_code if handlers else 0
    said = CaseReport(replay, played)
    if options.json:
        print(said.text(), flush=True)
    if played.run is None:
        raise UsageError(played.words)
    report.end(played.run, is_interrupted=bool(stopped), overruns=None)
    if not options.json:
        print(*map(shown, said.lines()), sep="\n", file=sys.stderr)
    return stopped or EXIT_CODES[played.run.state]


def _trace(options: argparse.Namespace, robot: VirtualRobot, stack: ExitStack) -> Trace | Literal[False]:
    """Return what writes the rows of `--trace`; False without it."""
    if options.trace is not None:
        step_ticks(options.step)
        has_actual = not robot.controller.is_plant_ideal
        signals = None if options.trace_signals is None else TraceSignals(options.trace_signals)
        names = () if signals is None else signals.names
        file = stack.enter_context(TraceFile(options.outputs["trace"], has_actual=has_actual, signals=names))
        return Trace(file.write, options.step, signals)
    if options.step is not None:
        raise UsageError("--step goes with --trace")
    if options.trace_signals is not None:
        raise UsageError("--trace-signals goes with --trace")
    return False


def _lines(bindings: list[str]) -> dict[str, str] | None:
    if not bindings:
        return None
    from elitescript.environment.line_bindings import parse_bindings

    return parse_bindings(bindings)


def _pacer() -> Any:
    from elitescript.services.time.pacing import Pacer

    return Pacer()


class _Watch:
    """Checks the wall clock while the program runs: shows its place, and ends it at the limit."""

    __slots__ = ("_calls", "_end_s", "_next_hint_s", "_progress", "_report", "_start_s")

    def __init__(self, report: RunReport, max_wall_s: float | None, progress: Progress | None) -> None:
        self._report = report
        self._progress = progress
        self._calls = CALLS
        self._start_s = time.monotonic()
        self._next_hint_s = self._start_s + HINT_AFTER_S
        self._end_s = None if max_wall_s is None else self._start_s + max_wall_s

    def __call__(self, robot: VirtualRobot) -> None:
        if self._end_s is not None and time.monotonic() >= self._end_s:
            robot.interrupt("time_limit")
        elif self._progress is not None:
            self._progress.update(robot.time_s, robot.controller.line)
        elif self._calls > 0:
            self._calls -= 1
        else:
            self._calls = CALLS
            now_s = time.monotonic()
            if now_s >= self._next_hint_s:
                self._next_hint_s = now_s + HINT_AFTER_S
                self._report.still_running(robot, now_s - self._start_s)


class _InterruptHandler:
    """Ends the program at its next checkpoint after Ctrl-C or another signal to stop, and the process at once after a
    second Ctrl-C.

    Attributes:
        number: of the signal; 0 if none has come.
    """

    def __init__(self, robot: VirtualRobot) -> None:
        self._robot = robot
        self.number = 0
        self._previous: dict[int, Any] = {}
        self._timer: Any = None

    @property
    def exit_code(self) -> int:
        """Exit code of a run that a signal has ended, as shells count it; 0 if none has come."""
        return 128 + self.number if self.number else 0

    def __enter__(self) -> _InterruptHandler:
        # Of the others those are handled of which the process is to be left; see `leave_by_signals`.
        others = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]
        numbers = [signal.SIGINT, *(number for number in others if callable(signal.getsignal(number)))]
        self._previous = {number: signal.signal(number, self._handle) for number in numbers}
        return self

    def _handle(self, number: int, _frame: FrameType | None) -> None:
        self.number = number
        signal.signal(number, signal.SIG_DFL)
        self._robot.interrupt()
        # Few runs are interrupted, and importing threads takes time.
        from threading import Timer

        self._timer = Timer(STOP_LIMIT_S, self._print_hint)
        self._timer.daemon = True
        self._timer.start()

    @staticmethod
    def _print_hint() -> None:
        print(
            "elitescript run: still busy: a call of the program or of a device does not come back; "
            "Ctrl-C again ends it at once",
            file=sys.stderr,
            flush=True,
        )

    def __exit__(self, *_: object) -> None:
        if self._timer is not None:
            self._timer.cancel()
        for number, handler in self._previous.items():
            signal.signal(number, handler)
