"""A call that fails with the values that stand there: an alarm (`ValueError`) wherever it is reached.

Numbers in texts have a point, whatever the country: "1.5".

    def job():
      textmsg(float("1,5"))                       # W278: "1.5"
      textmsg(int("1.5"))                         # W278: int(float("1.5"))
      textmsg(str_at("abc", 3))                   # W278: characters count from 0
      textmsg(float("1.5"))                       # fine
    end
"""

from __future__ import annotations

import ast
import builtins
import math
from collections.abc import Callable, Iterator
from typing import Any, Final

from elitescript.commands.definition.registry import Command
from elitescript.errors import ArgumentCountError, ArgumentTypeError, ScriptError, text_of
from elitescript.language.symbols import Resolution, Scope
from elitescript.lint.constants import Unknown
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule, shown_source
from elitescript.said import said

_BUILTINS: Final = frozenset(("chr", "float", "int", "max", "min", "ord"))
_MATH: Final = frozenset(("acos", "asin", "log", "log10", "log2", "sqrt"))
_LONGEST: Final = 200


@rule(code="W278", since="0.3", needs_values=True)
def failing_call(program: AnalysedProgram) -> Iterator[Finding]:
    """Report calls of functions that depend on their arguments alone, with constants that they refuse."""
    refused: set[ast.expr] | None = None
    for scope in program.symbols.scopes:
        for call in scope.calls:
            if call.keywords or not call.args:
                continue
            command = program.command(call.func.id, scope) if isinstance(call.func, ast.Name) else None
            function = None if command is not None else _function(program, call.func, scope)
            if function is None and (command is None or command.takes_robot or not program.is_available(command)):
                continue
            given = [program.constants.value(node, scope) for node in call.args]
            if any(isinstance(value, Unknown) or _is_long(value) for value in given) or program.is_tried(call):
                continue
            if refused is None:
                refused = {refusal.node for refusal in program.refusals}
            if refused.isdisjoint(call.args):
                if command is not None:
                    yield from _of_command(program, call, command, given)
                elif function is not None:
                    yield from _of_python(program, call, function, given)


def _is_long(value: Any) -> bool:
    if isinstance(value, (list, tuple)):
        return len(value) > _LONGEST or any(map(_is_long, value)) or any(isinstance(part, Unknown) for part in value)
    return isinstance(value, (str, bytes)) and len(value) > _LONGEST


def _of_python(
    program: AnalysedProgram, call: ast.Call, function: Callable[..., Any], given: list[Any]
) -> Iterator[Finding]:
    try:
        function(*given)
    except (ValueError, ZeroDivisionError):
        # Texts of Python are not ours.
        yield Finding(call, said("{call} fails", call=shown_source(program, call)), _hint(call, given))
    except (TypeError, ArithmeticError, MemoryError):
        # Told with the argument, or no mistake of the author.
        return


def _of_command(program: AnalysedProgram, call: ast.Call, command: Command, given: list[Any]) -> Iterator[Finding]:
    try:
        command.function(*command.bind(tuple(given), {}))
    except (ArgumentTypeError, ArgumentCountError):
        # Told with the argument.
        return
    except ScriptError as error:
        text = said("{call} fails: {mistake}", call=shown_source(program, call), mistake=text_of(error))
        yield Finding(call, text, error.hint or _hint(call, given))
    except (ArithmeticError, ValueError, TypeError):
        return


def _function(program: AnalysedProgram, node: ast.expr, scope: Scope) -> Callable[..., Any] | None:
    """Return the function of Python that a call means, of those that may be tried."""
    found: Callable[..., Any] | None = None
    if isinstance(node, ast.Name) and node.id in _BUILTINS and scope.resolve(node.id) is Resolution.BUILTIN:
        found = getattr(builtins, node.id)
    elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.attr in _MATH:
        is_math = program.symbols.imported(node.value.id, scope) == "math"
        found = getattr(math, node.attr) if is_math else None
    return found


def _hint(call: ast.Call, given: list[Any]) -> str:
    text = given[0]
    if not isinstance(text, str):
        return ""
    if "," in text and _is_number(text.replace(",", ".")):
        return said("the decimal sign is a point: {text}", text=repr(text.replace(",", ".")))
    name = call.func.id if isinstance(call.func, ast.Name) else ""
    return "int(float(x)) takes a text with a decimal point" if name == "int" and _is_number(text) else ""


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
