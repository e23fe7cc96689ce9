"""Small expressions over the robot's signals, as wires and scenario files hold them.

They look like Python: `standard_digital_out[0] and standard_analog_out[1] > 2.5`. Nothing can be named but signals and
what the place of the expression offers; nothing can be called but a few functions of numbers and texts.
"""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Mapping
from typing import Any, Final

from elitescript.errors import UsageError, did_you_mean
from elitescript.language.advice.expression_slips import plain_word, slip
from elitescript.messages.signals import SIGNALS, Value, parse_signal_name, signal_name

_OPERATORS: Final[dict[type, Callable[[Any, Any], Any]]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.In: lambda a, b: a in b,
    ast.NotIn: lambda a, b: a not in b,
}

_FUNCTIONS: Final[dict[str, Callable[..., Any]]] = {
    function.__name__: function for function in (abs, bool, float, int, len, max, min, round, str, sum)
}

TEXT_MAX: Final = 2000
"""Characters of an expression."""

Read = Callable[[str], Value]


class Expression:
    """A checked expression.

    Args:
        text: as written.
        names: what it may name besides signals.

    Attributes:
        text: as written.
        signals: names of the signals in it.

    Raises:
        UsageError: it is none, or names what is not there.
    """

    __slots__ = ("_body", "_names", "signals", "text")

    def __init__(self, text: object, names: tuple[str, ...] = ()) -> None:
        if not isinstance(text, str) or not text.strip():
            raise UsageError(f"write an expression as a text, such as 'standard_digital_out[0]', not {text!r}")
        if len(text) > TEXT_MAX:
            raise UsageError(f"an expression has {TEXT_MAX} characters at most, not {len(text)}")
        try:
            self._body = ast.parse(text.strip(), mode="eval").body
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            found = slip(text)
            reason = getattr(error, "msg", error) if found is None else found.text
            raise UsageError(f"{text!r} is no expression: {reason}") from None
        self.text = text
        self._names = names
        signals: dict[str, None] = {}
        self._check(self._body, signals)
        self.signals = tuple(signals)

    def value(self, read: Read, arguments: Mapping[str, Any] | None = None) -> Any:
        """Return what it comes to.

        Args:
            read: gives the level of a signal.
            arguments: values of the other names.

        Raises:
            UsageError: it cannot be worked out with these values.
        """
        try:
            return self._value(self._body, read, arguments or {})
        except UsageError:
            raise
        except Exception as error:
            raise UsageError(f"{self.text!r} cannot be worked out: {type(error).__name__}: {error}") from error

    def _check(self, node: ast.AST, signals: dict[str, None]) -> None:
        if (name := self._signal(node)) is not None:
            signals[name] = None
            return
        match node:
            case ast.Name(id=name):
                if name not in self._names:
                    raise UsageError(f"{self.text!r}: nothing is called {name!r}{self._known(name)}")
            case ast.Call(func=ast.Name(id=name), keywords=[]) if name in _FUNCTIONS:
                for argument in node.args:
                    self._check(argument, signals)
            case ast.Constant(value=bool() | int() | float() | str() | None):
                pass
            case (
                ast.BoolOp()
                | ast.UnaryOp()
                | ast.BinOp()
                | ast.Compare()
                | ast.IfExp()
                | ast.List()
                | ast.Tuple()
                | ast.Dict()
                | ast.Subscript()
            ):
                for child in ast.iter_child_nodes(node):
                    if isinstance(child, ast.expr):
                        self._check(child, signals)
                    elif type(child) not in (*_OPERATORS, ast.And, ast.Or, ast.Not, ast.USub, ast.UAdd, ast.Load):
                        raise UsageError(f"{self.text!r}: {type(child).__name__} is not possible here")
            case ast.Call(func=ast.Name(id=name), args=[ast.Constant(value=int() as index)]) if (
                signal := name.removeprefix("get_").removeprefix("read_")
            ) in SIGNALS:
                raise UsageError(f"{self.text!r}: write {signal}[{index}], as `--set` names signals")
            case _:
                known = ", ".join(sorted(_FUNCTIONS))
                what = ast.unparse(node)
                raise UsageError(f"{self.text!r}: {what!r} is not possible here; functions are {known}")

    def _known(self, name: str) -> str:
        """Return what may be meant by a name that is not there."""
        word = plain_word(name)
        if word:
            return f"; write {word}"
        if name in SIGNALS:
            return f"; write {signal_name(SIGNALS[name], 0)}"
        known = f"; it may name signals and {', '.join(self._names)}" if self._names else "; it may name signals"
        return did_you_mean(name, (*self._names, *SIGNALS)) or known

    def _signal(self, node: ast.AST) -> str | None:
        """Return the name of the signal that a node means; None if it means none."""
        match node:
            case ast.Subscript(value=ast.Name(id=name)) if name not in self._names:
                pass
            case ast.Name(id=name) if name in SIGNALS and name not in self._names:
                pass
            case _:
                return None
        try:
            row, index = parse_signal_name(ast.unparse(node))
        except UsageError as error:
            raise UsageError(f"{self.text!r}: {error}") from None
        return signal_name(row, index)

    def _value(self, node: ast.AST, read: Read, arguments: Mapping[str, Any]) -> Any:
        if (name := self._signal(node)) is not None:
            return read(name)

        def of(child: ast.AST) -> Any:
            return self._value(child, read, arguments)

        match node:
            case ast.Constant(value=value):
                return value
            case ast.Name(id=name):
                return arguments[name]
            case ast.BoolOp(op=ast.And(), values=values):
                return all(of(value) for value in values)
            case ast.BoolOp(values=values):
                return any(of(value) for value in values)
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                return not of(operand)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -of(operand)
            case ast.UnaryOp(operand=operand):
                return of(operand)
            case ast.BinOp(left=left, op=sign, right=right):
                return _OPERATORS[type(sign)](of(left), of(right))
            case ast.Compare(left=left, ops=signs, comparators=others):
                before = of(left)
                for comparison, other in zip(signs, others, strict=True):
                    after = of(other)
                    if not _OPERATORS[type(comparison)](before, after):
                        return False
                    before = after
                return True
            case ast.IfExp(test=test, body=body, orelse=orelse):
                return of(body) if of(test) else of(orelse)
            case ast.List(elts=items) | ast.Tuple(elts=items):
                return [of(item) for item in items]
            case ast.Dict(keys=keys, values=values):
                return {of(key): of(value) for key, value in zip(keys, values, strict=True) if key is not None}
            case ast.Subscript(value=value, slice=index):
                return of(value)[of(index)]
            case ast.Call(func=ast.Name(id=name), args=given):
                return _FUNCTIONS[name](*[of(argument) for argument in given])
        raise UsageError(f"{self.text!r} cannot be worked out")
