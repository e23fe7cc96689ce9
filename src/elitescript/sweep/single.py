"""One run of a sweep: from its number to its choices, from its choices to its row."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from elitescript.sweep.plan import Choices, Plan, Row

if TYPE_CHECKING:
    from elitescript.controller.views.trace import Trace
    from elitescript.messages.events import Event
    from elitescript.robot import VirtualRobot
    from elitescript.run import Run


class Runner:
    """Runs the runs of one plan, one after the other; kept in a worker, since it parses everything once.

    Args:
        plan: of the sweep.

    Raises:
        UsageError: something in the plan makes no sense.
        ProgramError: the program does not compile.
    """

    def __init__(self, plan: Plan) -> None:
        self.plan = plan

    def choices_of(self, run: int) -> Choices:
        """Return what is drawn for a run: the same for its number in every process."""
        raise NotImplementedError

    def robot(self, choices: Choices, on_event: Callable[[Event], None] | None = None) -> VirtualRobot:
        """Return the robot of a run before its program begins: with its values and disturbances."""
        raise NotImplementedError

    def run(self, choices: Choices) -> Row:
        """Run the program once."""
        return self.play(choices)[0]

    def play(
        self,
        choices: Choices,
        *,
        trace: Trace | None = None,
        on_event: Callable[[Event], None] | None = None,
    ) -> tuple[Row, Run]:
        """Run the program once, and look on: for a story, or for a page.

        Args:
            choices: of the run.
            trace: receives rows of the arm.
            on_event: receives every event at the moment it happens.
        """
        raise NotImplementedError


def job(description: Any) -> Callable[[Any], Any]:
    """Return what a child process does: rows as JSON has them, for numbers of runs or for choices.

    Args:
        description: a plan as JSON has it.
    """
    raise NotImplementedError
