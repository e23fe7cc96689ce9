"""A function whose value is used, and that returns none on one of its paths.

At its end such a function returns `None`, and the alarm, or the wrong number, comes up elsewhere. Callers that
test for `None`, or only whether the value is true, are left alone, and so are functions with a `return None`.

    def job():
      def speed_of(part):        # W220: nothing is returned if part is neither 1 nor 2
        if part == 1:
          return 0.5
        elif part == 2:
          return 0.2
      movel(TARGET, v=speed_of(3))
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence

from elitescript.language.symbols import Scope
from elitescript.lint.flow import Flow
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="W220", since="0.2", needs_all_lines=True)
def missing_return(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each such function at its name."""
    flow = program.derived(Flow)
    calls = _calls_by_name(program)
    lines_of_use: dict[tuple[str, Scope | None], int] = {}
    for scope in program.symbols.scopes:
        function = scope.node
        if not isinstance(function, ast.FunctionDef) or scope.kind != "function" or function.decorator_list:
            continue
        returns = [node for node in flow.returns_of(scope) if node.value]
        if not returns or any(_is_none(node.value) for node in returns) or flow.is_generator(scope):
            continue
        if not flow.reaches_end(function.body):
            continue
        # All functions of one name in one scope have the same callers.
        key = (scope.name, None if scope.parent is None else scope.parent.home(scope.name))
        if key not in lines_of_use:
            lines_of_use[key] = _line_of_use(calls.get(key, []), program)
        used = lines_of_use[key]
        if used:
            first = min(node.lineno for node in returns)
            yield Finding(
                program.name_span(function, function.name),
                said(
                    "`{function}` returns a value in line {first}, and none at its end; line {used} uses it",
                    function=function.name,
                    first=first,
                    used=used,
                ),
                "return a value on every path, also behind the last `if` or loop",
            )


def _is_none(node: ast.AST | None) -> bool:
    return isinstance(node, ast.Constant) and node.value is None


def _calls_by_name(program: AnalysedProgram) -> dict[tuple[str, Scope | None], list[tuple[ast.Call, Scope]]]:
    """Return the calls of names, by the name and the scope whose variable it is there; None for a global."""
    calls: dict[tuple[str, Scope | None], list[tuple[ast.Call, Scope]]] = {}
    for scope in program.symbols.scopes:
        for call in scope.calls:
            if isinstance(call.func, ast.Name):
                calls.setdefault((call.func.id, scope.home(call.func.id)), []).append((call, scope))
    return calls


def _line_of_use(calls: list[tuple[ast.Call, Scope]], program: AnalysedProgram) -> int:
    """Return the first line that cannot use `None` as the value; 0 if there is none or a caller expects it."""
    lines = []
    for line, uses in _uses(calls, program):
        if any(_asks_for_none(use, program) for use in uses):
            return 0
        if not all(_takes_none(use, program) for use in uses):
            lines.append(line)
    return min(lines, default=0)


def _uses(calls: list[tuple[ast.Call, Scope]], program: AnalysedProgram) -> Iterator[tuple[int, Sequence[ast.expr]]]:
    """Yield the places at which the values of calls are looked at: the call itself, or the variable that gets it.

    Each is behind the line of its call, of the first one whose value a variable gets.
    """
    lines: dict[tuple[str, Scope | None], int] = {}
    for call, scope in calls:
        above = program.symbols.parent(call)
        if isinstance(above, (ast.Assign, ast.AnnAssign)):
            targets = above.targets if isinstance(above, ast.Assign) else [above.target]
            names = [target.id for target in targets if isinstance(target, ast.Name)]
            if len(names) == len(targets):
                for name in names:
                    variable = (name, scope.home(name))
                    lines[variable] = min(call.lineno, lines.get(variable, call.lineno))
                continue
        if not isinstance(above, ast.Expr):
            yield call.lineno, [call]
    for variable, line in lines.items():
        yield line, program.symbols.reads_of(*variable)


def _asks_for_none(use: ast.expr, program: AnalysedProgram) -> bool:
    above = program.symbols.parent(use)
    if isinstance(above, ast.Compare):
        return any(_is_none(side) for side in (above.left, *above.comparators))
    return isinstance(above, ast.Call) and isinstance(above.func, ast.Name) and above.func.id in _KIND_QUESTIONS


def _takes_none(use: ast.expr, program: AnalysedProgram) -> bool:
    """Return whether a value is only tested for truth or equality, passed on, or ignored."""
    above = program.symbols.parent(use)
    if isinstance(above, ast.Compare):
        return all(isinstance(operator, (ast.Eq, ast.NotEq, ast.Is, ast.IsNot)) for operator in above.ops)
    if isinstance(above, ast.UnaryOp):
        return isinstance(above.op, ast.Not)
    if isinstance(above, (ast.If, ast.While, ast.IfExp, ast.Assert)):
        return above.test is use
    return isinstance(above, (ast.BoolOp, ast.Return, ast.Expr, ast.Lambda))


_KIND_QUESTIONS = frozenset(("isinstance", "type", "bool"))
