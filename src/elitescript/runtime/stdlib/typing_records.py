"""`NamedTuple` and `TypedDict` for scripts: classes that are made from the annotations in their bodies.

The real ones turn annotations in text form into objects that can be evaluated. Here annotations give names only.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

_KEPT: Final = frozenset(
    ("__new__", "__init__", "__slots__", "__getnewargs__", "_asdict", "_field_defaults", "_fields", "_make", "_replace")
)
"""Attributes that a class of named tuples cannot define."""


def record_names(namedtuple: Callable[..., Any]) -> dict[str, Any]:
    """Return `NamedTuple` and `TypedDict` of one program.

    Args:
        namedtuple: `collections.namedtuple` of that program.
    """
    return {"NamedTuple": _named_tuple(namedtuple), "TypedDict": _typed_dict()}


def _named_tuple(namedtuple: Callable[..., Any]) -> Callable[..., Any]:
    class NamedTupleMeta(type):
        """Makes a class of named tuples of the body of a class."""

        def __new__(cls, name: str, bases: tuple[type, ...], space: dict[str, Any]) -> Any:
            if bases != (base,):
                raise TypeError("can only inherit from a NamedTuple type and Generic")
            for key in space:
                if key in _KEPT:
                    raise AttributeError(f"Cannot overwrite NamedTuple attribute {key}")
            fields = list(space.get("__annotations__", ()))
            optional = [field for field in fields if field in space]
            if optional != fields[len(fields) - len(optional) :]:
                late = next(field for field in fields[fields.index(optional[0]) :] if field not in space)
                raise TypeError(
                    f"Non-default namedtuple field {late} cannot follow default field {', '.join(optional)}"
                )
            plain = namedtuple(name, fields, defaults=[space.pop(field) for field in optional], module="typing")
            # A class of its own on top, not attributes of `plain`, so that `super()` works in its methods.
            return type(name, (plain,), {"__doc__": plain.__doc__, **space, "__slots__": ()})

    base = type.__new__(NamedTupleMeta, "NamedTuple", (), {})

    def named_tuple(typename: str, fields: Any = None, /, **more: Any) -> Any:
        """Return a class of tuples whose elements have names; fields are (name, type) pairs."""
        if fields is not None and more:
            raise TypeError("Either list of fields or keywords can be provided to NamedTuple, not both")
        return namedtuple(typename, [name for name, _ in (more.items() if fields is None else fields)])

    return _extensible(named_tuple, "NamedTuple", base)


def _typed_dict() -> Callable[..., Any]:
    class TypedDictMeta(type):
        """Makes a class whose calls make dicts."""

        def __new__(cls, name: str, bases: tuple[type, ...], space: dict[str, Any]) -> Any:
            if any(type(each) is not TypedDictMeta for each in bases):
                raise TypeError("cannot inherit from both a TypedDict type and a non-TypedDict base class")
            return type.__new__(TypedDictMeta, name, (dict,), space)

        def __call__(cls, *args: Any, **kwargs: Any) -> Any:
            return dict(*args, **kwargs)

        def __instancecheck__(cls, instance: object) -> bool:
            raise TypeError("TypedDict does not support instance and class checks")

        def __subclasscheck__(cls, subclass: type) -> bool:
            raise TypeError("TypedDict does not support instance and class checks")

    base = type.__new__(TypedDictMeta, "TypedDict", (), {})

    def typed_dict(typename: str, fields: Any = (), /, *, total: bool = True) -> Any:
        """Return a class that makes dicts; fields are a dict of types by key."""
        return TypedDictMeta(str(typename), (), {"__annotations__": dict(fields)})

    return _extensible(typed_dict, "TypedDict", base)


def _extensible(function: Callable[..., Any], name: str, base: type) -> Callable[..., Any]:
    """Return the function, as a base of which classes extend `base`."""
    function.__name__ = function.__qualname__ = name
    function.__module__ = "typing"
    function.__mro_entries__ = lambda bases: (base,)  # type: ignore[attr-defined]
    return function
