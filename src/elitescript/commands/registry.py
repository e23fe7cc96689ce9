"""A command is one decorated function; everything else about it is derived from that function.

The signature gives names, order and defaults; the annotations give type, shape, unit and range; the
docstring gives the words. Nothing of it is worked out before somebody asks, because most programs
use few commands and all of them start often.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, Final, TypeVar, get_args

from elitescript.commands.quantities import Anything, Quantity, shown
from elitescript.errors import ArgumentCountError, InternalError, NotSimulatedError, ScriptError
from elitescript.messages.profile import release_of

Function = TypeVar("Function", bound=Callable[..., Any])

REQUIRED: Final = object()
"""Default of a parameter that has none."""

EVIDENCE: Final = ("documented", "observed", "assumed")


class Param:
    """One parameter of a command."""

    __slots__ = ("default", "name", "quantity", "spellings", "text")

    def __init__(self, name: str, quantity: Quantity, default: Any, spellings: tuple[str, ...], text: str) -> None:
        self.name = name
        self.quantity = quantity
        self.default = default
        self.spellings = spellings
        """Other keyword spellings that manuals or programs use."""
        self.text = text

    @property
    def is_required(self) -> bool:
        """Whether a call must pass it."""
        return self.default is REQUIRED


class Command:
    """One entry of the catalogue; see `command` for the fields."""

    __slots__ = (
        "_details",
        "aliases",
        "evidence",
        "family",
        "function",
        "is_simulated",
        "name",
        "since",
        "spellings",
        "takes_robot",
        "waits",
        "works_in_sec",
    )

    def __init__(
        self,
        function: Callable[..., Any],
        family: str,
        since: str,
        aliases: tuple[str, ...],
        spellings: dict[str, str],
        evidence: str,
        waits: bool,
        works_in_sec: bool,
        is_simulated: bool,
    ) -> None:
        if evidence not in EVIDENCE:
            raise InternalError(f"{function.__name__}: evidence {evidence!r} is not one of {EVIDENCE}")
        self.name = function.__name__
        self.function = function
        self.family = family
        self.since = since
        self.aliases = aliases
        self.spellings = spellings
        self.evidence = evidence
        self.waits = waits
        self.works_in_sec = works_in_sec
        self.is_simulated = is_simulated
        code = function.__code__
        self.takes_robot = code.co_argcount > 0 and code.co_varnames[0] == "robot"
        self._details: _Details | None = None

    @property
    def details(self) -> _Details:
        """Signature, annotations and docstring, worked out once."""
        if self._details is None:
            self._details = _Details(self)
        return self._details

    @property
    def params(self) -> tuple[Param, ...]:
        """Parameters in order, without the robot."""
        return self.details.params

    @property
    def summary(self) -> str:
        """First line of the docstring."""
        return self.details.summary

    @property
    def signature(self) -> str:
        """The call as the manual prints it."""
        parts = []
        for param in self.params:
            parts.append(param.name if param.is_required else f"{param.name}={param.default!r}")
        return f"{self.name}({', '.join(parts)})"

    def bind(self, args: tuple[Any, ...], kwargs: dict[str, Any]) -> list[Any]:
        """Put arguments in order, fill in defaults, coerce and check.

        Raises:
            ScriptError: complete with command, argument, value, limit and unit.
        """
        params = self.params
        if len(args) > len(params):
            raise self._count_error(f"takes {_arguments(len(params))}, got {len(args)}")
        values: list[Any] = list(args)
        for param in params[len(args) :]:
            value = REQUIRED
            for spelling in (param.name, *param.spellings):
                if kwargs and spelling in kwargs:
                    if value is not REQUIRED:
                        raise self._count_error(f"got the argument {param.name!r} twice")
                    value = kwargs[spelling]
            if value is REQUIRED and param.is_required:
                raise self._count_error(f"misses the argument {param.name!r}; it is called as {self.signature}")
            values.append(param.default if value is REQUIRED else value)
        if kwargs:
            self._refuse_strangers(len(args), kwargs)
        for index, param in enumerate(params):
            value = values[index]
            if value is param.default:
                continue
            try:
                values[index] = param.quantity.coerce(value)
            except ScriptError as error:
                error.command = self.name
                error.argument = param.name
                error.args = (f"{self.name}: {param.name} {error.args[0]}",)
                raise
        return values

    def call(self, robot: Any, args: tuple[Any, ...], kwargs: dict[str, Any]) -> Any:
        """Bind and run; tuples come back as the lists that scripts expect."""
        values = self.bind(args, kwargs)
        if not self.is_simulated:
            raise NotSimulatedError(f"{self.name} is not simulated yet", command=self.name)
        try:
            result = self.function(robot, *values) if self.takes_robot else self.function(*values)
        except ScriptError as error:
            if error.command is None:
                error.command = self.name
                error.args = (f"{self.name}: {error.args[0]}",)
            raise
        return list(result) if type(result) is tuple else result

    def _count_error(self, text: str) -> ScriptError:
        return ArgumentCountError(f"{self.name} {text}", command=self.name)

    def _refuse_strangers(self, positional: int, kwargs: dict[str, Any]) -> None:
        spelled = {spelling: param.name for param in self.params for spelling in (param.name, *param.spellings)}
        given = {param.name for param in self.params[:positional]}
        for keyword in kwargs:
            if keyword not in spelled:
                names = ", ".join(param.name for param in self.params) or "none"
                raise self._count_error(f"has no argument {keyword!r}; its arguments: {names}")
            if spelled[keyword] in given:
                raise self._count_error(f"got the argument {spelled[keyword]!r} twice")


def _arguments(count: int) -> str:
    return "no arguments" if count == 0 else "1 argument" if count == 1 else f"at most {count} arguments"


class _Details:
    """What the function's own text says about a command."""

    __slots__ = ("behaviour", "params", "returns", "returns_text", "summary")

    def __init__(self, command: Command) -> None:
        from elitescript.commands.docstring import read_docstring

        function = command.function
        doc = read_docstring(function.__doc__ or "")
        self.summary = doc.summary
        self.behaviour = doc.behaviour
        self.returns_text = doc.returns
        names = function.__code__.co_varnames[: function.__code__.co_argcount]
        defaults = function.__defaults__ or ()
        first_default = len(names) - len(defaults)
        params = []
        for index, name in enumerate(names):
            if index == 0 and command.takes_robot:
                continue
            quantity = _quantity(function, name)
            if quantity is None or name not in doc.args:
                raise InternalError(f"{command.name}: parameter {name!r} lacks a quantity or its line under Args")
            default = defaults[index - first_default] if index >= first_default else REQUIRED
            spellings = tuple(other for other, own in command.spellings.items() if own == name)
            params.append(Param(name, quantity, default, spellings, doc.args[name]))
        self.params = tuple(params)
        self.returns = _quantity(function, "return") or Anything("None")


