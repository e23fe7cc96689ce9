"""Calls of commands: which argument goes to which parameter.

The same rules as `Command.bind` has for values, for expressions that have none yet.
"""

from __future__ import annotations

import ast
from typing import NamedTuple

from elitescript.commands.definition.registry import Command, Param


class Misfit(NamedTuple):
    """A reason for which a call cannot be made."""

    node: ast.AST
    """The argument that is wrong; the called name if one is missing."""
    text: str


class Arguments(NamedTuple):
    """A call's arguments, brought into order.

    Attributes:
        given: each parameter that gets a value, with the expression.
        misfits: what is wrong with number and names.
    """

    given: tuple[tuple[Param, ast.expr], ...]
    misfits: tuple[Misfit, ...]


def arrange(command: Command, call: ast.Call) -> Arguments:
    """Bring the arguments of a call into order, as far as that is certain before the run."""
    params = command.params
    spreads_list = any(isinstance(argument, ast.Starred) for argument in call.args)
    spreads_dict = any(keyword.arg is None for keyword in call.keywords)
    given: dict[str, ast.expr] = {}
    misfits: list[Misfit] = []
    if not spreads_list:
        for param, argument in zip(params, call.args, strict=False):
            given[param.name] = argument
        if len(call.args) > len(params) and not command.takes_more:
            misfits.append(Misfit(call.args[len(params)], command.surplus_text(len(call.args))))
    for keyword in call.keywords:
        if keyword.arg is None:
            continue
        name = _parameter(params, keyword.arg)
        if name is None:
            misfits.append(Misfit(keyword, command.unknown_argument_text(keyword.arg)))
        elif name in given:
            misfits.append(Misfit(keyword, command.twice_text(name)))
        else:
            given[name] = keyword.value
    if not spreads_list and not spreads_dict:
        missing = [param.name for param in params if param.is_required and param.name not in given]
        # A misspelt keyword is reported; that its parameter is missing then follows.
        if missing and not misfits:
            misfits.append(Misfit(call.func, command.missing_text(missing)))
    return Arguments(tuple((param, given[param.name]) for param in params if param.name in given), tuple(misfits))


def _parameter(params: tuple[Param, ...], keyword: str) -> str | None:
    return next((param.name for param in params if keyword == param.name or keyword in param.spellings), None)
