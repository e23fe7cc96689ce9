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
from typing import TYPE_CHECKING, Any, Final

from elitescript.errors import ScriptPermissionError
from elitescript.language.policy import (
    DENIED_ATTRIBUTES,
    FORMAT_ATTRIBUTES,
    GUARDED_ATTRIBUTES,
    is_attribute_allowed,
    is_dunder,
)
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.runtime.names.identities import Identities

_MISSING: Final = object()
_SPEC_DEPTH: Final = 1
"""Fields inside fields of a format string; the limit of `str.format`."""


Load = Callable[[Any, str], Any]
"""Returns one of the guarded attributes of an object."""


def attribute_hook(identities: Identities) -> Load:
    """Return the hook that stands for loads of guarded attributes, for one run."""
    from elitescript.runtime.names.identities import shown_class

    def load(value: Any, name: str) -> Any:
        if name == "__class__":
            return shown_class(value.__class__)
        if name == "__hash__":
            return identities.hash_method(value)
        return checked_format_method(value, name)

    return load


def getattr_over(load: Load) -> Callable[..., Any]:
    """Return `getattr` for one run."""

    def getattr(value: Any, name: Any, *default: Any) -> Any:
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
                return load(value, name)
            except AttributeError:
                if default:
                    return default[0]
                raise
        return builtins.getattr(value, name, *default)

    getattr.__qualname__ = "getattr"
    return getattr


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
    if not isinstance(name, str):
        raise TypeError(f"attribute name must be string, not {type(name).__name__!r}")
    if type(name) is not str:
        raise TypeError(f"{function}(): attribute name must be a plain str, not {type(name).__name__!r}")
    if not name.isidentifier():
        raise AttributeError(f"{function}(): {name!r} cannot be the name of an attribute")


def _not_available(name: str) -> ScriptPermissionError:
    return ScriptPermissionError(said("the attribute {name!r} is not available to programs", name=name), value=name)


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
            value = _field_attribute(value, key) if is_attribute else value[key]
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


def _attribute_of_a_field(value: Any, name: str) -> Any:
    # Shown as a text, a method differs in nothing from the guarded one, and a field calls none.
    return checked_format_method(value, name) if name in FORMAT_ATTRIBUTES else builtins.getattr(value, name)


_field_attribute: Final = getattr_over(_attribute_of_a_field)
"""Reads an attribute in a field."""


def _converted(value: Any, conversion: str | None) -> Any:
    if conversion is None:
        return value
    convert = _CONVERSIONS.get(conversion)
    if convert is None:
        raise ValueError(f"Unknown conversion specifier {conversion!r}")
    return convert(value)


_CONVERSIONS: Final[dict[str, Callable[[Any], str]]] = {"r": repr, "s": str, "a": ascii}
