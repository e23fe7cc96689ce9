"""Evaluates expressions whose value is certain before the run.

Literals, arithmetic of literals, f-strings without formats, `str(5)`, `d2r(90)`, `math.pi`, `pose_trans` and its like,
elements of lists, names that the program sets once and that nothing else can change, and parameters of functions that
are called once. What is not certain is `UNKNOWN`, also inside a list.
"""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable
from typing import Any, Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.errors import ScriptError
from elitescript.language.symbols import THREAD_STARTER, Binding, Resolution, Scope, Symbols

_LARGEST_EXPONENT: Final = 64
_LONGEST: Final = 10_000
_DEEPEST: Final = 40
_EXACT_KINDS: Final = (bool, int, float, str, bytes, type(None))
_READERS: Final = frozenset("enumerate len list max min print sorted str sum tuple zip".split())  # noqa: SIM905
_SHOWERS: Final = frozenset(("len", "print", "str"))
_CONVERSIONS: Final = frozenset(("d2r", "r2d"))
_POSE_ALGEBRA: Final = frozenset(
    "interpolate_pose pose_add pose_inv pose_sub pose_trans rotvec2rpy rpy2rotvec".split()  # noqa: SIM905
)
_COPIES: Final = frozenset(("copy", "list"))
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
    """A value that is not known before the run; `text` is its source text."""

    __slots__ = ("text",)

    def __init__(self, text: str = "...") -> None:
        self.text = text


UNKNOWN: Final = Unknown()


