"""Makes the predefined names of scripts: commands, built-ins and the compiler's hooks.

Each run has a dict of its own, so a program that rebinds a name (`time = 3`, a parameter called `list`) changes it for
itself alone. Functions belong to one run too, because a script can set attributes of them. There are hundreds, and most
programs are short: each is made when code that names it is about to run. All code of a run is compiled here, so every
name that it can look up is in its code objects.
"""

from __future__ import annotations

import builtins
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from importlib import import_module as import_real
from itertools import chain, repeat
from types import CodeType, FunctionType
from typing import TYPE_CHECKING, Any, Final, NoReturn, Self

from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.registry import Command
from elitescript.commands.definition.vocabulary import newer_firmware_hint, newer_firmware_text
from elitescript.errors import FirmwareError, ScriptError, ScriptPermissionError, ScriptStateError
from elitescript.language.builtin_names import REFUSED_BUILTINS, WITHHELD_ERRORS
from elitescript.language.hooks import AT, ATTRIBUTE, CHECKPOINT, LINE, LOOP, PAY, RANGE, STOP, TICK, WATCHED
from elitescript.messages.profile import Profile, release_of
from elitescript.runtime.files import OpenFiles
from elitescript.runtime.names.context import Context
from elitescript.runtime.names.guards import (
    attribute_hook,
    checked_delattr,
    checked_dir,
    checked_hasattr,
    checked_setattr,
    getattr_over,
)
from elitescript.runtime.names.modules import Facade, ModuleShelf
from elitescript.runtime.stdlib.iteration import Steps, iter_until
from elitescript.runtime.threads.scheduler import Scheduler, noting_calls
from elitescript.runtime.threads.strand import UNCATCHABLE
from elitescript.said import said
from elitescript.sealed import Sealed

if TYPE_CHECKING:
    from elitescript.runtime.names.identities import Identities

_REAL_NAMES: Final = (
    "abs all any ascii bin callable chr divmod format hex isinstance issubclass len max min next oct ord pow repr"
    " round sorted sum"
    " bool bytearray bytes classmethod complex dict enumerate filter float frozenset int list map object property range"
    " reversed set slice staticmethod str super tuple zip"
)
"""Built-ins that scripts get as they are."""

_ERRORS: Final = [
    name
    for name, value in vars(builtins).items()
    if isinstance(value, type) and issubclass(value, BaseException) and name not in WITHHELD_ERRORS
]

_REAL: Final[dict[str, Any]] = {
    # Commands come before built-ins of the same name.
    **{name: getattr(builtins, name) for name in (*_REAL_NAMES.split(), *_ERRORS) if CATALOGUE.get(name) is None},
    "Ellipsis": ...,
    "NotImplemented": NotImplemented,
    "__debug__": True,
    "long": int,
    "unichr": chr,
}
"""Objects that no script can change; all runs share them."""


_SEES_MEMO: Final = "__deepcopy__"
"""Method that gets the table of objects of a `deepcopy`."""

Refused = Callable[[str, ScriptError], None]


class Bindings:
    """The built-ins of one run.

    Args:
        context: the program's.
        shelf: its modules.
        files: its open files.
        evaluate: `eval`.
        execute: `exec`.
        probe_hooks: of what counts its statements; empty without.
        refused: called with the name of a command that refuses a call, and the error; None for nothing.

    Attributes:
        names: the dict that its code runs with; grows as code is bound.
    """

    __slots__ = ("_identities", "context", "evaluate", "execute", "files", "names", "refused", "shelf")

    def __init__(
        self,
        context: Context,
        *,
        shelf: ModuleShelf,
        files: OpenFiles,
        evaluate: Callable[..., Any],
        execute: Callable[..., None],
        probe_hooks: Mapping[str, object],
        refused: Refused | None = None,
    ) -> None:
        self.context = context
        self.shelf = shelf
        self.files = files
        self.evaluate = evaluate
        self.execute = execute
        self.refused = refused
        self._identities: Identities | None = None
        scheduler = context.scheduler
        self.names: dict[str, Any] = {
            **_REAL,
            "__import__": noting_calls(scheduler, _import(shelf)),
            "__build_class__": builtins.__build_class__,
            TICK: scheduler.fuel.pop,
            CHECKPOINT: scheduler.checkpoint,
            PAY: scheduler.pay,
            LOOP: scheduler.note_loop,
            RANGE: range,
            STOP: UNCATCHABLE,
            WATCHED: scheduler.watchers,
            AT: scheduler.passes.__getitem__,
            ATTRIBUTE: self._first_attribute,
            LINE: _line(context),
            **probe_hooks,
        }

    @property
    def identities(self) -> Identities:
        """Numbers the objects of the run; most programs need none."""
        if self._identities is None:
            from elitescript.runtime.names.identities import Identities

            self._identities = Identities()
        return self._identities

    def _first_attribute(self, value: Any, name: str) -> Any:
        """Make the hook for guarded attributes when it is first called."""
        load = self.names[ATTRIBUTE] = attribute_hook(self.identities)
        return load(value, name)

    def number_classes(self) -> None:
        """Have classes that are made from now on, and their objects, hashed by number."""
        if self.names["__build_class__"] is builtins.__build_class__:
            self.names["__build_class__"] = self.identities.class_builder()

    def forget_identities(self) -> None:
        """Let go of the objects that have numbers."""
        if self._identities is not None:
            self._identities.clear()

    def bind(self, code: CodeType) -> None:
        """Make the objects that this code names; called before it runs."""
        names = self.names
        codes = [code]
        while codes:
            code = codes.pop()
            for name in code.co_names:
                if name not in names:
                    self.bind_name(name)
            if _SEES_MEMO in code.co_names or _SEES_MEMO in code.co_consts:
                self.shelf.show_memo()
            codes += [value for value in code.co_consts if type(value) is CodeType]

    def bind_name(self, name: str) -> None:
        """Make the object of a predefined name."""
        command, make = CATALOGUE.get(name), _MADE.get(name)
        if command is not None:
            self.names[name] = command_function(command, name, self.context, self.refused)
        elif make is not None:
            made = make(self)
            self.names[name] = noting_calls(self.context.scheduler, made) if name in _LONG else made

    def known(self) -> Iterable[str]:
        """Return all predefined names."""
        return (*_REAL, *_MADE, *CATALOGUE.names())


