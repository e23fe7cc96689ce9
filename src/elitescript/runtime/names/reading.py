"""Calls predefined functions that only give a value, for what looks at a program: nothing is changed or remembered."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any, Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.errors import DebugError
from elitescript.messages.profile import release_of
from elitescript.runtime.names.context import Context
from elitescript.values.concrete import Refusal, builtin_call

OnRead = Callable[[str, int], None]

_CHANGING: Final = frozenset(
    (
        "write",
        "request",
        "request_from",
        "request_motion",
        "request_path_offset",
        "cancel_move",
        "emit",
        "observe",
        "put",
    )
)
"""What a command may not ask of the machine while it is only looked at."""


def predefined_call(
    context: Context | None,
    name: str,
    arguments: tuple[Any, ...],
    named: dict[str, Any],
    on_read: OnRead | None = None,
) -> Any:
    """Call a command or a built-in function that only gives a value.

    Args:
        context: of the program whose call it would be; None for no program.
        name: of the function.
        arguments: by position.
        named: by name.
        on_read: called with family and index of each point of the signal image that is read.

    Raises:
        DebugError: it is refused, or fails.
    """
    command = CATALOGUE.get(name)
    if command is None:
        return builtin_call(name, arguments, named)
    if not command.only_gives_a_value:
        raise Refusal(f"{name}() changes something or takes time")
    if context is None or release_of(command.since) > context.profile.release:
        raise DebugError(f"{name}() is not there")
    look = copy.copy(context)
    look.machine = _ReadOnly(context.machine, on_read)
    look.is_look = True
    look.forget_copies()
    return command.call(look, arguments, named)


class _ReadOnly:
    """The machine, without what changes it."""

    __slots__ = ("_machine", "_on_read")

    def __init__(self, machine: Any, on_read: OnRead | None) -> None:
        self._machine = machine
        self._on_read = on_read

    def __getattr__(self, name: str) -> Any:
        if name in _CHANGING:
            raise Refusal("it changes the robot")
        if name == "read" and self._on_read is not None:
            return self._read
        return getattr(self._machine, name)

    def _read(self, family: str, index: int = 0) -> Any:
        assert self._on_read is not None
        self._on_read(family, index)
        return self._machine.read(family, index)
