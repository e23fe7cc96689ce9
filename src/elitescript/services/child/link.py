"""A robot in a child process: no program that runs there can hold up the server.

A tick is sent to the child, and its output taken, within the period. A child that is a little late is waited for; if it
takes longer, the last snapshot stands for the robot meanwhile, the ticks queue up, and the child makes up for them.
Then their outputs leave together: as rows, each tick once (`Output.rows`). While the child cannot make up for them,
ticks leave late. One that does not answer, ends or sends what is no message is replaced (see `supervision`); a fresh
child goes on from the last snapshot.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Awaitable, Callable, Sequence
from typing import Final

from elitescript.errors import ElitescriptError, UsageError
from elitescript.kernel import RobotOptions
from elitescript.kernel.restart import restored_inputs, restored_options
from elitescript.messages.events import Warned
from elitescript.messages.inputs import Input
from elitescript.messages.outputs import Output, TickResult
from elitescript.messages.snapshot import RobotDescription
from elitescript.messages.snapshot_parts import ALL_PARTS
from elitescript.messages.timing import TICKS_PER_S
from elitescript.records import replace
from elitescript.runtime.environment import Files, FilesRefused
from elitescript.services.child.buffers import BEHIND_TICKS, WAITING_MAX, OutputBuffer, PendingInputs, room_for
from elitescript.services.child.frames import NEVER, REFRESH_TICKS
from elitescript.services.child.jail import MEMORY_MAX, Layer
from elitescript.services.child.remote_files import FileDesk
from elitescript.services.child.supervision import (
    BOOTS_FROM_SNAPSHOT,
    BOOTS_MAX,
    FILES_MAX_S,
    HANG_LIMIT_S,
    Failure,
    Supervision,
    termination_events,
)
from elitescript.services.child.transport import ChildTransport, SentTick
from elitescript.services.compiler.desk import CompilerDesk
from elitescript.services.journal.writer import Journal
from elitescript.services.time.cycle import CATCH_UP_TICKS
from elitescript.services.time.prompt import PromptFuture

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
LOST_TEXT: Final = "the program that was being compiled does not begin: the controller was restarted"
BOOT_S: Final = 20.0
UNANSWERED_MAX: Final = 6000
"""Ticks that may wait for an answer; more than a text takes that is compiled for the longest time."""


class ChildLink:
    """The way to one robot in a child process. See `robot_link.RobotLink`.

    Args:
        options: of the robot.
        files: its task folder; none if None.
        is_jailed: lock the child in.
        journal: where to write the session down.
        hang_limit_s: processor time of the child without an answer after which it is replaced.
        grace_s: how long late outputs are waited for; infinite in a test that compares outputs.
        memory_max: bytes of address space of the child.

    Attributes:
        layers: of the jail, once the link is open; empty without one.
    """

    __slots__ = (
        "_alarm",
        "_answered",
        "_changed",
        "_compilers",
        "_description",
        "_desk",
        "_due",
        "_grace_left_s",
        "_grace_s",
        "_is_catching_up",
        "_is_jailed",
        "_is_over",
        "_journal",
        "_lost",
        "_memory_max",
        "_next",
        "_on_due",
        "_options",
        "_outputs",
        "_pending",
        "_snapshot_tick",
        "_supervision",
        "_transport",
        "_until_s",
        "_watched_until",
        "layers",
    )

    def __init__(
        self,
        options: RobotOptions,
        *,
        files: Files | None = None,
        is_jailed: bool = True,
        journal: Journal | None = None,
        hang_limit_s: float = HANG_LIMIT_S,
        grace_s: float = GRACE_S,
        memory_max: int = MEMORY_MAX,
    ) -> None:
        self._options = options
        self._is_jailed = is_jailed
        self._journal = journal
        self._supervision = Supervision(hang_limit_s)
        self._grace_s = grace_s
        self._grace_left_s = grace_s
        self._memory_max = memory_max
        self._compilers = CompilerDesk(options, is_jailed=is_jailed)
        self._desk = FileDesk(FilesRefused() if files is None else files)
        self._next = self._due = options.first_tick
        self._answered = options.first_tick - 1
        """The last tick that a child has answered."""
        self._on_due: Callable[[], object] = lambda: None
        self._transport: ChildTransport | None = None
        self._description: RobotDescription | None = None
        self._outputs = OutputBuffer()
        self._pending = PendingInputs()
        self._changed: PromptFuture | None = None
        """What is waited for now."""
        self._is_over: Callable[[], bool] = lambda: True
        """Whether it has come."""
        self._until_s = 0.0
        self._watched_until = 0
        """Up to this tick the event loop looks for each answer: some came later than outputs leave."""
        self._alarm: asyncio.TimerHandle | None = None
        self._is_catching_up = False
        self._lost: Sequence[Input] = ()
        """Inputs of the tick that the last child has failed in."""
        self._snapshot_tick = 0
        """The last whose snapshot was asked for."""
        self.layers: tuple[Layer, ...] = ()

    @property
    def description(self) -> RobotDescription:
        """What never changes about the robot."""
        assert self._description is not None, "the link is not open"
        return self._description

    @property
    def room(self) -> float | None:
        """Share of a tick's work for clients that the child can do: less, the more it is behind; None without one."""
        transport = self._transport
        if transport is None or not transport.is_begun or transport.end_reason or len(self._pending):
            return None
        return room_for(self._next - transport.unanswered[0].number if transport.unanswered else 0)

    @property
    def pid(self) -> int:
        """Number of the child process; 0 if there is none just now."""
        return 0 if self._transport is None else self._transport.process.pid

    @property
    def restarts(self) -> int:
        """Children that had to be replaced."""
        return self._supervision.restarts

    async def open(self) -> None:
        """Start the child and make the robot.

        Raises:
            UsageError: the configuration makes no sense, or no child can be started here.
            ElitescriptError: the child did not come up.
        """
        transport = self._start_child()
        try:
            await self._wait_until(lambda: transport.layers is not None or bool(transport.end_reason), BOOT_S)
            self.layers = transport.layers or ()
            if transport.layers is not None:
                transport.begin(self._options)
            await self._wait_until(lambda: transport.description is not None or bool(transport.end_reason), BOOT_S)
        finally:
            self._description = transport.description
            if self._description is None:
                transport.process.kill()
        if self._description is None:
            await transport.process.gone()
            reason = transport.failure or transport.end_reason or "it does not answer"
            raise ElitescriptError(f"the robot's process did not come up: {reason}\n{transport.process.log}".rstrip())

    @property
    def due_tick(self) -> int | None:
        """See `RobotLink.due_tick`.

        Every tick is due while the child owes an answer or is not there, while something waits for it or for its
        clients, and with a journal, whose digests cover every tick.
        """
        transport = self._transport
        if transport is None or not transport.is_begun or transport.end_reason or transport.unanswered:
            return self._next
        if self._journal is not None or self._compilers.is_active or len(self._pending) or not self._outputs.is_settled:
            return self._next
        return None if self._due == NEVER else max(self._due, self._next)

    def watch(self, on_due: Callable[[], object]) -> None:
        """See `RobotLink.watch`: a child may end at any time."""
        self._on_due = on_due

    async def tick(
        self,
        inputs: Sequence[Input],
        parts: int = ALL_PARTS,
        number: int | None = None,
        *,
        asks_due: bool = True,
        outlet: Callable[[], Awaitable[None]] | None = None,
    ) -> Output:
        """Give the robot its inputs and return what it has given by now; see `RobotLink.tick`.

        Raises:
            ElitescriptError: one child after the other has ended.
        """
        tick = self._next if number is None else number
        self._grace_left_s += (tick - self._next) * GRACE_PER_TICK_S
        self._next = tick + 1
        self._pending.add(inputs)
        if self._transport is None and self._supervision.may_start(tick):
            self._start_again(tick)
        if (transport := self._transport) is not None:
            # Where every tick runs, nearly all answers have come when outputs leave: the loop need not wake for them.
            is_prompt = not transport.unanswered and tick >= self._watched_until
            transport.process.watch(outlet is None or asks_due or not is_prompt)
            if len(transport.unanswered) >= LAG_MAX:
                await self._let_catch_up(transport)
            else:
                self._is_catching_up = False
            if transport.is_ready:
                if not transport.is_begun:
                    self._go_on(transport, tick)
                self._pass_code(transport)
                self._send_tick(transport, tick, parts, asks_due=asks_due)
        if outlet is not None:
            await outlet()
            if transport is not None:
                transport.process.read()
                if transport.unanswered:
                    self._watched_until = tick + TICKS_PER_S
                    transport.process.watch(True)
        await self._wait_for_output(tick, had_turn=outlet is not None)
        self._watch(tick)
        if self._outputs.newest is None:
            why = "" if transport is None else transport.failure or transport.end_reason
            raise ElitescriptError(f"the robot's process did not come up: {why}")
        return self._outputs.take(tick)

    async def close(self) -> None:
        """End the child."""
        if self._transport is not None:
            process, self._transport = self._transport.process, None
            process.kill()
            await process.gone()
        await self._compilers.close()
        if self._alarm is not None:
            self._alarm.cancel()
        self._desk.close()
        if self._journal is not None:
            self._journal.close()

    # ---------------------------------------------------------------- down

    def _start_child(self) -> ChildTransport:
        self._transport = transport = ChildTransport(
            self._desk,
            self._take_output,
            self._take_question,
            self._wake,
            self._compilers,
            is_jailed=self._is_jailed,
            memory_max=self._memory_max,
        )
        self._supervision.note_start()
        return transport

    def _go_on(self, transport: ChildTransport, tick: int) -> None:
        """Have a fresh child go on at this tick from the last snapshot; as at first, if others could not."""
        last = self._outputs.newest
        assert last is not None
        self._answered = tick - 1
        if self._supervision.boots >= BOOTS_FROM_SNAPSHOT:
            transport.begin(replace(self._options, first_tick=tick))
            return
        transport.begin(restored_options(self._options, self.description, last, tick))
        self._pending.put_first(restored_inputs(last))
        if self._journal is not None:
            self._journal.restart(tick, self._supervision.reason, last, self._lost)

    def _send_tick(self, transport: ChildTransport, tick: int, parts: int, *, asks_due: bool) -> None:
        inputs = self._pending.portion()
        if refused := self._pending.take_refused():
            text = f"{refused} inputs were refused: {WAITING_MAX} waited for the robot already"
            self._outputs.add_own(Warned(tick, text))
        if self._needs_snapshot(transport, tick):
            parts = ALL_PARTS
        if parts == ALL_PARTS:
            self._snapshot_tick = tick
        if not transport.unanswered:
            self._supervision.watch_from_now()
        transport.send_tick(tick, inputs, parts, asks_due=asks_due)

    def _pass_code(self, transport: ChildTransport) -> None:
        """Give the robot what its compiler has made meanwhile: as much as it takes in a tick."""
        code, inputs = self._compilers.step()
        if code is not None:
            transport.send_code(code)
        self._pending.add(inputs)

    def _needs_snapshot(self, transport: ChildTransport, tick: int) -> bool:
        """Return whether a tick needs a whole snapshot that nothing reads in it.

        The digests of a journal cover the snapshot of every tick; the first of a child has all that changes later ones
        refer to; while outputs leave later than in their own tick, what is due then reads the one of an earlier tick.
        """
        if self._journal is not None or not self._supervision.answered:
            return True
        if transport.unanswered or not self._outputs.is_empty:
            return True
        return tick - self._snapshot_tick >= REFRESH_TICKS

    # ---------------------------------------------------------------- up

    def _take_output(self, sent: SentTick, output: Output | TickResult, due: int) -> None:
        """Take what a tick has given."""
        transport = self._transport
        assert transport is not None
        self._supervision.note_answer(sent.number - self._answered)
        self._answered, self._due = sent.number, due
        if sent.size and len(transport.unanswered) >= LAG_MAX:
            # What queued up while it compiled is soon made up for; clients need not wait for that.
            self._is_catching_up = True
        self._outputs.add(output)
        self._pending.note(output.requests)
        if self._journal is not None:
            self._journal.tick(sent.number, sent.text, sent.answers, transport.output_text())
            self._outputs.add_own(*self._journal.take_warning(sent.number))

    def _take_question(self, sent: SentTick | None) -> None:
        """Count a question about files as an answer, unless they take too long altogether."""
        if sent is not None and time.monotonic() - sent.asking_since_s < FILES_MAX_S:
            self._supervision.watch_from_now()

    def _wake(self) -> None:
        """Look again at what is waited for."""
        if self._transport is not None and self._transport.end_reason:
            self._on_due()
        if self._changed is not None and not self._changed.done() and self._is_over():
            self._changed.set_result(None)

    # ---------------------------------------------------------------- watching

    def _watch(self, tick: int) -> None:
        """Replace a child that has ended, or that does not answer."""
        if self._transport is not None:
            failure = self._supervision.failure_of(self._transport, tick)
            if failure is not None:
                self._replace(self._transport, tick, failure)

    def _replace(self, transport: ChildTransport, tick: int, failure: Failure) -> None:
        """Kill the child, report it, and start a fresh one now or later."""
        transport.process.kill()
        self._transport = None
        self._desk.close()
        if self._compilers.is_active:
            self._compilers.cancel()
            self._outputs.add_own(Warned(tick, LOST_TEXT))
        # The oldest of the ticks is what it died of; it has not seen the others.
        unanswered = list(transport.unanswered)
        self._lost = unanswered[0].inputs if unanswered else ()
        shown = failure._replace(reason=self._supervision.note_failure(tick, failure.reason))
        events = termination_events(tick, shown, self._outputs.newest, self._lost, transport.line)
        if self._journal is not None:
            self._journal.told(tick, events)
        self._outputs.add_own(*events, requests=self._pending.end_connections())
        self._outputs.flush()
        self._pending.put_first(item for sent in unanswered[1:] for item in sent.inputs)
        if self._supervision.may_start(tick):
            self._start_again(tick)

    def _start_again(self, tick: int) -> None:
        """Start the child that takes the place of another one.

        Raises:
            ElitescriptError: too many have ended before they have answered anything.
        """
        boots, reason = self._supervision.boots, self._supervision.reason
        if boots >= BOOTS_MAX:
            raise ElitescriptError(f"the robot's process ended {boots} times before it answered: {reason}")
        try:
            self._start_child()
        except UsageError as error:
            self._supervision.note_no_process(tick, str(error))

    # ---------------------------------------------------------------- waiting

    async def _let_catch_up(self, transport: ChildTransport) -> None:
        """Wait for a child whose ticks last longer than a period; the cycle counts the late ticks."""
        unanswered, supervision = transport.unanswered, self._supervision
        if not self._is_catching_up and supervision.silent_s() < LAG_S:
            await self._wait_until(lambda: len(unanswered) < LAG_MAX or bool(transport.end_reason), LAG_S)
        if len(unanswered) >= UNANSWERED_MAX:
            # Only where ticks are not paced.
            room = UNANSWERED_MAX // 2
            longest_s = supervision.hang_limit_s
            await self._wait_until(lambda: len(unanswered) < room or bool(transport.end_reason), longest_s)

    async def _wait_for_output(self, tick: int, *, had_turn: bool) -> None:
        """Wait for the output of a tick, for as long as it may be late.

        Args:
            tick: its number.
            had_turn: whether the event loop has a turn before each tick anyhow.
        """
        grace_s, transport = self._grace_of(tick), self._transport
        if self._outputs.is_empty:
            self._outputs.note_lack()
        if transport is not None and transport.unanswered and self._outputs.is_empty:
            began_s = time.monotonic()
            await self._wait_until(lambda: not transport.unanswered or bool(transport.end_reason), grace_s)
            self._grace_left_s -= time.monotonic() - began_s
        elif not had_turn:
            # The event loop reads a fresh child even if ticks come without a pause.
            await asyncio.sleep(0)
        if self._outputs.newest is None and transport is not None:
            # The first tick of all: there is no snapshot yet to show instead.
            await self._wait_until(lambda: self._outputs.newest is not None or bool(transport.end_reason), BOOT_S)

    def _grace_of(self, tick: int) -> float:
        """Return how long to wait in this tick: one that is far behind does not catch up within a period."""
        self._grace_left_s = min(max(self._grace_left_s, 0.0) + GRACE_PER_TICK_S, self._grace_s)
        if self._grace_s >= self._supervision.hang_limit_s:
            return self._supervision.hang_limit_s
        # A fresh child has its robot to make.
        if self._supervision.boots or self._transport is None:
            return 0.0
        oldest = self._transport.unanswered[0] if self._transport.unanswered else None
        is_behind = oldest is not None and (tick - oldest.number >= BEHIND_TICKS or oldest.size >= LONG_TEXT)
        return 0.0 if is_behind else self._grace_left_s

    async def _wait_until(self, is_over: Callable[[], bool], longest_s: float) -> None:
        """Return when a condition holds, or after a time."""
        if longest_s <= 0.0:
            await asyncio.sleep(0)
            return
        if is_over():
            return
        self._until_s = time.monotonic() + longest_s
        self._is_over = is_over
        changed = self._changed = PromptFuture()
        self._set_alarm()
        try:
            await changed
        finally:
            self._changed = None

    def _set_alarm(self) -> None:
        """Have what is waited for given up in time.

        A timer that is set already is left alone, and set anew when it rings too early: nearly all answers come before.
        """
        if self._alarm is not None:
            if self._alarm.when() <= self._until_s:
                return
            self._alarm.cancel()
        self._alarm = asyncio.get_running_loop().call_at(self._until_s, self._ring)

    def _ring(self) -> None:
        self._alarm = None
        if self._changed is None or self._changed.done():
            return
        if time.monotonic() < self._until_s:
            self._set_alarm()
        else:
            self._changed.set_result(None)
