"""`sweep`: many runs of one program from Python, in notebooks and tests."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import mkdtemp
from typing import Any
from weakref import finalize

from elitescript.environment.process import cores
from elitescript.errors import UsageError
from elitescript.kernel.options import OPTIONS, UNTIL, Section, Whole, accept, accepted, check_keywords
from elitescript.messages.signals import Value
from elitescript.records import replace
from elitescript.run import Run
from elitescript.sweep.chaos.properties import properties_of
from elitescript.sweep.engines.engine import Engine
from elitescript.sweep.engines.executor import MAX_WALL_S
from elitescript.sweep.engines.here import HereEngine
from elitescript.sweep.engines.local import LocalEngine
from elitescript.sweep.making import make_plan, runs_of
from elitescript.sweep.plans.plan import Row, Variation
from elitescript.sweep.plans.trees import source_of_plan
from elitescript.sweep.plans.variations import checked, parse_variation
from elitescript.sweep.results.journal import Journal
from elitescript.sweep.results.summary import Summary, summary_of
from elitescript.sweep.results.table_files import TableFiles
from elitescript.sweep.results.tables import check_table, columns, values
from elitescript.sweep.results.totals import Totals
from elitescript.sweep.single import Runner
from elitescript.sweep.sweeping import Sweeping, is_random

Check = str | Callable[[Run], Any]
"""A property or measure: an expression, `FILE.py:function`, the name of a built-in property, or a function."""


def sweep(
    program: str | Path,
    *,
    vary: Mapping[str, Variation | str | Sequence[Any]] | None = None,
    runs: int | None = None,
    seed: int = 0,
    ensure: Check | Iterable[Check] = (),
    measure: Mapping[str, Check] | None = None,
    chaos: str = "",
    presets: Mapping[str, object] | None = None,
    signals: Mapping[str, Value] | None = None,
    world: str | Path | None = None,
    task_dir: str | Path | None = None,
    until_s: float | None = None,
    step_s: float | None = None,
    margins: bool = False,
    jobs: int | None = None,
    engine: Engine | None = None,
    max_wall_s: float | None = MAX_WALL_S,
    out: str | Path | None = None,
    resume: bool = False,
    on_progress: Callable[[int, int], None] | None = None,
    model: str | Path | None = None,
    **options: Any,
) -> Sweep:
    """Run a program many times.

    The runs are those of `elitescript sweep` with the same options: the same values, rows and bytes. They are made in
    processes of their own, so that a run which hangs or crashes costs itself alone.

    Args:
        program: program text, or path of a file.
        vary: what is drawn for each run, by name: `uniform(0, 1)` and the others of this package, a text such as
            `"uniform(0, 1)"`, or a list to choose from.
        runs: how many; every point of the grids once, else 100, if None.
        seed: of everything that is drawn.
        ensure: what must hold in every run. A function is given the `Run`, and returns True or False; with functions
            all runs are made in this process, one after the other. `never_stuck` and `no_alarm` if there is none.
        measure: a column of numbers for each name; a function is given the `Run`.
        chaos: profile of what goes wrong: `channels`, `inputs`, `people`, `all`, or the path of a file.
        presets: program globals that have a value before the program begins.
        signals: levels at the start.
        world: path of the world file.
        task_dir: folder of which every run has a copy; that of the program's file if None.
        until_s: limit of virtual time of a run, s.
        step_s: time between two rows of a moving arm that properties see, s; every tick if None.
        margins: whether the table has the margin of each property.
        jobs: processes; one for each processor if None.
        engine: what runs the runs instead, such as a `ClusterEngine`; it must have been entered.
        max_wall_s: wall time after which a run is given up, s; None for no limit.
        out: table of the rows: `.csv`, `.jsonl` or `.parquet`.
        resume: go on with a sweep that was ended before its table, or with more runs than a finished table has; one of
            other settings is refused.
        on_progress: called with the number of runs that are done, and of those that failed.
        model: arm, as for `VirtualRobot`.
        **options: of the robot, as for `VirtualRobot`; not the sections of a world file.

    Raises:
        UsageError: an argument that makes no sense.
        ProgramError: the program does not compile.

    Example:
        >>> from elitescript.sweep import sweep, uniform
        >>> result = sweep('''
        ... def p():
        ...   pause_s = 0.5
        ...   sleep(pause_s)
        ... end
        ... ''', vary={"pause_s": uniform(0, 1)}, runs=20, ensure="time_s < 0.9", jobs=1)
        >>> len(result), [row.choices.run for row in result.failures]
        (20, [5])
    """
    for name, given_s in (("until_s", until_s), ("step_s", step_s), ("max_wall_s", max_wall_s)):
        if given_s is not None:
            accepted(UNTIL, given_s, name)
    for name, count in (("runs", runs), ("jobs", jobs)):
        if count is not None:
            accepted(Whole(1), count, name)
    checks = [ensure] if isinstance(ensure, str) or callable(ensure) else list(ensure)
    functions: dict[str, Callable[[Run], Any]] = {}
    table = None if out is None else Path(out)
    if table is None and resume:
        raise UsageError("resume goes with out, beside which the rows so far are kept")
    files = None if table is None else TableFiles(table)
    if files is not None:
        check_table(files.table)
        files.check()
    plan = make_plan(
        program,
        world=world,
        task_dir=task_dir,
        options=_options(model, options),
        settings=[f"{name}={value!r}" for name, value in {**(signals or {}), **(presets or {})}.items()],
        variations=[_variation(name, given) for name, given in (vary or {}).items()],
        seed=seed,
        until_s=until_s,
        ensure=[_text(check, functions) for check in checks],
        measures={name: _text(check, functions) for name, check in (measure or {}).items()},
        chaos=chaos,
        step_s=step_s,
        has_margins=margins,
        without_files=[*(files or ())],
    )
    number = runs_of(plan.variations, runs)
    runner = Runner(plan, functions)
    if functions and resume:
        raise UsageError(
            "resume: what functions compute cannot be compared with what is there; write them into a file: "
            "'checks.py:is_stacked'"
        )
    if functions and (engine is not None or jobs not in (None, 1)):
        raise UsageError(
            "functions are called in this process, so jobs must be 1 and there is no engine; "
            "for several processes write them into a file: 'checks.py:is_stacked'"
        )
    if max_wall_s is not None and not max_wall_s > 0.0:
        raise UsageError(f"max_wall_s must be > 0 s, got {max_wall_s:g}")
    result = Sweep(runner)
    if files is not None and resume and (found := files.finished(plan)) is not None:
        number = max(number, found.runs)
    totals = Totals(plan.variations, properties_of(plan), tuple(plan.measures))
    with files.journal(plan, resumes=resume) if files else Journal(result.journal, plan, resumes=False) as journal:
        sweeping = Sweeping(plan, number, journal)
        if functions:
            sweeping.go(HereEngine(runner), on_progress)
        elif engine is not None:
            sweeping.go(engine, on_progress)
        else:
            with LocalEngine(jobs or cores(), max_wall_s=max_wall_s) as own:
                sweeping.go(own, on_progress)
        sweeping.finish(table, totals.add)
    if files is not None:
        files.finish(journal, sweeping.failed)
        shutil.move(files.part, result.journal)
        journal.path = result.journal
    result.sweeping, result.summary = (
        sweeping,
        summary_of(totals, is_random=is_random(plan), line_words=source_of_plan(plan).line_words),
    )
    return result


class Sweep:
    """What came of many runs; iterating over it gives their rows, in the order of their numbers.

    The rows are in a file of their own, which goes with this object.

    Attributes:
        plan: everything that determines the rows.
        summary: what was found, in words (`summary.lines()`) and as JSON.
        problems: warnings about the program.
    """

    sweeping: Sweeping
    summary: Summary

    def __init__(self, runner: Runner) -> None:
        self.plan = runner.plan
        self.problems = runner.problems
        self._runner = runner
        home = mkdtemp(prefix="elitescript-sweep-")
        self.journal = Path(home, "journal")
        """The file."""
        finalize(self, shutil.rmtree, home, ignore_errors=True)

    @property
    def holds(self) -> bool:
        """Whether everything held in every run."""
        return not self.sweeping.failed

    @property
    def failures(self) -> list[Row]:
        """The rows of the runs that failed."""
        return [row for row in self if row.failure is not None]

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns of the table."""
        return columns(self.plan)

    def records(self) -> Iterator[dict[str, Any]]:
        """Yield the rows of the table, as `pandas.DataFrame(result.records())` takes them."""
        names = self.columns
        for row in self:
            yield dict(zip(names, values(row, self.plan), strict=True))

    def play(self, row: Row) -> Run:
        """Run one of its rows again, in this process, and return the record.

        Raises:
            UsageError: the run could not begin.
        """
        _, run = self._runner.play(row.choices)
        if run is None:
            assert row.failure is not None
            raise UsageError(row.failure.text)
        return run

    def __iter__(self) -> Iterator[Row]:
        # A generator keeps this object, and so the file.
        yield from self.sweeping.rows()

    def __len__(self) -> int:
        return self.sweeping.done

    def __bool__(self) -> bool:
        return True

    def __repr__(self) -> str:
        return "\n".join(self.summary.lines())