class Constants:
    """Values of expressions of one program."""

    def __init__(self, symbols: Symbols) -> None:
        self._symbols = symbols
        self._known: dict[ast.expr, Any] = {}
        """Of expressions that were asked for: several rules ask for each argument."""
        self._values: dict[Binding, Any] = {}
        self._unchanged: dict[Binding, bool] = {}

    def value(self, node: ast.expr, scope: Scope) -> Any:
        """Return the value of an expression, or an `Unknown`. A list or tuple may hold `Unknown` elements."""
        if type(node) is ast.Constant:
            return node.value if isinstance(node.value, _EXACT_KINDS) else UNKNOWN
        value = self._known.get(node, self)
        if value is self:
            value = self._known[node] = self._value(node, scope, 0)
        return value

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
        if isinstance(node, ast.JoinedStr):
            return self._joined_text(node, scope, depth)
        if isinstance(node, ast.Name):
            return self._named(node, scope, depth)
        if isinstance(node, ast.Attribute):
            return self._attribute(node, scope)
        if isinstance(node, ast.Call):
            return self._call(node, scope, depth)
        if isinstance(node, ast.Subscript):
            return self._element(node, scope, depth)
        return UNKNOWN

    def _joined_text(self, node: ast.JoinedStr, scope: Scope, depth: int) -> Any:
        """Return the text of an f-string without formats."""
        parts = []
        for part in node.values:
            if isinstance(part, ast.FormattedValue):
                if part.conversion != -1 or part.format_spec is not None:
                    return UNKNOWN
                part = part.value
            value = self._value(part, scope, depth + 1)
            if not isinstance(value, _EXACT_KINDS):
                return UNKNOWN
            parts.append(value)
        return _computed(lambda *values: "".join(map(str, values)), *parts)

    def _element(self, node: ast.Subscript, scope: Scope, depth: int) -> Any:
        part = node.slice
        if isinstance(part, ast.Slice):
            ends = (part.lower, part.upper)
            bounds = [None if end is None else self._value(end, scope, depth + 1) for end in ends]
            if part.step is not None or not all(bound is None or type(bound) is int for bound in bounds):
                return UNKNOWN
            index: Any = slice(*bounds)
        else:
            index = self._value(part, scope, depth + 1)
            if type(index) is not int:
                return UNKNOWN
        whole = self._value(node.value, scope, depth + 1)
        if not isinstance(whole, (list, tuple)):
            return UNKNOWN
        try:
            return whole[index]
        except IndexError:
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
        values = []
        for element in node.elts:
            # Most lists are points: numbers, some with a sign.
            value = _number(element)
            if value is None:
                if isinstance(element, ast.Starred):
                    return UNKNOWN
                value = self._value(element, scope, depth + 1)
            values.append(Unknown(self._text(element)) if isinstance(value, Unknown) else value)
        return values if isinstance(node, ast.List) else tuple(values)

    def _text(self, node: ast.expr) -> str:
        line, column, end_line, end_column = self._symbols.range_of(node)
        return self._symbols.parsed.source.line(line)[column - 1 : end_column - 1] if line == end_line else "..."

    def _attribute(self, node: ast.Attribute, scope: Scope) -> Any:
        base = node.value
        if isinstance(base, ast.Name) and base.id == "math" and self._symbols.imported(base.id, scope) == "math":
            return _MATH.get(node.attr, UNKNOWN)
        return UNKNOWN

    def _call(self, node: ast.Call, scope: Scope, depth: int) -> Any:
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        if name in _POSE_ALGEBRA:
            return self._pose(name, node, scope, depth)
        if name in _COPIES and len(node.args) == 1 and not node.keywords:
            whole = self._value(node.args[0], scope, depth + 1)
            is_list = isinstance(whole, list) and scope.resolve(name) is Resolution.BUILTIN
            return list(whole) if is_list else UNKNOWN
        if name == "str" and len(node.args) == 1 and not node.keywords and scope.resolve(name) is Resolution.BUILTIN:
            return _computed(str, self._value(node.args[0], scope, depth + 1))
        if name not in _CONVERSIONS or node.keywords or len(node.args) != 1:
            return UNKNOWN
        command = CATALOGUE.get(name)
        if command is None or scope.resolve(name) is not Resolution.BUILTIN:
            return UNKNOWN
        angle = self._value(node.args[0], scope, depth + 1)
        return _computed(command.function, angle) if isinstance(angle, (int, float)) else UNKNOWN

    def _pose(self, name: str, node: ast.Call, scope: Scope, depth: int) -> Any:
        """Return the result of a command of the pose algebra."""
        command = CATALOGUE.get(name)
        if command is None or node.keywords or scope.resolve(name) is not Resolution.BUILTIN:
            return UNKNOWN
        values = [self._value(argument, scope, depth + 1) for argument in node.args]
        if any(_is_uncertain(value) for value in values):
            return UNKNOWN
        try:
            return list(command.function(*command.bind(tuple(values), {})))
        except (ScriptError, ArithmeticError, ValueError):
            return UNKNOWN

    # Names

    def _named(self, node: ast.Name, scope: Scope, depth: int) -> Any:
        home = scope.home(node.id)
        bindings = self._symbols.bindings(node.id, scope)
        if len(bindings) != 1:
            return UNKNOWN
        binding = bindings[0]
        if binding not in self._values:
            # Read again before there is a value, it is a circle: `a = b; b = a`.
            self._values[binding] = UNKNOWN
            source = self._source(binding, home)
            if source is not None:
                self._values[binding] = self._value(*source, depth + 1)
        value = self._values[binding]
        if isinstance(value, (list, tuple)):
            return value if self._is_never_changed(binding, home, _levels(value)) else UNKNOWN
        return value

    def _source(self, binding: Binding, home: Scope | None) -> tuple[ast.expr, Scope] | None:
        """Return the expression that alone gives a variable its value, and where it stands.

        Args:
            binding: the only one of the variable.
            home: its scope; None for a global of the program.
        """
        if binding.kind == "parameter":
            return None if home is None else self._only_argument(binding, home)
        statement = self._symbols.parent(binding.node)
        if not isinstance(statement, ast.Assign) or len(statement.targets) != 1 or binding.kind != "assign":
            return None
        scope = self._symbols.scope_of(binding.node)
        if statement.targets[0] is not binding.node or scope.kind not in ("body", "function"):
            return None
        if home is not None and self._symbols.is_nonlocal_inside(binding.name, home):
            return None
        return statement.value, scope

    def _only_argument(self, binding: Binding, home: Scope) -> tuple[ast.expr, Scope] | None:
        """Return what a parameter gets from the only call of its function, if that is the only use of the function."""
        function = home.node
        if home.kind != "function" or not isinstance(function, ast.FunctionDef) or function.decorator_list:
            return None
        outer = self._symbols.scope_of(function)
        owner = outer.home(function.name)
        if owner is None or len(owner.bindings[function.name]) != 1:
            return None
        reads = self._symbols.reads_of(function.name, owner)
        call = self._symbols.parent(reads[0]) if len(reads) == 1 else None
        if not isinstance(call, ast.Call) or call.func is not reads[0]:
            return None
        if any(isinstance(argument, ast.Starred) for argument in call.args):
            return None
        scope = self._symbols.scope_of(reads[0])
        names = [argument.arg for argument in (*function.args.posonlyargs, *function.args.args)]
        for name, argument in zip(names, call.args, strict=False):
            if name == binding.name:
                return argument, scope
        return next(((given.value, scope) for given in call.keywords if given.arg == binding.name), None)

    def _is_never_changed(self, binding: Binding, home: Scope | None, levels: int) -> bool:
        """Return whether nothing can change the list in a variable, or a list in it, or take a reference to one."""
        if binding not in self._unchanged:
            self._unchanged[binding] = False
            reads = self._symbols.reads_of(binding.name, home)
            self._unchanged[binding] = all(self._leaves_unchanged(read, levels) for read in reads)
        return self._unchanged[binding]

    def _leaves_unchanged(self, read: ast.expr, levels: int) -> bool:
        """Return whether a use changes nothing.

        Args:
            read: the use, of a variable or of an element.
            levels: nesting depth of the lists there; 1 for a list of numbers.
        """
        symbols = self._symbols
        above = symbols.parent(read)
        if isinstance(above, ast.Subscript):
            if above.value is not read:
                return True
            is_element = isinstance(above.ctx, ast.Load)
            return is_element and (levels == 1 or self._leaves_unchanged(above, levels - 1))
        if isinstance(above, ast.Assign) and above.value is read:
            return self._is_alias_unchanged(above, levels)
        if levels == 1:
            if isinstance(above, (ast.For, ast.comprehension)):
                return above.iter is read
            if isinstance(above, ast.Attribute):
                return above.attr == "copy" and isinstance(symbols.parent(above), ast.Call)
        if isinstance(above, ast.keyword):
            above = symbols.parent(above)
        if not isinstance(above, ast.Call):
            return levels == 1 and isinstance(above, (ast.BinOp, ast.UnaryOp, ast.Compare, ast.FormattedValue))
        function = above.func
        if not isinstance(function, ast.Name) or function is read:
            return False
        name = function.id
        is_command = name != THREAD_STARTER and CATALOGUE.get(name) is not None
        # A shallow copy of a list of lists holds the same lists.
        is_harmless = name in (_READERS if levels == 1 else _SHOWERS) or is_command
        return is_harmless and symbols.scope_of(function).resolve(name) is Resolution.BUILTIN

    def _is_alias_unchanged(self, statement: ast.Assign, levels: int) -> bool:
        """Return whether nothing changes a list under the other name that an assignment gives it."""
        target = statement.targets[0]
        if len(statement.targets) != 1 or not isinstance(target, ast.Name):
            return False
        scope = self._symbols.scope_of(target)
        bindings = self._symbols.bindings(target.id, scope)
        return len(bindings) == 1 and self._is_never_changed(bindings[0], scope.home(target.id), levels)


