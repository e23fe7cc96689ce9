"""The time of a served robot that goes by the wall clock."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from operator import attrgetter
from typing import Any, Final, Protocol

from elitescript.messages.enums import TaskState
from elitescript.messages.inputs import Input, Lag
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot import Snapshot
from elitescript.messages.timing import PERIOD_S, TICKS_PER_S
from elitescript.services.time.cycle import Cycle

REPORT_TICKS: Final = 10 * TICKS_PER_S
"""After so many ticks the log says how many of them were late."""
LATE_MANY: Final = REPORT_TICKS // 100
"""So many of them are a problem."""

_ALL_FIELDS: Final = attrgetter(*Snapshot.__dataclass_fields__)
_OVERRUNS_AT: Final = list(Snapshot.__dataclass_fields__).index("overruns")


class TimedRobot(Protocol):
    """A served robot, as what keeps its time needs it."""

    name: str
    output: Output
    """Of the last tick."""

    @property
    def has_readers(self) -> bool:
        """Whether an output leaves this process: clients, or connections of programs, are open."""

    @property
    def has_peers(self) -> bool:
        """Whether connections of programs are open."""

    def begin_tick(self) -> list[Input]:
        """Take what the tick that begins now is given."""

    async def run_tick(self, inputs: Sequence[Input]) -> Output:
        """Run the tick."""

    def end_tick(self, output: Output) -> None:
        """Publish the output of the tick."""

    def note(self, kind: str, text: str, *, is_problem: bool = False, **details: Any) -> None:
        """Write a line of the log."""


class PacedTime:
    """One tick after the other, each when it is due; see `cycle`.

    Args:
        robot: the robot.

    Attributes:
        waits_for: of lockstep; always empty.
    """

    __slots__ = ("_counted", "_cycle", "_lag_ticks", "_plain", "_robot")

    waits_for: Final = ""

    def __init__(self, robot: TimedRobot) -> None:
        self._robot = robot
        self._cycle = Cycle(on_left_out=lambda ticks: note_left_out(robot, ticks))
        self._lag_ticks = 0
        """The last that was an input of the robot."""
        self._plain: Snapshot | None = None
        self._counted: Snapshot | None = None
        """The snapshot of the last output as the robot made it, and with the count of late ticks."""

    @property
    def overruns(self) -> int:
        """Ticks that began late."""
        return self._cycle.overruns

    @property
    def left_out(self) -> int:
        """Ticks that never were because the computer was away."""
        return self._cycle.left_out

    async def run(self) -> None:
        """Let time pass; never returns."""
        cycle, robot = self._cycle, self._robot
        while True:
            before = cycle.overruns
            for _ in range(REPORT_TICKS):
                await cycle.next()
                output = await robot.run_tick([*self._lag(cycle.lag_ticks), *robot.begin_tick()])
                if cycle.overruns:
                    output = self._with_overruns(output, cycle.overruns)
                if robot.has_readers:
                    await cycle.outlet()
                robot.end_tick(output)
            self._report(cycle.overruns - before)

    def wake(self) -> None:
        """Do nothing: time waits for no client."""

    def close(self) -> None:
        """No tick comes after this."""
        self._cycle.close()

    def _lag(self, ticks: int) -> tuple[Lag, ...]:
        """Return the input for how far robot time is behind, if that is new and programs may wait for peers."""
        if ticks == self._lag_ticks or (ticks and not self._robot.has_peers):
            return ()
        self._lag_ticks = ticks
        return (Lag(self._robot.name, ticks),)

    def _with_overruns(self, output: Output, overruns: int) -> Output:
        """Return an output whose snapshot has that count; the very same snapshot while nothing has changed."""
        snapshot = output.snapshot
        if self._counted is None or snapshot is not self._plain or self._counted.overruns != overruns:
            # `dataclasses.replace` takes some times as long.
            fields = list(_ALL_FIELDS(snapshot))
            fields[_OVERRUNS_AT] = overruns
            self._plain, self._counted = snapshot, Snapshot(*fields)
        return replace(output, snapshot=self._counted)

    def _report(self, late: int) -> None:
        """Write how many ticks began late of the last `REPORT_TICKS`."""
        worst_ms, self._cycle.worst_ns = self._cycle.worst_ns / 1e6, 0
        if late:
            text = f"{late} of {REPORT_TICKS} ticks began late, by {worst_ms:.1f} ms at most: the computer is busy"
            self._robot.note("late", text, is_problem=late >= LATE_MANY, ticks=late, worst_ms=worst_ms)


def note_left_out(robot: TimedRobot, ticks: int) -> None:
    """Write that ticks never were."""
    is_playing = robot.output.snapshot.robot.task_state is TaskState.PLAYING
    text = f"the computer was away or too slow for {ticks * PERIOD_S:.3f} s: {ticks} ticks of the robot are left out"
    robot.note("left_out", text, is_problem=True, ticks=ticks, is_playing=is_playing)
