"""How the serving process reaches a robot: in this process, or in a child.

In both cases a tick is one call: inputs in, output out. How fast the time of the robot passes depends on the calls
alone. Ticks in which nothing is due and to which nothing is given need no call: the next one leaps over them, which
gives the same.

A snapshot takes most of the time of a tick, so one is made only at ticks of which something reads it, of those parts
alone, and when the discrete state has changed. So levels, modes, tool and task are up to date in the snapshot of any
output; joints, poses and forces in it may be older, if nothing was to read them.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Sequence
from typing import Protocol

from elitescript.kernel import Kernel
from elitescript.messages.inputs import Input
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot import RobotDescription, Snapshot
from elitescript.messages.snapshot_parts import ALL_PARTS, TIME


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

    @property
    def due_tick(self) -> int | None:
        """The next tick that is to run though it is given nothing; None if there is none."""

    @property
    def restarts(self) -> int:
        """Robots that had to be replaced by a fresh one."""

    def watch(self, on_due: Callable[[], object]) -> None:
        """Have a call made when a tick becomes due that `due_tick` has not announced."""

    def hurry(self, inputs: Sequence[Input]) -> None:
        """Take note of what the next tick will be given: the present one is not waited for if it is urgent."""

    @property
    def busy_line(self) -> int:
        """Line of the program that keeps the robot from answering; 0 if none does."""

    def knows(self, number: int, parts: int) -> bool:
        """Return whether the output of the next tick is known already if it is given nothing.

        Args:
            number: of the tick.
            parts: of its snapshot that are read, as bits of `messages.snapshot_parts`.
        """

    def known(self, number: int, parts: int) -> Output | None:
        """Return the output of the next tick, given nothing; None if it has not come, or is not known any more.

        Args:
            number: of the tick, for which `knows` was True.
            parts: likewise.
        """

    async def tick(
        self,
        inputs: Sequence[Input],
        parts: int = ALL_PARTS,
        number: int | None = None,
        *,
        asks_due: bool = True,
        outlet: Callable[[], Awaitable[None]] | None = None,
    ) -> Output:
        """Run one tick.

        Args:
            inputs: for the robot, in order.
            parts: of its snapshot that something reads, as bits of `messages.snapshot_parts`.
            number: of the tick, not later than `due_tick`; the one after the last if None.
            asks_due: whether `due_tick` is to be found out; if not, every tick is due.
            outlet: awaited before the output is returned; it returns when the output is to leave.
        """

    async def close(self) -> None:
        """Let the robot go."""


class InProcessLink:
    """A robot in this process.

    Args:
        robot: the robot.
    """

    __slots__ = ("_discrete_state", "_parts", "_snapshot", "robot")

    def __init__(self, robot: Kernel) -> None:
        self.robot = robot
        self._discrete_state: tuple[object, ...] = ()
        self._snapshot: Snapshot
        self._parts = 0
        """Those of the snapshot that are of its tick."""

    @property
    def description(self) -> RobotDescription:
        return self.robot.description

    @property
    def room(self) -> float | None:
        return 1.0

    async def open(self) -> None:
        """Do nothing: the robot is there."""

    @property
    def due_tick(self) -> int | None:
        return self.robot.due_tick()

    @property
    def restarts(self) -> int:
        return 0

    def watch(self, on_due: Callable[[], object]) -> None:
        """Do nothing: a robot in this process does nothing by itself but what `due_tick` announces."""

    def hurry(self, inputs: Sequence[Input]) -> None:
        """Do nothing: a tick in this process is over when anything else happens."""

    @property
    def busy_line(self) -> int:
        return 0

    def knows(self, number: int, parts: int) -> bool:
        """Return False: a tick in this process is computed when it comes."""
        return False

    def known(self, number: int, parts: int) -> Output | None:
        return None

    async def tick(
        self,
        inputs: Sequence[Input],
        parts: int = ALL_PARTS,
        number: int | None = None,
        *,
        asks_due: bool = True,
        outlet: Callable[[], Awaitable[None]] | None = None,
    ) -> Output:
        robot = self.robot
        result, discrete_state = robot.tick(inputs, number), robot.discrete_state()
        if parts or discrete_state != self._discrete_state:
            self._discrete_state = discrete_state
            self._parts = parts | TIME
            self._snapshot = robot.snapshot(self._parts)
        output = result.with_snapshot(self._snapshot, self._parts)
        if outlet is not None:
            await outlet()
        return output

    def completed(self, output: Output) -> Output:
        """Return the output of the last tick with all parts of its snapshot."""
        if output.has(ALL_PARTS):
            return output
        self._snapshot, self._parts = self.robot.snapshot(), ALL_PARTS
        return output.with_snapshot(self._snapshot)

    async def close(self) -> None:
        """Do nothing: there is nothing to end."""
