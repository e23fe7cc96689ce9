"""Frozen dataclasses with slots, and named tuples, whose methods are written when they are first called.

`dataclasses` writes and compiles six methods for each class that a program imports, and importing it takes as long as
twenty such classes. A run makes objects of a third of its classes and compares few of them, so `record` leaves each
method to its first use. All else is as with `@dataclass(frozen=True, slots=True)`: `fields`, `replace`, `asdict`,
`match`, `copy`, `pickle` and type checkers take a record for a dataclass. `NamedTuple` stands for that of `typing`
in the same way. Why: decision record 0014.
"""

from __future__ import annotations

import sys
from reprlib import recursive_repr

try:
    from _collections import _tuplegetter  # type: ignore[import-not-found]
except ImportError:
    # As in `collections`: only CPython has it.
    from operator import itemgetter

    def _tuplegetter(index: int, doc: str) -> property:
        return property(itemgetter(index), doc=doc)


TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
    from dataclasses import replace as replace
    from typing import Any, Final, TypeVar, dataclass_transform
    from typing import NamedTuple as NamedTuple

    Kind = TypeVar("Kind", bound=type)
else:

    def dataclass_transform(**_: object):
        """Stand in for the decorator of `typing`, which only type checkers read."""
        return lambda function: function

    def replace(original, /, **changes):
        """Return a copy of a record with other values of some fields, as `dataclasses.replace` does.

        Raises:
            TypeError: no such field, or one that the constructor does not take.
        """
        for name, field in type(original).__record_fields__.items():
            if field.init and name not in changes:
                changes[name] = getattr(original, name)
        return type(original)(**changes)

    class _Rows(type):
        """Makes the class of a `class Row(NamedTuple)`, in a module with `from __future__ import annotations`."""

        def __new__(cls, name, bases, namespace):
            fields = namespace.get("__annotations__", {})
            if len(bases) != 1 or not fields or not all(isinstance(text, str) for text in fields.values()):
                raise TypeError(f"{name}: a named tuple has annotated fields and no other base")
            names = tuple(fields)
            defaults = {field: namespace.pop(field) for field in names if field in namespace}
            late = _Late("__new__", _new)
            getters = {field: _tuplegetter(index, "") for index, field in enumerate(names)}
            own = {"__slots__": (), "__match_args__": names, "_fields": names, "_field_defaults": defaults}
            late.kind = type(name, (tuple,), {**_OF_ROWS, **getters, **own, "__new__": late, **namespace})
            return late.kind

    _BASE = type.__new__(_Rows, "NamedTuple", (), {})

    class NamedTuple:
        """Stand in for `typing.NamedTuple` as a base class; `class Row(NamedTuple)` is a tuple with names."""

        def __mro_entries__(self, bases):
            return (_BASE,)

    NamedTuple = NamedTuple()


MISSING: Final = object()
"""Default of a field that has none."""


MANY_FIELDS: Final = 6
"""From so many fields on it takes less time to make an object as one of an open twin and then change its class than to
set each slot through its descriptor: half of it for 26 fields."""


class _Factory:
    """Default, in a signature, of a field with a `default_factory`."""

    def __repr__(self) -> str:
        return "<factory>"


_FACTORY: Final = _Factory()

_NO_METADATA: Final[Mapping[str, Any]] = {}


class Field:
    """What is known of a field besides its name; as in `dataclasses.field`."""

    __slots__ = ("compare", "default", "default_factory", "init", "metadata", "repr", "type")

    def __init__(
        self,
        default: Any = MISSING,
        default_factory: Any = MISSING,
        init: bool = True,
        repr: bool = True,
        compare: bool = True,
        metadata: Mapping[str, Any] = _NO_METADATA,
    ) -> None:
        self.default = default
        self.default_factory = default_factory
        self.init = init
        self.repr = repr
        self.compare = compare
        self.metadata = metadata
        self.type = ""
        """The annotation, as it is written."""


