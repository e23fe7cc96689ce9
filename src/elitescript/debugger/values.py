"""Values of programs as text and as trees, without running code of the program and without addresses."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable
from itertools import islice
from math import isfinite
from types import BuiltinFunctionType, FunctionType, GeneratorType, MethodType
from typing import Any, Final

from elitescript.records import NamedTuple
from elitescript.runtime.environment import without_addresses
from elitescript.runtime.names.modules import Facade
from elitescript.runtime.stdlib.locks import holder_of, is_lock
from elitescript.values.concrete import own_fields
from elitescript.values.places import JOINTS, POSE

TEXT_MAX: Final = 2000
"""Characters of the text of a value, but for what says how much is left out."""
CHILDREN_MAX: Final = 100
"""Children of a value that are shown where no part of them is asked for, and items in the text of a value."""
PART_MAX: Final = 1000
"""Children that are shown at once, however many are asked for; of scopes also where no part is."""
_ROOM: Final = 100_000
"""Characters of the texts of all children that are shown at once."""
_CHILD_TEXT_MIN: Final = 100
_KEY_MAX: Final = 500
"""Characters of the name of a child of a dict."""
_SORTED_MAX: Final = 1000
"""Items of a set that is shown in the order of their texts; larger ones in that of the set."""
_KEYS_COMPARED_MAX: Final = 1000
"""Keys of a dict that are compared as text with the name of a child."""
_DEPTH_MAX: Final = 6

_SIMPLE: Final = (bool, int, float, complex, type(None), type(...), range)
_SEQUENCES: Final = (list, tuple, bytes, bytearray)
"""Types whose items are shown by index. Not those of a range: its text says all, and it can be endless."""
_SETS: Final = (set, frozenset)
_INDEX_DIGITS: Final = 12
_QUOTED_MIN: Final = 20
_QUOTES: Final = 3
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


class Child(NamedTuple):
    """Something that a value holds.

    Attributes:
        name: as it is shown.
        value: of it.
        path: what follows the expression of its holder to give it; empty if nothing does.
    """

    name: str
    value: Any
    path: str


def shown(value: Any, room: int = TEXT_MAX) -> str:
    """Return a value as text: the same in every execution. What is left out is counted: `… 99,900 more`.

    Args:
        value: any.
        room: characters that the text may have, about.
    """
    return _text(value, 0, room, [room])


def more(count: int) -> str:
    """Return the words for things that are left out."""
    return f"… {count:,} more"


def room_of_each(count: int) -> int:
    """Return how many characters the text of each of some children may have."""
    return min(TEXT_MAX, max(_CHILD_TEXT_MIN, _ROOM // max(count, 1)))


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


def count_children(value: Any) -> tuple[int, int]:
    """Return how many named and indexed children a value has: one of both is 0.

    Those of a large dict are indexed, since clients of the debug protocol ask for indexed children in parts alone.
    """
    kind = type(value)
    if kind in _SEQUENCES or kind in _SETS:
        return 0, len(value)
    if kind is Group:
        return len(value), 0
    if kind is Pose or kind is Joints:
        return min(len(value), 6), 0
    count = len(value) if kind is dict else len(_fields_of(value))
    return (0, count) if count > CHILDREN_MAX else (count, 0)


def children(value: Any, start: int, end: int) -> list[Child]:
    """Return some of the children of a value, in the order in which they are shown.

    Args:
        value: any.
        start: number of the first one, from 0.
        end: of the first one that is not wanted.
    """
    kind = type(value)
    if kind in _SEQUENCES:
        return [Child(f"[{index}]", value[index], f"[{index}]") for index in range(start, min(end, len(value)))]
    if kind in _SETS:
        items = sorted(value, key=shown)[start:end] if len(value) <= _SORTED_MAX else islice(value, start, end)
        return [Child(f"[{index}]", item, "") for index, item in enumerate(items, start)]
    if kind is Group:
        return [Child(name, item, "") for name, item in islice(value.items(), start, end)]
    if kind is Pose or kind is Joints:
        names = POSE if kind is Pose else JOINTS
        found = [Child(name, item, f"[{n}]") for n, (name, item) in enumerate(zip(names, value, strict=False))]
        return found[start:end]
    if kind is dict:
        return [_entry(key, item) for key, item in islice(value.items(), start, end)]
    return [Child(str(name), item, f".{name}") for name, item in islice(_fields_of(value).items(), start, end)]


def child_named(value: Any, name: str) -> Child | None:
    """Return the child of a value that is shown under a name; None if there is none."""
    kind = type(value)
    if kind in _SEQUENCES or kind in _SETS:
        index = name[1:-1]
        is_index = name == f"[{index}]" and index.isdecimal() and index.isascii() and len(index) < _INDEX_DIGITS
        found = children(value, int(index), int(index) + 1) if is_index else []
        return found[0] if found and found[0].name == name else None
    if kind is dict:
        return _entry_named(value, name)
    if kind is Pose or kind is Joints:
        return next((child for child in children(value, 0, 6) if child.name == name), None)
    held = value if kind is Group else _fields_of(value)
    return Child(name, held[name], "" if kind is Group else f".{name}") if name in held else None


def _entry(key: Any, item: Any) -> Child:
    literal = _literal_of(key)
    return Child(shown(key, _KEY_MAX), item, f"[{literal}]" if literal else "")


def _entry_named(value: dict[Any, Any], name: str) -> Child | None:
    """Return an entry of a dict by its name, without comparing keys of the program's classes."""
    try:
        wanted = ast.literal_eval(name)
    except (ValueError, SyntaxError, MemoryError, RecursionError):
        wanted = None
    if _literal_of(wanted):
        kind = type(wanted)
        for key, item in value.items():
            if type(key) is kind and key == wanted:
                return _entry(key, item)
    for key, item in islice(value.items(), _KEYS_COMPARED_MAX):
        if shown(key, _KEY_MAX) == name:
            return _entry(key, item)
    return None


