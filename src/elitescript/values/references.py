"""What a value stands for that is no data: functions, classes, modules, commands."""

from __future__ import annotations

import ast
from typing import Any

from elitescript.language.scopes import Scope
from elitescript.records import NamedTuple


class Own(NamedTuple):
    """A function or lambda of the program."""

    node: ast.AST


class OwnClass(NamedTuple):
    """A class of the program, or an object of it."""

    scope: Scope
    is_object: bool


class ModuleType(NamedTuple):
    """A module that programs may import."""

    name: str


class Library(NamedTuple):
    """A class of Python's library, or an object of it."""

    kind: Any


class Name(NamedTuple):
    """A command or built-in function, by its name; behind a `.`, that of a module."""

    name: str


class Made(NamedTuple):
    """What a class or function of a module has returned, by its name with that of the module."""

    name: str


class Method(NamedTuple):
    """A method of a value."""

    name: str
