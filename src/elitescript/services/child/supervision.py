"""Supervision of children: when one has failed, when the next one starts, and the events that clients get in between.

A child that has worked for `HANG_LIMIT_S` without an answer is in a call that does not come back. Its own processor
time counts, so that a busy computer does not look like such a call; one that does not work either, because it sleeps,
is killed after `SILENCE_MAX_S`, but not one that waits for a processor. Reading a long program and its questions about
files are no such calls: see `compile_s` and `FILES_MAX_S`.

The next child starts at once, after several failures in a row later and later.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Final

from elitescript.language.options import SECONDARY
from elitescript.messages.enums import TaskState
from elitescript.messages.events import Alarm, Event, TaskStateChanged
from elitescript.messages.inputs import Input, PlayTask, RunUnit
from elitescript.messages.snapshot import Snapshot
from elitescript.messages.timing import TICKS_PER_S
from elitescript.records import NamedTuple
from elitescript.said import said
from elitescript.services.child.process import ChildProcess
from elitescript.services.child.transport import ChildTransport, SentTick
from elitescript.services.child.urgent import WORKED_SHARE

HANG_LIMIT_S: Final = 0.7
"""Processor time without an answer after which a child is killed; wall time where processor time is not known."""
FIRST_HANG_LIMIT_S: Final = 3.0
"""The same before the first output of a fresh child, which has its robot to make."""
SILENCE_MAX_S: Final = 5.0
"""Wall time without an answer after which a child is killed that sleeps."""
COMPILE_S_PER_BYTE: Final = 40e-6
"""Added for every byte of program text; checking and compiling lines of `movel` takes a fifth of it (*measured*)."""
COMPILE_MAX_S: Final = 160.0
"""Upper bound of the extra time for compiling."""
FILES_MAX_S: Final = 10.0
"""How long questions about files in one tick count as answers."""
HANG_LIMIT_TICKS: Final = 20
"""Ticks that have gone by as well: while this process itself was stopped, no child could answer."""
ASK_SHARE: Final = 0.4
"""Share of the time for a stop after which a child is asked where its program is."""
TRACE_S: Final = 0.05
"""How long a child that is to be killed may take to write where it is."""
BOOTS_FROM_SNAPSHOT: Final = 3
"""From so many of them on, one begins as the first did: the last snapshot may be what they fail of."""
BOOTS_MAX: Final = 5
"""Children that may end one after the other before they have answered a tick."""
CALM_TICKS: Final = 10 * TICKS_PER_S
"""After so many answered ticks earlier failures do not count any more."""
PAUSES_TICKS: Final = (0, 0, 0, 62, 125, 250, 500, 1000, 2000)
"""Ticks before the next child starts, by the number of failures in a row."""

HINT: Final = "a call into Python's own functions cannot be interrupted; do less in one call"
COMPILE_HINT: Final = "split the program, or read long lists of points from a file"
FILES_HINT: Final = "read and write less in one control period: put a sync() or sleep() into the loop"
_NAME_MAX: Final = 100


class Failure(NamedTuple):
    """Why a child is to be replaced."""

    reason: str
    where: tuple[str, int] | None
    """Text and line of the program that it was in; None if that is not known."""
    hint: str = ""
    """What to do about it, if it did not answer."""
    is_stop: bool = False
    """Whether that was done to stop its program."""


def compile_s(size: int) -> float:
    """Return how much longer a child may take to answer that has so many bytes of program text to compile, s."""
    return min(size * COMPILE_S_PER_BYTE, COMPILE_MAX_S)


class Supervision:
    """Watches one child after the other.

    Args:
        hang_limit_s: see `HANG_LIMIT_S`.

    Attributes:
        answered: ticks that the present child has answered.
        boots: children since the last answer, with the present one.
        reason: of the last failure.
        restarts: children that had to be replaced.
    """

    __slots__ = (
        "_asked_where_s",
        "_failures",
        "_is_measured",
        "_restart_at",
        "_since_s",
        "_worked_s",
        "answered",
        "boots",
        "hang_limit_s",
        "reason",
        "restarts",
    )

    def __init__(self, hang_limit_s: float) -> None:
        self.hang_limit_s = hang_limit_s
        self._since_s = self._asked_where_s = 0.0
        self._worked_s: float | None = None
        """Processor time of the child at the end of the first tick in which it has not answered; None if not known."""
        self._is_measured = False
        self._failures = self._restart_at = 0
        self.answered = self.boots = self.restarts = 0
        self.reason = ""

    # ---------------------------------------------------------------- events

    def note_start(self) -> None:
        """Count a child that was started, or that takes the place of another one."""
        self.boots += 1
        self.answered = 0
        self._asked_where_s = 0.0

    def note_answer(self, ticks: int = 1) -> None:
        """Count a tick that the child has answered.

        Args:
            ticks: how many have gone by since the one before.
        """
        self.boots = 0
        self.answered += ticks
        if self.answered >= CALM_TICKS:
            self._failures = 0
        self._asked_where_s = 0.0
        self.watch_from_now()

    def watch_from_now(self) -> None:
        """Begin to wait for an answer anew."""
        self._since_s = time.monotonic()
        self._is_measured = False

    def note_failure(self, tick: int, reason: str) -> str:
        """Count a failure; return the reason, with when the next child starts if that is not at once."""
        self.restarts += 1
        pause = self._put_off(tick, reason)
        if pause:
            return said(
                "{reason}; after {failures} times in a row it starts {pause:g} s later",
                reason=reason,
                failures=self._failures,
                pause=pause / TICKS_PER_S,
            )
        return reason

    def note_ended(self, reason: str) -> None:
        """Count a child that was ended for a stop."""
        self.restarts += 1
        self.reason = reason

    def note_no_process(self, tick: int, reason: str) -> None:
        """Note that no process can be started just now: try again after the longest pause."""
        self._put_off(tick, reason)
        self._restart_at = tick + PAUSES_TICKS[-1]

    def _put_off(self, tick: int, reason: str) -> int:
        self._failures += 1
        self.reason = reason
        pause = PAUSES_TICKS[min(self._failures, len(PAUSES_TICKS) - 1)]
        self._restart_at = tick + pause
        return pause

    # ---------------------------------------------------------------- decisions

    def may_start(self, tick: int) -> bool:
        """Return whether the next child is to start at a tick."""
        return tick >= self._restart_at

    def silent_s(self) -> float:
        """Return how long the child has not answered, s."""
        return time.monotonic() - self._since_s

    def failure_of(self, transport: ChildTransport, tick: int) -> Failure | None:
        """Return why the child is to be replaced; None if it is not, or not yet.

        One that does not answer is asked first where its program is.
        """
        if transport.end_reason:
            return Failure(transport.failure or transport.end_reason, transport.process.where())
        if not transport.unanswered:
            return None
        process, sent = transport.process, transport.unanswered[0]
        if not self._is_measured:
            # Most answers come in the tick that they are asked for in, and this is not reached.
            self._worked_s, self._is_measured = process.worked_s(), True
        if not self._is_hanging(tick - sent.number, process, more_s=compile_s(sent.size)):
            return None
        if not self._asked_where_s:
            self._asked_where_s = time.monotonic()
            process.ask_where()
            return None
        where = process.where()
        if where is None and time.monotonic() - self._asked_where_s <= TRACE_S:
            return None
        return self._hang(sent, where, is_compiling=process.is_compiling)

    def stop_failure(
        self, transport: ChildTransport, since_s: float, limit_s: float, worked_s: float | None
    ) -> Failure | None:
        """Return why the child is to be replaced so that a stop acts; None if it is not, or not yet.

        Args:
            transport: to it.
            since_s: when it was asked for, by the monotonic clock.
            limit_s: how long that may take.
            worked_s: processor time of the child then; None if that is not known.
        """
        process, passed_s = transport.process, time.monotonic() - since_s
        if not self._asked_where_s and passed_s >= ASK_SHARE * limit_s:
            self._asked_where_s = time.monotonic()
            process.ask_where()
        if passed_s < limit_s:
            return None
        now_s = process.worked_s()
        if now_s is not None and worked_s is not None and now_s - worked_s < WORKED_SHARE * limit_s:
            return None
        reason = said(
            "a call of the program had not come back {passed_s:.0f} ms after it was to be stopped",
            passed_s=passed_s * 1000.0,
        )
        return Failure(reason, process.where(), HINT, is_stop=True)

    def _is_hanging(self, ticks: int, process: ChildProcess, *, more_s: float) -> bool:
        """Return whether the child takes too long to answer.

        Args:
            ticks: that have gone by since it was asked what it has not answered.
            process: it.
            more_s: how much longer than others it may take.
        """
        silent_s = self.silent_s()
        limit_s = (max(self.hang_limit_s, FIRST_HANG_LIMIT_S) if self.boots else self.hang_limit_s) + more_s
        if silent_s < limit_s or ticks < HANG_LIMIT_TICKS:
            return False
        now_s = process.worked_s()
        if now_s is None or self._worked_s is None:
            return True
        if now_s - self._worked_s >= limit_s:
            return True
        return silent_s >= max(SILENCE_MAX_S, limit_s) and not process.is_runnable()

    def _hang(self, sent: SentTick, where: tuple[str, int] | None, *, is_compiling: bool) -> Failure:
        silent_s = self.silent_s()
        if is_compiling and where is None:
            reason = said(
                "a program text of {size} bytes was not compiled within {silent_s:.1f} s",
                size=sent.size,
                silent_s=silent_s,
            )
            return Failure(reason, where, COMPILE_HINT)
        if sent.asking_since_s and time.monotonic() - sent.asking_since_s >= FILES_MAX_S:
            reason = said(
                "the program has worked with files for more than {files_max_s:g} s in one tick", files_max_s=FILES_MAX_S
            )
            return Failure(reason, where, FILES_HINT)
        return Failure(
            said("a call of the program did not come back for {silent_s:.2f} s", silent_s=silent_s), where, HINT
        )


def termination_events(
    tick: int, failure: Failure, last: Snapshot | None, lost: Sequence[Input] = (), last_line: int = 0
) -> tuple[Event, ...]:
    """Return the events that clients get in the place of a robot that is gone, with what has ended with it.

    A program that began in the tick that was never answered has a start and an end here too. That a text which came in
    that tick has begun is *assumed* where it is not known what the robot did.

    Args:
        tick: in which they are published.
        failure: why the robot was replaced.
        last: its last snapshot; None if there is none.
        lost: inputs of the tick that it has not answered.
        last_line: of the program, at the last tick that it has answered.
    """
    where = failure.where
    is_running = last is not None and last.robot.task_state is not TaskState.STOPPED
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
    hint = failure.hint
    details = {"program": where[0], "hint": hint or HINT} if where else {"hint": hint} if hint else {}
    text = said("the controller was restarted: {reason}", reason=failure.reason)
    events.append(Alarm(tick, "R132", "ControllerRestarted", text, line, 0, "", "", details))
    if is_running:
        ended = TaskStateChanged(tick, TaskState.STOPPED, running, "stopped" if failure.is_stop else "alarm")
        # A stop that was asked for is reported before the alarm about what it has taken.
        events.insert(len(events) - failure.is_stop, ended)
    return tuple(events)


def _begun(last: Snapshot | None, lost: Sequence[Input], where: tuple[str, int] | None) -> str | None:
    """Return the name of the program that has begun in the lost tick; None if none has."""
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
    """Return the name of a program: what stands between `def` and the bracket."""
    word, _, rest = text.lstrip().partition(" ")
    return rest.partition("(")[0].strip()[:_NAME_MAX] if word == "def" else ""
