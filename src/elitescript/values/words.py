"""Writes what a description says, for people."""

from __future__ import annotations

from math import inf
from typing import Final

from elitescript.values.description import (
    ANY,
    BOOL,
    BYTES,
    CHANNEL,
    COMMANDED,
    DICT,
    FLOAT,
    FUNCTION,
    IN_BASE,
    INT,
    LATE,
    LIST,
    MEASURED,
    NONE,
    NUMBER,
    OBJECT,
    RANGE,
    ROW,
    SET,
    SIGNAL,
    TEXT,
    TUPLE,
    Shape,
    Value,
)
from elitescript.values.results import POSITION

_NAMES: Final = {
    BOOL: "bool",
    INT: "int",
    FLOAT: "float",
    TEXT: "str",
    BYTES: "bytes",
    LIST: "list",
    TUPLE: "tuple",
    DICT: "dict",
    SET: "set",
    RANGE: "range",
    FUNCTION: "function",
    OBJECT: "object",
    NONE: "None",
}
_ORIGINS: Final = (
    (MEASURED, "measured"),
    (COMMANDED, "commanded"),
    (CHANNEL, "sent by a peer"),
    (SIGNAL, "a signal"),
)
ROLES: Final = {
    "joints": "joint positions",
    "pose": "pose",
    "tcp": "TCP offset",
    "joint speeds": "joint speeds",
    "tool velocity": "tool speed",
    "centre of gravity": "centre of gravity",
    "thread handle": "thread handle",
    "count": "count",
    POSITION: f"{POSITION} (not found)",
}
"""Words for roles that are not units."""


def words(value: Value) -> str:
    """Return what a description says, such as `int 1…3` or `pose, measured`; empty if it says nothing."""
    if not value.kinds or value.kinds == ANY:
        return ""
    parts = [_kinds(value)]
    if value.shape is not None and value.shape.is_counted:
        parts.append("first element: how many")
    parts += [word for bit, word in _ORIGINS if value.must & bit]
    if value.may & LATE and value.must & SIGNAL:
        parts.append("may have no value yet")
    return ", ".join(parts)


_WITHOUT_ARTICLE: Final = ("None", "bytes", "joint positions", "joint speeds", "first element")
_WIDE: Final = 2**31
"""Ranges of whole registers say nothing in a sentence."""


def phrase(value: Value) -> str:
    """Return what a description says as the rest of a sentence behind `is`, such as `a pose, measured`."""
    if value.has_constant:
        return words(value)
    if value.high >= _WIDE - 1 and value.low <= -_WIDE:
        value = value.but(low=-inf, high=inf)
    text = words(value)
    if not text or text.startswith(_WITHOUT_ARTICLE) or not text[0].isalpha():
        return text
    return f"{'an' if text[0] in 'aeio' else 'a'} {text}"


def _kinds(value: Value) -> str:
    names = [name for kind, name in _NAMES.items() if value.kinds & kind]
    role = ROLES.get(value.role, "")
    unit = "" if role else value.role
    if value.role == POSITION and value.low >= 0:
        role = ""
    if role and value.kinds & (ROW | NUMBER):
        if value.role == "pose" and value.must & IN_BASE:
            role += " in the base frame"
        names = [role, *(["None"] if value.kinds & NONE else [])]
    elif value.shape is not None and value.kinds in (LIST, TUPLE):
        names = [f"{names[0]}{_length(value)}{_units(value.shape)}"]
    text = " or ".join(names)
    if (
        value.constants is not None
        and value.constants != (False, True)
        and 0 < len(value.constants) <= 4
        and not value.kinds & ~(NUMBER | TEXT | NONE)
    ):
        return " or ".join(map(repr, value.constants))
    if not value.kinds & ~NUMBER and value.kinds != BOOL and not role:
        text += _range(value.low, value.high)
        text += f" {unit}" if unit else ""
    return text


def _units(shape: Shape) -> str:
    """Return the units of elements, each once; empty if that of any is not known."""
    units = dict.fromkeys(part.role for part in shape.items or (shape.element,))
    return "" if "" in units or any(unit in ROLES for unit in units) else f" {', '.join(units)}"


def _length(value: Value) -> str:
    shape = value.shape
    assert shape is not None
    if shape.least == shape.most:
        return f" of {shape.most:g}"
    return "" if shape.least == 0 and shape.most == inf else f" of{_range(shape.least, shape.most)}"


def _range(low: float, high: float) -> str:
    if low == -inf and high == inf:
        return ""
    if high == inf:
        return f" >= {_number(low)}"
    if low == -inf:
        return f" <= {_number(high)}"
    return f" {_number(low)}" if low == high else f" {_number(low)}…{_number(high)}"


def _number(number: float) -> str:
    return str(int(number)) if number == int(number) and abs(number) < 1e15 else f"{number:g}"
