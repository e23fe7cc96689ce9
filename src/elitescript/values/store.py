"""Holds what the parts of a program share while it is evaluated: variables, functions, and the places of lists.

A variable that more than one function sees is the join of all that is written to it, whoever writes it and when. So is
what is put into a list behind its creation.
"""

from __future__ import annotations

import ast
from typing import Any, Final

from elitescript.language.scopes import Scope
from elitescript.values.description import (
    BOTTOM,
    COMPUTED,
    IN_BASE,
    JOINED,
    LITERAL,
    UNKNOWN,
    Shape,
    Value,
    join,
    join_all,
    reach,
    same,
    unknown_of,
    widen,
)

WIDENED_AFTER: Final = 4
"""Changes of what is shared after which its range is given up rather than followed."""
CHANGES_MAX: Final = 40
"""Changes after which nothing is said of it."""
STORES_MAX: Final = 3
"""Elements that may be replaced before a list of a role counts as another one."""
_READINGS: Final = 4 | JOINED | LITERAL

Readers = dict["Function", None]
"""Functions that have read something, in the order in which they have."""


class Cell:
    """Holds the join of all that was written, and the functions that have read it."""

    __slots__ = ("changes", "readers", "value")

    def __init__(self) -> None:
        self.value = BOTTOM
        self.readers: Readers = {}
        self.changes = 0

    def add(self, value: Value) -> bool:
        """Join a value to it; return whether that changed what it holds."""
        old = self.value
        if value is old:
            return False
        new = join(old, value)
        if new is old or same(old, new):
            return False
        self.changes += 1
        if self.changes > CHANGES_MAX:
            new = unknown_of(new)
            if same(old, new):
                return False
        elif self.changes > WIDENED_AFTER:
            new = widen(old, new)
        self.value = new
        return True


class Variable:
    """A variable of a scope, or a global.

    Attributes:
        name: its name.
        key: see `memory.VariableKey`.
        owner: the function whose local variable it is; None for a global.
        cell: all that it ever is.
        is_shared: a function other than its owner writes it, so that it has no state of its own in the owner.
    """

    __slots__ = ("cell", "is_shared", "key", "name", "owner")

    def __init__(self, name: str, key: tuple[Any, str], owner: Function | None, is_shared: bool) -> None:
        self.name = name
        self.key = key
        self.owner = owner
        self.cell = Cell()
        self.is_shared = is_shared


class Function:
    """A function, lambda or the body of the program.

    Attributes:
        scope: its scope.
        parameters: what it gets, by name.
        result: what it returns.
        is_open: callers may be unknown.
        evaluations: how often it was evaluated.
    """

    __slots__ = ("_signature", "evaluations", "is_open", "parameters", "result", "scope")

    def __init__(self, scope: Scope) -> None:
        self.scope = scope
        self._signature: tuple[list[str], list[str], dict[str, ast.expr]] | None = None
        self.parameters: dict[str, Cell] = {}
        self.result = Cell()
        self.is_open = False
        self.evaluations = 0

    @property
    def arguments(self) -> ast.arguments | None:
        """Its parameters as they are written; None for the body of a text."""
        node = self.scope.node
        return node.args if isinstance(node, (ast.FunctionDef, ast.Lambda)) else None

    @property
    def signature(self) -> tuple[list[str], list[str], dict[str, ast.expr]]:
        """The parameters that are given by position, all but those with stars, and those that have a default."""
        if self._signature is None:
            arguments = self.arguments
            assert arguments is not None
            positional = [argument.arg for argument in (*arguments.posonlyargs, *arguments.args)]
            defaults = dict(zip(reversed(positional), reversed(arguments.defaults), strict=False))
            keyword_defaults = zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True)
            defaults |= {argument.arg: node for argument, node in keyword_defaults if node is not None}
            names = [*positional, *(argument.arg for argument in arguments.kwonlyargs)]
            self._signature = positional, names, defaults
        return self._signature


SiteState = tuple[dict[int | None, tuple[Value, int]], bool]


class Site:
    """A place of the text that makes lists or dicts.

    Attributes:
        stored: what is put in later, by index; by None where that is not known.
        has_grown: elements may be added or removed.
        is_open: unknown code may change it.
        maker: the function that makes one list there each time it is called; None if it may make more.
        is_shared: another function has put something in.
    """

    __slots__ = ("has_grown", "is_open", "is_shared", "maker", "readers", "stored")

    def __init__(self) -> None:
        self.stored: dict[int | None, Cell] = {}
        self.has_grown = False
        self.is_open = False
        self.maker: Function | None = None
        self.is_shared = False
        self.readers: Readers = {}

    def is_for(self, function: Function) -> bool:
        """Return whether no other function than the one that makes the lists there has seen or changed them."""
        is_unseen = all(reader is function for reader in self.readers)
        return self.maker is function and is_unseen and not self.is_shared and not self.is_open

    def state(self) -> SiteState:
        """Return what was put in by now, for `restore`."""
        return {index: (cell.value, cell.changes) for index, cell in self.stored.items()}, self.has_grown

    def restore(self, state: SiteState) -> None:
        """Take back what was put in since."""
        stored, self.has_grown = state
        self.stored = {index: self.stored[index] for index in stored}
        for index, (value, changes) in stored.items():
            self.stored[index].value, self.stored[index].changes = value, changes

    @property
    def is_changed(self) -> bool:
        """Whether anything changes what is made there."""
        return self.is_open or self.has_grown or bool(self.stored)


