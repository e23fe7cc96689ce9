"""Applies the checks of a command to its arguments before the run, where their value is certain.

These are the command's own quantities, so check and run always agree. In a list, uncertain elements are replaced
by stand-ins that fit, and only what is wrong with the rest is reported.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Final

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
from elitescript.errors import ArgumentTypeError, ScriptError, text_of
from elitescript.lint.constants import Unknown
from elitescript.records import NamedTuple
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.values.description import Value


class ArgumentRefusal(NamedTuple):
    """An argument that a command will refuse."""

    command: Command
    param: Param
    node: ast.expr
    error: ScriptError

    @property
    def text(self) -> str:
        """What is wrong, in the words of the alarm at run time."""
        command, argument = self.command.name, self.param.name
        return said("{command}: {argument} {mistake}", command=command, argument=argument, mistake=text_of(self.error))

    @property
    def hint(self) -> str:
        """What to do about it."""
        value = self.error.value
        return self.error.hint or self.command.hint_about(value)


_IS_OPEN: Final = frozenset((Unknown, list, tuple))


def refuse(param: Param, value: Any) -> ScriptError | None:
    """Return the error that a parameter raises for a value; None if it accepts it, or if that is not certain."""
    if isinstance(value, Unknown):
        return None
    quantity = param.quantity
    if isinstance(value, (list, tuple)) and not _IS_OPEN.isdisjoint(map(type, value)):
        filled = _filled(quantity, value)
        if filled is None:
            return None
        value = filled
    try:
        quantity.coerce(value)
    except ScriptError as error:
        return error
    return None


def refuse_description(param: Param, value: Value, text: str) -> ScriptError | None:
    """Return the error that a parameter raises for all values that a description allows; None if it may accept one.

    Args:
        param: the parameter.
        value: the description.
        text: the expression, which stands for the value in the message.
    """
    if not value.is_known or value.has_constant:
        return None
    if value.is_list:
        items = value.items
        # How many elements there are can be wrong, whatever they are.
        return None if items is None else refuse(param, [Unknown()] * len(items))
    kinds = [name for name, bit in _SAMPLES.items() if value.kinds & bit]
    known = sum(_SAMPLES.values())
    made = _made_by(value)
    if made:
        kinds, known = [*kinds, made], known | _OBJECT
    if not kinds or value.kinds & ~known:
        return None
    errors = []
    for name in kinds:
        error = refuse(param, _sample(name, text))
        if error is None or error.default_code != ArgumentTypeError.default_code:
            break
        errors.append(error)
    else:
        return errors[0]
    return None


def _made_by(value: Value) -> str:
    """Return the class of Python's library of which a value is an object, of those that are asked about; else empty."""
    kinds = {getattr(ref, "kind", None) for ref in value.refs or ()} if value.kinds & _OBJECT else set()
    return "bytearray" if kinds == {bytearray} else ""


_SAMPLES: Final = {
    "str": 8,
    "bytes": 16,
    "bool": 1,
    "int": 2,
    "float": 4,
    "None": 32,
    "dict": 256,
    "set": 512,
    "range": 1024,
    "function": 2048,
}
"""Kinds of which one value is refused for its type if all are; see `values.description`."""


_OBJECT: Final = 4096
_PLAIN: Final[dict[str, Any]] = {"bool": True, "None": None, "dict": {}, "range": range(1)}


def _sample(name: str, text: str) -> Any:
    """Return a value of a type that a message shows as its source text."""
    base: dict[str, tuple[type, Any]] = {
        "str": (str, "x"),
        "bytes": (bytes, b"x"),
        "int": (int, 1),
        "float": (float, 1.0),
        "set": (set, ()),
        "bytearray": (bytearray, b"x"),
    }
    if name == "function":
        return type(name, (), {"__repr__": lambda self: text, "__call__": lambda self: None})()
    if name in _PLAIN:
        return _PLAIN[name]
    kind, inner = base[name]
    made = type(name, (kind,), {"__repr__": lambda self: text})
    return made(inner)


class _StandIn:
    """Stands for a value that is not known yet; a message shows its source text."""

    text = "..."

    def __repr__(self) -> str:
        return self.text


class _SomeFloat(_StandIn, float):
    pass


class _SomeInt(_StandIn, int):
    pass


class _SomeText(_StandIn, str):
    pass


_SCALARS: Final = (Number, Integer, Choice, Boolean, Text, Octets)


def _filled(quantity: Quantity, items: list[Any] | tuple[Any, ...]) -> list[Any] | None:
    """Return a list with stand-ins for what is unknown; None if nothing is certain about it."""
    if isinstance(quantity, Optionally):
        return _filled(quantity.inner, items)
    if isinstance(quantity, Either):
        vectors = [kind for kind in quantity.kinds if isinstance(kind, Vector)]
        return _filled(vectors[0], items) if len(vectors) == 1 else None
    if type(quantity) in _SCALARS:
        # A list is none of these, whatever its elements are.
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
    """Return a value that fits a quantity and is shown as its source text; None if there is none."""
    candidates: Iterable[Any]
    if type(quantity) is Number:
        low, high = quantity.low or 0.0, quantity.high or 0.0
        candidates = map(_SomeFloat, (0.0, low, high, low + 1.0, (low + high) / 2))
    elif type(quantity) is Integer:
        candidates = map(_SomeInt, (0, quantity.low or 0, quantity.high or 0))
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
