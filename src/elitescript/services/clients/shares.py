"""Shares of clients in the reading time of one robot: which are read in a tick, and how much.

Reading takes time that all clients need, for what they send must be decoded, and what it asks for must be done. In
every tick there is `READ_BUDGET_NS` for it. A client that takes little is read whenever it sends something. One that
has used up its share waits, its bytes in its socket: clients that had sent no more than was read of them come before
the others, each in the order in which they came. What was spent beyond a tick is paid by the next
ones, so that the robot and other clients keep their time however many clients flood. While ticks begin late, because
the computer has other work too, there is less of it.

What inputs cost the robot itself is no matter of this module: see `input_queue`.
"""

from __future__ import annotations

from collections import deque
from typing import Final, Protocol

READ_BUDGET_NS: Final = 1_500_000
"""Of every tick, for what all clients send."""
LATE_READ_BUDGET_NS: Final = READ_BUDGET_NS // 10
"""The same while ticks begin late."""
SHARE_NS: Final = 300_000
"""Of every tick, for what one client sends."""
LIGHT_SHARES: Final = 4
"""Shares that a client may take which has sent no more than was read of it."""
READ_MIN: Final = 128
READ_MAX: Final = 4096
"""Bytes that are taken from a socket at once: as many as the share is expected to pay for."""
DEBT_MAX_TICKS: Final = 250
"""What is spent beyond a tick and is not paid by so many others is forgiven."""


class Waiting(Protocol):
    """A client or a listener that waits to be read."""

    expected_ns: int
    """What reading it will cost, as far as can be known, ns; 0 if it has gone."""

    def go_on(self) -> None:
        """Read on now."""


class Shares:
    """Divides the time for reading of one robot.

    Attributes:
        kept: bytes of clients that were taken from their sockets and wait for their turn.
        robots: that one process serves; they share its time.
        spent_ns: of this tick, with what the ticks before have left to pay.
        tick: number of ticks that have begun.
    """

    __slots__ = ("_heavy", "_light", "_tick_ns", "kept", "robots", "spent_ns", "tick")

    def __init__(self) -> None:
        self.robots = 1
        self.spent_ns = self.kept = self.tick = 0
        self._tick_ns = READ_BUDGET_NS
        self._light: deque[Waiting] = deque()
        self._heavy: deque[Waiting] = deque()

    @property
    def waiting(self) -> int:
        """Number of clients that wait to be read."""
        return len(self._light) + len(self._heavy)

    @property
    def is_settled(self) -> bool:
        """Whether nobody waits to be read, and nothing of earlier ticks is to be paid."""
        return not self._light and not self._heavy and not self.spent_ns

    def charge(self, spent_ns: int) -> None:
        """Count time that reading a client has used, ns."""
        self.spent_ns += spent_ns

    def is_used_up(self, own_ns: int, *, is_light: bool = False) -> bool:
        """Return whether a client that used `own_ns` must wait.

        Args:
            own_ns: what it has used.
            is_light: it has sent no more than was read of it. It may take more: a package that waits for the next tick
                is late, the end of a client that is not read is not seen, and late ticks are not caused by it.
        """
        if is_light:
            return own_ns > LIGHT_SHARES * SHARE_NS or self.spent_ns > LIGHT_SHARES * READ_BUDGET_NS
        return own_ns > SHARE_NS or self.spent_ns > self._tick_ns

    def size_for(self, ns_per_byte: float) -> int:
        """Return the bytes to read at once from a client whose bytes have cost so much."""
        if self.spent_ns > self._tick_ns:
            return READ_MIN
        if ns_per_byte * READ_MAX <= SHARE_NS:
            return READ_MAX
        return max(int(SHARE_NS / ns_per_byte), READ_MIN)

    def wait(self, client: Waiting, *, is_light: bool) -> None:
        """Take a place in the queue.

        Args:
            client: waits; must not wait already.
            is_light: it has sent no more than was read of it.
        """
        (self._light if is_light else self._heavy).append(client)

    def begin_tick(self, *, is_late: bool = False) -> None:
        """Begin the time for reading of a tick: those that wait first are read on.

        Args:
            is_late: the tick began late.
        """
        self.tick += 1
        self.spent_ns = min(max(self.spent_ns - self._tick_ns, 0), DEBT_MAX_TICKS * READ_BUDGET_NS)
        self._tick_ns = (LATE_READ_BUDGET_NS if is_late else READ_BUDGET_NS) // self.robots
        left_ns = self._tick_ns - self.spent_ns
        # One that is read on may take a place again at once; it is read in a later tick then.
        turns = self.waiting
        while turns and left_ns > 0:
            turns -= 1
            client = self._light.popleft() if self._light else self._heavy.popleft()
            left_ns -= client.expected_ns
            client.go_on()
