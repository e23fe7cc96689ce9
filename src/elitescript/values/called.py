"""Follows calls: of commands, built-in functions, methods, and functions of the program."""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence
from math import inf
from typing import Any, Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.registry import Command
from elitescript.errors import ScriptError
from elitescript.language.modules import AVAILABLE
from elitescript.language.symbols import THREAD_STARTER
from elitescript.values import calls
from elitescript.values.conditions import Conditions
from elitescript.values.description import (
    BOTTOM,
    BYTES,
    DICT,
    FUNCTION,
    IN_BASE,
    INT,
    LIST,
    MEASURED,
    NO_SITES,
    NONE,
    NOTHING,
    OBJECT,
    ROW,
    SET,
    SIZE_MAX,
    SOME_BYTES,
    SOME_COUNT,
    TEXT,
    TUPLE,
    UNKNOWN,
    WHOLE,
    Shape,
    Value,
    constant,
    join,
    row,
    unknown_of,
)
from elitescript.values.references import Library, Made, Method, ModuleType, Name, Own, OwnClass
from elitescript.values.results import POSITION, at_sites, result_of
from elitescript.values.state import CALL_DEPTH_MAX, CALLED_AT_MOST
from elitescript.values.store import Cell, Function

_INEXACT: Final = frozenset(
    (
        *("pose_add", "pose_sub", "pose_trans", "pose_inv", "pose_dist", "point_dist", "interpolate_pose"),
        *("norm", "normalize", "get_forward_kin", "get_inverse_kin", "rotvec2rpy", "rpy2rotvec"),
        *("sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sqrt", "d2r", "r2d"),
    )
)
"""Commands whose result is measured if an argument is."""


