"""A command is one decorated function; everything else about it is derived from that function.

The signature gives names, order and defaults; the annotations give type, shape, unit and range; the
docstring gives the texts. All of it is evaluated on first use, because most programs use few
commands and start-up time counts.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from math import hypot
from typing import TYPE_CHECKING, Any, Final, TypeVar, get_args

from elitescript.commands.definition.quantities import Anything, Optionally, Quantity, Vector
from elitescript.commands.definition.results import COMPUTED, Result
from elitescript.errors import ArgumentCountError, InternalError, ScriptError, ScriptStateError, UsageError
from elitescript.messages.motion import FARTHEST_REACH_M, TOWARDS_M
from elitescript.messages.profile import release_of
from elitescript.records import NamedTuple
from elitescript.said import Said, counted, said

if TYPE_CHECKING:
    from elitescript.commands.definition.plausibility import Doubt, Judge

Function = TypeVar("Function", bound=Callable[..., Any])

REQUIRED: Final = object()
"""Default of a parameter that has none."""

NO_DOCSTRINGS: Final = (
    "commands are described by their docstrings, which Python leaves out with -OO or PYTHONOPTIMIZE=2, and the source "
    "is not installed: take -O or 1"
)

EVIDENCE: Final = ("documented", "observed", "assumed")

_TARGET_REFUSALS: Final = ("R102", "R110", "R111")
_TARGET_DOUBTS: Final = ("W230", "W231", "W233", "W237")
"""Refusals of a target or load, and the doubts that can explain them."""

NO_ARGUMENTS: Final[Mapping[str, str]] = {}

_OMITTED: Final = object()
FORMS_MAX: Final = 64
"""Forms of calls of a command that are kept; a program writes few."""
_VARIADIC: Final = 0x04
"""Flag of a code object whose function takes `*more` (`inspect.CO_VARARGS`, without importing it)."""

_PURE_FAMILIES: Final = frozenset(("kinematics", "lists", "maths", "poses", "strings"))
_READING: Final = ("get_", "is_", "read_")
_ALSO_READING: Final = frozenset(
    """
    cal_rpy_frame controller_timestamp encoder_get_tick_count encoder_unwind_delta_tick_count force modbus_get_error
    modbus_get_signal_status modbus_get_time_since_signal_invalid path_offset_get serial_is_open serial_mode
    socket_is_connected tool_serial_is_open tool_serial_mode
    """.split()  # noqa: SIM905
)
_CHANGING: Final = frozenset(("random", "get_micro_line_values_by_index"))
"""`random` gives another value each time; the other one belongs to a file that is loaded."""


_HANDLED: Final = ("stop_thread", "join_thread")


class Param:
    """One parameter of a command."""

    __slots__ = ("default", "default_value", "name", "quantity", "spellings", "text")

    def __init__(self, name: str, quantity: Quantity, default: Any, spellings: tuple[str, ...], text: str) -> None:
        self.name = name
        self.quantity = quantity
        self.default = default
        """As the function has it; `REQUIRED` when a call must pass the parameter."""
        self.default_value = default if default is REQUIRED else quantity.coerce(default)
        """What the function gets when a call leaves the parameter out."""
        self.spellings = spellings
        """Other keyword spellings that manuals or programs use."""
        self.text = text

    @property
    def is_required(self) -> bool:
        """Whether a call must pass it."""
        return self.default is REQUIRED

    @property
    def default_text(self) -> str:
        """The default as the manual prints it; empty when there is none."""
        if self.is_required:
            return ""
        if self.default is None and isinstance(self.quantity, Optionally):
            return repr(self.quantity.placeholder)
        if isinstance(self.default, tuple) and self.default:
            return repr(list(self.default))
        return repr(self.default)


class Misfit(NamedTuple):
    """A reason for which a call cannot be made."""

    at: int | str | None
    """Index or keyword of the argument that is wrong; None if one is missing."""
    text: str


class Placement(NamedTuple):
    """The arguments of a call, by parameter."""

    slots: tuple[int | str | None, ...]
    """For each parameter the index or the keyword of its argument; None if the call leaves it out."""
    misfits: tuple[Misfit, ...]


SPELLINGS: Final = {
    "addr": ("address",),
    "address": ("addr",),
    "p": ("pose",),
    "p_from": ("p_fom",),
    "pose": ("p",),
    "qNear": ("qnear",),
    "qnear": ("qNear",),
    "signal_name": ("singal_name", "ignal_name"),
    "signal_type": ("singal_type",),
    "time_out": ("timeout",),
    "timeout": ("time_out",),
    "update_frequency": ("update_freqency",),
}
"""Spellings of a parameter in the manuals, misprints included: every command accepts all of them."""


class Command:
    """One name of the catalogue; see `command` for the fields.

    An alias is a `Command` of its own, so that messages repeat the name that the script used.
    """

    __slots__ = (
        "_details",
        "alias_of",
        "aliases",
        "arguments",
        "evidence",
        "family",
        "function",
        "is_simulated",
        "manual",
        "name",
        "since",
        "spellings",
        "takes_more",
        "takes_profile",
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
        manual: str = "",
        arguments: Mapping[str, str] = NO_ARGUMENTS,
    ) -> None:
        self.name = function.__name__
        if evidence not in EVIDENCE:
            raise InternalError(f"{self.name}: evidence {evidence!r} is not one of {EVIDENCE}")
        release_of(since)
        self.alias_of = ""
        """Name of the command that this is another name of; empty for the command itself."""
        self.function = function
        self.family = family
        self.since = since
        self.aliases = aliases
        self.arguments = arguments
        """Texts of parameters that the docstring does not describe, by name."""
        self.spellings = spellings
        self.evidence = evidence
        self.waits = waits
        self.works_in_sec = works_in_sec
        self.is_simulated = is_simulated
        self.manual = manual
        code = function.__code__
        first = code.co_varnames[0] if code.co_argcount else ""
        self.takes_robot = first == "robot"
        self.takes_profile = first == "profile"
        """Whether its result depends on the firmware beside its arguments."""
        self.takes_more = bool(code.co_flags & _VARIADIC)
        """Whether arguments beyond the signature are passed on as they are."""
        self._details: _Details | None = None

    def renamed(self, name: str, since: str = "", evidence: str = "") -> Command:
        """Return the same command under another name."""
        other: Command = object.__new__(type(self))
        for slot in self.__slots__:
            setattr(other, slot, getattr(self, slot))
        other.name, other.alias_of, other.aliases = name, self.name, ()
        other.since, other.evidence = since or self.since, evidence or self.evidence
        return other

    @property
    def details(self) -> _Details:
        """Signature, annotations and docstring, evaluated once."""
        if self._details is None:
            self._details = _Details(self)
        return self._details

    @property
    def params(self) -> tuple[Param, ...]:
        """Parameters in order, without the robot."""
        return self.details.params

    @property
    def signature(self) -> str:
        """The call as the manual prints it."""
        parts = (param.name if param.is_required else f"{param.name}={param.default_text}" for param in self.params)
        return f"{self.name}({', '.join(parts)})"

    @property
    def only_gives_a_value(self) -> bool:
        """Whether it changes nothing, so that a call of it is made for its result alone."""
        if self.waits or self.name in _CHANGING:
            return False
        module = self.function.__module__.rpartition(".")[2]
        return module in _PURE_FAMILIES or self.name in _ALSO_READING or self.name.startswith(_READING)

    @property
    def call_hint(self) -> str:
        """What to do about a wrong call."""
        return said("it is called as {signature}", signature=self.signature)

    def hint_about(self, value: object) -> str:
        """Return what to do about a value that the command refuses: what is commonly meant, or how it is called."""
        if self.name in _HANDLED and callable(value):
            name = getattr(value, "__name__", repr(value))
            return said(
                "{name} takes what start_thread has returned: h = start_thread({function}, ())",
                name=self.name,
                function=name if name.isidentifier() else "f",
            )
        return self.call_hint

    def bind(self, args: tuple[Any, ...], kwargs: dict[str, Any]) -> list[Any]:
        """Put arguments in order, fill in defaults, coerce and check.

        Raises:
            ScriptError: complete with command, argument, value, limit and unit.
        """
        details = self._details or self.details
        coercions = details.coercions
        values: list[Any] = []
        if kwargs and (len(args), *kwargs) in details.ordered:
            args, kwargs = (*args, *kwargs.values()), {}
        try:
            if len(args) == len(coercions) and not kwargs:
                for coerce, value in zip(coercions, args):  # noqa: B905  a keyword costs as much as one argument
                    values.append(coerce(value))
                return values
            if not kwargs and details.required <= len(args) <= len(coercions):
                given = [*args, *[_OMITTED] * (len(coercions) - len(args))]
            else:
                given = self._arrange(args, kwargs)
            for param, value in zip(details.params, given, strict=False):
                values.append(param.default_value if value is _OMITTED else param.quantity.coerce(value))
            return values + given[len(values) :]
        except ScriptError as error:
            if error.command is None:
                error.command = self.name
                error.argument = argument = details.params[len(values)].name
                text = f"{self.name}: {argument} {error.args[0]}"
                error.put_into(text, "{command}: {argument} {mistake}", command=self.name, argument=argument)
            raise

    def call(self, robot: Any, args: tuple[Any, ...], kwargs: dict[str, Any]) -> Any:
        """Bind and run; tuples come back as the lists that scripts expect.

        Raises:
            ScriptError: bad arguments, a call that a secondary program may not make, or the command's own refusal.
        """
        if not self.works_in_sec and robot is not None and robot.is_secondary:
            text = said("{name} moves or waits, which a secondary program (sec) may not do", name=self.name)
            raise ScriptStateError(text, code="R120", command=self.name)
        values = self.bind(args, kwargs)
        details = self._details or self.details
        doubts = None
        if details.judged and robot is not None and (doubts := self._doubts(robot, values)):
            robot.hold_doubts(doubts)
        try:
            if self.takes_robot:
                result = self.function(robot, *values)
            elif self.takes_profile:
                result = self.function(robot.profile, *values)
            else:
                result = self.function(*values)
        except ScriptError as error:
            if error.command is None:
                error.command = self.name
                error.put_into(f"{self.name}: {error.args[0]}", "{command}: {mistake}", command=self.name)
            if doubts:
                # One finding about one argument: the refusal, with the hint of the doubt.
                robot.hold_doubts(())
                if error.code in _TARGET_REFUSALS:
                    error.hint = next((doubt.hint for doubt in doubts if doubt.code in _TARGET_DOUBTS), error.hint)
            raise
        if doubts:
            robot.tell_doubts()
        if details.kind and robot is not None:
            robot.remember(details.kind, result)
        return _as_script_value(result) if type(result) is tuple else result

    def _doubts(self, robot: Any, values: list[Any]) -> list[Doubt]:
        """Return the doubts about values that are legal but hardly meant, with command and parameter in the text."""
        found = []
        for index, param, judge, is_kind in self.details.judged:
            value = values[index]
            if value is None or value is param.default_value:
                continue
            doubts = list(judge(value, robot.machine))
            if self.name == "movel":
                doubts = [doubt for doubt in doubts if not _is_direction(value, doubt)]
            if is_kind and (other := robot.mistaken(param.quantity.meaning, value)) is not None:
                doubts.append(other)
            found += [
                doubt._replace(
                    text=said("{command}: {argument}{doubt}", command=self.name, argument=param.name, doubt=doubt.text)
                )
                for doubt in doubts
            ]
        return found

    def place(self, positional: int, keywords: Sequence[str], *, is_complete: bool = True) -> Placement:
        """Match the arguments of a call with the parameters, for the run and for the checker.

        Args:
            positional: number of arguments without a keyword.
            keywords: keywords of the others, in the order of the call.
            is_complete: False if the call may have more arguments than these, such as `*list`; none is missing then.
        """
        params, indices, required = self.details.params, self.details.indices, self.details.required
        slots: list[int | str | None] = [*range(min(positional, len(params))), *[None] * (len(params) - positional)]
        misfits: list[Misfit] = []
        if positional > len(params) and not self.takes_more:
            allowed = counted(len(params), "argument", "arguments") if params else Said("no arguments")
            if required != len(params):
                allowed = said("at most {arguments}", arguments=allowed)
            misfits.append(
                Misfit(
                    len(params),
                    said(
                        "{name} takes {allowed}, got {positional}",
                        name=self.name,
                        allowed=allowed,
                        positional=positional,
                    ),
                )
            )
        for keyword in keywords:
            index = indices.get(keyword)
            if index is None:
                names = ", ".join(param.name for param in params) or "none"
                misfits.append(
                    Misfit(
                        keyword,
                        said(
                            "{name} has no argument `{keyword}`; its arguments: {names}",
                            name=self.name,
                            keyword=keyword,
                            names=names,
                        ),
                    )
                )
            elif slots[index] is not None:
                misfits.append(
                    Misfit(
                        keyword,
                        said(
                            "{name} gets the argument `{argument}` twice",
                            name=self.name,
                            argument=params[index].name,
                        ),
                    )
                )
            else:
                slots[index] = keyword
        # A misspelt keyword is reported; that its parameter is missing then follows.
        if is_complete and not misfits and None in slots[:required]:
            missing = [f"`{params[index].name}`" for index in range(required) if slots[index] is None]
            plural = "" if len(missing) == 1 else "s"
            misfits.append(
                Misfit(
                    None,
                    said(
                        "{name} misses the argument{plural} {missing}",
                        name=self.name,
                        plural=plural,
                        missing=", ".join(missing),
                    ),
                )
            )
        return Placement(tuple(slots), tuple(misfits))

    def _arrange(self, args: tuple[Any, ...], kwargs: dict[str, Any]) -> list[Any]:
        """Return the arguments in the order of the parameters, `_OMITTED` where one is left out."""
        form: tuple[int | str, ...] = (len(args), *kwargs)
        forms = self.details.forms
        slots = forms.get(form)
        if slots is None:
            slots, misfits = self.place(len(args), tuple(kwargs))
            if misfits:
                raise ArgumentCountError(misfits[0].text, command=self.name, hint=self.call_hint)
            if len(forms) < FORMS_MAX:
                forms[form] = slots
                if slots[: len(args) + len(kwargs)] == (*range(len(args)), *kwargs):
                    self.details.ordered.add(form)
        values = [_OMITTED if slot is None else kwargs[slot] if isinstance(slot, str) else args[slot] for slot in slots]
        return [*values, *args[len(values) :]]


def _as_script_value(result: tuple[Any, ...]) -> list[Any]:
    """Return a tuple, also tuples inside it, as lists."""
    return [_as_script_value(item) if type(item) is tuple else item for item in result]


class _Details:
    """Signature, annotations and docstring of a command, evaluated."""

    __slots__ = (
        "behaviour",
        "coercions",
        "forms",
        "indices",
        "judged",
        "kind",
        "ordered",
        "params",
        "raises",
        "required",
        "result",
        "returns",
        "returns_text",
        "summary",
    )

    def __init__(self, command: Command) -> None:
        from elitescript.commands.definition.docstring import docstring_of, read_docstring

        function = command.function
        text = docstring_of(function)
        if not text and sys.flags.optimize > 1:
            raise UsageError(NO_DOCSTRINGS)
        doc = read_docstring(text)
        self.summary = doc.summary
        self.behaviour = doc.behaviour
        self.raises = doc.raises
        texts = {**command.arguments, **doc.args}
        names = function.__code__.co_varnames[: function.__code__.co_argcount]
        defaults = function.__defaults__ or ()
        first_default = len(names) - len(defaults)
        params = []
        for index, name in enumerate(names):
            if index == 0 and (command.takes_robot or command.takes_profile):
                continue
            quantity = _quantity(function, name)
            if quantity is None or name not in texts:
                raise InternalError(f"{command.name}: parameter {name!r} lacks a quantity or its line under Args")
            default = defaults[index - first_default] if index >= first_default else REQUIRED
            spellings = tuple(other for other, own in command.spellings.items() if own == name)
            spellings += tuple(other for other in SPELLINGS.get(name, ()) if other not in names)
            params.append(Param(name, quantity, default, spellings, texts[name]))
        self.params = tuple(params)
        self.coercions = tuple(param.quantity.coerce for param in params)
        self.required = sum(param.is_required for param in params)
        """How many parameters every call must pass; they are the first ones."""
        self.indices = {name: index for index, param in enumerate(params) for name in (param.name, *param.spellings)}
        """Index of the parameter that a keyword means."""
        self.forms: dict[tuple[int | str, ...], tuple[int | str | None, ...]] = {}
        """Slots of calls that were right, by their number of arguments and their keywords; see `Command.place`."""
        self.ordered: set[tuple[int | str, ...]] = set()
        """Those of `forms` whose arguments are in the order of the first parameters: they are bound by position."""
        self.returns = _quantity(function, "return") or Anything("None")
        elements = self.returns.names if isinstance(self.returns, Vector) else ""
        self.result = _result(function)
        """Where the result comes from, and what its values stand for."""
        texts_of_result = (doc.returns or (f"{elements}." if elements else ""), self.result.text)
        self.returns_text = " ".join(text for text in texts_of_result if text)
        self.judged = _judged(self.params)
        """Index, parameter, judge, and whether it is joints or a pose; see `plausibility`."""
        self.kind = self.returns.meaning if self.returns.meaning in ("joints", "pose") else ""
        """Kind of a returned list: `joints` or `pose`; empty for others."""


def _is_direction(target: Any, doubt: Doubt) -> bool:
    """Return whether a doubtful target of `movel` is a direction as scripts of the pendant compute it: 1000 m away."""
    return doubt.code == "W231" and abs(hypot(*target[:3]) - TOWARDS_M) <= FARTHEST_REACH_M


def _judged(params: tuple[Param, ...]) -> tuple[tuple[int, Param, Judge, bool], ...]:
    if not any(param.quantity.meaning for param in params):
        return ()
    from elitescript.commands.definition.plausibility import JUDGES, KINDS

    return tuple(
        (index, param, JUDGES[param.quantity.meaning], param.quantity.meaning in KINDS)
        for index, param in enumerate(params)
        if param.quantity.meaning
    )


def _extras(function: Callable[..., Any], name: str) -> tuple[Any, ...]:
    """Return what an annotation says beside the type."""
    annotation = function.__annotations__.get(name)
    if isinstance(annotation, str):
        annotation = eval(annotation, function.__globals__)  # our own source text, from this package
    return get_args(annotation)[1:]


def _quantity(function: Callable[..., Any], name: str) -> Quantity | None:
    return next((extra for extra in _extras(function, name) if isinstance(extra, Quantity)), None)


def _result(function: Callable[..., Any]) -> Result:
    return next((extra for extra in _extras(function, "return") if isinstance(extra, Result)), COMPUTED)


class Catalogue:
    """All commands, by name and by alias."""

    __slots__ = ("_by_name", "_commands")

    def __init__(self) -> None:
        self._commands: dict[str, Command] = {}
        self._by_name: dict[str, Command] = {}

    def add(self, command: Command) -> None:
        """Register a command under its name and its aliases."""
        self._name(command)
        self._commands[command.name] = command
        for name in command.aliases:
            self._name(command.renamed(name))

    def add_alias(self, name: str, of: str, since: str = "", evidence: str = "") -> None:
        """Register another name of a command that is registered already."""
        command = self._commands[of]
        self._name(command.renamed(name, since, evidence))
        command.aliases = (*command.aliases, name)

    def _name(self, command: Command) -> None:
        if command.name in self._by_name:
            raise InternalError(f"two commands are called {command.name!r}")
        self._by_name[command.name] = command

    def get(self, name: str) -> Command | None:
        """Return the command of that name or alias."""
        return self._by_name.get(name)

    def names(self) -> Iterator[str]:
        """Return every name and alias that scripts can call."""
        return iter(self._by_name)

    def __iter__(self) -> Iterator[Command]:
        """Return the commands, each once, without the aliases."""
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
    manual: str = "",
    arguments: Mapping[str, str] = NO_ARGUMENTS,
) -> Callable[[Function], Function]:
    """Register the decorated function as a robot command.

    A first parameter called `robot` receives the `Robot` context, one called `profile` that of the firmware; neither is
    part of the script's signature. `*more` receives what a call passes beyond the signature.

    Args:
        family: chapter of the manual; see `page.CHAPTERS`.
        since: firmware release that brought it, such as `"2.14"`.
        aliases: other names of the same command, as old and as well known as the command (else: `alias`).
        spellings: other keyword spellings, each with the parameter it stands for.
        evidence: `documented` (manual), `observed` (real programs, clients) or `assumed`.
        waits: whether a call can take time.
        works_in_sec: whether a secondary program may call it.
        is_simulated: False for a command whose body checks what it can and then raises `NotSimulatedError`.
        manual: section of manual 2.10, such as `"2.1.1"`; of another one with its release, such as `"2.14: 3.1.25"`.
        arguments: texts of parameters that several commands share, for those that the docstring does not describe.
    """

    def register(function: Function) -> Function:
        REGISTRY.add(
            Command(
                function,
                family,
                since,
                aliases,
                spellings or {},
                evidence,
                waits,
                works_in_sec,
                is_simulated,
                manual,
                arguments,
            )
        )
        return function

    return register


def alias(name: str, *, of: str, since: str = "", evidence: str = "") -> None:
    """Give a command another name, with its own release and evidence where they differ."""
    REGISTRY.add_alias(name, of, since, evidence)
