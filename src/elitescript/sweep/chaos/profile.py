"""Profiles: which kinds of disturbances are drawn, and how often.

A profile is named, or a TOML file:

    base = "channels"       # begins with the rates of this profile; without it every rate is 0
    most = 3                # disturbances of one run: 0 to so many
    swarm = 0.5             # share of the runs in which a kind is on
    ends = 0.7              # share of the faults that are over before the run is

    [rates]                 # how often, relative to the others; 0 never
    drop = 3
    pause = 0

    [ranges.delay]          # between which values settings of a kind are drawn
    delay_s = [0.1, 10.0]
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from elitescript.errors import UsageError, did_you_mean
from elitescript.records import record
from elitescript.sweep.chaos.kinds import ALL, GROUPS, KINDS, Range
from elitescript.sweep.plans.toml_text import TomlText

MOST_MAX: Final = 20

PROFILES: Final = (*GROUPS, ALL)
"""Names of profiles."""


@record
class Profile:
    """What is drawn.

    Attributes:
        rates: of each kind with one above 0: how often it is drawn, relative to the others.
        ranges: of settings that are drawn, by kind and name.
        most: largest number of disturbances in one run.
        swarm: share of the runs in which a kind is on.
        ends: share of the faults that are over before the run is.
    """

    rates: Mapping[str, float]
    ranges: Mapping[str, Mapping[str, Range]]
    most: int = 3
    swarm: float = 0.5
    ends: float = 0.7


def profile_named(name: str) -> Profile:
    """Return one of `PROFILES`.

    Raises:
        UsageError: there is no such profile.
    """
    if name not in PROFILES:
        near = did_you_mean(name, PROFILES)
        raise UsageError(
            f"there is no chaos profile {name!r}; there are {', '.join(PROFILES)}, or a file PROFILE.toml{near}"
        )
    rates = {row.name: 1.0 for row in KINDS.values() if name == ALL or name in row.groups}
    return Profile(rates, {row.name: row.ranges for row in KINDS.values()})


def is_profile_file(name: str) -> bool:
    """Return whether what `--chaos` was given is a file."""
    return name.endswith(".toml")


def read_profile(text: str, file: str) -> Profile:
    """Return the profile of a TOML text.

    Args:
        text: of the file.
        file: its name, for messages.

    Raises:
        UsageError: no TOML, or what makes no sense in it; the text names file and line.
    """
    toml = TomlText(text, file, "profile")
    toml.check_keys((), ("base", "most", "swarm", "ends", "rates", "ranges"))
    base = toml.text(("base",), "")
    if base:
        try:
            usual = profile_named(base)
        except UsageError as error:
            raise toml.error(("base",), str(error)) from None
    else:
        usual = Profile({}, profile_named(ALL).ranges)
    rates = dict(usual.rates)
    for name in toml.table(("rates",)):
        _check_kind(toml, "rates", name)
        rates[name] = toml.number(("rates", name), 0.0, 1e6)
    rates = {name: rate for name, rate in rates.items() if rate}
    if not rates:
        raise toml.error(("rates",), "every rate is 0, so nothing would ever go wrong")
    ranges = {name: dict(of_kind) for name, of_kind in usual.ranges.items()}
    for name in toml.table(("ranges",)):
        _check_kind(toml, "ranges", name)
        for setting, given in toml.table(("ranges", name)).items():
            if setting not in ranges[name]:
                raise toml.unknown(("ranges", name, setting), ranges[name])
            ranges[name][setting] = _range(toml, ("ranges", name, setting), given)
    return Profile(
        rates,
        ranges,
        toml.whole(("most",), 1, MOST_MAX, usual.most),
        toml.number(("swarm",), 0.0, 1.0, usual.swarm),
        toml.number(("ends",), 0.0, 1.0, usual.ends),
    )


def _check_kind(toml: TomlText, section: str, name: str) -> None:
    if name not in KINDS:
        raise toml.unknown((section, name), KINDS)


def _range(toml: TomlText, path: tuple[str | int, ...], given: Any) -> Range:
    if not isinstance(given, list) or len(given) != 2:
        raise toml.error(path, f"must be two numbers, such as [0.1, 5.0], got {given!r}")
    low, high = (toml.number((*path, index), 0.0, 1e6) for index in (0, 1))
    if not 0.0 < low <= high:
        raise toml.error(path, f"must be a lower and a higher number above 0, got {given!r}")
    return low, high


def profile_of(chaos: str) -> Profile:
    """Return what a plan has of chaos: the name of a profile, or the text of a profile file.

    Raises:
        UsageError: it makes no sense.
    """
    return profile_named(chaos) if chaos.isidentifier() else read_profile(chaos, "PROFILE.toml")