class Calls(Conditions):
    """Evaluates calls."""

    def _call_own(self, node: ast.AST, args: Sequence[Value], keywords: dict[str, Value], is_certain: bool) -> Value:
        """Return what a function of the program returns, having joined what it gets."""
        if self._log is not None:
            return self._logged("_call_own", node, args, keywords, is_certain)  # type: ignore[no-any-return]
        function = self._function_at(node)
        if function.is_open:
            for value in (*args, *keywords.values()):
                self._escape(value)
        else:
            self._pass(function, args, keywords, is_certain)
        if not function.evaluations:
            if len(self._active) <= CALL_DEPTH_MAX and self._depth <= CALLED_AT_MOST:
                self._evaluate(function)
            else:
                function.evaluations = 1
                self._changed((function,))
        function.result.readers[self._function] = None
        return function.result.value

    def _pass(self, function: Function, args: Sequence[Value], keywords: dict[str, Value], is_certain: bool) -> None:
        if function.arguments is None:
            return
        positional, names, defaults = function.signature
        given: dict[str, Value] = dict(zip(positional, args, strict=False))
        for extra in args[len(positional) :]:
            self._escape(extra)
        for name, value in keywords.items():
            if name in names:
                given[name] = value
            else:
                self._escape(value)
        if not is_certain:
            given = {name: join(given.get(name, BOTTOM), UNKNOWN) for name in names}
        else:
            for name, node in defaults.items():
                if name not in given:
                    given[name] = self._noted(node)
        is_changed = False
        for name, value in given.items():
            cell = function.parameters.get(name)
            if cell is None:
                cell = function.parameters[name] = Cell()
            is_changed = cell.add(value) or is_changed
        if is_changed and function.evaluations:
            self._changed((function,))

    def _call(self, node: ast.Call) -> Value:
        function = node.func
        if isinstance(function, ast.Attribute):
            return self._call_attribute(node, function)
        called = self.expression(function)
        args, keywords, is_certain = self._arguments(node)
        return self._apply(node, called, args, keywords, is_certain)

    def _arguments(self, node: ast.Call) -> tuple[list[Value], dict[str, Value], bool]:
        """Return what a call passes by position and by keyword, and whether that is all."""
        args: list[Value] = []
        keywords: dict[str, Value] = {}
        is_certain = True
        for part in node.args:
            value = self.expression(part)
            if isinstance(part, ast.Starred):
                is_certain = False
                self._escape(self.values[part.value])
            elif is_certain:
                args.append(value)
            else:
                self._escape(value)
        for keyword in node.keywords:
            value = self.expression(keyword.value)
            if keyword.arg is None:
                is_certain = False
                self._escape(value)
            else:
                keywords[keyword.arg] = value
        return args, keywords, is_certain

    def _apply(
        self, node: ast.Call, called: Value, args: list[Value], keywords: dict[str, Value], is_certain: bool
    ) -> Value:
        """Return what a call returns."""
        if not called.kinds:
            return BOTTOM
        refs = called.refs
        if not refs and isinstance(node.func, ast.Name) and self._is_missing(node.func.id):
            # An alarm: nothing gets the arguments.
            return UNKNOWN
        if not refs or (called.kinds & ~(FUNCTION | OBJECT) and not isinstance(refs[0], Name)):
            for value in (*args, *keywords.values()):
                self._escape(value)
            return UNKNOWN
        found = BOTTOM
        for ref in refs:
            found = join(found, self._apply_one(node, ref, args, keywords, is_certain))
        return found

    def _apply_one(
        self, node: ast.Call, ref: Any, args: list[Value], keywords: dict[str, Value], is_certain: bool
    ) -> Value:
        if isinstance(ref, Own):
            return self._call_own(ref.node, args, keywords, is_certain)
        if isinstance(ref, Name):
            return self._call_name(node, ref.name, args, keywords, is_certain)
        for value in (*args, *keywords.values()):
            self._escape(value)
        if isinstance(ref, OwnClass) and not ref.is_object:
            made = (OwnClass(ref.scope, True),)
            written = ref.scope.node
            is_plain = isinstance(written, ast.ClassDef) and not (written.decorator_list or written.keywords)
            is_plain = is_plain and "__new__" not in ref.scope.bindings
            return Value(OBJECT, constants=(), refs=made) if is_plain else UNKNOWN.but(refs=made)
        if isinstance(ref, Library):
            return Value(OBJECT, constants=(), refs=(ref,))
        return UNKNOWN

    def _call_name(
        self, node: ast.Call, name: str, args: list[Value], keywords: dict[str, Value], is_certain: bool
    ) -> Value:
        command = CATALOGUE.get(name)
        if command is not None:
            return self._call_command(node, command, args, keywords, is_certain)
        module, _, member = name.rpartition(".")
        if module == "math":
            return calls.call_math(member, args) if is_certain else UNKNOWN
        if module in ("copy", "elicopy") and member in ("copy", "deepcopy") and len(args) == 1:
            return self._copy(node, args[0])
        if name in calls.READERS and is_certain:
            if keywords:
                for value in keywords.values():
                    self._escape(value)
                for value in args:
                    # A function among them gets the elements.
                    self._escape(calls.element_of(value) if value.kinds else value)
            current = [self._now(value) for value in args]
            return calls.call_builtin(name, current, bool(keywords), self._site(node))
        for value in (*args, *keywords.values()):
            self._escape(value)
        if name == "struct.pack":
            return SOME_BYTES
        if module:
            return UNKNOWN.but(refs=(Made(name),))
        if not is_certain:
            return UNKNOWN
        return calls.call_builtin(name, [unknown_of(value) for value in args], bool(keywords), NO_SITES)

    def _copy(self, node: ast.AST, value: Value) -> Value:
        """Return a copy of a value."""
        value = self._now(value)
        if not value.kinds or not value.kinds & ~(TEXT | BYTES | NONE | 7 | TUPLE):
            return value
        if value.kinds & ~LIST or value.shape is None:
            return unknown_of(value)
        return value.but(sites=self._site(node))

    def _call_command(
        self, node: ast.Call, command: Command, args: list[Value], keywords: dict[str, Value], is_certain: bool
    ) -> Value:
        for value in args:
            if not value.kinds:
                return BOTTOM
        for value in keywords.values():
            if not value.kinds:
                return BOTTOM
        if command.name == THREAD_STARTER:
            self._start(args, keywords, is_certain)
        if args and not command.takes_robot and not keywords and is_certain:
            folded = self._folded(node, command, args)
            if folded is not None:
                return folded
        result = result_of(command)
        if result.kinds & (LIST | DICT):
            sites = self._site(node)
            result = self._results.get(node) or self._results.setdefault(node, at_sites(command, sites))
        if command.name == "modbus_get_signal_status" and args:
            return self.signals.narrowed(result, args[0])
        counted_by, frame = command.details.result.counted_by, command.details.result.frame
        # What is computed of a reading is as inexact.
        more = (
            MEASURED
            if command.name in _INEXACT and any(value.must & MEASURED for value in (*args, *keywords.values()))
            else 0
        )
        if frame and _frame_of(command, frame, args, keywords) & IN_BASE:
            more |= IN_BASE
        if more:
            return result.but(may=result.may | more, must=result.must | more)
        if counted_by and result.shape is not None:
            return _counted(result, args[0] if args and is_certain else UNKNOWN)
        if command.name in ("length", "get_list_length") and args:
            return calls.call_builtin("len", [self._now(args[0])], False, NO_SITES)
        return result

    def _folded(self, node: ast.Call, command: Command, args: list[Value]) -> Value | None:
        """Return the result of a command that depends on its arguments alone, if they are all constants."""
        plain = []
        must = may = 0
        for value in args:
            known = plain_value(self._now(value))
            if known is UNKNOWN:
                return None
            plain.append(known)
            may, must = may | value.may, must | value.must
        try:
            bound = command.bind(tuple(plain), {})
            result = command.function(self.profile, *bound) if command.takes_profile else command.function(*bound)
        except (ScriptError, ArithmeticError, ValueError, TypeError):
            return UNKNOWN
        if isinstance(result, tuple):
            if not all(isinstance(number, (bool, int, float)) for number in result):
                return None
            template = result_of(command)
            roles: Sequence[Value] = ()
            if template.shape is not None and template.shape.items is not None:
                roles = template.shape.items
            items = [
                constant(number).but(role=roles[index].role if index < len(roles) else "")
                for index, number in enumerate(result)
            ]
            made = row(LIST, items, self._site(node))
            frame = template.must & IN_BASE
            return made.but(role=template.role, may=made.may | frame, must=made.must | frame)
        if isinstance(result, (bool, int, float, str)):
            role = POSITION if -1 in command.details.result.special else command.details.returns.unit
            made = constant(result, may or 1, must or 1)
            return made.but(role=role) if role else made
        return None

    def _start(self, args: list[Value], keywords: dict[str, Value], is_certain: bool) -> None:
        """Call the function that a thread runs."""
        function = args[0] if args else keywords.get("function", keywords.get("fundef", UNKNOWN))
        given = args[1] if len(args) > 1 else keywords.get("args", keywords.get("arg", row(TUPLE, ())))
        given = self._now(given)
        shape = given.shape
        values: list[Value] = []
        if shape is not None and shape.items is not None and not given.kinds & ~ROW and is_certain:
            values = list(shape.items)
        else:
            is_certain = False
            self._escape(given)
        for ref in function.refs or ():
            if isinstance(ref, Own):
                self._call_own(ref.node, values, {}, is_certain)
        if function.refs is None or any(not isinstance(ref, Own) for ref in function.refs):
            self._escape(given)

    def _call_attribute(self, node: ast.Call, function: ast.Attribute) -> Value:
        owner = self.expression(function.value)
        name = function.attr
        if owner.refs and not owner.kinds & ~(OBJECT | FUNCTION) and owner.shape is None:
            called = self._attribute_of(owner, name)
            self.values[function] = called
            args, keywords, is_certain = self._arguments(node)
            self._escape(owner)
            return self._apply(node, called, args, keywords, is_certain)
        self.values[function] = UNKNOWN if owner.kinds & OBJECT else Value(FUNCTION, constants=(), refs=(Method(name),))
        args, keywords, is_certain = self._arguments(node)
        if not owner.kinds or any(not value.kinds for value in args):
            return BOTTOM
        return self._call_method(node, owner, name, args, keywords)

    def _attribute_of(self, owner: Value, name: str) -> Value:
        found = BOTTOM
        for ref in owner.refs or ():
            found = join(found, self.member(ref, name) if isinstance(ref, ModuleType) else UNKNOWN)
        return found

    def member(self, module: ModuleType, name: str) -> Value:
        """Return what a name of a module is."""
        whole = f"{module.name}.{name}"
        if whole in AVAILABLE:
            return Value(OBJECT, constants=(), refs=(ModuleType(whole),))
        if module.name == "math":
            if name in calls.MATH_CONSTANTS:
                return constant(calls.MATH_CONSTANTS[name])
            return Value(FUNCTION, constants=(), refs=(Name(whole),))
        return UNKNOWN.but(refs=(Name(whole),))

    def _call_method(
        self, node: ast.Call, owner: Value, name: str, args: list[Value], keywords: dict[str, Value]
    ) -> Value:
        """Return what a method of a value returns, having noted what it changes."""
        kinds = owner.kinds & ~NONE or NONE
        if kinds in (TEXT, BYTES):
            for value in args:
                if value.kinds & OBJECT:
                    self._escape(value)
            return calls.text_method(owner, name, self._site(node))
        if not kinds & ~(WHOLE | 4):
            return calls.number_method(name)
        if kinds == LIST and owner.shape is not None:
            return self._list_method(node, owner, name, args)
        if kinds == SET:
            for value in args:
                self._escape(value)
            is_set = name in ("copy", "union", "intersection", "difference", "symmetric_difference")
            return Value(SET, constants=()) if is_set else UNKNOWN
        if kinds == TUPLE:
            return SOME_COUNT if name in ("count", "index") else UNKNOWN
        for value in (*args, *keywords.values()):
            self._escape(value)
        if kinds == DICT:
            return self._dict_method(node, owner, name, args)
        self._escape(owner)
        return unknown_of(owner)

    def _list_method(self, node: ast.Call, owner: Value, name: str, args: list[Value]) -> Value:
        now = self._now(owner)
        shape = now.shape
        assert shape is not None
        if name in ("append", "insert"):
            if args:
                self._store(owner, None, args[-1], grows=True)
            return NOTHING
        if name == "extend":
            if args:
                self._store(owner, None, calls.element_of(self._now(args[0])), grows=True)
            return NOTHING
        if name in ("sort", "reverse"):
            self._store(owner, None, shape.any, grows=False)
            for value in args:
                self._escape(value)
            return NOTHING
        if name == "pop":
            self._store(owner, None, BOTTOM, grows=True)
            return shape.any if shape.any.kinds else UNKNOWN
        if name in ("remove", "clear"):
            self._store(owner, None, BOTTOM, grows=True)
            return NOTHING
        if name == "copy":
            return now.but(sites=self._site(node))
        if name in ("count", "index"):
            return SOME_COUNT
        self._escape(owner)
        for value in args:
            self._escape(value)
        return UNKNOWN

    def _dict_method(self, node: ast.Call, owner: Value, name: str, args: list[Value]) -> Value:
        if name == "copy":
            return owner.but(sites=self._site(node) | owner.sites)
        if name == "get" and owner.shape is not None and args:
            found = self._now(owner)
            assert found.shape is not None
            return join(found.shape.any, args[1] if len(args) > 1 else NOTHING)
        if name in ("keys", "values", "items"):
            return unknown_of(owner).but(kinds=OBJECT, low=inf, high=-inf, constants=())
        self._escape(owner)
        return unknown_of(owner)


