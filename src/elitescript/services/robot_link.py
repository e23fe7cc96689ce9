"""How the serving process reaches a robot: in this process, or in a child.

Whichever it is, a tick is one call: inputs in, what the robot has to say out. The robot knows no clock; who calls
decides how fast its time passes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from elitescript.messages.inputs import Input
from elitescript.messages.outputs import Output, TickResult
from elitescript.messages.snapshot import RobotDescription, Snapshot


class TickedRobot(Protocol):
    """One robot as a function; `elitescript.kernel.Kernel` is one."""

    @property
    def description(self) -> RobotDescription:
        """What never changes about it."""

    def tick(self, inputs: Sequence[Input]) -> TickResult:
        """Apply inputs in their order and go on by one tick."""

    def snapshot(self) -> Snapshot:
        """Return the machine as its ports show it after the last tick."""


class RobotLink(Protocol):
    """The way to one robot.

    `open` is awaited once before anything else. Calls of `tick` never overlap.
    """

    @property
    def description(self) -> RobotDescription:
        """What never changes about the robot; known once the link is open."""

    @property
    def room(self) -> float | None:
        """Share of a tick's work for clients that the robot can do, 0 to 1; None if it is not there just now."""

    async def open(self) -> None:
        """Bring the robot up."""

    async def tick(self, inputs: Sequence[Input]) -> Output:
        """Give the robot its inputs and return what it has to say after one tick."""

    async def close(self) -> None:
        """Let the robot go."""


class InProcessLink:
    """A robot in this process.

    Args:
        robot: the robot.
    """

    __slots__ = ("robot",)

    def __init__(self, robot: TickedRobot) -> None:
        self.robot = robot

    @property
    def description(self) -> RobotDescription:
        return self.robot.description

    @property
    def room(self) -> float | None:
        return 1.0

    async def open(self) -> None:
        """Nothing has to be brought up."""

    async def tick(self, inputs: Sequence[Input]) -> Output:
        return self.tick_now(inputs)

    def tick_now(self, inputs: Sequence[Input]) -> Output:
        """As `tick`, without waiting."""
        return self.robot.tick(inputs).with_snapshot(self.robot.snapshot())

    async def close(self) -> None:
        """Nothing is left behind."""
