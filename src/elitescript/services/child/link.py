"""The way to a robot in a child process: no program that runs there can hold up whoever serves it.

A tick is sent to the child, and its output taken, within the period. A child that is a little late is waited for, so
that nothing is missing; if it takes longer, clients see the last picture meanwhile, the ticks queue up, and the child
makes up for them; while it cannot, ticks leave late. One that is silent for too long (`patience`), ends or talks
nonsense is killed and reported; a fresh child goes on from the last picture, soon or later.
"""

from __future__ import annotations

import asyncio
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Final

from elitescript.codec.json_text import from_text, to_text
from elitescript.codec.messages import shape_of
from elitescript.codec.values import CodecError
from elitescript.errors import ElitescriptError, UsageError
from elitescript.kernel import KernelConfig
from elitescript.kernel.restart import restored_config, restored_inputs
from elitescript.messages.events import Warned
from elitescript.messages.inputs import Input, Interpret, LoadTask, PlayTask, Query, RunUnit
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot import RobotDescription
from elitescript.messages.timing import TICKS_PER_S, seconds
from elitescript.runtime.environment import Files, FilesRefused
from elitescript.services.child import frames, output_changes
from elitescript.services.child.hang_watchdog import FILES_MAX_S, PATIENCE_S, HangWatchdog, compile_s
from elitescript.services.child.jail import MEMORY_MAX, Layer
from elitescript.services.child.output_buffer import OutputBuffer
from elitescript.services.child.output_changes import OutputReader
from elitescript.services.child.pending_inputs import BEHIND_TICKS, HELD_MAX, PendingInputs, room_for
from elitescript.services.child.process import ChildProcess
from elitescript.services.child.remote_files import FileDesk
from elitescript.services.child.termination_events import COMPILE_HINT, FILES_HINT, HINT, last_words
from elitescript.services.journal.writer import Journal
from elitescript.services.time.cycle import CATCH_UP_TICKS

GRACE_S: Final = 0.1
"""How long outputs that are late are waited for, if the others were in time: ticks leave late then, but all of them."""
GRACE_PER_TICK_S: Final = 0.0025
"""How much of it every tick gives back; timers of an event loop may add 1 ms."""
LONG_TEXT: Final = 20_000
"""Bytes of program text that take several ticks to compile: nothing is waited for then."""
LAG_MAX: Final = CATCH_UP_TICKS
"""Ticks behind which time waits for a child that goes on answering: what is asked for is done half a second later."""
LAG_S: Final = 0.1
"""How long it waits in each tick, and how long the child may have been silent before."""
TRACE_S: Final = 0.05
"""How long a child that is given up may take to say where it is."""
READING_MAX_S: Final = 0.25
READING_KEPT: Final = 0.99
"""Time that the outputs of the last hundred ticks or so may take to be read: more than half of it."""
BOOT_S: Final = 20.0
UNANSWERED_MAX: Final = 6000
"""Ticks that may wait for an answer; more than `COMPILE_MAX_S` has."""
BOOTS_FROM_PICTURE: Final = 3
"""From so many of them on, one begins as the first did: perhaps nobody can go on from the last picture."""
FAILURE_MAX: Final = 8000
"""Characters of the reason that a child gives for its end."""
BOOTS_MAX: Final = 5
"""Children that may end one after the other before they have answered a tick."""
CALM_TICKS: Final = 10 * TICKS_PER_S
"""After so many answered ticks it is forgotten that a child had to be replaced."""
PAUSES_TICKS: Final = (0, 0, 0, 62, 125, 250, 500, 1000, 2000)
"""How long nobody starts the next child, by the number of children before it that lived no longer than that."""


@dataclass(slots=True)
class _Sent:
    """A tick that has not been answered yet."""

    tick: int
    inputs: Sequence[Input]
    text: str
    """The inputs as JSON text."""
    answers: list[Any] = field(default_factory=list)
    size: int = 0
    """Bytes of program text that came with it, or were read in it to load a task."""
    asking_since_s: float = 0.0
    """When the first question about files came in it."""