def is_known(name: str) -> bool:
    """Return whether a name is predefined."""
    return name in _REAL or name in _MADE or CATALOGUE.get(name) is not None


def command_function(
    command: Command, name: str, context: Context, refused: Refused | None = None
) -> Callable[..., Any]:
    """Return the function of a command for scripts; one of a newer firmware raises `FirmwareError`."""
    if release_of(command.since) > context.profile.release:
        return _newer(name, command, context.profile)
    scheduler, run = context.scheduler, command.call

    def call(*args: Any, **kwargs: Any) -> Any:
        if scheduler.is_ending or scheduler.current is None:
            scheduler.refuse_if_stopped()
        try:
            return run(context, args, kwargs)
        except ScriptError as error:
            if refused is not None:
                refused(name, error)
            context.tell_refused(name, command.family, error)
            raise

    note_call = scheduler.note_call

    def metered(*args: Any, **kwargs: Any) -> Any:
        if scheduler.is_ending or scheduler.current is None:
            scheduler.refuse_if_stopped()
        note_call()
        try:
            return run(context, args, kwargs)
        except ScriptError as error:
            if refused is not None:
                refused(name, error)
            context.tell_refused(name, command.family, error)
            raise

    function = call if scheduler.meter is None else metered
    function.__name__ = function.__qualname__ = name
    return function


def _newer(name: str, command: Command, profile: Profile) -> Callable[..., NoReturn]:
    def call(*args: Any, **kwargs: Any) -> NoReturn:
        raise FirmwareError(
            newer_firmware_text(name, command.since, profile),
            command=name,
            limit=said("firmware >= {since}", since=command.since),
            hint=newer_firmware_hint(command.since),
        )

    call.__name__ = call.__qualname__ = name
    return call


def steps_of(scheduler: Scheduler) -> Steps:
    """Return an iterator with a checkpoint in each step, for iterators that run for a script without end."""
    tick, checkpoint = scheduler.fuel.pop, scheduler.checkpoint

    def refilled(_: None) -> Iterator[bool]:
        checkpoint()
        return iter(tick, False)

    # As `tick() or checkpoint()`, but in C as long as there is work left.
    return chain.from_iterable(chain([iter(tick, False)], map(refilled, repeat(None))))


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


def _type(run: Bindings) -> type:
    from elitescript.runtime.names.identities import OneArgumentType

    return OneArgumentType


def _id(identities: Identities) -> Callable[[Any], int]:
    def id(value: Any) -> int:
        """Return the number of an object, the same in every run."""
        return identities.number(value)

    id.__qualname__ = "id"
    return id


def _hash(identities: Identities) -> Callable[[Any], int]:
    hash_of = identities.hash_of

    def hash(value: Any, /) -> int:
        """Return the hash of an object, the same in every run that begins with the same hash seed."""
        return hash_of(value)

    hash.__qualname__ = "hash"
    return hash


