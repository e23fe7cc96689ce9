"""Plain command lines of the primary port, which are no script.

They are recognised outside programs only, in exactly this spelling, with any number of blanks. There is no reply:
clients watch the robot state.

Evidence: *documented*, the vendor's client sends them and the ROS 2 driver sends `stop task`.
"""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite
from typing import Final

from elitescript.messages.machine import (
    AskSafety,
    MachineRequest,
    PauseTask,
    PowerOff,
    PowerOn,
    ReleaseBrakes,
    SetSpeedScale,
    StopTask,
)
from elitescript.records import NamedTuple


class PlainCommand(NamedTuple):
    """One command line."""

    words: str
    request: Callable[[float], MachineRequest]
    """Makes the request; the argument is the fraction, 0 for commands without one."""
    takes_fraction: bool
    confirmation: str
    """State that the vendor's client waits for afterwards, and its timeout."""


COMMANDS: Final[tuple[PlainCommand, ...]] = (
    PlainCommand("power on", lambda _: PowerOn(), False, "robot mode idle or running, 30 s"),
    PlainCommand("power off", lambda _: PowerOff(), False, "robot mode power off, 30 s"),
    PlainCommand("set robotmode run", lambda _: ReleaseBrakes(), False, "robot mode running, 30 s"),
    PlainCommand("pause task", lambda _: PauseTask(), False, "task paused, 30 s"),
    PlainCommand("stop task", lambda _: StopTask(), False, "task stopped, 30 s; the ROS 2 driver waits for ever"),
    PlainCommand(
        "set unlock protective stop",
        lambda _: AskSafety("unlock_protective_stop"),
        False,
        "protective stopped is false, 5 s",
    ),
    PlainCommand(
        "restart safetyboard",
        lambda _: AskSafety("restart_safety"),
        False,
        "safety mode normal, 30 s; the arm is off (*assumed*)",
    ),
    PlainCommand("set speed", SetSpeedScale, True, "target speed fraction in percent, 3 s"),
)


def request_of(line: str) -> MachineRequest | None:
    """Return the request of a line; None if it is no plain command but script.

    Raises:
        ValueError: the command is known, its argument is invalid.
    """
    words = line.split()
    for command in COMMANDS:
        own = command.words.split()
        if words[: len(own)] == own:
            given = words[len(own) :]
            if command.takes_fraction:
                return command.request(_fraction(command.words, " ".join(given)))
            if not given:
                return command.request(0.0)
    return None


def is_command(line: str) -> bool:
    """Return whether a line begins like a plain command."""
    words = line.split()
    return any(words[: len(own)] == own for own in (command.words.split() for command in COMMANDS))


def _fraction(words: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not isfinite(value) or not 0.0 <= value <= 1.0:
        raise ValueError(f"`{words}` takes a fraction from 0 to 1, such as 0.50, not {text or 'nothing'}")
    return value
