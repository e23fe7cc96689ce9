"""What clients are told in the place of a robot that was given up: that it is gone, and what has ended with it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from elitescript.language.options import SECONDARY
from elitescript.messages.enums import TaskState
from elitescript.messages.events import Alarm, Event, TaskStateChanged
from elitescript.messages.inputs import Input, PlayTask, RunUnit
from elitescript.messages.snapshot import Snapshot

HINT: Final = "a call into Python's own functions cannot be interrupted; do less in one call"
COMPILE_HINT: Final = "split the program, or read long lists of points from a file"
FILES_HINT: Final = "read and write less in one control period: put a sync() or sleep() into the loop"
_NAME_MAX: Final = 100


def last_words(
    tick: int,
    reason: str,
    last: Snapshot | None,
    lost: Sequence[Input] = (),
    *,
    where: tuple[str, int] | None = None,
    hint: str = "",
    last_line: int = 0,
) -> tuple[Event, ...]:
    """The events.

    A program that began in the tick that was never answered is told of too: whoever waits for its start and its end
    gets both. That a text which came in that tick has begun is *assumed* where it is not known what the robot did.

    Args:
        tick: in which it is told.
        reason: why the robot was given up.
        last: its last picture; None if there is none.
        lost: inputs of the tick that it has not answered.
        where: text and line of the program that it was in; None if that is not known.
        last_line: of the program, at the last tick that the robot has answered.
        hint: what to do about it, if it was given up because it did not answer.
    """
    state = None if last is None else last.robot
    is_running = state is not None and state.task_state is not TaskState.STOPPED
    running = last.task.running if last is not None and is_running else ""
    begun = _begun(last, lost, where)
    events: list[Event] = []
    if begun is not None:
        if is_running:
            events.append(TaskStateChanged(tick, TaskState.STOPPED, running, "stopped"))
        events.append(TaskStateChanged(tick, TaskState.PLAYING, begun))
        running, is_running = begun, True
    line = where[1] if where else 0
    if not line and begun is None:
        line = last_line
    details = {"program": where[0], "hint": hint or HINT} if where else {"hint": hint} if hint else {}
    text = f"the controller was restarted: {reason}"
    events.append(Alarm(tick, "R132", "ControllerRestarted", text, line, 0, "", "", details))
    if is_running:
        events.append(TaskStateChanged(tick, TaskState.STOPPED, running, "alarm"))
    return tuple(events)


def _begun(last: Snapshot | None, lost: Sequence[Input], where: tuple[str, int] | None) -> str | None:
    """Name of the program that has begun in the lost tick; None if none has."""
    found: str | None = None
    for item in lost:
        if isinstance(item, RunUnit) and item.kind != SECONDARY:
            if where is None or where[0] == f"<{item.origin}>":
                found = _name_of(item.text)
        elif isinstance(item, PlayTask) and last is not None and last.robot.task_state is TaskState.STOPPED:
            stem = last.task.loaded.removesuffix(".task")
            if where is None or (stem and where[0].rpartition("/")[2].startswith(f"{stem.rpartition('/')[2]}.")):
                found = stem
    return found


def _name_of(text: str) -> str:
    """The name of a program: what stands between `def` and the bracket."""
    word, _, rest = text.lstrip().partition(" ")
    return rest.partition("(")[0].strip()[:_NAME_MAX] if word == "def" else ""
