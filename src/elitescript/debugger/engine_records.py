"""Records of the debugger as JSON and back, for two processes. On the way back only the classes named here are made."""

from __future__ import annotations

import json
from typing import Any, Final

from elitescript.debugger.api import (
    BreakpointState,
    Change,
    DataInfo,
    ExceptionInfo,
    Frame,
    Output,
    Picture,
    Position,
    Scope,
    State,
    Stop,
    ThreadInfo,
    Unevaluated,
    Variable,
)
from elitescript.debugger.engine import Goal
from elitescript.debugger.inputs import Input
from elitescript.debugger.places import CountedText
from elitescript.debugger.rules import CodeRule, DataRule, Rules
from elitescript.language.probes import CountedBranch, CountedFunction, CountedStatement, ProbeTable
from elitescript.untrusted.json_text import json_value

_KINDS: Final[dict[str, type]] = {
    kind.__name__: kind
    for kind in (
        *(
            BreakpointState,
            Change,
            DataInfo,
            ExceptionInfo,
            Frame,
            Output,
            Picture,
            Position,
            Scope,
            State,
            Stop,
            ThreadInfo,
        ),
        *(Unevaluated, Variable, Goal, Input, CodeRule, DataRule, Rules),
        *(CountedBranch, CountedFunction, CountedStatement, CountedText, ProbeTable),
    )
}
_TUPLE: Final = "tuple"
_SET: Final = "set"


def written(value: Any) -> bytes:
    """Return a value as bytes: numbers, texts, lists, tuples, sets and records of the debugger."""
    return json.dumps(_data(value), separators=(",", ":")).encode()


def read(data: bytes) -> Any:
    """Return the value of such bytes.

    Raises:
        ValueError: they are none.
    """
    return _value(json_value(data, depth_max=None))


def _data(value: Any) -> Any:
    kind = type(value)
    if kind in (int, float, str, bool, type(None)):
        return value
    if kind is list:
        return [_data(item) for item in value]
    if kind.__name__ in _KINDS and _KINDS[kind.__name__] is kind:
        names = getattr(kind, "_fields", None) or kind.__record_fields__
        return {kind.__name__: [_data(getattr(value, name)) for name in names]}
    if kind is tuple:
        return {_TUPLE: [_data(item) for item in value]}
    if kind is frozenset:
        return {_SET: [_data(item) for item in value]}
    if isinstance(value, int | float | str):
        return value
    raise ValueError(f"a {kind.__name__} cannot be sent")


def _value(data: Any) -> Any:
    if type(data) is list:
        return [_value(item) for item in data]
    if type(data) is not dict:
        return data
    ((name, items),) = data.items()
    values = [_value(item) for item in items]
    if name == _TUPLE:
        return tuple(values)
    if name == _SET:
        return frozenset(values)
    if name not in _KINDS:
        raise ValueError(f"{name!r} is no record of the debugger")
    return _KINDS[name](*values)
