"""Matches the expressions of a call with the parameters of its command, before the run.

The rules are those of `Command.place`, which binds values at run time.
"""

from __future__ import annotations

import ast

from elitescript.commands.definition.registry import Command, Param, Placement
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
        is_complete: nothing is passed as `*list` or `**dict`.
    """

    given: tuple[tuple[Param, ast.expr], ...]
    misfits: tuple[Misfit, ...]
    is_complete: bool


Placements = dict[tuple[Command, int, tuple[str, ...], bool], Placement]
"""Of the forms of calls that a program has."""


def arrange(command: Command, call: ast.Call, known: Placements) -> Arguments:
    """Return the arguments of a call by parameter, as far as that is certain before the run.

    Args:
        command: that is called.
        call: the call.
        known: placements of calls of the same form; gets that of this one.
    """
    spreads_list = ast.Starred in map(type, call.args)
    by_position = [] if spreads_list else call.args
    named: dict[str, ast.keyword] = {}
    names: tuple[str, ...] = ()
    if call.keywords:
        named = {keyword.arg: keyword for keyword in reversed(call.keywords) if keyword.arg is not None}
        names = tuple([keyword.arg for keyword in call.keywords if keyword.arg is not None])
    is_complete = not spreads_list and len(names) == len(call.keywords)
    form = (command, len(by_position), names, is_complete)
    placement = known.get(form)
    if placement is None:
        placement = known[form] = command.place(len(by_position), names, is_complete=is_complete)
    given = tuple(
        [
            (param, by_position[slot] if type(slot) is int else named[slot].value)  # type: ignore[index]
            for param, slot in zip(command.params, placement.slots, strict=True)
            if slot is not None
        ]
    )
    if not placement.misfits:
        return Arguments(given, (), is_complete)
    nodes: dict[int | str | None, ast.AST] = {None: call.func}
    nodes.update(enumerate(by_position))
    nodes.update(named.items())
    misfits = tuple(Misfit(nodes[misfit.at], misfit.text) for misfit in placement.misfits)
    return Arguments(given, misfits, is_complete)
