"""A list that is changed under its other name: `b = a` does not copy a list.

Found are positions and poses, of which an element is replaced under one name, and which are then used under the other
one.

    def job():
      home = get_actual_joint_positions()
      up = home
      up[1] = up[1] + 0.2                         # W263: `home` is changed too; write up = home.copy()
      movej(up)
      movej(home)
    end
"""

from __future__ import annotations

import ast
from bisect import bisect_right
from collections.abc import Iterator
from math import inf

from elitescript.language.diagnostics import Edit, Fix
from elitescript.language.scopes import Scope
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said
from elitescript.values.description import NUMBER
from elitescript.values.results import LIST_ROLES

_SIX = 6


@rule(code="W263", since="0.3", needs_all_lines=True, needs_values=True)
def changed_alias(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the first change of each such list."""
    symbols = program.symbols
    stores: dict[tuple[str, Scope | None], list[ast.Subscript]] | None = None
    for node in program.nodes(ast.Assign):
        target, value = node.targets[0], node.value
        if len(node.targets) != 1 or not isinstance(target, ast.Name) or not isinstance(value, ast.Name):
            continue
        scope = symbols.scope_of(node)
        if not scope.has_local(target.id) or not scope.has_local(value.id) or not _is_position(program, value):
            continue
        if stores is None:
            stores = _stores(program)
        for changed, other in ((target.id, value.id), (value.id, target.id)):
            found = _changed(scope, node, changed, other, stores.get((changed, scope), []))
            if found is not None:
                copy = f"{target.id} = {value.id}.copy()"
                text = said(
                    "`{changed}` and `{other}` are one list since line {line}: this changes both",
                    changed=changed,
                    other=other,
                    line=node.lineno,
                )
                fix = Fix(
                    said("write {copy}", copy=copy), (Edit(*program.span(value), f"{value.id}.copy()"),), safe=False
                )
                yield Finding(found, text, said("{copy} makes a list of its own", copy=copy), fix)
                break


def _is_position(program: AnalysedProgram, node: ast.Name) -> bool:
    value = program.values.of(node)
    if not value.is_list:
        return False
    items = value.items
    if items is not None and len(items) == _SIX and not any(item.kinds & ~NUMBER for item in items):
        return True
    return value.role in LIST_ROLES


def _stores(program: AnalysedProgram) -> dict[tuple[str, Scope | None], list[ast.Subscript]]:
    """Return where elements are replaced, by the variable of the list."""
    found: dict[tuple[str, Scope | None], list[ast.Subscript]] = {}
    for node in program.nodes(ast.Subscript):
        if isinstance(node.ctx, ast.Store) and isinstance(node.value, ast.Name):
            home = program.symbols.scope_of(node).home(node.value.id)
            found.setdefault((node.value.id, home), []).append(node)
    for nodes in found.values():
        nodes.sort(key=_line)
    return found


def _line(node: ast.expr) -> int:
    return node.lineno


def _changed(
    scope: Scope, alias: ast.Assign, changed: str, other: str, stores: list[ast.Subscript]
) -> ast.Subscript | None:
    """Return the first change behind an alias whose other name is read after it, before either is given a new value."""
    place = bisect_right(stores, alias.lineno, key=_line)
    if place == len(stores):
        return None
    store = stores[place]
    until = inf
    for name in (changed, other):
        bindings = scope.bindings[name]
        renewed = bisect_right(bindings, alias.lineno, key=lambda binding: binding.line)
        if renewed < len(bindings):
            until = min(until, bindings[renewed].line)
    reads = scope.reads.get(other, [])
    read = bisect_right(reads, store.lineno, key=_line)
    is_read = read < len(reads) and reads[read].lineno <= until
    return store if store.lineno < until and is_read else None
