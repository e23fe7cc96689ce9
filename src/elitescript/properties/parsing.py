"""Reads `--ensure` and `--measure`: expressions, functions of Python files, properties with names.

| text | what it is |
|---|---|
| `max_of(tcp_speed) < 0.5` | an expression; see docs/reference/expressions.md |
| `checks.py:is_stacked` | a function, which is given the finished run |
| `never_stuck`, `limits(0.9)` | a property with a name, if the caller has such |
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Collection, Mapping
from typing import Any, Final

from elitescript.errors import UsageError, did_you_mean
from elitescript.properties.expressions import ExpressionMeasure, ExpressionProperty
from elitescript.properties.functions_of_files import FunctionMeasure, FunctionProperty, Load
from elitescript.properties.grammar import one_line, tree_of
from elitescript.properties.places import wrong_at
from elitescript.properties.verdicts import Measure, Property
from elitescript.values.plain import TEXT_MAX

Named = Mapping[str, Callable[..., Property]]
"""Makes the properties that have names, such as `limits`, from the literals in their brackets."""

_PLACE: Final = re.compile(r"\s*(?P<file>[^\n]+\.py):(?P<function>[^\n:]*?)\s*", re.ASCII)


def function_place(text: str) -> tuple[str, str] | None:
    """Return file and function of a text such as `checks.py:is_stacked`; None if it is none."""
    found = _PLACE.fullmatch(text) if len(text) <= TEXT_MAX else None
    return None if found is None else (found["file"], found["function"])


def parse_property(
    text: str,
    program_globals: Collection[str] | None = None,
    *,
    load: Load | None = None,
    named: Named | None = None,
) -> Property:
    """Return a property.

    Args:
        text: as written.
        program_globals: names of the globals that the program has; any name is taken if None.
        load: loads Python files; without it there are none.
        named: makes properties that have names.

    Raises:
        UsageError: it makes no sense; with the place.
    """
    if (place := function_place(text)) is not None:
        return FunctionProperty(text.strip(), *place, load or _no_file)
    named, line = named or {}, one_line(text)
    match tree_of(line):
        case ast.Name(id=name) if name in named:
            return _made(line, None, named[name], name, [])
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]) as call if name in named:
            return _made(line, call, named[name], name, arguments)
    try:
        return ExpressionProperty(text, program_globals)
    except UsageError as error:
        near = did_you_mean(line, named) if line.isidentifier() else ""
        raise UsageError(f"{error}{near and f'{chr(10)}  properties with names: {near[2:]}'}") from None


def parse_measure(text: str, program_globals: Collection[str] | None = None, *, load: Load | None = None) -> Measure:
    """Return a measure; arguments and errors are those of `parse_property`."""
    if (place := function_place(text)) is not None:
        return FunctionMeasure(text.strip(), *place, load or _no_file)
    return ExpressionMeasure(text, program_globals)


def _no_file(path: str) -> Mapping[str, Any]:
    """Refuse a file."""
    raise UsageError(f"{path}: functions of Python files are not possible here")


def _made(
    text: str, call: ast.Call | None, make: Callable[..., Property], name: str, arguments: list[ast.expr]
) -> Property:
    values: list[Any] = []
    for argument in arguments:
        try:
            values.append(ast.literal_eval(argument))
        except ValueError:
            raise wrong_at(text, argument, f"{name} takes literals, such as {name}(0.9)") from None
    try:
        return make(*values)
    except TypeError:
        raise wrong_at(text, call, f"{name} does not take these arguments") from None
