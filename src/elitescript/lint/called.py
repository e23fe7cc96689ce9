"""Lists the calls of commands by name, with their arguments by parameter: for rules that compare calls."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cached_property

from elitescript.language.scopes import Scope
from elitescript.lint.program import AnalysedProgram
from elitescript.records import NamedTuple
from elitescript.values.description import TEXT, WHOLE


class Called(NamedTuple):
    """A call of a command.

    Attributes:
        name: of the command; of an older name, the one it stands for.
        call: the call.
        scope: where it stands.
        given: the expressions of the arguments, by parameter.
        is_complete: nothing is passed as `*list` or `**dict`.
    """

    name: str
    call: ast.Call
    scope: Scope
    given: dict[str, ast.expr]
    is_complete: bool


class CalledCommands:
    """The calls of commands of one program.

    Args:
        program: the program.
    """

    __slots__ = ("__dict__", "_by_name", "_program")

    def __init__(self, program: AnalysedProgram) -> None:
        self._program = program
        self._by_name: dict[str, list[Called]] = {}
        for found, arguments in zip(program.command_calls, program.arguments, strict=True):
            given = {param.name: node for param, node in arguments.given}
            name = found.command.alias_of or found.command.name
            made = Called(name, found.call, found.scope, given, arguments.is_complete)
            self._by_name.setdefault(name, []).append(made)

    def __iter__(self) -> Iterator[Called]:
        for calls in self._by_name.values():
            yield from calls

    def at(self, call: ast.AST) -> Called | None:
        """Return a call of a command; None if it is none."""
        return self._by_call.get(call)

    @cached_property
    def _by_call(self) -> dict[ast.AST, Called]:
        return {called.call: called for called in self}

    def of(self, *names: str) -> list[Called]:
        """Return the calls of some commands, in the order of their names."""
        return [called for name in names for called in self._by_name.get(name, ())]

    def are_passed_on(self, *names: str) -> bool:
        """Return whether commands are used otherwise than by a call, so that their arguments are not known."""
        return any(use.name in names and not use.is_call for use in self._program.outside)

    def texts(self, called: Called, param: str, default: str) -> tuple[str, ...]:
        """Return all texts that an argument can be; none if that is not known."""
        node = called.given.get(param)
        if node is None:
            return (default,) if called.is_complete else ()
        value = self._program.constants.value(node, called.scope)
        if isinstance(value, str):
            return (value,)
        described = self._program.values.of(node)
        if described.kinds == TEXT and described.constants:
            return tuple(described.constants)
        return ()

    def number(self, called: Called, param: str, default: int | None = None) -> int | None:
        """Return the whole number that an argument is in any case; None if that is not known."""
        node = called.given.get(param)
        if node is None:
            return default if called.is_complete else None
        value = self._program.constants.value(node, called.scope)
        if isinstance(value, int):
            return value
        described = self._program.values.of(node)
        is_known = described.has_constant and not described.kinds & ~WHOLE
        return int(described.constant) if is_known else None
