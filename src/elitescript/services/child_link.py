"""The way to a robot in a child process: no program that runs there can hold up whoever serves it.

A tick is sent to the child, and its output taken, within the period. A child that is late is not waited for: clients
see the last picture meanwhile, the ticks queue up, and the child makes up for them. One that has worked for
`PATIENCE_S` without saying anything is in a call that does not come back: it is killed, and a fresh child goes on from
the last picture. Its own processor time counts, so that a busy computer does not look like such a call; one that does
not work either, because it sleeps, is killed after `ABSENCE_MAX_S`.
"""

from __future__ import annotations

import asyncio
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

from elitescript.errors import ElitescriptError, UsageError
from elitescript.kernel import KernelConfig
from elitescript.kernel.restart import restored_config, restored_inputs
from elitescript.messages.codec import from_text, to_text
from elitescript.messages.events import Warned
from elitescript.messages.inputs import ChannelClosed, ChannelData, ChannelOpened, Input
from elitescript.messages.outputs import CloseChannel, OpenChannel, OpenLine, Output
from elitescript.messages.shapes import CodecError
from elitescript.messages.snapshot import RobotDescription
from elitescript.messages.timing import PERIOD_S
from elitescript.runtime.world import Files, FilesRefused
from elitescript.services import frames
from elitescript.services.child_process import ChildProcess, Silence
from elitescript.services.config_codec import full_codec
from elitescript.services.jail import MEMORY_MAX, Layer
from elitescript.services.journal import Journal
from elitescript.services.last_words import last_words
from elitescript.services.output_buffer import OutputBuffer
from elitescript.services.output_changes import OutputReader
from elitescript.services.remote_files import FileDesk

PATIENCE_S: Final = 0.7
"""Processor time without a word after which a child is given up; wall time where processor time is not known."""
FIRST_PATIENCE_S: Final = 3.0
"""The same before the first output of a fresh child, which has its robot to make."""
ABSENCE_MAX_S: Final = 5.0
"""Wall time without a word after which a child is given up, whatever it does."""
PATIENCE_TICKS: Final = 20
"""Ticks that have gone by as well: whoever was away himself has no reason to complain."""
GRACE_S: Final = 0.0015
"""How long an output is waited for in its own period; timers of an event loop may add 1 ms."""
ON_TIME_S: Final = 0.8 * PERIOD_S
"""Whoever calls again sooner than this has time to make up for, and does not wait."""
BEHIND_TICKS: Final = 3
"""Ticks behind which no output is waited for."""
TRACE_S: Final = 0.05
"""How long a child that is given up may take to say where it is."""
READING_MAX_S: Final = 0.25
READING_KEPT: Final = 0.99
"""Time that the outputs of the last hundred ticks or so may take to be read: more than half of it."""
BOOT_S: Final = 20.0
UNANSWERED_MAX: Final = 2000
"""Ticks that may wait for an answer; more than `ABSENCE_MAX_S` has."""
HELD_MAX: Final = 10_000
"""Inputs that wait while there is no child; more are refused."""
BOOTS_MAX: Final = 5
"""Children that may end one after the other before they have answered a tick."""


@dataclass(slots=True)
class _Sent:
    """A tick that has not been answered yet."""

    tick: int
    inputs: Sequence[Input]
    answers: list[Any] = field(default_factory=list)


