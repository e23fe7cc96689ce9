"""A robot in a child process: no program that runs there can hold up the server.

A tick is sent to the child, and its output taken, within the period. A child that is a little late is waited for; if it
takes longer, the last snapshot stands for the robot meanwhile, and the child makes up for the ticks. At most
`UNDER_WAY_MAX` of them are sent ahead, the others are kept here: so what comes in goes into the next tick that is sent,
and no stop waits behind ticks that were sent before it. Outputs of late ticks leave together: as rows, each tick once
(`Output.rows`). While the child cannot make up for them, ticks leave late. One that does not answer, that a stop cannot
wait for (`urgent`), that ends or sends what is no message is replaced (see `supervision`); a fresh child goes on from
the last snapshot.
"""

from __future__ import annotations

import asyncio
import time
from collections import deque
from collections.abc import Awaitable, Callable, Iterator, Sequence
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
from elitescript.records import NamedTuple, replace
from elitescript.runtime.environment import Files, FilesRefused
from elitescript.said import said
from elitescript.services.child.buffers import BEHIND_TICKS, WAITING_MAX, OutputBuffer, PendingInputs, room_for
from elitescript.services.child.frames import AHEAD_TICKS, NEVER, REFRESH_TICKS
from elitescript.services.child.jail import MEMORY_MAX, Layer
from elitescript.services.child.remote_files import FileDesk
from elitescript.services.child.spare import Spares
from elitescript.services.child.supervision import (
    BOOTS_FROM_SNAPSHOT,
    BOOTS_MAX,
    FILES_MAX_S,
    HANG_LIMIT_S,
    Failure,
    Supervision,
    compile_s,
    termination_events,
)
from elitescript.services.child.transport import ChildTransport, SentTick
from elitescript.services.child.urgent import BEGIN_S, COMPILES, is_stop, longest_s, stopped
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
BEHIND_MAX: Final = 6000
"""Ticks that may wait for an answer; more than a text takes that is compiled for the longest time."""
UNDER_WAY_MAX: Final = 2
"""Ticks that the child has at a time: the one that it runs, and the next one, so that it does not wait for us."""


