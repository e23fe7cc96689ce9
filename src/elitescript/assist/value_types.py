"""Determines of what type an expression certainly is, for the methods and names behind a `.`."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Iterable
from importlib import import_module
from typing import Any, Final

from elitescript.assist.document import Document
from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.quantities import (
    Boolean,
    Integer,
    Number,
    Octets,
    Quantity,
    Text,
    Vector,
)
from elitescript.language.modules import AVAILABLE, COPIED_NAMES, OWN_NAMES, SHARED_NAMES
from elitescript.language.parser import syntax_tree
from elitescript.language.policy import is_attribute_allowed
from elitescript.language.scopes import Binding, Resolution, Scope
from elitescript.records import NamedTuple

_DEEPEST: Final = 12
_LITERALS: Final[dict[type[ast.expr], type]] = {
    ast.JoinedStr: str,
    ast.List: list,
    ast.ListComp: list,
    ast.Tuple: tuple,
    ast.Dict: dict,
    ast.DictComp: dict,
    ast.Set: set,
    ast.SetComp: set,
    ast.Compare: bool,
}
_QUANTITIES: Final[tuple[tuple[type[Quantity], type], ...]] = (
    (Vector, list),
    (Text, str),
    (Octets, bytes),
    (Boolean, bool),
    (Integer, int),
    (Number, float),
)
_RESULTS: Final[dict[type, dict[str, type]]] = {
    str: {
        **dict.fromkeys(("split", "rsplit", "splitlines"), list),
        **dict.fromkeys(("partition", "rpartition"), tuple),
        **dict.fromkeys(
            (
                *("capitalize", "casefold", "center", "expandtabs", "format", "join", "ljust", "lower", "lstrip"),
                *("removeprefix", "removesuffix", "replace", "rjust", "rstrip", "strip", "swapcase", "title"),
                *("translate", "upper", "zfill"),
            ),
            str,
        ),
        "encode": bytes,
    },
    bytes: {"decode": str, "hex": str, "strip": bytes, "split": list},
    list: {"copy": list},
    dict: {"copy": dict},
    set: {"copy": set, "union": set, "intersection": set, "difference": set},
}
"""Types of what methods return."""

_FUNCTIONS: Final[dict[str, type]] = {"sorted": list, "repr": str, "len": int, "hex": str, "bin": str, "chr": str}


class ModuleType(NamedTuple):
    """A module that programs may import."""

    name: str


class OwnClass(NamedTuple):
    """A class of the program, or an object of it."""

    scope: Scope
    is_object: bool


ValueType = type | ModuleType | OwnClass


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
    """Follows the values of one document through assignments and functions."""

    def __init__(self, document: Document) -> None:
        self.symbols = document.symbols
        self._bindings: dict[int, ValueType | None] = {}
        self._functions: dict[int, ValueType | None] = {}

    def of(self, node: ast.expr, scope: Scope) -> ValueType | None:
        """Return the type of an expression; None if it is not certain."""
        return self._of(node, scope, 0)

    def _of(self, node: ast.expr, scope: Scope, depth: int) -> ValueType | None:
        if depth > _DEEPEST:
            return None
        if isinstance(node, ast.Constant):
            return type(node.value)
        if type(node) in _LITERALS:
            return _LITERALS[type(node)]
        if isinstance(node, ast.BinOp):
            return self._operation(node, scope, depth)
        if isinstance(node, ast.Name):
            return self._name(node.id, scope, depth)
        if isinstance(node, ast.Attribute):
            owner = self._of(node.value, scope, depth + 1)
            is_module = isinstance(owner, ModuleType) and f"{owner.name}.{node.attr}" in AVAILABLE
            return ModuleType(f"{owner.name}.{node.attr}") if is_module else None  # type: ignore[union-attr]
        if isinstance(node, ast.Subscript):
            owner = self._of(node.value, scope, depth + 1)
            return owner if isinstance(node.slice, ast.Slice) and owner in (list, str, tuple, bytes) else None
        return self._call(node, scope, depth) if isinstance(node, ast.Call) else None

    def _operation(self, node: ast.BinOp, scope: Scope, depth: int) -> ValueType | None:
        left, right = self._of(node.left, scope, depth + 1), self._of(node.right, scope, depth + 1)
        if left is str and isinstance(node.op, ast.Mod):
            return str
        if left is right or (left in (str, list) and isinstance(node.op, ast.Mult)):
            return float if left is int and isinstance(node.op, ast.Div) else left
        return float if {left, right} == {int, float} else None

    def _call(self, node: ast.Call, scope: Scope, depth: int) -> ValueType | None:
        function = node.func
        if isinstance(function, ast.Attribute):
            owner = self._of(function.value, scope, depth + 1)
            if isinstance(owner, type):
                return _RESULTS.get(owner, {}).get(function.attr)
            found = attribute(owner, function.attr) if isinstance(owner, ModuleType) else None
            return found if isinstance(found, type) else None
        if not isinstance(function, ast.Name):
            return None
        name = function.id
        if scope.resolve(name) is not Resolution.BUILTIN:
            return self._own_call(name, scope, depth)
        command = CATALOGUE.get(name)
        if command is not None:
            returns = command.details.returns
            return next((kind for quantity, kind in _QUANTITIES if isinstance(returns, quantity)), None)
        found = getattr(builtins, name, None)
        return found if isinstance(found, type) else _FUNCTIONS.get(name)

    def _own_call(self, name: str, scope: Scope, depth: int) -> ValueType | None:
        """Return the type of what a function of the program returns, or of an object of its class."""
        called = self._name(name, scope, depth)
        if isinstance(called, OwnClass):
            return OwnClass(called.scope, True)
        if isinstance(called, type):
            return called
        return _common(self._result(function, depth) for function in self.symbols.definitions(name, scope))

    def _result(self, function: Scope, depth: int) -> ValueType | None:
        """Return the type of what a function returns."""
        if id(function) not in self._functions:
            # Asked again before there is an answer, it calls itself.
            self._functions[id(function)] = None
            returns = [node for statement in function.statements for node in _returns(statement)]
            self._functions[id(function)] = _common(
                self._of(node.value, function, depth + 1) if node.value else None for node in returns
            )
        return self._functions[id(function)]

    def _name(self, name: str, scope: Scope, depth: int) -> ValueType | None:
        return _common(self._bound(binding, depth) for binding in self.symbols.bindings(name, scope))

    def _bound(self, binding: Binding, depth: int) -> ValueType | None:
        if id(binding) not in self._bindings:
            # Asked again before there is an answer, it is a circle: `a = b; b = a`.
            self._bindings[id(binding)] = None
            self._bindings[id(binding)] = self._source(binding, depth)
        return self._bindings[id(binding)]

    def _source(self, binding: Binding, depth: int) -> ValueType | None:
        symbols, node = self.symbols, binding.node
        scope = symbols.scope_of(node)
        if binding.kind == "class":
            made = symbols.scope_made_by(node)
            return OwnClass(made, False) if made is not None else None
        if binding.kind == "import":
            origin = symbols.imported(binding.name, scope)
            if origin in AVAILABLE:
                return ModuleType(origin)
            owner, _, name = origin.rpartition(".")
            found = attribute(ModuleType(owner), name) if owner in AVAILABLE else None
            return found if isinstance(found, type) else None
        if binding.kind == "parameter":
            return self._first_parameter(binding)
        statement = symbols.parent(node)
        if isinstance(statement, ast.Assign) and node in statement.targets:
            return self._of(statement.value, scope, depth + 1)
        if isinstance(statement, ast.AugAssign):
            return self._of(statement.value, scope, depth + 1)
        return None

    def _first_parameter(self, binding: Binding) -> ValueType | None:
        """Return the object of the class if a parameter is the first one of a method."""
        scope = self.symbols.scope_of(binding.node)
        outer = scope.parent
        if outer is None or outer.kind != "class" or next(iter(scope.parameters), None) != binding.name:
            return None
        return OwnClass(outer, True)


def _common(kinds: Iterable[ValueType | None]) -> ValueType | None:
    """Return the type that all have; None if they differ or there are none."""
    first, *others = [*kinds] or [None]
    return first if all(kind == first for kind in others) else None


def _returns(statement: ast.stmt) -> list[ast.Return]:
    """Return the `return` statements in a statement, not those of functions inside it."""
    found = []
    stack: list[ast.AST] = [statement]
    while stack:
        node = stack.pop()
        if isinstance(node, ast.Return):
            found.append(node)
        if not isinstance(node, (ast.FunctionDef, ast.Lambda, ast.ClassDef)):
            stack.extend(ast.iter_child_nodes(node))
    return found
