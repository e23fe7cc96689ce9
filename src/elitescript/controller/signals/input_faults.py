"""Simulates faults of digital and analog inputs.

An input has a physical level, which devices, wires, schedules and clients set, and a level that the robot reads, which
is in the signal image. They differ only while a fault acts. Several faults of one input are applied in the order in
which they began. Random numbers follow from the seed of the fault and its number alone, so a run that leaps over ticks
is the same as one that runs every tick.

The behaviour of the real hardware is *assumed* throughout: an open digital input reads low, an open analog one 0 V or
0 A, a spurious flip lasts one control period, and an analog input reads the end of its range beyond it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from math import ceil, cos, log, log1p, pi, sqrt
from typing import Final

from elitescript.controller.arm.joint_encoders import mixed
from elitescript.messages.machine import DisturbInput
from elitescript.messages.signals import SIGNALS, Value
from elitescript.messages.timing import PERIOD_S, TICKS_PER_S

_WORD: Final = (1 << 64) - 1
_FAR: Final = 1 << 62
"""Tick of an event that never comes."""

Show = Callable[[str, int, Value, bool], None]
"""Callback with family, index, the level that is read from now on, and whether a fault is the cause."""


class _Chance:
    """Random numbers that follow from a seed and a key."""

    __slots__ = ("_base",)

    def __init__(self, seed: int, number: int) -> None:
        self._base = mixed(mixed(seed & _WORD) ^ number)

    def word(self, *key: int) -> int:
        word = self._base
        for part in key:
            word = mixed(word ^ (part & _WORD))
        return word

    def share(self, *key: int) -> float:
        """Return a number in (0, 1]."""
        return ((self.word(*key) >> 11) + 1) / (1 << 53)

    def normal(self, key: int) -> float:
        """Return a normally distributed number (Box and Muller 1958)."""
        return sqrt(-2.0 * log(self.share(key, 0))) * cos(2.0 * pi * self.share(key, 1))


class _Effect:
    """One fault of one input while it acts; repeated reads of a tick give the same.

    Args:
        fault: its parameters.
        tick: the first tick.
        level: applied at that tick.
        chance: its random numbers.
    """

    __slots__ = ("_chance", "_fault", "_level")

    def __init__(self, fault: DisturbInput, tick: int, level: Value, chance: _Chance) -> None:
        self._fault = fault
        self._level = level
        self._chance = chance

    def read(self, tick: int, level: Value) -> Value:
        """Return the level that is read in a tick in which `level` is applied."""
        raise NotImplementedError

    def next_tick(self, tick: int) -> int:
        """Return the next tick at which another level may be read though the same one is applied."""
        return _FAR


class _Stuck(_Effect):
    def read(self, tick: int, level: Value) -> Value:
        return self._level if self._fault.value is None else self._fault.value


class _Inverted(_Effect):
    def read(self, tick: int, level: Value) -> Value:
        return not level


class _OpenWire(_Effect):
    def read(self, tick: int, level: Value) -> Value:
        return SIGNALS[self._fault.name].default if self._fault.value is None else self._fault.value


class _Late(_Effect):
    __slots__ = ("_coming", "_read")

    def __init__(self, fault: DisturbInput, tick: int, level: Value, chance: _Chance) -> None:
        super().__init__(fault, tick, level, chance)
        self._read = level
        self._coming: deque[tuple[int, Value]] = deque()

    def read(self, tick: int, level: Value) -> Value:
        if level != self._level:
            self._level = level
            self._coming.append((tick + self._fault.span_ticks, level))
        while self._coming and self._coming[0][0] <= tick:
            self._read = self._coming.popleft()[1]
        return self._read

    def next_tick(self, tick: int) -> int:
        return self._coming[0][0] if self._coming else _FAR


class _Bouncing(_Effect):
    __slots__ = ("_edges", "_toggles")

    def __init__(self, fault: DisturbInput, tick: int, level: Value, chance: _Chance) -> None:
        super().__init__(fault, tick, level, chance)
        self._edges = 0
        self._toggles: list[int] = []
        """Ticks at which the level toggles after the last edge."""

    def read(self, tick: int, level: Value) -> Value:
        if level != self._level:
            self._level = level
            self._edges += 1
            self._toggles = self._drawn(tick)
        passed = sum(at <= tick for at in self._toggles)
        return not level if passed % 2 else level

    def _drawn(self, tick: int) -> list[int]:
        """Return twice as many different ticks as there are bounces, within the settling time."""
        ticks = list(range(tick + 1, tick + self._fault.span_ticks + 1))
        for place in range(2 * self._fault.bounces):
            other = place + self._chance.word(self._edges, place) % (len(ticks) - place)
            ticks[place], ticks[other] = ticks[other], ticks[place]
        return sorted(ticks[: 2 * self._fault.bounces])

    def next_tick(self, tick: int) -> int:
        return next((at for at in self._toggles if at > tick), _FAR)


class _Flipping(_Effect):
    """`noisy` of a digital input: the time from one flip to the next is distributed geometrically."""

    __slots__ = ("_flip", "_flips", "_rest")

    def __init__(self, fault: DisturbInput, tick: int, level: Value, chance: _Chance) -> None:
        super().__init__(fault, tick, level, chance)
        share = fault.amount * PERIOD_S
        self._rest = log1p(-share) if share < 1.0 else 0.0
        """Logarithm of the share of ticks without a flip; 0 if every tick has one."""
        self._flips = 0
        self._flip = fault.begin_tick - 1 + self._gap()

    def _gap(self) -> int:
        if not self._rest:
            return 1
        return max(1, ceil(log(self._chance.share(self._flips)) / self._rest))

    def read(self, tick: int, level: Value) -> Value:
        while self._flip < tick:
            self._flips += 1
            self._flip += self._gap()
        return not level if self._flip == tick else level

    def next_tick(self, tick: int) -> int:
        return self._flip if self._flip > tick else tick + 1


class _Periodic(_Effect):
    """A fault that changes an analog level once in each of its periods."""

    __slots__ = ()

    def _period(self, tick: int) -> int:
        return (tick - self._fault.begin_tick) // self._fault.span_ticks

    def next_tick(self, tick: int) -> int:
        return self._fault.begin_tick + (self._period(tick) + 1) * self._fault.span_ticks


class _Noisy(_Periodic):
    __slots__ = ()

    def read(self, tick: int, level: Value) -> Value:
        return level + self._fault.amount * self._chance.normal(self._period(tick))


class _Drifting(_Periodic):
    __slots__ = ()

    def _deviation(self, tick: int) -> float:
        deviation = self._fault.amount * self._period(tick) * self._fault.span_ticks / TICKS_PER_S
        bound = self._fault.bound
        return deviation if bound is None else min(max(deviation, -bound), bound)

    def read(self, tick: int, level: Value) -> Value:
        return level + self._deviation(tick)

    def next_tick(self, tick: int) -> int:
        bound = self._fault.bound
        if bound is not None and abs(self._deviation(tick)) >= bound:
            return _FAR
        return super().next_tick(tick)


_DIGITAL: Final[dict[str, type[_Effect]]] = {
    "stuck": _Stuck,
    "inverted": _Inverted,
    "bouncing": _Bouncing,
    "open_wire": _OpenWire,
    "noisy": _Flipping,
    "late": _Late,
}
_ANALOG: Final[dict[str, type[_Effect]]] = {
    "stuck": _Stuck,
    "open_wire": _OpenWire,
    "drifting": _Drifting,
    "noisy": _Noisy,
    "late": _Late,
}
EFFECTS: Final = {"bool": _DIGITAL, "float": _ANALOG}
"""Classes of faults by kind of input and of fault."""


class _Scheduled:
    """A fault with its begin and end."""

    __slots__ = ("effect", "end", "fault", "number")

    def __init__(self, fault: DisturbInput, number: int) -> None:
        self.fault = fault
        self.number = number
        self.end = _FAR if fault.ticks is None else fault.begin_tick + fault.ticks
        self.effect: _Effect | None = None
        """None until it begins."""


class _Input:
    """One input with at least one active or scheduled fault."""

    __slots__ = ("index", "name", "physical", "scheduled")

    def __init__(self, name: str, index: int, physical: Value) -> None:
        self.name = name
        self.index = index
        self.physical = physical
        self.scheduled: list[_Scheduled] = []

    def read(self, tick: int, highest: float) -> Value:
        """End and begin the faults that are due, and return the level that the robot reads."""
        self.scheduled = [scheduled for scheduled in self.scheduled if scheduled.end > tick]
        level = self.physical
        # In the order in which they begin, not in that of the requests.
        for scheduled in sorted(self.scheduled, key=lambda scheduled: (scheduled.fault.begin_tick, scheduled.number)):
            fault = scheduled.fault
            if fault.begin_tick > tick:
                break
            if scheduled.effect is None:
                effect = EFFECTS[SIGNALS[self.name].kind][fault.kind]
                scheduled.effect = effect(fault, tick, level, _Chance(fault.seed, scheduled.number))
            level = scheduled.effect.read(tick, level)
        if isinstance(level, bool) or level == self.physical:
            return level
        return min(max(level, 0.0), highest)

    def next_tick(self, tick: int) -> int:
        due = _FAR
        for scheduled in self.scheduled:
            due = min(due, scheduled.end)
            due = min(due, scheduled.fault.begin_tick if scheduled.effect is None else scheduled.effect.next_tick(tick))
        return due


class InputFaults:
    """Applies the faults of the inputs of one robot.

    Args:
        clock: gives the present tick.
        highest: gives the highest level, V or A, that an analog input can read, from family and index.
        show: takes the levels that the robot reads.
    """

    __slots__ = ("_clock", "_due", "_highest", "_inputs", "_number", "_show")

    def __init__(self, clock: Callable[[], int], highest: Callable[[str, int], float], show: Show) -> None:
        self._clock = clock
        self._highest = highest
        self._show = show
        self._inputs: dict[tuple[str, int], _Input] = {}
        self._number = 0
        """Faults so far."""
        self._due = _FAR

    def add(self, fault: DisturbInput, physical: Value) -> None:
        """Add a fault; it acts at once if its time has begun, and never if its time is over.

        Args:
            fault: its parameters.
            physical: level applied to an input that has no other fault.
        """
        found = self._inputs.setdefault((fault.name, fault.index), _Input(fault.name, fault.index, physical))
        found.scheduled.append(_Scheduled(fault, self._number))
        self._number += 1
        self._update(found, is_fault=True)
        self._plan()

    def end(self) -> None:
        """End all faults: every input reads the applied level again."""
        inputs, self._inputs = self._inputs, {}
        self._due = _FAR
        for found in inputs.values():
            self._show(found.name, found.index, found.physical, True)

    def take(self, name: str, index: int, level: Value) -> bool:
        """Apply a level to an input if it has faults; return whether it has."""
        found = self._inputs.get((name, index))
        if found is None:
            return False
        found.physical = level
        self._update(found, is_fault=False)
        self._plan()
        return True

    def physical(self, name: str, index: int) -> Value | None:
        """Return the level applied to an input that has faults; None for other inputs."""
        found = self._inputs.get((name, index))
        return None if found is None else found.physical

    @property
    def next_tick(self) -> int | None:
        """Next tick at which another level may be read though the same one is applied."""
        return None if self._due == _FAR else self._due

    def run_tick(self, tick: int) -> bool:
        """Update the faults that are due, before levels are applied in the tick; return whether there were any."""
        if tick < self._due:
            return False
        for found in list(self._inputs.values()):
            self._update(found, is_fault=True)
        self._plan()
        return True

    def _update(self, found: _Input, *, is_fault: bool) -> None:
        level = found.read(self._clock(), self._highest(found.name, found.index))
        if not found.scheduled:
            del self._inputs[found.name, found.index]
        self._show(found.name, found.index, level, is_fault or level != found.physical)

    def _plan(self) -> None:
        tick = self._clock()
        self._due = min((found.next_tick(tick) for found in self._inputs.values()), default=_FAR)
