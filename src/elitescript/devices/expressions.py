"""Small expressions over the robot's signals, as wires and scenario files hold them.

They look like Python: `standard_digital_out[0] and standard_analog_out[1] > 2.5`. Nothing can be named but signals and
what the place of the expression offers; nothing can be called but a few functions of numbers and texts.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from typing import Any, Final

from elitescript.errors import DebugError, UsageError, did_you_mean
from elitescript.language.advice.expression_slips import plain_word
from elitescript.messages.signals import SIGNALS, Value, signal_name
from elitescript.values.concrete import Indexed, builtin_call, computed
from elitescript.values.places import signal_at
from elitescript.values.plain import COMPARISONS, MEMBERSHIP, NoExpression, tree_of

_OPERATORS: Final = frozenset(
    {
        *(ast.Add, ast.Sub, ast.Mult, ast.Div, ast.FloorDiv, ast.Mod, ast.USub, ast.UAdd),
        *(*COMPARISONS, *MEMBERSHIP, ast.And, ast.Or, ast.Not, ast.Load),
    }
)
_FUNCTIONS: Final = ("abs", "bool", "float", "int", "len", "max", "min", "round", "str", "sum")

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
        try:
            self._body = tree_of(text.strip())
        except NoExpression as error:
            raise UsageError(f"{text!r} is no expression: {error}") from None
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
        known = arguments or {}

        def value(name: str) -> Any:
            if name in known:
                return known[name]
            return read(name) if SIGNALS[name].size == 1 else Indexed(lambda index: read(f"{name}[{index}]"))

        try:
            return computed(self._body, value, builtin_call)
        except DebugError as error:
            raise UsageError(f"{self.text!r} cannot be worked out: {error}") from error

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
                    elif type(child) not in _OPERATORS:
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
        root = node.value if isinstance(node, ast.Subscript) else node
        if isinstance(root, ast.Name) and root.id in self._names:
            return None
        try:
            found = signal_at(node, has_lists=False)
        except UsageError as error:
            raise UsageError(f"{self.text!r}: {error}") from None
        return None if found is None else signal_name(*found)
