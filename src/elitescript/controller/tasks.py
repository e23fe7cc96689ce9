"""Defines the task: the state of the program, and its transitions.

`TRANSITIONS` is the whole state machine; a transition that is not in it is refused with its reason.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, Protocol

from elitescript.errors import ScriptStateError
from elitescript.messages.enums import TaskState
from elitescript.messages.events import Alarm
from elitescript.said import said


class ProgramPort(Protocol):
    """Lists the methods of the host of scripts that the controller calls."""

    def run_tick(self, tick: int) -> None:
        """Run every script thread that is due until it waits or has used up this tick's work."""

    def next_tick(self, tick: int) -> int | None:
        """Return the earliest tick after `tick` at which a script thread is due; None while there is none."""

    def motion_ended(self, move: int, is_complete: bool) -> None:
        """Wake the threads that wait for a move; they go on at the next `run_tick`."""

    def pause(self) -> None:
        """Suspend the script threads."""

    def resume(self) -> None:
        """Let the script threads go on after a pause."""

    def stop(self, reason: str) -> None:
        """End every script thread at the next `run_tick`."""

    def fail(self, alarm: Alarm) -> None:
        """End every script thread with an alarm that the program cannot catch."""

    @property
    def line(self) -> int:
        """Line of the main thread; 0 without a program."""

    @property
    def caller(self) -> tuple[str, int]:
        """Name and line of the running thread; an empty name and 0 while none runs."""

    @property
    def caller_line(self) -> int:
        """Line of the running thread; 0 while none runs."""

    def is_cleanup(self, line: int) -> bool:
        """Return whether a line of the program stands in a block of `except` or `finally`."""


class NoProgram:
    """Do nothing: the port until a host is attached."""

    line = 0
    caller = ("", 0)
    caller_line = 0

    def is_cleanup(self, line: int) -> bool:
        return False

    def _ignore(self, *_: Any) -> None:
        pass

    run_tick = next_tick = motion_ended = pause = resume = stop = fail = _ignore


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
    """The one task of a controller, and the host of its program.

    Args:
        on_change: called with the states before and after a change.

    Attributes:
        name: of the program that runs or ran last.
        program: host of its threads.
        state: of the task.
        successor: what replaces the program while it is stopped for that, in words; empty otherwise.
    """

    __slots__ = ("_is_held", "_on_change", "name", "program", "state", "successor")

    def __init__(self, on_change: Callable[[TaskState, TaskState], None]) -> None:
        self._on_change = on_change
        self._is_held = False
        self.program: ProgramPort = NoProgram()
        self.state = TaskState.STOPPED
        self.name = ""
        self.successor = ""

    @property
    def is_running(self) -> bool:
        """Whether a task runs; a paused one does."""
        return self.state is not TaskState.STOPPED

    def start(self) -> None:
        """Begin the task."""
        self.apply("start")
        self._is_held = False

    def pause(self) -> None:
        """Pause the task; a task held by a safeguard then stays paused when the safeguard is closed."""
        if self._is_held:
            self._is_held = False
            return
        self.apply("pause")
        self.program.pause()

    def resume(self) -> None:
        """Let a paused task go on."""
        self.apply("resume")
        self.program.resume()

    def stop(self, reason: str) -> None:
        """End the threads of the program, and then the task.

        Raises:
            ScriptStateError: no task runs.
        """
        if not self.is_running:
            raise ScriptStateError("cannot stop: no task is running")
        self.program.stop(reason)

    def hold(self) -> None:
        """Pause a running task until `release`."""
        self.apply("pause")
        self.program.pause()
        self._is_held = True

    def release(self) -> None:
        """Resume a task that `hold` has paused, unless it was paused or stopped otherwise since."""
        was_held, self._is_held = self._is_held, False
        if was_held and self.state is TaskState.PAUSED:
            self.resume()

    def fail(self, alarm: Alarm) -> None:
        """End the task, if one runs, with an alarm."""
        self._is_held = False
        if self.is_running:
            self.program.fail(alarm)

    def apply(self, action: str) -> None:
        """Make the transition `start`, `pause`, `resume` or `stop`.

        Raises:
            ScriptStateError: the table does not have it; the reason is in the text.
        """
        self.require(action)
        before, self.state = self.state, TRANSITIONS[self.state, action]
        self._on_change(before, self.state)

    def require(self, action: str) -> None:
        """Check that a transition is possible.

        Raises:
            ScriptStateError: the table does not have it; the reason is in the text.
        """
        if (self.state, action) not in TRANSITIONS:
            raise ScriptStateError(
                said("cannot {action}: {refusals}", action=action, refusals=REFUSALS[self.state, action])
            )
