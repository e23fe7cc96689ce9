"""Makes classes for objects whose state scripts cannot reach.

A hidden slot is storage in every instance without an attribute: its descriptor is taken out of the class, so
no attribute name leads to it. A sealed class cannot be patched, so one program cannot change it for the next.
"""

from __future__ import annotations

from typing import Any, NoReturn


class Sealed(type):
    """Metaclass of classes that scripts can see and must not change."""

    def __setattr__(cls, name: str, value: object) -> NoReturn:
        raise TypeError(f"cannot set {name!r} of the type {cls.__name__!r}")

    def __delattr__(cls, name: str) -> NoReturn:
        raise TypeError(f"cannot delete {name!r} of the type {cls.__name__!r}")


def hidden_slot(cls: type, name: str) -> Any:
    """Take the descriptor of a slot out of its class; `.__get__(instance)` and `.__set__(instance, value)` remain."""
    descriptor = cls.__dict__[name]
    type.__delattr__(cls, name)
    return descriptor


def no_copy(self: object, protocol: object = None) -> NoReturn:
    """Refuse to copy or pickle: `__reduce_ex__` of objects with hidden state."""
    raise TypeError(f"cannot copy or pickle {type(self).__name__!r} object")
