"""Evaluates a program: what each expression is, in any run.

A function is evaluated statement by statement: its local variables have a state, of which branches change a copy that
is kept as a trail (what was set, and what it was before), so that a branch costs what it changes. Loops are repeated
until their state stays the same. What several functions share (`store`) is the join of all that is written, and who has
read it is evaluated again when it grows. A call joins its arguments to those of the function and gets what it returns.

Every range stops growing after a few changes, so this ends; if it takes too long nothing is known (`GivenUp`).
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence
from typing import Any, Final

from elitescript.language.nodes import children
from elitescript.language.scopes import Scope
from elitescript.values import calls
from elitescript.values.description import (
    BOTTOM,
    FUNCTION,
    LIST,
    MUTABLE,
    NOTHING,
    OBJECT,
    SOME_OBJECT,
    UNKNOWN,
    Value,
    join,
    same,
    widen,
)
from elitescript.values.expressions import Expressions
from elitescript.values.memory import Memory, Record, StartAgain, VariableKey, agree
from elitescript.values.references import ModuleType, Own, OwnClass
from elitescript.values.state import DEPTH_MAX, EVALUATIONS_MAX, LOOP_WIDENED_AFTER, LOOPS_MAX, GivenUp, Locals, Loop
from elitescript.values.store import Function, Site, SiteState


class _Heads(dict[ast.AST, Locals]):
    """Holds the states at the heads of the loops of one function; what was known before is read through."""

    def __init__(self, before: dict[ast.AST, Locals]) -> None:
        super().__init__()
        self._before = before

    def get(self, node: ast.AST, default: Any = None) -> Any:
        return super().get(node) or self._before.get(node, default)


def _by_key(state: Locals) -> dict[VariableKey, Value]:
    return {variable.key: value for variable, value in state.items()}


class Evaluation(Expressions):
    """Evaluates one program, once; see `State` for its arguments.

    Attributes:
        evaluated: the functions that were evaluated, each as often as it was.
    """

    def run(self) -> None:
        """Evaluate the program.

        Raises:
            GivenUp: nothing is known of it.
            StartAgain: it has to be evaluated without what is known of the version before.
        """
        self._mark_open_functions()
        if self._memory is not None:
            if any(scope.kind == "class" for scope in self.symbols.scopes):
                # What is known of objects belongs to one version.
                self._memory.forget()
                self._memory = None
            else:
                self._memory.begin(self._circumstances())
        self._evaluate(self._function_of(self.symbols.body))
        self._settle()
        functions = [self._function_of(scope) for scope in self.symbols.scopes if scope.kind in ("function", "lambda")]
        for function in functions:
            if function.is_open and not function.evaluations:
                self._evaluate(function)
        self._settle()
        # What nobody calls is described as well.
        for function in functions:
            if not function.evaluations:
                function.is_open = True
                self._evaluate(function)
                self._settle()
        if self._memory is not None:
            self._memory.end()
            self._memory = None

    def aside(self, node: ast.expr, scope: Scope) -> Value:
        """Return what an expression would be anywhere in a scope; for one that is not part of the text.

        Raises:
            GivenUp: it is nested too deep.
        """
        self._depth = 0
        self._function, self._scope, self._is_lazy = Function(scope), scope, True
        self._state, self._trail, self._loops, self._attempts = {}, [], [], []
        return self.expression(node)

    def _settle(self) -> None:
        while self._waiting:
            function = self._waiting.popleft()
            self._queued.discard(function)
            if function.evaluations:
                self._evaluate(function)

    def _evaluate(self, function: Function) -> None:
        """Evaluate the body of a function."""
        function.evaluations += 1
        if function.evaluations > EVALUATIONS_MAX:
            raise GivenUp
        kept = (self._function, self._scope, self._is_lazy, self._repeated)
        kept_state = (self._state, self._trail, self._loops, self._attempts)
        self._function, self._scope, self._is_lazy, self._repeated = function, function.scope, False, 0
        self._state, self._trail, self._loops, self._attempts = {}, [], [], []
        self._active.append(function)
        if self._memory is None:
            self._go_through(function)
        else:
            self._go_through_once(function, self._memory)
        self._active.pop()
        self._function, self._scope, self._is_lazy, self._repeated = kept
        self._state, self._trail, self._loops, self._attempts = kept_state

    def _go_through(self, function: Function) -> None:
        node = function.scope.node
        self.evaluated.append(function)
        for name in function.scope.parameters:
            variable = self.variable(name, function.scope)
            if variable is not None:
                self._assign(variable, self._argument(name))
        if isinstance(node, ast.Lambda):
            self._changed_result(self.expression(node.body))
        elif self.block(function.scope.statements):
            self._changed_result(NOTHING)

    def _go_through_once(self, function: Function, memory: Memory) -> None:
        """Evaluate a function, unless it was evaluated in the version before and all that it asks for is the same."""
        log, values, depth, heads = self._log, self.values, self._depth, self._heads
        base_depth = self._base_depth
        self._log = None
        situation = self._situation(function)
        record = memory.known(function.scope, function.evaluations - 1, situation)
        self._outer_values.append(values)
        if record is None or not self._played_again(record, depth):
            self._depth, self._repeated = depth, 0
            self._log, self.values, self._heads = [], {}, _Heads(self._all_heads)
            self._base_depth = depth
            self._go_through(function)
            changed = {node: _by_key(state) for node, state in self._heads.items()}
            statements = tuple(function.scope.statements) if function.scope.kind == "body" else ()
            record = Record(situation, statements, self._log, self.values, changed)
        self._outer_values.pop()
        self._all_values.update(record.values)
        for node, state in record.heads.items():
            self._all_heads[node] = {self._variable_at(key): value for key, value in state.items()}
        memory.keep(function.scope, record)
        self._log, self.values, self._depth, self._heads = log, values, depth, heads
        self._base_depth = base_depth

    def _played_again(self, record: Record, base_depth: int) -> bool:
        """Do again what an evaluation has done; return whether all that it has asked for is the same."""
        self._outer_values.append(record.values)
        is_same = True
        before: dict[Site, SiteState] = {}
        for method, arguments, depth, repeated, answer in record.log:
            self._depth, self._repeated = base_depth + depth, repeated
            if method == "_put_into":
                for site in self.sites.at(arguments[0].sites):
                    before.setdefault(site, site.state())
            if not agree(answer, getattr(self, method)(*arguments)):
                is_same = False
                break
        self._outer_values.pop()
        if not is_same:
            for site, state in before.items():
                if not site.is_for(self._function):
                    raise StartAgain
                site.restore(state)
        return is_same

    # ---------------------------------------------------------------- statements

    def block(self, statements: Sequence[ast.stmt]) -> bool:
        """Evaluate statements; return whether what stands behind them is reached."""
        is_reached = True
        for statement in statements:
            self._stop_if_outdated()
            visit = _STATEMENTS.get(type(statement))
            if visit is not None:
                if visit(self, statement) is False:
                    is_reached = False
            else:
                for child in children(statement):
                    if isinstance(child, ast.expr):
                        self.expression(child)
        return is_reached

    def _inner(self, statements: Sequence[ast.stmt]) -> bool:
        self._depth += 1
        if self._depth > DEPTH_MAX:
            raise GivenUp
        is_reached = self.block(statements)
        self._depth -= 1
        return is_reached

    def _expr(self, node: ast.Expr) -> None:
        self.expression(node.value)

    def _assignment(self, node: ast.Assign) -> None:
        value = self.expression(node.value)
        for target in node.targets:
            self._bind(target, value)

    def _annotated(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self._bind(node.target, self.expression(node.value))

    def _augmented(self, node: ast.AugAssign) -> None:
        target = node.target
        if isinstance(target, ast.Name):
            variable = self.variable(target.id, self._scope)
            old = UNKNOWN if variable is None else self._read(variable)
        else:
            old = self._subscript_value(target) if isinstance(target, ast.Subscript) else UNKNOWN
            if isinstance(target, ast.Attribute):
                self.expression(target.value)
        self.values[target] = self.values[node] = old
        operand = self.expression(node.value)
        new = self._computed(node, node.op, old, operand)
        if isinstance(node.op, ast.Add) and old.kinds & LIST:
            # The list itself grows.
            self._store(old, None, calls.element_of(self._now(operand, False)), grows=True)
            new = join(old, new) if old.kinds & ~LIST else old
        elif old.kinds & MUTABLE:
            self._escape(old)
        self._bind(target, new)

    def _delete(self, node: ast.Delete) -> None:
        for target in node.targets:
            if isinstance(target, ast.Subscript):
                owner = self.expression(target.value)
                if not isinstance(target.slice, ast.Slice):
                    self.expression(target.slice)
                self._store(owner, None, BOTTOM, grows=True)

    def _return(self, node: ast.Return) -> bool:
        value = NOTHING if node.value is None else self.expression(node.value)
        self._changed_result(value)
        return False

    def _raise(self, node: ast.Raise) -> bool:
        for child in (node.exc, node.cause):
            if child is not None:
                self._escape(self.expression(child))
        return False

    def _break(self, node: ast.Break) -> bool:
        if self._loops:
            loop = self._loops[-1]
            loop.breaks.append(self._changes(loop.mark))
        return False

    def _continue(self, node: ast.Continue) -> bool:
        if self._loops:
            loop = self._loops[-1]
            loop.continues.append(self._changes(loop.mark))
        return False

    def _if(self, node: ast.If) -> bool:
        start = len(self._trail)
        branches: list[Locals] = []
        is_reached = False
        current: ast.If = node
        while True:
            self.expression(current.test)
            mark = len(self._trail)
            self.narrow(current.test, True)
            reached = self._inner(current.body)
            # What the tests before have narrowed belongs to it.
            changed = self._changes(start)
            self._undo(mark)
            if reached:
                branches.append(changed)
                is_reached = True
            self.narrow(current.test, False)
            rest = current.orelse
            if len(rest) == 1 and isinstance(rest[0], ast.If):
                current = rest[0]
                continue
            if self._inner(rest) or False:
                branches.append(self._changes(start))
                is_reached = True
            break
        self._undo(start)
        self._merge(branches)
        return is_reached

    def _while(self, node: ast.While) -> bool:
        is_endless = isinstance(node.test, ast.Constant) and bool(node.test.value)

        def once() -> bool:
            self.expression(node.test)
            self.narrow(node.test, True)
            return self._inner(node.body)

        loop = self._repeat(node, once)
        leaving: list[Locals] = list(loop.breaks)
        if not is_endless:
            mark = len(self._trail)
            self.expression(node.test)
            self.narrow(node.test, False)
            if self._inner(node.orelse):
                leaving.append(self._changes(mark))
            self._undo(mark)
        self._merge(leaving)
        return bool(leaving)

    def _for(self, node: ast.For) -> bool:
        every = self._now(self.expression(node.iter))
        element = calls.element_of(every) if every.kinds else BOTTOM

        def once() -> bool:
            self._bind(node.target, element)
            return self._inner(node.body)

        loop = self._repeat(node, once)
        leaving: list[Locals] = list(loop.breaks)
        mark = len(self._trail)
        if self._inner(node.orelse):
            leaving.append(self._changes(mark))
        self._undo(mark)
        self._merge(leaving)
        return bool(leaving)

    def _repeat(self, node: ast.stmt, once: Callable[[], bool]) -> Loop:
        """Evaluate a loop until the state at its head stays the same, and leave that state."""
        state = self._state
        for variable, value in self._heads.get(node, {}).items():
            before = state.get(variable)
            joined = value if before is None else join(before, value)
            if joined is not before:
                self._set(variable, joined)
        head: Locals = {}
        turn = 0
        while True:
            mark = len(self._trail)
            loop = Loop(mark)
            self._loops.append(loop)
            self._repeated += 1
            is_reached = once()
            self._repeated -= 1
            self._loops.pop()
            ends = [*loop.continues]
            if is_reached:
                ends.append(self._changes(mark))
            self._undo(mark)
            turn += 1
            grown: Locals = {}
            for end in ends:
                for variable, value in end.items():
                    before = grown.get(variable, state.get(variable, BOTTOM))
                    joined = join(before, value)
                    if joined is not before and not same(joined, before):
                        grown[variable] = joined
            if not grown:
                break
            if turn > LOOPS_MAX:
                raise GivenUp
            for variable, value in grown.items():
                before = state.get(variable, BOTTOM)
                if turn > LOOP_WIDENED_AFTER:
                    value = widen(before, value)
                head[variable] = value
                self._set(variable, value)
        if head:
            self._heads[node] = {**self._heads.get(node, {}), **head}
        return loop

    def _with(self, node: ast.With) -> bool:
        # A context manager may swallow an exception of any statement in the body.
        mark = len(self._trail)
        for item in node.items:
            self.expression(item.context_expr)
            if item.optional_vars is not None:
                self._bind(item.optional_vars, UNKNOWN)
        self._attempts.append({})
        is_reached = self._inner(node.body)
        attempt = self._attempts.pop()
        self._keep_attempt(attempt)
        changed = self._changes(mark)
        self._undo(mark)
        branches = [changed] if is_reached else []
        branches.append(self._at_any_point(attempt))
        self._merge(branches)
        return True

    def _at_any_point(self, attempt: Locals) -> Locals:
        """Return what was set where an exception may have come at any point of what was tried."""
        state = self._state
        return {variable: join(state.get(variable, BOTTOM), value) for variable, value in attempt.items()}

    def _keep_attempt(self, attempt: Locals) -> None:
        if self._attempts:
            outer = self._attempts[-1]
            for variable, value in attempt.items():
                outer[variable] = join(outer.get(variable, BOTTOM), value)

    def _try(self, node: ast.Try) -> bool:
        mark = len(self._trail)
        branches: list[Locals] = []
        leavers = [(loop, len(loop.breaks), len(loop.continues)) for loop in self._loops]
        self._attempts.append({})
        is_reached = self._inner(node.body)
        thrown = dict(self._attempts[-1])
        if is_reached and self._inner(node.orelse):
            branches.append(self._changes(mark))
        self._undo(mark)
        for handler in node.handlers:
            for variable, value in self._at_any_point(thrown).items():
                self._set(variable, value)
            if handler.type is not None:
                self.expression(handler.type)
            if handler.name:
                caught = self.variable(handler.name, self._scope)
                if caught is not None:
                    self._assign(caught, SOME_OBJECT)
            if self._inner(handler.body):
                branches.append(self._changes(mark))
            self._undo(mark)
        attempt = self._attempts.pop()
        self._keep_attempt(attempt)
        if not node.finalbody:
            self._merge(branches)
            return bool(branches)
        self._merge([*branches, self._at_any_point(attempt)])
        mark = len(self._trail)
        is_passed = self._inner(node.finalbody)
        final = self._changes(mark)
        for loop, breaks, continues in leavers:
            for left in (*loop.breaks[breaks:], *loop.continues[continues:]):
                left.update({variable: join(left.get(variable, BOTTOM), value) for variable, value in final.items()})
        return is_passed and bool(branches)

    def _match(self, node: ast.Match) -> bool:
        self._escape(self.expression(node.subject))
        branches: list[Locals] = []
        mark = len(self._trail)
        for case in node.cases:
            for part in ast.walk(case.pattern):
                name = (
                    getattr(part, "rest", None) if isinstance(part, ast.MatchMapping) else getattr(part, "name", None)
                )
                if name:
                    variable = self.variable(name, self._scope)
                    if variable is not None:
                        self._assign(variable, UNKNOWN)
                if isinstance(part, (ast.MatchValue, ast.MatchClass)):
                    self.expression(part.value if isinstance(part, ast.MatchValue) else part.cls)
            if case.guard is not None:
                self.expression(case.guard)
            if self._inner(case.body):
                branches.append(self._changes(mark))
            self._undo(mark)
        branches.append({})
        self._merge(branches)
        return True

    def _definition(self, node: ast.FunctionDef) -> None:
        for default in (*node.args.defaults, *node.args.kw_defaults):
            if default is not None:
                self.expression(default)
        for decorator in node.decorator_list:
            self.expression(decorator)
        variable = self.variable(node.name, self._scope)
        made = self.symbols.scope_made_by(node)
        if variable is not None:
            is_plain = made is not None and not node.decorator_list
            refs = (Own(node),) if is_plain else None
            self._assign(variable, Value(FUNCTION, constants=(), refs=refs) if is_plain else UNKNOWN)

    def _class(self, node: ast.ClassDef) -> None:
        for part in (*node.decorator_list, *node.bases, *(keyword.value for keyword in node.keywords)):
            self._escape(self.expression(part))
        made = self.symbols.scope_made_by(node)
        variable = self.variable(node.name, self._scope)
        outer = self._scope
        if made is not None:
            self._scope = made
            self._inner(node.body)
            for name in made.bindings:
                attribute = self.variable(name, made)
                if attribute is not None:
                    # Objects and methods reach it by attributes, which are not followed.
                    self._escape(attribute.cell.value)
            self._scope = outer
        if variable is not None:
            refs = None if made is None else (OwnClass(made, False),)
            self._assign(variable, Value(FUNCTION | OBJECT, constants=(), refs=refs))

    def _import(self, node: ast.Import | ast.ImportFrom) -> None:
        for alias in node.names:
            name = alias.asname or (alias.name.partition(".")[0] if isinstance(node, ast.Import) else alias.name)
            variable = self.variable(name, self._scope)
            if variable is None:
                continue
            if isinstance(node, ast.Import):
                module = alias.name if alias.asname else name
                value = Value(OBJECT, constants=(), refs=(ModuleType(module),))
            else:
                value = self.member(ModuleType(node.module or ""), alias.name)
            self._assign(variable, value)

    def _global(self, node: ast.Global | ast.Nonlocal) -> None:
        return None

    def _assert(self, node: ast.Assert) -> None:
        self.expression(node.test)
        if node.msg is not None:
            self.expression(node.msg)
        self.narrow(node.test, True)


_STATEMENTS: Final[dict[type[ast.stmt], Callable[[Evaluation, Any], bool | None]]] = {
    ast.Expr: Evaluation._expr,
    ast.Assign: Evaluation._assignment,
    ast.AnnAssign: Evaluation._annotated,
    ast.AugAssign: Evaluation._augmented,
    ast.Delete: Evaluation._delete,
    ast.Return: Evaluation._return,
    ast.Raise: Evaluation._raise,
    ast.Break: Evaluation._break,
    ast.Continue: Evaluation._continue,
    ast.If: Evaluation._if,
    ast.While: Evaluation._while,
    ast.For: Evaluation._for,
    ast.With: Evaluation._with,
    ast.Try: Evaluation._try,
    ast.Match: Evaluation._match,
    ast.FunctionDef: Evaluation._definition,
    ast.ClassDef: Evaluation._class,
    ast.Import: Evaluation._import,
    ast.ImportFrom: Evaluation._import,
    ast.Global: Evaluation._global,
    ast.Nonlocal: Evaluation._global,
    ast.Assert: Evaluation._assert,
}
