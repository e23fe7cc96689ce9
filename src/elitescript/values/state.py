"""Holds the state of an evaluation: names, local variables with their trail, loops, and what is tried."""

from __future__ import annotations

import ast
import re
from collections import deque
from collections.abc import Callable, Collection, Sequence
from typing import Any, Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.language.advice.unknown_names import KNOWN
from elitescript.language.options import LINE, SCRIPT, SECONDARY
from elitescript.language.scopes import Scope
from elitescript.language.symbols import THREAD_STARTER, Symbols
from elitescript.messages.profile import DEFAULT_FIRMWARE, PROFILES, Profile
from elitescript.values.description import (
    BOTTOM,
    DICT,
    MUTABLE,
    OBJECT,
    TUPLE,
    UNKNOWN,
    Value,
    join,
    reach,
)
from elitescript.values.memory import BODY, Entry, Memory, VariableKey
from elitescript.values.references import OwnClass
from elitescript.values.signals import Signals
from elitescript.values.store import Cell, Function, Sites, Variable

EVALUATIONS_MAX: Final = 40
"""Evaluations of one function, after which the program is given up."""
LOOP_WIDENED_AFTER: Final = 2
LOOPS_MAX: Final = 30
CALL_DEPTH_MAX: Final = 6
CALLED_AT_MOST: Final = 40
"""Calls, and nesting around them, that are followed at once; deeper ones when the caller is done."""
DEPTH_MAX: Final = 100
"""Nesting of statements and expressions that is followed."""

_INTERPRETING: Final = "interpreter_mode"
"""What lets other texts assign any variable that can be seen where it is called."""
_EXECUTING: Final = ("exec", _INTERPRETING)
"""What lets other texts assign globals of the program."""
_READING: Final = ("eval", *_EXECUTING)
"""What lets other texts call functions of the program, and change its lists."""

_COMPARING: Final = frozenset(("__eq__", "__ne__", "__lt__", "__le__", "__gt__", "__ge__", "__contains__"))
"""Methods of classes that may return anything from a comparison."""

Locals = dict[Variable, Value]


class GivenUp(Exception):
    """The program is nested too deep, or takes too long."""


class Loop:
    """A loop around what is evaluated: where its trail begins, and the states of those who leave it."""

    __slots__ = ("breaks", "continues", "mark")

    def __init__(self, mark: int) -> None:
        self.mark = mark
        self.breaks: list[Locals] = []
        self.continues: list[Locals] = []


