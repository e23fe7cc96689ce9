"""`elitescript plot`: shows a run or a trace as an HTML page."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Final

from elitescript.cli.output.report import TextRunReport
from elitescript.cli.output.screen import palette_of, progress_on, rendered
from elitescript.cli.robot_options import options_from
from elitescript.cli.run import DOES_NOT_COMPILE
from elitescript.cli.watched import watch_for_crashes
from elitescript.environment.program_file import source_of
from elitescript.environment.start_values import parse_settings
from elitescript.errors import ProgramError, UsageError
from elitescript.kernel.options import DEFAULTS, OPTIONS
from elitescript.language.text.source import SourceFile
from elitescript.messages.timing import PERIOD_S
from elitescript.models.model import load_model
from elitescript.plotting.line_times import ThreadLines
from elitescript.plotting.page import Recording, page
from elitescript.plotting.sampling import Sampling
from elitescript.plotting.trace_reader import SUFFIXES, read_trace
from elitescript.robot import VirtualRobot
from elitescript.run import EXIT_CODES

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

UNTIL_S: Final = 300.0
"""Default limit of robot time."""

_OF_PROGRAMS: Final = ("until", "task_dir", "set", "world")
"""Arguments for programs only, besides the options of the robot."""


def plot(options: argparse.Namespace) -> int:
    """Write the page; return the exit code, which for a program is that of `run`."""
    watch_for_crashes()
    path = Path(options.file)
    target = Path(options.output) if options.output else Path(f"{path.stem}.plot.html")
    if target.exists() and path.exists() and target.samefile(path):
        raise UsageError(f"-o {target}: this is the file that is to be plotted")
    if path.suffix in SUFFIXES:
        recording, code = _recorded(path, options), 0
    else:
        try:
            recording, code = _played(path, options)
        except ProgramError as error:
            _print_problems(path, error)
            return DOES_NOT_COMPILE
    text = page(recording)
    try:
        # A text of a program may hold half a surrogate pair; its escape is valid JSON.
        target.write_text(text, encoding="utf-8", errors="backslashreplace", newline="\n")
    except OSError as error:
        raise UsageError(f"-o {target}: {error.strerror or error}") from error
    duration_s = recording.rows[-1].t - recording.rows[0].t
    ending = {"time_limit": f", cut off at {duration_s:g} s (--until)", "": ""}.get(
        recording.state, f", {recording.state}"
    )
    step = "" if recording.step_s <= PERIOD_S else f", a row every {1000.0 * recording.step_s:g} ms"
    print(
        f"{target}: {duration_s:.3f} s of {recording.model.name}{ending}{step} ({target.stat().st_size / 1000:.0f} kB)"
    )
    return code


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
    if not until_s >= 0.0:
        raise UsageError(f"--until must be >= 0 s, got {until_s:g}")
    signals, presets = parse_settings(options.set)
    report = TextRunReport(sys.stderr, sys.stderr)
    robot = VirtualRobot(
        task_dir=options.task_dir or path.resolve().parent,
        world=options.world,
        on_event=report.event,
        **options_from(options),
    )
    robot.reports_signals = False
    robot.set_start(signals)
    source = source_of(path)
    sampling, threads = Sampling(), ThreadLines()

    progress = progress_on(sys.stderr, robot.time_s)

    def watch(robot: VirtualRobot) -> None:
        if progress is not None:
            progress.update(robot.time_s, robot.controller.line)
        threads.record(robot.time_s, [(thread.name, thread.line) for thread in robot.threads()[1:]])

    run = robot.run(robot.compile(source), until_s=until_s, presets=presets, trace=sampling, watch=watch)
    recording = Recording(
        path.name,
        robot.model,
        sampling.rows,
        source,
        run.events,
        run.state,
        sampling.step_s,
        threads.stretches(sampling.rows[-1].t),
    )
    return recording, EXIT_CODES[run.state]


def _print_problems(path: Path, error: ProgramError) -> None:
    source = SourceFile(str(path), path.read_bytes().decode("utf-8", "replace"))
    for problem in error.problems:
        print(rendered(problem, source, palette_of(sys.stderr)), file=sys.stderr)
