"""A list that is changed under its other name: `b = a` does not copy a list.

Found are positions and poses, of which an element is replaced under one name, and which are then used under the other
one. The other name may be that of a variable of the enclosing program, the place in a list of points, or what the
caller of a function has passed.

    def job():
      home = get_actual_joint_positions()
      up = home
      up[1] = up[1] + 0.2                         # W263: `home` is changed too; write up = home.copy()
      movej(up)
      movej(home)
      def lifted(p):
        p = p.copy()                              # fine: without this line W263
        p[2] = p[2] + 0.1
        return p
      end
      start = get_target_tcp_pose()
      movel(lifted(start))
      movel(start)
    end
"""

from __future__ import annotations

import ast
from bisect import bisect_left, bisect_right
from collections.abc import Iterator
from math import inf

from elitescript.language.diagnostics import Edit, Fix
from elitescript.language.scopes import Scope
from elitescript.lint.list_changes import Change, ListChanges, Variable, variable_of
from elitescript.lint.placing import loops
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said
from elitescript.values.description import NUMBER
from elitescript.values.results import LIST_ROLES

_SIX = 6
_READS_MAX = 16
"""Uses of a list that are looked at behind a change."""


@rule(code="W263", since="0.3", needs_all_lines=True, needs_values=True)
def changed_alias(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the first change of each such list."""
    changes = program.derived(ListChanges)
    if not changes.all:
        return
    for node in program.nodes(ast.Assign):
        if len(node.targets) == 1:
            yield from _alias(program, node, changes)
        else:
            yield from _chain(program, node, changes)
    for call in program.nodes(ast.Call):
        if isinstance(call.func, ast.Name):
            yield from _passed(program, call, call.func, changes)


def _alias(program: AnalysedProgram, node: ast.Assign, changes: ListChanges) -> Iterator[Finding]:
    """Yield `b = a` and `b = points[0]` before a change."""
    target, value = node.targets[0], node.value
    if not isinstance(target, ast.Name) or not program.symbols.scope_of(node).has_local(target.id):
        return
    if isinstance(value, ast.Subscript) and not isinstance(value.slice, ast.Slice):
        owner = value.value
        if isinstance(owner, ast.Name) and _is_position(program, value):
            found = _changed(program, node, target, owner, changes)
            if found is not None and _goes_to_a_command(program, target, found):
                yield _finding(program, node, target, value, found)
        return
    if not isinstance(value, ast.Name) or not _is_position(program, value):
        return
    for changed, other in ((target, value), (value, target)):
        found = _changed(program, node, changed, other, changes)
        if found is not None:
            yield _finding(program, node, changed, other, found)
            return


def _finding(program: AnalysedProgram, alias: ast.Assign, changed: ast.expr, other: ast.expr, found: Change) -> Finding:
    source = ast.unparse(alias.value)
    copy = f"{ast.unparse(alias.targets[0])} = {source}.copy()"
    text = said(
        "`{changed}` and `{other}` are one list since line {line}: this changes both",
        changed=ast.unparse(changed),
        other=ast.unparse(other),
        line=alias.lineno,
    )
    edit = Edit(*program.span(alias.value), f"{source}.copy()")
    fix = Fix(said("write {copy}", copy=copy), (edit,), safe=False)
    return Finding(found.node, text, said("{copy} makes a list of its own", copy=copy), fix)


def _is_position(program: AnalysedProgram, node: ast.expr) -> bool:
    value = program.values.of(node)
    if not value.is_list:
        return False
    items = value.items
    if items is not None and len(items) == _SIX and not any(item.kinds & ~NUMBER for item in items):
        return True
    return value.role in LIST_ROLES


def _changed(
    program: AnalysedProgram, alias: ast.Assign, changed: ast.Name, other: ast.Name, changes: ListChanges
) -> Change | None:
    """Return the first change behind an alias after which the other name is read, before either gets a new value."""
    symbols = program.symbols
    scope = symbols.scope_of(alias)
    variable, another = variable_of(program, changed), variable_of(program, other)
    if variable[1] is not scope:
        return None
    stores = changes.of(variable)
    place = bisect_right(stores, alias.lineno, key=lambda change: change.node.lineno)
    if place == len(stores):
        return None
    store = stores[place]
    if another[1] is not scope:
        return store if _is_kept_outside(program, another, alias, store) else None
    until = inf
    for name in (changed.id, other.id):
        bindings = scope.bindings[name]
        renewed = bisect_right(bindings, alias.lineno, key=lambda binding: binding.line)
        if renewed < len(bindings):
            until = min(until, bindings[renewed].line)
    if store.node.lineno > until:
        return None
    reads = scope.reads.get(other.id, [])
    first = bisect_right(reads, store.node.lineno, key=lambda read: read.lineno)
    for read in reads[first : first + _READS_MAX]:
        if read.lineno <= until and not _is_gone_through_anew(program, read, alias):
            return store
    return store if store.is_relative and _is_repeated_alone(program, alias, scope, other.id) else None


def _is_gone_through_anew(program: AnalysedProgram, read: ast.Name, alias: ast.Assign) -> bool:
    """Return whether a later reading only takes another element of a list: `points[1]` behind `p = points[0]`."""
    value = alias.value
    above = program.symbols.parent(read)
    if not isinstance(value, ast.Subscript) or not isinstance(above, ast.Subscript) or above.value is not read:
        return False
    both = isinstance(value.slice, ast.Constant) and isinstance(above.slice, ast.Constant)
    return both and ast.dump(value.slice) != ast.dump(above.slice)


def _is_repeated_alone(program: AnalysedProgram, alias: ast.Assign, scope: Scope, name: str) -> bool:
    """Return whether a loop repeats an alias of a whole list that gets its value in front of the loop."""
    if not isinstance(alias.value, ast.Name) or alias.value.id != name:
        return False
    loop = next(loops(program.symbols, alias), None)
    if loop is None:
        return False
    return not any(loop.lineno <= binding.line <= (loop.end_lineno or 0) for binding in scope.bindings[name])


def _is_kept_outside(program: AnalysedProgram, variable: Variable, alias: ast.Assign, store: Change) -> bool:
    """Return whether a variable of the enclosing program has one value, and is read elsewhere too."""
    name, home = variable
    symbols = program.symbols
    bindings = symbols.global_bindings(name) if home is None else home.bindings[name]
    if len(bindings) != 1 or bindings[0].kind != "assign":
        return False
    inside = symbols.scope_of(alias)
    for read in symbols.reads_of(name, home):
        if symbols.scope_of(read) is not inside or read.lineno > store.node.lineno:
            return True
    return False


def _goes_to_a_command(program: AnalysedProgram, target: ast.Name, store: Change) -> bool:
    """Return whether a changed list itself is an argument of a command: it is more than a way into a longer list."""
    reads = program.symbols.scope_of(target).reads.get(target.id, [])
    first = bisect_right(reads, store.node.lineno, key=lambda read: read.lineno)
    for read in reads[first : first + _READS_MAX]:
        call = program.symbols.parent(read)
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name):
            command = program.command(call.func.id, program.symbols.scope_of(call))
            if command is not None and command.takes_robot:
                return True
    return False


def _chain(program: AnalysedProgram, node: ast.Assign, changes: ListChanges) -> Iterator[Finding]:
    """Yield `a = b = [...]` before a change."""
    names = [target for target in node.targets if isinstance(target, ast.Name)]
    if len(names) < len(node.targets) or not _is_position(program, node.value):
        return
    for changed in names:
        for other in names:
            found = None if changed is other else _changed(program, node, changed, other, changes)
            if found is not None:
                text = said(
                    "`{changed}` and `{other}` are one list since line {line}: this changes both",
                    changed=changed.id,
                    other=other.id,
                    line=node.lineno,
                )
                yield Finding(found.node, text, "give each name a list of its own, in a line of its own")
                return


def _passed(program: AnalysedProgram, call: ast.Call, func: ast.Name, changes: ListChanges) -> Iterator[Finding]:
    """Yield a function that changes the list that it gets, returns it, and whose caller goes on with its own."""
    symbols = program.symbols
    made = symbols.definitions(func.id, symbols.scope_of(call))
    if len(made) != 1 or call.keywords or symbols.scope_of(call) is made[0]:
        return
    function = made[0]
    for name, given in zip(function.parameters, call.args, strict=False):
        if not isinstance(given, ast.Name) or len(function.bindings[name]) != 1 or not _is_position(program, given):
            continue
        stores = changes.of((name, function))
        if not stores or not _is_result(program, name, function) or not _is_used_again(program, call, given):
            continue
        text = said(
            "`{name}` is the list `{given}` of line {line}: this changes that one too",
            name=name,
            given=given.id,
            line=call.lineno,
        )
        copy = f"{name} = {name}.copy()"
        yield Finding(stores[0].node, text, said("write {copy} in front of it", copy=copy))
        return


def _is_result(program: AnalysedProgram, name: str, function: Scope) -> bool:
    """Return whether a function returns what it got, and all its ways to the end do."""
    reads = program.symbols.reads_of(name, function)
    return any(isinstance(program.symbols.parent(read), ast.Return) for read in reads)


def _is_used_again(program: AnalysedProgram, call: ast.Call, given: ast.Name) -> bool:
    """Return whether the caller reads its list once more, and has not replaced it by the result."""
    symbols = program.symbols
    scope = symbols.scope_of(call)
    variable = variable_of(program, given)
    if variable[1] is not scope:
        return False
    above = symbols.parent(call)
    if isinstance(above, ast.Expr):
        return False
    bindings, reads = scope.bindings[given.id], scope.reads.get(given.id, [])
    renewed = bisect_left(bindings, call.lineno, key=lambda binding: binding.line)
    until = bindings[renewed].line if renewed < len(bindings) else inf
    read = bisect_right(reads, call.lineno, key=lambda read: read.lineno)
    return read < len(reads) and reads[read].lineno <= until
