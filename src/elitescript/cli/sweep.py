"""`elitescript sweep`: runs a program many times, and says what holds."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterable
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

from elitescript.cli.optimise import search_values, searches
from elitescript.cli.output.screen import Progress, progress_on
from elitescript.cli.robot_options import options_from
from elitescript.cli.settings import parse_size
from elitescript.errors import ProgramError, UsageError
from elitescript.language.diagnostics import render
from elitescript.language.text.source import SourceFile
from elitescript.sweep.engine import Engine
from elitescript.sweep.journal import SUFFIX, Journal
from elitescript.sweep.local import LocalEngine
from elitescript.sweep.making import make_plan, runs_of
from elitescript.sweep.plan import Plan, Row
from elitescript.sweep.plan_json import plan_digest
from elitescript.sweep.single import Runner
from elitescript.sweep.sweeping import Sweeping
from elitescript.sweep.tables import columns, format_of, json_line, values
from elitescript.sweep.variations import grid_size, parse_variation

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

HOLDS: Final = 0
FAILS: Final = 1
DOES_NOT_COMPILE: Final = 3
INTERRUPTED: Final = 130
"""Ctrl-C, as shells count it."""


def sweep(options: argparse.Namespace) -> int:
    """Run the sweep of the command line; return the exit code."""
    variations = [parse_variation(text) for text in options.vary]
    out = None if options.out is None else Path(options.out)
    part = None if out is None else out.with_name(out.name + SUFFIX)
    _check_out(options, out)
    plan = make_plan(
        Path(options.file),
        world=options.world,
        task_dir=options.task_dir,
        options=options_from(options),
        settings=options.set,
        variations=variations,
        seed=options.seed,
        until_s=options.until,
        ensure=options.ensure,
        measures=_measures(options.measure),
        chaos=options.chaos or "",
        step_s=options.step,
        has_margins=options.margins,
        without_files=[path for path in (out, part) if path is not None],
    )
    if searches(options):
        return search_values(options, plan, _engine(options), out)
    runs = runs_of(variations, options.runs)
    try:
        runner = Runner(plan)
    except ProgramError as error:
        _print_problems(error.problems, plan)
        return DOES_NOT_COMPILE
    if not options.json:
        _print_problems(runner.problems, plan)
    _note_grid(plan, runs)
    with ExitStack() as stack:
        if part is None:
            part = Path(stack.enter_context(TemporaryDirectory(prefix="elitescript-sweep-"))) / "journal"
        elif part.exists() and not options.resume:
            print(f"elitescript sweep: {part} is written anew; --resume would have gone on with it", file=sys.stderr)
        journal = stack.enter_context(Journal(part, plan, resumes=options.resume))
        sweeping = Sweeping(plan, runs, journal)
        if sweeping.done and not options.json:
            print(f"{sweeping.done:,} of {runs:,} runs are there already", file=sys.stderr)
        return _go(options, sweeping, out)


def _go(options: argparse.Namespace, sweeping: Sweeping, out: Path | None) -> int:
    plan = sweeping.plan
    progress = None if options.json else progress_on(sys.stderr)
    meter = _Meter(sweeping, progress)
    is_interrupted = False
    try:
        with _engine(options) as engine:
            sweeping.go(engine, meter.update, _print_row(plan) if options.json else None)
    except KeyboardInterrupt:
        is_interrupted = True
    failing: list[Row] = []

    def look(row: Row) -> None:
        if row.failure is not None:
            failing.append(row)

    sweeping.finish(None if is_interrupted else out, look)
    if options.json:
        data = {"type": "summary", "runs": sweeping.done, "failed": sweeping.failed, "digest": plan_digest(plan)}
        print(json_line(data, data.values()))
    else:
        print(f"{sweeping.done - sweeping.failed} of {sweeping.done} runs hold")
        for row in failing[:10]:
            assert row.failure is not None
            print(f"run {row.choices.run}: {row.failed}: {row.failure.text}")
    if is_interrupted:
        if out is not None:
            rest = f"--resume goes on from {sweeping.journal.path}"
        else:
            rest = "with --out FILE it could be gone on with"
        done = f"{sweeping.done:,} of {sweeping.runs:,} runs are done"
        print(f"elitescript sweep: ended by Ctrl-C; {done}; {rest}", file=sys.stderr)
        return INTERRUPTED
    if out is not None:
        sweeping.journal.path.unlink()
    return FAILS if sweeping.failed else HOLDS


def _engine(options: argparse.Namespace) -> Engine:
    jobs = options.jobs if options.jobs is not None else _cores()
    if jobs < 1:
        raise UsageError(f"--jobs must be 1 or more, got {jobs}")
    if options.max_wall is not None and not options.max_wall > 0.0:
        raise UsageError(f"--max-wall must be > 0 s, got {options.max_wall:g}")
    memory_bytes = parse_size(options.memory_limit, "--memory-limit")
    if options.dask is not None:
        if options.jobs is not None:
            raise UsageError("--jobs is for this computer; with --dask the cluster says how many workers there are")
        from elitescript.sweep.cluster import ClusterEngine

        return ClusterEngine(
            options.dask,
            max_wall_s=options.max_wall,
            memory_bytes=memory_bytes,
            is_mixed=options.mixed,
            note=lambda text: print(f"elitescript sweep: {text}", file=sys.stderr),
        )
    if options.mixed:
        raise UsageError("--mixed goes with --dask")
    return LocalEngine(jobs, max_wall_s=options.max_wall, memory_bytes=memory_bytes)


def _cores() -> int:
    """Return the number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class _Meter:
    """Shows how far a sweep is."""

    def __init__(self, sweeping: Sweeping, progress: Progress | None) -> None:
        self._progress = progress
        self._runs = sweeping.runs
        self._done = sweeping.done
        self._start_s = time.monotonic()

    def update(self, done: int, failed: int) -> None:
        """Show it."""
        if self._progress is None:
            return
        rate = (done - self._done) / max(time.monotonic() - self._start_s, 1e-9)
        self._progress.note(f"{done:,} of {self._runs:,} runs, {failed:,} fail, {rate:,.0f} runs/s")