class State:
    """Holds what is known of one program while it is evaluated.

    Args:
        symbols: of its text.
        presets: names of globals that have a value before the program begins.
        stop_if_outdated: see `Values`.
        memory: what is known of the version before.
        profile: the firmware that it is for.

    Attributes:
        values: what each expression is.
    """

    def __init__(
        self,
        symbols: Symbols,
        presets: Collection[str] = (),
        stop_if_outdated: Callable[[], object] = bool,
        memory: Memory | None = None,
        profile: Profile = PROFILES[DEFAULT_FIRMWARE],
    ) -> None:
        self.symbols = symbols
        self.presets = presets
        self.profile = profile
        self._stop_if_outdated = stop_if_outdated
        self._memory = memory
        self._log: list[Entry] | None = None
        """What the function that is evaluated has asked and changed; None if that is not kept."""
        self.values: dict[ast.AST, Value] = {}
        self._outer_values: list[dict[ast.AST, Value]] = []
        """With a memory: those of all functions, and of functions of which evaluations are under way."""
        self.evaluated: list[Function] = []
        self.sites = Sites(None if memory is None else memory.numbers)
        self._functions: dict[Scope, Function] = {}
        self._variables: dict[tuple[Scope | None, str], Variable] = {}
        self._names: dict[Scope, dict[str, Variable | None]] = {}
        self._literals: dict[tuple[type, Any], Value] = {}
        """Of literals, by type and value, and of signs with the description of a literal behind them."""
        self._heads: dict[ast.AST, Locals] = {}
        self._all_values, self._all_heads = self.values, self._heads
        """Of all functions; with a memory each evaluation has its own besides."""
        self._known_meanings: dict[Function, list[Any]] = {}
        self._base_depth = 0
        """Nesting around the function that is evaluated."""
        self._builtins: dict[str, Value] = {}
        self._results: dict[ast.AST, Value] = {}
        self._waiting: deque[Function] = deque()
        self._queued: set[Function] = set()
        self._active: list[Function] = []
        self._depth = 0
        self._repeated = 0
        """Loops and comprehensions around what is evaluated."""
        self._is_lazy = False
        # Of the function that is evaluated.
        self._function = self._function_of(symbols.body)
        self._scope = symbols.body
        self._state: Locals = {}
        self._trail: list[tuple[Variable, Value | None]] = []
        self._loops: list[Loop] = []
        self._attempts: list[Locals] = []
        self.signals = Signals(symbols)
        self._has_classes = any(
            scope.kind == "class" and not _COMPARING.isdisjoint(scope.bindings) for scope in symbols.scopes
        )
        self._has_foreign_writers = self._find_foreign_writers()
        parsed = symbols.parsed
        self._is_a_part = parsed.kind == SCRIPT or bool(re.search(r"import[ \t]*\*", parsed.source.text))
        """Whether names may be defined that the text does not show."""
        self._has_interpreter = self._is_read(_INTERPRETING)
        self._has_foreign_readers = self._is_read(*_READING)

    # ---------------------------------------------------------------- what is kept of an evaluation

    def _logged(self, method: str, *arguments: Any) -> Any:
        """Do what a method does, and note that in the log."""
        log, self._log = self._log, None
        depth, repeated = self._depth, self._repeated
        answer = getattr(self, method)(*arguments)
        self._log = log
        assert log is not None
        log.append(Entry(method, arguments, depth - self._base_depth, repeated, answer))
        return answer

    def release(self) -> None:
        """Let go of what functions know of each other."""
        for function in self._functions.values():
            function.result.readers.clear()

    def _circumstances(self) -> Any:
        """Return what all evaluations of the program depend on, besides its functions."""
        return (
            frozenset(self.presets),
            self.profile.name,
            self._has_foreign_writers,
            self._is_a_part,
            self._has_interpreter,
            self._has_foreign_readers,
            self.signals.kinds,
        )

    def _situation(self, function: Function) -> Any:
        """Return what an evaluation of a function depends on, besides its text and what it asks for."""
        # Nesting matters where it comes near to what is followed.
        return function.is_open, max(0, self._depth - CALLED_AT_MOST // 2), self._meanings(function)

    def _meanings(self, function: Function) -> list[Any]:
        """Return what the names of a function mean."""
        found = self._known_meanings.get(function)
        if found is None:
            found = self._known_meanings[function] = []
            scopes = [function.scope]
            for scope in scopes:
                for name in (*scope.reads, *scope.bindings):
                    variable = self.variable(name, scope)
                    found.append(None if variable is None else (variable.key, variable.is_shared))
                scopes += [inner for inner in scope.children if inner.kind == "comprehension"]
        return found

    def _function_at(self, node: ast.AST) -> Function:
        scope = self.symbols.scope_made_by(node)
        assert scope is not None
        return self._function_of(scope)

    def _variable_at(self, key: VariableKey) -> Variable:
        home, name = key
        scope = self.symbols.body if home is BODY else self.symbols.scope_made_by(home) if home else None
        variable = self._variables.get((scope, name)) or self._new_variable(scope, name)
        assert isinstance(variable, Variable)
        return variable

    def _noted(self, node: ast.AST) -> Value:
        """Return what was noted of an expression, of any function."""
        found = self.values.get(node)
        for values in reversed(self._outer_values):
            if found is not None:
                break
            found = values.get(node)
        return UNKNOWN if found is None else found

    def _changed(self, readers: Collection[Function]) -> None:
        for reader in readers:
            if reader not in self._queued:
                self._queued.add(reader)
                self._waiting.append(reader)

    # ---------------------------------------------------------------- names

    def _find_foreign_writers(self) -> bool:
        """Return whether other texts may assign globals of the program."""
        if self.symbols.parsed.kind in (SECONDARY, LINE):
            return True
        return self._is_read(*_EXECUTING)

    def _is_read(self, *names: str) -> bool:
        """Return whether the program uses one of some names."""
        return any(name in scope.reads for scope in self.symbols.scopes for name in names)

    def _is_missing(self, name: str) -> bool:
        """Return whether nothing at all is called so, here or outside the program."""
        if self._has_foreign_writers or self._is_a_part or name in self.presets or name in KNOWN:
            return False
        return CATALOGUE.get(name) is None and self.variable(name, self._scope) is None

    def _function_of(self, scope: Scope) -> Function:
        found = self._functions.get(scope)
        if found is None:
            found = self._functions[scope] = Function(scope)
        return found

    def owner(self, scope: Scope) -> Function:
        """Return the function whose code a scope is part of."""
        while scope.kind in ("comprehension", "class") and scope.parent is not None:
            scope = scope.parent
        return self._function_of(scope)

    def variable(self, name: str, scope: Scope) -> Variable | None:
        """Return the variable that a name is in a scope; None for what the program does not bind."""
        names = self._names.get(scope)
        if names is None:
            names = self._names[scope] = {}
        if name in names:
            return names[name]
        home = scope.home(name)
        found: Variable | None
        if home is None and name not in self.symbols.global_names:
            found = None
        else:
            found = self._variables.get((home, name)) or self._new_variable(home, name)
        names[name] = found
        return found

    def _new_variable(self, home: Scope | None, name: str) -> Variable:
        if home is None:
            variable = Variable(name, (None, name), None, True)
            is_foreign = self._has_foreign_writers or name in self.presets
            if is_foreign or not self.symbols.global_bindings(name):
                variable.cell.add(UNKNOWN)
        else:
            owner = self.owner(home)
            is_shared = self._has_interpreter or self.symbols.is_nonlocal_inside(name, home)
            node = BODY if home.kind == "body" else home.node
            variable = Variable(name, (node, name), owner, is_shared)
            if self._has_interpreter:
                variable.cell.add(UNKNOWN)
        self._variables[home, name] = variable
        return variable

    def _mark_open_functions(self) -> None:
        """Mark the functions whose callers are not all known."""
        symbols = self.symbols
        for scope in symbols.scopes:
            if scope.kind == "lambda":
                self._function_of(scope).is_open = True
            if scope.kind != "function" or not isinstance(scope.node, ast.FunctionDef):
                continue
            function, node, outer = self._function_of(scope), scope.node, scope.parent
            if outer is None:
                continue
            if outer.kind == "class" or node.decorator_list or self._has_foreign_readers:
                function.is_open = True
                continue
            reads = symbols.reads_of(node.name, outer.home(node.name))
            function.is_open = not all(self._is_followed(read) for read in reads)

    def _is_followed(self, read: ast.Name) -> bool:
        """Return whether a use of a function calls it, or starts it as a thread."""
        above = self.symbols.parent(read)
        if isinstance(above, ast.Call):
            if above.func is read:
                return True
            is_start = isinstance(above.func, ast.Name) and above.func.id == THREAD_STARTER
            return is_start and bool(above.args) and above.args[0] is read
        return isinstance(above, ast.Compare)

    # ---------------------------------------------------------------- functions

    def _argument(self, name: str) -> Value:
        """Return what a parameter of the function can be."""
        if self._log is not None:
            return self._logged("_argument", name)  # type: ignore[no-any-return]
        function = self._function
        arguments = function.arguments
        if arguments is not None:
            if arguments.vararg is not None and arguments.vararg.arg == name:
                return Value(TUPLE, constants=())
            if arguments.kwarg is not None and arguments.kwarg.arg == name:
                return Value(DICT, constants=())
        outer = function.scope.parent
        is_first = next(iter(function.scope.parameters), None) == name
        if outer is not None and outer.kind == "class" and is_first:
            return Value(OBJECT, constants=(), refs=(OwnClass(outer, True),))
        if function.is_open:
            return UNKNOWN
        cell = function.parameters.get(name)
        if cell is None:
            cell = function.parameters[name] = Cell()
        return cell.value

    def _changed_result(self, value: Value) -> None:
        """Note that the function returns a value."""
        if self._log is not None:
            self._logged("_changed_result", value)
            return
        function = self._function
        if function.is_open and (value.sites or value.shape is not None):
            self._escape(value)
        if function.result.add(value):
            self._changed(function.result.readers)

    # ---------------------------------------------------------------- state

    def _assign(self, variable: Variable, value: Value) -> None:
        if self._log is None:
            self._put(variable, value)
        else:
            self._logged("_put_at", variable.key, value)
        if variable.owner is self._function and not variable.is_shared:
            self._set(variable, value)
            if self._attempts:
                attempt = self._attempts[-1]
                attempt[variable] = join(attempt.get(variable, BOTTOM), value)

    def _put(self, variable: Variable, value: Value) -> None:
        """Note that a variable gets a value, for all that may read it."""
        if self._has_foreign_readers:
            self._escape(value)
        cell = variable.cell
        if cell.value is not value and cell.add(value) and cell.readers:
            self._changed(cell.readers)

    def _put_at(self, key: VariableKey, value: Value) -> None:
        self._put(self._variable_at(key), value)

    def _set(self, variable: Variable, value: Value) -> None:
        state = self._state
        self._trail.append((variable, state.get(variable)))
        state[variable] = value

    def _changes(self, mark: int) -> Locals:
        """Return what was set since a mark of the trail."""
        state = self._state
        return {variable: state[variable] for variable, _ in self._trail[mark:]}

    def _undo(self, mark: int) -> None:
        """Take back what was set since a mark of the trail."""
        trail, state = self._trail, self._state
        while len(trail) > mark:
            variable, old = trail.pop()
            if old is None:
                del state[variable]
            else:
                state[variable] = old

    def _merge(self, branches: Sequence[Locals]) -> None:
        """Go on with the join of what branches have set; the state is that before them."""
        if not branches:
            return
        if len(branches) == 1:
            for variable, value in branches[0].items():
                self._set(variable, value)
            return
        state = self._state
        for variable in {variable: None for branch in branches for variable in branch}:
            before = state.get(variable, BOTTOM)
            joined = BOTTOM
            for branch in branches:
                joined = join(joined, branch.get(variable, before))
            if joined is not before:
                self._set(variable, joined)

    def _read(self, variable: Variable) -> Value:
        if variable.owner is self._function and not variable.is_shared and not self._is_lazy:
            value = self._state.get(variable)
            if value is not None:
                return value
        if self._log is not None:
            return self._logged("_shared_at", variable.key)  # type: ignore[no-any-return]
        cell = variable.cell
        cell.readers[self._function] = None
        return cell.value

    def _shared_at(self, key: VariableKey) -> Value:
        cell = self._variable_at(key).cell
        cell.readers[self._function] = None
        return cell.value

    def _now(self, value: Value, is_reader: bool = True) -> Value:
        """Return the description of a list with what is put in later; see `Sites.now`."""
        if not value.sites or value.shape is None:
            return value
        if self._log is not None:
            return self._logged("_now", value, is_reader)  # type: ignore[no-any-return]
        return self.sites.now(value, self._function if is_reader else None)

    def _are_unchanged(self, value: Value) -> bool:
        if self._log is not None:
            return self._logged("_are_unchanged", value)  # type: ignore[no-any-return]
        return self.sites.are_unchanged(value)

    def _site(self, node: ast.AST) -> frozenset[int]:
        """Return the place that makes a list or dict here."""
        if self._log is not None:
            return self._logged("_site", node)  # type: ignore[no-any-return]
        return self.sites.made_by(node, None if self._repeated else self._function)

    def _escape(self, value: Value) -> None:
        """Note that unknown code gets a value, and may change the lists in it."""
        if value.sites or value.shape is not None:
            if self._log is not None:
                self._logged("_escape", value)
                return
            sites = reach(value)
            if sites:
                self._changed(self.sites.open(sites))

    # ---------------------------------------------------------------- what others do

    def expression(self, node: ast.expr) -> Value:
        """Return what an expression is, and note it."""
        raise NotImplementedError

    def _evaluate(self, function: Function) -> None:
        """Evaluate the body of a function."""
        raise NotImplementedError

    def _store(self, owner: Value, index: int | None, value: Value, *, grows: bool) -> None:
        """Note that something is put into a list or dict."""
        if not owner.kinds & MUTABLE:
            return
        if self._log is None:
            self._put_into(owner, index, value, grows)
        else:
            self._logged("_put_into", owner, index, value, grows)

    def _put_into(self, owner: Value, index: int | None, value: Value, grows: bool) -> None:
        if owner.kinds & OBJECT or owner.shape is None:
            self._escape(value)
        for site in self.sites.at(owner.sites):
            site.is_shared = site.is_shared or site.maker is not self._function
        readers = self.sites.store(owner, index, value, grows=grows)
        # What was read of a new list before it is changed has been right, unless it all comes again.
        is_new = all(site.maker is self._function for site in self.sites.at(owner.sites))
        if is_new and not self._repeated:
            readers.pop(self._function, None)
        if readers:
            self._changed(readers)
