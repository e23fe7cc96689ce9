"""One list that stands in several places, and is changed in one of them: it changes in all.

`[[0] * 3] * 2` has one row twice, a list that is appended in each turn of a loop is the same one each time, and the
default of a parameter is made once for all calls.

    def job():
      grid = [[0] * 3] * 2
      grid[0][1] = 5                              # W224: in each row; [[0] * 3 for _ in range(2)]
      p = get_target_tcp_pose()
      points = []
      for i in range(3):
        p[0] = p[0] + 0.05
        points.append(p)                          # W224: points.append(p.copy())
      end
    end
"""

from __future__ import annotations

import ast
from bisect import bisect_left
from collections.abc import Iterator

from elitescript.language.diagnostics import Edit, Fix
from elitescript.lint.list_changes import Change, ListChanges, variable_of
from elitescript.lint.placing import loops
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule, shown_source
from elitescript.said import said
from elitescript.values.description import INT


@rule(code="W224", since="0.3", needs_all_lines=True, needs_values=True)
def list_in_several_places(program: AnalysedProgram) -> Iterator[Finding]:
    """Report rows that are one list, one list that a loop adds again and again, and defaults that are changed."""
    changes = program.derived(ListChanges)
    if not changes.all:
        return
    yield from _repeated(program, changes)
    for change in changes.all:
        yield from _added_again(program, change, changes)
    for function in program.nodes(ast.FunctionDef):
        yield from _default(program, function, changes)


def _repeated(program: AnalysedProgram, changes: ListChanges) -> Iterator[Finding]:
    """Yield changes of rows of `[row] * n`."""
    for product in program.nodes(ast.BinOp):
        if not isinstance(product.op, ast.Mult):
            continue
        rows, number = product.left, product.right
        if isinstance(number, ast.List):
            rows, number = number, rows
        if not isinstance(rows, ast.List) or len(rows.elts) != 1:
            continue
        row = rows.elts[0]
        count = program.values.of(number)
        value = program.values.of(row)
        sites = value.sites
        if not value.is_list or count.kinds != INT or count.high < 2 or len(sites) != 1 or -1 in sites:
            continue
        for change in changes.by_site.get(sites, ()):
            if _is_of_a_row(program, change) and change.node.lineno > product.lineno:
                text = said(
                    "{expression} of line {line} has one list several times: this changes each of them",
                    expression=shown_source(program, product),
                    line=product.lineno,
                )
                written = ast.unparse(row)
                made = f"{written}.copy()" if isinstance(row, ast.Name) else written
                yield Finding(
                    change.node,
                    text,
                    said("write [{row} for _ in range({number})]", row=made, number=ast.unparse(number)),
                )
                break


def _is_of_a_row(program: AnalysedProgram, change: Change) -> bool:
    """Return whether a change reaches a row through the longer list, or in a loop over it."""
    if isinstance(change.list, ast.Subscript):
        return True
    if not isinstance(change.list, ast.Name):
        return False
    name, home = variable_of(program, change.list)
    bindings = [] if home is None else home.bindings[name]
    return len(bindings) == 1 and bindings[0].kind == "for"


def _added_again(program: AnalysedProgram, change: Change, changes: ListChanges) -> Iterator[Finding]:
    """Yield `points.append(p)` in a loop that changes `p`, which gets its value in front of the loop."""
    call = change.node
    if not isinstance(call, ast.Call) or not isinstance(call.func, ast.Attribute):
        return
    if call.func.attr not in ("append", "insert") or not call.args or not isinstance(call.args[-1], ast.Name):
        return
    symbols = program.symbols
    added = call.args[-1]
    name, home = variable_of(program, added)
    loop = next(loops(symbols, call), None)
    if loop is None or home is None or home is not symbols.scope_of(call) or not program.values.of(added).is_list:
        return
    first, last = loop.lineno, loop.end_lineno or loop.lineno
    if any(first <= binding.line <= last for binding in home.bindings[name]):
        return
    stores = changes.of((name, home))
    at = bisect_left(stores, first, key=lambda found: found.node.lineno)
    if at == len(stores) or stores[at].node.lineno > last or _is_left(program, call):
        return
    text = said(
        "each turn adds `{name}` itself, one list, and line {line} changes it", name=name, line=stores[at].node.lineno
    )
    copy = f"{ast.unparse(call.func)}({name}.copy())"
    edit = Edit(*program.span(added), f"{name}.copy()")
    yield Finding(
        call, text, said("write {copy}", copy=copy), Fix(said("write {copy}", copy=copy), (edit,), safe=False)
    )


def _is_left(program: AnalysedProgram, call: ast.Call) -> bool:
    """Return whether the loop is left behind a call, in the same block."""
    statement = program.symbols.parent(call)
    if not isinstance(statement, ast.Expr):
        return False
    _, block, place = program.symbols.block_of(statement)
    return any(isinstance(later, (ast.Break, ast.Return)) for later in block[place + 1 :])


def _default(program: AnalysedProgram, function: ast.FunctionDef, changes: ListChanges) -> Iterator[Finding]:
    """Yield the change of a list that is the default of a parameter."""
    arguments = function.args
    positional = [*arguments.posonlyargs, *arguments.args]
    pairs = list(zip(reversed(positional), reversed(arguments.defaults), strict=False))
    pairs += [
        (argument, node) for argument, node in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True) if node
    ]
    scope = program.symbols.scope_made_by(function)
    for argument, default in pairs:
        if scope is None or not isinstance(default, ast.List) or len(scope.bindings[argument.arg]) != 1:
            continue
        found = changes.of((argument.arg, scope))
        if found:
            text = said(
                "the default of `{name}` is one list for all calls: what this changes stays changed", name=argument.arg
            )
            hint = said("write {name}=None, and make the list in the function", name=argument.arg)
            yield Finding(found[0].node, text, hint)
