"""The names that every script finds without importing anything: commands, built-ins and the compiler's hooks.

They are the built-ins of a run, one dict for each, so that a program which rebinds one (`time = 3`, a parameter
called `list`) hides it for itself and for nobody else.
"""

from __future__ import annotations

import builtins
from collections.abc import Callable
from typing import Any, Final, NoReturn

from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.registry import Catalogue, Command
from elitescript.errors import FirmwareError, ScriptPermissionError, ScriptStateError
from elitescript.language.hooks import CHECKPOINT, FORMAT, LINE, STOP, TICK
from elitescript.messages.profile import Profile, release_of
from elitescript.runtime.alarms import newer_firmware_hint, newer_firmware_text
from elitescript.runtime.context import Context
from elitescript.runtime.facades import Facade, ModuleShelf
from elitescript.runtime.files import OpenFiles
from elitescript.runtime.guards import (
    Identities,
    OneArgumentType,
    checked_delattr,
    checked_dir,
    checked_format_method,
    checked_getattr,
    checked_hasattr,
    checked_setattr,
    class_builder,
)
from elitescript.runtime.scheduler import Scheduler
from elitescript.runtime.stdlib.iteration import Step, iter_until
from elitescript.runtime.strand import UNCATCHABLE

_REAL_NAMES: Final = (
    "abs all any ascii bin callable chr divmod format hash hex isinstance issubclass len max min next oct ord pow repr"
    " round sorted sum"
    " bool bytearray bytes classmethod complex dict enumerate filter float frozenset int list map object property range"
    " reversed set slice staticmethod str super tuple zip"
)
"""Built-ins that scripts get as they are."""

_WITHHELD_ERRORS: Final = frozenset(
    ("BaseExceptionGroup", "ExceptionGroup", "KeyboardInterrupt", "PythonFinalizationError")
)
"""Not for scripts: groups can rebuild exceptions behind a handler's back, an interrupt belongs to the user."""

_ERRORS: Final = [
    name
    for name, value in vars(builtins).items()
    if isinstance(value, type) and issubclass(value, BaseException) and name not in _WITHHELD_ERRORS
]

_REAL: Final[dict[str, Any]] = {
    **{name: getattr(builtins, name) for name in (*_REAL_NAMES.split(), *_ERRORS)},
    "Ellipsis": ...,
    "NotImplemented": NotImplemented,
    "__debug__": True,
}

_REFUSED: Final = {
    "breakpoint": "the robot has no debugger on a terminal",
    "compile": "eval() computes an expression, exec() runs statements",
    "globals": "a program's globals are its `global` names",
    "help": "see `elitescript commands NAME`",
    "locals": "name the variables one by one",
    "memoryview": "bytes and bytearray hold binary data",
    "vars": "name the attributes one by one",
}
"""Built-ins that lead behind objects or to the computer, and what to use instead."""


def builtins_for(
    context: Context,
    *,
    shelf: ModuleShelf,
    files: OpenFiles,
    identities: Identities,
    evaluate: Callable[..., Any],
    execute: Callable[..., None],
    catalogue: Catalogue = CATALOGUE,
) -> dict[str, Any]:
    """The built-ins of one run.

    Args:
        context: the program's.
        shelf: its modules.
        files: its open files.
        identities: numbers its objects.
        evaluate: `eval`.
        execute: `exec`.
        catalogue: the commands.
    """
    scheduler = context.scheduler
    names = dict(_REAL)
    names.update((name, _refused(name, advice)) for name, advice in _REFUSED.items())
    names.update(
        delattr=checked_delattr,
        dir=checked_dir,
        eval=evaluate,
        exec=execute,
        exit=_leaving(context, "exit"),
        getattr=checked_getattr,
        hasattr=checked_hasattr,
        id=_id(identities),
        input=_input,
        iter=iter_until(step_of(scheduler)),
        long=int,
        open=_open(files),
        print=_print(context),
        quit=_leaving(context, "quit"),
        setattr=checked_setattr,
        type=OneArgumentType,
        unichr=chr,
    )
    names["copy"] = names["elicopy"] = _preloaded_copy(shelf)
    names["__import__"] = _import(shelf)
    # A stand-in of this run: handlers may name it, but nobody raises it; the real one belongs to the user.
    names["KeyboardInterrupt"] = type("KeyboardInterrupt", (BaseException,), {"__module__": "builtins"})
    names["__build_class__"] = class_builder(identities)
    names.update((name, command_function(catalogue, name, context)) for name in catalogue.names())
    names[TICK] = scheduler.fuel.pop
    names[CHECKPOINT] = scheduler.checkpoint
    names[STOP] = UNCATCHABLE
    names[FORMAT] = checked_format_method
    names[LINE] = _line(context)
    return names