def _number(node: ast.expr) -> float | None:
    """Return the value of a float as a program writes it, with its sign; None for anything else."""
    if type(node) is ast.Constant:
        value = node.value
        return value if type(value) is float else None
    if type(node) is ast.UnaryOp and type(node.op) is ast.USub and type(node.operand) is ast.Constant:
        value = node.operand.value
        return -value if type(value) is float else None
    return None


def _computed(compute: Callable[..., Any], *values: Any) -> Any:
    """Return a result; `UNKNOWN` if an operand is unknown, or the result is not a plain, short value."""
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
    """Return the sum of two lists, or a list times a number."""
    result: Any = UNKNOWN
    if isinstance(op, ast.Add) and type(left) is type(right):
        result = left + right
    elif isinstance(op, ast.Mult) and isinstance(left, int) != isinstance(right, int):
        count, items = (left, right) if isinstance(left, int) else (right, left)
        if count * len(items) <= _LONGEST:
            result = items * count
    return UNKNOWN if isinstance(result, (list, tuple)) and len(result) > _LONGEST else result


def _levels(value: Any) -> int:
    """Return the nesting depth of lists; 0 for no list."""
    return 1 + max((_levels(item) for item in value), default=0) if isinstance(value, (list, tuple)) else 0


def _is_uncertain(value: Any) -> bool:
    return isinstance(value, Unknown) or (isinstance(value, (list, tuple)) and any(map(_is_uncertain, value)))


def _is_small(value: Any) -> bool:
    return isinstance(value, (int, float)) and abs(value) <= _LARGEST_EXPONENT