class KeptTick(NamedTuple):
    """A tick that is not sent yet."""

    number: int
    parts: int
    """Of its snapshot that are read, as bits."""
    asks_due: bool
    ahead: int = 0
    """How many rows of the ticks after it are asked for."""


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
        spares: keeps a child ready that may take the place of this one; each is started when it is needed if None.

    Attributes:
        layers: of the jail, once the link is open; empty without one.
    """

    __slots__ = (
        "_ahead",
        "_alarm",
        "_answered",
        "_asks_from",
        "_changed",
        "_compilers",
        "_description",
        "_desk",
        "_due",
        "_grace_left_s",
        "_grace_s",
        "_is_catching_up",
        "_is_hurried",
        "_is_jailed",
        "_is_over",
        "_journal",
        "_kept",
        "_lost",
        "_memory_max",
        "_next",
        "_on_due",
        "_options",
        "_outputs",
        "_pending",
        "_snapshot_tick",
        "_spares",
        "_supervision",
        "_transport",
        "_until_s",
        "_urgent_since_s",
        "_urgent_worked_s",
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
        spares: Spares | None = None,
    ) -> None:
        self._options = options
        self._is_jailed = is_jailed
        self._journal = journal
        self._supervision = Supervision(hang_limit_s)
        self._grace_s = grace_s
        self._grace_left_s = grace_s
        self._memory_max = memory_max
        self._compilers = CompilerDesk(options, is_jailed=is_jailed)
        self._spares = spares
        self._ahead = 0
        """How many rows were asked for last: the more, the longer nothing has been given to the robot."""
        self._asks_from = 0
        """Tick from which on rows are asked for again: there were none when they were asked for last."""
        self._is_hurried = False
        """Whether something urgent waits for the next tick."""
        self._urgent_since_s: float | None = None
        """When it came that is urgent and not answered yet; None without."""
        self._urgent_worked_s: float | None = None
        """Processor time of the child then; None if that is not known."""
        self._desk = FileDesk(FilesRefused() if files is None else files)
        self._next = self._due = options.first_tick
        self._answered = options.first_tick - 1
        """The last tick that a child has answered."""
        self._on_due: Callable[[], object] = lambda: None
        self._transport: ChildTransport | None = None
        self._description: RobotDescription | None = None
        self._outputs = OutputBuffer()
        self._pending = PendingInputs()
        self._kept: deque[KeptTick] = deque()
        """Ticks that follow those that are under way."""
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
        if transport is None or not transport.is_begun or transport.end_reason or self._pending.is_full:
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

    def knows(self, number: int, parts: int) -> bool:
        """See `RobotLink.knows`."""
        return self._transport is not None and self._is_known(self._transport, number, parts)

    def known(self, number: int, parts: int) -> Output | None:
        """See `RobotLink.known`: nothing is to be done for such a tick but to take its row."""
        transport = self._transport
        if transport is None or self._urgent_since_s is not None or not self._is_known(transport, number, parts):
            return None
        if not parts or (output := transport.take_row(number, parts)) is None:
            return None
        assert isinstance(output, Output)
        self._grace_left_s = min(self._grace_left_s + GRACE_PER_TICK_S, self._grace_s)
        self._next = number + 1
        self._supervision.note_answer(number - self._answered)
        self._answered = number
        self._outputs.pass_on(output)
        transport.process.watch(True)
        return output

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
        tick, is_known = self._next if number is None else number, False
        self._grace_left_s += (tick - self._next) * GRACE_PER_TICK_S
        self._next = tick + 1
        self._pending.add(inputs)
        self._is_hurried = False
        if self._urgent_since_s is None and inputs and longest_s(inputs) is not None:
            self._note_urgent()
        if self._transport is None and self._supervision.may_start(tick):
            self._start_again(tick)
        if (transport := self._transport) is not None:
            # Where every tick runs, nearly all answers have come when outputs leave: the loop need not wake for them.
            is_prompt = not transport.unanswered and tick >= self._watched_until
            is_known = self._is_known(transport, tick, parts)
            transport.process.watch(outlet is None or asks_due or is_known or not is_prompt)
            if self._behind(transport) >= LAG_MAX:
                await self._let_catch_up(transport)
            else:
                self._is_catching_up = False
            if transport.is_ready:
                if not transport.is_begun:
                    self._go_on(transport, tick)
                self._pass_code(transport)
                if is_known:
                    transport.await_row(tick, parts)
                else:
                    ahead = 0 if outlet is None or asks_due else self._rows_to_ask(transport, tick)
                    self._kept.append(KeptTick(tick, parts, asks_due, ahead))
                    self._send_kept(transport)
        if outlet is not None:
            await outlet()
            # Where the output was known, the event loop reads what comes.
            if transport is not None and not is_known:
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

    def hurry(self, inputs: Sequence[Input]) -> None:
        """See `RobotLink.hurry`."""
        if longest_s(inputs) is not None:
            self._is_hurried = True
            if self._urgent_since_s is None:
                self._note_urgent()
            self._wake()

    @property
    def busy_line(self) -> int:
        """See `RobotLink.busy_line`."""
        transport = self._transport
        return transport.line if transport is not None and transport.is_running and transport.unanswered else 0

    async def close(self) -> None:
        """End the child."""
        if self._spares is not None:
            self._spares.close()
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
        transport = None if self._spares is None else self._spares.take()
        receivers = (self._desk, self._take_output, self._take_question, self._wake, self._compilers)
        if transport is None:
            transport = ChildTransport(*receivers, is_jailed=self._is_jailed, memory_max=self._memory_max)
        else:
            transport.serve_for(*receivers)
            assert self._spares is not None
            self._spares.want(self._options)
        self._transport = transport
        self._supervision.note_start()
        return transport

    def _note_urgent(self) -> None:
        """Begin to wait for the end of the program that runs."""
        transport = self._transport
        if transport is not None and (transport.is_running or self._begins(transport)):
            self._urgent_since_s, self._urgent_worked_s = time.monotonic(), transport.process.worked_s()

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

    def _behind(self, transport: ChildTransport) -> int:
        """Return how many ticks the child has not answered yet, with those that are kept for it."""
        return len(transport.unanswered) + len(self._kept)

    def _send_kept(self, transport: ChildTransport) -> None:
        """Send ticks, as many as may be under way; all that waits for the robot goes into the first of them."""
        while self._kept and len(transport.unanswered) < UNDER_WAY_MAX and not transport.end_reason:
            self._send_tick(transport, *self._kept.popleft())

    def _send_tick(self, transport: ChildTransport, tick: int, parts: int, asks_due: bool, ahead: int) -> None:
        inputs = self._pending.portion()
        if refused := self._pending.take_refused():
            text = said(
                "{refused} inputs were refused: {waiting_max} waited for the robot already",
                refused=refused,
                waiting_max=WAITING_MAX,
            )
            self._outputs.add_own(Warned(tick, text))
        is_whole = parts == ALL_PARTS or self._needs_snapshot(transport, tick + ahead)
        if is_whole:
            self._snapshot_tick = tick
        if not transport.unanswered:
            self._supervision.watch_from_now()
        transport.send_tick(tick, inputs, parts, asks_due=asks_due, is_whole=is_whole, ahead=ahead)

    def _is_known(self, transport: ChildTransport, tick: int, parts: int) -> bool:
        """Return whether the child has given the output of a tick ahead: nothing that it does not know is in it."""
        if self._pending or self._kept or self._compilers.is_active or not self._outputs.is_settled:
            return False
        return transport.knows(tick, parts)

    def _rows_to_ask(self, transport: ChildTransport, tick: int) -> int:
        """Return how many rows to ask for with the tick that is sent now.

        They are lost when something comes in; so there are more only while nothing does. The digests of a journal cover
        every tick; a child that is late has more to do than ticks that are not there yet. Where there are none, since
        every tick is due, looking for them would cost each tick something.
        """
        if self._ahead and not self._behind(transport) and not transport.gave_rows:
            self._ahead, self._asks_from = 0, tick + AHEAD_TICKS
        if self._pending or self._compilers.is_active or self._journal is not None:
            self._ahead = 0
        elif self._behind(transport) or tick < self._asks_from or not self._supervision.answered:
            return 0
        else:
            self._ahead = min(2 * self._ahead + 1, AHEAD_TICKS)
        return self._ahead

    def _pass_code(self, transport: ChildTransport) -> None:
        """Give the robot what its compiler has made meanwhile: as much as it takes in a tick."""
        code, inputs = self._compilers.step()
        if code is not None:
            transport.send_code(code)
        self._pending.add(inputs)

    def _needs_snapshot(self, transport: ChildTransport, last: int) -> bool:
        """Return whether a tick needs a whole snapshot that nothing reads in it; the next can be had after tick `last`.

        The digests of a journal cover the snapshot of every tick; the first of a child has all that changes later ones
        refer to; while outputs leave later than in their own tick, what is due then reads the one of an earlier tick.
        """
        if self._journal is not None or not self._supervision.answered:
            return True
        if transport.unanswered or self._kept or not self._outputs.is_empty:
            return True
        return last - self._snapshot_tick >= REFRESH_TICKS

    # ---------------------------------------------------------------- up

    def _take_output(self, sent: SentTick, output: Output | TickResult, due: int) -> None:
        """Take what a tick has given."""
        transport = self._transport
        assert transport is not None
        self._supervision.note_answer(sent.number - self._answered)
        self._answered, self._due = sent.number, due
        if self._urgent_since_s is not None and not self._is_hurried and longest_s(self._waiting_inputs()) is None:
            self._urgent_since_s = None
        if transport.is_running and self._spares is not None:
            self._spares.want(self._options)
        if sent.size and self._behind(transport) >= LAG_MAX:
            # What queued up while it compiled is soon made up for; clients need not wait for that.
            self._is_catching_up = True
        self._outputs.add(output)
        self._pending.note(output.requests)
        if self._journal is not None:
            self._journal.tick(sent.number, sent.text, sent.answers, transport.output_text(), sent.cut)
            self._outputs.add_own(*self._journal.take_warning(sent.number))
        self._send_kept(transport)

    def _take_question(self, sent: SentTick | None) -> None:
        """Count a question about files as an answer, unless they take too long altogether."""
        if sent is not None and time.monotonic() - sent.asking_since_s < FILES_MAX_S:
            self._supervision.watch_from_now()

    def _wake(self) -> None:
        """Look again at what is waited for."""
        if self._transport is not None and self._transport.end_reason:
            self._on_due()
        if self._changed is not None and not self._changed.done() and (self._is_hurried or self._is_over()):
            self._changed.set_result(None)

    # ---------------------------------------------------------------- watching

    def _watch(self, tick: int) -> None:
        """Replace a child that has ended, or that does not answer."""
        if self._transport is not None:
            failure = self._supervision.failure_of(self._transport, tick) or self._stop_failure(self._transport)
            if failure is not None:
                self._replace(self._transport, tick, failure)

    def _waiting_inputs(self) -> Iterator[Input]:
        """Return what the child has not answered yet, in order."""
        if self._transport is not None:
            for sent in self._transport.unanswered:
                yield from sent.inputs
        yield from self._pending

    def _stop_failure(self, transport: ChildTransport) -> Failure | None:
        """Return why the child is to be ended for what is urgent; None if it is not."""
        if self._urgent_since_s is None or not transport.unanswered:
            return None
        begins = self._begins(transport)
        # What is compiled just now does not wait for itself.
        held = transport.unanswered[0].inputs if begins else ()
        limit_s = longest_s(item for item in self._waiting_inputs() if item not in held or is_stop(item))
        if limit_s is None or not (begins or transport.is_running):
            return None
        if begins:
            limit_s = BEGIN_S + compile_s(transport.unanswered[0].size)
        failure = self._supervision.stop_failure(transport, self._urgent_since_s, limit_s, self._urgent_worked_s)
        # Nothing of the program is on the stack while its text is compiled.
        return None if begins and failure is not None and failure.where is None else failure

    @staticmethod
    def _begins(transport: ChildTransport) -> bool:
        """Return whether a text may be compiled in the tick that is under way."""
        return bool(transport.unanswered) and any(isinstance(item, COMPILES) for item in transport.unanswered[0].inputs)

    def _replace(self, transport: ChildTransport, tick: int, failure: Failure) -> None:
        """Kill the child, report it, and start a fresh one now or later."""
        transport.process.kill()
        self._transport = None
        self._kept.clear()
        self._desk.close()
        if self._compilers.is_active:
            self._compilers.cancel()
            self._outputs.add_own(Warned(tick, LOST_TEXT))
        # The oldest of the ticks is what it died of; it has not seen the others.
        unanswered = list(transport.unanswered)
        self._lost = unanswered[0].inputs if unanswered else ()
        if failure.is_stop:
            # It was asked for: the next one need not wait.
            self._supervision.note_ended(failure.reason)
            shown = failure
        else:
            shown = failure._replace(reason=self._supervision.note_failure(tick, failure.reason))
        events = termination_events(tick, shown, self._outputs.newest, self._lost, transport.line)
        if failure.is_stop and (last := self._outputs.newest) is not None:
            waiting = [item for sent in unanswered for item in sent.inputs] + list(self._pending)
            self._outputs.stand_for(stopped(last, tick, waiting))
        self._urgent_since_s = None
        if self._journal is not None:
            self._journal.told(tick, events)
        self._outputs.add_own(*events, requests=self._pending.end_connections())
        self._outputs.flush()
        kept = [item for item in self._lost if is_stop(item)]
        self._pending.put_first([*kept, *(item for sent in unanswered[1:] for item in sent.inputs)])
        if self._supervision.may_start(tick):
            self._start_again(tick)

    def _start_again(self, tick: int) -> None:
        """Start the child that takes the place of another one.

        Raises:
            ElitescriptError: too many have ended before they have answered anything.
        """
        boots, reason = self._supervision.boots, self._supervision.reason
        if boots >= BOOTS_MAX:
            raise ElitescriptError(
                said("the robot's process ended {boots} times before it answered: {reason}", boots=boots, reason=reason)
            )
        try:
            self._start_child()
        except UsageError as error:
            self._supervision.note_no_process(tick, str(error))

    # ---------------------------------------------------------------- waiting

    async def _let_catch_up(self, transport: ChildTransport) -> None:
        """Wait for a child whose ticks last longer than a period; the cycle counts the late ticks."""
        supervision = self._supervision

        async def wait_for_room(behind_max: int, longest_s: float) -> None:
            await self._wait_until(
                lambda: self._behind(transport) < behind_max or bool(transport.end_reason), longest_s
            )

        if not self._is_catching_up and supervision.silent_s() < LAG_S and self._urgent_since_s is None:
            await wait_for_room(LAG_MAX, LAG_S)
        if self._behind(transport) >= BEHIND_MAX:
            # Only where ticks are not paced.
            await wait_for_room(BEHIND_MAX // 2, supervision.hang_limit_s)

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
        # A fresh child has its robot to make; and nothing is waited for while a stop is.
        if self._supervision.boots or self._transport is None or self._urgent_since_s is not None:
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