def field(
    *,
    default: Any = MISSING,
    default_factory: Any = MISSING,
    init: bool = True,
    repr: bool = True,
    compare: bool = True,
    metadata: Mapping[str, Any] = _NO_METADATA,
) -> Any:
    """Describe a field that needs more than a type and a default; as `dataclasses.field` does."""
    return Field(default, default_factory, init, repr, compare, metadata)


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
def record(kind: Kind) -> Kind:
    """Make a class with annotated fields a frozen dataclass with slots.

    Its module has `from __future__ import annotations`; its fields are neither `ClassVar` nor `InitVar`.

    Raises:
        TypeError: a field of another kind.
    """
    own: dict[str, Field] = {}
    for name, text in kind.__annotations__.items():
        if not isinstance(text, str) or text.startswith(("ClassVar", "InitVar")):
            raise TypeError(f"{kind.__name__}.{name}: a record has no field of the type {text!r}")
        default = kind.__dict__.get(name, MISSING)
        own[name] = default if isinstance(default, Field) else Field(default)
        own[name].type = text
    inherited: dict[str, Field] = {}
    for base in reversed(kind.__mro__):
        inherited.update(base.__dict__.get("__record_fields__", ()))
    fields = inherited | own
    left_out = {*own, *_OF_CLASSES_WITHOUT_SLOTS}
    if kind.__dict__.get("__hash__", MISSING) is None and "__eq__" in kind.__dict__:
        # It was taken away by Python, since the class has an `__eq__` of its own.
        left_out.add("__hash__")
    namespace = {name: value for name, value in kind.__dict__.items() if name not in left_out}
    late = [_Late(name, make) for name, make in _LATE.items() if name not in namespace]
    namespace = {**_COMMON, **{method.name: method for method in late}, **namespace}
    namespace["__slots__"] = tuple(name for name in own if name not in inherited)
    namespace["__match_args__"] = tuple(name for name, field in fields.items() if field.init)
    namespace["__record_fields__"] = fields
    made = type(kind)(kind.__name__, kind.__bases__, namespace)
    made.__qualname__ = kind.__qualname__
    for method in late:
        method.kind = made
    return made


def fields_of(kind: type) -> Mapping[str, Field]:
    """Return the fields of a record by name, in their order."""
    fields: Mapping[str, Field] = kind.__record_fields__  # type: ignore[attr-defined]
    return fields


def is_record(kind: object) -> bool:
    """Return whether this is a class made by `record`."""
    return isinstance(kind, type) and "__record_fields__" in kind.__dict__


class _Late:
    """An attribute of a class that is made when it is first read, and then stands there instead of this object."""

    __slots__ = ("kind", "make", "name")

    def __init__(self, name: str, make: Callable[[type], Any]) -> None:
        self.name = name
        self.make = make
        self.kind: type = object

    def __get__(self, instance: object, owner: type) -> Any:
        value = self.kind.__dict__[self.name]
        if value is self:
            value = self.make(self.kind)
            setattr(self.kind, self.name, value)
        bind = getattr(value, "__get__", None)
        return value if bind is None else bind(instance, owner)


# ---------------------------------------------------------------- what is made late


def _init(kind: type) -> Any:
    parameters = ["self"]
    given_of: dict[str, str] = {}
    values: dict[str, Any] = {}
    annotations: dict[str, Any] = {}
    for name, field in fields_of(kind).items():
        given = name
        if field.default is not MISSING:
            values[f"default_{name}"] = field.default
        if field.default_factory is not MISSING:
            values[f"make_{name}"], values["FACTORY"] = field.default_factory, _FACTORY
            given = f"make_{name}() if {name} is FACTORY else {name}" if field.init else f"make_{name}()"
        if field.init:
            annotations[name] = field.type
            if field.default is not MISSING:
                parameters.append(f"{name}=default_{name}")
            else:
                parameters.append(name if field.default_factory is MISSING else f"{name}=FACTORY")
        elif field.default is not MISSING:
            given = f"default_{name}"
        elif field.default_factory is MISSING:
            # `__post_init__` sets it.
            continue
        given_of[name] = given
    # Slots are set past `__setattr__`, which refuses.
    values |= {f"set_{name}": getattr(kind, name).__set__ for name in given_of}
    lines = [f"set_{name}(self, {given})" for name, given in given_of.items()]
    if len(given_of) >= MANY_FIELDS:
        values |= {"KIND": kind, "OPEN": _open_twin(kind), "become": object.__dict__["__class__"].__set__}
        setting = [f"self.{name} = {given}" for name, given in given_of.items()]
        at_once = ["become(self, OPEN)", *setting, "self.__class__ = KIND"]
        lines = _branch("if self.__class__ is KIND:", at_once) + _branch("else:", lines)
    if hasattr(kind, "__post_init__"):
        lines.append("self.__post_init__()")
    init = _written(kind, "__init__", ", ".join(parameters), lines or ["pass"], values)
    init.__annotations__ = {**annotations, "return": None}
    return init


def _open_twin(kind: type) -> type:
    """Return a class of the same layout whose attributes can be set."""
    can_be_set = {"__setattr__": object.__setattr__, "__delattr__": object.__delattr__}
    return type(kind)(kind.__name__, kind.__bases__, {"__slots__": kind.__dict__["__slots__"], **can_be_set})


def _branch(head: str, lines: list[str]) -> list[str]:
    return [head, *[f" {line}" for line in lines]]


def _eq(kind: type) -> Any:
    ours, theirs = _compared(kind, "self"), _compared(kind, "other")
    lines = [f"return {ours} == {theirs} if other.__class__ is self.__class__ else NotImplemented"]
    return _written(kind, "__eq__", "self, other", lines, {})


def _hash(kind: type) -> Any:
    return _written(kind, "__hash__", "self", [f"return hash({_compared(kind, 'self')})"], {})


