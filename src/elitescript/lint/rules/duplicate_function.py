"""A function that is defined twice in the same block.

The second `def` replaces the first one, which then cannot be called any more; usually a piece of the text was
pasted twice, or two functions got the same name by mistake. A first one that is used before the second comes,
and definitions in different branches of an `if` or `try`, are left alone; so is what the pendant's plug-ins repeat
word by word for each of their nodes, in texts with line marks.

    def job():
      def grip():
        set_tool_digital(0, True)
      end
      def grip():                # W217
        set_tool_digital(1, True)
      end
      grip()
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.language.nodes import BLOCKS
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="W217", since="0.2")
def duplicate_function(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each later definition."""
    names = [node.name for node in program.nodes(ast.FunctionDef)]
    if len(set(names)) == len(names):
        return
    for scope in program.symbols.scopes:
        for block in _blocks(scope.statements):
            latest: dict[str, ast.FunctionDef] = {}
            for statement in block:
                if not isinstance(statement, ast.FunctionDef):
                    _forget_used(latest, statement)
                    continue
                before = latest.get(statement.name)
                if before is not None and not statement.decorator_list and not _is_repeated(before, statement, program):
                    name = statement.name
                    yield Finding(
                        program.name_span(statement, name),
                        said(
                            "`{name}` is defined already in line {line}: that one can no longer be called",
                            name=name,
                            line=before.lineno,
                        ),
                        "remove one of the two, or give it another name",
                    )
                if statement.decorator_list:
                    latest.pop(statement.name, None)
                else:
                    latest[statement.name] = statement


def _is_repeated(before: ast.FunctionDef, after: ast.FunctionDef, program: AnalysedProgram) -> bool:
    return program.parsed.has_line_marks and ast.dump(before) == ast.dump(after)


def _blocks(statements: list[ast.stmt]) -> Iterator[list[ast.stmt]]:
    """Yield the statements of a scope, and those of the blocks in it that are no scopes of their own."""
    stack = [statements]
    while stack:
        block = stack.pop()
        yield block
        for statement in block:
            if isinstance(statement, (ast.FunctionDef, ast.ClassDef)):
                continue
            for field in BLOCKS:
                inner = getattr(statement, field, None)
                if inner:
                    stack.append(inner)
            stack += [handler.body for handler in getattr(statement, "handlers", ())]
            stack += [case.body for case in getattr(statement, "cases", ())]


def _forget_used(latest: dict[str, ast.FunctionDef], statement: ast.stmt) -> None:
    """Remove from `latest` the functions that a statement may use, itself or through what it calls."""
    if not latest:
        # Each statement of a chain of `elif` holds all that follow: none is gone through for nothing.
        return
    for node in ast.walk(statement):
        if isinstance(node, ast.Call):
            latest.clear()
            return
        if isinstance(node, ast.Name):
            latest.pop(node.id, None)
