"""Makes a failing run smaller: the fewest disturbances and the simplest values that still fail in the same way.

Delta debugging over the list of disturbances (Zeller, Hildebrandt 2002), then simpler kinds, then each number towards
its target with few digits, then the varied values towards the plain ones. Nothing is drawn, so the result depends on
the run and on `still_fails` alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import ceil, floor
from typing import Any, Final, TypeVar

from elitescript.errors import UsageError
from elitescript.messages.signals import Value
from elitescript.messages.timing import PERIOD_S
from elitescript.records import NamedTuple, replace
from elitescript.sweep.chaos.applying import check
from elitescript.sweep.plans.plan import Choices, Disturbance, Failure

Item = TypeVar("Item")

BUDGET: Final = 200
"""Runs that shrinking may take."""

_HALVINGS: Final = 6
_ROUNDS: Final = 3
_DIGITS: Final = 4

SIMPLER_KINDS: Final[Mapping[str, tuple[str, ...]]] = {
    "corrupt": ("drop",),
    "wrong_reply": ("drop",),
    "duplicate": ("drop",),
    "silence": ("drop",),
    "disconnect": ("drop",),
    "trickle": ("drop", "delay"),
    "noisy": ("stuck",),
    "bouncing": ("stuck",),
    "inverted": ("stuck",),
    "open_wire": ("stuck",),
    "drifting": ("stuck",),
    "reduced_mode": ("slider",),
}
"""For a kind, those that are easier to understand and to bring about, the simplest first."""

_MESSAGES: Final = ("drop", "delay", "duplicate", "corrupt", "trickle", "wrong_reply")
_FIRST: Final[tuple[Mapping[str, int], ...]] = ({}, {"nth": 2}, {"nth": 3})
"""Of messages: the first one, the second, the third."""

_TARGETS: Final[Mapping[str, float]] = {
    "at_s": 0.0,
    "for_s": 0.1,
    "nth": 1,
    "count": 1,
    "chunk": 1,
    "bounces": 1,
    "axis": 0,
    "fraction": 1.0,
    "force_n": 0.0,
    "delay_s": PERIOD_S,
    "settle_s": PERIOD_S,
    "every_s": PERIOD_S,
    "sigma": 0.0,
    "rate_hz": 0.0,
    "per_s": 0.0,
    "bound": 0.0,
}
"""What each number of a disturbance goes towards."""


class Shrunk(NamedTuple):
    """The result of shrinking.

    Attributes:
        choices: the smallest that still fail.
        runs: how many were tried.
        is_complete: whether everything was tried; else the budget was used up before.
    """

    choices: Choices
    runs: int
    is_complete: bool


class _OutOfBudget(Exception):
    """So many runs were tried as there may be."""


def is_same(failure: Failure | None, other: Failure) -> bool:
    """Return whether a run failed in the same way as another one.

    That is the same property, and the same alarm in the same line; the disturbances are what shrinking changes.
    """
    return failure is not None and (
        failure.expression,
        failure.state,
        failure.code,
        failure.line,
    ) == (other.expression, other.state, other.code, other.line)


def fewest(items: Sequence[Item], fails: Callable[[Sequence[Item]], bool]) -> Sequence[Item]:
    """Return the fewest of some items, in their order, that still fail (ddmin): none of them can be left out.

    Args:
        items: that fail together.
        fails: returns whether some of them still fail.
    """
    if not items or fails(()):
        return ()
    parts = 2
    while len(items) > 1:
        step = -(-len(items) // parts)
        chunks = [items[at : at + step] for at in range(0, len(items), step)]
        rests = [[item for other in chunks if other is not chunk for item in other] for chunk in chunks]
        if smaller := next((chunk for chunk in chunks if fails(chunk)), None):
            items, parts = smaller, 2
        elif len(chunks) > 2 and (smaller := next((rest for rest in rests if fails(rest)), None)):
            items, parts = smaller, max(parts - 1, 2)
        elif step == 1:
            break
        else:
            parts = min(2 * parts, len(items))
    return items


def shrink(
    choices: Choices,
    still_fails: Callable[[Choices], bool],
    *,
    plain: Mapping[str, Value | str] | None = None,
    budget: int = BUDGET,
) -> Shrunk:
    """Return the smallest choices that still fail.

    Args:
        choices: of a run that fails.
        still_fails: runs the program with choices, and returns whether it fails in the same way; may raise
            `UsageError` for choices that make no sense.
        plain: for each varied value the plain one: the middle, the default or the first choice.
        budget: runs that may be tried.
    """
    search = _Search(choices, still_fails, budget)
    try:
        for _ in range(_ROUNDS):
            before = search.best
            search.fewer()
            search.simpler()
            search.smaller()
            search.plainer(plain or {})
            if search.best == before:
                break
    except _OutOfBudget:
        return Shrunk(search.best, search.runs, False)
    return Shrunk(search.best, search.runs, True)


class _Search:
    """Holds the smallest choices so far, and what was tried."""

    __slots__ = ("_budget", "_still_fails", "_tried", "best", "runs")

    def __init__(self, choices: Choices, still_fails: Callable[[Choices], bool], budget: int) -> None:
        self.best = choices
        self.runs = 0
        self._budget = budget
        self._still_fails = still_fails
        self._tried: dict[str, bool] = {_key(choices): True}

    def fails(self, choices: Choices) -> bool:
        """Return whether choices still fail; then they are the best ones."""
        key = _key(choices)
        if key not in self._tried:
            try:
                for disturbance in choices.disturbances:
                    check(disturbance)
                if self.runs >= self._budget:
                    raise _OutOfBudget
                self.runs += 1
                self._tried[key] = self._still_fails(choices)
            except UsageError:
                self._tried[key] = False
        if self._tried[key]:
            self.best = choices
        return self._tried[key]

    def _with(self, disturbances: Sequence[Disturbance]) -> Choices:
        return replace(self.best, disturbances=tuple(disturbances))

    def _with_one(self, index: int, disturbance: Disturbance) -> Choices:
        found = list(self.best.disturbances)
        found[index] = disturbance
        return self._with(found)

    # ---------------------------------------------------------------- fewer disturbances

    def fewer(self) -> None:
        """Leave out what is not needed (ddmin)."""
        # What fails becomes the best of the search, so the result is there already.
        fewest(self.best.disturbances, lambda items: self.fails(self._with(items)))

    # ---------------------------------------------------------------- simpler kinds

    def simpler(self) -> None:
        """Replace kinds and settings by simpler ones."""
        for index in range(len(self.best.disturbances)):
            for candidate in _simpler_kinds(self.best.disturbances[index]):
                if self.fails(self._with_one(index, candidate)):
                    break
            for candidate in _one_message(self.best.disturbances[index]):
                if self.fails(self._with_one(index, candidate)):
                    break
            for change in (_to_robot, _to_device, _later, _plain_reply):
                changed = change(self.best.disturbances[index])
                if changed is not None:
                    self.fails(self._with_one(index, changed))

    # ---------------------------------------------------------------- smaller numbers

    def smaller(self) -> None:
        """Bring each number towards its target."""
        for index in range(len(self.best.disturbances)):
            for name, target in _TARGETS.items():
                value = _number(self.best.disturbances[index], name)
                if value is None:
                    continue
                if name == "for_s":
                    target = min(value, target)

                def tried(number: float, index: int = index, name: str = name) -> bool:
                    return self.fails(self._with_one(index, _with_number(self.best.disturbances[index], name, number)))

                _search_number(value, target, tried, is_time=name.endswith("_s") and name != "per_s")

    # ---------------------------------------------------------------- plainer values

    def plainer(self, plain: Mapping[str, Value | str]) -> None:
        """Bring each varied value towards the plain one."""
        for name, target in plain.items():
            value = self.best.values.get(name, target)

            def tried(changed: Any, name: str = name) -> bool:
                return self.fails(replace(self.best, values={**self.best.values, name: changed}))

            if _is_number(value) and _is_number(target):
                _search_number(value, target, tried)  # type: ignore[arg-type]
            elif value != target:
                tried(target)


def _key(choices: Choices) -> str:
    """Return a text that is the same for equal choices alone."""
    items = [
        (item.kind, item.on, item.at_s, item.for_s, sorted(item.settings.items())) for item in choices.disturbances
    ]
    return repr((sorted(choices.values.items()), items))


# ---------------------------------------------------------------- kinds and settings


def _simpler_kinds(disturbance: Disturbance) -> Iterator[Disturbance]:
    """Yield the same disturbance as a simpler kind: one message of those that it meets, or a level."""
    for kind in SIMPLER_KINDS.get(disturbance.kind, ()):
        base = replace(disturbance, kind=kind, settings={})
        if kind in _MESSAGES:
            kept = {"count": 1, **({"delay_s": 1.0} if kind == "delay" else {})}
            for first in _FIRST:
                for direction in ("to_robot", "to_device"):
                    yield replace(base, for_s=None, settings={**kept, **first, "direction": direction})
        elif kind == "stuck":
            values = (False, True) if "digital" in str(disturbance.on) else ()
            for value in values:
                yield replace(base, settings={"value": value})
            yield base
        elif kind == "slider":
            yield replace(base, settings={"fraction": 0.1})


def _one_message(disturbance: Disturbance) -> Iterator[Disturbance]:
    """Yield the same disturbance of one message alone: the first that it meets, or one of the next."""
    if disturbance.kind not in _MESSAGES:
        return
    settings = {name: value for name, value in disturbance.settings.items() if name != "share"}
    if settings == disturbance.settings and settings.get("count") == 1 and disturbance.for_s is None:
        return
    for first in _FIRST:
        yield replace(disturbance, for_s=None, settings={**settings, "count": 1, **first})


def _to_robot(disturbance: Disturbance) -> Disturbance | None:
    return _directed(disturbance, "to_robot")


def _to_device(disturbance: Disturbance) -> Disturbance | None:
    return _directed(disturbance, "to_device")


def _directed(disturbance: Disturbance, direction: str) -> Disturbance | None:
    if disturbance.kind not in (*_MESSAGES, "silence") or disturbance.kind == "wrong_reply":
        return None
    if disturbance.settings.get("direction", "both") != "both":
        return None
    return replace(disturbance, settings={**disturbance.settings, "direction": direction})


def _later(disturbance: Disturbance) -> Disturbance | None:
    """Return a fault without an end with one, if it is about a time."""
    if disturbance.for_s is not None or disturbance.kind in (*_MESSAGES, "protective_stop", "reconnect"):
        return None
    return replace(disturbance, for_s=10.0)


def _plain_reply(disturbance: Disturbance) -> Disturbance | None:
    if disturbance.kind != "wrong_reply" or disturbance.settings.get("form", "text") == "text":
        return None
    kept = {name: value for name, value in disturbance.settings.items() if name not in ("form", "code", "reply")}
    return replace(disturbance, settings={**kept, "form": "text", "reply": "?\r\n"})


# ---------------------------------------------------------------- numbers


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _number(disturbance: Disturbance, name: str) -> float | None:
    value = getattr(disturbance, name) if name in ("at_s", "for_s") else disturbance.settings.get(name)
    return value if _is_number(value) else None


def _with_number(disturbance: Disturbance, name: str, value: float) -> Disturbance:
    if name == "at_s":
        return replace(disturbance, at_s=value)
    if name == "for_s":
        return replace(disturbance, for_s=value)
    return replace(disturbance, settings={**disturbance.settings, name: value})


def _search_number(value: float, target: float, fails: Callable[[Any], bool], *, is_time: bool = False) -> None:
    """Bring a number towards its target: there, then half way again and again, then to the fewest digits."""
    if value == target or fails(target):
        return
    is_whole = isinstance(value, int) and isinstance(target, int)
    good, bad = value, target
    for _ in range(_HALVINGS):
        middle = _rounded((good + bad) / 2, is_whole=is_whole, is_time=is_time)
        if middle in (good, bad):
            break
        if fails(middle):
            good = middle
        else:
            bad = middle
    if is_whole:
        return
    for step in (1.0, 0.1) if is_time else _steps(good):
        candidates = (floor(good / step) * step, ceil(good / step) * step)
        # The one that is nearer to the target first; none is beyond the number that there was.
        for candidate in sorted((round(at, 9) for at in candidates), key=lambda at: abs(at - target)):
            if min(value, target) <= candidate <= max(value, target) and (candidate == good or fails(candidate)):
                return


def _steps(value: float) -> Iterator[float]:
    """Yield the units of the last digit of a number with one digit, with two, and so on."""
    power = 0
    size = abs(value)
    while size >= 10.0:
        size, power = size / 10.0, power + 1
    while 0.0 < size < 1.0:
        size, power = size * 10.0, power - 1
    for digits in range(_DIGITS):
        yield float(f"1e{power - digits}")


def _rounded(value: float, *, is_whole: bool, is_time: bool) -> float:
    if is_whole:
        return int(value)
    if is_time:
        return round(round(value / PERIOD_S) * PERIOD_S, 3)
    return float(f"{value:.6g}")
