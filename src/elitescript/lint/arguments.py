"""Matches the expressions of a call with the parameters of its command, before the run.

The rules are those of `Command.place`, which binds values at run time.
"""

from __future__ import annotations

import ast

from elitescript.commands.definition.registry import Command, Param
from elitescript.records import NamedTuple


class Misfit(NamedTuple):
    """A reason for which a call cannot be made."""

    node: ast.AST
    """The argument that is wrong; the called name if one is missing."""
    text: str


class Arguments(NamedTuple):
    """A call's arguments, by parameter.

    Attributes:
        given: each parameter that gets a value, with the expression.
        misfits: what is wrong with number and names.
    """

    given: tuple[tuple[Param, ast.expr], ...]
    misfits: tuple[Misfit, ...]


def arrange(command: Command, call: ast.Call) -> Arguments:
    """Return the arguments of a call by parameter, as far as that is certain before the run."""
    spreads_list = any(isinstance(argument, ast.Starred) for argument in call.args)
    spreads_dict = any(keyword.arg is None for keyword in call.keywords)
    by_position = [] if spreads_list else call.args
    by_keyword = [keyword for keyword in call.keywords if keyword.arg is not None]
    placement = command.place(
        len(by_position),
        [keyword.arg for keyword in by_keyword if keyword.arg is not None],
        is_complete=not spreads_list and not spreads_dict,
    )
    values: dict[int | str | None, ast.expr] = dict(enumerate(by_position))
    nodes: dict[int | str | None, ast.AST] = {**values, None: call.func}
    for keyword in reversed(by_keyword):
        values[keyword.arg], nodes[keyword.arg] = keyword.value, keyword
    given = tuple(
        (param, values[slot]) for param, slot in zip(command.params, placement.slots, strict=True) if slot is not None
    )
    return Arguments(given, tuple(Misfit(nodes[misfit.at], misfit.text) for misfit in placement.misfits))