def _frame_of(command: Command, name: str, args: Sequence[Value], keywords: Mapping[str, Value]) -> int:
    """Return the origins of the argument in whose frame a result is; 0 if there is none."""
    names = [param.name for param in command.params]
    index = names.index(name) if name in names else len(args)
    value = args[index] if index < len(args) else keywords.get(name)
    return 0 if value is None else value.must


def _counted(result: Value, number: Value) -> Value:
    """Return what a reading of so many values returns: how many arrived, then the values."""
    shape = result.shape
    assert shape is not None
    values = shape.element
    most = number.high
    count = Value(INT, 0, most if most >= 0 else inf, None, "count", result.may, result.must)
    if number.has_constant and number.kinds == INT and 0 <= number.constant <= SIZE_MAX:
        return result.but(shape=Shape((count, *(values,) * number.constant), is_counted=True))
    return result.but(shape=Shape(None, join(count, values), 1, inf, True))


def plain_value(value: Value) -> Any:
    """Return the constant, or the list or tuple of constants, that a value certainly is; `UNKNOWN` if it is none."""
    if value.has_constant:
        return value.constant
    shape = value.shape
    if value.kinds not in (LIST, TUPLE) or shape is None or shape.items is None:
        return UNKNOWN
    items = []
    for item in shape.items:
        # A list in a list may have changed; see `Sites.now`.
        if not item.has_constant:
            return UNKNOWN
        items.append(item.constant)
    return items if value.kinds == LIST else tuple(items)
