"""What expressions may name: the record of a run, and what there is over time."""

from __future__ import annotations

import ast
from collections.abc import Callable
from math import pi
from typing import Any, Final

from elitescript.messages.timing import seconds
from elitescript.properties.pieces import LIST, NUMBER, TABLE, TEXT, Piece
from elitescript.properties.units import M, S, Unit, unit
from elitescript.properties.verdicts import Needs, Undefined
from elitescript.records import NamedTuple
from elitescript.run import Run
from elitescript.values.places import PLACES

_NODE: Final = ast.Constant(None)
"""Of parts that are items of a list, not text."""


def _items(*units: Unit) -> tuple[Piece, ...]:
    def item(index: int) -> Callable[[Any], Any]:
        return lambda values: values[index]

    return tuple(Piece(_NODE, NUMBER, item(index), unit) for index, unit in enumerate(units))


_JOINTS: Final = _items(*map(unit, PLACES["q"].units))
_POSE: Final = _items(*map(unit, PLACES["tcp"].units))

Keys = dict[str, tuple[str, Unit]]

ALARM: Final[Keys] = {
    "t": (NUMBER, S),
    "code": (TEXT, None),
    "class": (TEXT, None),
    "text": (TEXT, None),
    "line": (NUMBER, None),
    "column": (NUMBER, None),
    "thread": (TEXT, None),
}
FINDINGS: Final[Keys] = {"error": (NUMBER, None), "warning": (NUMBER, None), "note": (NUMBER, None)}
CONTACT: Final[Keys] = {
    "t": (NUMBER, S),
    "first": (TEXT, None),
    "second": (TEXT, None),
    "distance_m": (NUMBER, M),
    "line": (NUMBER, None),
}


class Name(NamedTuple):
    """A name of the record."""

    kind: str
    value: Callable[[Run], Any]
    summary: str
    unit: Unit = None
    items: tuple[Piece, ...] | None = None
    keys: Keys | None = None


def _alarms(run: Run) -> list[dict[str, Any]]:
    return [
        {
            "t": seconds(alarm.tick - run.start_tick),
            "code": alarm.code,
            "class": alarm.class_name,
            "text": alarm.text,
            "line": alarm.line,
            "column": alarm.column,
            "thread": alarm.thread,
        }
        for alarm in run.alarms
    ]


def _contacts(run: Run) -> list[dict[str, Any]]:
    return [
        {
            "t": contact.t - seconds(run.start_tick),
            "first": contact.first,
            "second": contact.second,
            "distance_m": contact.distance_m,
            "line": contact.line,
        }
        for contact in run.contacts
    ]


def _clearance(run: Run) -> float:
    if run.watch is None:
        raise Undefined("the world has no solids, so there is no clearance")
    distances = [closest.distance_m for closest in run.clearances]
    if not distances:
        raise Undefined("no clearance was measured")
    return min(distances)


RECORD: Final[dict[str, Name]] = {
    "time_s": Name(NUMBER, lambda run: run.time_s, "time from the start to the end of the run, s", S),
    "state": Name(
        TEXT, lambda run: run.state, "how the run ended: `finished`, `alarm`, `stopped`, `time_limit` or `stuck`"
    ),
    "globals": Name(TABLE, lambda run: run.globals, "program globals at the end, by name"),
    "signals": Name(TABLE, lambda run: run.signals, "levels at the end, when what was sent has arrived, by name"),
    "joints": Name(LIST, lambda run: run.joints, "target joint positions at the end, rad", None, _JOINTS),
    "tcp_pose": Name(LIST, lambda run: run.tcp_pose, "target pose of the TCP at the end, m and rad", None, _POSE),
    "alarms": Name(LIST, _alarms, "what stopped the program: a table for each alarm", keys=ALARM),
    "log": Name(LIST, lambda run: run.log, "texts of `textmsg`"),
    "printed": Name(LIST, lambda run: run.printed, "texts of `print`"),
    "warnings": Name(LIST, lambda run: run.warnings, "texts of warnings"),
    "findings": Name(
        TABLE,
        lambda run: run.findings.counts(),
        "how much text and run have found: `findings.error`, `findings.warning`, `findings.note`",
        keys=FINDINGS,
    ),
    "contacts": Name(LIST, _contacts, "where arm, tool or payload touched something: a table for each", keys=CONTACT),
    "clearance": Name(NUMBER, _clearance, "the closest that they came to a thing of the world, m", M),
}
"""Names of the record by name."""

TEXTS: Final = frozenset({"log", "printed", "warnings"})
"""Lists of texts."""


class OverTime(NamedTuple):
    """A name inside functions over time."""

    kind: str
    value: Callable[[Any], Any]
    needs: Needs
    summary: str
    unit: Unit = None
    items: tuple[Piece, ...] | None = None


def _over_time(name: str, kind: str, value: Callable[[Any], Any], needs: Needs) -> OverTime:
    place = PLACES[name]
    if place.elements:
        return OverTime(kind, value, needs, place.summary, None, _items(*map(unit, place.units)))
    return OverTime(kind, value, needs, place.summary, unit(place.units[0]) if place.units else None)


OVER_TIME: Final[dict[str, OverTime]] = {
    name: _over_time(name, kind, value, needs)
    for name, kind, value, needs in (
        ("t", NUMBER, lambda m: m.t, Needs(time=True)),
        ("q", LIST, lambda m: m.q, Needs(joints=True)),
        ("qd", LIST, lambda m: m.qd, Needs(speeds=True)),
        ("tcp", LIST, lambda m: m.tcp, Needs(pose=True)),
        ("tcp_speed", NUMBER, lambda m: m.tcp_speed, Needs(tcp_speed=True)),
        ("line", NUMBER, lambda m: m.line, Needs(line=True)),
    )
}
"""Names inside functions over time, by name."""

CONSTANTS: Final = {"pi": pi}

COUNTED: Final = {"errors": "error", "warning": "warning", "error": "error", "notes": "note", "note": "note"}
"""Keys of `findings` that people write as names."""

LISTS: Final = {
    "warnings": "warnings is the list of texts: write findings.warning, which counts what text and run have found, "
    "each once, or len(warnings)",
    "alarms": "alarms is the list of alarms: write len(alarms)",
    "contacts": "contacts is the list of contacts: write len(contacts)",
    "log": "log is the list of texts: write len(log)",
    "printed": "printed is the list of texts: write len(printed)",
    "findings": "findings has a number for each severity: write findings.error, findings.warning or findings.note",
}
"""What to write where one of these is compared with a number."""

INSTEAD: Final = {"joints": "q", "tcp_pose": "tcp", "time_s": "t", "signals": 'signal("...")'}
"""What there is over time instead of a name of the record."""
