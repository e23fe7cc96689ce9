"""Messages to the log and to the screen (manual 2.10 chapter 6.2)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from elitescript.commands.definition.quantities import Any_, Bool
from elitescript.commands.definition.registry import command

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot


@command(family="message", manual="6.2.1")
def textmsg(robot: Robot, s1: Any_, s2: Any_ = "", *more: object) -> None:
    """Write one entry in the robot's log.

    Values are written as Python's `str` does and follow each other without a blank. A third value and any more are
    joined as well.

    Args:
        s1: text or any other value.
        s2: text or any other value, behind the first.
    """
    robot.message("".join([str(part) for part in (s1, s2, *more)]))


@command(family="message", manual="6.2.2", waits=True)
def popup(
    robot: Robot,
    s: Any_,
    title: Any_ = "Popup",
    warning: Bool = False,
    error: Bool = False,
    blocking: Bool = False,
) -> None:
    """Show a message window.

    Args:
        s: text or any other value.
        title: title of the window.
        warning: mark the window as a warning.
        error: mark the window as an error; goes before `warning` (*assumed*).
        blocking: True waits until the window is confirmed; in a secondary program it never waits.
    """
    level = "error" if error else "warning" if warning else "info"
    robot.popup(str(s), str(title), level, is_blocking=blocking and not robot.is_secondary)
