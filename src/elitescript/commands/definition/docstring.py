"""Finds docstrings, and splits that of a command: summary, behaviour, arguments, result, errors."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from functools import cache
from types import ModuleType
from typing import Any

from elitescript.records import NamedTuple


def docstring_of(owner: Callable[..., Any] | ModuleType) -> str:
    """Return the docstring of a function of a module or of a module; empty if there is none.

    With `-OO` or `PYTHONOPTIMIZE=2` Python leaves it out of the code; then it is read from the source.
    """
    if owner.__doc__ is not None or sys.flags.optimize < 2:
        return owner.__doc__ or ""
    if isinstance(owner, ModuleType):
        return _written_in(owner.__file__ or "").get("", "")
    return _written_in(owner.__code__.co_filename).get(owner.__name__, "")


@cache
def _written_in(path: str) -> Mapping[str, str]:
    """Return the docstrings of a source by the names of its functions; that of the module has no name."""
    from ast import FunctionDef, Module, PyCF_ONLY_AST, get_docstring
    from pathlib import Path

    try:
        # Since Python 3.14 the tree has no docstrings either, unless it is asked for as without an option.
        module = compile(Path(path).read_bytes(), path, "exec", PyCF_ONLY_AST, dont_inherit=True, optimize=0)
    except (OSError, SyntaxError, ValueError):
        return {}
    assert isinstance(module, Module)
    functions = {node.name: get_docstring(node, clean=False) or "" for node in module.body if type(node) is FunctionDef}
    return {"": get_docstring(module, clean=False) or "", **functions}


class Docstring(NamedTuple):
    """The parts, without indentation."""

    summary: str
    behaviour: str
    args: dict[str, str]
    returns: str
    raises: dict[str, str]
    """Class of the error, and when it comes."""


_SECTIONS = ("Args:", "Returns:", "Raises:")


def read_docstring(text: str) -> Docstring:
    """Split a docstring in the Google form; unknown sections stay part of the behaviour."""
    lines = [line.rstrip() for line in text.strip().split("\n")]
    margin = min((len(line) - len(line.lstrip()) for line in lines[1:] if line.strip()), default=0)
    lines = [lines[0], *(line[margin:] for line in lines[1:])]
    parts: dict[str, list[str]] = {"": [], **{section: [] for section in _SECTIONS}}
    section = ""
    for line in lines[1:]:
        if line in _SECTIONS:
            section = line
        else:
            if section and line and not line.startswith(" "):
                section = ""
            parts[section].append(line)
    return Docstring(
        summary=lines[0].strip(),
        behaviour="\n".join(parts[""]).strip(),
        args=_entries(parts["Args:"]),
        returns=" ".join(line.strip() for line in parts["Returns:"] if line.strip()),
        raises=_entries(parts["Raises:"]),
    )


def _entries(lines: list[str]) -> dict[str, str]:
    entries: dict[str, str] = {}
    name = ""
    for line in lines:
        if not line.strip():
            continue
        if not line.startswith("     "):
            name, _, rest = line.strip().partition(":")
            entries[name] = rest.strip()
        else:
            entries[name] = f"{entries[name]} {line.strip()}"
    return entries