def _check_out(options: argparse.Namespace, out: Path | None) -> None:
    """Refuse a table that could not be written, before the first run."""
    if out is None:
        if options.resume:
            raise UsageError("--resume goes with --out, beside which the rows so far are kept")
        return
    format_of(out)
    if not out.parent.is_dir():
        raise UsageError(f"--out {out}: there is no folder {out.parent}")
    if out.is_dir():
        raise UsageError(f"--out {out}: it is a folder")


def _measures(texts: Iterable[str]) -> dict[str, str]:
    found: dict[str, str] = {}
    for text in texts:
        name, equals, expression = text.partition("=")
        name = name.strip()
        if not equals or not name.isidentifier() or expression.startswith("="):
            raise UsageError(f"--measure {text}: write NAME=EXPRESSION")
        if name in found:
            raise UsageError(f"--measure {text}: {name} is measured twice")
        found[name] = expression.strip()
    return found


def _note_grid(plan: Plan, runs: int) -> None:
    size = grid_size(plan.variations)
    if any(row.kind == "grid" for row in plan.variations) and runs % size:
        print(f"elitescript sweep: {runs} runs are no multiple of the {size} points of the grid", file=sys.stderr)


def _print_problems(problems: Iterable[Any], plan: Plan) -> None:
    source = SourceFile(plan.program_name, plan.program)
    for problem in problems:
        print(render(problem, source.name, source.line(problem.line)), file=sys.stderr)


def _print_row(plan: Plan) -> Any:
    names = ("type", *columns(plan))

    def show(row: Row) -> None:
        print(json_line(names, ("row", *values(row, plan))), flush=True)

    return show
