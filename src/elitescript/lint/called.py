"""Lists the calls of commands by name, with their arguments by parameter: for rules that compare calls."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING

from elitescript.language.scopes import Scope
from elitescript.lint.arguments import Arguments
from elitescript.lint.program import AnalysedProgram, CommandCall
from elitescript.records import NamedTuple
from elitescript.values.description import TEXT, WHOLE

if TYPE_CHECKING:
    from elitescript.lint.passed_values import PassedCall


class Called(NamedTuple):
    """A call of a command.

    Attributes:
        name: of the command; of an older name, the one it stands for.
        call: the call.
        scope: where it stands.
        given: the expressions of the arguments, by parameter.
        is_complete: nothing is passed as `*list` or `**dict`.
        written: the call as it is written; another one than `call` for a turn of a loop, or a caller.
    """

    name: str
    call: ast.Call
    scope: Scope
    given: dict[str, ast.expr]
    is_complete: bool
    written: ast.Call


def _put(
    by_name: dict[str, list[Called]], found: CommandCall | PassedCall, arguments: Arguments, written: ast.Call
) -> None:
    call = found.call
    given = {param.name: node for param, node in arguments.given}
    name = found.command.alias_of or found.command.name
    by_name.setdefault(name, []).append(Called(name, call, found.scope, given, arguments.is_complete, written))


class CalledCommands:
    """The calls of commands of one program.

    Args:
        program: the program.
    """

    __slots__ = ("__dict__", "_by_name", "_passed", "_program")

    def __init__(self, program: AnalysedProgram) -> None:
        self._program = program
        self._by_name: dict[str, list[Called]] = {}
        self._passed: dict[str, list[Called]] | None = None
        for found, arguments in zip(program.command_calls, program.arguments, strict=True):
            _put(self._by_name, found, arguments, found.call)

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

    def all_of(self, *names: str) -> list[Called]:
        """Return the calls of some commands, all if no name is given, and behind them those of `PassedValues`."""
        if self._passed is None:
            self._passed = {}
            for passed, arguments in self._program.passed_calls:
                _put(self._passed, passed, arguments, passed.written)
        if not names:
            return [*self, *(called for calls in self._passed.values() for called in calls)]
        return self.of(*names) + [called for name in names for called in self._passed.get(name, ())]

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