def _input(*prompt: Any) -> NoReturn:
    """Refuse: there is no terminal.

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


def _refusal(name: str, _run: Bindings) -> Callable[..., NoReturn]:
    advice = REFUSED_BUILTINS[name]

    def refuse(*args: Any, **kwargs: Any) -> NoReturn:
        """Refuse.

        Raises:
            ScriptPermissionError: always.
        """
        raise ScriptPermissionError(said("{name}() is not available to programs", name=name), command=name, hint=advice)

    refuse.__name__ = refuse.__qualname__ = name
    return refuse


def _import(shelf: ModuleShelf) -> Callable[..., Any]:
    def import_module(name: Any, *details: Any, **options: Any) -> Any:
        """`__import__`."""
        if type(name) is not str:
            raise TypeError(f"the name of a module must be a str, not {type(name).__name__}")
        if len(details) > 2 and type(details[2]) is list:
            # Python's own C code needs a module; the statement of a program has a tuple or None here.
            return import_real(name)
        return shelf.import_module(name, *details, **options)

    return import_module


def _stand_in(name: str) -> type[BaseException]:
    """Return an exception that handlers may name, but that is never raised: the real one belongs to the user."""
    return type(name, (BaseException,), {"__module__": "builtins"})


class _BaseGroup(BaseException, metaclass=Sealed):
    """A class that handlers may name, and that cannot be called: groups could rebuild what ends a thread."""

    __module__ = "builtins"
    __qualname__ = "BaseExceptionGroup"

    def __new__(cls, *args: Any, **options: Any) -> Self:
        raise ScriptPermissionError(
            said("{name} is not available to programs", name=cls.__qualname__),
            command=cls.__qualname__,
            hint="raise one exception; it can hold others in a list",
        )


class _Group(_BaseGroup, Exception):
    """See `_BaseGroup`."""

    __module__ = "builtins"
    __qualname__ = "ExceptionGroup"


_GROUPS: Final[dict[str, type[BaseException]]] = {kind.__qualname__: kind for kind in (_BaseGroup, _Group)}
for _kind in _GROUPS.values():
    type.__setattr__(_kind, "__name__", _kind.__qualname__)


def _group(name: str, _run: Bindings) -> type[BaseException]:
    return _GROUPS[name]


def _copy_of(function: Any) -> Callable[[Bindings], Any]:
    """Return a maker of copies of a function, one for each run."""

    def make(run: Bindings) -> Any:
        copy = FunctionType(function.__code__, function.__globals__, function.__name__, function.__defaults__)
        copy.__qualname__, copy.__doc__ = function.__qualname__, function.__doc__
        return copy

    return make


def _preloaded(run: Bindings) -> Facade:
    """Return the object of `copy` and `elicopy`."""
    names = run.names
    return names.get("copy") or names.get("elicopy") or _preloaded_copy(run.shelf)


def _preloaded_copy(shelf: ModuleShelf) -> Facade:
    """`copy` and `elicopy`, which programs use without importing; the module itself is loaded at the first call."""

    def copy(x: Any) -> Any:
        """Return a shallow copy."""
        return vars(shelf.facade("copy"))["copy"](x)

    def deepcopy(x: Any, memo: Any = None) -> Any:
        """Return a copy of the value and of all that it holds."""
        return vars(shelf.facade("copy"))["deepcopy"](x, memo)

    for function in (copy, deepcopy):
        function.__qualname__ = function.__name__
    return Facade("copy", {"copy": copy, "deepcopy": deepcopy})


def _line(context: Context) -> Callable[..., None]:
    def mark(number: Any, label: Any, after: Any = None) -> None:
        """The program has reached a `$ LINE` mark; the third element says that the node is behind it."""
        context.mark(int(number), str(label))

    return mark


_LONG: Final = frozenset({"open", "print"})
"""Names of functions that are no commands, and whose calls may take long."""

_MADE: Final[dict[str, Callable[[Bindings], Any]]] = {
    **{name: partial(_refusal, name) for name in REFUSED_BUILTINS},
    **{name: partial(_group, name) for name in _GROUPS},
    "KeyboardInterrupt": lambda run: _stand_in("KeyboardInterrupt"),
    "copy": _preloaded,
    "delattr": _copy_of(checked_delattr),
    "dir": _copy_of(checked_dir),
    "elicopy": _preloaded,
    "eval": lambda run: run.evaluate,
    "exec": lambda run: run.execute,
    "exit": lambda run: _leaving(run.context, "exit"),
    "getattr": lambda run: getattr_over(attribute_hook(run.identities)),
    "hasattr": _copy_of(checked_hasattr),
    "hash": lambda run: _hash(run.identities),
    "id": lambda run: _id(run.identities),
    "input": _copy_of(_input),
    "iter": lambda run: iter_until(steps_of(run.context.scheduler), lambda: run.shelf.copy("copy")),
    "open": lambda run: _open(run.files),
    "print": lambda run: _print(run.context),
    "quit": lambda run: _leaving(run.context, "quit"),
    "setattr": _copy_of(checked_setattr),
    "type": _type,
}
"""Makers of the names that each run has for itself."""