class ChildLink:
    """The way to one robot in a child process. See `robot_link.RobotLink`.

    Args:
        config: of the robot.
        files: its task folder; none if None.
        is_jailed: lock the child in.
        journal: where to write the session down.
        patience_s: silence after which the child is given up, in its own processor time.
        grace_s: how long to wait for an output in its own period; infinite in a test that compares outputs.
        memory_max: bytes of address space of the child.

    Attributes:
        layers: of the jail, once the link is open; empty without one.
        restarts: children that had to be replaced.
    """

    __slots__ = (
        "_boots",
        "_called_s",
        "_changed",
        "_channels",
        "_child",
        "_codec",
        "_config",
        "_description",
        "_desk",
        "_end_reason",
        "_failure",
        "_given_up_s",
        "_grace_s",
        "_held",
        "_input_shape",
        "_is_describing",
        "_is_jailed",
        "_is_locked_in",
        "_journal",
        "_lost",
        "_memory_max",
        "_next",
        "_outputs",
        "_patience_s",
        "_reader",
        "_reading_s",
        "_replaced_because",
        "_silence",
        "_unanswered",
        "layers",
        "restarts",
    )

    def __init__(
        self,
        config: KernelConfig,
        *,
        files: Files | None = None,
        is_jailed: bool = True,
        journal: Journal | None = None,
        patience_s: float = PATIENCE_S,
        grace_s: float = GRACE_S,
        memory_max: int = MEMORY_MAX,
    ) -> None:
        self._config = config
        self._is_jailed = is_jailed
        self._journal = journal
        self._patience_s = patience_s
        self._grace_s = grace_s
        self._memory_max = memory_max
        self._codec = full_codec()
        self._input_shape = self._codec.shape(Input)
        self._reader = OutputReader(self._codec)
        self._desk = FileDesk(FilesRefused() if files is None else files)
        self._next = config.first_tick
        self._child: ChildProcess | None = None
        self._description: RobotDescription | None = None
        self._outputs = OutputBuffer()
        self._unanswered: deque[_Sent] = deque()
        self._held: list[Input] = []
        self._channels: set[int] = set()
        self._changed: asyncio.Future[None] | None = None
        self._is_locked_in = False
        self._is_describing = False
        self._end_reason = ""
        self._failure = ""
        self._given_up_s = 0.0
        self._boots = 0
        self._called_s = 0.0
        self._reading_s = 0.0
        self._replaced_because = ""
        self._lost: Sequence[Input] = ()
        self._silence = Silence(0.0, 0.0)
        self.layers: tuple[Layer, ...] = ()
        self.restarts = 0

    @property
    def description(self) -> RobotDescription:
        """What never changes about the robot; known once the link is open."""
        assert self._description is not None, "the link is not open"
        return self._description

    @property
    def pid(self) -> int:
        """Number of the child process; 0 if there is none just now."""
        return 0 if self._child is None else self._child.pid

    async def open(self) -> None:
        """Start the child and make the robot.

        Raises:
            UsageError: the configuration makes no sense, or no child can be started here.
            ElitescriptError: the child did not come up.
        """
        self._start_child()
        try:
            await self._wait_until(lambda: self._is_locked_in or bool(self._end_reason), BOOT_S)
            if self._is_locked_in:
                self._begin(self._config)
            await self._wait_until(lambda: self._description is not None or bool(self._end_reason), BOOT_S)
        finally:
            if self._description is None and self._child is not None:
                self._child.kill()
        if self._description is None:
            reason = self._failure or self._end_reason or "it does not answer"
            raise ElitescriptError(f"the robot's process did not come up: {reason}\n{self._log()}".rstrip())

    async def tick(self, inputs: Sequence[Input]) -> Output:
        """Give the robot its inputs and return what it has had to say by now.

        Raises:
            ElitescriptError: one child after the other has ended.
        """
        tick, self._next = self._next, self._next + 1
        self._hold(inputs)
        if len(self._unanswered) >= UNANSWERED_MAX:
            # Only who does not pace its calls gets here.
            room = UNANSWERED_MAX // 2
            await self._wait_until(lambda: len(self._unanswered) < room or bool(self._end_reason), self._patience_s)
        if self._child is not None and self._is_locked_in and not self._end_reason:
            if not self._is_describing:
                self._go_on(tick)
            self._send_tick(tick)
        if self._unanswered and self._outputs.is_empty:
            await self._wait_until(lambda: not self._unanswered or bool(self._end_reason), self._grace_of(tick))
        else:
            # Who calls without a pause must not keep a fresh child from being heard.
            await asyncio.sleep(0)
        if self._outputs.newest is None:
            # The first tick of all: there is no picture yet to show instead.
            await self._wait_until(lambda: self._outputs.newest is not None or bool(self._end_reason), BOOT_S)
        self._watch(tick)
        if self._outputs.newest is None:
            raise ElitescriptError(f"the robot's process did not come up: {self._failure or self._end_reason}")
        return self._outputs.take(tick)

    async def close(self) -> None:
        """End the child."""
        if self._child is not None:
            self._child.kill()
            self._child = None
        self._desk.close()
        if self._journal is not None:
            self._journal.close()

    # ---------------------------------------------------------------- down

    def _start_child(self) -> None:
        self._is_locked_in = self._is_describing = False
        self._end_reason = self._failure = ""
        self._given_up_s = self._reading_s = 0.0
        self._boots += 1
        self._reader = OutputReader(self._codec)
        try:
            self._child = ChildProcess(self._message, self._ended)
        except (OSError, ValueError, AttributeError) as error:
            raise UsageError(f"no process for the robot can be started: {error}; use --in-process") from error
        self._child.send(frames.LOCK_IN, to_text([self._is_jailed, self._memory_max]))

    def _begin(self, config: KernelConfig) -> None:
        assert self._child is not None
        self._is_describing = True
        self._child.send(frames.BEGIN, to_text(self._codec.shape(KernelConfig).encode(config)))

    def _go_on(self, tick: int) -> None:
        """Have a fresh child go on at this tick from the last picture."""
        last = self._outputs.newest
        assert last is not None
        self._begin(restored_config(self._config, self.description, last, tick))
        self._held[:0] = restored_inputs(last)
        if self._journal is not None:
            self._journal.restart(tick, self._replaced_because, last, self._lost)

    def _grace_of(self, tick: int) -> float:
        """How long to wait in this tick: one that is far behind does not catch up within a period."""
        now_s = time.monotonic()
        is_late, self._called_s = now_s - self._called_s < ON_TIME_S, now_s
        if self._grace_s >= self._patience_s:
            return self._patience_s
        is_behind = bool(self._unanswered) and tick - self._unanswered[0].tick >= BEHIND_TICKS
        return 0.0 if is_behind or is_late else self._grace_s

    def _hold(self, inputs: Sequence[Input]) -> None:
        for item in inputs:
            if isinstance(item, ChannelOpened | ChannelData | ChannelClosed):
                if item.channel not in self._channels:
                    # Of a child that is gone.
                    continue
                if isinstance(item, ChannelClosed):
                    self._channels.discard(item.channel)
            if len(self._held) >= HELD_MAX:
                text = f"an input was refused: {HELD_MAX} wait for the robot already"
                self._outputs.add_own(Warned(self._next - 1, text))
                return
            self._held.append(item)

    def _send_tick(self, tick: int) -> None:
        assert self._child is not None
        inputs, self._held = self._held, []
        if not self._unanswered:
            self._silence = self._silence_from_now()
        self._unanswered.append(_Sent(tick, inputs))
        self._child.send(frames.TICK, to_text([self._input_shape.encode(item) for item in inputs]))

    # ---------------------------------------------------------------- up

    def _message(self, letter: str, text: bytes) -> None:
        """A message of the child; what makes no sense ends it."""
        try:
            if letter in (frames.OUTPUT, frames.OUTPUT_CHANGES):
                self._take_output(letter, text)
            elif letter == frames.QUESTION:
                self._take_question(text)
            elif letter == frames.LOCKED_IN and not self._is_locked_in:
                self.layers = tuple(Layer(str(name), active is True, str(why)) for name, active, why in from_text(text))
                self._is_locked_in = True
            elif letter == frames.DESCRIBED:
                self._description = self._codec.shape(RobotDescription).decode(from_text(text))
            elif letter == frames.FAILED:
                kind, why = map(str, from_text(text))
                self._failure = why if kind == "usage" else f"a mistake of ours, please report it:\n{why}"
            else:
                raise CodecError(f"a message {letter!r} that was not asked for")
        except (CodecError, ValueError, TypeError) as error:
            self._ended(f"what it says makes no sense: {error}")
        self._wake()

    def _take_output(self, letter: str, text: bytes) -> None:
        if not self._unanswered:
            raise CodecError("an output that was not asked for")
        began_s = time.thread_time()
        output = self._reader.read(letter, text)
        self._reading_s = READING_KEPT * self._reading_s + time.thread_time() - began_s
        if self._reading_s > READING_MAX_S:
            raise CodecError("it says so much that reading it takes the time of everybody else")
        sent = self._unanswered.popleft()
        if output.tick != sent.tick:
            raise CodecError(f"the output of tick {output.tick} instead of {sent.tick}")
        self._boots = 0
        self._given_up_s = 0.0
        self._silence = self._silence_from_now()
        self._outputs.add(output)
        for request in output.requests:
            if isinstance(request, OpenChannel | OpenLine):
                self._channels.add(request.channel)
            elif isinstance(request, CloseChannel):
                self._channels.discard(request.channel)
        if self._journal is not None:
            self._journal.tick(sent.tick, sent.inputs, sent.answers, self._reader.text().encode())
            self._outputs.add_own(*self._journal.take_warning(sent.tick))

    def _take_question(self, text: bytes) -> None:
        assert self._child is not None
        answer = self._desk.answer(from_text(text))
        if self._unanswered:
            self._unanswered[0].answers.append(answer)
        self._child.send(frames.ANSWER, to_text(answer))

    def _ended(self, reason: str) -> None:
        self._end_reason = self._end_reason or reason
        self._wake()

    # ---------------------------------------------------------------- watching

    def _watch(self, tick: int) -> None:
        """Replace a child that has ended, or that does not answer."""
        if self._end_reason:
            self._replace(tick, self._failure or self._end_reason)
            return
        if not self._unanswered or self._child is None:
            return
        oldest, now_s = self._unanswered[0], time.monotonic()
        silent_s = now_s - self._silence.since_s
        patience_s = max(self._patience_s, FIRST_PATIENCE_S) if self._boots else self._patience_s
        if silent_s < patience_s or tick - oldest.tick < PATIENCE_TICKS:
            return
        worked_s, before_s = self._child.worked_s(), self._silence.worked_s
        if worked_s is not None and before_s is not None:
            has_worked_enough = worked_s - before_s >= patience_s
            if not has_worked_enough and silent_s < max(ABSENCE_MAX_S, patience_s):
                return
        if not self._given_up_s:
            self._given_up_s = now_s
            self._child.ask_where()
        elif self._child.where() is not None or now_s - self._given_up_s > TRACE_S:
            self._replace(tick, f"a call of the program did not come back for {silent_s:.2f} s")

    def _silence_from_now(self) -> Silence:
        return Silence(time.monotonic(), None if self._child is None else self._child.worked_s())

    def _replace(self, tick: int, reason: str) -> None:
        """Kill the child, report it, and start a fresh one."""
        assert self._child is not None
        where = self._child.where() if self._given_up_s else None
        self._child.kill()
        self._child = None
        self._desk.close()
        self.restarts += 1
        # The oldest of the ticks is what it died of; it has not seen the others.
        self._lost = self._unanswered[0].inputs if self._unanswered else ()
        self._report(tick, reason, where)
        self._outputs.add_own(requests=tuple(CloseChannel(channel) for channel in sorted(self._channels)))
        self._outputs.flush()
        self._channels.clear()
        later = [item for sent in list(self._unanswered)[1:] for item in sent.inputs]
        self._held[:0] = later
        del self._held[HELD_MAX:]
        self._unanswered.clear()
        if self._boots >= BOOTS_MAX:
            raise ElitescriptError(f"the robot's process ended {self._boots} times before it answered: {reason}")
        self._start_child()
        self._replaced_because = reason

    def _report(self, tick: int, reason: str, where: tuple[str, int] | None) -> None:
        hangs = bool(self._given_up_s)
        events = last_words(tick, reason, self._outputs.newest, self._lost, where=where, hangs=hangs)
        self._outputs.add_own(*events)
        if self._journal is not None:
            self._journal.told(tick, events)

    def _log(self) -> str:
        return "" if self._child is None else self._child.log

    # ---------------------------------------------------------------- waiting

    def _wake(self) -> None:
        if self._changed is not None and not self._changed.done():
            self._changed.set_result(None)

    async def _wait_until(self, is_over: Callable[[], bool], longest_s: float) -> None:
        """Return when something is so, or after a time."""
        loop = asyncio.get_running_loop()
        if longest_s <= 0.0:
            await asyncio.sleep(0)
            return
        until_s = loop.time() + longest_s
        while not is_over() and loop.time() < until_s:
            changed = self._changed = loop.create_future()
            timer = loop.call_at(until_s, self._wake)
            try:
                await changed
            finally:
                self._changed = None
                timer.cancel()
