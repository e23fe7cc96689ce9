"""The task as a whole, and interpreter mode (manual 2.14 chapters 2 and 9.2)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from elitescript.commands.definition.quantities import Bool
from elitescript.commands.definition.registry import command

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot


@command(family="task", since="2.14", manual="2.14: 9.2.1", waits=True, works_in_sec=False)
def pause(robot: Robot) -> None:
    """Pause the task until it is resumed."""
    robot.pause()


@command(family="task", since="2.14", manual="2.14: 9.2.2")
def halt(robot: Robot) -> None:
    """Stop the task, from whichever thread or secondary program; what follows is not run."""
    robot.halt()


@command(family="task", since="2.11", manual="2.14: 2.3", waits=True, works_in_sec=False)
def interpreter_mode(robot: Robot, clearQueueOnEnter: Bool = True, clearOnEnd: Bool = True) -> None:
    """Run statements that arrive on the interpreter port until `end_interpreter`.

    Only the main thread may call it, and not inside itself.

    Args:
        clearQueueOnEnter: True drops statements that arrived before, False runs them first.
        clearOnEnd: True forgets functions that statements defined, False keeps them for the next time.
    """
    robot.enter_interpreter(clears_queue=bool(clearQueueOnEnter), clears_at_end=bool(clearOnEnd))


@command(family="task", since="2.11", manual="2.14: 2.4")
def end_interpreter(robot: Robot) -> None:
    """Let `interpreter_mode` return after the command that runs."""
    robot.end_interpreter()


@command(family="task", since="2.11", manual="2.14: 2.5")
def clear_interpreter(robot: Robot) -> None:
    """Drop the queued statements and the functions that statements defined."""
    robot.clear_interpreter()
