"""The task: what state the program is in, and who may change it.

`TRANSITIONS` is the whole state machine; a transition that is not in it is refused with its reason.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, Protocol

from elitescript.errors import ScriptStateError
from elitescript.messages.enums import TaskState
from elitescript.messages.events import Alarm


class ProgramPort(Protocol):
    """What the controller asks of whatever runs scripts."""

    def run_tick(self, tick: int) -> None:
        """Run every script thread that is due, until each waits or has used up this tick's work."""

    def next_tick(self, tick: int) -> int | None:
        """Earliest tick after `tick` at which a script thread is due; None while all wait for something else."""

    def motion_ended(self, move: int, is_complete: bool) -> None:
        """The arm stands still; threads that wait for this move go on at the next `run_tick`."""

    def pause(self) -> None:
        """Let no script thread go on."""

    def resume(self) -> None:
        """Let the script threads go on."""

    def stop(self, reason: str) -> None:
        """End every script thread at the next `run_tick`."""

    def fail(self, alarm: Alarm) -> None:
        """End them as an alarm does, which the program has not caused and cannot catch."""

    @property
    def line(self) -> int:
        """Line of the main thread; 0 without a program."""

    @property
    def caller(self) -> tuple[str, int]:
        """Name and line of the thread that runs at this moment; an empty name and 0 while none does."""


class NoProgram:
    """Stands in until a program port is attached."""

    line = 0
    caller = ("", 0)

    def run_tick(self, tick: int) -> None:
        """Nothing runs."""

    def next_tick(self, tick: int) -> int | None:
        """Nothing is due."""
        return None

    def motion_ended(self, move: int, is_complete: bool) -> None:
        """Nobody waits."""

    def pause(self) -> None:
        """Nothing runs."""

    def resume(self) -> None:
        """Nothing runs."""

    def stop(self, reason: str) -> None:
        """Nothing runs."""

    def fail(self, alarm: Alarm) -> None:
        """Nothing runs."""


TRANSITIONS: Final[dict[tuple[TaskState, str], TaskState]] = {
    (TaskState.STOPPED, "start"): TaskState.PLAYING,
    (TaskState.PLAYING, "pause"): TaskState.PAUSED,
    (TaskState.PAUSED, "resume"): TaskState.PLAYING,
    (TaskState.PLAYING, "stop"): TaskState.STOPPED,
    (TaskState.PAUSED, "stop"): TaskState.STOPPED,
}

REFUSALS: Final[dict[tuple[TaskState, str], str]] = {
    (TaskState.STOPPED, "pause"): "no task is running",
    (TaskState.STOPPED, "resume"): "no task is paused",
    (TaskState.STOPPED, "stop"): "no task is running",
    (TaskState.PLAYING, "start"): "a task is running; stop it first",
    (TaskState.PLAYING, "resume"): "the task is not paused",
    (TaskState.PAUSED, "start"): "a task is paused; resume or stop it first",
    (TaskState.PAUSED, "pause"): "the task is paused already",
}


class Task:
    """State of the one task that a controller has."""

    __slots__ = ("_on_change", "name", "state")

    def __init__(self, on_change: Callable[[TaskState, TaskState], None]) -> None:
        self._on_change = on_change
        self.state = TaskState.STOPPED
        self.name = ""

    @property
    def is_running(self) -> bool:
        """Whether a task runs; a paused one does."""
        return self.state is not TaskState.STOPPED

    def apply(self, action: str) -> None:
        """Make the transition `start`, `pause`, `resume` or `stop`.

        Raises:
            ScriptStateError: the table does not have it; the reason is in the text.
        """
        before = self.state
        after = TRANSITIONS.get((before, action))
        if after is None:
            raise ScriptStateError(f"cannot {action}: {REFUSALS[before, action]}")
        self.state = after
        self._on_change(before, after)
