"""What a command says to an argument before the run, when its value is certain.

The command's own quantities are asked, so that check and run can never disagree. In a list with uncertain
elements these are replaced by stand-ins that fit, and only what is wrong with the rest is said.
"""

from __future__ import annotations

import ast
from typing import Any, Final, NamedTuple

from elitescript.commands.definition.quantities import (
    Boolean,
    Choice,
    Either,
    Integer,
    Number,
    Octets,
    Optionally,
    Quantity,
    Text,
    Vector,
)
from elitescript.commands.definition.registry import Command, Param
from elitescript.errors import ScriptError
from elitescript.lint.constants import Unknown


class ArgumentRefusal(NamedTuple):
    """An argument that a command will refuse."""

    command: Command
    param: Param
    node: ast.expr
    error: ScriptError

    @property
    def text(self) -> str:
        """What is wrong, as the alarm at run time would say it."""
        return f"{self.command.name}: {self.param.name} {self.error}"

    @property
    def hint(self) -> str:
        """What to do about it."""
        return self.error.hint or self.command.call_hint


def refuse(param: Param, value: Any) -> ScriptError | None:
    """Return the error with which a parameter meets a value; None if it takes it, or if that is not certain."""
    if isinstance(value, Unknown):
        return None
    quantity = param.quantity
    if isinstance(value, (list, tuple)) and any(isinstance(item, (Unknown, list, tuple)) for item in value):
        filled = _filled(quantity, value)
        if filled is None:
            return None
        value = filled
    try:
        quantity.coerce(value)
    except ScriptError as error:
        return error
    return None


class _SomeFloat(float):
    """Stands for a number that is not known yet; a message shows what is written."""

    text = "..."

    def __repr__(self) -> str:
        return self.text


class _SomeInt(int):
    """Stands for an int that is not known yet."""

    text = "..."

    def __repr__(self) -> str:
        return self.text


class _SomeText(str):
    """Stands for a text that is not known yet."""

    text = "..."

    def __repr__(self) -> str:
        return self.text


_SCALARS: Final = (Number, Integer, Choice, Boolean, Text, Octets)


def _filled(quantity: Quantity, items: list[Any] | tuple[Any, ...]) -> list[Any] | None:
    """Return a list with stand-ins for what is unknown; None if nothing is certain about it."""
    if isinstance(quantity, Optionally):
        return _filled(quantity.inner, items)
    if isinstance(quantity, Either):
        vectors = [kind for kind in quantity.kinds if isinstance(kind, Vector)]
        return _filled(vectors[0], items) if len(vectors) == 1 else None
    if type(quantity) in _SCALARS:
        # Whatever the elements are: a list is none of these.
        return [_stand_in(Number(), item) if isinstance(item, Unknown) else item for item in items]
    if type(quantity) is not Vector:
        return None
    filled: list[Any] = []
    for item in items:
        new = item
        if isinstance(item, Unknown):
            new = _stand_in(quantity.element, item)
        elif isinstance(item, (list, tuple)):
            new = _filled(quantity.element, item)
        if new is None:
            return None
        filled.append(new)
    return filled


def _stand_in(quantity: Quantity, unknown: Unknown) -> Any:
    """Return a value that fits a quantity and is shown as the text that stands there; None if there is none."""
    candidates: tuple[Any, ...]
    if type(quantity) is Number:
        low, high = quantity.low or 0.0, quantity.high or 0.0
        candidates = tuple(_SomeFloat(number) for number in (0.0, low, high, low + 1.0, (low + high) / 2))
    elif type(quantity) is Integer:
        candidates = tuple(_SomeInt(number) for number in (0, quantity.low or 0, quantity.high or 0))
    elif type(quantity) is Boolean:
        candidates = (_SomeInt(0),)
    elif type(quantity) is Text:
        candidates = (_SomeText(),)
    else:
        return None
    for candidate in candidates:
        try:
            quantity.coerce(candidate)
        except ScriptError:
            continue
        candidate.text = unknown.text
        return candidate
    return None
