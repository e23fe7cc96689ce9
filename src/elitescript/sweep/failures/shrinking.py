"""Makes a failing run smaller: the fewest disturbances and the simplest values that still fail in the same way.

Delta debugging over the list of disturbances (Zeller, Hildebrandt 2002), then simpler kinds, then each number towards
its target with few digits, then the varied values towards the plain ones. Nothing is drawn, so the result depends on
the run and on `still_fails` alone.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from contextlib import suppress
from math import ceil, floor
from typing import Any, Final, TypeVar

from elitescript.errors import UsageError
from elitescript.messages.signals import Value
from elitescript.messages.timing import PERIOD_S
from elitescript.records import NamedTuple, replace
from elitescript.sweep.chaos.applying import check
from elitescript.sweep.plans.plan import Choices, Disturbance, Failure

Item = TypeVar("Item")

Answers = Mapping[int, bool]
"""Whether candidates fail, by their places in what was asked: those that were run, the first one at least."""

Asking = Generator[Sequence[Choices], Answers, None]
"""Asks for candidates in the order in which they are wanted, and is sent answers."""

BUDGET: Final = 200
"""Runs that making one failure smaller may take, unless it is said (*assumed*)."""

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
    search = _ddmin(items)
    found: Sequence[Item] | None = None
    try:
        asked = next(search)
        while True:
            found = next((some for some in asked if fails(some)), None)
            asked = search.send(found)
    except StopIteration as end:
        fewer: Sequence[Item] = end.value
        return fewer


def _ddmin(items: Sequence[Item]) -> Generator[list[Sequence[Item]], Sequence[Item] | None, Sequence[Item]]:
    """Yield alternatives, and be sent the first of them that still fails, or None; return the fewest items."""
    if not items or (yield [()]) is not None:
        return ()
    parts = 2
    while len(items) > 1:
        step = -(-len(items) // parts)
        chunks = [items[at : at + step] for at in range(0, len(items), step)]
        rests = [[item for other in chunks if other is not chunk for item in other] for chunk in chunks]
        if (smaller := (yield list(chunks))) is not None:
            items, parts = smaller, 2
        elif len(chunks) > 2 and (smaller := (yield list(rests))) is not None:
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

    def answered(asked: Sequence[Choices]) -> bool:
        try:
            return still_fails(asked[0])
        except UsageError:
            return False

    search = Shrinking(choices, plain=plain, budget=budget)
    while search.asked:
        search.answer({0: answered(search.asked)})
    return search.result


class Shrinking:
    """Makes one failing run smaller, question by question; its caller runs the candidates.

    What comes out depends on the answers alone, not on how many candidates are run at the same time: those that are
    run beside the first one count as tried when they are wanted, and not otherwise.

    Args:
        choices: of a run that fails.
        plain: see `shrink`.
        budget: see there.

    Attributes:
        asked: candidates in the order in which they may be wanted, the first one for certain; empty at the end.
    """

    __slots__ = ("_asking", "_is_complete", "_search", "asked")

    def __init__(
        self, choices: Choices, *, plain: Mapping[str, Value | str] | None = None, budget: int = BUDGET
    ) -> None:
        self._search = _Search(choices, budget)
        self._asking = self._search.everything(plain or {})
        self._is_complete = False
        self.asked: Sequence[Choices] = ()
        self._go_on(None)

    def answer(self, answers: Answers) -> None:
        """Take whether candidates of `asked` fail, the first one at least."""
        self._go_on(answers)

    @property
    def result(self) -> Shrunk:
        """The smallest choices so far."""
        return Shrunk(self._search.best, self._search.runs, self._is_complete)

    def _go_on(self, answers: Answers | None) -> None:
        try:
            # A generator that has just begun takes nothing but None.
            self.asked = next(self._asking) if answers is None else self._asking.send(answers)
        except StopIteration:
            self.asked, self._is_complete = (), True
        except _OutOfBudget:
            self.asked = ()


class _Search:
    """Holds the smallest choices so far, and what was tried."""

    __slots__ = ("_budget", "_known", "_tried", "best", "runs")

    def __init__(self, choices: Choices, budget: int) -> None:
        self.best = choices
        self.runs = 0
        self._budget = budget
        self._tried: dict[str, bool] = {_key(choices): True}
        self._known: dict[str, bool] = {}
        """Of candidates that were run beside others."""

    def everything(self, plain: Mapping[str, Value | str]) -> Asking:
        """Make the run smaller in every way, again and again."""
        for _ in range(_ROUNDS):
            before = self.best
            yield from self.fewer()
            yield from self.simpler()
            yield from self.smaller()
            yield from self.plainer(plain)
            if self.best == before:
                break

    def first(
        self, candidates: Sequence[Choices], perhaps: Sequence[Choices] = ()
    ) -> Generator[Sequence[Choices], Answers, Choices | None]:
        """Return the first candidate that still fails, which is the best then; None if all hold.

        Args:
            candidates: in their order.
            perhaps: what may be wanted next.
        """
        for place, candidate in enumerate(candidates):
            key = _key(candidate)
            if key not in self._tried:
                if not _makes_sense(candidate):
                    self._tried[key] = False
                    continue
                if self.runs >= self._budget:
                    raise _OutOfBudget
                if key not in self._known:
                    asked = self._unknown(candidate, (*candidates[place + 1 :], *perhaps))
                    answers = yield asked
                    self._known |= {_key(asked[at]): fails for at, fails in answers.items()}
                self.runs += 1
                self._tried[key] = self._known[key]
            if self._tried[key]:
                self.best = candidate
                return candidate
        return None

    def _unknown(self, candidate: Choices, others: Sequence[Choices]) -> list[Choices]:
        """Return a candidate, and those of others that would have to be run."""
        found = {_key(candidate): candidate}
        for other in others:
            key = _key(other)
            if key not in self._tried and key not in self._known and _makes_sense(other):
                found.setdefault(key, other)
        return list(found.values())

    def _with(self, disturbances: Sequence[Disturbance]) -> Choices:
        return replace(self.best, disturbances=tuple(disturbances))

    def _with_one(self, index: int, disturbance: Disturbance) -> Choices:
        found = list(self.best.disturbances)
        found[index] = disturbance
        return self._with(found)

    # ---------------------------------------------------------------- fewer disturbances

    def fewer(self) -> Asking:
        """Leave out what is not needed (ddmin)."""
        search = _ddmin(self.best.disturbances)
        with suppress(StopIteration):
            asked = next(search)
            while True:
                found = yield from self.first([self._with(some) for some in asked])
                asked = search.send(None if found is None else found.disturbances)

    # ---------------------------------------------------------------- simpler kinds

    def simpler(self) -> Asking:
        """Replace kinds and settings by simpler ones."""
        for index in range(len(self.best.disturbances)):
            for simpler in (_simpler_kinds, _one_message):
                yield from self.first([self._with_one(index, one) for one in simpler(self.best.disturbances[index])])
            for change in (_to_robot, _to_device, _later, _plain_reply):
                changed = change(self.best.disturbances[index])
                if changed is not None:
                    yield from self.first([self._with_one(index, changed)])

    # ---------------------------------------------------------------- smaller numbers

    def smaller(self) -> Asking:
        """Bring each number towards its target."""
        for index in range(len(self.best.disturbances)):
            for name, target in _TARGETS.items():
                value = _number(self.best.disturbances[index], name)
                if value is None:
                    continue
                if name == "for_s":
                    target = min(value, target)

                def made(number: float, index: int = index, name: str = name) -> Choices:
                    return self._with_one(index, _with_number(self.best.disturbances[index], name, number))

                yield from self._number(value, target, made, is_time=name.endswith("_s") and name != "per_s")

    # ---------------------------------------------------------------- plainer values

    def plainer(self, plain: Mapping[str, Value | str]) -> Asking:
        """Bring each varied value towards the plain one."""
        for name, target in plain.items():
            value = self.best.values.get(name, target)

            def made(changed: Any, name: str = name) -> Choices:
                return replace(self.best, values={**self.best.values, name: changed})

            if _is_number(value) and _is_number(target):
                yield from self._number(value, target, made)  # type: ignore[arg-type]
            elif value != target:
                yield from self.first([made(target)])

    def _number(self, value: float, target: float, made: Callable[[Any], Choices], *, is_time: bool = False) -> Asking:
        """Bring a number towards its target: there, then half way again and again, then to the fewest digits."""
        is_whole = isinstance(value, int) and isinstance(target, int)

        def between(good: float, bad: float) -> float:
            return _rounded((good + bad) / 2, is_whole=is_whole, is_time=is_time)

        if value == target or (yield from self.first([made(target)], [made(between(value, target))])):
            return
        good, bad = value, target
        for _ in range(_HALVINGS):
            middle = between(good, bad)
            if middle in (good, bad):
                break
            # One of both is wanted next, unless this was the last one.
            perhaps = [made(between(middle, bad)), made(between(good, middle))]
            if (yield from self.first([made(middle)], perhaps)):
                good = middle
            else:
                bad = middle
        if is_whole:
            return
        wanted: list[float] = []
        for step in (1.0, 0.1) if is_time else _steps(good):
            candidates = (floor(good / step) * step, ceil(good / step) * step)
            # The one that is nearer to the target first; none is beyond the number that there was.
            for candidate in sorted((round(at, 9) for at in candidates), key=lambda at: abs(at - target)):
                if min(value, target) <= candidate <= max(value, target):
                    wanted.append(candidate)
        yield from self.first([made(candidate) for candidate in wanted])


def _makes_sense(choices: Choices) -> bool:
    """Return whether every disturbance has settings that it may have."""
    try:
        for disturbance in choices.disturbances:
            check(disturbance)
    except UsageError:
        return False
    return True


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
