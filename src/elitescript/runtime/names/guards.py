"""Guards built-ins that could reach hidden attributes.

Names in the text of a program are checked when it is compiled (`language.policy`). Checked here is the rest: computed
attribute names, and format strings, which hold attribute names. Guards accept exact `str` names only: an instance of a
subclass can pretend to be another name.
"""

from __future__ import annotations

import builtins
from _string import formatter_field_name_split, formatter_parser  # type: ignore[import-not-found]
from collections.abc import Callable, Mapping
from types import BuiltinFunctionType, MethodDescriptorType
from typing import Any, Final

from elitescript.errors import ScriptPermissionError
from elitescript.language.policy import DENIED_ATTRIBUTES, GUARDED_ATTRIBUTES, is_attribute_allowed, is_dunder
from elitescript.runtime.sealed import Sealed
from elitescript.said import said

_MISSING: Final = object()
_SPEC_DEPTH: Final = 2
"""Fields inside fields of a format string; the limit of `str.format`."""


def checked_getattr(value: Any, name: Any, *default: Any) -> Any:
    """Return an attribute that programs may read.

    Raises:
        ScriptPermissionError: another name.
    """
    if len(default) > 1:
        raise TypeError(f"getattr expected at most 3 arguments, got {2 + len(default)}")
    _check_name("getattr", name)
    if not is_attribute_allowed(name):
        raise _not_available(name)
    if name in GUARDED_ATTRIBUTES:
        try:
            return checked_format_method(value, name)
        except AttributeError:
            if default:
                return default[0]
            raise
    return getattr(value, name, *default)


def checked_hasattr(value: Any, name: Any) -> bool:
    """Return whether there is an attribute that programs may read."""
    _check_name("hasattr", name)
    return is_attribute_allowed(name) and hasattr(value, name)


def checked_setattr(value: Any, name: Any, new: Any) -> None:
    """Set an attribute that programs may assign.

    Raises:
        ScriptPermissionError: another name.
    """
    _check_name("setattr", name)
    if is_dunder(name) or name in DENIED_ATTRIBUTES:
        raise ScriptPermissionError(said("the attribute {name!r} cannot be changed", name=name), value=name)
    setattr(value, name, new)


def checked_delattr(value: Any, name: Any) -> None:
    """Delete an attribute that programs may assign.

    Raises:
        ScriptPermissionError: another name.
    """
    _check_name("delattr", name)
    if is_dunder(name) or name in DENIED_ATTRIBUTES:
        raise ScriptPermissionError(said("the attribute {name!r} cannot be deleted", name=name), value=name)
    delattr(value, name)


def checked_dir(*values: Any) -> list[str]:
    """Return the attribute names of an object that programs may read, without the special ones."""
    if len(values) != 1:
        raise ScriptPermissionError("dir() is not available without an object")
    return sorted(name for name in dir(values[0]) if is_attribute_allowed(name) and not is_dunder(name))


def _check_name(function: str, name: Any) -> None:
    if type(name) is not str:
        raise TypeError(f"{function}(): attribute name must be a plain str, not {type(name).__name__!r}")
    if not name.isidentifier():
        raise AttributeError(f"{function}(): {name!r} cannot be the name of an attribute")


def _not_available(name: str) -> ScriptPermissionError:
    return ScriptPermissionError(said("the attribute {name!r} is not available to programs", name=name), value=name)


class _OneArgument(Sealed):
    """Makes `type` a function of one argument that is still usable in `isinstance`."""

    def __call__(cls, *args: Any, **kwargs: Any) -> Any:
        if len(args) != 1 or kwargs:
            raise ScriptPermissionError("type() takes one object; write `class` to make a class")
        return type(args[0])

    def __instancecheck__(cls, instance: Any) -> bool:
        return isinstance(instance, type)

    def __subclasscheck__(cls, subclass: Any) -> bool:
        return issubclass(subclass, type)

    def __repr__(cls) -> str:
        return "<class 'type'>"


class OneArgumentType(metaclass=_OneArgument):
    """`type` for scripts."""

    __slots__ = ()
    __module__ = "builtins"
    __qualname__ = "type"


# ---------------------------------------------------------------- format strings


def checked_format_method(value: Any, name: str) -> Any:
    """Return `value.format` or `value.format_map`; that of a str reads only attributes that programs may read."""
    method = getattr(value, name)
    kind = type(method)
    if kind is BuiltinFunctionType and isinstance(method.__self__, str):
        text = str.__str__(method.__self__)
        if name == "format":
            return lambda *args, **kwargs: checked_format(text, args, kwargs)
        return lambda mapping: checked_format(text, None, mapping)
    if kind is MethodDescriptorType and method.__objclass__ is str:
        return _unbound_format if name == "format" else _unbound_format_map
    return method


def _unbound_format(text: Any, /, *args: Any, **kwargs: Any) -> str:
    return checked_format(_text_of(text, "format"), args, kwargs)


