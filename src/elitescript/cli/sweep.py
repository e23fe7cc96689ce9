"""`elitescript sweep`: runs a program many times, and says what holds."""

from __future__ import annotations

import shlex
import sys
import time
from collections.abc import Iterable
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

from elitescript.cli.optimise import search_values, searches
from elitescript.cli.output.screen import palette_of, progress_on, rendered
from elitescript.cli.output.writable import Writable
from elitescript.cli.robot_options import options_from
from elitescript.cli.settings import parse_size
from elitescript.codec.json_text import to_text
from elitescript.environment.process import cores
from elitescript.environment.stop_signals import Stopped, cause_of, exit_code_of
from elitescript.errors import ProgramError, UsageError
from elitescript.page import NOT_BUILT, is_built
from elitescript.paths import PROGRAM_SUFFIX
from elitescript.shown import shown, shown_word
from elitescript.sweep.chaos.properties import properties_of
from elitescript.sweep.engines.engine import Engine
from elitescript.sweep.engines.local import LocalEngine
from elitescript.sweep.failures.findings import KINDS_MAX, Finding, Places, Remembered, Shrinkings, find, remembered
from elitescript.sweep.making import make_plan, runs_of
from elitescript.sweep.plans.plan import Plan, Row
from elitescript.sweep.plans.plan_json import disturbance_data, plan_digest
from elitescript.sweep.plans.trees import source_of_plan
from elitescript.sweep.plans.variations import grid_size, parse_variation
from elitescript.sweep.results.journal import Journal
from elitescript.sweep.results.page import PAGE_SAMPLE
from elitescript.sweep.results.progress import Meter
from elitescript.sweep.results.replays import write_pages
from elitescript.sweep.results.summary import Summary, summary_of
from elitescript.sweep.results.table_files import Finished, TableFiles
from elitescript.sweep.results.tables import check_table, columns, json_line, values
from elitescript.sweep.results.totals import SAMPLE, Totals
from elitescript.sweep.single import Runner
from elitescript.sweep.sweeping import Sweeping, is_random

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

HOLDS: Final = 0
FAILS: Final = 1
DOES_NOT_COMPILE: Final = 3
LINE_S: Final = 10.0
"""Wall time between two lines of progress where there is no terminal."""


def sweep(options: argparse.Namespace) -> int:
    """Run the sweep of the command line; return the exit code."""
    variations = [parse_variation(text) for text in options.vary]
    out = None if options.out is None else Path(options.out)
    _check_out(options, out)
    if options.shrink_runs < 0:
        raise UsageError(f"--shrink-runs must be 0 or more, got {options.shrink_runs}")
    files = None if out is None else TableFiles(out)
    if files is not None:
        files.check()
    if options.page is not None and not is_built():
        raise UsageError(f"--page: {NOT_BUILT}")
    plan = make_plan(
        Path(options.file),
        world=options.world,
        task_dir=options.task_dir,
        options=options_from(options),
        settings=options.set,
        variations=variations,
        seed=options.sweep_seed,
        until_s=options.until,
        ensure=options.ensure,
        measures=_measures(options.measure),
        chaos=options.chaos or "",
        step_s=options.step,
        has_margins=options.margins,
        is_generated=options.generated,
        without_files=[*(files or ()), *([Path(options.page)] if options.page else ())],
    )
    if options.json and "type" in columns(plan):
        raise UsageError("--json: a column called 'type' would hide what each line is; choose another name")
    if searches(options):
        return search_values(options, plan, _engine(options), files)
    runs = runs_of(variations, options.runs)
    first = 0
    if options.only is not None:
        _check_only(options, runs)
        first, runs = options.only, options.only + 1
    try:
        runner = Runner(plan)
    except ProgramError as error:
        _print_problems(error.problems, plan)
        return DOES_NOT_COMPILE
    if not options.json:
        _print_problems(runner.problems, plan)
    if options.only is None:
        _note_grid(plan, runs)
    with ExitStack() as stack:
        if files is None:
            home = stack.enter_context(TemporaryDirectory(prefix="elitescript-sweep-"))
            journal = stack.enter_context(Journal(Path(home, "journal"), plan, resumes=False))
        else:
            if options.resume and (found := files.finished(plan)) is not None:
                # A page needs the rows; a table that was deleted is written again from them.
                if found.runs >= runs and options.page is None and files.table.exists():
                    return _say_finished(options, files.table, found)
                runs = max(runs, found.runs)
            if files.part.exists() and not options.resume:
                _note(f"{files.part} is written anew; --resume would have gone on with it")
            journal = stack.enter_context(files.journal(plan, resumes=options.resume))
        sweeping = Sweeping(plan, runs, journal, first)
        if sweeping.done and not options.json:
            print(f"{sweeping.done:,} of {runs:,} runs are there already", file=sys.stderr)
        return _go(options, sweeping, runner, files)


