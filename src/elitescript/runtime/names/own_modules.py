"""Makes the modules of the runtime by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, Protocol

from elitescript.runtime.names.bindings import steps_of
from elitescript.runtime.names.context import Context
from elitescript.runtime.names.modules import Facade, ModuleShelf
from elitescript.runtime.stdlib.iteration import itertools_names
from elitescript.runtime.stdlib.os_module import os_names, signal_names
from elitescript.runtime.stdlib.random_module import random_names
from elitescript.runtime.stdlib.re_module import re_names
from elitescript.runtime.stdlib.subprocess_module import ProcessTable, subprocess_names
from elitescript.runtime.stdlib.sys_module import system_names
from elitescript.runtime.stdlib.time_module import clock_names
from elitescript.runtime.threads.scheduler import Scheduler


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
    """Return the public names of a module of the runtime, for one program."""
    return _MAKERS[name](program)


def _dates(program: Owner) -> dict[str, Any]:
    from elitescript.runtime.stdlib.datetime_module import datetime_names

    return datetime_names(program.context, lambda: program.shelf.copy("_strptime"))


_MAKERS: Final[dict[str, Callable[[Owner], dict[str, Any]]]] = {
    "datetime": _dates,
    "elicopy": lambda program: dict(vars(program.shelf.facade("copy"))),
    "itertools": lambda program: itertools_names(steps_of(program.scheduler), lambda: program.shelf.copy("copy")),
    "os": lambda program: os_names(program.context.task_files, program.processes, Facade),
    "random": lambda program: random_names(
        program.generator(), lambda: vars(program.shelf.facade("collections.abc"))["Sequence"]
    ),
    "re": lambda program: re_names(),
    "signal": lambda program: signal_names(),
    "subprocess": lambda program: subprocess_names(program.processes, program.scheduler),
    "sys": lambda program: system_names(program.context.write, program.context.leave, program.context.profile.python),
    "time": lambda program: clock_names(program.context, lambda: program.shelf.copy("_strptime")),
}
