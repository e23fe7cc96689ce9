"""Evaluates expressions."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Callable, Sequence
from math import inf
from typing import Any, Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.language.nodes import children
from elitescript.values import calls, narrowing
from elitescript.values.called import Calls
from elitescript.values.description import (
    BOTTOM,
    BYTES,
    DICT,
    FUNCTION,
    INT,
    LIST,
    NO_SITES,
    OBJECT,
    RANGE,
    ROW,
    SET,
    SIZE_MAX,
    SOME_BOOL,
    SOME_OBJECT,
    SOME_TEXT,
    TEXT,
    TUPLE,
    UNKNOWN,
    WHOLE,
    Shape,
    Value,
    constant,
    join,
    join_all,
    row,
    same,
    shaped,
    unknown_of,
)
from elitescript.values.operators import binary, compare, unary
from elitescript.values.plain import LONGEST
from elitescript.values.references import Method, ModuleType, Name, Own
from elitescript.values.state import DEPTH_MAX, GivenUp


class Expressions(Calls):
    """Evaluates expressions, and gives values to what stands on the left of assignments."""

    def expression(self, node: ast.expr) -> Value:
        """Return what an expression is, and note it."""
        kind = type(node)
        if kind is ast.Constant:
            # Equal literals have one description.
            written = node.value  # type: ignore[attr-defined]
            key = (type(written), written)
            value = self._literals.get(key)
            if value is None:
                value = self._literals[key] = constant(written)
            self.values[node] = value
            return value
        visit = _EXPRESSIONS.get(kind)
        if visit is None:
            for child in children(node):
                if isinstance(child, ast.expr):
                    self._escape(self.expression(child))
            value = UNKNOWN
        else:
            self._depth += 1
            if self._depth > DEPTH_MAX:
                raise GivenUp
            value = visit(self, node)
            self._depth -= 1
        self.values[node] = value
        return value

    def _name(self, node: ast.Name) -> Value:
        names = self._names.get(self._scope)
        variable = names[node.id] if names is not None and node.id in names else self.variable(node.id, self._scope)
        if variable is None:
            return self._builtin(node.id)
        return self._read(variable)

    def _builtin(self, name: str) -> Value:
        found = self._builtins.get(name)
        if found is None:
            if name in self.presets:
                found = UNKNOWN
            elif CATALOGUE.get(name) is not None or name in calls.READERS or name in calls.CONSTANT_RESULTS:
                found = Value(FUNCTION, constants=(), refs=(Name(name),))
            elif name in ("copy", "elicopy"):
                found = Value(OBJECT, constants=(), refs=(ModuleType("copy"),))
            elif isinstance(kind := getattr(builtins, name, None), type):
                found = Value(FUNCTION, constants=(), refs=(Name(name),) if kind is not type else None)
            elif callable(kind):
                found = Value(FUNCTION, constants=(), refs=(Name(name),))
            else:
                found = UNKNOWN
            self._builtins[name] = found
        return found

    def _computed(self, node: ast.AST, op: ast.operator, left: Value, right: Value) -> Value:
        if left.sites or right.sites:
            left, right = self._now(left), self._now(right)
        makes_list = (left.kinds | right.kinds) & (LIST | DICT | SET)
        found = binary(op, left, right, self._site(node) if makes_list else NO_SITES, node if makes_list else None)
        if (left.kinds | right.kinds) & OBJECT:
            # The operator may be a method of the program.
            self._escape(left)
            self._escape(right)
        return found

    def _binary(self, node: ast.BinOp) -> Value:
        # A long sum is a deep tree: its left spine is followed without recursion.
        spine = [node]
        left = node.left
        while type(left) is ast.BinOp:
            spine.append(left)
            left = left.left
        value = self.expression(left)
        while spine:
            part = spine.pop()
            right = self.expression(part.right)
            value = self._computed(part, part.op, value, right)
            self.values[part] = value
        return value

    def _unary(self, node: ast.UnaryOp) -> Value:
        operand = self.expression(node.operand)
        if operand.kinds & ROW:
            operand = self._now(operand)
        if type(node.operand) is ast.Constant:
            key = (type(node.op), operand)
            value = self._literals.get(key)
            if value is None:
                value = self._literals[key] = unary(node.op, operand)
            return value
        return unary(node.op, operand)

    def _logical(self, node: ast.BoolOp) -> Value:
        is_and = isinstance(node.op, ast.And)
        mark = len(self._trail)
        found = BOTTOM
        last = len(node.values) - 1
        for index, part in enumerate(node.values):
            value = self.expression(part)
            if index < last:
                found = join(found, narrowing.by_truth(value, not is_and))
                self.narrow(part, is_and)
            else:
                found = join(found, value)
        if len(self._trail) > mark:
            self._take_back(mark)
        return found

    def _take_back(self, mark: int) -> None:
        """Take back what conditions have narrowed, and keep what `:=` has set."""
        changed = self._changes(mark)
        self._undo(mark)
        for variable, value in changed.items():
            before = self._state.get(variable)
            if before is None:
                self._set(variable, value)
            else:
                joined = join(before, value)
                if joined is not before and not same(joined, before):
                    self._set(variable, joined)

    def _choice(self, node: ast.IfExp) -> Value:
        self.expression(node.test)
        mark = len(self._trail)
        self.narrow(node.test, True)
        first = self.expression(node.body)
        self._take_back(mark)
        mark = len(self._trail)
        self.narrow(node.test, False)
        second = self.expression(node.orelse)
        self._take_back(mark)
        return join(first, second)

    def _walrus(self, node: ast.NamedExpr) -> Value:
        value = self.expression(node.value)
        self._bind(node.target, value)
        return value

    def _comparison(self, node: ast.Compare) -> Value:
        left = self._now(self.expression(node.left))
        outcomes: list[bool | None] = []
        is_foreign = False
        for op, part in zip(node.ops, node.comparators, strict=True):
            right = self._now(self.expression(part))
            outcomes.append(compare(op, left, right))
            is_foreign = is_foreign or bool((left.kinds | right.kinds) & OBJECT)
            left = right
        if False in outcomes:
            return constant(False, 2, 2)
        if None in outcomes:
            return UNKNOWN if is_foreign and self._has_classes else SOME_BOOL
        return constant(True, 2, 2)

    def _list(self, node: ast.List | ast.Tuple) -> Value:
        is_list = isinstance(node, ast.List)
        site = self._site(node) if is_list else NO_SITES
        items: list[Value] = []
        is_long, is_reached = len(node.elts) > SIZE_MAX, True
        for part in node.elts:
            if isinstance(part, ast.Starred):
                is_long = True
                items.append(calls.element_of(self._now(self.expression(part.value))))
                is_reached = is_reached and bool(items[-1].kinds)
                continue
            value = self.expression(part)
            if not value.kinds:
                is_reached = False
            elif value.node is not part and value.shape is None and not value.has_constant:
                value = value.but(node=part)
            items.append(value)
        if not is_reached:
            return BOTTOM
        kind = LIST if is_list else TUPLE
        if is_long:
            return shaped(kind, Shape(None, join_all(items)), site)
        return row(kind, items, site)

    def _set_display(self, node: ast.Set) -> Value:
        for part in node.elts:
            self._escape(self.expression(part))
        return Value(SET, constants=())

    def _dict(self, node: ast.Dict) -> Value:
        for key in node.keys:
            if key is not None:
                self._escape(self.expression(key))
        values = [self.expression(value) for value in node.values]
        site = self._site(node)
        if None in node.keys:
            return Value(DICT, constants=(), sites=site | unknown_of(*values).sites)
        return shaped(DICT, Shape(None, join_all(values), 0, inf), site)

    def _text(self, node: ast.JoinedStr) -> Value:
        parts: list[Value] = []
        has_formats = False
        for part in node.values:
            if isinstance(part, ast.FormattedValue):
                parts.append(self.expression(part.value))
                if part.format_spec is not None:
                    self.expression(part.format_spec)
                has_formats = has_formats or part.conversion != -1 or part.format_spec is not None
            else:
                parts.append(self.expression(part))
        if any(not part.kinds for part in parts):
            return BOTTOM
        if has_formats or not all(part.has_constant for part in parts):
            return SOME_TEXT
        text = "".join(str(part.constant) for part in parts)
        return constant(text) if len(text) <= LONGEST else SOME_TEXT

    def _lambda(self, node: ast.Lambda) -> Value:
        for default in (*node.args.defaults, *node.args.kw_defaults):
            if default is not None:
                self.expression(default)
        made = self.symbols.scope_made_by(node)
        return Value(FUNCTION, constants=(), refs=None if made is None else (Own(node),))

    def _comprehension(self, node: ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp) -> Value:
        outer, was_lazy = self._scope, self._is_lazy
        made = self.symbols.scope_made_by(node)
        mark = len(self._trail)
        least, most = 1.0, 1.0
        for number, generator in enumerate(node.generators):
            every = self._now(self.expression(generator.iter))
            if number == 0:
                self._scope = made or outer
                # What a generator computes is computed later, when its variables may have changed.
                self._is_lazy = was_lazy or isinstance(node, ast.GeneratorExp)
                self._repeated += 1
            low, high = calls.length_of(every)
            least, most = least * low, 0 if 0 in (most, high) else most * high
            self._bind(generator.target, calls.element_of(every) if every.kinds else BOTTOM)
            for condition in generator.ifs:
                least = 0
                self.expression(condition)
                self.narrow(condition, True)
        if isinstance(node, ast.DictComp):
            self._escape(self.expression(node.key))
            element = self.expression(node.value)
        else:
            element = self.expression(node.elt)
        self._scope, self._is_lazy = outer, was_lazy
        self._repeated -= 1
        self._take_back(mark)
        if isinstance(node, ast.ListComp):
            return shaped(LIST, Shape(None, element, least if least == least else 0, most), self._site(node))
        if isinstance(node, ast.GeneratorExp):
            return Value(OBJECT, constants=(), shape=Shape(None, element), refs=None)
        if isinstance(node, ast.DictComp):
            return shaped(DICT, Shape(None, element), self._site(node))
        self._escape(element)
        return Value(SET, constants=())

    def _yield(self, node: ast.Yield | ast.YieldFrom) -> Value:
        if node.value is not None:
            self._escape(self.expression(node.value))
        self._changed_result(SOME_OBJECT)
        return UNKNOWN

    def _starred(self, node: ast.Starred) -> Value:
        self.expression(node.value)
        return UNKNOWN

    def _attribute(self, node: ast.Attribute) -> Value:
        owner = self.expression(node.value)
        if not owner.kinds:
            return BOTTOM
        if owner.refs and len(owner.refs) == 1 and isinstance(owner.refs[0], ModuleType):
            return self.member(owner.refs[0], node.attr)
        # What it is may change the list or dict that it belongs to.
        self._escape(owner)
        return UNKNOWN if owner.kinds & OBJECT else Value(FUNCTION, constants=(), refs=(Method(node.attr),))

    def _subscript(self, node: ast.Subscript) -> Value:
        return self._subscript_value(node)

    def _subscript_value(self, node: ast.Subscript) -> Value:
        owner = self._now(self.expression(node.value))
        part = node.slice
        if isinstance(part, ast.Slice):
            ends = [None if end is None else self.expression(end) for end in (part.lower, part.upper, part.step)]
            return self._slice(node, owner, ends)
        index = self.expression(part)
        if not owner.kinds or not index.kinds:
            return BOTTOM
        kinds = owner.kinds
        if kinds & OBJECT:
            self._escape(index)
            return unknown_of(owner)
        found = BOTTOM
        if kinds & TEXT:
            found = SOME_TEXT.but(may=owner.may, must=owner.must)
        if kinds & BYTES:
            found = join(found, Value(INT, 0, 255, None, "", owner.may, owner.must))
        if kinds & DICT:
            found = join(found, unknown_of(owner) if owner.shape is None else owner.shape.any)
        if kinds & (ROW | RANGE):
            found = join(found, _item(owner, index))
        return found if found.kinds else UNKNOWN

    def _slice(self, node: ast.AST, owner: Value, ends: list[Value | None]) -> Value:
        if not owner.kinds or any(end is not None and not end.kinds for end in ends):
            return BOTTOM
        if not owner.kinds & ~(TEXT | BYTES):
            return owner.but(constants=None, node=None)
        if owner.kinds & ~(ROW | TEXT | BYTES):
            return unknown_of(owner)
        site = self._site(node) if owner.kinds & LIST else NO_SITES
        shape = owner.shape
        if shape is None:
            return owner.but(constants=None, role="", sites=site | owner.sites, node=None)
        if owner.kinds & ~ROW:
            cut = Shape(None, shape.any, 0, shape.most)
            return owner.but(constants=None, shape=cut, role="", sites=site, node=None)
        bounds: list[Any] = [None if end is None else end.constant if end.has_constant else end for end in ends]
        if shape.items is not None and not any(isinstance(bound, Value) for bound in bounds):
            try:
                items = shape.items[slice(*bounds)]
            except (TypeError, ValueError):
                return UNKNOWN
            is_whole = len(items) == len(shape.items)
            role = owner.role if is_whole else ""
            cut = Shape(items, is_counted=shape.is_counted and is_whole)
            return owner.but(shape=cut, sites=site, role=role, node=owner.node if is_whole else None)
        is_whole = all(end is None for end in ends)
        if is_whole:
            return owner.but(sites=site)
        return owner.but(shape=Shape(None, shape.any, 0, shape.most), sites=site, role="", node=None)

    def _bind(self, target: ast.expr, value: Value) -> None:
        """Give a value to what stands on the left of an assignment."""
        if isinstance(target, ast.Name):
            variable = self.variable(target.id, self._scope)
            if variable is not None:
                self._assign(variable, value)
            self.values[target] = value
        elif isinstance(target, (ast.Tuple, ast.List)):
            self._unpack(target, value)
        elif isinstance(target, ast.Starred):
            items = Value(LIST, constants=(), shape=Shape(None, value), sites=self._site(target))
            self._bind(target.value, items)
        elif isinstance(target, ast.Subscript):
            self._store_item(target, value)
        elif isinstance(target, ast.Attribute):
            self.expression(target.value)
            self._escape(value)

    def _unpack(self, target: ast.Tuple | ast.List, value: Value) -> None:
        value = self._now(value)
        shape = value.shape
        parts: Sequence[Value] | None = None
        if shape is not None and not value.kinds & ~(ROW | RANGE):
            is_starred = any(isinstance(part, ast.Starred) for part in target.elts)
            if shape.items is not None and len(shape.items) == len(target.elts) and not is_starred:
                parts = shape.items
        if parts is None:
            element = calls.element_of(value) if value.kinds else BOTTOM
            parts = (element,) * len(target.elts)
        for part, item in zip(target.elts, parts, strict=True):
            self._bind(part, item)

    def _store_item(self, target: ast.Subscript, value: Value) -> None:
        owner = self.expression(target.value)
        part = target.slice
        if isinstance(part, ast.Slice):
            for end in (part.lower, part.upper, part.step):
                if end is not None:
                    self.expression(end)
            self._store(owner, None, calls.element_of(self._now(value)), grows=True)
            return
        index = self.expression(part)
        place = index.constant if index.has_constant and index.kinds == INT else None
        if place is not None and place < 0:
            shape = owner.shape
            place = place + len(shape.items) if shape is not None and shape.items is not None else None
        self._store(owner, place, value, grows=bool(owner.kinds & DICT))


def _item(owner: Value, index: Value) -> Value:
    """Return an element of a list, tuple or range."""
    shape = owner.shape
    if shape is None:
        return unknown_of(owner)
    if not index.kinds & WHOLE:
        # An error; or, with an object, anything.
        return UNKNOWN
    items = shape.items
    if items is None:
        element = shape.element
        if shape.is_counted and index.has_constant and index.constant == 0:
            return element.but(kinds=INT)
        return element if element.kinds else UNKNOWN
    if index.kinds & ~WHOLE:
        return join_all(items) if items else UNKNOWN
    if index.has_constant:
        place = index.constant
        return items[place] if -len(items) <= place < len(items) else UNKNOWN
    if index.constants is not None:
        return join_all(items[place] for place in index.constants if -len(items) <= place < len(items))
    return join_all(items) if items else UNKNOWN


_EXPRESSIONS: Final[dict[type[ast.expr], Callable[[Expressions, Any], Value]]] = {
    ast.Name: Expressions._name,
    ast.BinOp: Expressions._binary,
    ast.UnaryOp: Expressions._unary,
    ast.BoolOp: Expressions._logical,
    ast.IfExp: Expressions._choice,
    ast.NamedExpr: Expressions._walrus,
    ast.Compare: Expressions._comparison,
    ast.List: Expressions._list,
    ast.Tuple: Expressions._list,
    ast.Set: Expressions._set_display,
    ast.Dict: Expressions._dict,
    ast.JoinedStr: Expressions._text,
    ast.Lambda: Expressions._lambda,
    ast.ListComp: Expressions._comprehension,
    ast.SetComp: Expressions._comprehension,
    ast.DictComp: Expressions._comprehension,
    ast.GeneratorExp: Expressions._comprehension,
    ast.Yield: Expressions._yield,
    ast.YieldFrom: Expressions._yield,
    ast.Starred: Expressions._starred,
    ast.Attribute: Expressions._attribute,
    ast.Subscript: Expressions._subscript,
    ast.Call: Expressions._call,
}