def _quantity(function: Callable[..., Any], name: str) -> Quantity | None:
    annotation = function.__annotations__.get(name)
    if isinstance(annotation, str):
        annotation = eval(annotation, function.__globals__)  # our own source text, from this package
    for extra in get_args(annotation)[1:]:
        if isinstance(extra, Quantity):
            return extra
    return None


class Catalogue:
    """All commands, by name and by alias."""

    __slots__ = ("_by_name", "_commands")

    def __init__(self) -> None:
        self._commands: dict[str, Command] = {}
        self._by_name: dict[str, Command] = {}

    def add(self, command: Command) -> None:
        """Register a command under its name and its aliases."""
        self._commands[command.name] = command
        for name in (command.name, *command.aliases):
            if name in self._by_name:
                raise InternalError(f"two commands are called {name!r}")
            self._by_name[name] = command

    def get(self, name: str) -> Command | None:
        """The command of that name or alias."""
        return self._by_name.get(name)

    def names(self) -> Iterator[str]:
        """Every name and alias that scripts can call."""
        return iter(self._by_name)

    def __iter__(self) -> Iterator[Command]:
        return iter(self._commands.values())

    def __len__(self) -> int:
        return len(self._commands)


REGISTRY: Final = Catalogue()
"""Filled when `elitescript.commands.catalogue` is imported; read it from there."""


def command(
    *,
    family: str,
    since: str = "2.10",
    aliases: tuple[str, ...] = (),
    spellings: dict[str, str] | None = None,
    evidence: str = "documented",
    waits: bool = False,
    works_in_sec: bool = True,
    is_simulated: bool = True,
) -> Callable[[Function], Function]:
    """Make the function below a robot command.

    A first parameter called `robot` receives the `Robot` context and is not part of the script's signature.

    Args:
        family: chapter of the manual.
        since: firmware release that brought it, such as `"2.14"`.
        aliases: other names of the same command.
        spellings: other keyword spellings, each with the parameter it stands for.
        evidence: how we know: `documented` (manual), `observed` (real programs, clients) or `assumed`.
        waits: whether a call can take time.
        works_in_sec: whether a secondary program may call it.
        is_simulated: False for a command that is known but raises `NotSimulatedError`.
    """
    release_of(since)

    def register(function: Function) -> Function:
        REGISTRY.add(
            Command(function, family, since, aliases, spellings or {}, evidence, waits, works_in_sec, is_simulated)
        )
        return function

    return register


def describe_call(command_name: str, args: tuple[Any, ...], kwargs: dict[str, Any]) -> str:
    """A call as a message repeats it."""
    parts = [shown(arg) for arg in args] + [f"{name}={shown(value)}" for name, value in kwargs.items()]
    return f"{command_name}({', '.join(parts)})"
