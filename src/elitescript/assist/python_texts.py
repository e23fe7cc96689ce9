"""Describes functions, classes and modules of Python's library as Markdown."""

from __future__ import annotations

import builtins
from typing import Any, Final

from elitescript.assist.value_types import real_module
from elitescript.language.builtin_names import REFUSED_BUILTINS
from elitescript.language.modules import AVAILABLE

_LONGEST: Final = 800


def python_object(path: str) -> Any:
    """Return what a path such as `math.sin` or `builtins.str.join` names; None if programs do not find it."""
    parts = path.split(".")
    for count in range(len(parts), 0, -1):
        module = ".".join(parts[:count])
        if module != "builtins" and module not in AVAILABLE:
            continue
        found = builtins if module == "builtins" else real_module(module)
        for part in parts[count:]:
            found = getattr(found, part, None)
        return found
    return None


def python_signature(name: str, found: Any) -> str:
    """Return the call of a function as text, or the type of a constant; empty if neither is known."""
    if found is None:
        return ""
    if not callable(found):
        return type(found).__name__
    first = (getattr(found, "__text_signature__", None) or "").replace("$self, ", "").replace("$self", "")
    for mark in ("$module, ", "$module", "/, ", ", /", "/"):
        first = first.replace(mark, "")
    return first or ("class" if isinstance(found, type) else "")


def python_markdown(path: str) -> str:
    """Return signature and text of an object of Python's library; empty if there is none."""
    found = python_object(path)
    name = path.removeprefix("builtins.")
    refusal = REFUSED_BUILTINS.get(name)
    if refusal:
        return f"`{name}` is not available to programs: {refusal}"
    text = getattr(found, "__doc__", None) or ""
    if found is None or not isinstance(text, str):
        return ""
    if not callable(found) and path not in AVAILABLE:
        return f"`{name}` = `{found!r}`" if isinstance(found, (int, float, str)) else f"`{name}`"
    lines = text.strip().split("\n")
    margin = min((len(line) - len(line.lstrip()) for line in lines[1:] if line.strip()), default=0)
    text = "\n".join([lines[0], *(line[margin:] for line in lines[1:])])
    cut = text if len(text) <= _LONGEST else text[:_LONGEST].rpartition("\n")[0] + "\n..."
    head = f"import {path}" if path in AVAILABLE else name + python_signature(name, found)
    return f"```elitescript\n{head}\n```\n\n{cut}"