def command_function(catalogue: Catalogue, name: str, context: Context) -> Callable[..., Any]:
    """The function that a script calls for a command.

    A command of a newer firmware is there and says which one it needs.
    """
    command = catalogue.get(name)
    assert command is not None
    if release_of(command.since) > context.profile.release:
        return _newer(name, command, context.profile)
    scheduler, run = context.scheduler, command.call

    def call(*args: Any, **kwargs: Any) -> Any:
        if scheduler.is_ending or scheduler.current is None:
            scheduler.refuse_if_stopped()
        return run(context, args, kwargs)

    call.__name__ = call.__qualname__ = name
    return call


def _newer(name: str, command: Command, profile: Profile) -> Callable[..., NoReturn]:
    def call(*args: Any, **kwargs: Any) -> NoReturn:
        raise FirmwareError(
            newer_firmware_text(name, command.since, profile),
            command=name,
            limit=f"firmware >= {command.since}",
            hint=newer_firmware_hint(command.since),
        )

    call.__name__ = call.__qualname__ = name
    return call


def step_of(scheduler: Scheduler) -> Step:
    """A checkpoint for our own loops that run on behalf of a script."""
    tick, checkpoint = scheduler.fuel.pop, scheduler.checkpoint

    def step() -> bool:
        return tick() or checkpoint()

    return step


def _print(context: Context) -> Callable[..., None]:
    write = context.write

    def print(*values: Any, sep: Any = " ", end: Any = "\n", file: Any = None, flush: Any = False) -> None:
        """Print to the task's log, or to a file."""
        text = (" " if sep is None else sep).join([str(value) for value in values]) + ("\n" if end is None else end)
        if file is None:
            write(text)
        else:
            file.write(text)

    print.__qualname__ = "print"
    return print


def _open(files: OpenFiles) -> Callable[..., Any]:
    def open(
        file: Any,
        mode: Any = "r",
        buffering: Any = -1,
        encoding: Any = None,
        errors: Any = None,
        newline: Any = None,
    ) -> Any:
        """Open a file of the task folder."""
        return files.open(file, mode, encoding, newline, errors)

    open.__qualname__ = "open"
    return open


def _id(identities: Identities) -> Callable[[Any], int]:
    def id(value: Any) -> int:
        """A number that belongs to an object and is the same in every run."""
        return identities.number(value)

    id.__qualname__ = "id"
    return id


def _input(*prompt: Any) -> NoReturn:
    """Refuse: nobody sits at a terminal.

    Raises:
        ScriptStateError: always.
    """
    raise ScriptStateError("input() has no terminal to read from", code="R123", command="input")


def _leaving(context: Context, name: str) -> Callable[..., None]:
    def leave(status: Any = None) -> None:
        """End the program, like `halt()`."""
        context.leave(name)

    leave.__name__ = leave.__qualname__ = name
    return leave


def _refused(name: str, advice: str) -> Callable[..., NoReturn]:
    def refuse(*args: Any, **kwargs: Any) -> NoReturn:
        """Refuse.

        Raises:
            ScriptPermissionError: always.
        """
        raise ScriptPermissionError(f"{name}() is not available to programs", command=name, hint=advice)

    refuse.__name__ = refuse.__qualname__ = name
    return refuse


def _import(shelf: ModuleShelf) -> Callable[..., Any]:
    def import_module(name: Any, *details: Any, **options: Any) -> Any:
        """`__import__`."""
        if type(name) is not str:
            raise TypeError(f"the name of a module must be a str, not {type(name).__name__}")
        return shelf.import_module(name, *details, **options)

    return import_module


def _preloaded_copy(shelf: ModuleShelf) -> Facade:
    """`copy` and `elicopy`, which programs use without importing; the module itself is loaded at the first call."""

    def copy(x: Any) -> Any:
        """A shallow copy."""
        return vars(shelf.facade("copy"))["copy"](x)

    def deepcopy(x: Any, memo: Any = None) -> Any:
        """A copy of the value and of all that it holds."""
        return vars(shelf.facade("copy"))["deepcopy"](x, memo)

    for function in (copy, deepcopy):
        function.__qualname__ = function.__name__
    return Facade("copy", {"copy": copy, "deepcopy": deepcopy})


def _line(context: Context) -> Callable[..., None]:
    def mark(number: Any, label: Any, after: Any = None) -> None:
        """The program has reached a `$ LINE` mark; the third element says that the node is behind it."""
        context.mark(int(number), str(label))

    return mark
