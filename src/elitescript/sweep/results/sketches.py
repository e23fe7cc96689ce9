"""Bounded sketches of many rows: a distribution with a known error, and a sample that is the same in any order.

Both depend on what was added alone, not on the order: parts of a sweep may be added as they come.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Final, Generic, TypeVar

from elitescript.records import record

BINS: Final = 2048
"""Occupied bins of a sketch, at most."""

_FINEST: Final = -40
"""Exponent of the first bin width: 2^-40 is 1e-12."""

_COARSEST: Final = 1023

_WHOLE: Final = 2.0**53
"""Floats from here on are whole numbers."""

_SPARE: Final = 64
"""Sums are kept by this power of two smaller, so that they do not overflow."""

_WORD: Final = (1 << 64) - 1

Item = TypeVar("Item")


@record
class Distribution:
    """What a sketch knows.

    Attributes:
        count: of finite values.
        least: value, exact.
        p05: 5 % of the values are at most this, with `error`; so for the others.
        p25: see there.
        median: see there.
        p75: see there.
        p95: see there.
        most: value, exact.
        mean: value; its sum is exact but for its last rounding.
        error: largest error of the five quantiles, in the unit of the values.
        others: values that are no finite number.
    """

    count: int
    least: float
    p05: float
    p25: float
    median: float
    p75: float
    p95: float
    most: float
    mean: float
    error: float
    others: int


class Sketch:
    """A histogram whose bins are multiples of a power of two, as fine as `BINS` occupied ones allow.

    The width is the smallest with which the values occupy at most `BINS` bins, so it depends on the values alone.
    """

    __slots__ = ("_bins", "_exponent", "_partials", "count", "least", "most", "others")

    def __init__(self) -> None:
        self._bins: dict[int, int] = {}
        self._exponent = _FINEST
        # Sums without rounding: Shewchuk's partial sums, as `math.fsum` has them, which do not depend on the order.
        self._partials: list[float] = []
        self.count = 0
        self.others = 0
        self.least = math.inf
        self.most = -math.inf

    def add(self, value: float) -> None:
        """Add a value; infinities and NaN are counted beside the others."""
        if not math.isfinite(value):
            self.others += 1
            return
        self.count += 1
        self.least = min(self.least, value)
        self.most = max(self.most, value)
        self._add_exactly(math.ldexp(value, -_SPARE))
        index = _bin_of(value, self._exponent)
        self._bins[index] = self._bins.get(index, 0) + 1
        while len(self._bins) > BINS and self._exponent < _COARSEST:
            self._exponent += 1
            merged: dict[int, int] = {}
            for index, count in self._bins.items():
                merged[index >> 1] = merged.get(index >> 1, 0) + count
            self._bins = merged

    def distribution(self) -> Distribution | None:
        """Return what is known; None without a finite value."""
        if self.count == 0:
            return None
        p05, p25, median, p75, p95 = (self.quantile(share) for share in (0.05, 0.25, 0.5, 0.75, 0.95))
        mean = math.ldexp(math.fsum(self._partials) / self.count, _SPARE)
        error = math.ldexp(1.0, self._exponent - 1)
        return Distribution(self.count, self.least, p05, p25, median, p75, p95, self.most, mean, error, self.others)

    def quantile(self, share: float) -> float:
        """Return the value below or at which a share of all values lies, with an error of half a bin."""
        wanted = max(1, math.ceil(share * self.count))
        seen = 0
        for index in sorted(self._bins):
            seen += self._bins[index]
            if seen >= wanted:
                return min(max(_middle_of(index, self._exponent), self.least), self.most)
        return self.most

    def _add_exactly(self, value: float) -> None:
        kept = 0
        for partial in self._partials:
            larger, smaller = (value, partial) if abs(value) >= abs(partial) else (partial, value)
            total = larger + smaller
            rest = smaller - (total - larger)
            if rest:
                self._partials[kept] = rest
                kept += 1
            value = total
        self._partials[kept:] = [value]


def _bin_of(value: float, exponent: int) -> int:
    """Return the number of the bin, exactly: `value` is a fraction whose denominator is a power of two."""
    if exponent < 0 and abs(value) >= _WHOLE:
        return int(value) << -exponent
    return math.floor(math.ldexp(value, -exponent))


def _middle_of(index: int, exponent: int) -> float:
    if exponent < 0 and abs(index) >= 1 << 60:
        return float(index >> -exponent)
    return math.ldexp(index + 0.5, exponent)


class Sample(Generic[Item]):
    """Some of many items, chosen by a hash of their number: which ones depends on the numbers alone.

    Args:
        size: items that are kept at most; between half of it and all of it once there are more.
    """

    __slots__ = ("_items", "_level", "_size", "seen")

    def __init__(self, size: int) -> None:
        self._size = size
        self._level = 0
        self._items: dict[int, Item] = {}
        self.seen = 0

    def add(self, number: int, make: Callable[[], Item]) -> None:
        """Add an item, which is only made if it is kept."""
        self.seen += 1
        if not self._keeps(number):
            return
        self._items[number] = make()
        while len(self._items) > self._size:
            self._level += 1
            self._items = {number: item for number, item in self._items.items() if self._keeps(number)}

    def __iter__(self) -> Iterator[Item]:
        """Give the items in the order of their numbers."""
        return (self._items[number] for number in sorted(self._items))

    def __len__(self) -> int:
        return len(self._items)

    @property
    def one_in(self) -> int:
        """Of so many items one is kept, about."""
        return 1 << self._level

    def at_most(self, size: int) -> tuple[list[Item], int]:
        """Return what a sample of another size, not larger, would have kept, and of how many items it keeps one."""
        numbers, one_in = sorted(self._items), self.one_in
        while len(numbers) > size:
            one_in *= 2
            numbers = [number for number in numbers if not mixed(number) & (one_in - 1)]
        return [self._items[number] for number in numbers], one_in

    def _keeps(self, number: int) -> bool:
        return not mixed(number) & ((1 << self._level) - 1)


def mixed(number: int) -> int:
    """Return 64 bits that look random, the same for the same number: the last steps of splitmix64."""
    bits = (number + 0x9E3779B97F4A7C15) & _WORD
    bits = ((bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9) & _WORD
    bits = ((bits ^ (bits >> 27)) * 0x94D049BB133111EB) & _WORD
    return bits ^ (bits >> 31)