class ChildLink:
    """The way to one robot in a child process. See `robot_link.RobotLink`.

    Args:
        config: of the robot.
        files: its task folder; none if None.
        is_jailed: lock the child in.
        journal: where to write the session down.
        patience_s: silence after which the child is given up, in its own processor time.
        grace_s: how long late outputs are waited for; infinite in a test that compares outputs.
        memory_max: bytes of address space of the child.

    Attributes:
        layers: of the jail, once the link is open; empty without one.
        restarts: children that had to be replaced.
    """

    __slots__ = (
        "_answered",
        "_boots",
        "_changed",
        "_child",
        "_config",
        "_crashes",
        "_description",
        "_desk",
        "_end_reason",
        "_failure",
        "_given_up_s",
        "_grace_left_s",
        "_grace_s",
        "_held",
        "_input_shape",
        "_is_catching_up",
        "_is_described",
        "_is_describing",
        "_is_jailed",
        "_is_locked_in",
        "_journal",
        "_lost",
        "_memory_max",
        "_next",
        "_outputs",
        "_patience",
        "_reader",
        "_reading_s",
        "_replaced_because",
        "_restart_at",
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
        self._patience = HangWatchdog(patience_s)
        self._grace_s = grace_s
        self._grace_left_s = grace_s
        self._memory_max = memory_max
        self._input_shape = shape_of(Input)
        self._reader = OutputReader()
        self._desk = FileDesk(FilesRefused() if files is None else files)
        self._next = config.first_tick
        self._child: ChildProcess | None = None
        self._description: RobotDescription | None = None
        self._outputs = OutputBuffer()
        self._unanswered: deque[_Sent] = deque()
        self._held = PendingInputs()
        self._changed: asyncio.Future[None] | None = None
        self._is_locked_in = False
        self._is_describing = self._is_described = False
        self._is_catching_up = False
        self._end_reason = ""
        self._failure = ""
        self._given_up_s = 0.0
        self._answered = self._boots = self._crashes = self._restart_at = 0
        self._reading_s = 0.0
        self._replaced_because = ""
        self._lost: Sequence[Input] = ()
        self.layers: tuple[Layer, ...] = ()
        self.restarts = 0

    @property
    def description(self) -> RobotDescription:
        """What never changes about the robot."""
        assert self._description is not None, "the link is not open"
        return self._description

    @property
    def room(self) -> float | None:
        """Share of a tick's work for clients that the child can do: less, the more it is behind; None without one."""
        if self._child is None or not self._is_describing or self._end_reason or len(self._held):
            return None
        return room_for(self._next - self._unanswered[0].tick if self._unanswered else 0)

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
            log = "" if self._child is None else self._child.log
            raise ElitescriptError(f"the robot's process did not come up: {reason}\n{log}".rstrip())

    async def tick(self, inputs: Sequence[Input]) -> Output:
        """Give the robot its inputs and return what it has had to say by now.

        Raises:
            ElitescriptError: one child after the other has ended.
        """
        tick, self._next = self._next, self._next + 1
        self._held.add(inputs)
        if self._child is None and tick >= self._restart_at:
            self._start_again(tick)
        self._is_catching_up = self._is_catching_up and len(self._unanswered) >= LAG_MAX
        if len(self._unanswered) >= LAG_MAX and not self._is_catching_up and self._patience.silent_s() < LAG_S:
            # Its ticks last longer than a period; whoever keeps time finds itself late, and counts it.
            await self._wait_until(lambda: len(self._unanswered) < LAG_MAX or bool(self._end_reason), LAG_S)
        if len(self._unanswered) >= UNANSWERED_MAX:
            # Only who does not pace its calls gets here.
            room = UNANSWERED_MAX // 2
            await self._wait_until(
                lambda: len(self._unanswered) < room or bool(self._end_reason), self._patience.patience_s
            )
        if self._child is not None and self._is_locked_in and not self._end_reason:
            if not self._is_describing:
                self._go_on(tick)
            self._send_tick(tick)
        grace_s = self._grace_of(tick)
        if self._unanswered and self._outputs.is_empty:
            began_s = time.monotonic()
            await self._wait_until(lambda: not self._unanswered or bool(self._end_reason), grace_s)
            self._grace_left_s -= time.monotonic() - began_s
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
            child, self._child = self._child, None
            child.kill()
            await child.gone()
        self._desk.close()
        if self._journal is not None:
            self._journal.close()

    # ---------------------------------------------------------------- down

    def _start_child(self) -> None:
        self._is_locked_in = self._is_describing = self._is_described = False
        self._end_reason = self._failure = ""
        self._given_up_s = self._reading_s = 0.0
        self._boots += 1
        self._answered = 0
        self._reader = OutputReader()
        try:
            self._child = ChildProcess(self._message, self._ended)
        except (OSError, ValueError, AttributeError) as error:
            raise UsageError(f"no process for the robot can be started: {error}; use --in-process") from error
        self._child.send(frames.LOCK_IN, to_text([self._is_jailed, self._memory_max]))

    def _begin(self, config: KernelConfig) -> None:
        assert self._child is not None
        self._is_describing = True
        self._child.send(frames.BEGIN, to_text(shape_of(KernelConfig).encode(config)))

    def _go_on(self, tick: int) -> None:
        """Have a fresh child go on at this tick from the last picture; as at first, if others could not."""
        last = self._outputs.newest
        assert last is not None
        if self._boots >= BOOTS_FROM_PICTURE:
            self._begin(replace(self._config, first_tick=tick))
            return
        self._begin(restored_config(self._config, self.description, last, tick))
        self._held.put_first(restored_inputs(last))
        if self._journal is not None:
            self._journal.restart(tick, self._replaced_because, last, self._lost)

    def _grace_of(self, tick: int) -> float:
        """How long to wait in this tick: one that is far behind does not catch up within a period."""
        self._grace_left_s = min(max(self._grace_left_s, 0.0) + GRACE_PER_TICK_S, self._grace_s)
        if self._grace_s >= self._patience.patience_s:
            return self._patience.patience_s
        # A fresh child has its robot to make.
        if self._boots:
            return 0.0
        oldest = self._unanswered[0] if self._unanswered else None
        is_behind = oldest is not None and (tick - oldest.tick >= BEHIND_TICKS or oldest.size >= LONG_TEXT)
        return 0.0 if is_behind else self._grace_left_s

    def _send_tick(self, tick: int) -> None:
        assert self._child is not None
        inputs = self._held.portion()
        if refused := self._held.take_refused():
            text = f"{refused} inputs were refused: {HELD_MAX} waited for the robot already"
            self._outputs.add_own(Warned(tick, text))
        if not self._unanswered:
            self._patience.begin(self._child.worked_s())
        text = to_text([self._input_shape.encode(item) for item in inputs])
        size = sum(len(item.text) for item in inputs if isinstance(item, RunUnit | Interpret | Query))
        self._unanswered.append(_Sent(tick, inputs, text, size=size))
        self._child.send(frames.TICK, text)

    # ---------------------------------------------------------------- up

    def _message(self, letter: str, text: bytes) -> None:
        """A message of the child; what makes no sense ends it, and nothing more of it is read."""
        if self._end_reason:
            return
        try:
            if letter in (frames.OUTPUT, frames.OUTPUT_CHANGES):
                self._take_output(letter, text)
            elif letter == frames.QUESTION:
                self._take_question(text)
            elif letter == frames.LOCKED_IN and not self._is_locked_in:
                output_changes.check_values(text)
                self.layers = tuple(Layer(str(name), active is True, str(why)) for name, active, why in from_text(text))
                self._is_locked_in = True
            elif letter == frames.DESCRIBED and self._is_describing and not self._is_described:
                self._is_described = True
                output_changes.check_values(text)
                self._description = shape_of(RobotDescription).decode(from_text(text))
            elif letter == frames.FAILED:
                output_changes.check_values(text)
                kind, why = (str(part)[:FAILURE_MAX] for part in from_text(text))
                self._failure = why if kind == "usage" else f"a mistake of ours, please report it:\n{why}"
                self._ended("it has ended")
            else:
                raise CodecError(f"a message {letter!r} that was not asked for")
        except CodecError as error:
            self._ended(f"what it says makes no sense: {error}")
        except Exception as error:
            # No message of a child may end this process, whatever we have not thought of.
            self._ended(f"what it says makes no sense: {type(error).__name__}: {error}")
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
        self._answered += 1
        self._crashes = 0 if self._answered >= CALM_TICKS else self._crashes
        self._given_up_s = 0.0
        self._patience.begin(None if self._child is None else self._child.worked_s())
        if sent.size and len(self._unanswered) >= LAG_MAX:
            # What queued up while it compiled is soon made up for; clients need not wait for that.
            self._is_catching_up = True
        self._outputs.add(output)
        self._held.note(output.requests)
        if self._journal is not None:
            self._journal.tick(sent.tick, sent.text, sent.answers, self._reader.text().encode())
            self._outputs.add_own(*self._journal.take_warning(sent.tick))

    def _take_question(self, text: bytes) -> None:
        assert self._child is not None
        answer = self._desk.answer(from_text(text))
        answer_text = to_text(answer)
        if self._unanswered:
            sent = self._unanswered[0]
            sent.answers.append(answer)
            if any(isinstance(item, LoadTask | PlayTask) for item in sent.inputs):
                sent.size += len(answer_text)
            now_s = time.monotonic()
            sent.asking_since_s = sent.asking_since_s or now_s
            if now_s - sent.asking_since_s < FILES_MAX_S:
                self._patience.begin(self._child.worked_s())
        self._child.send(frames.ANSWER, answer_text)

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
        sent = self._unanswered[0]
        more_s = compile_s(sent.size)
        if not self._patience.is_over(
            tick - sent.tick, self._child.worked_s, is_fresh=bool(self._boots), more_s=more_s
        ):
            return
        if not self._given_up_s:
            self._given_up_s = time.monotonic()
            self._child.ask_where()
        elif self._child.where() is not None or time.monotonic() - self._given_up_s > TRACE_S:
            self._replace(tick, *self._why_silent(sent))

    def _why_silent(self, sent: _Sent) -> tuple[str, str]:
        """Why a child is given up that does not answer, and what to do about it."""
        assert self._child is not None
        silent_s = self._patience.silent_s()
        if self._child.is_compiling and self._child.where() is None:
            return f"a program text of {sent.size} bytes was not compiled within {silent_s:.1f} s", COMPILE_HINT
        if sent.asking_since_s and time.monotonic() - sent.asking_since_s >= FILES_MAX_S:
            return f"the program has worked with files for more than {FILES_MAX_S:g} s in one tick", FILES_HINT
        return f"a call of the program did not come back for {silent_s:.2f} s", HINT

    def _replace(self, tick: int, reason: str, hint: str = "") -> None:
        """Kill the child, report it, and start a fresh one."""
        assert self._child is not None
        where = self._child.where()
        self._child.kill()
        self._child = None
        self._desk.close()
        self.restarts += 1
        self._crashes += 1
        pause = PAUSES_TICKS[min(self._crashes, len(PAUSES_TICKS) - 1)]
        # The oldest of the ticks is what it died of; it has not seen the others.
        self._lost = self._unanswered[0].inputs if self._unanswered else ()
        self._report(tick, reason, where, pause, hint)
        self._outputs.add_own(requests=self._held.end_connections())
        self._outputs.flush()
        self._held.put_first(item for sent in list(self._unanswered)[1:] for item in sent.inputs)
        self._unanswered.clear()
        self._replaced_because, self._end_reason = reason, ""
        self._restart_at = tick + pause
        if not pause:
            self._start_again(tick)

    def _start_again(self, tick: int) -> None:
        """Start the child that takes the place of another one.

        Raises:
            ElitescriptError: too many have ended before they have answered anything.
        """
        if self._boots >= BOOTS_MAX:
            text = f"the robot's process ended {self._boots} times before it answered: {self._replaced_because}"
            raise ElitescriptError(text)
        try:
            self._start_child()
        except UsageError as error:
            # No room for a process just now; there may be some later.
            self._crashes += 1
            self._replaced_because = str(error)
            self._restart_at = tick + PAUSES_TICKS[-1]

    def _report(self, tick: int, reason: str, where: tuple[str, int] | None, pause: int, hint: str) -> None:
        if pause:
            reason += f"; after {self._crashes} times in a row it starts {seconds(pause):g} s later"
        events = last_words(tick, reason, self._outputs.newest, self._lost, where=where, hint=hint)
        self._outputs.add_own(*events)
        if self._journal is not None:
            self._journal.told(tick, events)

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
