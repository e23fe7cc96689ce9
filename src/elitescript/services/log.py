"""The log of a served robot: its events, and lines about its clients, its ports and its time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from elitescript.messages.events import Event

DEVICE: Final = "device"
"""Kind of the lines that virtual devices write."""
SSH: Final = "ssh"
"""Kind of the lines of the SSH port."""


@dataclass(frozen=True, slots=True)
class LogLine:
    """A line of the log that is no event of the robot."""

    robot: str
    tick: int
    """The last one when it was written."""
    kind: str
    text: str
    is_problem: bool
    details: Mapping[str, Any] = field(default_factory=dict)


Listen = Callable[[str, Event | LogLine], None]
"""Takes the name of a robot, and what its log has; must not block."""


class ServerLog:
    """Passes on what is written to it.

    Args:
        robot: its name, unique among the robots of a `serve`.
        listen: takes everything.

    Attributes:
        clock: returns the last tick.
    """

    __slots__ = ("_listen", "clock", "robot")

    def __init__(self, robot: str, listen: Listen) -> None:
        self.robot = robot
        self._listen = listen
        self.clock: Callable[[], int] = lambda: 0

    @property
    def tick(self) -> int:
        """The last tick."""
        return self.clock()

    def event(self, event: Event) -> None:
        """Write an event of the robot."""
        self._listen(self.robot, event)

    def note(self, kind: str, text: str, *, is_problem: bool = False, **details: Any) -> None:
        """Write a line."""
        self._listen(self.robot, LogLine(self.robot, self.tick, kind, text, is_problem, details))
