"""Writes what a debugger asks and answers as values of JSON, and reads them, every value checked.

A record is an object with its fields by name, a tuple a list. What a function takes and returns is read from its
annotations, so that both ends of a connection share the one definition of it.

    >>> written(FunctionBreakpoint("movej"))
    {'name': 'movej', 'condition': '', 'hit_condition': ''}
"""

from __future__ import annotations

import collections.abc
from collections.abc import Callable, Mapping
from functools import cache
from math import isfinite
from types import NoneType, UnionType
from typing import Any, Final, Union, get_args, get_origin, get_type_hints

from elitescript.errors import DebugError

TEXT_MAX: Final = 1_000_000
"""Most characters of a text; longer ones come in parts."""

_SHOWN: Final = 60


def written(value: Any) -> Any:
    """Return a value as JSON can hold it; numbers that JSON lacks as None."""
    if isinstance(value, float):
        return value if isfinite(value) else None
    if value is None or isinstance(value, str | int):
        return value
    kind: Any = type(value)
    names = _fields(kind)
    if names:
        return {name: written(getattr(value, name)) for name in names}
    return [written(item) for item in value]


def read(kind: Any, data: Any) -> Any:
    """Return the value of a kind that JSON holds.

    Raises:
        DebugError: it is of another kind.
    """
    origin, arguments = get_origin(kind), get_args(kind)
    if origin in (Union, UnionType):
        if data is None and NoneType in arguments:
            return None
        return read(next(item for item in arguments if item is not NoneType), data)
    if kind in (str, bool, int):
        if type(data) is not kind or (kind is str and len(data) > TEXT_MAX):
            raise _error(kind.__name__, data)
        return data
    if kind is float:
        if type(data) not in (float, int):
            raise _error("number", data)
        return float(data)
    if kind is NoneType:
        return None
    if origin in (tuple, collections.abc.Sequence):
        return _read_list(arguments, data)
    return _read_object(kind, data)


def arguments_of(function: Callable[..., Any], data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keyword arguments of a function that an object of JSON holds.

    Raises:
        DebugError: one is missing, of another kind, or not known.
    """
    taken, needed = _parameters(function)
    for name in data:
        if name not in taken:
            raise DebugError(f"{function.__name__} takes {', '.join(taken) or 'nothing'}, not {str(name)[:_SHOWN]!r}")
    for name in needed:
        if name not in data:
            raise DebugError(f"{function.__name__} needs {name!r}")
    found = {}
    for name, value in data.items():
        try:
            found[name] = read(taken[name], value)
        except DebugError as error:
            raise DebugError(f"{function.__name__}: {name}: {error}") from None
    return found


def result_of(function: Callable[..., Any], data: Any) -> Any:
    """Return what a function has returned, from JSON.

    Raises:
        DebugError: it is of another kind.
    """
    return read(get_type_hints(function).get("return", NoneType), data)


@cache
def _parameters(function: Callable[..., Any]) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Return the parameters of a method with their kinds, and those without a default."""
    from inspect import Parameter, signature

    hints = get_type_hints(function)
    parameters = list(signature(function).parameters.values())[1:]
    needed = tuple(item.name for item in parameters if item.default is Parameter.empty)
    return {item.name: hints[item.name] for item in parameters}, needed


@cache
def _fields(kind: type) -> tuple[str, ...]:
    """Return the names of the fields of a record or named tuple; empty for any other class."""
    return tuple(getattr(kind, "__record_fields__", ()) or getattr(kind, "_fields", ()))


@cache
def _kinds(kind: type) -> dict[str, Any]:
    hints = get_type_hints(kind)
    return {name: hints[name] for name in _fields(kind)}


def _read_list(arguments: tuple[Any, ...], data: Any) -> tuple[Any, ...]:
    if type(data) is not list:
        raise _error("list", data)
    if len(arguments) == 1 or arguments[1:] == (...,):
        return tuple(read(arguments[0], item) for item in data)
    if len(data) != len(arguments):
        raise DebugError(f"a list of {len(arguments)}, not {len(data)}")
    return tuple(map(read, arguments, data))


def _read_object(kind: Any, data: Any) -> Any:
    kinds = _kinds(kind)
    if type(data) is not dict:
        raise _error(kind.__name__, data)
    values = {}
    for name, value in data.items():
        if name not in kinds:
            raise DebugError(f"{kind.__name__} has {', '.join(kinds)}, not {str(name)[:_SHOWN]!r}")
        try:
            values[name] = read(kinds[name], value)
        except DebugError as error:
            raise DebugError(f"{name}: {error}") from None
    try:
        return kind(**values)
    except TypeError as error:
        raise DebugError(f"{kind.__name__}: {error}") from None


def _error(wanted: str, data: Any) -> DebugError:
    shown = repr(data)
    return DebugError(f"{wanted}, not {shown if len(shown) <= _SHOWN else shown[:_SHOWN] + '...'}")
