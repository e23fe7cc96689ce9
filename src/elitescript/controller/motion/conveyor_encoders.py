"""The two conveyor encoders: counters whose count is a function of time.

A simulated encoder turns at the speed of the signal `encoder_speed`, so its count is linear between two changes of that
signal. The signal is the count of a quadrature decoder; a decoder of one channel counts fewer edges and no direction
(*assumed*, from how such decoders work). An encoder that no program has set up counts from 0 in quadrature, signed, 32
bits (*assumed*).

Where a program supplies the count (`encoder_set_tick_count`), a conveyor's speed in between is estimated from what
was set last, see `Encoder.line`. A simulated speed counts there too, from the count that was set last.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from math import floor, remainder
from typing import Any, Final

from elitescript.errors import ArgumentRangeError, ScriptStateError
from elitescript.messages.enums import PulseDecoder
from elitescript.messages.machine import DecodePulses, PrepareEncoder, SetEncoderCount
from elitescript.messages.timing import TICKS_PER_S
from elitescript.records import NamedTuple
from elitescript.said import said

ENCODERS: Final = 2

SPEED_SIGNAL: Final = "encoder_speed"
"""Quadrature counts per second of a simulated encoder."""


class CountRange(NamedTuple):
    """Range of a counter that wraps around."""

    low: int
    bits: int

    @property
    def size(self) -> int:
        """Number of different counts."""
        return 1 << self.bits

    @property
    def high(self) -> int:
        """Highest count."""
        return self.low + self.size - 1

    def wrapped(self, count: float) -> float:
        """Return a count wrapped to the range."""
        return self.low + (count - self.low) % self.size

    def unwound(self, delta: float) -> float:
        """Return a difference of two counts, brought to within half a range of 0."""
        return remainder(delta, self.size) + 0.0


RANGES: Final = (
    CountRange(-(1 << 31), 32),
    CountRange(0, 8),
    CountRange(0, 16),
    CountRange(0, 24),
    CountRange(0, 32),
)
"""By the number that `encoder_enable_set_tick_count` takes (manual 2.14, 3.1.21)."""

SHARES: Final = {
    PulseDecoder.QUADRATURE: 1.0,
    PulseDecoder.EDGES: 0.5,
    PulseDecoder.RISING: 0.25,
    PulseDecoder.FALLING: 0.25,
}
"""Counts for one quadrature count: a period of the wheel has four edges on two channels, two on one."""

WINDOW_TICKS: Final = 50
"""Speed between counts that a program sets is that of the last 0.2 s (*assumed*), so that whole counts do not show."""

GAP_TICKS: Final = 125
"""Counts that are set less often than every 0.5 s give no speed (*assumed*)."""

_SETS_MAX: Final = 64
"""Counts that are remembered."""

_WHOLE: Final = 1e-9
"""A count less than this below a whole number is that number: rounding."""


class CountLine(NamedTuple):
    """Counts since the start, not wrapped, as a linear function of time."""

    tick: int
    counts: float
    """At that tick."""
    rate: float
    """Counts per second."""

    def at(self, tick: int) -> float:
        """Return the counts at a tick."""
        return self.counts + self.rate * (tick - self.tick) / TICKS_PER_S

    def at_rate(self, tick: int, rate: float) -> CountLine:
        """Return the line that goes on from a tick at another rate."""
        return CountLine(tick, self.at(tick), rate)


class Encoder:
    """One encoder; it keeps its settings and its count from one program to the next (*assumed*).

    Args:
        index: its number.
    """

    __slots__ = (
        "_count",
        "_counts_then",
        "_decoder",
        "_index",
        "_is_set_by_program",
        "_line",
        "_sets",
        "_speed",
        "range",
    )

    def __init__(self, index: int) -> None:
        self._index = index
        self.range = RANGES[0]
        self._speed = 0.0
        self._decoder = PulseDecoder.QUADRATURE
        self._is_set_by_program = False
        self._line = CountLine(0, 0.0, 0.0)
        self._count = 0.0
        """Shown count at `_counts_then`."""
        self._counts_then = 0.0
        self._sets: deque[CountLine] = deque(maxlen=_SETS_MAX)

    def count(self, tick: int) -> float:
        """Return the shown count: whole counts, or the one that was set last."""
        return self.range.wrapped(self._count + floor(self._line.at(tick) - self._counts_then + _WHOLE))

    def line(self, tick: int) -> CountLine:
        """Return the motion of the conveyor from a tick on, as known at that tick.

        Between counts that a program sets, the conveyor keeps the speed of the last ones, for the time of two more.
        If none comes by then, it stands at the last count (*assumed*).
        """
        sets = self._sets
        if len(sets) < 2:
            return self._line
        last, before = sets[-1], sets[-2]
        interval = last.tick - before.tick
        if interval > GAP_TICKS or tick >= last.tick + 2 * interval:
            return self._line
        return last

    def turn(self, speed: float, tick: int) -> None:
        """Set the speed of the wheel from a tick on, quadrature counts per second."""
        self._speed = speed
        self._line = self._line.at_rate(tick, self._rate)

    def prepare(self, request: PrepareEncoder, tick: int) -> None:
        """Let the program supply the count, in a range; it is 0 before the first (*assumed*)."""
        self._begin(RANGES[request.range_id], PulseDecoder.QUADRATURE, tick)
        self._is_set_by_program = True

    def decode(self, request: DecodePulses, tick: int) -> None:
        """Count the pulses at high-speed inputs, from 0 in 32 bits with sign (*assumed*)."""
        self._begin(RANGES[0], request.decoder, tick)
        self._is_set_by_program = False

    def set_count(self, request: SetEncoderCount, tick: int) -> None:
        """Take the count that the program supplies.

        The first one only sets the shown count. Every other one moves the conveyor, by less than half a range
        (*assumed*).

        Raises:
            ScriptError: the encoder is not prepared for it, or the count is outside its range.
        """
        index, count, limits = self._index, request.count, self.range
        if not self._is_set_by_program:
            raise ScriptStateError(
                said("encoder {index} does not take its count from the program", index=index),
                code="R122",
                value=count,
                hint=said("encoder_enable_set_tick_count({index}, range_id) prepares it", index=index),
            )
        if not limits.low <= count <= limits.high:
            raise ArgumentRangeError(
                said(
                    "count must be in [{low}, {high}], the range of encoder {index}, got {count:.12g}",
                    low=limits.low,
                    high=limits.high,
                    index=index,
                    count=count,
                ),
                argument="count",
                value=count,
                limit=f"[{limits.low}, {limits.high}]",
                unit="ticks",
            )
        counts = self._line.at(tick)
        if self._sets:
            counts += limits.unwound(count - self.count(tick))
        self._line = CountLine(tick, counts, self._rate)
        self._count, self._counts_then = count, counts
        while self._sets and self._sets[-1].tick == tick:
            self._sets.pop()
        self._sets.append(CountLine(tick, counts, self._recent_rate(tick, counts)))

    def _recent_rate(self, tick: int, counts: float) -> float:
        since: CountLine | None = None
        for earlier in reversed(self._sets):
            if since is not None and tick - earlier.tick > WINDOW_TICKS:
                break
            since = earlier
        return self._rate if since is None else (counts - since.counts) / (tick - since.tick) * TICKS_PER_S

    def _begin(self, limits: CountRange, decoder: PulseDecoder, tick: int) -> None:
        self.range = limits
        self._decoder = decoder
        self._line = self._line.at_rate(tick, self._rate)
        self._count, self._counts_then = 0.0, self._line.counts
        self._sets.clear()

    @property
    def _rate(self) -> float:
        if self._decoder is PulseDecoder.QUADRATURE:
            return self._speed
        return abs(self._speed) * SHARES[self._decoder]


ENCODER_HANDLERS: Final[dict[type, Callable[[Encoder, Any, int], None]]] = {
    PrepareEncoder: Encoder.prepare,
    DecodePulses: Encoder.decode,
    SetEncoderCount: Encoder.set_count,
}
"""Handler of every request that changes an encoder, at a tick."""
