"""Describes what commands return, as the catalogue says it."""

from __future__ import annotations

from functools import cache
from math import inf
from typing import Final

from elitescript.commands.definition.quantities import (
    Boolean,
    Choice,
    Either,
    Integer,
    Number,
    Octets,
    Quantity,
    Text,
    Vector,
)
from elitescript.commands.definition.registry import Command
from elitescript.values.description import (
    BOOL,
    BYTES,
    CHANNEL,
    COMMANDED,
    COMPUTED,
    FLOAT,
    IN_BASE,
    INT,
    LATE,
    LIST,
    MEASURED,
    NO_SITES,
    NOTHING,
    OBJECT,
    SIGNAL,
    TEXT,
    TYPES,
    UNKNOWN,
    Shape,
    Value,
    join_all,
    of_constants,
)

_ORIGINS: Final = {
    "measured": MEASURED,
    "commanded": COMMANDED,
    "channel": CHANNEL,
    "signal": SIGNAL,
}
"""Of the origins in the catalogue; all others are computed."""

HANDLE: Final = "thread handle"
"""Role of what `start_thread` returns."""

POSITION: Final = "position or -1"
"""Role of where something was found; -1 if it was not."""

ELEMENT_ROLES: Final = {"m, rad": ("m", "m", "m", "rad", "rad", "rad"), "m/s, rad/s": ("m/s",) * 3 + ("rad/s",) * 3}
"""Roles of the elements of a list whose elements have two units."""

LIST_ROLES: Final = ("joints", "pose", "tcp", "joint speeds", "tool velocity", "centre of gravity")
"""Roles of whole lists."""


@cache
def result_of(command: Command) -> Value:
    """Return what a command returns; the lists in it have no sites, see `at_sites`."""
    return _result_of(command, NO_SITES)


def at_sites(command: Command, sites: frozenset[int]) -> Value:
    """Return what a command returns that makes lists at some sites."""
    result = result_of(command)
    shape = result.shape
    inner = None if shape is None else shape.element if shape.items is None else shape.items[0]
    if inner is not None and inner.shape is None and not inner.kinds & LIST:
        return result.but(sites=sites)
    return _result_of(command, sites)


def _result_of(command: Command, sites: frozenset[int]) -> Value:
    details = command.details
    result = details.result
    returns = details.returns
    origin = _ORIGINS.get(result.origin, COMPUTED)
    if result.frame == "base":
        origin |= IN_BASE
    may = origin | (LATE if result.may_be_late else 0)
    if returns.type_name == "None":
        return NOTHING
    if result.kinds:
        return join_all(_any_of(kind, sites, may, origin) for kind in result.kinds)
    if returns.type_name == "RPC handle":
        return Value(OBJECT, constants=(), may=may, must=origin, refs=None)
    described = of_quantity(returns, sites, may, origin)
    if result.origin == "handle":
        return described.but(role=HANDLE)
    if -1 in result.special:
        return described.but(role=POSITION)
    return described


def _any_of(kind: type, sites: frozenset[int], may: int, must: int) -> Value:
    bits = TYPES[kind]
    if bits & (INT | FLOAT):
        return Value(bits, -inf, inf, None, "", may, must)
    if bits == LIST:
        return Value(bits, constants=(), may=may, must=must, shape=Shape(None), sites=sites)
    return Value(bits, may=may, must=must)


def of_quantity(quantity: Quantity, sites: frozenset[int], may: int, must: int) -> Value:
    """Return the description of a value of a quantity."""
    kind = type(quantity)
    role = quantity.meaning or quantity.unit
    if isinstance(quantity, Vector):
        return _vector(quantity, sites, may, must)
    if isinstance(quantity, Number):
        low = -inf if quantity.low is None or quantity.allows_non_finite else quantity.low
        high = inf if quantity.high is None or quantity.allows_non_finite else quantity.high
        return Value(FLOAT, low, high, None, role, may, must)
    if isinstance(quantity, Integer):
        low = -inf if quantity.low is None else quantity.low
        return Value(INT, low, inf if quantity.high is None else quantity.high, None, role, may, must)
    if isinstance(quantity, Choice):
        return of_constants(quantity.choices, may, must)
    if isinstance(quantity, Either):
        return join_all(of_quantity(inner, sites, may, must) for inner in quantity.kinds)
    if kind is Boolean:
        return Value(BOOL, 0, 1, (False, True), "", may, must)
    if kind is Text:
        return Value(TEXT, may=may, must=must)
    if kind is Octets:
        return Value(BYTES, may=may, must=must)
    return UNKNOWN


def _vector(quantity: Vector, sites: frozenset[int], may: int, must: int) -> Value:
    element = of_quantity(quantity.element, sites, may, must)
    if quantity.count is None:
        shape = Shape(None, element)
    else:
        roles = ELEMENT_ROLES.get(quantity.unit, (quantity.unit,) * quantity.count)
        shape = Shape(tuple(element.but(role=roles[index % len(roles)]) for index in range(quantity.count)))
    role = quantity.meaning if quantity.meaning in LIST_ROLES else ""
    return Value(LIST, constants=(), role=role, may=may, must=must, shape=shape, sites=sites or NO_SITES)
