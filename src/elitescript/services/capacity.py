"""How many served robots a computer holds, from what one takes by the page of speed; nothing is measured here.

A robot in a child takes a share of a core for itself; robots in one process share one interpreter, whatever the number
of cores, but need no messages between processes.
"""

from __future__ import annotations

from typing import Final

from elitescript.environment.process import cores
from elitescript.records import record

ROBOTS_PER_CORE: Final = 5
"""Robots in children at rest, each with a client at 250 Hz; `python -m benchmarks.fleet` measures it."""
ROBOTS_IN_PROCESS: Final = 20
"""The same in one process."""
MOVING_PER_CORE: Final = 3.5
MOVING_IN_PROCESS: Final = 11
"""The same while every arm moves."""


@record
class Capacity:
    """What a computer holds of the robots of one `serve`."""

    robots: int
    """That are served."""
    cores: int
    is_in_process: bool

    @property
    def held(self) -> int:
        """Robots that keep their time, each with a client at 250 Hz."""
        return ROBOTS_IN_PROCESS if self.is_in_process else ROBOTS_PER_CORE * self.cores

    @property
    def held_moving(self) -> int:
        """The same while all of them move their arms."""
        return MOVING_IN_PROCESS if self.is_in_process else int(MOVING_PER_CORE * self.cores)

    @property
    def is_exceeded(self) -> bool:
        """Whether more are served."""
        return self.robots > self.held

    def __str__(self) -> str:
        cores = "1 core" if self.cores == 1 else f"{self.cores} cores"
        subject = "one process holds" if self.is_in_process else f"{cores} hold{'s' if self.cores == 1 else ''}"
        text = f"{subject} about {self.held} robots with a client at 250 Hz each, {self.held_moving} if all arms move"
        if self.is_exceeded:
            text += f"; of {self.robots} packages will come late and robot time will be left out"
            if not self.is_in_process and self.held < ROBOTS_IN_PROCESS:
                text += f". --in-process holds about {ROBOTS_IN_PROCESS}, without a jail: for programs that you trust"
        return text


def own_capacity(robots: int, *, is_in_process: bool) -> Capacity:
    """Return what this computer holds of so many robots, of the cores that this process may use."""
    return Capacity(robots, cores(), is_in_process)