def _say_finished(options: argparse.Namespace, table: Path, found: Finished) -> int:
    """Say that there is nothing left to do; return the exit code."""
    if options.json:
        _print_json(type="finished", out=str(table), runs=found.runs, failed=found.failed)
        return HOLDS
    few = f", {options.runs:,} are asked for" if options.runs is not None and options.runs < found.runs else ""
    rest = f"{found.failed:,} of them failed" if found.failed else "all of them hold"
    name = shown_word(str(table))
    print(f"{name} is finished: it has the {found.runs:,} runs of these settings{few}, and {rest}; nothing was run")
    return HOLDS


def _go(options: argparse.Namespace, sweeping: Sweeping, runner: Runner, files: TableFiles | None) -> int:
    plan = sweeping.plan
    out = None if files is None else files.table
    places = Places(
        Path() if out is None else out.parent,
        f"{options.file}{PROGRAM_SUFFIX}" if options.generated else options.file,
        options.world or "",
        options.task_dir or "",
        options_from(options),
    )
    reports = _JsonReport(plan) if options.json else _TextReport(sys.stdout)
    sample = SAMPLE if options.page is None else PAGE_SAMPLE
    totals = Totals(plan.variations, properties_of(plan), tuple(plan.measures), sample)
    known: list[Remembered] = []
    stop: KeyboardInterrupt | None = None
    with _engine(options) as engine:
        try:
            known = [] if options.no_cases or options.only is not None else remembered(runner, engine, places, _note)
            reports.remembered(known)
            sweeping.go(engine, _Meter(sweeping).update, reports.row)
        except KeyboardInterrupt as came:
            stop = came
        sweeping.finish(out if stop is None else None, totals.add)
        summary = summary_of(
            totals, is_random=options.only is None and is_random(plan), line_words=source_of_plan(plan).line_words
        )
        findings: list[Finding] = []
        if stop is None and not options.no_cases:
            try:
                findings = _findings(options, totals, runner, engine, places, known)
            except Stopped as came:
                stop = came
    unread: Stopped | OSError | None = None
    try:
        reports.end(summary, findings, len(known))
    except (Stopped, OSError) as came:
        # All is computed, and what was asked for as files is written, though nobody reads the report.
        unread = came
    if options.page is not None and stop is None:
        _write_pages(options, runner, totals, summary, findings)
    if stop is not None:
        rest = f"--resume goes on from {sweeping.journal.path}" if out is not None else "--out keeps them for --resume"
        done = f"{sweeping.done:,} of {sweeping.runs:,} runs are done"
        print(f"elitescript sweep: ended by {cause_of(stop)}; {done}; {shown(rest)}", file=sys.stderr)
        return exit_code_of(stop)
    if files is not None:
        files.finish(sweeping.journal, sweeping.failed)
        sweeping.journal.delete()
    if unread is not None:
        raise unread
    return FAILS if sweeping.failed or any(row.row.failure is not None for row in known) else HOLDS


def _findings(
    options: argparse.Namespace,
    totals: Totals,
    runner: Runner,
    engine: Engine,
    places: Places,
    known: list[Remembered],
) -> list[Finding]:
    """Return the first failures of each kind, shrunk; Ctrl-C leaves them as small as they are."""
    # First one of each mistake, then what other disturbances have led to.
    alike = totals.alike()
    groups = [kinds[0] for kinds in alike] + [group for kinds in alike for group in kinds[1:]]
    firsts = [group.rows[0] for group in groups[:KINDS_MAX]]
    progress = _Lines(time.monotonic())

    def note(shrinkings: Shrinkings) -> None:
        left = shrinkings.waiting
        done = f"{len(firsts) - left} of {len(firsts)} failures are made smaller, {shrinkings.tried:,} runs for that"
        progress.note(f"{done}  (Ctrl-C leaves them as they are)", done)
        if shrinkings.is_interrupted:
            print("elitescript sweep: ended by Ctrl-C before all failures were made smaller", file=sys.stderr)

    return find(firsts, runner, engine, places, known, budget=options.shrink_runs, note=note)


