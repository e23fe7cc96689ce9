"""Everything that a robot is made with, each option written once.

A field of `RobotOptions` is an option: its name, type and default stand there as in any dataclass, and `option` adds
its help text, the values it takes, and its flag on the command line. Derived from it: arguments of `run`, `plot`,
`check` and `serve` (`cli.robot_options`), the section `[robot]` of world files (`world_file`), signature and docstring
of `VirtualRobot` (`kernel.option_signature`), the types of its keywords (`kernel.option_keywords`) and the page
docs/reference/options.md; the last two are written by `make reference`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib import import_module
from math import inf, isfinite
from operator import index
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from elitescript.controller.modes import AT_ONCE, REALISTIC, PowerTimes
from elitescript.errors import CODES, UsageError, did_you_mean
from elitescript.messages.motion import Six
from elitescript.messages.profile import (
    BRACKETED,
    DEFAULT_FIRMWARE,
    PROFILES,
    PUBLISHED,
    QUERY_FORMS,
    version_of,
    version_text,
)
from elitescript.messages.signals import Value
from elitescript.messages.timing import HELD_UP_MAX_S, RPC_TIMEOUT_S, WORK_PER_TICK, ticks_for
from elitescript.records import NamedTuple, field, fields_of, record

if TYPE_CHECKING:
    from elitescript.controller.force.contact import ContactConfig
    from elitescript.controller.safety.limits import SafetyLimits
    from elitescript.messages.faults import ChannelFault
    from elitescript.messages.machine import DisturbInput
    from elitescript.messages.plant import PlantConfig

ROBOT_SECTION: Final = "robot"
"""Section of a world file that sets options by their names."""

# ---------------------------------------------------------------- kinds of values
#
# The text of a kind describes its values. `accept` returns a value in the form in which options hold it, or raises
# `UsageError` with a text that begins with `must be`.


class Number(NamedTuple):
    """Finite numbers from `low` to `high`, in an SI unit."""

    low: float = -inf
    high: float = inf
    unit: str = ""

    def __str__(self) -> str:
        if isfinite(self.low) and isfinite(self.high):
            return f"in [{self.low:g}, {self.high:g}] {self.unit}".rstrip()
        return f"a number in {self.unit}" if self.unit else "a number"

    def accept(self, value: Any) -> float:
        try:
            number = None if isinstance(value, bool | str | bytes) else float(value)
        except (TypeError, ValueError, OverflowError):
            number = None
        if number is None:
            raise UsageError(f"must be a number{f' in {self.unit}' if self.unit else ''}, got {value!r}")
        if not isfinite(number):
            raise UsageError(f"must be finite{f', in {self.unit}' if self.unit else ''}, got {value!r}")
        if not self.low <= number <= self.high:
            raise UsageError(f"must be {self}, got {value!r}")
        return number


YEAR_1_S: Final = -62_135_596_800.0
YEAR_9999_S: Final = 253_402_300_799.0
"""First and last second that has a date, s since 1970."""


class Duration:
    """Times from 0 s on; infinity stands for no limit."""

    __slots__ = ()

    def __str__(self) -> str:
        return ">= 0 s"

    def accept(self, value: Any) -> float:
        try:
            number = None if isinstance(value, bool | str | bytes) else float(value)
        except (TypeError, ValueError, OverflowError):
            number = None
        if number is None:
            raise UsageError(f"must be a number in s, got {value!r}")
        if not number >= 0.0:
            raise UsageError(f"must be {self}, got {number:g}")
        return number


class Time(Number):
    """Moments: seconds since 1970, or `datetime` objects with a time zone."""

    __slots__ = ()

    def __str__(self) -> str:
        return "seconds since 1970, or a date and time with a time zone"

    def accept(self, value: Any) -> float:
        if hasattr(value, "year") and getattr(value, "tzinfo", None) is None:
            raise UsageError(f"must be {self}, got {value}")
        return super().accept(value.timestamp() if hasattr(value, "year") else value)


class Whole(NamedTuple):
    """Whole numbers from `low` on."""

    low: int | None = None

    def __str__(self) -> str:
        return "a whole number" if self.low is None else f"a whole number >= {self.low}"

    def accept(self, value: Any) -> int:
        number = index(value) if hasattr(value, "__index__") and not isinstance(value, bool) else None
        if number is None or (self.low is not None and number < self.low):
            raise UsageError(f"must be {self}, got {value!r}")
        return number


class Switch:
    """`True` and `False`."""

    __slots__ = ()

    def __str__(self) -> str:
        return "true or false"

    def accept(self, value: Any) -> bool:
        if not isinstance(value, bool):
            raise UsageError(f"must be {self}, got {value!r}")
        return value


class Text(NamedTuple):
    """Texts; those of `choices` if there are some."""

    choices: tuple[str, ...] = ()

    def __str__(self) -> str:
        return " or ".join(f'"{choice}"' for choice in self.choices) or "a text"

    def accept(self, value: Any) -> str:
        if not isinstance(value, str) or (self.choices and value not in self.choices):
            raise UsageError(f"must be {self}, got {value!r}")
        return value


class Network:
    """What programs reach outside of their world; see `environment.reach`."""

    __slots__ = ()

    def __str__(self) -> str:
        return '"none", "local", "all" or addresses such as "192.168.1.5:502,camera.local"'

    def accept(self, value: Any) -> str:
        if value in ("none", "local", "all"):
            return str(value)
        if not isinstance(value, str):
            raise UsageError(f"must be {self}, got {value!r}")
        # Few robots name addresses.
        from elitescript.environment.addresses import parse_values

        try:
            return ",".join(parse_values([value], "--network")[2])
        except UsageError as error:
            raise UsageError(f"must be {self}, got {value!r}: {str(error).partition(': ')[2]}") from None


class Codes:
    """Codes of findings, separated by commas. What keeps a text from starting cannot be named."""

    __slots__ = ()

    def __str__(self) -> str:
        return 'codes of findings such as "W230,N280"'

    def accept(self, value: Any) -> str:
        if not isinstance(value, str):
            raise UsageError(f"must be {self}, got {value!r}")
        codes = [code.strip().upper() for code in value.split(",") if code.strip()]
        for code in codes:
            if code not in CODES:
                raise UsageError(f"must be {self}, there is no code {code!r}")
            if code[:2] in ("E0", "E1") or code[0] == "R":
                raise UsageError(f"must be {self}, {code} ({CODES[code].title}) cannot be left out")
        return ",".join(codes)


class VersionText:
    """Versions of the controller as text, or an empty text."""

    __slots__ = ()

    def __str__(self) -> str:
        return f"a version such as {version_text(PUBLISHED)}"

    def accept(self, value: Any) -> str:
        if not isinstance(value, str):
            raise UsageError(f"must be {self}, got {value!r}")
        return version_text(version_of(value)) if value else ""


class Joints:
    """Six joint positions in rad, or None; their ranges are those of the model."""

    __slots__ = ()

    def __str__(self) -> str:
        return "six numbers in rad"

    def accept(self, value: Any) -> Six | None:
        if value is None:
            return None
        if isinstance(value, str | bytes) or not (hasattr(value, "__len__") and hasattr(value, "__iter__")):
            raise UsageError(f"must be {self}, got {value!r}")
        if len(value) != 6:
            raise UsageError(f"must be {self}, got {len(value)}")
        a, b, c, d, e, f = map(_RAD.accept, value)
        return (a, b, c, d, e, f)


class Section(NamedTuple):
    """Objects of a class that a section of a world file describes as well, under the name of the option; or None."""

    module: str
    name: str
    """Of the class, which has `from_table` and is imported on first use."""

    def __str__(self) -> str:
        return f"a `{self.name}`"

    def accept(self, value: Any) -> Any:
        if value is not None and not isinstance(value, self._class()):
            raise UsageError(f"must be {self}, got {value!r}")
        return value

    def from_table(self, table: Mapping[str, Any]) -> Any:
        """Return what the section of a world file describes.

        Raises:
            UsageError: a key or a value that makes no sense.
        """
        return self._class().from_table(table)

    def _class(self) -> Any:
        return getattr(import_module(self.module), self.name)


_RAD: Final = Number(unit="rad")

# ---------------------------------------------------------------- the options


class Option(NamedTuple):
    """What is known of an option besides name, type and default."""

    text: str
    """What it means, with the unit."""
    kind: Number | Whole | Switch | Text | Network | VersionText | Joints | Section | None = None
    """What values it takes; None for what only this package sets."""
    default_text: str = ""
    """The default in words, where the value says too little."""
    flag: str = ""
    """On the command line; empty if it has none."""
    metavar: str = ""
    """What stands behind the flag in help texts."""
    commands: tuple[str, ...] = ()
    """Commands that have the flag."""


def option(default: Any, *about: Any, **more: Any) -> Any:
    """Return the field of an option with this default; what follows is for `Option`."""
    return field(default=default, metadata={"option": Option(*about, **more)})


@record
class RobotOptions:
    """One robot. Together with the inputs of every tick it determines everything that the robot does.

    Raises:
        UsageError: a value that an option does not take.
    """

    model: str = option(
        "CS66",
        "arm: CS63 CS66 CS612 CS616 CS620 CS625, or a file my_arm.toml",
        Text(),
        flag="--robot",
        metavar="MODEL",
        commands=("run", "sweep", "plot", "check", "serve", "studio", "audit", "shadow"),
    )
    model_text: str = option("", "text of the file of an own arm; empty for a model of the package")
    firmware: str = option(
        DEFAULT_FIRMWARE,
        "controller firmware",
        Text(tuple(PROFILES)),
        flag="--firmware",
        commands=("run", "sweep", "plot", "check", "serve", "studio", "audit", "shadow"),
    )
    controller_version: str = option(
        "",
        "version that the robot reports to clients and programs; what it can do is that of the firmware",
        VersionText(),
        default_text=", ".join(f"{version_text(row.version)} of firmware {name}" for name, row in PROFILES.items()),
        flag="--controller-version",
        metavar="A.B.C.D",
        commands=("run", "serve"),
    )
    seed: int = option(
        0,
        "seed of random()",
        Whole(),
        flag="--seed",
        metavar="N",
        commands=("run", "plot", "serve", "audit", "shadow"),
    )
    first_tick: int = option(0, "number of the first tick; of a robot that goes on where another one ended")
    epoch_s: float = option(
        1_704_067_200.0,
        "controller clock at the start, s since 1970",
        Time(YEAR_1_S, YEAR_9999_S, "s"),
        default_text="2024-01-01T00:00:00Z; of serve, the present time",
        flag="--epoch",
        metavar="TIME",
        commands=("run", "sweep"),
    )
    joints: Six | None = option(
        None,
        "joint positions at the start, rad",
        Joints(),
        default_text="the model's home",
        flag="--joints",
        metavar="Q1,...,Q6",
        commands=("run", "sweep", "plot", "serve"),
    )
    speed: float = option(
        1.0,
        "speed slider as a fraction",
        Number(0.0, 1.0),
        flag="--speed",
        metavar="0..1",
        commands=("run", "sweep", "plot", "serve", "shadow"),
    )
    power_on: bool = option(
        False,
        "begin with power on and brakes released",
        Switch(),
        flag="--power-on",
        commands=("serve",),
    )
    power_times: PowerTimes = option(REALISTIC, "how long the arm takes to go up")
    remote: bool = option(
        True, "whether clients may change the robot at the start", Switch(), flag="--local", commands=("serve",)
    )
    robot_id: str = option("elitescript", "name of the robot that clients are shown", Text())
    serial_number: str = option("ES0000000001", "serial number that clients are shown", Text())
    query_form: str = option(
        BRACKETED,
        "form of the replies of the query port: `[ID] [success] : [VALUE]` without exponents, or `ID success : VALUE`",
        Text(QUERY_FORMS),
        flag="--query-form",
        commands=("serve",),
    )
    configuration: str = option(
        "default.configuration", "path of the configuration that is loaded at the start", Text()
    )
    safety: SafetyLimits | None = option(
        None, "what the safety system watches", Section("elitescript.controller.safety.limits", "SafetyLimits")
    )
    contact: ContactConfig | None = option(
        None, "planes that the TCP can touch", Section("elitescript.controller.force.contact", "ContactConfig")
    )
    plant: PlantConfig | None = option(
        None,
        "how the joints follow their targets",
        Section("elitescript.messages.plant", "PlantConfig"),
        default_text="exactly, unless an own arm has a `[plant]`",
    )
    signals: tuple[tuple[str, Value], ...] = option((), "levels at the start, by the names of `--set`")
    faults: tuple[ChannelFault | DisturbInput, ...] = option((), "what goes wrong on channels and at inputs")
    work_per_tick: int = option(
        WORK_PER_TICK,
        "loop passes and calls that a thread may make in one tick; how many the real controller makes is not known",
        Whole(1),
    )
    held_up_max_s: float = option(
        HELD_UP_MAX_S,
        "for how long calls of 10 ms and more may hold up a served robot, beyond 1 % of the time, before its program "
        "ends with R135; 0: for ever",
        Number(unit="s"),
    )
    rpc_timeout_s: float = option(
        RPC_TIMEOUT_S,
        "how long a remote procedure call waits for its answer; 0 waits for ever",
        Number(unit="s"),
        flag="--rpc-timeout",
        metavar="SECONDS",
        commands=("run", "sweep", "serve"),
    )
    network: str = option(
        "local",
        "what programs reach besides what is beside the robot in its world: none; local, the loopback addresses of "
        "this computer; HOST[:PORT],..., these as well; all",
        Network(),
        flag="--network",
        metavar="WHAT",
        commands=("run", "plot", "check"),
    )
    strict: bool = option(
        False,
        "refuse what only warns otherwise",
        Switch(),
        flag="--strict",
        commands=("run", "sweep", "check", "serve"),
    )
    ignore: str = option(
        "",
        "codes of findings that check and runs leave out, such as W230,N280; what ends a program cannot be left out",
        Codes(),
        flag="--ignore",
        metavar="CODES",
        commands=("run", "plot", "sweep", "check", "serve"),
    )
    compiles_elsewhere: bool = option(
        False, "whether long programs are compiled in another process, and begin when they come back from there"
    )
    reads_trees: bool = option(
        True, "whether a task is run from the tree in its file; journals of versions that did not are replayed without"
    )
    confirms_popups: bool = option(
        False, "confirm popups that block at once; if not, a client of the dashboard does", Switch()
    )

    @property
    def ignored(self) -> frozenset[str]:
        """The codes of `ignore`."""
        return frozenset(self.ignore.split(",")) if self.ignore else frozenset()

    def __post_init__(self) -> None:
        for name, kind in _CHECKED.items():
            given = getattr(self, name)
            if (held := accepted(kind, given, name)) is not given:
                object.__setattr__(self, name, held)


UNTIL: Final = Duration()
"""What limits of the time of a run may be: `--until`, `--max-wall`, `until_s`, `until` of a launch."""

OPTIONS: Final[dict[str, Option]] = {name: row.metadata["option"] for name, row in fields_of(RobotOptions).items()}
"""Every option by its name."""

DEFAULTS: Final[dict[str, Any]] = {name: row.default for name, row in fields_of(RobotOptions).items()}

IN_VIRTUAL_TIME: Final[dict[str, Any]] = {"power_on": True, "power_times": AT_ONCE, "confirms_popups": True}
"""Options of a robot in virtual time that are not the default, unless they are given."""

SECTIONS: Final[dict[str, Section]] = {name: row.kind for name, row in OPTIONS.items() if isinstance(row.kind, Section)}
"""Options that are a section of a world file."""

_CHECKED: Final = {name: row.kind for name, row in OPTIONS.items() if row.kind is not None}


KEYWORDS: Final = tuple(name for name in _CHECKED if name != "model")
"""Options that are keywords of `VirtualRobot`, besides `model`, which is its first argument."""


def robot_options(
    given: Mapping[str, Any], from_file: Mapping[str, Any] = MappingProxyType({}), **base: Any
) -> RobotOptions:
    """Return the options of a robot: those that are given, else those of a world file, else `base`, else the default.

    Args:
        given: by a caller or on the command line; None is as good as nothing.
        from_file: of a world file.
        base: of the front door.

    Raises:
        UsageError: a value that an option does not take, or a section that is given and in the world file as well.
    """
    chosen = {name: value for name, value in given.items() if value is not None}
    for name in chosen:
        if name in SECTIONS and name in from_file:
            raise UsageError(f"{name} is given by the world file too; give it in one of both")
    return RobotOptions(**{**base, **from_file, **chosen})


def check_keywords(names: Iterable[str], others: Iterable[str] = ()) -> None:
    """Refuse keywords that are no options, as a function with these keywords would.

    Args:
        names: of the keywords.
        others: further keywords that the function has.

    Raises:
        TypeError: there is one; the text names the nearest option.
    """
    for name in names:
        if name not in KEYWORDS:
            near = did_you_mean(name, (*KEYWORDS, *others))
            raise TypeError(f"got an unexpected keyword argument {name!r}{near}")


def options_of_table(table: Mapping[str, Any]) -> dict[str, Any]:
    """Return the options that the section `[robot]` of a world file sets.

    Raises:
        UsageError: an unknown key, or a value that makes no sense; the text begins with `[robot]`.
    """
    known = [name for name in _CHECKED if name not in SECTIONS]
    place = f"[{ROBOT_SECTION}]"
    for name in table:
        if name in SECTIONS:
            raise UsageError(f"{place} {name} is a section of its own: [{name}]")
        if name not in known:
            raise UsageError(f"{place} {name} is not known; there are {', '.join(known)}{did_you_mean(name, known)}")
    return {name: accept(name, value, f"{place} {name}") for name, value in table.items()}


def accept(name: str, value: Any, called: str) -> Any:
    """Return the value of an option as `RobotOptions` holds it.

    Args:
        name: of the option.
        value: what was given.
        called: what the user calls it, for error texts.

    Raises:
        UsageError: the option does not take this value.
    """
    return accepted(_CHECKED[name], value, called)


def accepted(kind: Any, value: Any, called: str) -> Any:
    """Return a value as its kind holds it; see `accept`.

    Raises:
        UsageError: the kind does not take this value.
    """
    try:
        return kind.accept(value)
    except UsageError as error:
        raise UsageError(f"{called} {error}") from None


def given_ticks(duration_s: Any, called: str) -> int:
    """Return the ticks of a time that a caller gives, rounded up.

    Raises:
        UsageError: it is none; the text names the argument.
    """
    return ticks_for(accepted(UNTIL, duration_s, called))
