"""Expressions whose value is certain before the run.

Literals, arithmetic of literals, `d2r(90)`, `math.pi`, and names that the program sets once and that nothing
else can change. What is not certain is `UNKNOWN`, also inside a list.
"""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable
from typing import Any, Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.language.symbols import THREAD_STARTER, Binding, Resolution, Scope, Symbols

_LARGEST_EXPONENT: Final = 64
_LONGEST: Final = 10_000
_DEEPEST: Final = 40
_EXACT_KINDS: Final = (bool, int, float, str, bytes, type(None))
_READERS: Final = frozenset("enumerate len list max min print sorted str sum tuple zip".split())  # noqa: SIM905
_CONVERSIONS: Final = frozenset(("d2r", "r2d"))
_MATH: Final = {"pi": math.pi, "tau": math.tau, "e": math.e}

_ARITHMETIC: Final[dict[type[ast.operator], Callable[[Any, Any], Any]]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Pow: operator.pow,
    ast.LShift: operator.lshift,
    ast.RShift: operator.rshift,
    ast.BitOr: operator.or_,
    ast.BitAnd: operator.and_,
    ast.BitXor: operator.xor,
}
_SIGNS: Final[dict[type[ast.unaryop], Callable[[Any], Any]]] = {
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Not: operator.not_,
    ast.Invert: operator.invert,
}


class Unknown:
    """A value that only the run will show; `text` is what stands there."""

    __slots__ = ("text",)

    def __init__(self, text: str = "...") -> None:
        self.text = text


UNKNOWN: Final = Unknown()


