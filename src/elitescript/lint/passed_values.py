"""Finds what certainly reaches a command: elements of a list that is gone through, arguments of a program's functions.

A command in a loop over `[["a", 5], ["b", 70000]]`, or in a function that is called with 5 and with 70000, gets both,
if no condition stands between. `PassedValues` lists such calls once more for each turn and caller, with the expressions
of the list or of the caller in place of the variables: rules judge them as they judge what is written at the command,
and a finding stands where the value is written.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from typing import TYPE_CHECKING, Any, Final, Protocol

from elitescript.language.nodes import children
from elitescript.language.scopes import Scope
from elitescript.language.symbols import THREAD_STARTER, Symbols
from elitescript.lint.placing import conditions
from elitescript.records import NamedTuple

if TYPE_CHECKING:
    from elitescript.commands.definition.registry import Command
    from elitescript.values.program import Values

_TURNS_MAX: Final = 16
"""Elements of a list that are looked at one by one; a longer one is left alone."""
_CALLERS_MAX: Final = 16
_CALLS_MAX: Final = 400
"""Calls that are listed for one program."""
_DEPTH_MAX: Final = 3
"""Functions and loops around a command that are followed."""
_LEAVING: Final = (ast.Break, ast.Continue, ast.Return, ast.Raise, ast.Assert)
_ENDING: Final = frozenset(("halt", "exit", "quit"))


class Program(Protocol):
    """Describes what is asked of a program, an `AnalysedProgram`."""

    symbols: Symbols

    @property
    def values(self) -> Values: ...

    def command(self, name: str, scope: Scope) -> Command | None: ...

    def is_available(self, command: Command) -> bool: ...


Variable = tuple[str, Scope]
Given = Mapping[Variable, ast.expr]
"""What variables are in one turn of a loop, or for one caller, as expressions of the text."""


class PassedCall(NamedTuple):
    """A call of a command with what one turn or caller gives it.

    Attributes:
        command: the command.
        call: the call, with other arguments.
        scope: where it stands.
        written: the call as it is written.
    """

    command: Command
    call: ast.Call
    scope: Scope
    written: ast.Call


class PassedValues:
    """The calls of one program once more, for each turn and caller.

    Args:
        program: the program.

    Attributes:
        calls: the calls.
        origins: the call that is written, by each expression that stands in its place in another one.
    """

    __slots__ = ("_not_reached", "_program", "calls", "origins")

    def __init__(self, program: Program) -> None:
        self._program = program
        self._not_reached: dict[ast.AST, frozenset[ast.AST]] = {}
        self.calls: list[PassedCall] = []
        self.origins: dict[ast.AST, ast.Call] = {}
        for scope in program.symbols.scopes:
            for call in scope.calls:
                func = call.func
                if not isinstance(func, ast.Name) or not (call.args or call.keywords):
                    continue
                if self._has_variables(call, scope):
                    self._add(call, func, scope)
                if scope.home(func.id) is not None:
                    self._add_named(call, func, scope)

    def _has_variables(self, call: ast.Call, scope: Scope) -> bool:
        """Return whether a call may have an argument of a turn or caller, or is one of a command that is passed."""
        parts = [call.func, *call.args, *(keyword.value for keyword in call.keywords)]
        return any(self._is_variable(name, scope) for part in parts for name in _names(part))

    def _is_variable(self, node: ast.Name, scope: Scope) -> bool:
        home = scope.home(node.id)
        if home is None or home is not scope:
            return False
        bindings = home.bindings[node.id]
        return len(bindings) == 1 and bindings[0].kind in ("for", "parameter")

    def _add_named(self, call: ast.Call, func: ast.Name, scope: Scope) -> None:
        """Add a call of a variable that is a command in any case: `send = socket_send_line`."""
        bindings = self._program.symbols.bindings(func.id, scope)
        if any(binding.kind != "assign" for binding in bindings):
            return
        from elitescript.values.references import Name

        refs = self._program.values.of(func).refs
        if refs is not None and len(refs) == 1 and isinstance(refs[0], Name):
            command = self._program.command(refs[0].name, self._program.symbols.body)
            if command is not None and self._program.is_available(command):
                self.calls.append(PassedCall(command, call, scope, call))

    def _add(self, call: ast.Call, func: ast.Name, scope: Scope) -> None:
        for given in self._given(call, _DEPTH_MAX, ()):
            if len(self.calls) >= _CALLS_MAX:
                return
            name = self._put(func, scope, given)
            command = None
            if isinstance(name, ast.Name):
                command = self._program.command(name.id, self._program.symbols.scope_of(name))
            if command is None or not self._program.is_available(command):
                continue
            args = [self._put(part, scope, given) for part in call.args]
            keywords = [
                ast.copy_location(ast.keyword(keyword.arg, self._put(keyword.value, scope, given)), keyword)
                for keyword in call.keywords
            ]
            old = (*call.args, *(keyword.value for keyword in call.keywords))
            new = (*args, *(keyword.value for keyword in keywords))
            changed = [node for node, before in zip(new, old, strict=True) if node is not before]
            if changed or name is not func:
                made = ast.copy_location(ast.Call(func, args, keywords), call)
                self.calls.append(PassedCall(command, made, scope, call))
                for node in changed or new:
                    for part in ast.walk(node):
                        self.origins.setdefault(part, call)

    # What variables are

    def _given(self, node: ast.AST, depth: int, active: tuple[ast.AST, ...]) -> Iterator[Given]:
        """Yield what the variables of loops and callers around a node are, for each turn and caller."""
        symbols = self._program.symbols
        conditional = {above for above, _ in conditions(symbols, node) if not _is_run(above)}
        found: list[dict[Variable, ast.expr]] = [{}]
        child = node
        for above in symbols.ancestors(node):
            if above in conditional or child in self._unsure(above):
                break
            if isinstance(above, ast.For) and child in above.body:
                turns = self._turns(above)
                if turns:
                    found = [dict(given) | dict(turn) for given in found for turn in turns][: _TURNS_MAX * 2]
            elif isinstance(above, ast.FunctionDef):
                if above not in active and depth > 0:
                    callers = list(self._callers(above, depth - 1, (*active, above)))
                    if callers:
                        found = [dict(given) | dict(caller) for given in found for caller in callers][: _TURNS_MAX * 2]
                break
            elif isinstance(above, (ast.Lambda, ast.ClassDef, ast.comprehension)):
                break
            child = above
        yield from (given for given in found if given)

    def _turns(self, loop: ast.For) -> Sequence[Given]:
        """Return what the variables of a loop are in each of its turns; nothing if that is not known."""
        elements = self._elements(loop.iter)
        scope = self._program.symbols.scope_of(loop)
        turns: list[Given] = []
        for element in elements if len(elements) <= _TURNS_MAX else ():
            given = self._bound(loop.target, element, scope)
            if given is None:
                return []
            turns.append(given)
        return turns

    def _elements(self, node: ast.expr) -> list[ast.expr]:
        """Return the elements of a list that is written out, here or where its only variable gets it."""
        written = node
        scope = self._program.symbols.scope_of(node)
        if isinstance(node, ast.Name):
            home = scope.home(node.id)
            bindings = [] if home is None else home.bindings[node.id]
            above = self._program.symbols.parent(bindings[0].node) if len(bindings) == 1 else None
            if not isinstance(above, ast.Assign) or above.targets != [bindings[0].node]:
                return []
            written = above.value
        if not isinstance(written, (ast.List, ast.Tuple)) or any(
            isinstance(part, ast.Starred) for part in written.elts
        ):
            return []
        if written is not node:
            # It must still be what is written there.
            now = self._program.values.of(node).items
            made = self._program.values.of(written).items
            if now is None or made is None or len(now) != len(written.elts) or now != made:
                return []
        return written.elts

    def _bound(self, target: ast.expr, element: ast.expr, scope: Scope) -> dict[Variable, ast.expr] | None:
        """Return what the names of a target are if it gets an element; None if that is not known."""
        if isinstance(target, ast.Name):
            home = scope.home(target.id)
            if home is None or len(home.bindings[target.id]) != 1:
                return {}
            return {(target.id, home): element}
        if isinstance(target, (ast.Tuple, ast.List)) and isinstance(element, (ast.Tuple, ast.List)):
            if len(target.elts) != len(element.elts):
                return None
            found: dict[Variable, ast.expr] = {}
            for part, value in zip(target.elts, element.elts, strict=True):
                bound = self._bound(part, value, scope)
                if bound is None:
                    return None
                found |= bound
            return found
        return None

    def _callers(self, function: ast.FunctionDef, depth: int, active: tuple[ast.AST, ...]) -> Iterator[Given]:
        """Yield what the parameters of a function are, for each of its callers."""
        symbols = self._program.symbols
        scope = symbols.scope_made_by(function)
        arguments = function.args
        if scope is None or scope.parent is None or function.decorator_list or arguments.vararg or arguments.kwarg:
            return
        reads = symbols.reads_of(function.name, scope.parent.home(function.name))
        if len(symbols.bindings(function.name, scope.parent)) != 1 or len(reads) > _CALLERS_MAX:
            return
        names = [argument.arg for argument in (*arguments.posonlyargs, *arguments.args)]
        for read in reads:
            call = symbols.parent(read)
            if not isinstance(call, ast.Call):
                continue
            by_position, keywords = self._passed(call, read)
            given: dict[Variable, ast.expr] = {}
            for name, value in (*zip(names, by_position, strict=False), *keywords.items()):
                if name in scope.parameters and len(scope.bindings[name]) == 1 and not isinstance(value, ast.Starred):
                    given[name, scope] = value
            if any(isinstance(value, ast.Starred) for value in by_position):
                continue
            outer = list(self._given(call, depth, active)) if depth else []
            where = symbols.scope_of(call)
            for around in outer or [{}]:
                yield {variable: self._put(value, where, around) for variable, value in given.items()}

    def _passed(self, call: ast.Call, read: ast.Name) -> tuple[list[ast.expr], dict[str, ast.expr]]:
        """Return what a call, or the start of a thread, passes to a function by position and by name."""
        if call.func is read:
            return call.args, {keyword.arg: keyword.value for keyword in call.keywords if keyword.arg is not None}
        is_start = isinstance(call.func, ast.Name) and call.func.id == THREAD_STARTER and call.args[:1] == [read]
        if is_start and len(call.args) > 1 and isinstance(call.args[1], (ast.Tuple, ast.List)):
            return call.args[1].elts, {}
        return [], {}

    def _unsure(self, node: ast.AST) -> frozenset[ast.AST]:
        """Return the statements in the blocks of a node that one in front of them may keep from being reached."""
        found = self._not_reached.get(node)
        if found is None:
            unsure: list[ast.AST] = []
            for name in ("body", "orelse", "finalbody"):
                block = getattr(node, name, None)
                if isinstance(block, list):
                    leaving = next((at for at, statement in enumerate(block) if _leaves(statement)), len(block))
                    unsure += block[leaving + 1 :]
            found = self._not_reached[node] = frozenset(unsure)
        return found

    # What expressions are then

    def _put(self, node: ast.expr, scope: Scope, given: Given) -> ast.expr:
        """Return an expression with the values of variables in their place; the expression if nothing changes."""
        if isinstance(node, ast.Name):
            home = scope.home(node.id)
            return node if home is None else given.get((node.id, home), node)
        if isinstance(node, ast.Subscript):
            owner = self._put(node.value, scope, given)
            index = node.slice
            if owner is not node.value and isinstance(owner, (ast.List, ast.Tuple)) and isinstance(index, ast.Constant):
                place = index.value
                if isinstance(place, int) and -len(owner.elts) <= place < len(owner.elts):
                    return owner.elts[place]
            return node
        if not isinstance(node, (ast.List, ast.Tuple, ast.BinOp, ast.UnaryOp)):
            return node
        changes: dict[str, Any] = {}
        for name, value in ast.iter_fields(node):
            if isinstance(value, ast.expr):
                changes[name] = self._literal(self._put(value, scope, given), value)
            elif isinstance(value, list):
                changes[name] = [self._literal(self._put(part, scope, given), part) for part in value]
        if all(changes[name] == getattr(node, name) for name in changes):
            return node
        made = copy(node)
        for name, value in changes.items():
            setattr(made, name, value)
        self._program.values.evaluated(made, scope)
        return made

    def _literal(self, node: ast.expr, written: ast.expr) -> ast.expr:
        """Return what stands in place of a part of an expression: a literal, which is the same in every scope."""
        if node is written or all(isinstance(part, _CLOSED) for part in ast.walk(node)):
            return node
        return written


_CLOSED: Final = (ast.Constant, ast.UnaryOp, ast.USub, ast.UAdd, ast.List, ast.Tuple, ast.Load)


def _names(node: ast.AST) -> Iterator[ast.Name]:
    stack = [node]
    while stack:
        part = stack.pop()
        if isinstance(part, ast.Name):
            yield part
        elif not isinstance(part, ast.Lambda):
            stack += children(part)


def _is_run(node: ast.AST) -> bool:
    """Return whether the body of a statement is run at least once, or for each element."""
    if isinstance(node, ast.While):
        return isinstance(node.test, ast.Constant) and bool(node.test.value)
    return isinstance(node, ast.For)


def _leaves(statement: ast.stmt) -> bool:
    stack: list[ast.AST] = [statement]
    while stack:
        node = stack.pop()
        if isinstance(node, _LEAVING):
            return True
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in _ENDING:
            return True
        if not isinstance(node, (ast.FunctionDef, ast.Lambda, ast.ClassDef)):
            stack += children(node)
    return False