def _variation(name: str, given: Variation | str | Sequence[Any]) -> Variation:
    if isinstance(given, str):
        return parse_variation(f"{name}={given}", "vary")
    if not isinstance(given, Variation):
        if not isinstance(given, Iterable):
            raise UsageError(f"vary {name}: write uniform(a, b) or the like, or a list to choose from, not {given!r}")
        given = Variation("", "choice", tuple(given))
    return checked(replace(given, name=name), f"vary {name}")


def _text(check: Check, functions: dict[str, Callable[[Run], Any]]) -> str:
    """Return a check as text; a function is put among the others, by a name that is its text."""
    if isinstance(check, str):
        return check
    if not callable(check):
        raise UsageError(f"{check!r} is neither an expression nor a function")
    called = getattr(check, "__name__", type(check).__name__)
    name, number = called, 2
    while functions.get(name, check) is not check:
        name, number = f"{called} {number}", number + 1
    functions[name] = check
    return name


def _options(model: str | Path | None, given: Mapping[str, Any]) -> dict[str, Any]:
    """Return options of the robot as JSON has them.

    Raises:
        UsageError: a value that an option does not take, or one that only a world file can describe.
    """
    check_keywords(given)
    found: dict[str, Any] = {} if model is None else {"model": os.fspath(model)}
    for name, value in given.items():
        if value is None:
            continue
        if isinstance(OPTIONS[name].kind, Section):
            raise UsageError(f"{name}: write it into the world file, as [{name}]; a sweep is made of texts")
        accepted = accept(name, value, name)
        found[name] = list(accepted) if isinstance(accepted, tuple) else accepted
    return found