class _Lines:
    """Shows progress: on a terminal in its status line, elsewhere as a line each `LINE_S`.

    Args:
        now_s: wall time at the start, s.
    """

    def __init__(self, now_s: float) -> None:
        self._progress = progress_on(sys.stderr)
        self._next_s = now_s + LINE_S

    def note(self, status: str, line: str = "") -> None:
        """Show it.

        Args:
            status: on a terminal.
            line: elsewhere; the same if empty.
        """
        if self._progress is not None:
            self._progress.note(status)
        elif (now_s := time.monotonic()) >= self._next_s:
            self._next_s = now_s + LINE_S
            _note(line or status)
            sys.stderr.flush()


def _write_pages(
    options: argparse.Namespace, runner: Runner, totals: Totals, summary: Summary, findings: list[Finding]
) -> None:
    """Write the page of the sweep and its replays."""
    progress = progress_on(sys.stderr)
    output = options.outputs["page"]
    command = shlex.join(["elitescript", *_without(options.command_line, "--page", "--only", "--out", "--jobs")])
    note = progress.note if progress is not None else lambda _: None
    size = write_pages(output, runner, totals, summary, findings, command, note)
    if not options.json:
        # Not into a page that goes to standard output.
        stream = sys.stdout if output.is_file else sys.stderr
        print(f"\n{shown_word(str(output.path))}: {totals.runs:,} runs ({size / 1000:.0f} kB)", file=stream)


def _without(arguments: list[str], *names: str) -> list[str]:
    """Return the arguments of a call without some options, which have a value each."""
    kept: list[str] = []
    is_value = False
    for argument in arguments:
        if not is_value and argument.partition("=")[0] not in names:
            kept.append(argument)
        is_value = not is_value and argument in names
    return kept


def _engine(options: argparse.Namespace) -> Engine:
    jobs = options.jobs if options.jobs is not None else cores()
    if jobs < 1:
        raise UsageError(f"--jobs must be 1 or more, got {jobs}")
    if options.max_wall is not None and not options.max_wall > 0.0:
        raise UsageError(f"--max-wall must be > 0 s, got {options.max_wall:g}")
    memory_bytes = parse_size(options.memory_limit, "--memory-limit")
    if options.dask is not None:
        if options.jobs is not None:
            raise UsageError("--jobs is for this computer; with --dask the cluster says how many workers there are")
        from elitescript.sweep.engines.cluster import ClusterEngine

        return ClusterEngine(
            options.dask,
            max_wall_s=options.max_wall,
            memory_bytes=memory_bytes,
            is_mixed=options.mixed,
            note=_note,
        )
    if options.mixed:
        raise UsageError("--mixed goes with --dask")
    return LocalEngine(jobs, max_wall_s=options.max_wall, memory_bytes=memory_bytes)


def _note(text: str) -> None:
    print(f"elitescript sweep: {shown(text)}", file=sys.stderr)


class _Meter:
    """Shows how far a sweep is."""

    def __init__(self, sweeping: Sweeping) -> None:
        self._lines = _Lines(time.monotonic())
        self._runs = sweeping.runs
        self._meter = Meter(sweeping.runs, time.monotonic(), sweeping.done)

    def update(self, done: int, failed: int) -> None:
        """Show it."""
        if text := self._meter.text(done, failed, time.monotonic()):
            self._lines.note(text, f"{done:,} of {self._runs:,} runs are done, {failed:,} of them failed")


