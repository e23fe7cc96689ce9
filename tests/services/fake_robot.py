"""A robot for the tests of services: it remembers what it is asked, and says what the test wants."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from elitescript.messages.enums import RobotMode, TaskState
from elitescript.messages.inputs import Do, GetVariable, Input, Interpret, PlayTask, Query, RunUnit
from elitescript.messages.machine import PowerOff, PowerOn, ReleaseBrakes, SetSpeedScale, WriteSignal
from elitescript.messages.outcomes import Done, Outcome, Refused, ShownValue, StatementAccepted
from elitescript.messages.outputs import Reply, TickResult
from elitescript.messages.snapshot import RobotDescription, Snapshot
from elitescript.messages.snapshot_parts import ALL_PARTS
from tests.protocol.snapshots import description, output


class FakeRobot:
    """Applies signals, speed and power at once; everything else it only remembers."""

    def __init__(self, **changes: Any) -> None:
        self.description: RobotDescription = description()
        self.heard: list[tuple[int, Input]] = []
        self.says: dict[int, dict[str, Any]] = {}
        """Events, requests and replies by tick."""
        self.refuses = ""
        """If not empty, requests to the machine are refused for this reason."""
        self.play_answer: Outcome = Done()
        self.on_tick: Callable[[int], None] = lambda tick: None
        self._snapshot = output(0, task_state=TaskState.STOPPED, **changes).snapshot
        self._tick = -1

    def due_tick(self) -> int | None:
        """Every tick, as the test may let it say something at any time."""
        return self._tick + 1

    def tick(self, inputs: Sequence[Input], number: int | None = None) -> TickResult:
        self._tick = self._tick + 1 if number is None else number
        tick = self._tick
        self.on_tick(tick)
        self.heard += [(tick, item) for item in inputs]
        replies: list[Reply] = []
        snapshot = self._snapshot
        for item in inputs:
            if isinstance(item, Do):
                if not self.refuses:
                    snapshot = self._done(snapshot, item.request)
                if item.is_answered:
                    replies.append(Reply(item.origin, Refused(self.refuses) if self.refuses else Done()))
            elif isinstance(item, PlayTask):
                replies.append(Reply(item.origin, self.play_answer))
            elif isinstance(item, GetVariable):
                replies.append(Reply(item.origin, Refused("no such variable")))
            elif isinstance(item, Interpret):
                replies.append(Reply(item.origin, StatementAccepted(1, item.text)))
            elif isinstance(item, Query):
                replies.append(Reply(item.origin, ShownValue(item.text)))
        snapshot = replace(snapshot, robot=replace(snapshot.robot, tick=tick, time_s=tick * 0.004))
        said = {"events": (), "requests": (), "replies": tuple(replies)} | self.says.pop(tick, {})
        self._snapshot = snapshot
        return TickResult(tick=tick, **said)

    def snapshot(self, parts: int = ALL_PARTS) -> Snapshot:
        return self._snapshot

    def discrete_state(self) -> tuple[object, ...]:
        return (replace(self._snapshot, robot=replace(self._snapshot.robot, tick=0, time_s=0.0)),)

    @staticmethod
    def _done(snapshot: Any, request: Any) -> Any:
        if isinstance(request, WriteSignal):
            levels = list(snapshot.signals[request.name])
            levels[request.index] = request.value
            return replace(snapshot, signals={**snapshot.signals, request.name: tuple(levels)})
        modes = {PowerOn: RobotMode.IDLE, PowerOff: RobotMode.POWER_OFF, ReleaseBrakes: RobotMode.RUNNING}
        if type(request) in modes:
            return replace(snapshot, robot=replace(snapshot.robot, robot_mode=modes[type(request)]))
        if isinstance(request, SetSpeedScale):
            return replace(snapshot, robot=replace(snapshot.robot, speed_scale=request.fraction))
        return snapshot

    def units(self) -> list[str]:
        """Texts of the programs that came in."""
        return [item.text for _, item in self.heard if isinstance(item, RunUnit)]

    def say(self, **what: Any) -> None:
        """Say something at the next tick."""
        self.says.setdefault(self._tick + 1, {}).update(what)
