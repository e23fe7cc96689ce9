"""Follows what conditions say of local variables."""

from __future__ import annotations

import ast
from collections.abc import Callable

from elitescript.values import narrowing
from elitescript.values.description import (
    INT,
    ROW,
    UNKNOWN,
    Value,
)
from elitescript.values.plain import MIRRORED
from elitescript.values.state import State


class Conditions(State):
    """Narrows local variables by conditions."""

    def narrow(self, test: ast.expr, outcome: bool) -> None:
        """Go on with what a condition says of local variables if it is true, or not."""
        if isinstance(test, ast.Name):
            self._narrow_name(test, lambda value: narrowing.by_truth(value, outcome))
        elif isinstance(test, ast.UnaryOp):
            if isinstance(test.op, ast.Not):
                self.narrow(test.operand, not outcome)
        elif isinstance(test, ast.BoolOp):
            if isinstance(test.op, ast.And) is outcome:
                for part in test.values:
                    self.narrow(part, outcome)
        elif isinstance(test, ast.NamedExpr):
            self._narrow_name(test.target, lambda value: narrowing.by_truth(value, outcome))
        elif isinstance(test, ast.Compare):
            if len(test.ops) == 1:
                self._narrow_comparison(test, outcome)
            elif outcome:
                parts = (test.left, *test.comparators)
                for left, op, right in zip(parts, test.ops, parts[1:], strict=False):
                    self._narrow_side(left, type(op), self.values.get(right, UNKNOWN), outcome)
        elif isinstance(test, ast.Call):
            self._narrow_class(test, outcome)

    def _narrow_comparison(self, test: ast.Compare, outcome: bool) -> None:
        op, left, right = type(test.ops[0]), test.left, test.comparators[0]
        self._narrow_side(left, op, self.values.get(right, UNKNOWN), outcome)
        mirrored = MIRRORED.get(op)
        if mirrored is not None and not isinstance(right, ast.Constant):
            self._narrow_side(right, mirrored, self.values.get(left, UNKNOWN), outcome)

    def _narrow_side(self, node: ast.expr, op: type[ast.cmpop], other: Value, outcome: bool) -> None:
        if op in (ast.In, ast.NotIn):
            return
        if isinstance(node, ast.NamedExpr):
            node = node.target
        if isinstance(node, ast.Name):
            self._narrow_name(node, lambda value: narrowing.by_comparison(op, value, other, outcome))
        elif isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name):
            index = self.values.get(node.slice, UNKNOWN)
            if index.has_constant and index.kinds == INT:
                place = index.constant
                self._narrow_row(node.value, lambda value: narrowing.by_item(value, place, op, other, outcome))
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and len(node.args) == 1:
            given = node.args[0]
            is_length = node.func.id in ("len", "length", "get_list_length") and self._is_builtin(node.func)
            if is_length and isinstance(given, ast.Name):
                self._narrow_row(given, lambda value: narrowing.by_length(value, op, other, outcome))

    def _is_builtin(self, node: ast.Name) -> bool:
        return self.variable(node.id, self._scope) is None

    def _narrow_name(self, node: ast.Name, change: Callable[[Value], Value]) -> None:
        variable = self.variable(node.id, self._scope)
        if variable is None or variable.owner is not self._function or variable.is_shared or self._is_lazy:
            return
        old = self._state.get(variable)
        if old is not None and old.kinds:
            new = change(old)
            if new is not old and new.kinds:
                self._set(variable, new)

    def _narrow_row(self, node: ast.Name, change: Callable[[Value], Value]) -> None:
        """Narrow a list that nothing can change in between."""

        def narrowed(value: Value) -> Value:
            if value.kinds & ~ROW or value.shape is None:
                return value
            self._now(value)
            return change(value) if self._are_unchanged(value) else value

        self._narrow_name(node, narrowed)

    def _narrow_class(self, test: ast.Call, outcome: bool) -> None:
        function = test.func
        if not isinstance(function, ast.Name) or function.id != "isinstance" or len(test.args) != 2:
            return
        subject, classes = test.args
        if not self._is_builtin(function) or not isinstance(subject, ast.Name):
            return
        parts = classes.elts if isinstance(classes, ast.Tuple) else [classes]
        names = tuple(part.id for part in parts if isinstance(part, ast.Name) and self._is_builtin(part))
        if len(names) == len(parts):
            self._narrow_name(subject, lambda value: narrowing.by_class(value, names, outcome))