def _unbound_format_map(text: Any, mapping: Any, /) -> str:
    return checked_format(_text_of(text, "format_map"), None, mapping)


def _text_of(text: Any, name: str) -> str:
    if not isinstance(text, str):
        raise TypeError(f"descriptor {name!r} for 'str' objects doesn't apply to a {type(text).__name__!r} object")
    return str.__str__(text)


def checked_format(text: str, args: tuple[Any, ...] | None, mapping: Mapping[str, Any]) -> str:
    """Return `text.format(*args, **mapping)`; without `args` `text.format_map(mapping)`.

    Raises:
        ScriptPermissionError: a field reads an attribute that programs may not read.
        KeyError, IndexError, ValueError, AttributeError: as `str.format`.
    """
    return _Fields(args, mapping).fill(text, _SPEC_DEPTH)


class _Fields:
    """The values of one format call, and the numbering of its fields."""

    __slots__ = ("args", "mapping", "next_number")

    def __init__(self, args: tuple[Any, ...] | None, mapping: Mapping[str, Any]) -> None:
        self.args = args
        self.mapping = mapping
        self.next_number: int | None = None
        """Number of the next field without one; -1 once a field had a number."""

    def fill(self, text: str, depth: int) -> str:
        """Put the values into a text or into the specification of a field."""
        if depth < 0:
            raise ValueError("Max string recursion exceeded")
        parts = []
        for literal, field, spec, conversion in formatter_parser(text):
            if literal:
                parts.append(literal)
            if field is not None:
                value = _converted(self.value(field), conversion)
                parts.append(format(value, self.fill(spec, depth - 1) if spec else ""))
        return "".join(parts)

    def value(self, field: str) -> Any:
        """Return the value of a field such as `0.name[key]`."""
        first, rest = formatter_field_name_split(field)
        value = self.numbered(first) if first == "" or isinstance(first, int) else self.mapping[first]
        for is_attribute, key in rest:
            value = checked_getattr(value, key) if is_attribute else value[key]
        return value

    def numbered(self, number: int | str) -> Any:
        """Return the value of a positional field; the empty text is a field without a number."""
        if self.args is None:
            raise ValueError("Format string contains positional fields")
        if isinstance(number, str):
            if self.next_number == -1:
                raise ValueError("cannot switch from manual field specification to automatic field numbering")
            number = self.next_number or 0
            self.next_number = number + 1
        else:
            if self.next_number not in (None, -1):
                raise ValueError("cannot switch from automatic field numbering to manual field specification")
            self.next_number = -1
        if number >= len(self.args):
            raise IndexError(f"Replacement index {number} out of range for positional args tuple")
        return self.args[number]


def _converted(value: Any, conversion: str | None) -> Any:
    if conversion is None:
        return value
    convert = _CONVERSIONS.get(conversion)
    if convert is None:
        raise ValueError(f"Unknown conversion specifier {conversion!r}")
    return convert(value)


_CONVERSIONS: Final[dict[str, Callable[[Any], str]]] = {"r": repr, "s": str, "a": ascii}


# ---------------------------------------------------------------- identity

IDS_MAX: Final = 10_000
"""Objects whose number is remembered."""


class Identities:
    """Numbers objects in the order of their first `number` call, so that `id` is the same in every run.

    The last `IDS_MAX` objects are kept alive; an older one gets a new number.
    """

    __slots__ = ("_count", "_known")

    def __init__(self) -> None:
        self._known: dict[int, tuple[int, Any]] = {}
        self._count = 0

    def next_number(self) -> int:
        """Return a new number."""
        self._count += 1
        return 16 * self._count

    def number(self, value: Any) -> int:
        """Return the number of an object."""
        found = self._known.get(id(value))
        if found is not None:
            return found[0]
        number = self.next_number()
        if len(self._known) >= IDS_MAX:
            del self._known[next(iter(self._known))]
        self._known[id(value)] = (number, value)
        return number

    def clear(self) -> None:
        """Forget all objects."""
        self._known.clear()


def class_builder(identities: Identities) -> Callable[..., type]:
    """Return `__build_class__` for objects hashed by number, so that their sets have the same order in every run."""
    build = builtins.__build_class__

    def hash_of(self: Any) -> int:
        """Return the number of the object."""
        try:
            attributes = object.__getattribute__(self, "__dict__")
        except AttributeError:
            return identities.number(self)
        number = attributes.get(_HASH)
        if number is None:
            number = attributes[_HASH] = identities.next_number()
        return int(number)

    def build_class(body: Callable[..., Any], name: str, *bases: Any) -> type:
        made: type = build(body, name, *bases)
        if getattr(made, "__hash__") is getattr(object, "__hash__"):  # noqa: B009
            type.__setattr__(made, "__hash__", hash_of)
        return made

    return build_class


_HASH: Final = "@hash"
"""Attribute that no script can name."""
