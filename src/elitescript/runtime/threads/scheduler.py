"""Schedules script threads in virtual time, in an order that is the same in every run.

In each tick the threads that are due run in the order of their start, each until it waits or has used up its work for
this tick. Threads that others wake in the same tick run after those, in the order in which they were woken. Work is
counted in checkpoints (loop passes, calls), never in time, so an endless loop takes one tick for every `work_per_tick`
checkpoints and blocks nothing. The speed of the real controller is not known: the number is *assumed*. Where a wall
clock rules, a meter may end the program phase of a tick before that, for all threads at once; see `meter`.

Compiled scripts evaluate `tick() or checkpoint()`, where `tick` pops from the list `fuel`. The list holds True for
every checkpoint that is passed at once, above False values that lead to `checkpoint`. It is filled in portions; work is
counted exactly, so the size of a portion has no effect on results. Short loops take what they need at once (`pay`).
"""

from __future__ import annotations

import sys
from collections import deque
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, Final

from elitescript.messages.timing import WORK_PER_TICK
from elitescript.runtime.threads.strand import ENDED, READY, WAITING, LineTables, Stopped, Strand
from elitescript.runtime.threads.timers import Timers
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.runtime.threads.meter import Meter
    from elitescript.runtime.threads.said import SaidText

WORK_PER_ACTIVATION: Final = 20
"""Cost of a wake-up in checkpoints, so that threads which only wake each other use up the tick too."""

WORK_PER_EVENT: Final = 20
"""Cost of an event in checkpoints (*assumed*), which limits the events of a loop in one tick."""

WORK_PER_REFUSAL: Final = 20
"""Cost of a call that a command refuses in checkpoints (*assumed*)."""

WORK_PER_REFUSED_MOVE: Final = 200
"""The same of a move, which is planned first (*assumed*): a loop that swallows refusals makes ten in a tick, as long as
a tick takes. Elsewhere a clock would have to end it."""

FLOOR: Final = 1000
"""False values below the fuel. In the last calls before the recursion limit `checkpoint` cannot be called, and each try
takes one away."""

STARTS_PER_TICK: Final = 1000
"""Most threads that begin in the tick in which they are started, so that a chain of starts does not stop time."""

PORTION: Final = 500
"""Checkpoints that are paid out at a time."""

DEBUGGER: Final = "the debugger"
"""What a thread waits for that is held before a statement."""

PORTION_MAX: Final = 64
"""Most checkpoints between two looks at a meter."""

_ORPHAN_WORK: Final = 1000
"""Checkpoints for script code that no thread runs: `finally` blocks of generators that are collected."""


_FLOOR: Final = (False,) * FLOOR


