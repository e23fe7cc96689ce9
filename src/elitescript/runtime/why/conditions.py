"""Says a condition for people: whether it is true now, what it reads, and what may change that."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Mapping
from types import FunctionType
from typing import Any, Final

from elitescript.errors import DebugError, ElitescriptError
from elitescript.language.scopes import Scope
from elitescript.language.symbols import Symbols
from elitescript.messages.signals import SIGNALS, point_names
from elitescript.runtime.names.context import Context
from elitescript.runtime.names.reading import predefined_call
from elitescript.runtime.why.facts import Facts
from elitescript.runtime.why.setters import Setters
from elitescript.said import joined, said
from elitescript.values.concrete import UNKNOWN, MissingName, Refusal, computed, truth

SHOWN_MAX: Final = 80
"""Most characters of a value or a condition."""
ATOMS_MAX: Final = 6
"""Most values of one condition."""
_STEPS_MAX: Final = 20_000
_DEPTH_MAX: Final = 4
"""Calls of functions of the program in functions of the program that are followed."""
_SCALARS: Final = (bool, int, float, str, bytes, type(None))
_PLAIN: Final = (*_SCALARS, list, tuple)
_MODBUS: Final = "modbus_get_signal_status"

LastRead = Callable[[str, tuple[Any, ...]], Any]
"""Returns for a command that reads a channel, and its arguments, what it gave last; `UNKNOWN` if that is not kept."""


class Conditions:
    """Says conditions of one program.

    Args:
        symbols: of its text.
        context: for commands, which are called if they only read; None for no program.
        facts: what is known of its surroundings.
        setters: what sets its variables.
        last_read: what readings of channels gave.
    """

    __slots__ = ("_context", "_facts", "_last_read", "_setters", "_symbols")

    def __init__(
        self, symbols: Symbols, context: Context | None, facts: Facts, setters: Setters, last_read: LastRead
    ) -> None:
        self._symbols = symbols
        self._context = context
        self._facts = facts
        self._setters = setters
        self._last_read = last_read

    def text(self, node: ast.expr) -> str:
        """Return an expression as it is written, shortened."""
        line = getattr(node, "lineno", 0)
        if line and line == getattr(node, "end_lineno", 0):
            _, column, _, end = self._symbols.range_of(node)
            text = self._symbols.parsed.source.line(line)[column - 1 : end - 1]
        else:
            text = ast.unparse(node)
        return cut(" ".join(text.split()))

    def holds(self, test: ast.expr, names: Mapping[str, Any]) -> bool | None:
        """Return whether a condition is true now; None if that takes more than a look."""
        value = self._value(test, names)
        try:
            return None if value is UNKNOWN else truth(value)
        except (DebugError, ElitescriptError):
            return None

    def values(self, test: ast.expr, names: Mapping[str, Any], scope: Scope, loop: ast.stmt | None) -> str:
        """Return what a condition reads, with what is known of it, as `: x is 2, ...`; empty if nothing is known.

        Args:
            test: the condition.
            names: variables with their values.
            scope: in which it stands.
            loop: which it decides.
        """
        parts = list(dict.fromkeys(self._parts(test, names, scope, loop, 0)))
        for part in self._line_ends(test, names):
            parts.append(part)
        return said(": {values}", values=joined(", ", parts[:ATOMS_MAX])) if parts else ""

    # ---------------------------------------------------------------- parts

    def _parts(
        self, test: ast.expr, names: Mapping[str, Any], scope: Scope | None, loop: ast.stmt | None, depth: int
    ) -> Iterator[str]:
        stack: list[ast.AST] = [test]
        while stack:
            node = stack.pop()
            if isinstance(node, ast.Name):
                yield from self._variable(node, names, scope, loop)
            elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                yield from self._call(node, names, scope, loop, depth)
            elif isinstance(node, ast.Attribute | ast.Subscript):
                value = self._value(node, names)
                if type(value) in _PLAIN:
                    yield said("{text} is {value}", text=self.text(node), value=shown(value))
                inner = [node.slice] if isinstance(node, ast.Subscript) else []
                stack += [part for part in inner if type(value) in _PLAIN] or [node.value]
            elif not isinstance(node, ast.Lambda | ast.ListComp | ast.GeneratorExp | ast.SetComp | ast.DictComp):
                stack += reversed([child for child in ast.iter_child_nodes(node) if isinstance(child, ast.expr)])

    def _variable(
        self, node: ast.Name, names: Mapping[str, Any], scope: Scope | None, loop: ast.stmt | None
    ) -> Iterator[str]:
        value = names.get(node.id, UNKNOWN)
        is_parameter = loop is None and scope is not None and node.id in scope.parameters
        if type(value) in _PLAIN and not is_parameter:
            about = "" if scope is None else self._setters.words(node.id, scope, loop, self)
            yield said("{name} is {value}{about}", name=node.id, value=shown(value), about=about)

    def _call(
        self, node: ast.Call, names: Mapping[str, Any], scope: Scope | None, loop: ast.stmt | None, depth: int
    ) -> Iterator[str]:
        assert isinstance(node.func, ast.Name)
        name, text = node.func.id, self.text(node)
        if name in names:
            yield from self._own_call(node, names, depth)
            return
        points, value = self._read(node, names)
        if name == _MODBUS and value is not UNKNOWN:
            yield self._modbus(node, names, value)
        elif len(points) == 1 and value is not UNKNOWN and len(node.args) <= 1:
            yield self._point(*points[0], value)
            for argument in node.args:
                yield from self._parts(argument, names, scope, loop, depth)
        elif type(value) in _SCALARS:
            yield said("{text} is {value}", text=text, value=shown(value))
            if name != "len":
                scalars = [part for part in node.args if type(self._value(part, names)) in _SCALARS]
                for part in scalars:
                    yield from self._parts(part, names, scope, loop, depth)
        elif value is UNKNOWN:
            arguments = tuple(
                self._value(part, names) for part in (*node.args, *(item.value for item in node.keywords))
            )
            last = self._last_read(name, arguments)
            if last is not UNKNOWN:
                yield said("{text} gave {last} last", text=text, last=shown(last))
            for part in node.args:
                yield from self._parts(part, names, scope, loop, depth)

    def _point(self, family: str, index: int, value: Any) -> str:
        """Return the level of a point of the signal image, since when, and what may set it."""
        row = SIGNALS.get(family)
        name = family if row is None or row.size == 1 else point_names(family)[index]
        facts = [said("it {history}", history=history)] if (history := self._facts.history(name)) else []
        in_program = self._setters.of_point(family, index)
        around = self._facts.setters(name)
        facts += [*in_program, *(around or [])]
        if not in_program and around == []:
            facts.append("nothing here sets it")
        about = f" ({', '.join(facts[:-1])}{' and ' if facts[1:] else ''}{facts[-1]})" if facts else ""
        return said("{name} is {value}{about}", name=name, value=shown(value), about=about)

    def _modbus(self, node: ast.Call, names: Mapping[str, Any], value: Any) -> str:
        name = self._value(node.args[0], names) if node.args else ""
        about = ""
        try:
            if self._context is not None and not self._context.modbus.has_value(name):
                about = " (the device has not answered)"
        except (DebugError, ElitescriptError):
            pass
        return said("the MODBUS signal {name!r} is {value}{about}", name=name, value=shown(value), about=about)

    def _own_call(self, node: ast.Call, names: Mapping[str, Any], depth: int) -> Iterator[str]:
        """Yield what a function of the program gives, and what it reads; it is not run."""
        found = self._body_of(node, names)
        if found is None or depth >= _DEPTH_MAX:
            return
        function, inner, scope = found
        value = self._value(node, names)
        if type(value) in _SCALARS:
            yield said("{text} is {value}", text=self.text(node), value=shown(value))
        returned = _only_value(function)
        if returned is not None:
            yield from self._parts(returned, inner, scope, None, depth + 1)
            return
        # What a longer one does is not known; what it looks at is.
        for part in ast.walk(function):
            if isinstance(part, ast.Call) and isinstance(part.func, ast.Name) and part.func.id not in inner:
                points, level = self._read(part, inner)
                if len(points) == 1 and level is not UNKNOWN:
                    yield self._point(*points[0], level)

    def _body_of(
        self, node: ast.Call, names: Mapping[str, Any]
    ) -> tuple[ast.FunctionDef, dict[str, Any], Scope] | None:
        """Return the definition that a call leads to, the names in it, and its scope."""
        assert isinstance(node.func, ast.Name)
        function = names.get(node.func.id)
        if type(function) is not FunctionType:
            return None
        code = function.__code__
        for scope in self._symbols.scopes:
            made = scope.node
            if isinstance(made, ast.FunctionDef) and made.name == code.co_name and made.lineno == code.co_firstlineno:
                cells = zip(code.co_freevars, function.__closure__ or (), strict=True)
                inner = {**function.__globals__, **{name: cell.cell_contents for name, cell in cells if _is_full(cell)}}
                given = [self._value(part, names) for part in node.args]
                inner.update(zip(code.co_varnames[: code.co_argcount], given, strict=False))
                return made, {name: value for name, value in inner.items() if value is not UNKNOWN}, scope
        return None

    def _line_ends(self, test: ast.expr, names: Mapping[str, Any]) -> Iterator[str]:
        for node in ast.walk(test):
            if isinstance(node, ast.Compare) and len(node.ops) == 1 and isinstance(node.ops[0], ast.Eq | ast.NotEq):
                left, right = self._seen(node.left, names), self._seen(node.comparators[0], names)
                if isinstance(left, str) and isinstance(right, str) and left != right and left.strip() == right.strip():
                    yield said("{left!r} and {right!r} differ by a line end or blanks", left=left, right=right)

    def _seen(self, node: ast.expr, names: Mapping[str, Any]) -> Any:
        value = self._value(node, names)
        if value is UNKNOWN and isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            return self._last_read(node.func.id, tuple(self._value(part, names) for part in node.args))
        return value

    # ---------------------------------------------------------------- values

    def _read(self, node: ast.expr, names: Mapping[str, Any]) -> tuple[list[tuple[str, int]], Any]:
        """Return the points of the signal image that an expression reads, and its value."""
        points: list[tuple[str, int]] = []
        value = self._value(node, names, lambda family, index: points.append((family, index)))
        return points, value

    def _value(
        self,
        node: ast.expr,
        names: Mapping[str, Any],
        on_read: Callable[[str, int], None] | None = None,
        depth: int = 0,
    ) -> Any:
        """Return the value of an expression now; `UNKNOWN` if that takes more than a look."""

        def value(name: str) -> Any:
            if name not in names:
                raise MissingName(name, names.keys)
            return names[name]

        def call(name: str, arguments: tuple[Any, ...], named: dict[str, Any]) -> Any:
            if name not in names:
                return predefined_call(self._context, name, arguments, named, on_read)
            fitting = ast.Call(ast.Name(name), [ast.Constant(part) for part in arguments], [])
            found = None if named or depth >= _DEPTH_MAX else self._body_of(fitting, names)
            returned = None if found is None else _only_value(found[0])
            if found is None or returned is None:
                raise Refusal(name)
            made = self._value(returned, found[1], on_read, depth + 1)
            if made is UNKNOWN:
                raise Refusal(name)
            return made

        try:
            return computed(node, value, call, _STEPS_MAX)
        except (DebugError, ElitescriptError):
            return UNKNOWN


def _only_value(function: ast.FunctionDef) -> ast.expr | None:
    """Return what a function returns that does nothing else."""
    body = [part for part in function.body if not isinstance(part, ast.Global | ast.Nonlocal)]
    if body and isinstance(body[0], ast.Expr) and isinstance(body[0].value, ast.Constant):
        del body[0]
    only = body[0] if len(body) == 1 else None
    return only.value if isinstance(only, ast.Return) else None


def _is_full(cell: Any) -> bool:
    try:
        cell.cell_contents  # noqa: B018
    except ValueError:
        return False
    return True


def cut(text: str) -> str:
    """Return a text with at most `SHOWN_MAX` characters."""
    return text if len(text) <= SHOWN_MAX else f"{text[:SHOWN_MAX]}…"


def shown(value: Any) -> str:
    """Return a value as the program would write it, shortened."""
    return cut(repr(value))
