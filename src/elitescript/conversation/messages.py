"""The messages that a page sends, each a record; `read_message` makes them of the text of one.

`web/src/source/messages.ts` has the same messages as types, and says what each asks for. A message has all fields of
its row in `MESSAGES` and no other; a refusal names the field: `program.options.inputs[2].at_s: must be ...`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from elitescript.controller.signals.by_name import signal_write
from elitescript.conversation.fields import (
    MessageError,
    Reader,
    choice,
    level,
    listed,
    number,
    plain_table,
    switch,
    table,
    text,
    whole,
)
from elitescript.errors import UsageError, did_you_mean
from elitescript.messages.motion import Six
from elitescript.messages.signals import Value
from elitescript.messages.timing import PERIOD_S
from elitescript.records import NamedTuple, field, fields_of, record
from elitescript.untrusted.json_text import JsonError, json_value

PROTOCOL: Final = 1
"""Version of the conversation."""

TEXT_MAX: Final = 2_000_000
"""Characters of a program."""
MESSAGE_BYTES_MAX: Final = 16 << 20
"""Longest message of a page; a character of a program takes up to 6 bytes. A longer one ends the connection."""
UNTIL_S_DEFAULT: Final = 120.0
"""Robot time after which a live run waits for `go_on`, s."""
UNTIL_S_MAX: Final = 3600.0 * 24
INPUTS_MAX: Final = 1000
DETAIL_ROWS_MAX: Final = 100_000
"""Rows that one `detail` may ask for."""

# ---------------------------------------------------------------- programs


class SignalInput(NamedTuple):
    """A signal that takes a value from outside at a time; 0 s: before the program begins."""

    name: str
    value: Value
    at_s: float


@record
class RunOptions:
    """Options of a live run; None is what the command line gave.

    Attributes:
        robot, firmware: as the options of these names.
        world: path of a world file, relative to the opened folder.
        joints: at the start, rad.
        seed: of random numbers.
        until_s: end of the run, s.
        may_connect: whether connections of the program may leave the simulation.
        inputs: in the order of the page.
    """

    robot: str | None = None
    firmware: str | None = None
    world: str | None = None
    joints: Six | None = None
    seed: int | None = None
    until_s: float | None = None
    may_connect: bool | None = None
    inputs: tuple[SignalInput, ...] | None = None


@record
class Program:
    """A new text of the editor."""

    version: int
    text: str
    options: RunOptions = RunOptions()


@record
class GoOn:
    """Let a run that has reached its limit of time go on."""

    run: int
    until_s: float


@record
class Stop:
    """End what is being computed."""


@record
class Detail:
    """Ask for rows of a stretch."""

    run: int
    ask: int
    from_s: float
    to_s: float
    step_s: float


@record
class Seek:
    """Ask for the exact state at a time."""

    run: int
    ask: int
    t: float


@record
class Step:
    """Ask for the state at the next (1) or previous (-1) beginning of a statement of a thread."""

    run: int
    ask: int
    by: int
    thread: str
    t: float
    position: str = ""
    """Of the last state; the time counts if it is empty."""


# ---------------------------------------------------------------- texts and files


@record
class Service:
    """Ask for something that editors show; `arguments` are those of the service."""

    ask: int
    service: str
    version: int
    line: int = 0
    column: int = 0
    arguments: Mapping[str, Any] = field(default_factory=dict)


@record
class Record:
    """Run a text from begin to end with the options of the last program, or read a trace; for comparisons and pages."""

    ask: int
    name: str
    text: str
    form: str
    """`recording`: bytes in base 64; `page`: the text of a page."""


@record
class Save:
    """Write the file."""

    ask: int
    text: str
    seen: str
    """Digest of the file as the page knows it."""
    force: bool = False
    """Although it has changed since."""


@record
class Open:
    """Open a file of the folder, by its relative path, or a new one."""

    ask: int
    name: str


@record
class Settings:
    """What a page remembers from one start to the next."""

    values: Mapping[str, Any]


# ---------------------------------------------------------------- controllers


@record
class Control:
    """Press one of the buttons of a robot."""

    ask: int
    action: str


@record
class SetSignal:
    """Set a signal now."""

    ask: int
    name: str
    value: Value


@record
class Speed:
    """Move the speed slider."""

    ask: int
    fraction: float


@record
class Fault:
    """Let something go wrong: the words of `ctl`."""

    ask: int
    words: tuple[str, ...]


@record
class Load:
    """Load a program of the controller."""

    ask: int
    program: str


@record
class SendProgram:
    """Send a text to the controller, and run it there."""

    ask: int
    text: str


@record
class Jog:
    """Move while this is repeated."""

    frame: str
    axis: int
    direction: int
    speed: float


@record
class JogEnd:
    """End a jog."""


@record
class Guiding:
    """Keep hand guiding on; it begins none."""


ToSource = (
    Program
    | GoOn
    | Stop
    | Detail
    | Seek
    | Step
    | Service
    | Record
    | Save
    | Open
    | Settings
    | Control
    | SetSignal
    | Speed
    | Fault
    | Load
    | SendProgram
    | Jog
    | JogEnd
    | Guiding
)

# ---------------------------------------------------------------- reading


def _signal(read: Reader) -> Reader:
    """Return a reader of objects that have name and level of a signal."""

    def checked(value: Any, place: str) -> Any:
        found = read(value, place)
        try:
            signal_write(found.name, found.value)
        except UsageError as error:
            raise MessageError(f"{place}: {error}") from None
        return found

    return checked


def _within(read: Reader) -> Reader:
    """Return a reader of stretches of time."""

    def checked(value: Any, place: str) -> Any:
        found = read(value, place)
        if found.to_s < found.from_s:
            raise MessageError(f"{place}: from_s {found.from_s:g} s is after to_s {found.to_s:g} s")
        if (found.to_s - found.from_s) / found.step_s > DETAIL_ROWS_MAX:
            raise MessageError(f"{place}: more than {DETAIL_ROWS_MAX} rows; take a larger step_s")
        return found

    return checked


def _service(value: Any, place: str) -> Service:
    """Read a service: what is none of its own fields is an argument."""
    found = plain_table(value, place)
    own = {name: part for name, part in found.items() if name in _SERVICE}
    made: Service = table(Service, _SERVICE, ("line", "column"))(own, place)
    arguments = {name: part for name, part in found.items() if name not in _SERVICE}
    return Service(made.ask, made.service, made.version, made.line, made.column, arguments)


_NAME: Final = text(1000, is_empty_allowed=False)
_TEXT: Final = text(TEXT_MAX)
_ASK: Final = whole()
_TIME: Final = number(0.0, UNTIL_S_MAX, "s")
_UNTIL: Final = number(PERIOD_S, UNTIL_S_MAX, "s")

_INPUT: Final = _signal(table(SignalInput, {"name": _NAME, "value": level, "at_s": _TIME}))
_OPTIONS: Final[dict[str, Reader]] = {
    "robot": _NAME,
    "firmware": _NAME,
    "world": text(1000),
    "joints": listed(number(unit="rad"), 6, items_min=6),
    "seed": whole(),
    "until_s": _UNTIL,
    "may_connect": switch,
    "inputs": listed(_INPUT, INPUTS_MAX),
}
SERVICES: Final = (
    *("completion", "resolve", "hover", "signature", "definition", "references", "rename", "actions", "format"),
    *(
        "tokens",
        "hints",
        "typing",
        "folding",
        "outline",
        "explain",
        "commands",
        "robots",
        "mesh",
        "examples",
        "signals",
    ),
)
ACTIONS: Final = (
    *("power_on", "power_off", "release_brakes", "play", "pause", "resume", "stop", "unlock", "close_popup"),
    *("freedrive_on", "freedrive_off", "emergency_stop", "emergency_stop_release", "safeguard_open"),
    "safeguard_close",
)
_SERVICE: Final[dict[str, Reader]] = {
    "ask": _ASK,
    "service": choice(*SERVICES),
    "version": whole(),
    "line": whole(),
    "column": whole(),
}
_DETAIL: Final[dict[str, Reader]] = {
    "run": whole(),
    "ask": _ASK,
    "from_s": _TIME,
    "to_s": _TIME,
    "step_s": number(PERIOD_S, 3600.0, "s"),
}
_RECORD: Final[dict[str, Reader]] = {
    "ask": _ASK,
    "name": _NAME,
    "text": _TEXT,
    "form": choice("recording", "page"),
}
_STEP: Final[dict[str, Reader]] = {
    "run": whole(),
    "ask": _ASK,
    "by": choice(1, -1),
    "thread": text(1000),
    "t": _TIME,
    "position": text(200),
}
_JOG: Final[dict[str, Reader]] = {
    "frame": choice("joint", "base", "tool"),
    "axis": whole(0, 5),
    "direction": choice(1, -1),
    "speed": number(0.0, 1.0),
}

MESSAGES: Final[dict[str, Reader]] = {
    "program": table(
        Program,
        {"version": whole(), "text": _TEXT, "options": table(RunOptions, _OPTIONS, _OPTIONS)},
        ("options",),
    ),
    "go_on": table(GoOn, {"run": whole(), "until_s": _UNTIL}),
    "stop": table(Stop, {}),
    "detail": _within(table(Detail, _DETAIL)),
    "seek": table(Seek, {"run": whole(), "ask": _ASK, "t": _TIME}),
    "step": table(Step, _STEP, ("position",)),
    "service": _service,
    "record": table(Record, _RECORD),
    "save": table(Save, {"ask": _ASK, "text": _TEXT, "seen": text(200), "force": switch}, ("force",)),
    "open": table(Open, {"ask": _ASK, "name": _NAME}),
    "settings": table(Settings, {"values": plain_table}),
    "control": table(Control, {"ask": _ASK, "action": choice(*ACTIONS)}),
    "signal": _signal(table(SetSignal, {"ask": _ASK, "name": _NAME, "value": level})),
    "speed": table(Speed, {"ask": _ASK, "fraction": number(0.0, 1.0)}),
    "fault": table(Fault, {"ask": _ASK, "words": listed(text(200), 50)}),
    "load": table(Load, {"ask": _ASK, "program": _NAME}),
    "send_program": table(SendProgram, {"ask": _ASK, "text": _TEXT}),
    "jog": table(Jog, _JOG),
    "jog_end": table(JogEnd, {}),
    "guiding": table(Guiding, {}),
}
"""Reader of each message, by its type."""


def read_message(data: str | bytes) -> ToSource:
    """Return the message of a text of JSON.

    Raises:
        MessageError: it is too long, no JSON, no message, or one with a field that makes no sense.
    """
    if len(data) > MESSAGE_BYTES_MAX:
        raise MessageError(f"a message of {len(data)} characters; at most {MESSAGE_BYTES_MAX} are taken")
    try:
        found = json_value(data, parse_constant=_no_constant)
    except JsonError as error:
        raise MessageError(f"the message is no JSON: {str(error)[:80]}") from None
    if not isinstance(found, dict):
        raise MessageError("the message is no object")
    kind = found.pop("type", None)
    if not isinstance(kind, str) or kind not in MESSAGES:
        near = did_you_mean(kind, MESSAGES) if isinstance(kind, str) and len(kind) <= 40 else ""
        raise MessageError(f"type: there is no such message{near}")
    message: ToSource = MESSAGES[kind](found, kind)
    return message


def ask_of(data: str | bytes) -> int | None:
    """Return the number `ask` of a message that `read_message` refuses, for the answer; None if it has none."""
    try:
        ask = json_value(data).get("ask")
    except (JsonError, AttributeError):
        return None
    return ask if isinstance(ask, int) and not isinstance(ask, bool) and 0 <= ask <= 2**53 else None


def options_data(options: RunOptions) -> dict[str, Any]:
    """Return options as a message has them, without those that are None."""
    given = {name: getattr(options, name) for name in fields_of(RunOptions)}
    data = {name: list(value) if name == "joints" else value for name, value in given.items() if value is not None}
    if options.inputs is not None:
        data["inputs"] = [item._asdict() for item in options.inputs]
    return data


def _no_constant(word: str) -> Any:
    raise ValueError(f"{word} is no JSON")
