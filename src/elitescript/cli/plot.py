"""`elitescript plot`: shows a run or a trace as an HTML page."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Final

from elitescript.cli.output.report import TextRunReport
from elitescript.cli.output.screen import palette_of, progress_on, rendered
from elitescript.cli.robot_options import options_from
from elitescript.cli.run import DOES_NOT_COMPILE, NO_FILE
from elitescript.cli.watched import watch_for_crashes
from elitescript.environment.network_option import COMMAND_LINE
from elitescript.environment.program_file import refused_source, source_of
from elitescript.environment.start_values import parse_settings
from elitescript.errors import ProgramError, UsageError
from elitescript.findings.found import Findings
from elitescript.kernel.options import DEFAULTS, OPTIONS, UNTIL, accepted
from elitescript.lint.engine import compile_checked
from elitescript.messages.timing import PERIOD_S
from elitescript.models.model import load_model
from elitescript.outputs.writing import Output
from elitescript.page import NOT_BUILT, is_built
from elitescript.paths import real_path
from elitescript.plotting.page import page_of
from elitescript.plotting.recorder import RunRecorder
from elitescript.plotting.recording import Recording
from elitescript.plotting.sampling import Sampling
from elitescript.plotting.trace_reader import SUFFIXES, read_trace
from elitescript.robot import VirtualRobot
from elitescript.run import EXIT_CODES
from elitescript.shown import shown_word

UNTIL_S: Final = 300.0
"""Default limit of robot time."""

_OF_PROGRAMS: Final = ("until", "task_dir", "set", "world")
"""Arguments for programs only, besides the options of the robot."""


def plot(options: argparse.Namespace) -> int:
    """Write the page; return the exit code, which for a program is that of `run`."""
    watch_for_crashes()
    if options.case is not None:
        return _plot_case(options)
    if options.file is None:
        raise UsageError(NO_FILE)
    path = Path(options.file)
    comparing = options.compare is not None or options.compare_robot is not None or options.compare_world is not None
    compared: Recording | None = None
    try:
        recording, code = _recording(path, options)
        if comparing:
            path = path if options.compare is None else Path(options.compare)
            compared, _ = _recording(path, _options_of_compared(path, options))
    except ProgramError as error:
        _print_problems(path, error)
        return DOES_NOT_COMPILE
    if not is_built():
        if comparing:
            raise UsageError(f"--compare: {NOT_BUILT}")
        print(f"a plain page is written: {NOT_BUILT}", file=sys.stderr)
    _write(options.outputs["output"], recording, compared)
    return code


def _plot_case(options: argparse.Namespace) -> int:
    """Write the page of a run of a sweep; return the exit code, which is that of its end."""
    # Imported late: plots without a case need nothing of sweeps.
    from elitescript.cli.case import replay_of

    path = Path(options.case)
    replay = replay_of(options)
    report = TextRunReport(sys.stderr, sys.stderr)
    robot = replay.robot(report.event)
    robot.reports_signals = False
    recorder = RunRecorder(robot, Sampling())
    run = robot.run(**replay.arguments(), trace=recorder.sampling, watch=recorder.watch)
    if not is_built():
        print(f"a plain page is written: {NOT_BUILT}", file=sys.stderr)
    source = source_of(replay.program)
    _write(options.outputs["output"], recorder.recording(path.name, robot, source, run, replay.runner.problems))
    return EXIT_CODES[run.state]


def _write(output: Output, recording: Recording, compared: Recording | None = None) -> None:
    found = page_of(recording, compared)
    output.finish(found.text)
    step_s = max(recording.step_s, found.step_s)
    step = "" if step_s <= PERIOD_S else f", a row every {1000.0 * step_s:g} ms"
    other = "" if compared is None else f"; compared with {_in_words(compared)}"
    size = f"{len(found.text) / 1000:.0f} kB"
    # Not into a page that goes to standard output.
    stream = sys.stdout if output.is_file else sys.stderr
    print(f"{shown_word(str(output.path))}: {_in_words(recording)}{step}{other} ({size})", file=stream)


def _in_words(recording: Recording) -> str:
    """Return duration, arm and end of a run, and how much was found."""
    duration_s = recording.rows[-1].t - recording.rows[0].t
    ending = {"time_limit": f", cut off at {duration_s:g} s (--until)", "": ""}.get(
        recording.state, f", {recording.state}"
    )
    counted = Findings(recording.findings).without_alarms.words
    return f"{duration_s:.3f} s of {recording.model.name}{ending}{f', {counted}' if counted else ''}"


def _options_of_compared(path: Path, options: argparse.Namespace) -> argparse.Namespace:
    """Return the options of the other run: those of the first but for robot and world; of a trace the robot alone."""
    given = vars(options)
    if path.suffix in SUFFIXES:
        given = {name: value for name, value in given.items() if name == "model" or name not in OPTIONS}
        given |= {"until": None, "task_dir": None, "set": [], "world": None}
    changed = argparse.Namespace(**given)
    if options.compare_robot is not None:
        changed.model = options.compare_robot
    if options.compare_world is not None:
        changed.world = options.compare_world
    return changed


def _recording(path: Path, options: argparse.Namespace) -> tuple[Recording, int]:
    """Return what a page shows of a program or a trace, and the exit code."""
    return (_recorded(path, options), 0) if path.suffix in SUFFIXES else _played(path, options)


def _recorded(path: Path, options: argparse.Namespace) -> Recording:
    given = options_from(options)
    model = load_model(given.pop("model", DEFAULTS["model"]))
    flags = [OPTIONS[name].flag for name in given]
    flags += [f"--{name.replace('_', '-')}" for name in _OF_PROGRAMS if getattr(options, name) not in (None, [])]
    if flags:
        raise UsageError(f"{flags[0]} goes with a program; {path} is a trace")
    return Recording(path.name, model, read_trace(path))


def _played(path: Path, options: argparse.Namespace) -> tuple[Recording, int]:
    until_s = UNTIL_S if options.until is None else options.until
    accepted(UNTIL, until_s, "--until")
    signals, presets = parse_settings(options.set)
    report = TextRunReport(sys.stderr, sys.stderr)
    robot = VirtualRobot(
        task_dir=options.task_dir or real_path(path).parent,
        world=options.world,
        on_event=report.event,
        **options_from(options),
    )
    robot.set_network_by(COMMAND_LINE)
    robot.reports_signals = False
    robot.set_start(signals)
    source = source_of(path, options.task_dir, is_generated=options.generated)
    report.problems((), source)
    recorder = RunRecorder(robot, Sampling())
    checked = compile_checked(source, robot.profile, robot.text_options(source), presets=presets, arm=robot.model)
    progress = progress_on(sys.stderr, robot.time_s)

    def watch(robot: VirtualRobot) -> None:
        if progress is not None:
            progress.update(robot.time_s, robot.controller.line)
        recorder.watch(robot)

    run = robot.run(robot.compile(source), until_s=until_s, presets=presets, trace=recorder.sampling, watch=watch)
    code = run.exit_code(is_strict=robot.options.strict)
    return recorder.recording(path.name, robot, source, run, checked.problems), code


def _print_problems(path: Path, error: ProgramError) -> None:
    source = refused_source(path)
    for problem in error.problems:
        print(rendered(problem, source, palette_of(sys.stderr)), file=sys.stderr)
