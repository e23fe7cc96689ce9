"""Our own modules by name: what each needs of the program that imports it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, Protocol

from elitescript.runtime.bindings import step_of
from elitescript.runtime.context import Context
from elitescript.runtime.facades import Facade, ModuleShelf
from elitescript.runtime.scheduler import Scheduler
from elitescript.runtime.stdlib.chance import random_names
from elitescript.runtime.stdlib.clock import clock_names
from elitescript.runtime.stdlib.iteration import itertools_names
from elitescript.runtime.stdlib.notation import typing_names
from elitescript.runtime.stdlib.patterns import re_names
from elitescript.runtime.stdlib.posix import os_names, signal_names
from elitescript.runtime.stdlib.processes import ProcessTable, subprocess_names
from elitescript.runtime.stdlib.system import system_names


class Owner(Protocol):
    """The program."""

    context: Context
    scheduler: Scheduler
    shelf: ModuleShelf

    @property
    def processes(self) -> ProcessTable:
        """Its processes."""

    def generator(self) -> Any:
        """Draws its random numbers."""


def own_names(name: str, program: Owner) -> dict[str, Any]:
    """Public names of one of our modules, for one program."""
    return _MAKERS[name](program)


_MAKERS: Final[dict[str, Callable[[Owner], dict[str, Any]]]] = {
    "elicopy": lambda program: dict(vars(program.shelf.facade("copy"))),
    "itertools": lambda program: itertools_names(step_of(program.scheduler)),
    "os": lambda program: os_names(program.context, program.processes, Facade),
    "random": lambda program: random_names(program.generator()),
    "re": lambda program: re_names(),
    "signal": lambda program: signal_names(),
    "subprocess": lambda program: subprocess_names(program.processes, program.scheduler),
    "sys": lambda program: system_names(program.context.write, program.context.leave),
    "time": lambda program: clock_names(program.context, lambda: program.shelf.copy("_strptime")),
    "typing": lambda program: typing_names(vars(program.shelf.facade("collections"))["namedtuple"]),
}
