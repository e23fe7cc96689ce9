"""Values of programs as text and as trees, without running code of the program and without addresses."""

from __future__ import annotations

from itertools import islice
from types import BuiltinFunctionType, FunctionType, GeneratorType, MethodType
from typing import Any, Final

from elitescript.debugger.expressions import own_fields
from elitescript.runtime.alarms import without_addresses
from elitescript.runtime.names.modules import Facade
from elitescript.runtime.stdlib.locks import holder_of, is_lock

TEXT_MAX: Final = 2000
_ITEMS_MAX: Final = 100
_DEPTH_MAX: Final = 6

POSE: Final = ("x", "y", "z", "rx", "ry", "rz")
JOINTS: Final = ("base", "shoulder", "elbow", "wrist1", "wrist2", "wrist3")

_SIMPLE: Final = (bool, int, float, complex, type(None), type(...), range, slice)
_SEQUENCES: Final = (list, tuple, bytes, bytearray)
"""Types whose items are shown by index. Not those of a range: its text says all, and it can be endless."""
_BRACKETS: Final[dict[type, tuple[str, str]]] = {
    list: ("[", "]"),
    tuple: ("(", ")"),
    set: ("{", "}"),
    frozenset: ("{", "}"),
}


class Pose(tuple[float, ...]):
    """Six numbers that are a pose: x, y, z in m, a rotation vector or roll, pitch, yaw in rad."""

    __slots__ = ()


class Joints(tuple[float, ...]):
    """Six numbers that belong to the joints."""

    __slots__ = ()


class Group(dict[str, Any]):
    """Named values that are shown as a tree."""

    __slots__ = ()


def shown(value: Any) -> str:
    """Return a value as text: the same in every execution."""
    text = _text(value, 0, [TEXT_MAX])
    return text if len(text) <= TEXT_MAX else f"{text[: TEXT_MAX - 3]}..."


def type_name(value: Any) -> str:
    """Return what kind of value it is."""
    if isinstance(value, Pose):
        return "pose"
    if isinstance(value, Joints):
        return "joints"
    if isinstance(value, Group):
        return ""
    if isinstance(value, FunctionType | BuiltinFunctionType | MethodType):
        return "function"
    if type(value) is Facade:
        return "module"
    kind = type(value)
    if kind is type(None):
        return "None"
    return "class" if issubclass(kind, type) else str(type.__dict__["__name__"].__get__(kind))


def indexed_part(value: Any, start: int, count: int) -> list[tuple[str, Any, str]] | None:
    """Return some of the indexed children of a list or text of bytes; None for other values.

    Args:
        start: index of the first one.
        count: how many at most; 0 for all that follow.
    """
    if type(value) not in _SEQUENCES:
        return None
    end = min(start + count, len(value)) if count else len(value)
    return [(f"[{index}]", value[index], f"[{index}]") for index in range(start, end)]


def children(value: Any) -> tuple[list[tuple[str, Any, str]], list[tuple[str, Any, str]]]:
    """Return what a value holds: named and indexed children, each as name, value and what follows its expression."""
    kind = type(value)
    if kind is Group:
        return [(name, item, "") for name, item in value.items()], []
    if kind is Pose:
        return [(name, item, f"[{n}]") for n, (name, item) in enumerate(zip(POSE, value, strict=False))], []
    if kind is Joints:
        return [(name, item, f"[{n}]") for n, (name, item) in enumerate(zip(JOINTS, value, strict=False))], []
    if (indexed := indexed_part(value, 0, 0)) is not None:
        return [], indexed
    if kind in (set, frozenset):
        return [], [(f"[{index}]", item, "") for index, item in enumerate(sorted(value, key=shown))]
    if kind is dict:
        return [(shown(key), item, f"[{shown(key)}]" if _is_literal(key) else "") for key, item in value.items()], []
    if kind in _SIMPLE or kind is str or isinstance(value, type | FunctionType | BuiltinFunctionType | MethodType):
        return [], []
    if kind is Facade or isinstance(value, GeneratorType):
        return [], []
    return [(name, item, f".{name}") for name, item in own_fields(value).items()], []


def count_children(value: Any) -> tuple[int, int]:
    """Return how many named and indexed children a value has."""
    kind = type(value)
    if kind in _SEQUENCES or kind in (set, frozenset):
        return 0, len(value)
    if kind in (dict, Group):
        return len(value), 0
    named, indexed = children(value)
    return len(named), len(indexed)


def _is_literal(key: Any) -> bool:
    return type(key) in (bool, int, float, str, bytes, type(None))


def _text(value: Any, depth: int, left: list[int]) -> str:
    """Return a value as text.

    Args:
        value: any.
        depth: values that it is in.
        left: how many values may still be looked at. Each gives a character at least, so what is left out when none is
            left stands behind the longest text that is shown.
    """
    kind = type(value)
    left[0] -= 1
    if left[0] < 0:
        return "..."
    if kind in _SIMPLE:
        return _number(value)
    if kind in (str, bytes, bytearray):
        return repr(value[:TEXT_MAX])
    if depth > _DEPTH_MAX:
        return "..."
    if kind is Pose or kind is Joints:
        return f"[{', '.join(f'{item:.6g}' for item in value)}]"
    if kind is Group:
        return ", ".join(f"{name} {_text(item, depth + 1, left)}" for name, item in islice(value.items(), _ITEMS_MAX))
    if kind in _BRACKETS:
        return _sequence(value, kind, depth, left)
    if kind is dict:
        first = islice(value.items(), _ITEMS_MAX)
        pairs = [f"{_text(key, depth + 1, left)}: {_text(item, depth + 1, left)}" for key, item in first]
        return "{" + ", ".join([*pairs, *(["..."] if len(value) > _ITEMS_MAX else [])]) + "}"
    if isinstance(value, FunctionType | BuiltinFunctionType):
        return f"function {value.__qualname__.rpartition('<locals>.')[2]}"
    if isinstance(value, MethodType):
        return f"method {value.__func__.__name__}"
    if kind is Facade:
        return without_addresses(repr(value))
    if is_lock(value):
        holder = holder_of(value)
        return f"<lock, {f'held by {holder.name}' if holder is not None else 'free'}>"
    if issubclass(kind, type):
        return f"class {type.__dict__['__name__'].__get__(value)}"
    if issubclass(kind, BaseException) and kind.__module__ == "builtins":
        return f"{kind.__name__}({', '.join(_text(item, depth + 1, left) for item in value.args[:_ITEMS_MAX])})"
    return f"<{type.__dict__['__name__'].__get__(kind)}>"


def _number(value: Any) -> str:
    try:
        return repr(value)
    except ValueError:
        return f"an int of {value.bit_length()} bits"


def _sequence(value: Any, kind: type, depth: int, left: list[int]) -> str:
    if kind in (set, frozenset):
        if not value:
            return f"{kind.__name__}()"
        if len(value) > left[0]:
            return f"{kind.__name__} of {len(value)} items"
        # Their order is not that of the text, so each gets the same share.
        share = left[0] // len(value)
        left[0] -= len(value)
        parts = sorted(_text(item, depth + 1, [share]) for item in value)[:_ITEMS_MAX]
    else:
        parts = [_text(item, depth + 1, left) for item in value[:_ITEMS_MAX]]
    opening, closing = _BRACKETS[kind]
    more = ["..."] if len(value) > _ITEMS_MAX else []
    only = "," if kind is tuple and len(value) == 1 else ""
    return f"{opening}{', '.join([*parts, *more])}{only}{closing}"