class SiteNumbers:
    """The numbers of places that make lists and dicts, by their node: the same in each version of a text."""

    __slots__ = ("_known", "_next", "_used")

    def __init__(self) -> None:
        self._known: dict[ast.AST, frozenset[int]] = {}
        self._used: dict[ast.AST, frozenset[int]] = {}
        self._next = 0

    def of(self, node: ast.AST) -> frozenset[int]:
        """Return the number of a place, as a set."""
        found = self._used.get(node)
        if found is None:
            found = self._known.get(node)
            if found is None:
                found = frozenset((self._next,))
                self._next += 1
            self._used[node] = found
        return found

    def keep_used(self) -> None:
        """Forget the numbers of nodes that have not been asked for since the last call."""
        self._known, self._used = self._used, {}


class Sites:
    """The places of a program that make lists and dicts, by number.

    Args:
        numbers: those of the version before; gets those of this one.
    """

    __slots__ = ("_made", "_numbers", "_sites")

    def __init__(self, numbers: SiteNumbers | None = None) -> None:
        self._made = numbers or SiteNumbers()
        self._sites: dict[int, Site] = {}
        self._numbers: dict[ast.AST, frozenset[int]] = {}

    def made_by(self, node: ast.AST, maker: Function | None) -> frozenset[int]:
        """Return the place that an expression is, as a set; see `Site` for what makes a list there."""
        found = self._numbers.get(node)
        if found is None:
            found = self._numbers[node] = self._made.of(node)
            (number,) = found
            site = self._sites[number] = Site()
        else:
            (number,) = found
            site = self._sites[number]
        site.maker = maker
        return found

    def known(self, node: ast.AST) -> frozenset[int] | None:
        """Return the place that an expression is; None if it makes nothing."""
        return self._numbers.get(node)

    def at(self, sites: frozenset[int]) -> list[Site]:
        """Return places by their numbers."""
        if -1 in sites:
            return list(self._sites.values())
        return [self._sites[number] for number in sites]

    def are_unchanged(self, value: Value) -> bool:
        """Return whether nothing changes a list after its creation, as far as is known by now."""
        return not any(site.is_changed for site in self.at(value.sites))

    def now(self, value: Value, reader: Function | None = None) -> Value:
        """Return the description of a list with what is put in later; its elements are as they were written."""
        if not value.sites or value.shape is None:
            return value
        changed = []
        for site in self.at(value.sites):
            if reader is not None:
                site.readers[reader] = None
            if site.is_changed:
                changed.append(site)
        if not changed:
            return value
        shape = value.shape
        may, must = value.may | COMPUTED, value.must & ~_READINGS
        if not must & ~IN_BASE:
            must |= COMPUTED
        if any(site.is_open for site in changed):
            element = UNKNOWN.but(sites=reach(value))
            return value.but(shape=Shape(None, element), role="", may=may, must=must, node=None)
        stored = [(index, cell.value) for site in changed for index, cell in site.stored.items()]
        role = value.role if len(stored) <= STORES_MAX and all(index is not None for index, _ in stored) else ""
        if shape.items is None or any(site.has_grown for site in changed):
            element = join(shape.any, join_all(new for _, new in stored))
            has_grown = any(site.has_grown for site in changed)
            least, most = (0.0, float("inf")) if has_grown else (shape.least, shape.most)
            role = "" if has_grown else role
            return value.but(shape=Shape(None, element, least, most), role=role, may=may, must=must, node=None)
        items = list(shape.items)
        for index, new in stored:
            if index is None:
                items = [join(item, new) for item in items]
            elif -len(items) <= index < len(items):
                items[index] = join(items[index], new)
        return value.but(shape=Shape(tuple(items)), role=role, may=may, must=must, node=None)

    def store(self, value: Value, index: int | None, new: Value, *, grows: bool) -> Readers:
        """Note that something is put into a list or dict; return the functions that have read it.

        Args:
            value: the list.
            index: where; None if that is not known.
            new: what.
            grows: the number of elements, or their order, may change.
        """
        if value.shape is None:
            return self.open(value.sites | reach(new)) if value.sites or reach(new) else {}
        readers: Readers = {}
        for site in self.at(value.sites):
            if site.is_open:
                readers |= self.open(reach(new))
                continue
            cell = site.stored.get(index)
            if cell is None:
                cell = site.stored[index] = Cell()
            if cell.add(new) or (grows and not site.has_grown):
                site.has_grown = site.has_grown or grows
                readers |= site.readers
        return readers

    def open(self, sites: frozenset[int]) -> Readers:
        """Note that unknown code may change lists, and what they hold; return the functions that have read them."""
        readers: Readers = {}
        waiting = list(self.at(sites))
        while waiting:
            site = waiting.pop()
            if not site.is_open:
                site.is_open = True
                readers |= site.readers
                for cell in site.stored.values():
                    waiting += self.at(reach(cell.value))
        return readers
