"""What a property is: what it needs to see of a run, what watches one run, and the verdict.

Expressions, Python functions and the built-in properties of sweeps have this form.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final, Protocol

from elitescript.messages.motion import Six
from elitescript.messages.signals import Value
from elitescript.messages.state import ZERO_SIX
from elitescript.records import field, record

if TYPE_CHECKING:
    from elitescript.run import Run


class Undefined(Exception):
    """An expression has no value: a division by zero, a global that is not there; the reason is its text."""


@record
class Needs:
    """What a watch is shown of a run besides its record.

    Attributes:
        signals: names of the signals whose levels decide it, each as `signal_name` writes it.
        line: the line of the main thread.
        time: the time, in every tick, whether anything changes or not.
        joints: joint positions, in every tick in which the arm moves.
        speeds: joint speeds, likewise.
        pose: pose of the TCP, likewise.
        tcp_speed: speed of the TCP, likewise.
    """

    signals: frozenset[str] = frozenset()
    line: bool = False
    time: bool = False
    joints: bool = False
    speeds: bool = False
    pose: bool = False
    tcp_speed: bool = False

    @property
    def rows(self) -> bool:
        """Whether it needs each tick in which the arm moves."""
        return self.joints or self.speeds or self.pose or self.tcp_speed

    @property
    def nothing(self) -> bool:
        """Whether the record at the end is enough."""
        return not (self.signals or self.line or self.time or self.rows)

    def with_those_of(self, other: Needs) -> Needs:
        """Return what either needs."""
        return Needs(
            self.signals | other.signals,
            self.line or other.line,
            self.time or other.time,
            self.joints or other.joints,
            self.speeds or other.speeds,
            self.pose or other.pose,
            self.tcp_speed or other.tcp_speed,
        )


NOTHING: Final = Needs()


class Moment:
    """A run at one tick: signals after the tick, the arm after its motion. Only what is needed is up to date.

    One object is shown for the whole run; what is read of it is to be copied.

    Attributes:
        tick: of the robot.
        t: time since the start of the run, s.
        line: of the main thread; 0 when no program runs.
        q: target joint positions, rad.
        qd: their speeds, rad/s.
        tcp: pose of the TCP, base frame, m and rad.
        tcp_speed: of the TCP, m/s.
        levels: of the signals that any watch needs, by their names.
    """

    __slots__ = ("levels", "line", "q", "qd", "t", "tcp", "tcp_speed", "tick")

    def __init__(self) -> None:
        self.tick = 0
        self.t = 0.0
        self.line = 0
        self.q: Six = ZERO_SIX
        self.qd: Six = ZERO_SIX
        self.tcp: Six = ZERO_SIX
        self.tcp_speed = 0.0
        self.levels: dict[str, Value] = {}


@record
class Verdict:
    """What came of a property in one run.

    Attributes:
        holds: whether it held.
        margin: how far it was from the other answer, in `unit`, negative if it did not hold; None if it has none, or
            several in different units.
        unit: of the margin; empty for a number without a unit.
        t: when it was decided, or nearest to the other answer, s since the start of the run; None if it has no time.
        words: what decided it, for people; empty if there is nothing to say.
        margins: by unit, if there are several.
    """

    holds: bool
    margin: float | None = None
    unit: str = ""
    t: float | None = None
    words: str = ""
    margins: Mapping[str, float] = field(default_factory=dict)


class Watch(Protocol):
    """Watches one run for one property."""

    def see(self, moment: Moment) -> None:
        """Take in a moment: the first one, each at which something that is needed has changed, and the last one."""

    def verdict(self, run: Run, end_tick: int) -> Verdict:
        """Return what came of it, once the run is over; `end_tick` is that of the last moment."""


class Property(Protocol):
    """Something that holds of a run or does not. One object serves many runs."""

    @property
    def text(self) -> str:
        """The property as it was written."""

    @property
    def needs(self) -> Needs:
        """What its watches are shown."""

    def watch(self) -> Watch:
        """Return what watches one run."""


class MeasureWatch(Protocol):
    """Watches one run for one measure."""

    def see(self, moment: Moment) -> None:
        """Take in a moment, as `Watch.see`."""

    def value(self, run: Run, end_tick: int) -> Value | None:
        """Return the number of that run; None if it has none."""

    @property
    def reason(self) -> str:
        """Why there is no number; empty if there is one."""


class Measure(Protocol):
    """A number of each run. One object serves many runs."""

    @property
    def text(self) -> str:
        """The measure as it was written."""

    @property
    def needs(self) -> Needs:
        """What its watches are shown."""

    def watch(self) -> MeasureWatch:
        """Return what watches one run."""


def plain(value: Any, depth: int = 0) -> Any:
    """Return a value of a program as numbers, texts, lists and tables of them; objects of a program run no code here.

    Raises:
        Undefined: it is or holds something else, or is nested too deeply.
    """
    kind = type(value)
    if kind in _SCALARS:
        return value
    if depth >= _DEPTH_MAX:
        raise Undefined(f"a value is nested more than {_DEPTH_MAX} deep")
    # By the methods of the built-in types: those of a program's own classes are not called.
    if isinstance(value, list):
        return [plain(item, depth + 1) for item in list.__iter__(value)]
    if isinstance(value, tuple):
        return [plain(item, depth + 1) for item in tuple.__iter__(value)]
    if isinstance(value, dict):
        return {plain_key(key): plain(item, depth + 1) for key, item in dict.items(value)}
    if isinstance(value, set | frozenset):
        return frozenset(plain_key(item) for item in set(value))
    raise Undefined(f"a value of class {kind.__name__!r} is neither a number, a text nor a list")


def plain_key(key: Any) -> Any:
    """Return a key of a table, or an item of a set.

    Raises:
        Undefined: it is neither a number nor a text.
    """
    if type(key) in _SCALARS:
        return key
    raise Undefined(f"a key of class {type(key).__name__!r} is neither a number nor a text")


_SCALARS: Final = frozenset({bool, int, float, str, type(None)})
_DEPTH_MAX: Final = 20
