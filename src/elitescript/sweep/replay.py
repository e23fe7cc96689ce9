"""Plays a case again, with the program, the world and the Python files as they are on the disk now."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from elitescript.errors import UsageError
from elitescript.messages.signals import Value
from elitescript.models.model import is_model_file
from elitescript.paths import is_program_name, is_task_name
from elitescript.properties.parsing import function_place
from elitescript.records import NamedTuple
from elitescript.sweep.chaos.ground import Ears
from elitescript.sweep.failures.cases import Case, digest_of, read_case
from elitescript.sweep.failures.shrinking import is_same
from elitescript.sweep.failures.story import Story, tell
from elitescript.sweep.making import make_plan
from elitescript.sweep.plans.plan import LOST, Plan, Row, Variation
from elitescript.sweep.single import Runner

if TYPE_CHECKING:
    from elitescript.controller.views.trace import Trace
    from elitescript.messages.events import Event
    from elitescript.robot import VirtualRobot
    from elitescript.run import Run


class Played(NamedTuple):
    """A case that was played again.

    Attributes:
        row: of the run.
        run: its record; None if it could not begin.
        words: whether the failure came again, for people.
        story: what happened; None if the property holds now.
    """

    row: Row
    run: Run | None
    words: str
    story: Story | None


class Replay:
    """One case, ready to be played again.

    Args:
        path: of the case.
        program: path of the program; that of the case if None.

    Attributes:
        case: what was read.
        program: path of the program.
        plan: of a sweep of this one run.
        runner: that runs it.
        note: what has changed since; empty if nothing has.

    Raises:
        UsageError: the case, or a file that it names, makes no sense.
        ProgramError: the program does not compile.

    Example:
        robot = replay.robot(); run = robot.run(**replay.arguments())
    """

    __slots__ = ("case", "note", "plan", "program", "runner")

    def __init__(self, path: str | Path, program: str | Path | None = None) -> None:
        self.case = read_case(path)
        folder = Path(path).parent
        self.program = Path(program) if program is not None else folder / self.case.program
        try:
            self.plan = plan_of(self.case, folder, self.program)
            self.runner = Runner(self.plan)
            self.robot()  # so that what makes no sense in it is refused, instead of being a run that fails
        except UsageError as error:
            raise UsageError(f"{path}: {error}") from error
        changed = bool(self.case.digest) and digest_of(self.plan.program) != self.case.digest
        self.note = f"{self.program} has changed since the case was written" if changed else ""

    def robot(self, on_event: Callable[[Event], None] | None = None) -> VirtualRobot:
        """Return the robot before the program begins, with everything that goes wrong in the run.

        Raises:
            UsageError: a value or a disturbance makes no sense there.
        """
        robot = self.runner.robot(self.case.choices, on_event)
        self.runner.chaos.begin(robot, self.case.choices)
        return robot

    def arguments(self) -> dict[str, Any]:
        """Return the arguments of `VirtualRobot.run`: the program, its presets and the limit of time."""
        return self.runner.arguments(self.case.choices)

    def play(
        self,
        *,
        trace: Trace | None = None,
        on_event: Callable[[Event], None] | None = None,
        before: Callable[[VirtualRobot], None] | None = None,
    ) -> Played:
        """Run the program once, and look whether the failure comes again."""
        ears: list[Ears] = []

        def prepare(robot: VirtualRobot) -> None:
            ears.append(Ears(robot))
            if before is not None:
                before(robot)

        row, run = self.runner.play(self.case.choices, before=prepare, trace=trace, on_event=on_event)
        expected, found = self.case.failure, row.failure
        is_lost = expected.expression in LOST
        if found is None:
            now = "the run comes to its end" if is_lost else f"{expected.expression} holds"
            return Played(row, run, f"the failure did not come again: {now} now", None)
        words = found.text if is_lost else f"{expected.expression} does not hold"
        if is_same(found, expected):
            words = f"the failure came again: {words}"
        elif run is None or is_lost:
            words = f"it failed in another way: {found.text}"
        else:
            words = f"the failure came again in another way: {words}; {found.text}"
        if run is None:
            return Played(row, run, words, None)
        ground = self.runner.chaos.ground if self.case.disturbances else None
        ends_s = self.runner.ends_s(row)
        return Played(row, run, words, tell(self.case.choices, found, run, ears[0].heard, ground, ends_s))


def plan_of(case: Case, folder: Path, program: Path) -> Plan:
    """Return the plan of a sweep of one case.

    Args:
        case: what is played.
        folder: of the case, from which its paths are.
        program: path of the program.

    Raises:
        UsageError: a file that it names cannot be read.
        ProgramError: the program is not UTF-8.
    """
    options = dict(case.options)
    if is_model_file(model := options.get("model", "")):
        options["model"] = str(folder / model)
    text = case.failure.expression
    if (place := function_place(text)) is not None:
        text = f"{folder / place[0]}:{place[1]}"
    # Of a sweep with --generated, the program is the script beside a task, whose variables the case may name.
    task = program.with_suffix("")
    is_generated = is_task_name(task.name) and is_program_name(program.name) and task.is_file()
    return make_plan(
        task if is_generated else program,
        world=folder / case.world if case.world else None,
        task_dir=folder / case.task_dir if case.task_dir else None,
        options=options,
        settings=case.settings,
        variations=[_variation(case, name, value) for name, value in case.values.items()],
        seed=case.sweep_seed,
        until_s=case.until_s,
        ensure=[] if text in LOST else [text],
        step_s=case.step_s,
        is_generated=is_generated,
    )


def _variation(case: Case, name: str, value: Value | str) -> Variation:
    """Return a variation whose plain value is that of the sweep: the plain run decides what is stuck."""
    return Variation(name, "choice", (case.plain.get(name, value), value))


def robot_for_case(path: str | Path) -> tuple[VirtualRobot, dict[str, Any]]:
    """Return the robot of a case before its program begins, and the arguments of `VirtualRobot.run`.

    Raises:
        UsageError: the case, or a file that it names, makes no sense.
        ProgramError: the program does not compile.
    """
    replay = Replay(path)
    return replay.robot(), replay.arguments()
