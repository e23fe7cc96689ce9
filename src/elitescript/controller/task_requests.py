"""Requests to the task and to the power: pause, resume, stop; power on, release the brakes, power off."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, Protocol

from elitescript.controller.modes import Power
from elitescript.controller.safety.control import SafetyControl
from elitescript.controller.tasks import ProgramPort, Task
from elitescript.errors import ScriptStateError
from elitescript.messages.enums import RobotMode
from elitescript.messages.machine import (
    PauseTask,
    PowerDown,
    PowerOff,
    PowerOn,
    ReleaseBrakes,
    ResumeTask,
    StopTask,
)


class TaskControl(Protocol):
    """What these requests change."""

    power: Power
    task: Task
    program: ProgramPort
    safety: SafetyControl

    @property
    def tick(self) -> int:
        """The present one."""

    def switch_off(self) -> None:
        """Stop the arm and switch its power off at standstill."""


def _pause(port: TaskControl, _request: PauseTask) -> None:
    if port.safety.take_pause():
        return
    port.task.apply("pause")
    port.program.pause()


def _resume(port: TaskControl, _request: ResumeTask) -> None:
    port.safety.require("resume_task")
    port.task.apply("resume")
    port.program.resume()


def _stop(port: TaskControl, _request: StopTask) -> None:
    if not port.task.is_running:
        raise ScriptStateError("cannot stop: no task is running")
    port.program.stop("stopped")


def _go_up(port: TaskControl, goal: RobotMode) -> None:
    port.safety.require("power_on")
    if port.power.is_going_off:
        raise ScriptStateError("cannot power on: the arm is being switched off", hint="ask again when it is off")
    port.power.go_up(goal, port.tick)


def _power_on(port: TaskControl, _request: PowerOn) -> None:
    _go_up(port, RobotMode.IDLE)


def _release_brakes(port: TaskControl, _request: ReleaseBrakes) -> None:
    _go_up(port, RobotMode.RUNNING)


def _power_off(port: TaskControl, _request: PowerOff | PowerDown) -> None:
    if port.task.is_running:
        port.program.stop("power off")
    port.switch_off()


TASK_HANDLERS: Final[dict[type, Callable[[TaskControl, Any], None]]] = {
    PauseTask: _pause,
    ResumeTask: _resume,
    StopTask: _stop,
    PowerOn: _power_on,
    ReleaseBrakes: _release_brakes,
    PowerOff: _power_off,
    PowerDown: _power_off,
}
"""Every request to task and power, and what handles it."""
