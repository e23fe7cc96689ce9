"""Requests that pause, resume and end the task."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, Protocol

from elitescript.controller.safety_control import SafetyControl
from elitescript.controller.tasks import ProgramPort, Task
from elitescript.errors import ScriptStateError
from elitescript.messages.machine import PauseTask, PowerDown, ResumeTask, StopTask


class TaskPort(Protocol):
    """What these requests change."""

    task: Task
    program: ProgramPort
    safety: SafetyControl

    def switch_off(self) -> None:
        """Stop the arm and switch its power off at standstill."""


def _pause(port: TaskPort, _request: PauseTask) -> None:
    if port.safety.take_pause():
        return
    port.task.apply("pause")
    port.program.pause()


def _resume(port: TaskPort, _request: ResumeTask) -> None:
    port.safety.require("resume_task")
    port.task.apply("resume")
    port.program.resume()


def _stop(port: TaskPort, _request: StopTask) -> None:
    if not port.task.is_running:
        raise ScriptStateError("cannot stop: no task is running")
    port.program.stop("stopped")


def _power_down(port: TaskPort, _request: PowerDown) -> None:
    if port.task.is_running:
        port.program.stop("powerdown")
    port.switch_off()


TASK_HANDLERS: Final[dict[type, Callable[[TaskPort, Any], None]]] = {
    PauseTask: _pause,
    ResumeTask: _resume,
    StopTask: _stop,
    PowerDown: _power_down,
}
"""Every request to the task, and what handles it."""
