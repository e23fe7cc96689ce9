"""Calls of commands: which argument goes to which parameter.

The same rules as `Command.bind` has for values, for expressions that have none yet.
"""

from __future__ import annotations

import ast
from typing import NamedTuple

from elitescript.commands.registry import Command, Param


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
            text = f"{command.name} takes {_count(params)}, got {len(call.args)}"
            misfits.append(Misfit(call.args[len(params)], text))
    for keyword in call.keywords:
        if keyword.arg is None:
            continue
        name = _parameter(params, keyword.arg)
        if name is None:
            names = ", ".join(param.name for param in params) or "none"
            text = f"{command.name} has no argument `{keyword.arg}`; its arguments: {names}"
            misfits.append(Misfit(keyword, text))
        elif name in given:
            misfits.append(Misfit(keyword, f"{command.name} gets the argument `{name}` twice"))
        else:
            given[name] = keyword.value
    if not spreads_list and not spreads_dict:
        missing = [f"`{param.name}`" for param in params if param.is_required and param.name not in given]
        # A misspelt keyword is reported; that its parameter is missing then follows.
        if missing and not misfits:
            noun = "argument" if len(missing) == 1 else "arguments"
            misfits.append(Misfit(call.func, f"{command.name} misses the {noun} {', '.join(missing)}"))
    return Arguments(tuple((param, given[param.name]) for param in params if param.name in given), tuple(misfits))


def _parameter(params: tuple[Param, ...], keyword: str) -> str | None:
    return next((param.name for param in params if keyword == param.name or keyword in param.spellings), None)


def _count(params: tuple[Param, ...]) -> str:
    if not params:
        return "no arguments"
    required = sum(param.is_required for param in params)
    most = len(params)
    noun = "argument" if most == 1 else "arguments"
    return f"{most} {noun}" if required == most else f"at most {most} {noun}"