class _TextReport:
    """Says for people what came of a sweep."""

    row = None

    def __init__(self, out: Writable) -> None:
        self._out = out

    def remembered(self, known: list[Remembered]) -> None:
        """Say what became of the cases of earlier sweeps."""
        for case in known:
            failure = case.row.failure
            words = "holds now" if failure is None else f"still fails: {failure.expression}: {failure.text}"
            if failure is not None and not case.is_same:
                words = f"fails otherwise now: {failure.expression}: {failure.text}"
            print(f"{shown_word(str(case.path))} {shown(words)}", file=self._out)

    def end(self, summary: Summary, findings: list[Finding], known: int) -> None:
        """Say what was found."""
        for line in summary.lines():
            print(shown(line), file=self._out)
        cases: dict[Path, list[Finding]] = {}
        for finding in findings:
            cases.setdefault(finding.case, []).append(finding)
        for finding, *same in cases.values():
            print(file=self._out)
            if finding.story is not None:
                for line in finding.story.lines:
                    print(shown(line), file=self._out)
            smaller = f", made smaller in {finding.tried} tries" if finding.tried else ""
            smaller += "" if finding.is_complete else " and perhaps not the smallest, see --shrink-runs"
            run = f"run {finding.first.choices.run}{smaller}"
            print(f"{run}: elitescript run --case {shown_word(str(finding.case))}", file=self._out)
            if same:
                runs = ", ".join(str(other.first.choices.run) for other in same)
                tries = sum(other.tried for other in same)
                made = f"made smaller in {tries} tries" if tries else "made smaller"
                print(f"{made}, run{'s' if len(same) > 1 else ''} {runs} came to the same", file=self._out)
        if findings or known:
            print(file=self._out)
            print(_spent(_numbers(summary, findings, known)), file=self._out)


def _spent(numbers: dict[str, int]) -> str:
    """Return in words what runs were made for, and what was written."""

    def counted(name: str, one: str, many: str) -> str:
        return f"{numbers[name]:,} {one if numbers[name] == 1 else many}"

    parts = [counted("runs", "run of the plan", "runs of the plan")]
    if numbers["cases_played"]:
        parts.append(counted("cases_played", "of a case that was there", "of cases that were there"))
    if numbers["shrink_runs"]:
        parts.append(
            f"{numbers['shrink_runs']:,} to make {numbers['shrunk']} of {numbers['failed']:,} failures smaller"
        )
    return f"{', '.join(parts)}; {counted('cases_written', 'case is', 'cases are')} written"


class _JsonReport:
    """Prints one JSON object for each row, in the order of their numbers, then for each failure, then the summary."""

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._names = ("type", *columns(plan))

    def row(self, row: Row) -> None:
        """Print a row."""
        _write_line(json_line(self._names, ("row", *values(row, self._plan))))

    def remembered(self, known: list[Remembered]) -> None:
        """Print what became of the cases of earlier sweeps."""
        for case in known:
            row = case.row
            _print_json(type="case", case=str(case.path), state=row.state, failed=row.failed, same=case.is_same)

    def end(self, summary: Summary, findings: list[Finding], known: int) -> None:
        """Print what was found."""
        for finding in findings:
            failure = finding.failure
            _print_json(
                type="failure",
                run=finding.first.choices.run,
                failed=failure.expression,
                state=failure.state,
                code=failure.code,
                line=failure.line,
                t=failure.t,
                margin=failure.margin,
                text=failure.text,
                values=dict(finding.choices.values),
                disturbances=[disturbance_data(row) for row in finding.choices.disturbances],
                story=None if finding.story is None else finding.story.data(),
                case=str(finding.case),
                tried=finding.tried,
                complete=finding.is_complete,
                written=finding.is_written,
            )
        numbers = _numbers(summary, findings, known)
        _print_json(type="summary", digest=plan_digest(self._plan), **summary.as_json(), numbers=numbers)


def _numbers(summary: Summary, findings: list[Finding], known: int) -> dict[str, int]:
    """Return how many runs a sweep has made and for what, and what it has written."""
    return {
        "runs": summary.runs,
        "cases_played": known,
        "shrink_runs": sum(finding.tried for finding in findings),
        "shrunk": sum(finding.tried > 0 for finding in findings),
        "failed": summary.failed,
        "cases_written": sum(finding.is_written for finding in findings),
    }


def _write_line(text: str) -> None:
    """Write a line of JSON at once, so that Ctrl-C does not part it from its end."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def _print_json(**data: Any) -> None:
    _write_line(to_text(data))


def _check_out(options: argparse.Namespace, out: Path | None) -> None:
    """Refuse a table that could not be written, before the first run."""
    if out is None:
        if options.resume:
            raise UsageError("--resume goes with --out, beside which the rows so far are kept")
        return
    check_table(out)


def _check_only(options: argparse.Namespace, runs: int) -> None:
    if options.out is not None:
        raise UsageError("--only: one run is no table; leave out --out")
    if not 0 <= options.only < runs:
        raise UsageError(f"--only must be a number from 0 to {runs - 1} (--runs), got {options.only}")


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
    source = source_of_plan(plan)
    for problem in problems:
        print(rendered(problem, source, palette_of(sys.stderr)), file=sys.stderr)
