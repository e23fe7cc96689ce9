"""What programs must never get hold of, and a crawler that looks for it.

The crawler follows every attribute that the language policy lets a program read, every element, key and value,
and calls nothing. It knows no exceptions: what it can reach, a program can reach.
"""

from __future__ import annotations

import types
from collections import deque
from collections.abc import Iterator
from typing import Any

from elitescript.language.policy import GUARDED_ATTRIBUTES, is_attribute_allowed
from elitescript.runtime.host import ScriptHost
from elitescript.runtime.names.context import Context
from elitescript.runtime.names.modules import ModuleShelf
from elitescript.runtime.program import Program
from elitescript.runtime.stdlib.loader import CopyLoader
from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.runtime.threads.strand import Strand
from elitescript.runtime.threads.timers import Timers

INSIDE = (
    types.FrameType,
    types.CodeType,
    types.TracebackType,
    types.ModuleType,
    types.CellType,
)
"""Types of the interpreter's own objects."""

KERNEL = (Context, CopyLoader, ModuleShelf, Program, Scheduler, ScriptHost, Strand, Timers)
"""Types of the runtime's own objects."""

OUTSIDE = {"os", "posix", "nt", "subprocess", "ctypes", "shutil", "socket", "pathlib", "builtins.open", "io"}
"""Modules whose functions act on the computer."""


def forbidden(value: Any, bench: Any) -> str:
    """Why a program may not hold a value; empty if it may."""
    if isinstance(value, INSIDE):
        return f"a {type(value).__name__} of the interpreter"
    if isinstance(value, KERNEL):
        return f"a {type(value).__name__} of the runtime"
    if value is bench.machine:
        return "the machine"
    if value is eval or value is exec or value is open or value is compile or value is __import__:
        return "an unguarded built-in"
    module = getattr(value, "__module__", None)
    if callable(value) and type(module) is str and module in OUTSIDE and isinstance(value, types.BuiltinFunctionType):
        return f"a function of {module}"
    if isinstance(value, dict) and "__builtins__" in value:
        return "the globals of a function"
    return ""


_LEAVES = (
    str,
    bytes,
    int,
    float,
    complex,
    type(None),
    types.BuiltinFunctionType,
    types.ClassMethodDescriptorType,
    types.GetSetDescriptorType,
    types.MemberDescriptorType,
    types.MethodDescriptorType,
    types.MethodWrapperType,
    types.WrapperDescriptorType,
)
"""Values behind which the policy lets nobody read more than names and texts."""

DEEPEST = 8
"""Attributes in a row; some attributes make a new object at each read, without end."""


class Crawl:
    """Everything that can be reached from some objects.

    Attributes:
        found: why and how, for each forbidden object.
        reached: how many objects were looked at.
        classes: mutable classes that were reached, by their path.
    """

    def __init__(self, bench: Any, roots: dict[str, Any]) -> None:
        self.found: list[str] = []
        self.classes: dict[str, type] = {}
        self._bench = bench
        self._seen: dict[int, Any] = {}
        queue = deque(roots.items())
        while queue:
            path, value = queue.popleft()
            if id(value) in self._seen:
                continue
            self._seen[id(value)] = value
            why = forbidden(value, bench)
            if why:
                self.found.append(f"{path}: {why}: {value!r:.80}")
                continue
            if isinstance(value, type) and not _is_immutable(value):
                self.classes[path] = value
            queue.extend(self._next(path, value))

    @property
    def reached(self) -> int:
        return len(self._seen)

    def _next(self, path: str, value: Any) -> Iterator[tuple[str, Any]]:
        if isinstance(value, _LEAVES) or path.count(".") > DEEPEST:
            return
        if isinstance(value, dict):
            for key, item in list(value.items()):
                yield f"{path}.keys()", key
                yield f"{path}[{key!r:.20}]", item
        elif isinstance(value, (list, tuple, set, frozenset)):
            for index, item in enumerate(list(value)):
                yield f"{path}[{index}]", item
        yield f"type({path})", type(value)
        for name in _names(value):
            if is_attribute_allowed(name) and name not in GUARDED_ATTRIBUTES:
                try:
                    item = getattr(value, name)
                except Exception as error:
                    yield f"{path}.{name}!", error
                else:
                    yield f"{path}.{name}", item


def _names(value: Any) -> list[str]:
    try:
        return list(dir(value))
    except Exception:
        return []


def _is_immutable(kind: type) -> bool:
    """Whether no attribute of a class can be set."""
    try:
        kind.__crawler__ = 1  # type: ignore[attr-defined]
        del kind.__crawler__  # type: ignore[attr-defined]
    except TypeError:
        return True
    return False
