"""The result of a call that gives none: the variable is None.

`append`, `sort` and their like change their list and return nothing.

    def job():
      parts = [3, 1, 2]
      parts = parts.sort()                        # W277: parts.sort() alone on its line
      kept = sorted([3, 1, 2])                    # fine: a new list
      textmsg(parts, kept)
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.lint.list_changes import CHANGING
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule, shown_source
from elitescript.said import said
from elitescript.values.description import NONE


@rule(code="W277", since="0.3", needs_values=True)
def no_result(program: AnalysedProgram) -> Iterator[Finding]:
    """Report variables that get the result of such a method or command, and are used."""
    for node in program.nodes(ast.Assign):
        target, call = node.targets[0], node.value
        if len(node.targets) != 1 or not isinstance(target, ast.Name) or not isinstance(call, ast.Call):
            continue
        if not _gives_nothing(program, call) or not _is_used(program, target):
            continue
        text = said("{call} gives no value: `{name}` is None", call=shown_source(program, call), name=target.id)
        name = call.func.attr if isinstance(call.func, ast.Attribute) else ""
        hint = said("write {call} alone on its line", call=ast.unparse(call))
        yield Finding(
            node, text, "sorted(...) makes a new list" if name == "sort" and _is_other(call, target) else hint
        )


def _gives_nothing(program: AnalysedProgram, call: ast.Call) -> bool:
    if isinstance(call.func, ast.Attribute):
        is_list = call.func.attr in CHANGING and program.values.of(call.func.value).is_list
        return is_list and program.values.of(call).kinds == NONE
    if not isinstance(call.func, ast.Name):
        return False
    command = program.command(call.func.id, program.symbols.scope_of(call))
    return command is not None and command.details.returns.type_name == "None"


def _is_used(program: AnalysedProgram, target: ast.Name) -> bool:
    """Return whether a variable is read as more than None: called on, calculated with, asked, passed."""
    symbols = program.symbols
    home = symbols.scope_of(target).home(target.id)
    for read in symbols.reads_of(target.id, home):
        above = symbols.parent(read)
        is_none = isinstance(above, ast.Compare) and any(
            isinstance(part, ast.Constant) and part.value is None for part in (above.left, *above.comparators)
        )
        if not is_none and read.lineno > target.lineno:
            return True
    return False


def _is_other(call: ast.Call, target: ast.Name) -> bool:
    owner = call.func.value if isinstance(call.func, ast.Attribute) else None
    return not isinstance(owner, ast.Name) or owner.id != target.id
