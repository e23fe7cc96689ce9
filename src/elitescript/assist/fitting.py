"""Ranks what a program has by how well it fits an argument: first what means the same, then what has its type."""

from __future__ import annotations

from typing import Final

from elitescript.assist.own_names import LIST_KINDS
from elitescript.commands.definition.quantities import Optionally, Quantity
from elitescript.values.description import ANY, FLOAT, INT, NO_SITES, NONE, Value
from elitescript.values.results import of_quantity

SAME_MEANING: Final = 0
SAME_TYPE: Final = 1
NO_FIT: Final = 9

_TRANSFORM: Final = "m, rad"
"""Unit of poses and of offsets between them."""


def fit_of(value: Value, wanted: Quantity, kind: str = "") -> int:
    """Return how well a value fits a parameter: `SAME_MEANING`, `SAME_TYPE` or `NO_FIT`.

    Args:
        value: description of the value.
        wanted: what the parameter takes.
        kind: `joints` or `pose` if the value is used as such.
    """
    while isinstance(wanted, Optionally):
        wanted = wanted.inner
    meaning = LIST_KINDS.get(wanted.meaning, wanted.meaning or wanted.unit)
    if meaning == _TRANSFORM:
        meaning = "pose"
    described = of_quantity(wanted, NO_SITES, 0, 0)
    kinds = described.kinds | (INT if described.kinds & FLOAT else 0)
    if kinds == ANY or not value.is_known or value.kinds & ~(kinds | NONE):
        return NO_FIT
    role = LIST_KINDS.get(value.role, value.role)
    if (role and role in (meaning, wanted.unit)) or (kind and kind == meaning):
        return SAME_MEANING
    if (role and (meaning or wanted.unit)) or value.kinds & ~kinds:
        return NO_FIT
    shape, other = described.shape, value.shape
    if shape is None or other is None:
        return SAME_TYPE
    has_count = other.least <= shape.most and shape.least <= other.most
    roles, units = ({part.role for part in one.items or (one.element,)} - {""} for one in (other, shape))
    return SAME_TYPE if has_count and not (roles and units and roles - units) else NO_FIT
