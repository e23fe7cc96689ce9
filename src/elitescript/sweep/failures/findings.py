"""What a sweep leaves behind of its failures: of each kind the first one, shrunk, told, and written as a case."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from elitescript.environment.stop_signals import Stopped
from elitescript.errors import UsageError
from elitescript.models.model import is_model_file
from elitescript.paths import real_path
from elitescript.records import field, record
from elitescript.sweep.chaos.ground import Ears
from elitescript.sweep.engines.engine import Engine
from elitescript.sweep.failures.cases import (
    FILE_NAME,
    SUFFIX,
    Case,
    digest_of,
    is_case,
    read_case,
    relative_to,
    write_case,
)
from elitescript.sweep.failures.shrinking import BUDGET, Shrinking, Shrunk, is_same
from elitescript.sweep.failures.story import Story, tell
from elitescript.sweep.plans.plan import LOST, Choices, Failure, Plan, Row
from elitescript.sweep.plans.variations import plain_value
from elitescript.sweep.single import Runner

KINDS_MAX: Final = 5
"""Kinds of failures of one sweep that are shrunk and written: those that come first (*assumed*)."""

CASES_MAX: Final = 100
"""Cases of one folder that are played before a sweep, and names that are tried for a new one."""


@record
class Places:
    """Where the files of a sweep are, for the cases that name them.

    Attributes:
        folder: of the cases.
        program: path.
        world: path; empty without one.
        task_dir: path; empty for that of the program.
        options: of the robot, as they were given: the model may be a path.
    """

    folder: Path
    program: str
    world: str = ""
    task_dir: str = ""
    options: Mapping[str, Any] = field(default_factory=dict)


@record
class Finding:
    """One kind of failure.

    Attributes:
        first: row of the first run that failed so.
        failure: of the smallest run that fails so.
        choices: of that run.
        tried: runs that it took to find it.
        story: what happened in it; None of a run that did not come back.
        case: file that plays it again.
        is_complete: whether nothing smaller was left to try; else the budget was used up, or it was interrupted.
        is_written: whether the case was written for it; else it was there, or is that of another failure.
    """

    first: Row
    failure: Failure
    choices: Choices
    tried: int
    story: Story | None
    case: Path
    is_complete: bool = True
    is_written: bool = True


@record
class Remembered:
    """A case of an earlier sweep that was played again.

    Attributes:
        path: of the case.
        row: what came of it.
        is_same: whether it failed in the same way.
    """

    path: Path
    row: Row
    is_same: bool


def find(
    firsts: Sequence[Row],
    runner: Runner,
    engine: Engine,
    places: Places,
    known: Iterable[Remembered] = (),
    *,
    budget: int = BUDGET,
    note: Callable[[Shrinkings], None] = lambda shrinkings: None,
) -> list[Finding]:
    """Shrink runs that failed, all at the same time, tell their stories, and write their cases.

    Ctrl-C ends the shrinking; what is smallest by then is described and written.

    Args:
        firsts: their rows.
        runner: of the plan.
        engine: runs the candidates.
        places: of the files.
        known: cases that were played before; one that failed in the same way is not written again.
        budget: runs that each may take.
        note: called after each round of candidates, and after Ctrl-C.

    Raises:
        UsageError: a case cannot be written.
    """
    shrinkings = Shrinkings(firsts, runner.plan, budget)
    try:
        shrinkings.go(engine, note)
    except Stopped:
        raise
    except KeyboardInterrupt:
        shrinkings.is_interrupted = True
        note(shrinkings)
    found: list[Finding] = []
    for first, shrunk in zip(firsts, shrinkings.results, strict=True):
        assert first.failure is not None
        choices, failure, tried, story = first.choices, first.failure, 0, None
        if shrunk is not None:
            choices, tried = shrunk.choices, shrunk.runs
            story, failure = _told(runner, choices, failure)
        path = next((row.path for row in known if is_same(row.row.failure, failure)), None)
        if path is None and story is not None:
            # Other faults may have led to the same mistake.
            path = next((row.case for row in found if _is_same_run(row, choices, failure)), None)
        is_written = path is None
        if path is None:
            lines = [failure.text] if story is None else story.lines
            path = _written(places.folder, case_of_run(runner, choices, failure, places), lines)
        is_complete = shrunk is None or shrunk.is_complete
        found.append(Finding(first, failure, choices, tried, story, path, is_complete, is_written))
    return found


class Shrinkings:
    """Failures that are made smaller at the same time.

    Each takes as many candidates of a round as there are workers for it, so few failures use all of them too.

    Args:
        firsts: rows of the runs.
        plan: of the sweep.
        budget: runs that each may take.

    Attributes:
        is_interrupted: whether they were ended before.
    """

    __slots__ = ("_failures", "_plan", "_shrinkings", "is_interrupted")

    def __init__(self, firsts: Sequence[Row], plan: Plan, budget: int) -> None:
        self._plan = plan
        self._failures: list[Failure] = []
        # Of runs that were lost there is nothing to compare, or each candidate takes --max-wall.
        self._shrinkings: list[Shrinking | None] = []
        self.is_interrupted = False
        for first in firsts:
            assert first.failure is not None
            self._failures.append(first.failure)
            is_lost = first.state in LOST
            shrinking = None if is_lost else Shrinking(first.choices, plain=plain_values(plan), budget=budget)
            self._shrinkings.append(shrinking)

    @property
    def tried(self) -> int:
        """Runs so far."""
        return sum(result.runs for result in self.results if result is not None)

    @property
    def waiting(self) -> int:
        """How many are not as small as can be."""
        return len(self._asking())

    @property
    def results(self) -> list[Shrunk | None]:
        """The smallest choices so far; None of runs that were lost."""
        return [None if one is None else one.result for one in self._shrinkings]

    def go(self, engine: Engine, note: Callable[[Shrinkings], None]) -> None:
        """Run candidates until all are as small as can be, or the budget is used up."""
        while asking := self._asking():
            width = max(1, engine.workers // len(asking))
            asked = [(one, failure, at) for one, failure in asking for at in range(min(width, len(one.asked)))]
            fails = self._fails(engine, [(one.asked[at], failure) for one, failure, at in asked])
            answers: dict[Shrinking, dict[int, bool]] = {one: {} for one, _ in asking}
            for (one, _, at), is_failing in zip(asked, fails, strict=True):
                answers[one][at] = is_failing
            for one, its in answers.items():
                one.answer(its)
            note(self)

    def _asking(self) -> list[tuple[Shrinking, Failure]]:
        pairs = zip(self._shrinkings, self._failures, strict=True)
        return [(one, failure) for one, failure in pairs if one is not None and one.asked]

    def _fails(self, engine: Engine, candidates: Sequence[tuple[Choices, Failure]]) -> list[bool]:
        """Return whether candidates fail as the failures do that they are made of; what makes no sense does not."""
        try:
            rows = engine.rows_of(self._plan, [choices for choices, _ in candidates])
        except UsageError:
            if len(candidates) == 1:
                return [False]
            return [fails for candidate in candidates for fails in self._fails(engine, [candidate])]
        return [is_same(row.failure, failure) for row, (_, failure) in zip(rows, candidates, strict=True)]


def _is_same_run(finding: Finding, choices: Choices, failure: Failure) -> bool:
    mine = finding.choices
    is_equal = (mine.values, mine.disturbances) == (choices.values, choices.disturbances)
    return is_equal and is_same(finding.failure, failure)


def plain_values(plan: Plan) -> dict[str, Any]:
    """Return the plain value of everything that is varied, by name."""
    return {row.name: plain_value(row) for row in plan.variations}


def _told(runner: Runner, choices: Choices, failure: Failure) -> tuple[Story | None, Failure]:
    """Return the story of a run that has come back before, and its failure."""
    ears: list[Ears] = []
    row, run = runner.play(choices, before=lambda robot: ears.append(Ears(robot)))
    if run is None or row.failure is None:
        return None, failure
    ground = runner.chaos.ground if choices.disturbances else None
    return tell(choices, row.failure, run, ears[0].heard, ground, runner.ends_s(row)), row.failure


def case_of_run(runner: Runner, choices: Choices, failure: Failure, places: Places) -> Case:
    """Return the case of a run."""
    plan, folder = runner.plan, places.folder
    options = dict(places.options)
    if is_model_file(model := options.get("model", "")):
        options["model"] = relative_to(model, folder)
    return Case(
        relative_to(places.program, folder),
        failure,
        digest_of(plan.program),
        choices.run,
        choices.seed,
        choices.values,
        choices.disturbances,
        relative_to(places.world, folder) if places.world else "",
        relative_to(places.task_dir, folder) if places.task_dir else "",
        options,
        plan.settings,
        runner.chaos.until_s(choices.disturbances),
        plan.step_s,
        plain_values(plan),
        plan.seed,
    )


def _written(folder: Path, case: Case, lines: Sequence[str]) -> Path:
    """Write a case under the first free name of a folder; return its path.

    Raises:
        UsageError: it cannot be written, or there is no such name.
    """
    for number in range(1, CASES_MAX + 1):
        path = folder / (FILE_NAME if number == 1 else f"CASE-{number}{SUFFIX}")
        if not path.exists() and write_case(path, case, lines):
            return path
    raise UsageError(f"{folder}: there are {CASES_MAX} cases already; delete those that hold")


def remembered(runner: Runner, engine: Engine, places: Places, note: Callable[[str], None]) -> list[Remembered]:
    """Play the cases of earlier sweeps of a program again, as far as they vary what is varied now.

    Args:
        runner: of the plan.
        engine: runs the cases.
        places: of the files.
        note: called with a text for each case that cannot be read, and is left out.
    """
    plan = runner.plan
    names = {row.name for row in plan.variations}
    cases: list[tuple[Path, Case]] = []
    files = sorted(path for path in places.folder.iterdir() if path.is_file() and is_case(path.name))
    for path in files[:CASES_MAX]:
        try:
            case = read_case(path)
        except UsageError as error:
            note(f"{error}; this case is not played")
            continue
        program = real_path(path.parent / case.program)
        world = real_path(path.parent / case.world) if case.world else None
        is_ours = program == real_path(places.program) and set(case.values) == names
        if not is_ours or world != (real_path(places.world) if places.world else None):
            continue
        cases.append((path, case))
    rows = engine.rows_of(plan, [case.choices for _, case in cases])
    pairs = zip(cases, rows, strict=True)
    return [Remembered(path, row, is_same(row.failure, case.failure)) for (path, case), row in pairs]
