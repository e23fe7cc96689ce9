"""Meters: what ends the program phase of a tick where a wall clock rules, for all threads at once.

Work is counted in checkpoints, and a call of a command, or one that is refused, may take as long as thousands of them.
A served robot has to keep up with the wall clock all the same. So its scheduler looks at a meter before it lets a
thread go on, at each call of a command or a facade, and at checkpoints, at first at each, then at every second, fourth
and so on up to every 64th. Where the looks are depends on the program alone: their number in the tick says
exactly how far the threads came, and a robot that is given this number (`RepeatingMeter`) stops at the same place.

The share of a tick is time of the processor that the thread of the robot has had, so that a busy computer cuts nothing.
What a program leaves of its shares it may use later, up to `CREDIT_SHARES`; what one long call takes beyond them is
missing in the ticks behind it, so that robot time keeps up in the mean. Where ticks begin late, because the computer
was away for a while, a program that has used up the tick before gets a part of its share until they are in time again:
streams catch up at once, and programs that wait in their ticks are not cut for what the computer does beside them.

Nothing looks inside such a call, and streams are late by as long as it takes. One now and then is warned of. Where they
hold the robot up for more than 1 % of the time, by more than `held_up_max_s`, the program has to end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import Final

from elitescript.messages.cut import WHOLE, Cut
from elitescript.messages.timing import HELD_UP_MAX_S, TICKS_PER_S

PERIOD_NS: Final = 1_000_000_000 // TICKS_PER_S
SHARE_NS: Final = 2_000_000
"""Time of programs in a tick: half of it; the rest is for the snapshot, the way to the clients and a busy computer."""
CREDIT_SHARES: Final = 2
"""Shares of earlier ticks that are kept for a later one at most: a period, so that no stream is late by more."""
BEGIN_SHARES: Final = 10
"""What a program may use at its beginning besides: its first calls load what they need."""
HURRIED_PART: Final = 8
"""The share divided by it is what a program has that uses ticks up, while they begin late."""
HURRIED_NS: Final = 2_000_000
"""So late a tick begins that is late: half a period."""
GIVEN_UP_NS: Final = 500_000_000
"""Later ones are not made up for, and the next are as late for good: those that are left out."""
CREEP_NS: Final = 40_000
"""Of each tick: what begins late for good counts as in time after a while."""
CLEANUP_NS: Final = 4_000_000
"""Time in a tick for the `finally` blocks of stopped threads."""
LATE_NS: Final = 10_000_000
"""A call that takes so much more than its share makes streams late; a program is warned of it once."""
HELD_UP_PER_TICK_US: Final = 40
"""Time of each tick for which calls may hold the robot up for good: 1 %."""


class Meter:
    """Counts the looks of a tick. This one ends no tick.

    Attributes:
        is_spent: whether no thread runs on in this tick.
        was_spent: whether that was so in the tick before.
        late_ms: by how much the call that has ended the tick was too long; 0 where none was.
        late_line: line of the statement that has taken longest in that tick, if `notes_statements`; 0 elsewhere.
        notes_statements: whether it is of use to call `note_statement`.
        held_up_us: for how long such calls of the program have held the robot up beyond what they may for good; one
            call counts a third of `held_up_max_us` at most, so that no two calls end a program.
        held_up_max_us: beyond this the program has to end.
    """

    __slots__ = (
        "_cleanups",
        "_given_up_at",
        "_looks",
        "_spent_at",
        "_tick",
        "held_up_max_us",
        "held_up_us",
        "is_spent",
        "late_line",
        "late_ms",
        "was_spent",
    )

    notes_statements = False

    def __init__(self) -> None:
        self._tick = -1
        self._looks = self._spent_at = self._cleanups = self._given_up_at = 0
        self.is_spent = self.was_spent = False
        self.late_ms = self.late_line = 0
        self.held_up_us = 0
        self.held_up_max_us = round(1_000_000 * HELD_UP_MAX_S)

    @property
    def cut(self) -> Cut:
        """How far the threads came in the tick that ran last."""
        if not self._spent_at and not self._given_up_at:
            return WHOLE
        return Cut(self._spent_at, self._given_up_at, self.late_ms, self.late_line)

    def begin_tick(self, tick: int) -> None:
        """Begin the program phase of a tick, or go on with it: a program that is replaced ends before it."""
        if tick == self._tick:
            self._resume()
            return
        ticks = tick - self._tick
        self._begin(ticks)
        if self.held_up_us:
            self.held_up_us = max(0, self.held_up_us - ticks * HELD_UP_PER_TICK_US)
        self._tick = tick
        # Where ticks were leapt over, they were not.
        self.was_spent, self.is_spent = self.is_spent and ticks == 1, False
        self._looks = self._spent_at = self._cleanups = self._given_up_at = self.late_ms = self.late_line = 0

    def end_tick(self) -> None:
        """End it, or leave it until `begin_tick` is called for the same tick."""

    def begin_program(self) -> None:
        """Note that a program begins."""
        self.held_up_us = 0

    def pardon(self) -> AbstractContextManager[None]:
        """Return a context in which time does not count."""
        return nullcontext()

    def note_statement(self, line: int) -> None:
        """Note that the statement of this line begins."""

    def look(self) -> bool:
        """Return whether the tick is over for all threads."""
        if not self.is_spent:
            self._looks += 1
            if self._is_over(self._looks):
                self._spent_at = self._looks
                self.is_spent = True
                self.late_ms = self._late_ms()
                if self.late_ms:
                    self.late_line = self._late_line()
                self.held_up_us += min(1000 * self.late_ms, self.held_up_max_us // 3)
        return self.is_spent

    def look_at_cleanup(self) -> bool:
        """Return whether threads that were stopped are to be given up where they stand."""
        if not self._given_up_at:
            self._cleanups += 1
            if self._is_cleanup_over(self._cleanups):
                self._given_up_at = self._cleanups
        return self._given_up_at > 0

    def _begin(self, ticks: int) -> None:
        pass

    def _resume(self) -> None:
        pass

    def _is_over(self, look: int) -> bool:
        return False

    def _is_cleanup_over(self, step: int) -> bool:
        return False

    def _late_ms(self) -> int:
        return 0

    def _late_line(self) -> int:
        return 0


class ClockMeter(Meter):
    """Ends ticks by a clock.

    Args:
        now_ns: a clock that is quick to read.
        worked_ns: time of the processor that the calling thread has had; looked at only where `now_ns` says it is late.
        share_ns: see `SHARE_NS`.
    """

    __slots__ = (
        "_allowed_ns",
        "_began_ns",
        "_cleanup_until_ns",
        "_cleanup_worked_ns",
        "_credit_ns",
        "_due_ns",
        "_line",
        "_line_ns",
        "_longest_line",
        "_longest_ns",
        "_now_ns",
        "_over_ns",
        "_share_ns",
        "_until_ns",
        "_used_ns",
        "_worked_before_ns",
        "_worked_ns",
        "_worked_until_ns",
    )

    notes_statements = True

    def __init__(self, now_ns: Callable[[], int], worked_ns: Callable[[], int], *, share_ns: int = SHARE_NS) -> None:
        super().__init__()
        self._now_ns = now_ns
        self._worked_ns = worked_ns
        self._share_ns = share_ns
        self._credit_ns = self._allowed_ns = self._used_ns = 0
        self._due_ns = 0
        """When the last tick was to begin."""
        self._began_ns = self._until_ns = self._over_ns = 0
        self._worked_before_ns = self._worked_until_ns = 0
        """Time of the processor at the begin of the phase, and when it was left last; what does not count is in it."""
        self._cleanup_until_ns = self._cleanup_worked_ns = 0
        self._line = self._line_ns = self._longest_line = self._longest_ns = 0

    def end_tick(self) -> None:
        self._worked_until_ns = self._worked_ns()
        self._used_ns = self._worked_until_ns - self._worked_before_ns

    def _begin(self, ticks: int) -> None:
        # Nothing was done in ticks that were leapt over.
        earned_ns = ticks * self._share_ns - self._used_ns
        self._credit_ns = min(self._credit_ns + earned_ns, max(CREDIT_SHARES * self._share_ns, self._credit_ns))
        self._began_ns = self._now_ns()
        self._allowed_ns = self._share_ns + self._credit_ns
        if self._is_late(ticks) and self.is_spent:
            self._credit_ns = min(self._credit_ns, 0)
            self._allowed_ns = min(self._allowed_ns, self._share_ns // HURRIED_PART)
        self._used_ns = 0
        self._worked_before_ns = self._worked_ns()
        self._until_ns = self._began_ns + self._allowed_ns
        self._cleanup_until_ns = 0
        # A statement in whose middle a thread was suspended goes on.
        self._line_ns, self._longest_line, self._longest_ns = self._began_ns, 0, 0

    def _is_late(self, ticks: int) -> bool:
        """Note when a tick begins; return whether that is late, by the ticks before."""
        due_ns = self._due_ns + ticks * PERIOD_NS
        late_ns = self._began_ns - due_ns
        is_known = self._due_ns and 0 <= late_ns <= GIVEN_UP_NS
        self._due_ns = due_ns + min(late_ns, ticks * CREEP_NS) if is_known else self._began_ns
        return bool(is_known) and late_ns >= HURRIED_NS

    def _resume(self) -> None:
        # What was between is no work of programs.
        self._worked_before_ns += self._worked_ns() - self._worked_until_ns

    def begin_program(self) -> None:
        super().begin_program()
        self._line = 0
        begin_ns = BEGIN_SHARES * self._share_ns
        self._credit_ns = max(self._credit_ns, begin_ns)
        # In the tick that runs already, too.
        self._allowed_ns = max(self._allowed_ns, begin_ns)

    @contextmanager
    def pardon(self) -> Iterator[None]:
        began_ns = self._worked_ns()
        try:
            yield
        finally:
            self._worked_before_ns += self._worked_ns() - began_ns

    def spend(self, time_ns: int) -> None:
        """Count time in which a program has not worked, but had something done for it."""
        self._worked_before_ns -= time_ns

    def _is_over(self, look: int) -> bool:
        now_ns = self._now_ns()
        if now_ns < self._until_ns:
            return False
        left_ns = self._allowed_ns - (self._worked_ns() - self._worked_before_ns)
        self._until_ns = now_ns + left_ns
        self._over_ns = -left_ns - max(-self._allowed_ns, 0)
        return left_ns <= 0

    def note_statement(self, line: int) -> None:
        now_ns = self._now_ns()
        if now_ns - self._line_ns > self._longest_ns:
            self._longest_line, self._longest_ns = self._line, now_ns - self._line_ns
        self._line, self._line_ns = line, now_ns

    def _late_line(self) -> int:
        if self._line:
            self.note_statement(self._line)
        return self._longest_line

    def _late_ms(self) -> int:
        return self._over_ns // 1_000_000 if self._over_ns >= LATE_NS else 0

    def _is_cleanup_over(self, step: int) -> bool:
        now_ns = self._now_ns()
        if not self._cleanup_until_ns:
            self._cleanup_until_ns, self._cleanup_worked_ns = now_ns + CLEANUP_NS, self._worked_ns()
        if now_ns < self._cleanup_until_ns:
            return False
        left_ns = CLEANUP_NS - (self._worked_ns() - self._cleanup_worked_ns)
        self._cleanup_until_ns = now_ns + left_ns
        return left_ns <= 0


class RepeatingMeter(Meter):
    """Ends ticks where they ended before."""

    __slots__ = ("_expected", "_next")

    def __init__(self) -> None:
        super().__init__()
        self._next = self._expected = WHOLE

    def expect(self, cut: Cut) -> None:
        """Take how far the threads came in the tick that runs next."""
        self._next = cut

    def _begin(self, ticks: int) -> None:
        self._expected, self._next = self._next, WHOLE

    def _is_over(self, look: int) -> bool:
        return look == self._expected.looks

    def _is_cleanup_over(self, step: int) -> bool:
        return step == self._expected.cleanups

    def _late_ms(self) -> int:
        return self._expected.late_ms

    def _late_line(self) -> int:
        return self._expected.late_line
