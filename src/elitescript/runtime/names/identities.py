"""Numbers objects where Python would take an address, so that `id`, `hash` and the order of sets repeat.

An address differs from run to run, and with it all that follows from it. A number is given when it is first needed: by
`id`, by `object.__hash__`, by the hash of a class. Nothing else is changed: a class that has or inherits a hash or an
equality of its own keeps it, wherever it stands among the bases.

Sets and dicts ask for hashes in C, past every name of a program. So the classes of a program that can show the order of
a set (`language.hash_order`) get a metaclass, which numbers them, and one more class in front of `object` in their
method resolution order, which numbers their objects. Classes of other programs are made by Python alone.
"""

from __future__ import annotations

import builtins
import gc
from collections.abc import Callable, Iterable
from sys import getrefcount, getsizeof
from types import FunctionType, GenericAlias, MethodType, MethodWrapperType, resolve_bases
from typing import Any, Final
from weakref import ref

from elitescript.sealed import Sealed

STEP: Final = 16
"""Distance of two numbers, which look like addresses; a hash is the number divided by it, as in Python."""
_HELD_MIN: Final = 1000
_HELD_BYTES_MIN: Final = 4_000_000
"""So many objects without weak references, or bytes of them, are held before the first search for unused ones."""
_REACHED_MAX: Final = 200_000
"""Objects that a search for unused cycles looks at; if there are more, all count as used."""

_OWN_COPIES: Final = frozenset((int, float, bool, complex, str, bytes, range, type, FunctionType, type(None)))
"""Classes of values that `copy.deepcopy` returns as they are."""

_OBJECT_HASH: Final[object] = object.__hash__
_FLOAT_HASH: Final[object] = float.__hash__
_SHOWN: Final = "@shown"
"""Attribute of our metaclasses that no program can name: the one that it stands for."""


class _Reference(ref):  # type: ignore[type-arg]
    """A weak reference that knows the address of its object."""

    __slots__ = ("key",)

    key: int


class Identities:
    """The numbers of the objects of one run; that of an object stays the same as long as it lives.

    An object that can have a weak reference is forgotten when it dies. Others are held, and let go when nothing else
    holds them: the newest at the next call, all that are unused whenever they have become twice as many.

    Attributes:
        object_hash: `object.__hash__` for programs.
    """

    __slots__ = (
        "_count",
        "_forget",
        "_held",
        "_held_bytes",
        "_held_limits",
        "_known",
        "object_hash",
    )

    def __init__(self) -> None:
        self._known: dict[int, tuple[int, Any]] = {}
        """Number, and the object or its weak reference, by address."""
        self._held: list[int] = []
        """Addresses of the objects that are held, the newest last."""
        self._held_bytes = 0
        self._held_limits = _HELD_MIN, _HELD_BYTES_MIN
        self._count = 0
        known = self._known

        def forget(reference: _Reference) -> None:
            known.pop(reference.key, None)

        def __hash__(self: Any, /) -> int:
            """Return hash(self)."""
            entry = known.get(id(self))
            return (add(self) if entry is None else entry[0]) // STEP

        self._forget = forget
        add = self._add
        __hash__.__qualname__ = "object.__hash__"
        self.object_hash = __hash__

    def number(self, value: Any) -> int:
        """Return the number of an object."""
        entry = self._known.get(id(value))
        return self._add(value) if entry is None else entry[0]

    def number_for_copies(self, value: Any) -> int:
        """Return the number of an object; 0 for a value that is its own copy, of which `copy` notes nothing."""
        if type(value) in _OWN_COPIES:
            return 0
        entry = self._known.get(id(value))
        return self._add(value) if entry is None else entry[0]

    def hash_of(self, value: Any) -> int:
        """Return `hash(value)`; the number of an object whose hash would follow from its address."""
        if type(value).__hash__ is _OBJECT_HASH or _is_hashed_nan(value):
            return self.number(value) // STEP
        return hash(value)

    def hash_method(self, value: Any) -> Any:
        """Return `value.__hash__`; for that of `object` the one that gives numbers."""
        method = value.__hash__
        if method is _OBJECT_HASH:
            return self.object_hash
        if _is_hashed_nan(value):
            return MethodType(self.object_hash, value)
        if type(method) is MethodWrapperType and method.__qualname__ == "object.__hash__":
            return MethodType(self.object_hash, method.__self__)
        return method

    def class_builder(self) -> Callable[..., type]:
        """Return `__build_class__` for classes that are hashed by number, as are their objects."""
        return _class_builder(self)

    def clear(self) -> None:
        """Forget all objects."""
        self._known.clear()
        self._held.clear()
        self._held_bytes = 0

    # ---------------------------------------------------------------- what is known

    def _add(self, value: Any) -> int:
        self._count += 1
        number = STEP * self._count
        key = id(value)
        try:
            reference = _Reference(value, self._forget)
        except TypeError:
            self._hold(key, number, value)
        else:
            reference.key = key
            self._known[key] = number, reference
        return number

    def _hold(self, key: int, number: int, value: Any) -> None:
        while self._held and self._is_unused(self._held[-1]):
            self._release(self._held.pop())
        self._known[key] = number, value
        self._held.append(key)
        self._held_bytes += _size_of(value)
        most, most_bytes = self._held_limits
        if len(self._held) > most or self._held_bytes > most_bytes:
            self._sweep()
            self._held_limits = max(_HELD_MIN, 2 * len(self._held)), max(_HELD_BYTES_MIN, 2 * self._held_bytes)

    def _is_unused(self, key: int) -> bool:
        return getrefcount(self._known[key][1]) == _ALONE

    def _release(self, key: int) -> None:
        self._held_bytes -= _size_of(self._known[key][1])
        del self._known[key]

    def _sweep(self) -> None:
        """Let go of what nothing else holds, the inner ones after the outer ones, then of unused cycles."""
        before = len(self._held) + 1
        while len(self._held) < before:
            before = len(self._held)
            self._keep(key for key in reversed(self._held) if self._is_unused(key))
        self._keep(_unused({key: self._known[key][1] for key in self._held}))

    def _keep(self, unused: Iterable[int]) -> None:
        gone = set()
        for key in unused:
            gone.add(key)
            self._release(key)
        if gone:
            self._held = [key for key in self._held if key not in gone]


