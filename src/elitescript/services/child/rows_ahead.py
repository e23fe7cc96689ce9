"""Rows that a child sends ahead: what ticks give in which nothing is due, if nothing is given to the robot by then.

The rows of a tick that was answered follow its answer. While they last, the ticks of the server need no message to the
child. As soon as a tick is sent, because an input has come in or more is read, rows of it and of later ticks are not
used any more, wherever they are on their way.
"""

from __future__ import annotations

from collections import deque

from elitescript.codec.values import CodecError
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot_parts import TIME


class RowsAhead:
    """Keeps the rows of one child until their tick.

    Attributes:
        count: how many rows the last answer has announced.
        due: the next tick that is due, as the answer before the rows has said.
        parts: of the snapshots of the rows that come, as bits.
    """

    __slots__ = ("_coming", "_until", "_waiting", "count", "due", "parts")

    def __init__(self) -> None:
        self._waiting: deque[Output] = deque()
        self._coming = range(0)
        """Ticks of the rows that are still to come, used or not."""
        self._until = -1
        """The last tick whose row is used."""
        self.count = 0
        self.due = 0
        self.parts = 0

    def end_before(self, number: int) -> None:
        """Use no row of this tick, which is sent, or of a later one."""
        self._until = min(self._until, number - 1)
        self._waiting.clear()

    def announce(self, number: int, count: int, parts: int, due: int, *, is_newest: bool) -> None:
        """Take note of the rows that follow the answer to a tick.

        Args:
            number: of that tick.
            count: of the rows.
            parts: of their snapshots, as bits.
            due: the next tick that is due.
            is_newest: whether no later tick was sent meanwhile: only then they are used.

        Raises:
            CodecError: rows that were announced before have not come.
        """
        if self._coming:
            raise CodecError(f"the row of tick {self._coming[0]} is missing")
        self._coming = range(number + 1, number + 1 + count)
        self._until = number + count if is_newest else number
        self.count, self.parts, self.due = count, parts | TIME, due

    def add(self, row: Output) -> bool:
        """Take a row that has come; return whether it is used.

        Raises:
            CodecError: it is not the one that is to come, or is more than a row.
        """
        if not self._coming or row.tick != self._coming[0]:
            raise CodecError(f"a row of tick {row.tick} that was not announced")
        if row.events or row.requests or row.replies:
            raise CodecError("a row in which something happens")
        self._coming = self._coming[1:]
        if row.tick > self._until:
            return False
        self._waiting.append(row)
        return True

    def knows(self, number: int, parts: int) -> bool:
        """Return whether there is, or will be, a row of this tick with these parts of its snapshot."""
        return number <= self._until and not parts & ~self.parts

    def take(self, number: int) -> Output | None:
        """Return the row of a tick of `knows`, and forget those before it; None if it has not come yet."""
        waiting = self._waiting
        while waiting and waiting[0].tick < number:
            waiting.popleft()
        return waiting.popleft() if waiting and waiting[0].tick == number else None
