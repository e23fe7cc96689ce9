"""Kinds of disturbances: the faults of `devices.channels.faults`, and what stops and people do.

`KINDS` has every kind that can be drawn. What a fault means, where it makes sense and which settings it has is in the
table of faults alone; here stands between which values its settings are drawn. All ranges are *assumed*.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from elitescript.devices.channels.faults import TABLE
from elitescript.records import NamedTuple

CHANNELS: Final = "channels"
INPUTS: Final = "inputs"
STOPS: Final = "stops"
PEOPLE: Final = "people"
GROUPS: Final = (CHANNELS, INPUTS, STOPS, PEOPLE)

ALL: Final = "all"

Range = tuple[float, float]


class Kind(NamedTuple):
    """One row: a kind of disturbance.

    Attributes:
        name: as in `Disturbance.kind`.
        groups: profiles that have it, besides `all`.
        text: what it does; empty for faults, whose table says it.
        ranges: of the settings that are drawn, by their names; evenly by the logarithm.
        always_ends: whether it is over before the run is; else the profile decides.
        by_message: whether it ends after some messages, instead of after some time.
        table: section of a case file.
    """

    name: str
    groups: tuple[str, ...]
    text: str = ""
    ranges: Mapping[str, Range] = {}
    always_ends: bool = False
    by_message: bool = False
    table: str = "fault"


_FOR_S: Final = (0.1, 5.0)
_COUNT: Final = (1.0, 3.0)


def _of_messages(name: str, **ranges: Range) -> Kind:
    return Kind(name, (CHANNELS,), ranges={"count": _COUNT, **ranges}, by_message=True)


def _of_channel(name: str, *, always_ends: bool = False) -> Kind:
    return Kind(name, (CHANNELS,), ranges={"for_s": _FOR_S}, always_ends=always_ends)


def _of_input(name: str, **ranges: Range) -> Kind:
    return Kind(name, (INPUTS,), ranges={"for_s": _FOR_S, **ranges})


def _stop(name: str, text: str, *groups: str, **ranges: Range) -> Kind:
    return Kind(name, groups or (STOPS,), text, ranges, always_ends="for_s" in ranges, table="stop")


def _person(name: str, text: str, **ranges: Range) -> Kind:
    return Kind(name, (PEOPLE,), text, ranges, always_ends=True, table="person")


_ROWS: Final = (
    _of_channel("refuse"),
    _of_channel("silence"),
    _of_messages("drop"),
    _of_messages("delay", delay_s=(0.02, 5.0)),
    _of_messages("duplicate"),
    _of_messages("corrupt"),
    _of_messages("trickle", chunk=(1.0, 8.0)),
    _of_messages("wrong_reply"),
    _of_channel("disconnect"),
    _of_input("stuck"),
    _of_input("inverted"),
    _of_input("bouncing", settle_s=(0.016, 0.2)),
    _of_input("open_wire"),
    _of_input("drifting", per_s=(0.02, 1.0), bound=(0.1, 5.0)),
    _of_input("noisy", sigma=(0.01, 1.0), rate_hz=(0.5, 20.0)),
    _of_input("late", delay_s=(0.02, 2.0)),
    _stop("pause", "the task is paused, and resumed for_s later", for_s=_FOR_S),
    _stop(
        "safeguard_stop",
        "somebody opens the safeguard, and closes it for_s later; the task goes on then",
        STOPS,
        PEOPLE,
        for_s=_FOR_S,
    ),
    _stop("protective_stop", "the safety system stops the arm, which ends the program with R140"),
    _stop(
        "slider", "the speed slider is moved to fraction, and back for_s later", for_s=(0.5, 10.0), fraction=(0.05, 1.0)
    ),
    _stop("reduced_mode", "the reduced safety limits are asked for, for for_s", for_s=(0.5, 10.0)),
    _person("early_press", "a digital input reads high for for_s: a button is pressed early", for_s=(0.1, 1.0)),
    _person("no_part", "a digital input reads low for for_s: the part is not there, or late", for_s=(0.5, 10.0)),
    _person("push", "somebody pushes the tool with force_n for for_s", for_s=(0.1, 2.0), force_n=(5.0, 80.0)),
)

KINDS: Final[dict[str, Kind]] = {row.name: row for row in _ROWS}
"""All kinds by name. `reconnect` is not drawn: a disconnect that ends is one."""

PLACED: Final = ("early_press", "no_part")
"""Kinds of people that are at an input."""


def is_fault(kind: str) -> bool:
    """Return whether a kind is one of the table of faults."""
    return kind in TABLE