def _alone() -> int:
    known: dict[int, tuple[int, object]] = {0: (0, [])}
    return getrefcount(known[0][1])


_ALONE: Final = _alone()
"""Count of the references to an object that is held here alone."""


def _size_of(value: Any) -> int:
    # The method could be one of the program.
    return getsizeof(value) if type(value) in (list, dict, tuple, str, bytes, bytearray, int) else 0


def _unused(held: dict[int, Any]) -> list[int]:
    """Return the keys of objects that only other unused objects refer to, as the collector of Python finds them.

    Args:
        held: objects that one tuple holds besides, by address.
    """
    found = list(held.values())
    places = {id(value): place for place, value in enumerate(found)}
    inner = [0] * len(found)
    referred: list[list[int]] = []
    for value in found:
        own = []
        for other in gc.get_referents(value) if gc.is_tracked(value) else ():
            place = places.get(id(other))
            if place is None:
                if isinstance(other, type) or not gc.is_tracked(other) or callable(other):
                    continue
                place = places[id(other)] = len(found)
                found.append(other)
                inner.append(0)
                if place > _REACHED_MAX:
                    return []
            inner[place] += 1
            own.append(place)
        referred.append(own)
    value = other = None  # they would count as references
    # One reference is in `found`, one the argument; a held one is in its tuple and in `held` too.
    rest = [2 + 2 * (place < len(held)) for place in range(len(found))]
    pending = [place for place in range(len(found)) if getrefcount(found[place]) > inner[place] + rest[place]]
    used = set(pending)
    while pending:
        for place in referred[pending.pop()]:
            if place not in used:
                used.add(place)
                pending.append(place)
    return [key for place, key in enumerate(held) if place not in used]


# ---------------------------------------------------------------- classes


def _is_hashed_nan(value: Any) -> bool:
    """Return whether this is a float that is not a number and has the hash of floats, which is its address then."""
    return type(value).__hash__ is _FLOAT_HASH and bool(float.__ne__(value, value))


class _OneArgument(Sealed):
    """Makes `type` a function of one argument that is still usable in `isinstance`."""

    def __call__(cls, *args: Any, **kwargs: Any) -> Any:
        if len(args) != 1 or kwargs:
            from elitescript.errors import ScriptPermissionError

            raise ScriptPermissionError("type() takes one object; write `class` to make a class")
        return shown_class(type(args[0]))

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
    __class_getitem__: Any = classmethod(GenericAlias)
    __call__ = type.__call__
    """Not called; classes are callable, and abstract classes look for it here."""


# Messages of Python name the class of an object.
for _kind in (_OneArgument, OneArgumentType):
    type.__setattr__(_kind, "__name__", "type")


def shown_class(kind: Any) -> Any:
    """Return a class as programs see it: `type` for metaclasses that number or seal, and for that of Python."""
    if isinstance(kind, type) and issubclass(kind, type):
        kind = type if issubclass(kind, Sealed) else vars(kind).get(_SHOWN, kind)
        return OneArgumentType if kind is type else kind
    return kind


def _class_builder(identities: Identities) -> Callable[..., type]:
    build: Any = builtins.__build_class__
    metaclasses: dict[type, type] = {}

    def metaclass_for(kind: type) -> type:
        """Return the metaclass that numbers, in place of another one."""
        found = metaclasses.get(kind)
        if found is None:
            if not metaclasses:
                metaclasses[type] = _numbering(identities)
            if kind is type:
                return metaclasses[type]
            bases = [metaclass_for(base) for base in kind.__bases__ if base is not type] or [metaclasses[type]]
            found = metaclasses[kind] = type(
                kind.__name__, (*bases, kind), {"__module__": kind.__module__, "__slots__": (), _SHOWN: kind}
            )
        return found

    def build_class(body: Callable[..., Any], name: str, *bases: Any, **options: Any) -> type:
        kind = _metaclass_of(resolve_bases(bases), options.get("metaclass", type))
        if kind is not None:
            options["metaclass"] = metaclass_for(kind)
        made: type = build(body, name, *bases, **options)
        return made

    return build_class


def _metaclass_of(bases: tuple[Any, ...], kind: Any) -> type | None:
    """Return the metaclass that Python would take; None for what is made without a number."""
    for base in bases:
        other = type(base)
        if not isinstance(base, type) or issubclass(base, type):
            return None
        other = vars(other).get(_SHOWN, other)
        if issubclass(other, kind):
            kind = other
        elif not issubclass(kind, other):
            # Python says why.
            return None
    return kind if isinstance(kind, type) else None


def _numbering(identities: Identities) -> type:
    """Return the metaclass of classes that are hashed by number, as are their objects."""

    class Hashed:
        """Stands in front of `object`."""

        __slots__ = ()
        __hash__ = identities.object_hash

    def mro(cls: type) -> list[type]:
        order = [kind for kind in type.mro(cls) if kind is not Hashed]
        return [*order[:-1], Hashed, object]

    space = {"mro": mro, "__hash__": identities.object_hash, "__module__": "builtins", "__slots__": (), _SHOWN: type}
    return type("type", (type,), space)