class Scheduler:
    """Runs strands.

    Args:
        work_per_tick: checkpoints that a thread may pass in one tick.
        portion: checkpoints paid out at a time; affects speed only.
        meter: ends ticks; see there. None where work alone counts.

    Attributes:
        now: the tick that runs, or ran last.
        current: the strand that runs.
        fuel: see the module.
        is_ending: whether the running strand was stopped.
        needs_attention: keeps `run_ready` from going on; set by `call_attention`.
        is_paused: whether only secondary programs run.
        lag_ticks: delay of robot time behind the wall clock, see `Deadline`.
        said: what programs have said and clients have not got yet; None before the first text.
        timers: timeouts of waits.
        watchers: called with the running strand and the number of its next statement; see `watch`.
        passes: numbers of statements at which no watcher is called, as keys.
    """

    __slots__ = (
        "_is_in_tick",
        "_is_interrupted",
        "_is_pausing",
        "_is_resuming",
        "_loaded",
        "_next",
        "_on_abandoned",
        "_on_end",
        "_on_late",
        "_orphan_work",
        "_portion",
        "_ready",
        "_started",
        "_starts_max",
        "_tables",
        "_unpaid",
        "_work_per_tick",
        "current",
        "fuel",
        "is_ending",
        "is_paused",
        "lag_ticks",
        "meter",
        "needs_attention",
        "now",
        "passes",
        "said",
        "strands",
        "timers",
        "watchers",
    )

    def __init__(
        self,
        *,
        work_per_tick: int = WORK_PER_TICK,
        portion: int = PORTION,
        meter: Meter | None = None,
        on_end: Callable[[Strand], None] = lambda strand: None,
        on_abandoned: Callable[[Strand], None] = lambda strand: None,
        on_late: Callable[[Strand, int], None] = lambda strand, late_ms: None,
    ) -> None:
        self.now = 0
        self.current: Strand | None = None
        self.strands: list[Strand] = []
        self.fuel: list[bool] = list(_FLOOR)
        self.is_ending = False
        self.needs_attention = False
        self.is_paused = False
        self.lag_ticks = 0
        self.meter = meter
        self._tables = LineTables()
        self._work_per_tick = max(work_per_tick, WORK_PER_ACTIVATION + 1)
        self._portion = [True] * portion
        self._loaded = 0
        self._unpaid = 0
        """With a meter and a watcher: the checkpoints that would be in the fuel: no look at the meter in them."""
        self._ready: deque[Strand] = deque()
        self._next: list[Strand] = []
        self.said: SaidText | None = None
        self.timers = Timers()
        self.watchers: list[Callable[[Strand, int], None]] = []
        self.passes = _Passes(self)
        self._started = self._starts_max = 0
        self._is_in_tick = False
        self._is_interrupted = False
        self._is_pausing = False
        self._is_resuming = False
        self._orphan_work = _ORPHAN_WORK
        self._on_end = on_end
        self._on_abandoned = on_abandoned
        self._on_late = on_late

    # ---------------------------------------------------------------- strands

    def spawn(
        self, name: str, body: Callable[[], None], builtins: dict[str, Any], *, is_secondary: bool = False
    ) -> Strand:
        """Add a strand; it runs in this tick after those that are ready already, or in the next one."""
        strand = Strand(self._started, name, body, builtins, is_secondary=is_secondary, tables=self._tables)
        self._started += 1
        self.strands.append(strand)
        (self._next.append if self._started > self._starts_max else self._enqueue)(strand)
        return strand

    def find(self, handle: int) -> Strand | None:
        """Return the living strand with that handle."""
        return next((strand for strand in self.strands if strand.handle == handle), None)

    @property
    def caller(self) -> Strand:
        """The running strand.

        Raises:
            Stopped: the caller is no strand, but left-over code of one.
        """
        if self.current is None:
            raise Stopped
        return self.current

    # ---------------------------------------------------------------- calls of the loop

    def begin_tick(self, tick: int) -> None:
        """Make the strands ready that are due at a tick."""
        self.now = tick
        self._starts_max = self._started + STARTS_PER_TICK
        self._is_in_tick = True
        if self._is_pausing:
            self._is_pausing = False
            self.timers.hold(tick)
        if self._is_resuming:
            self._is_resuming = False
            self.timers.release(tick)
        meter = self.meter
        if meter is not None:
            meter.begin_tick(tick)
        due = self._next
        self._next = []
        for strand in self.timers.due(tick):
            strand.was_woken = False
            strand.state = READY
            due.append(strand)
        if len(due) > 1:
            # After a tick that was cut, those that did not run in it come first.
            due.sort(key=_last_run if meter is not None and meter.was_spent else _order)
        self._ready.extend(due)

    def run_ready(self) -> None:
        """Run strands until none is ready in this tick, or something needs attention."""
        ready = self._ready
        now, meter = self.now, self.meter
        ran: Strand | None = None
        while ready and not self.needs_attention and not self._is_interrupted:
            strand = ready.popleft()
            if strand.state is not READY:
                continue
            if not strand.is_dying and (
                (self.is_paused and not strand.is_secondary)
                or (strand.work_tick == now and strand.work >= self._work_per_tick)
                or (meter is not None and self._is_over(meter, ran))
            ):
                self._next.append(strand)
                continue
            ran = strand
            self._activate(strand)
        if meter is not None and ran is not None and not ready:
            # The last one may have made a long call before it ended.
            self._is_over(meter, ran)

    @property
    def has_work(self) -> bool:
        """Whether a strand may be ready in this tick, or something needs attention."""
        return bool(self._ready) or self.needs_attention

    def end_tick(self) -> None:
        """Leave the tick; an interruption is over with it."""
        self._is_in_tick = False
        self._is_interrupted = False
        if self.meter is not None:
            self.meter.end_tick()

    def next_tick(self, tick: int) -> int | None:
        """Return the earliest tick after `tick` at which a strand is due; None while all wait for something else."""
        if self._is_resuming or (self._is_pausing and not self.is_paused):
            return tick + 1
        if self._next or self._ready:
            for strand in (*self._next, *self._ready):
                if strand.state is READY and (strand.is_secondary or not self.is_paused):
                    return tick + 1
        until = self.timers.next_tick()
        return tick + 1 if until is not None and until <= tick else until

    def interrupt(self) -> None:
        """Bring control back to the loop at the next checkpoint; may be called from a signal handler."""
        self._is_interrupted = True
        self._drain()

    def call_attention(self) -> None:
        """Bring control back to `run_ready` at the next checkpoint, and out of it."""
        self.needs_attention = True
        self._drain()

    def pause(self) -> None:
        """Let only secondary programs run.

        Virtual time goes on; waits of the paused strands are longer by the pause (*assumed*).
        """
        if not self.is_paused:
            self.is_paused = True
            if self._is_resuming:
                self._is_resuming = False
            elif self._is_in_tick:
                self.timers.hold(self.now)
            else:
                self._is_pausing = True

    def resume(self) -> None:
        """Let all strands run again, from the next tick that runs."""
        if self.is_paused:
            self.is_paused = False
            if self._is_pausing:
                self._is_pausing = False
            else:
                self._is_resuming = True

    def forget_pause(self) -> None:
        """Drop the pause of a program that has ended."""
        self.is_paused = self._is_pausing = self._is_resuming = False
        self.timers.forget_held()

    # ---------------------------------------------------------------- watching

    def watch(self, look: Callable[[Strand, int], None] | None, passes: Iterable[int] = ()) -> None:
        """Call a function before statements of programs that have probes.

        Meanwhile no fuel is paid out, so that every pass and call comes to `checkpoint`, behind which the probes are;
        see `language.switches`. Work is counted as before.

        Args:
            look: called with the running strand and the number of its next statement; None ends that.
            passes: numbers of the statements for which it is not called.
        """
        self.watchers[:] = () if look is None else (look,)
        self.passes.clear()
        self.passes.update(dict.fromkeys(passes))
        left = max(0, len(self.fuel) - FLOOR) + self._unpaid
        self._drain()
        if self.meter is not None and look is not None:
            self._unpaid = left
        elif left and self.meter is not None:
            self.fuel.extend(self._portion[:left])
            self._loaded += left

    def at_statement(self, number: int) -> None:
        """Let the watcher look at the next statement of the running strand."""
        strand = self.current
        if strand is not None and not strand.is_dying and strand.is_running:
            for look in self.watchers:
                look(strand, number)

    # ---------------------------------------------------------------- stopping

    def kill(self, strand: Strand) -> None:
        """End a strand where it stands; its `finally` blocks run first.

        When a strand stops another one, it goes on after that one has unwound. A strand that stops itself does not
        come back from this call.
        """
        if strand.state is ENDED or strand.is_dying:
            return
        strand.is_dying = True
        strand.ticket += 1
        if strand.cancel is not None:
            strand.cancel()
        current = self.current
        if strand is current:
            self.is_ending = True
            self._drain()
            raise Stopped
        strand.state = READY
        if not strand.is_started:
            self._retire(strand)
        elif current is None:
            self._activate(strand)
        elif current.is_dying:
            self._ready.appendleft(strand)
        else:
            self._ready.appendleft(current)
            self._ready.appendleft(strand)
            current.suspend()
            self._go_on(current)

    def forget(self) -> None:
        """Drop the stacks of all strands, which never run again."""
        for strand in self.strands:
            strand.forget()

    def refuse_if_stopped(self) -> None:
        """Let `finally` blocks of a stopped strand use commands that do not wait; stop it again otherwise.

        Raises:
            Stopped: again.
        """
        strand = self.current
        if strand is None or not strand.is_running:
            raise Stopped
        if strand.is_dying:
            self._spend_cleanup(strand)

    # ---------------------------------------------------------------- calls of strands

    def note_call(self) -> None:
        """Look at the meter before a call of the running strand; suspend it until a tick that has time for the call.

        Raises:
            Stopped: the strand was stopped meanwhile.
        """
        strand, meter = self.current, self.meter
        if meter is None or strand is None or strand.is_dying or not strand.is_running:
            return
        while meter.look():
            if meter.late_ms:
                self._on_late(strand, meter.late_ms)
            self._next.append(strand)
            strand.suspend()
            self._go_on(strand)
        strand.ran_tick = self.now

    def checkpoint(self) -> bool:
        """Refill the fuel, or suspend the strand; return True when it may go on. Called by compiled scripts.

        Raises:
            Stopped: it may not.
        """
        fuel = self.fuel
        taken = FLOOR - len(fuel)
        if taken == 1:
            fuel.append(False)
        else:
            fuel[:] = _FLOOR
        strand = self.current
        if strand is None or not strand.is_running:
            return self._orphan()
        strand.work += self._loaded + taken
        self._loaded = 0
        if strand.is_dying:
            self._spend_cleanup(strand)
            return True
        if self._is_interrupted or self.needs_attention:
            self._ready.appendleft(strand)
            strand.suspend()
            self._go_on(strand)
        if self._unpaid:
            # Without a watcher this one would have been passed at once.
            self._unpaid -= 1
            return True
        meter = self.meter
        while strand.work >= self._work_per_tick or (meter is not None and meter.look()):
            if meter is not None and meter.late_ms:
                self._on_late(strand, meter.late_ms)
            self._next.append(strand)
            strand.suspend()
            self._go_on(strand)
        strand.ran_tick = self.now
        # Another strand may have left fuel, which this strand has used since it was resumed.
        if self._loaded == 0:
            self._load(strand)
        return True

    def pay(self, count: int) -> bool:
        """Take checkpoints from the fuel at once; return False, and take none, if it holds fewer."""
        fuel = self.fuel
        if len(fuel) < FLOOR + count:
            return False
        del fuel[-count:]
        return True

    def note_loop(self, mark: tuple[str, int]) -> bool:
        """Keep that the running strand comes to a loop in which it may wait; return True.

        Args:
            mark: the name of the hook, and the line of the loop.
        """
        strand = self.current
        if strand is not None:
            strand.loops[mark[1]] = self.now
        return True

    def spend_refusal(self, *, moves: bool) -> None:
        """Charge the running strand for a call that a command has refused.

        Args:
            moves: it was planned as a move before it was refused.
        """
        self.spend(WORK_PER_REFUSED_MOVE if moves else WORK_PER_REFUSAL)

    def spend(self, count: int = WORK_PER_EVENT) -> None:
        """Charge the running strand for an event, or for something else that costs as much as so many checkpoints.

        They are taken from its fuel, and are work where that does not hold them.
        """
        strand = self.current
        if strand is not None:
            fuel = self.fuel
            left = len(fuel) - count
            if left < FLOOR:
                strand.work += FLOOR - max(left, FLOOR - count)
                left = FLOOR
            del fuel[left:]
            self._unpaid = max(self._unpaid - count, 0)

    def wait(self, reason: str, until: int | None = None) -> bool:
        """Suspend the running strand until it is woken, or until a tick; return whether it was woken.

        Args:
            reason: of the wait, as in "waits for ...".
            until: tick of the timeout.

        Raises:
            Stopped: the strand was stopped.
        """
        strand = self.current
        if strand is None or strand.is_dying or not strand.is_running:
            raise Stopped
        strand.ticket += 1
        if until is not None:
            if self.is_paused and not strand.is_secondary:
                self.timers.set_held(strand, until - self.now)
            else:
                self.timers.set(strand, until)
        strand.waits_for = reason
        strand.until = until
        strand.state = WAITING
        strand.suspend()
        strand.waits_for = ""
        strand.until = None
        self._go_on(strand)
        return strand.was_woken

    def join(self, strand: Strand, until: int | None = None) -> bool:
        """Suspend the running strand until another one has ended, or until a tick; return whether it has ended.

        Raises:
            Stopped: the running strand was stopped.
        """
        waiting = self.current
        if waiting is None or strand.state is ENDED:
            return strand.state is ENDED
        ticket = waiting.ticket + 1

        def wake() -> None:
            if waiting.ticket == ticket:
                self.wake(waiting)

        strand.at_end.append(wake)
        try:
            self.wait(said("the end of thread {strand!r}", strand=strand.name), until)
        finally:
            if wake in strand.at_end:
                strand.at_end.remove(wake)
        return strand.state is ENDED

    def give_way(self, reason: str) -> None:
        """Suspend the running strand until the next tick in which it may run.

        Raises:
            Stopped: the strand was stopped.
        """
        strand = self.current
        if strand is None or strand.is_dying or not strand.is_running:
            raise Stopped
        strand.waits_for = reason
        self._next.append(strand)
        strand.suspend()
        strand.waits_for = ""
        self._go_on(strand)

    def wake(self, strand: Strand) -> None:
        """End the wait of a strand; it runs in this tick, or in the next one that runs."""
        if strand.state is WAITING:
            strand.ticket += 1
            strand.was_woken = True
            strand.state = READY
            self._enqueue(strand)

    # ---------------------------------------------------------------- internal

    def _enqueue(self, strand: Strand) -> None:
        if self._is_in_tick:
            self._ready.append(strand)
        else:
            self._next.append(strand)

    def _is_over(self, meter: Meter, ran: Strand | None) -> bool:
        """Look at the meter outside all strands, after one that has run in this tick."""
        was_spent = meter.is_spent
        if not meter.look():
            return False
        if meter.late_ms and not was_spent and ran is not None:
            self._on_late(ran, meter.late_ms)
        return True

    def _activate(self, strand: Strand) -> None:
        if strand.work_tick != self.now:
            strand.work_tick = self.now
            strand.work = 0
            strand.portion = 1
        strand.work += WORK_PER_ACTIVATION
        strand.activations += 1
        outer, outer_ending = self.current, self.is_ending
        self.current = strand
        self.is_ending = strand.is_dying
        fuel = self.fuel
        allowed = 0 if strand.is_dying else max(0, self._work_per_tick - strand.work - 1)
        if self.meter is not None:
            allowed = min(allowed, strand.portion)
            self._unpaid = min(self._unpaid, allowed)
        if len(fuel) - FLOOR > allowed:
            del fuel[FLOOR + allowed :]
        self._loaded = len(fuel) - FLOOR
        limit = sys.getrecursionlimit()
        try:
            if strand.recursion_limit:
                sys.setrecursionlimit(strand.recursion_limit)
            strand.resume()
        finally:
            sys.setrecursionlimit(limit)
            strand.work += self._loaded - (len(fuel) - FLOOR)
            if len(fuel) < FLOOR:
                fuel[:] = _FLOOR
            self._loaded = len(fuel) - FLOOR
            self.current, self.is_ending = outer, outer_ending
            if strand.is_finished:
                self._retire(strand)
            elif strand.is_abandoned and strand.state is not ENDED:
                self._on_abandoned(strand)
                self._retire(strand)

    def _go_on(self, strand: Strand) -> None:
        if strand.is_dying:
            raise Stopped

    def _spend_cleanup(self, strand: Strand) -> None:
        if self.meter is not None and self.meter.look_at_cleanup():
            strand.give_up()
        strand.spend_cleanup()

    def _load(self, strand: Strand) -> None:
        count = min(len(self._portion), self._work_per_tick - strand.work - 1)
        if self.meter is not None:
            count = min(count, strand.portion)
            # Many long calls between two looks would hold the robot up for as long as all of them take.
            strand.portion = 1 if self.meter.held_up_us else min(2 * strand.portion, PORTION_MAX)
            if self.watchers:
                self._unpaid = max(count, 0)
        if self.watchers:
            return
        if count > 0:
            self.fuel.extend(self._portion if count == len(self._portion) else self._portion[:count])
            self._loaded = count

    def _drain(self) -> None:
        self._loaded -= max(0, len(self.fuel) - FLOOR)
        self._unpaid = 0
        self.fuel[:] = _FLOOR

    def _retire(self, strand: Strand) -> None:
        strand.state = ENDED
        self.strands.remove(strand)
        at_end, strand.at_end = strand.at_end, []
        for call in at_end:
            call()
        self._on_end(strand)

    def _orphan(self) -> bool:
        """Pass a checkpoint in code that no strand runs."""
        self._orphan_work -= 1
        if self._orphan_work < 0:
            raise Stopped
        return True


def noting_calls(scheduler: Scheduler, function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function that looks at the meter of the scheduler first; the function itself where there is none."""
    if scheduler.meter is None:
        return function
    note_call = scheduler.note_call

    def call(*args: Any, **kwargs: Any) -> Any:
        note_call()
        return function(*args, **kwargs)

    call.__name__, call.__qualname__, call.__doc__ = function.__name__, function.__qualname__, function.__doc__
    return call


class _Passes(dict[int, None]):
    """Numbers of statements. What is looked up and is none of them is looked at; the others cost a call in C."""

    __slots__ = ("_scheduler",)

    def __init__(self, scheduler: Scheduler) -> None:
        self._scheduler = scheduler

    def __missing__(self, number: int) -> None:
        self._scheduler.at_statement(number)


def _order(strand: Strand) -> int:
    return strand.order


def _last_run(strand: Strand) -> tuple[int, int]:
    return strand.ran_tick, strand.order
