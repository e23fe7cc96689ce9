"""`elitescript run`: a program from its start to its end, on the terminal or as JSON lines."""

from __future__ import annotations

import argparse
import signal
import sys
import time
from collections.abc import Collection
from contextlib import ExitStack
from pathlib import Path
from types import FrameType
from typing import Any, Final

from elitescript.cli.report import JsonReport, Report, TextReport
from elitescript.cli.settings import check_presets, parse_epoch, parse_joints, parse_settings, parse_size
from elitescript.cli.trace_file import TraceFile
from elitescript.cli.watched import limit_memory, watch_for_crashes
from elitescript.controller.trace import Trace, step_ticks
from elitescript.errors import ElitescriptError, ProgramError, UsageError
from elitescript.language.diagnostics import Diagnostic, Severity
from elitescript.language.source import SourceFile
from elitescript.messages.events import DeviceNoted
from elitescript.robot import VirtualRobot
from elitescript.wiring import EPOCH_S
from elitescript.worlds.program_file import source_of

EXIT_CODES: Final = {"finished": 0, "stopped": 0, "alarm": 1, "time_limit": 4, "stuck": 5}
DOES_NOT_COMPILE: Final = 3
INTERRUPTED: Final = 130
"""Ctrl-C, as shells count it."""

HINT_AFTER_S: Final = 5.0
"""Wall time after which a run says where it is; then again after each such time."""

PATIENCE_S: Final = 1.0
"""What a program or a device has to come to an end after Ctrl-C, before people are told how to end the process."""


def run(options: argparse.Namespace) -> int:
    """Run the program of the command line; return the exit code."""
    if watch_for_crashes():
        limit_memory(parse_size(options.memory_limit, "--memory-limit"))
    path = Path(options.file)
    report: Report = JsonReport(sys.stdout) if options.json else TextReport(sys.stdout, sys.stderr)
    signals, presets = parse_settings(options.set)
    robot = VirtualRobot(
        options.robot,
        firmware=options.firmware,
        seed=options.seed,
        joints=None if options.joints is None else parse_joints(options.joints),
        speed=options.speed,
        task_dir=options.task_dir or path.resolve().parent,
        task_dir_limit=parse_size(options.task_dir_limit, "--task-dir-limit"),
        strict=options.strict,
        epoch_s=EPOCH_S if options.epoch is None else parse_epoch(options.epoch),
        rpc_timeout_s=options.rpc_timeout,
        world=options.world,
        lines=_lines(options.serial),
        state_file=options.state,
        on_event=report.event,
    )
    for name, value in signals.items():
        robot.signals[name] = value
    for name, value in (("--until", options.until), ("--max-wall", options.max_wall)):
        if value is not None and not value >= 0.0:
            raise UsageError(f"{name} must be >= 0 s, got {value:g}")
    try:
        source = source_of(path)
    except ProgramError as error:
        report.problems(error.problems, SourceFile(str(path), path.read_bytes().decode("utf-8", "replace")))
        return DOES_NOT_COMPILE
    problems = _find_problems(robot, source, strict=options.strict, presets=presets)
    report.problems(problems, source)
    if any(problem.severity is Severity.ERROR for problem in problems):
        return DOES_NOT_COMPILE
    unit = robot.compile(source)
    check_presets(presets, source.text)
    with ExitStack() as stack:
        trace: bool | Trace = False
        if options.trace is not None:
            step_ticks(options.step)  # before the file of that name is emptied
            has_actual = not robot.controller.is_plant_ideal
            trace_file = stack.enter_context(TraceFile(Path(options.trace), has_actual=has_actual))
            trace = Trace(trace_file.write, options.step)
        elif options.step is not None:
            raise UsageError("--step goes with --trace")
        report.start(robot, path)
        watch = _Watch(report, options.max_wall)
        pace = _pacer() if options.realtime else None
        with _InterruptHandler(robot) as interrupted:
            try:
                result = robot.run(
                    unit,
                    until_s=options.until,
                    presets=presets,
                    trace=trace,
                    pace=pace,
                    watch=watch,
                )
            except ElitescriptError as error:
                # A device beside the robot has failed. Who reads records is to hear of it, and of the end.
                if options.json and robot.current is not None:
                    report.event(DeviceNoted(robot.tick, "world", str(error), is_warning=True))
                    report.end(robot.current, is_interrupted=False, overruns=None)
                raise
    report.end(result, is_interrupted=interrupted.happened, overruns=None if pace is None else pace.overruns)
    return INTERRUPTED if interrupted.happened else EXIT_CODES[result.state]


def _lines(bindings: list[str]) -> dict[str, str] | None:
    if not bindings:
        return None
    from elitescript.worlds.line_bindings import parse_bindings

    return parse_bindings(bindings)


def _pacer() -> Any:
    from elitescript.services.pacing import Pacer

    return Pacer()


def _find_problems(
    robot: VirtualRobot, source: SourceFile, *, strict: bool, presets: Collection[str]
) -> tuple[Diagnostic, ...]:
    """What `check` finds, with findings against the catalogue as warnings: programs may catch them."""
    from dataclasses import replace

    from elitescript.lint.engine import check_source

    problems = check_source(source, robot.profile, strict=strict, presets=presets)
    if strict:
        return problems
    return tuple(
        replace(problem, severity=Severity.WARNING) if problem.code.startswith("E3") else problem
        for problem in problems
    )


class _Watch:
    """Looks at the wall clock while the program runs: says where it is, and ends it at the limit."""

    def __init__(self, report: Report, max_wall_s: float | None) -> None:
        self._report = report
        self._start_s = time.monotonic()
        self._next_hint_s = self._start_s + HINT_AFTER_S
        self._end_s = None if max_wall_s is None else self._start_s + max_wall_s

    def __call__(self, robot: VirtualRobot) -> None:
        now_s = time.monotonic()
        if self._end_s is not None and now_s >= self._end_s:
            robot.interrupt("time_limit")
        elif now_s >= self._next_hint_s:
            self._next_hint_s = now_s + HINT_AFTER_S
            self._report.still_running(robot, now_s - self._start_s)


class _InterruptHandler:
    """Ctrl-C ends the program at its next checkpoint; a second one ends the process at once."""

    def __init__(self, robot: VirtualRobot) -> None:
        self._robot = robot
        self.happened = False
        self._previous: Any = None
        self._timer: Any = None

    def __enter__(self) -> _InterruptHandler:
        self._previous = signal.signal(signal.SIGINT, self._handle)
        return self

    def _handle(self, _number: int, _frame: FrameType | None) -> None:
        self.happened = True
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        self._robot.interrupt()
        # Hardly any run is interrupted, and threads take their time to load.
        from threading import Timer

        self._timer = Timer(PATIENCE_S, self._say)
        self._timer.daemon = True
        self._timer.start()

    @staticmethod
    def _say() -> None:
        print(
            "elitescript run: still busy: a call of the program or of a device does not come back; "
            "Ctrl-C again ends it at once",
            file=sys.stderr,
            flush=True,
        )

    def __exit__(self, *_: object) -> None:
        if self._timer is not None:
            self._timer.cancel()
        signal.signal(signal.SIGINT, self._previous)
