"""The signatures of classes as texts, as `inspect` writes them; `dataclass` puts them into docstrings.

`inspect` itself takes longer to import than most programs run.
"""

from __future__ import annotations

import re
from types import FunctionType, GenericAlias
from typing import Any, Final

_ARGS: Final = 4
_KEYWORDS: Final = 8
_OBJECT_INIT: Final[object] = object.__init__


def signature_of(kind: type) -> str:
    """Return the parameters of a class without `self`, as in `(x: int, *, y: float = 0.5) -> None`.

    Raises:
        ValueError: its `__init__` is not written in Python.
    """
    init = kind.__init__  # type: ignore[misc]
    if init is _OBJECT_INIT:
        return "()"
    if type(init) is not FunctionType:
        raise ValueError(f"no signature found for builtin type {kind!r}")
    code = init.__code__
    notes = init.__annotations__
    names = code.co_varnames
    count, last = code.co_argcount, code.co_argcount + code.co_kwonlyargcount
    given = init.__defaults__ or ()
    defaults = dict(zip(names[count - len(given) : count], given, strict=True)) | (init.__kwdefaults__ or {})
    parts = []
    for place in range(1, count):
        parts.append(_parameter(names[place], notes, defaults))
        if place == code.co_posonlyargcount - 1:
            parts.append("/")
    if code.co_flags & _ARGS:
        parts.append(f"*{_parameter(names[last], notes, {})}")
        last += 1
    elif code.co_kwonlyargcount:
        parts.append("*")
    parts += [_parameter(name, notes, defaults) for name in names[count : count + code.co_kwonlyargcount]]
    if code.co_flags & _KEYWORDS:
        parts.append(f"**{_parameter(names[last], notes, {})}")
    result = f" -> {_annotation(notes['return'])}" if "return" in notes else ""
    return f"({', '.join(parts)}){result}"


def _parameter(name: str, notes: dict[str, Any], defaults: dict[str, Any]) -> str:
    text = f"{name}: {_annotation(notes[name])}" if name in notes else name
    if name not in defaults:
        return text
    return f"{text} = {defaults[name]!r}" if name in notes else f"{text}={defaults[name]!r}"


def _annotation(value: Any) -> str:
    if getattr(value, "__module__", None) == "typing":
        return re.sub(r"[\w\.]+", lambda found: found[0].removeprefix("typing."), repr(value))
    if isinstance(value, type) and not isinstance(value, GenericAlias):
        return value.__qualname__ if value.__module__ == "builtins" else f"{value.__module__}.{value.__qualname__}"
    return repr(value)