def _compared(kind: type, name: str) -> str:
    """Return a display of the tuple of the fields that are compared."""
    return f"({''.join(f'{name}.{row},' for row, field in fields_of(kind).items() if field.compare)})"


def _written(kind: type, name: str, parameters: str, lines: list[str], values: dict[str, Any]) -> Any:
    """Return a function of these lines, in which `values` are names besides those of the module of the class."""
    body = "".join(f"\n  {line}" for line in lines)
    text = f"def written({', '.join(values)}):\n def {name}({parameters}):{body}\n return {name}"
    namespace: dict[str, Any] = {}
    # A method may be needed when the module is gone: at the end of the process, or after a test that loads it anew.
    exec(text, getattr(sys.modules.get(kind.__module__), "__dict__", {}), namespace)
    function = namespace["written"](**values)
    function.__qualname__ = f"{kind.__qualname__}.{name}"
    return function


def _dataclass_attribute(name: str) -> Callable[[type], Any]:
    """Return the function that makes an attribute by which `dataclasses` knows its classes."""

    def make(kind: type) -> Any:
        import dataclasses

        namespace: dict[str, Any] = {"__module__": kind.__module__, "__annotations__": {}}
        for name_of_field in kind.__annotations__:
            about = fields_of(kind)[name_of_field]
            given = {key: getattr(about, key) for key in ("init", "repr", "compare", "metadata")}
            for key in ("default", "default_factory"):
                if getattr(about, key) is not MISSING:
                    given[key] = getattr(about, key)
            namespace["__annotations__"][name_of_field] = about.type
            namespace[name_of_field] = dataclasses.field(**given)
        twin = type(kind.__name__, kind.__bases__, namespace)
        return getattr(dataclasses.dataclass(frozen=True, slots=True)(twin), name)

    return make


def _new(kind: Any) -> Any:
    defaults = kind._field_defaults
    values = {"new": tuple.__new__, **{f"default_{name}": value for name, value in defaults.items()}}
    parameters = [f"{name}=default_{name}" if name in defaults else name for name in kind._fields]
    lines = [f"return new(_cls, ({''.join(f'{name},' for name in kind._fields)}))"]
    new = _written(kind, "__new__", ", ".join(("_cls", *parameters)), lines, values)
    new.__annotations__ = kind.__annotations__
    return staticmethod(new)


# ---------------------------------------------------------------- what all records share


@recursive_repr()
def _repr(self: Any) -> str:
    shown = (f"{name}={getattr(self, name)!r}" for name, field in self.__record_fields__.items() if field.repr)
    return f"{type(self).__qualname__}({', '.join(shown)})"


def _refuse_setting(self: object, name: str, value: object) -> None:
    from dataclasses import FrozenInstanceError

    raise FrozenInstanceError(f"cannot assign to field {name!r}")


def _refuse_deleting(self: object, name: str) -> None:
    from dataclasses import FrozenInstanceError

    raise FrozenInstanceError(f"cannot delete field {name!r}")


def _state(self: Any) -> list[Any]:
    return [getattr(self, name) for name in self.__record_fields__]


def _set_state(self: Any, state: list[Any]) -> None:
    for name, value in zip(self.__record_fields__, state, strict=True):
        object.__setattr__(self, name, value)


def _row_repr(self: Any) -> str:
    shown = (f"{name}={value!r}" for name, value in zip(self._fields, self, strict=True))
    return f"{type(self).__name__}({', '.join(shown)})"


def _row_of(kind: Any, values: Iterable[Any]) -> Any:
    row = tuple.__new__(kind, values)
    if len(row) != len(kind._fields):
        raise TypeError(f"Expected {len(kind._fields)} arguments, got {len(row)}")
    return row


def _row_replaced(self: Any, /, **changes: Any) -> Any:
    row = self._make(map(changes.pop, self._fields, self))
    if changes:
        error = TypeError if sys.version_info >= (3, 13) else ValueError
        raise error(f"Got unexpected field names: {list(changes)!r}")
    return row


_OF_ROWS: Final = {
    "__repr__": _row_repr,
    "__getnewargs__": lambda self: tuple(self),
    "__replace__": _row_replaced,
    "_asdict": lambda self: dict(zip(self._fields, self, strict=True)),
    "_make": classmethod(_row_of),
    "_replace": _row_replaced,
}
"""Methods that all named tuples share."""

_LATE: Final = {
    "__init__": _init,
    "__eq__": _eq,
    "__hash__": _hash,
    "__dataclass_fields__": _dataclass_attribute("__dataclass_fields__"),
    "__dataclass_params__": _dataclass_attribute("__dataclass_params__"),
}

_COMMON: Final = {
    "__repr__": _repr,
    "__setattr__": _refuse_setting,
    "__delattr__": _refuse_deleting,
    "__getstate__": _state,
    "__setstate__": _set_state,
    "__replace__": replace,
}

_OF_CLASSES_WITHOUT_SLOTS: Final = ("__dict__", "__weakref__")
