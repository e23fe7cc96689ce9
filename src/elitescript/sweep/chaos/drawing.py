"""Draws the disturbances of a run: the same for its number in every process, whatever else is drawn."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import exp, log
from typing import Any, Final, Protocol, TypeVar

from elitescript.devices.channels.faults import DIGITAL, DIRECTIONS, TABLE
from elitescript.messages.timing import PERIOD_S
from elitescript.sweep.chaos.applying import in_order
from elitescript.sweep.chaos.ground import Chance, Ground, Place
from elitescript.sweep.chaos.kinds import KINDS, Range
from elitescript.sweep.chaos.profile import Profile
from elitescript.sweep.plans.plan import Disturbance

_AT_MOMENTS: Final = 0.7
"""Share of disturbances that begin shortly before something happens at their place; the others begin at any time."""
_BEFORE_S: Final = 0.05

_Item = TypeVar("_Item")


class Source(Protocol):
    """A generator of random numbers."""

    def random(self) -> float:
        """Return a number in [0, 1)."""


def draw(profile: Profile, ground: Ground, source_of: Callable[[str], Source]) -> tuple[Disturbance, ...]:
    """Return what goes wrong in one run, in the order of time.

    First it is drawn which kinds are on in this run (swarm testing), then how many disturbances there are, then each
    from a source of its own: one more or fewer changes none of the others.

    Args:
        profile: which kinds, and how often.
        ground: what there is to disturb.
        source_of: returns the source of random numbers of this run for a name.
    """
    by_kind: dict[str, list[Chance]] = {}
    for chance in ground.chances:
        if profile.rates.get(chance.kind, 0.0) > 0.0:
            by_kind.setdefault(chance.kind, []).append(chance)
    if not by_kind:
        return ()
    swarm = source_of("chaos")
    count = int(swarm.random() * (profile.most + 1))
    on = [kind for kind in by_kind if swarm.random() < profile.swarm] or [_one_of(list(by_kind), swarm)]
    found = []
    for number in range(count):
        source = source_of(f"chaos/{number}")
        kind = _weighted(on, [profile.rates[kind] for kind in on], source)
        found.append(_drawn(_one_of(by_kind[kind], source), profile, ground, source))
    return in_order(found)


def _drawn(chance: Chance, profile: Profile, ground: Ground, source: Source) -> Disturbance:
    kind, ranges = KINDS[chance.kind], profile.ranges[chance.kind]
    settings = dict(chance.settings)
    ends = kind.always_ends or source.random() < profile.ends
    for_s = _ticks(_between(ranges["for_s"], source)) if "for_s" in ranges else None
    at_s = _time(chance, for_s or 0.0, ground, source)
    for name, limits in ranges.items():
        if name in ("for_s", "count") or (name in ("sigma", "rate_hz") and name not in settings):
            continue
        settings[name] = _setting(name, limits, source)
    if kind.by_message:
        settings["count"] = int(_between(ranges["count"], source)) if ends else None
        settings["direction"] = "to_robot" if chance.kind == "wrong_reply" else _one_of(DIRECTIONS, source)
        if settings["count"] is None:
            del settings["count"]
    elif chance.kind in ("stuck", "open_wire") and chance.place is not None and chance.place.kind == DIGITAL:
        if chance.kind == "stuck" and source.random() < 0.5:
            settings["value"] = source.random() < 0.5
    elif chance.kind == "bouncing":
        most = int(settings["settle_s"] / (2 * PERIOD_S) + 1e-9)
        settings["bounces"] = 1 + int(source.random() * min(most, 4))
    elif chance.kind == "push":
        settings["axis"] = int(source.random() * 3)
        settings["force_n"] *= 1.0 if source.random() < 0.5 else -1.0
    on = "" if chance.place is None else chance.place.on
    return Disturbance(chance.kind, on, at_s, for_s if ends else None, settings)


def _time(chance: Chance, for_s: float, ground: Ground, source: Source) -> float:
    end_s = max(ground.plain.time_s, PERIOD_S)
    place = chance.place
    share = source.random()
    moments = _moments(chance.kind, place, ground)
    if share < _AT_MOMENTS and moments:
        before_s = {"early_press": 3.0, "no_part": for_s}.get(chance.kind, _BEFORE_S)
        return _ticks(max(0.0, _one_of(moments, source) - before_s * source.random()), least=0)
    return _ticks(end_s * source.random(), least=0)


def _moments(kind: str, place: Place | None, ground: Ground) -> Sequence[float]:
    if place is None:
        return ()
    return ground.rises.get(str(place.on), ()) if kind in ("early_press", "no_part") else place.moments


def _setting(name: str, limits: Range, source: Source) -> Any:
    value = _between(limits, source)
    if name == "chunk":
        return int(value)
    return _ticks(value) if name.endswith("_s") and name != "per_s" else float(f"{value:.3g}")


def _between(limits: Range, source: Source) -> float:
    """Return a number between two others above 0, evenly by the logarithm; whole numbers are cut off."""
    low, high = limits
    return exp(log(low) + (log(high) - log(low)) * source.random())


def _ticks(time_s: float, *, least: int = 1) -> float:
    """Return a time in whole control periods, s."""
    return round(max(least, round(time_s / PERIOD_S)) * PERIOD_S, 3)


def _one_of(items: Sequence[_Item], source: Source) -> _Item:
    return items[int(source.random() * len(items))]


def _weighted(items: Sequence[_Item], weights: Sequence[float], source: Source) -> _Item:
    at = source.random() * sum(weights)
    for item, weight in zip(items, weights, strict=True):
        at -= weight
        if at < 0.0:
            return item
    return items[-1]


def is_over(disturbance: Disturbance, end_s: float) -> bool:
    """Return whether a disturbance was over before a time."""
    if disturbance.kind == "protective_stop":
        return False
    # What is late comes late by so much, after the last message or change that was.
    late_s = float(disturbance.settings.get("delay_s", 0.0))
    if disturbance.for_s is not None:
        return disturbance.at_s + disturbance.for_s + late_s <= end_s
    count = disturbance.settings.get("count")
    return disturbance.kind in TABLE and count is not None and disturbance.at_s + count * late_s <= end_s


PLAIN_UNTIL_S: Final = 600.0
"""Limit of virtual time of the plain run, and of every run if that reaches it, unless there is another, *assumed*."""

SLACK_S: Final = 30.0
"""Time that a disturbed run has beyond twice that of the plain one, *assumed*."""

_LATE_MAX: Final = 50
"""Late messages and changes of one disturbance that a program is taken to wait for one after the other, *assumed*."""


def time_limit_s(ground: Ground, disturbances: Sequence[Disturbance], until_s: float | None) -> float | None:
    """Return the limit of virtual time of a disturbed run, s: what takes longer waits for ever.

    Args:
        ground: of the plain run.
        disturbances: of the run.
        until_s: limit that was asked for; None for none.
    """
    if ground.plain.state == "time_limit":
        return PLAIN_UNTIL_S if until_s is None else until_s
    moments = {chance.place.on: len(chance.place.moments) for chance in ground.chances if chance.place is not None}
    held_s = sum(_held_s(item, moments.get(item.on, 1)) for item in disturbances)
    slow = [float(item.settings["fraction"]) for item in disturbances if item.kind == "slider" and item.for_s is None]
    factor = max(1.0, *(1.0 / max(fraction, 0.01) for fraction in slow), 1.0)
    own_s = 2.0 * ground.plain.time_s * factor + held_s + SLACK_S
    return own_s if until_s is None else min(until_s, own_s)


def _held_s(disturbance: Disturbance, moments: int) -> float:
    """Return how long a disturbance can hold a program up by itself, s.

    Args:
        disturbance: of the run.
        moments: how often something passes or changes at its place in the plain run.
    """
    late_s = float(disturbance.settings.get("delay_s", 0.0))
    count = disturbance.settings.get("count") or max(1, moments)
    return (disturbance.for_s or 0.0) + late_s * min(count, _LATE_MAX)
