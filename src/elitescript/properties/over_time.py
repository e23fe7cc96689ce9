"""Functions over time: what each keeps of the moments that it is shown, and what it comes to at the end.

A state holds from the moment that shows it until the next moment: moments come whenever anything that the expression
names has changed.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isinf
from typing import Any, Final, Protocol

from elitescript.messages.timing import seconds
from elitescript.properties.pieces import LEVEL, NUMBER, TRUTH, Margin, MarginKey, Piece, margin_of, number
from elitescript.properties.units import S, Unit
from elitescript.properties.verdicts import Moment, Undefined
from elitescript.records import NamedTuple

BEFORE_KEY: Final = MarginKey(S, "")

_UNDEFINED: Final = (Undefined, ArithmeticError, ValueError, TypeError)


class Part(NamedTuple):
    """A checked argument: true or false, or a number, of a moment."""

    text: str
    value: Any
    keys: tuple[MarginKey, ...]
    margins: tuple[Margin, ...]


def part_of(piece: Piece, text: str) -> Part:
    """Return an argument; `text` is what was written."""
    keys = tuple(piece.margins)
    return Part(text, piece.value, keys, tuple(margin_of(piece, key) for key in keys))


class Watched(Protocol):
    """What one function over time keeps of one run."""

    def see(self, moment: Moment) -> None:
        """Take in a moment."""

    def finish(self, end_tick: int) -> None:
        """End the run at a tick, whose moment has been shown."""

    def value(self) -> Any:
        """Return what the function comes to. Raises Undefined if that is nothing."""

    def margin(self, index: int) -> float:
        """Return the margin for the key at an index of `keys`, of a function that is true or false."""

    @property
    def t(self) -> float | None:
        """The moment that decided it, s."""

    def words(self) -> str:
        """Return what happened, for people, without the margin."""


class _Reduced:
    """Base of `always` and `eventually`: the extreme of the margins, and the first moment that decides."""

    __slots__ = ("_decisive", "_keys", "_margins", "_part", "_reason", "_worst", "_worst_t", "first_t")

    sign = 1.0
    """1 for the least margin, -1 for the greatest."""

    def __init__(self, part: Part) -> None:
        self._part = part
        self._keys = range(len(part.keys))
        self._margins = part.margins
        self._worst = [inf] * len(part.keys)
        """Least margin so far, of each key; of its opposite for `eventually`."""
        self._worst_t = [0.0] * len(part.keys)
        self.first_t: float | None = None
        """First moment at which `always` does not hold any more, or `eventually` holds."""
        self._reason = ""

    def see(self, moment: Moment) -> None:
        sign = self.sign
        try:
            if not self._keys:
                if self.first_t is None and bool(self._part.value(moment)) == (sign < 0.0):
                    self.first_t = moment.t
                return
            margin = 0.0
            for index in self._keys:
                margin = sign * self._margins[index](moment)
                if margin < self._worst[index]:
                    self._worst[index], self._worst_t[index] = margin, moment.t
            if self.first_t is None and margin <= 0.0:
                # The margin says it by its sign, but at the edge itself.
                if margin < 0.0 or bool(self._part.value(moment)) == (sign < 0.0):
                    self.first_t = moment.t
            elif margin != margin:
                raise Undefined(f"{self._part.text} compares with what is no number (nan)")
        except _UNDEFINED as error:
            self._see_undefined(moment, error)

    def _see_undefined(self, moment: Moment, error: Exception) -> None:
        """Take in a moment at which a part has no value; one that `and` and `or` do not come to does not matter."""
        try:
            holds = bool(self._part.value(moment))
        except _UNDEFINED:
            holds = False
            self._reason = self._reason or f"{error} at {moment.t:.3f} s"
        if self.first_t is None and holds == (self.sign < 0.0):
            self.first_t = moment.t
        for index in self._keys:
            margin = self.sign * (inf if holds else -inf)
            if margin < self._worst[index]:
                self._worst[index], self._worst_t[index] = margin, moment.t

    def finish(self, end_tick: int) -> None:
        """Nothing is left to do."""

    def margin(self, index: int) -> float:
        return self.sign * self._worst[index] + 0.0

    @property
    def t(self) -> float | None:
        return self._worst_t[0] if len(self._worst) == 1 and not isinf(self._worst[0]) else self.first_t


class Always(_Reduced):
    """`always(e)`: whether e holds at every moment."""

    __slots__ = ()

    def value(self) -> bool:
        return self.first_t is None

    def words(self) -> str:
        if self._reason:
            return self._reason
        if self.first_t is None:
            return f"{self._part.text} holds all the time"
        return f"{self._part.text} does not hold at {self.first_t:.3f} s"


class Eventually(_Reduced):
    """`eventually(e)`: whether e holds at any moment."""

    __slots__ = ()
    sign = -1.0

    def value(self) -> bool:
        return self.first_t is not None

    def words(self) -> str:
        if self.first_t is not None:
            return f"{self._part.text} holds at {self.first_t:.3f} s"
        return f"{self._part.text} never holds" + (f": {self._reason}" if self._reason else "")


class _FirstTime:
    """The first moment at which something holds."""

    __slots__ = ("part", "reason", "t", "tick")

    def __init__(self, part: Part) -> None:
        self.part = part
        self.tick: int | None = None
        self.t: float | None = None
        self.reason = ""

    def see(self, moment: Moment) -> None:
        if self.tick is not None:
            return
        try:
            if self.part.value(moment):
                self.tick, self.t = moment.tick, moment.t
        except _UNDEFINED as error:
            self.reason = self.reason or f"{error} at {moment.t:.3f} s"


class Before:
    """`before(a, b)`: whether a first holds at an earlier or the same tick than b, or b never does."""

    __slots__ = ("_first", "_second")

    def __init__(self, first: Part, second: Part) -> None:
        self._first, self._second = _FirstTime(first), _FirstTime(second)

    def see(self, moment: Moment) -> None:
        self._first.see(moment)
        self._second.see(moment)

    def finish(self, end_tick: int) -> None:
        """Nothing is left to do."""

    def value(self) -> bool:
        first, second = self._first.tick, self._second.tick
        return second is None or (first is not None and first <= second)

    def margin(self, index: int) -> float:
        first, second = self._first.tick, self._second.tick
        if first is None or second is None:
            return inf if second is None else -inf
        return seconds(second - first)

    @property
    def t(self) -> float | None:
        return self._second.t

    def words(self) -> str:
        return "; ".join(
            f"{one.part.text} first holds at {one.t:.3f} s"
            if one.t is not None
            else f"{one.part.text} never holds" + (f" ({one.reason})" if one.reason else "")
            for one in (self._first, self._second)
        )


class First(_FirstTime):
    """`first(e)`: the time at which e first holds, s."""

    __slots__ = ()

    def finish(self, end_tick: int) -> None:
        """Nothing is left to do."""

    def value(self) -> float:
        if self.t is None:
            raise Undefined(self.words())
        return self.t

    def margin(self, index: int) -> float:
        raise AssertionError("a number has no margin")

    def words(self) -> str:
        if self.t is None:
            return f"{self.part.text} never holds" + (f": {self.reason}" if self.reason else "")
        return f"{self.part.text} first holds at {self.t:.3f} s"


class _Held:
    """Base of `duration` and `count`: follows whether something holds."""

    __slots__ = ("_begin", "_count", "_holds", "_part", "_reason", "_ticks", "t")

    def __init__(self, part: Part) -> None:
        self._part = part
        self._holds = False
        self._begin = 0
        self._ticks = 0
        self._count = 0
        self._reason = ""
        self.t: float | None = None

    def see(self, moment: Moment) -> None:
        try:
            holds = bool(self._part.value(moment))
        except _UNDEFINED as error:
            holds = False
            self._reason = self._reason or f"{error} at {moment.t:.3f} s"
        if holds is not self._holds:
            if holds:
                self._begin, self._count = moment.tick, self._count + 1
                self.t = moment.t
            else:
                self._ticks += moment.tick - self._begin
            self._holds = holds

    def finish(self, end_tick: int) -> None:
        """Let what still holds end with the run."""
        if self._holds:
            self._ticks += end_tick - self._begin
            self._begin = end_tick

    def margin(self, index: int) -> float:
        raise AssertionError("a number has no margin")

    def _checked(self) -> None:
        if self._reason:
            raise Undefined(self._reason)


class Duration(_Held):
    """`duration(e)`: for how long e holds altogether, s."""

    __slots__ = ()

    def value(self) -> float:
        self._checked()
        return seconds(self._ticks)

    def words(self) -> str:
        return f"{self._part.text} holds for {seconds(self._ticks):.3f} s"


class Count(_Held):
    """`count(e)`: how often e begins to hold; a beginning at the start counts."""

    __slots__ = ()

    def value(self) -> int:
        self._checked()
        return self._count

    def words(self) -> str:
        times = "once" if self._count == 1 else f"{self._count} times"
        return f"{self._part.text} begins to hold {times}"


class _Extreme:
    """Base of `max_of` and `min_of`."""

    __slots__ = ("_best", "_part", "_reason", "t")
    sign = 1.0

    def __init__(self, part: Part) -> None:
        self._part = part
        self._best: Any = None
        self._reason = ""
        self.t: float | None = None

    def see(self, moment: Moment) -> None:
        try:
            value = self._part.value(moment)
            if self._best is None or self.sign * value > self.sign * self._best:
                self._best, self.t = +number(value, self._part.text), moment.t
            elif value != value:
                number(value, self._part.text)
        except _UNDEFINED as error:
            self._reason = self._reason or f"{error} at {moment.t:.3f} s"

    def finish(self, end_tick: int) -> None:
        """Nothing is left to do."""

    def value(self) -> Any:
        if self._reason:
            raise Undefined(self._reason)
        return self._best

    def margin(self, index: int) -> float:
        raise AssertionError("a number has no margin")

    def words(self) -> str:
        best = "nothing" if self._best is None else f"{self._best:.6g}"
        return f"{self._part.text} reaches {best} at {self.t or 0.0:.3f} s"


class MaxOf(_Extreme):
    """`max_of(e)`: the greatest value of e."""

    __slots__ = ()


class MinOf(_Extreme):
    """`min_of(e)`: the least value of e."""

    __slots__ = ()
    sign = -1.0


class OverTimeFunction(NamedTuple):
    """A function over time."""

    make: Any
    """Makes what watches one run, from its arguments."""
    takes: frozenset[str]
    """Kinds of its arguments."""
    arguments: int
    kind: str
    """Of its value."""
    summary: str
    unit: Unit = None
    keeps_unit: bool = False
    """Whether its value has the unit of its argument."""


_TRUTHS: Final = frozenset({TRUTH, LEVEL})
_NUMBERS: Final = frozenset({NUMBER, LEVEL})

FUNCTIONS_OVER_TIME: Final[dict[str, OverTimeFunction]] = {
    "always": OverTimeFunction(Always, _TRUTHS, 1, TRUTH, "whether it holds at every moment"),
    "eventually": OverTimeFunction(Eventually, _TRUTHS, 1, TRUTH, "whether it holds at any moment"),
    "before": OverTimeFunction(
        Before,
        _TRUTHS,
        2,
        TRUTH,
        "whether the first holds no later than the second first does, or the second never does",
    ),
    "max_of": OverTimeFunction(MaxOf, _NUMBERS, 1, NUMBER, "greatest value", keeps_unit=True),
    "min_of": OverTimeFunction(MinOf, _NUMBERS, 1, NUMBER, "least value", keeps_unit=True),
    "first": OverTimeFunction(
        First, _TRUTHS, 1, NUMBER, "time at which it first holds, s; no value if it never does", S
    ),
    "duration": OverTimeFunction(Duration, _TRUTHS, 1, NUMBER, "for how long it holds altogether, s", S),
    "count": OverTimeFunction(Count, _TRUTHS, 1, NUMBER, "how often it begins to hold"),
}
"""By name."""


def keys_over_time(name: str, parts: Sequence[Piece]) -> tuple[MarginKey, ...]:
    """Return the keys of the margins of a function over time."""
    if name == "before":
        return (BEFORE_KEY,)
    return tuple(parts[0].margins) if FUNCTIONS_OVER_TIME[name].kind == TRUTH else ()
