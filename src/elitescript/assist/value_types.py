"""Determines of what type an expression certainly is, for the methods and names behind a `.`."""

from __future__ import annotations

import ast
import builtins
from importlib import import_module
from typing import Any, Final

from elitescript.assist.document import Document
from elitescript.language.modules import AVAILABLE, COPIED_NAMES, OWN_NAMES, SHARED_NAMES
from elitescript.language.parser import syntax_tree
from elitescript.language.policy import is_attribute_allowed
from elitescript.language.scopes import Scope
from elitescript.values.description import FUNCTION, NONE, OBJECT, TYPES
from elitescript.values.references import Library, Made, ModuleType, Name, OwnClass

ValueType = type | ModuleType | OwnClass

_TYPES: Final = {bits: kind for kind, bits in TYPES.items() if not bits & (FUNCTION | OBJECT)}
"""Types of values by their only kind."""


def module_names(name: str) -> tuple[str, ...]:
    """Return the names of a module as programs see it; none of an unknown one."""
    listed = {**SHARED_NAMES, **COPIED_NAMES, **OWN_NAMES}.get(name, "")
    real = real_module(name)
    if real is None:
        return ()
    if listed == "*":
        public = getattr(real, "__all__", None) or [item for item in vars(real) if not item.startswith("_")]
        return tuple(sorted(item for item in public if type(vars(real).get(item)) is not type(real)))
    return tuple(sorted(item for item in listed.split() if hasattr(real, item)))


def real_module(name: str) -> Any:
    """Return Python's module of that name, for its texts; None if programs may not import it."""
    return import_module({"elicopy": "copy"}.get(name, name)) if name in AVAILABLE else None


def attribute_names(kind: ValueType) -> tuple[str, ...]:
    """Return the names that may stand behind the `.` of a value."""
    if isinstance(kind, ModuleType):
        return module_names(kind.name)
    if isinstance(kind, OwnClass):
        return tuple(sorted({*kind.scope.bindings, *(_own_attributes(kind.scope) if kind.is_object else ())}))
    return tuple(name for name in dir(kind) if not name.startswith("_") and is_attribute_allowed(name))


def attribute(kind: ValueType, name: str) -> Any:
    """Return the object behind a `.` in Python's own library, for its text; None if there is none."""
    if isinstance(kind, ModuleType):
        return getattr(real_module(kind.name), name, None)
    return getattr(kind, name, None) if isinstance(kind, type) else None


def type_of_text(document: Document, text: str, scope: Scope) -> ValueType | None:
    """Return the type of an expression that is given as text; None if it is not certain or does not parse."""
    node = expression(text)
    return None if node is None else document.once(ValueTypes).of(node, scope)


def expression(text: str) -> ast.expr | None:
    """Return the tree of an expression; None if the text is none."""
    try:
        (statement,) = syntax_tree(text.strip()).body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None
    return statement.value if isinstance(statement, ast.Expr) else None


def _own_attributes(scope: Scope) -> set[str]:
    """Return what the methods of a class assign to attributes of their first parameter."""
    found = set()
    for method in scope.children:
        first = next(iter(method.parameters), None)
        for statement in method.statements:
            for node in ast.walk(statement):
                if (
                    isinstance(node, ast.Attribute)
                    and isinstance(node.ctx, ast.Store)
                    and isinstance(node.value, ast.Name)
                    and node.value.id == first
                ):
                    found.add(node.attr)
    return found


class ValueTypes:
    """Gives the types of the expressions of one document: a view of `values`."""

    __slots__ = ("_values",)

    def __init__(self, document: Document) -> None:
        self._values = document.program.values

    def of(self, node: ast.expr, scope: Scope) -> ValueType | None:
        """Return the type of an expression; None if it is not certain."""
        value = self._values.evaluated(node, scope)
        refs = value.refs
        if refs and len(refs) == 1:
            found = _referred(refs[0])
            if found is not None:
                return found
        return _TYPES.get(value.kinds & ~NONE or NONE)


def _referred(ref: Any) -> ValueType | None:
    """Return the type of what a value stands for; a class of the library counts as its objects."""
    if isinstance(ref, (ModuleType, OwnClass)):
        return ref
    if isinstance(ref, Library):
        found = ref.kind
    elif isinstance(ref, (Name, Made)):
        module, _, name = ref.name.rpartition(".")
        found = attribute(ModuleType(module), name) if module in AVAILABLE else getattr(builtins, name, None)
    else:
        return None
    return found if isinstance(found, type) else None
