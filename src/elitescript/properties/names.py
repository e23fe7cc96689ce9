"""What expressions may name: the record of a run, and what there is over time."""

from __future__ import annotations

import ast
from collections.abc import Callable
from math import pi
from typing import Any, Final

from elitescript.messages.timing import seconds
from elitescript.properties.pieces import LIST, NUMBER, TABLE, TEXT, Piece
from elitescript.properties.units import M_PER_S, RAD, RAD_PER_S, M, S, Unit
from elitescript.properties.verdicts import Needs, Undefined
from elitescript.records import NamedTuple
from elitescript.run import Run

_NODE: Final = ast.Constant(None)
"""Of parts that are items of a list, not text."""


def _items(*units: Unit) -> tuple[Piece, ...]:
    def item(index: int) -> Callable[[Any], Any]:
        return lambda values: values[index]

    return tuple(Piece(_NODE, NUMBER, item(index), unit) for index, unit in enumerate(units))


_JOINTS: Final = _items(*[RAD] * 6)
_SPEEDS: Final = _items(*[RAD_PER_S] * 6)
_POSE: Final = _items(M, M, M, RAD, RAD, RAD)

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


OVER_TIME: Final[dict[str, OverTime]] = {
    "t": OverTime(NUMBER, lambda m: m.t, Needs(time=True), "time since the start of the run, s", S),
    "q": OverTime(LIST, lambda m: m.q, Needs(joints=True), "target joint positions, rad", None, _JOINTS),
    "qd": OverTime(LIST, lambda m: m.qd, Needs(speeds=True), "target joint speeds, rad/s", None, _SPEEDS),
    "tcp": OverTime(LIST, lambda m: m.tcp, Needs(pose=True), "target pose of the TCP, m and rad", None, _POSE),
    "tcp_speed": OverTime(
        NUMBER, lambda m: m.tcp_speed, Needs(tcp_speed=True), "target speed of the TCP, m/s", M_PER_S
    ),
    "line": OverTime(NUMBER, lambda m: m.line, Needs(line=True), "line of the main thread; 0 when no program runs"),
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
