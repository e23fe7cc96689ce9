"""A call of a command, or of a function of the program, with the wrong number or names of arguments.

The rules are those of the run: names may be spelt as the manuals spell them, and nothing is dropped in silence.
`start_thread` passes the elements of its second argument.

    def job():
      set_standard_digital_out(1)          # E303: the level is missing
      movel(TARGET, speed=0.1)             # E303: it is called `v`
      def grip(width, force):
        set_standard_analog_out(0, width)
      end
      grip(0.5)                            # E303: grip misses `force`
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.language.advice.unknown_names import nearest
from elitescript.language.diagnostics import Edit, Fix
from elitescript.language.symbols import THREAD_STARTER
from elitescript.lint.program import AnalysedProgram, CommandCall
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_SHOWN: Final = 80
"""Characters of the head of a function that a message repeats."""


@rule(code="E303", since="0.1")
def argument_count(program: AnalysedProgram) -> Iterator[Finding]:
    """Report what is surplus, missing, misnamed or given twice."""
    for called, arguments in zip(program.command_calls, program.arguments, strict=True):
        for misfit in arguments.misfits:
            yield Finding(misfit.node, misfit.text, called.command.call_hint, _fix(program, called, misfit.node))
    yield from _own(program)


def _own(program: AnalysedProgram) -> Iterator[Finding]:
    """Report calls of functions of the program, and starts of threads."""
    symbols = program.symbols
    for scope in symbols.scopes:
        if scope.kind != "function" or not isinstance(scope.node, ast.FunctionDef) or scope.parent is None:
            continue
        function, outer = scope.node, scope.parent
        if function.decorator_list or outer.kind == "class" or len(symbols.bindings(function.name, outer)) != 1:
            continue
        for read in symbols.reads_of(function.name, outer.home(function.name)):
            call = symbols.parent(read)
            if not isinstance(call, ast.Call) or program.is_tried(call):
                continue
            passed = _passed(call, read)
            if passed is not None:
                why = _misfit(function, *passed)
                if why:
                    text = said("{function} {why}", function=function.name, why=why)
                    yield Finding(
                        call, text, said("line {line} has {head}", line=function.lineno, head=_head(function))
                    )


def _passed(call: ast.Call, read: ast.Name) -> tuple[int, list[str]] | None:
    """Return how many arguments a call passes by position, and which by name; None if that is not certain."""
    if call.func is read:
        if any(isinstance(part, ast.Starred) for part in call.args) or any(part.arg is None for part in call.keywords):
            return None
        return len(call.args), [part.arg for part in call.keywords if part.arg is not None]
    is_start = isinstance(call.func, ast.Name) and call.func.id == THREAD_STARTER and call.args[:1] == [read]
    if not is_start or any(isinstance(part, ast.Starred) for part in call.args):
        return None
    rest = [*call.args[1:2], *(part.value for part in call.keywords if part.arg in ("args", "arg"))]
    if not rest:
        return 0, []
    elements = rest[0].elts if isinstance(rest[0], (ast.Tuple, ast.List)) else None
    if elements is None or any(isinstance(part, ast.Starred) for part in elements):
        return None
    return len(elements), []


def _misfit(function: ast.FunctionDef, given: int, names: list[str]) -> str:
    """Return what is wrong with the arguments of a call; empty if nothing is."""
    arguments = function.args
    by_position = [part.arg for part in (*arguments.posonlyargs, *arguments.args)]
    known = {part.arg for part in (*arguments.args, *arguments.kwonlyargs)}
    unknown = [name for name in names if name not in known]
    if unknown and arguments.kwarg is None:
        return said("has no argument {name!r}", name=unknown[0])
    if given > len(by_position) and arguments.vararg is None:
        return said("takes {most}, and gets {given}", most=_counted(len(by_position)), given=given)
    twice = [name for name in by_position[:given] if name in names]
    if twice:
        return said("gets {name!r} twice", name=twice[0])
    needed = by_position[given : len(by_position) - len(arguments.defaults)]
    needed += [
        part.arg for part, value in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True) if value is None
    ]
    missing = [name for name in needed if name not in names]
    return said("misses the argument {name!r}", name=missing[0]) if missing else ""


def _counted(number: int) -> str:
    return "no arguments" if number == 0 else "1 argument" if number == 1 else said("{n} arguments", n=number)


def _head(function: ast.FunctionDef) -> str:
    head = said("def {name}({arguments})", name=function.name, arguments=ast.unparse(function.args))
    return head if len(head) <= _SHOWN else said("def {name}(...)", name=function.name)


def _fix(program: AnalysedProgram, called: CommandCall, node: ast.AST) -> Fix | None:
    """Return the repair of a misspelt keyword; None for anything else."""
    if not isinstance(node, ast.keyword) or not node.arg:
        return None
    names = [param.name for param in called.command.params]
    meant = nearest(node.arg, names) if node.arg not in names else ""
    line, column = program.symbols.place(node)
    edit = Edit(line, column, line, column + len(node.arg), meant)
    return Fix(said("write {meant}", meant=meant), (edit,), safe=False) if meant else None