class Constants:
    """Values of expressions of one program."""

    def __init__(self, symbols: Symbols) -> None:
        self._symbols = symbols
        self._values: dict[Binding, Any] = {}
        self._unchanged: dict[Binding, bool] = {}

    def value(self, node: ast.expr, scope: Scope) -> Any:
        """The value of an expression, or an `Unknown`. A list or tuple may hold `Unknown` elements."""
        return self._value(node, scope, 0)

    def _value(self, node: ast.expr, scope: Scope, depth: int) -> Any:
        if depth > _DEEPEST:
            return UNKNOWN
        if isinstance(node, ast.Constant):
            return node.value if isinstance(node.value, _EXACT_KINDS) else UNKNOWN
        if isinstance(node, ast.UnaryOp):
            return _computed(_SIGNS[type(node.op)], self._value(node.operand, scope, depth + 1))
        if isinstance(node, ast.BinOp):
            return self._binary(node, scope, depth)
        if isinstance(node, (ast.List, ast.Tuple)):
            return self._sequence(node, scope, depth)
        if isinstance(node, ast.Name):
            return self._named(node, scope, depth)
        if isinstance(node, ast.Attribute):
            return self._attribute(node, scope)
        if isinstance(node, ast.Call):
            return self._call(node, scope, depth)
        return UNKNOWN

    def _binary(self, node: ast.BinOp, scope: Scope, depth: int) -> Any:
        compute = _ARITHMETIC.get(type(node.op))
        if compute is None:
            return UNKNOWN
        left = self._value(node.left, scope, depth + 1)
        right = self._value(node.right, scope, depth + 1)
        if isinstance(left, (list, tuple)) or isinstance(right, (list, tuple)):
            return _joined(node.op, left, right)
        if isinstance(node.op, (ast.Pow, ast.LShift)) and not _is_small(right):
            return UNKNOWN
        if not isinstance(node.op, ast.Add) and (isinstance(left, (str, bytes)) or isinstance(right, (str, bytes))):
            return UNKNOWN
        return _computed(compute, left, right)

    def _sequence(self, node: ast.List | ast.Tuple, scope: Scope, depth: int) -> Any:
        if any(isinstance(element, ast.Starred) for element in node.elts):
            return UNKNOWN
        values = []
        for element in node.elts:
            value = self._value(element, scope, depth + 1)
            values.append(Unknown(self._text(element)) if isinstance(value, Unknown) else value)
        return values if isinstance(node, ast.List) else tuple(values)

    def _text(self, node: ast.expr) -> str:
        line, column, end_line, end_column = self._symbols.range_of(node)
        return self._symbols.parsed.source.line(line)[column - 1 : end_column - 1] if line == end_line else "..."

    def _attribute(self, node: ast.Attribute, scope: Scope) -> Any:
        base = node.value
        if isinstance(base, ast.Name) and base.id == "math" and self._is_module(base.id, scope):
            return _MATH.get(node.attr, UNKNOWN)
        return UNKNOWN

    def _is_module(self, name: str, scope: Scope) -> bool:
        home = scope.home(name)
        bindings = home.bindings[name] if home else self._symbols.global_bindings(name)
        return bool(bindings) and all(
            isinstance(binding.node, ast.alias) and binding.node.name == name for binding in bindings
        )

    def _call(self, node: ast.Call, scope: Scope, depth: int) -> Any:
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        if name not in _CONVERSIONS or node.keywords or len(node.args) != 1:
            return UNKNOWN
        command = CATALOGUE.get(name)
        if command is None or scope.resolve(name) is not Resolution.BUILTIN:
            return UNKNOWN
        angle = self._value(node.args[0], scope, depth + 1)
        return _computed(command.function, angle) if isinstance(angle, (int, float)) else UNKNOWN

    # Names

    def _named(self, node: ast.Name, scope: Scope, depth: int) -> Any:
        home = scope.home(node.id)
        if home is None:
            return UNKNOWN
        bindings = home.bindings[node.id]
        if len(bindings) != 1:
            return UNKNOWN
        binding = bindings[0]
        if binding not in self._values:
            # Whoever comes here again before there is a value asks in a circle: `a = b; b = a`.
            self._values[binding] = UNKNOWN
            source = self._source(binding, home)
            if source is not None:
                self._values[binding] = self._value(source, home, depth + 1)
        value = self._values[binding]
        if isinstance(value, (list, tuple)):
            is_flat = not any(isinstance(element, (list, tuple)) for element in value)
            return value if is_flat and self._is_never_changed(binding, home) else UNKNOWN
        return value

    def _source(self, binding: Binding, home: Scope) -> ast.expr | None:
        """The expression that alone gives a variable its value."""
        statement = self._symbols.parent(binding.node)
        if not isinstance(statement, ast.Assign) or len(statement.targets) != 1 or binding.kind != "assign":
            return None
        if statement.targets[0] is not binding.node or home.kind not in ("body", "function"):
            return None
        if any(binding.name in other.nonlocals for other in home.walk()):
            return None
        return statement.value

    def _is_never_changed(self, binding: Binding, home: Scope) -> bool:
        """Whether nothing can change the list in a variable, or get hold of it."""
        if binding not in self._unchanged:
            name = binding.name
            users = [other for other in home.walk() if other is home or other.home(name) is home]
            reads = [read for user in users for read in user.reads.get(name, ())]
            self._unchanged[binding] = all(self._leaves_unchanged(read) for read in reads)
        return self._unchanged[binding]

    def _leaves_unchanged(self, read: ast.Name) -> bool:
        symbols = self._symbols
        above = symbols.parent(read)
        if isinstance(above, ast.Subscript):
            return above.value is not read or isinstance(above.ctx, ast.Load)
        if isinstance(above, (ast.For, ast.comprehension)):
            return above.iter is read
        if isinstance(above, ast.Attribute):
            return above.attr == "copy" and isinstance(symbols.parent(above), ast.Call)
        if isinstance(above, ast.keyword):
            above = symbols.parent(above)
        if not isinstance(above, ast.Call):
            return isinstance(above, (ast.BinOp, ast.UnaryOp, ast.Compare, ast.FormattedValue))
        function = above.func
        if not isinstance(function, ast.Name) or function is read:
            return False
        name = function.id
        is_harmless = name in _READERS or (name != THREAD_STARTER and CATALOGUE.get(name) is not None)
        return is_harmless and symbols.scope_of(function).resolve(name) is Resolution.BUILTIN


def _computed(compute: Callable[..., Any], *values: Any) -> Any:
    """A result, `UNKNOWN` if an operand is or if it is no plain, short value."""
    if not all(isinstance(value, _EXACT_KINDS) for value in values):
        return UNKNOWN
    try:
        result = compute(*values)
    except (ArithmeticError, TypeError, ValueError):
        return UNKNOWN
    if not isinstance(result, _EXACT_KINDS) or (isinstance(result, (str, bytes)) and len(result) > _LONGEST):
        return UNKNOWN
    if isinstance(result, int) and result.bit_length() > _LONGEST:
        return UNKNOWN
    return result


def _joined(op: ast.operator, left: Any, right: Any) -> Any:
    """The sum of two lists, a list times a number."""
    result: Any = UNKNOWN
    if isinstance(op, ast.Add) and type(left) is type(right):
        result = left + right
    elif isinstance(op, ast.Mult) and isinstance(left, int) != isinstance(right, int):
        count, items = (left, right) if isinstance(left, int) else (right, left)
        if count * len(items) <= _LONGEST:
            result = items * count
    return UNKNOWN if isinstance(result, (list, tuple)) and len(result) > _LONGEST else result


def _is_small(value: Any) -> bool:
    return isinstance(value, (int, float)) and abs(value) <= _LARGEST_EXPONENT
