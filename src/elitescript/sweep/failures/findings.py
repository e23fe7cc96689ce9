"""What a sweep leaves behind of its failures: of each kind the first one, shrunk, told, and written as a case."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, Final

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
from elitescript.sweep.failures.shrinking import BUDGET, Shrunk, is_same, shrink
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
    """

    first: Row
    failure: Failure
    choices: Choices
    tried: int
    story: Story | None
    case: Path


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
    first: Row,
    runner: Runner,
    engine: Engine,
    places: Places,
    known: Iterable[Remembered] = (),
    found: Iterable[Finding] = (),
) -> Finding:
    """Shrink a run that failed, tell its story, and write its case.

    Args:
        first: its row.
        runner: of the plan.
        engine: runs the candidates.
        places: of the files.
        known: cases that were played before; one that failed in the same way is not written again.
        found: what was found before: a smallest run that is the same again is not written again.

    Raises:
        UsageError: the case cannot be written.
    """
    assert first.failure is not None
    choices, failure, tried, story = first.choices, first.failure, 0, None
    # Of those there is nothing to compare, or each candidate takes --max-wall.
    if first.state not in LOST:
        shrunk = _shrunk(choices, failure, runner.plan, engine)
        choices, tried = shrunk.choices, shrunk.runs
        story, failure = _told(runner, choices, failure)
    path = next((row.path for row in known if is_same(row.row.failure, failure)), None)
    if path is None and story is not None:
        # Other faults may have led to the same mistake.
        path = next((row.case for row in found if _is_same_run(row, choices, failure)), None)
    if path is None:
        path = _free_name(places.folder)
        lines = [failure.text] if story is None else story.lines
        write_case(path, case_of_run(runner, choices, failure, places), lines)
    return Finding(first, failure, choices, tried, story, path)


def _shrunk(choices: Choices, failure: Failure, plan: Plan, engine: Engine) -> Shrunk:
    def still_fails(candidate: Choices) -> bool:
        return is_same(engine.row(plan, candidate).failure, failure)

    return shrink(choices, still_fails, plain=plain_values(plan), budget=BUDGET)


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


def _free_name(folder: Path) -> Path:
    for number in range(1, CASES_MAX + 1):
        path = folder / (FILE_NAME if number == 1 else f"CASE-{number}{SUFFIX}")
        if not path.exists():
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
    found = []
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
        row = engine.row(plan, case.choices)
        found.append(Remembered(path, row, is_same(row.failure, case.failure)))
    return found