def _fields_of(value: Any) -> dict[str, Any]:
    """Return what an object of a program's class holds; nothing for any other value."""
    kind = type(value)
    if kind in _SIMPLE or kind in (str, slice, Facade):
        return {}
    if isinstance(value, type | FunctionType | BuiltinFunctionType | MethodType | GeneratorType):
        return {}
    return own_fields(value)


def _literal_of(key: Any) -> str:
    """Return what stands for a key in an expression; empty if nothing does, or too much."""
    kind = type(key)
    if kind in (str, bytes):
        return repr(key) if len(key) <= _KEY_MAX else ""
    if kind is int:
        return repr(key) if key.bit_length() <= _KEY_MAX else ""
    return repr(key) if kind in (bool, type(None)) or (kind is float and isfinite(key)) else ""


def _text(value: Any, depth: int, room: int, left: list[int]) -> str:
    """Return a value as text.

    Args:
        value: any.
        depth: values that it is in.
        room: characters that the text may have, about.
        left: how many values may still be looked at.
    """
    kind = type(value)
    left[0] -= 1
    if left[0] < 0:
        return "…"
    if kind in _SIMPLE:
        return _cut(_number(value), room)
    if kind in (str, bytes, bytearray):
        return _quoted(value, room)
    if depth > _DEPTH_MAX:
        return "…"
    if kind is Pose or kind is Joints:
        return f"[{', '.join(f'{item:.6g}' for item in value)}]"
    if kind is Group:
        return _list(
            value.items(), len(value), lambda one, room: f"{one[0]} {_text(one[1], depth + 1, room, left)}", room
        )
    if kind in _BRACKETS:
        return _sequence(value, kind, depth, room, left)
    if kind is dict:

        def pair(one: tuple[Any, Any], room: int) -> str:
            key = _text(one[0], depth + 1, room, left)
            return f"{key}: {_text(one[1], depth + 1, max(room - len(key), 1), left)}"

        return "{" + _list(value.items(), len(value), pair, room) + "}"
    if kind is slice:
        parts = (_text(part, depth + 1, room // 3, left) for part in (value.start, value.stop, value.step))
        return f"slice({', '.join(parts)})"
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
        arguments = _list(value.args, len(value.args), lambda item, room: _text(item, depth + 1, room, left), room)
        return f"{kind.__name__}({arguments})"
    return f"<{type.__dict__['__name__'].__get__(kind)}>"


def _number(value: Any) -> str:
    try:
        return repr(value)
    except ValueError:
        return f"an int of {value.bit_length()} bits"


def _cut(text: str, room: int) -> str:
    return text if len(text) <= room else f"{text[:room]}{more(len(text) - room)}"


def _quoted(value: str | bytes | bytearray, room: int) -> str:
    """Return a text in quotes; of a long one the begin."""
    kept = min(len(value), room)
    text = repr(value[:kept])
    if len(text) > room + _QUOTES and len(value) > _QUOTED_MIN:
        # What is written as an escape takes more room.
        kept = max(kept * room // len(text), _QUOTED_MIN)
        text = repr(value[:kept])
    return text if kept == len(value) else f"{text}{more(len(value) - kept)}"


def _sequence(value: Any, kind: type, depth: int, room: int, left: list[int]) -> str:
    items = value
    if kind in _SETS:
        if not value:
            return f"{kind.__name__}()"
        if len(value) <= left[0]:
            # Their order is that of their texts, not that in which they are looked at: each gets the same share.
            share = left[0] // len(value)
            left[0] -= len(value)
            texts = sorted(_text(item, depth + 1, room, [share]) for item in value)
            return f"{{{_list(texts, len(texts), lambda text, room: text, room)}}}"
    opening, closing = _BRACKETS[kind]
    only = "," if kind is tuple and len(value) == 1 else ""
    text = _list(items, len(items), lambda item, room: _text(item, depth + 1, room, left), room)
    return f"{opening}{text}{only}{closing}"


def _list(items: Iterable[Any], count: int, text_of: Callable[[Any, int], str], room: int) -> str:
    """Return items as text, as many as there is room for, and how many more there are."""
    texts: list[str] = []
    for item in islice(items, CHILDREN_MAX):
        if room <= 0:
            break
        texts.append(text_of(item, room))
        room -= len(texts[-1]) + 2
    if count > len(texts):
        texts.append(more(count - len(texts)))
    return ", ".join(texts)
