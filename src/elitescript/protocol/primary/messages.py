"""Robot messages of the primary port (type 20) as a table, and the events that become messages.

Clients know two kinds, robot error (6) and script exception (10), and skip the others. Those are *documented*; the
other kinds are *assumed* from a protocol of the same family, which numbers these two alike. So are the events that each
kind is sent for. The vendor's numbers of robot errors are not known: ours have code 0 and a text.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any, Final

from elitescript.messages.enums import SafetyMode, TaskState
from elitescript.messages.events import Alarm, Event, Popup, SafetyModeChanged, TaskStateChanged, TextMessage, Warned
from elitescript.messages.snapshot import RobotDescription
from elitescript.protocol.binary import (
    BOOL,
    INT32,
    UINT8,
    UINT32,
    UINT64,
    Field,
    FieldList,
    Number,
    WireType,
    WireValue,
)
from elitescript.protocol.lines import text_bytes
from elitescript.protocol.primary.packets import ASSUMED, DOCUMENTED, timestamp
from elitescript.records import record

ROBOT_MESSAGE: Final = 20

SOURCE_SAFETY: Final = 99
SOURCE_CONTROLLER: Final = 104

INFO, WARNING, ERROR, FATAL = range(4)
"""Levels of a robot error."""
TEXT_DATA: Final = 5
"""Data type of a robot error whose rest is text."""

TERMINATOR: Final = b"\0"
"""Behind the last text of a message; *assumed*: several public clients drop the last byte."""
MAX_TEXT_BYTES: Final = 4096
"""Longer texts are cut and end in dots. *Assumed.*"""
MAX_TITLE_BYTES: Final = 255
WAITING_MAX: Final = 500
"""Limit of robot messages that wait for a client; the last of them leaves after 14 s."""
VITAL_MAX: Final = 1000
"""Limit for vital ones."""

_PROJECT: Final = b"EliControl"


class MessageKind:
    """One kind of robot message.

    Args:
        name: of the kind.
        number: its kind on the wire.
        evidence: for its number and layout.
        summary: when it is sent.
        fields: between the common head and the texts.
        texts: names of the texts that follow: the last one goes to the end of the message, each before it has its
            length in front, one byte.
    """

    __slots__ = ("evidence", "fields", "name", "number", "summary", "texts")

    def __init__(
        self, name: str, number: int, evidence: str, summary: str, fields: tuple[Field, ...], texts: tuple[str, ...]
    ) -> None:
        self.name = name
        self.number = number
        self.evidence = evidence
        self.summary = summary
        self.fields = FieldList(*HEAD, *fields)
        self.texts = texts

    def pack(
        self,
        tick: int,
        values: tuple[Number | tuple[Number, ...], ...],
        *texts: str,
        source: int = SOURCE_CONTROLLER,
        terminator: bytes = TERMINATOR,
    ) -> bytes:
        """Return a whole message."""
        *titles, text = texts
        body = b""
        for title in titles:
            data = _cut(title, MAX_TITLE_BYTES)
            body += bytes((len(data),)) + data
        body += _cut(text, MAX_TEXT_BYTES) + terminator
        size = self.fields.size + len(body)
        return self.fields.pack((size, ROBOT_MESSAGE, timestamp(tick), source, self.number, *values)) + body

    def unpack(self, data: bytes) -> tuple[dict[str, WireValue], dict[str, str]]:
        """Return the values of the fields and the texts of a whole message, by name.

        Raises:
            ValueError: fewer bytes than the fields, or the titles with their lengths, need.
        """
        values = self.fields.unpack(data)
        at = self.fields.size
        texts: dict[str, str] = {}
        for name in self.texts[:-1]:
            if at >= len(data) or at + 1 + data[at] > len(data):
                raise ValueError(f"the {name} of a {self.name} message ends behind the message")
            texts[name] = data[at + 1 : at + 1 + data[at]].decode("utf-8", "replace")
            at += 1 + data[at]
        texts[self.texts[-1]] = data[at:].rstrip(b"\0").decode("utf-8", "replace")
        return {field.name: value for field, value in zip(self.fields.fields, values, strict=True)}, texts


HEAD: Final = (
    Field("length", UINT32, "byte", DOCUMENTED, "with these bytes"),
    Field("type", UINT8, "", DOCUMENTED, f"{ROBOT_MESSAGE}"),
    Field("timestamp", UINT64, "us", DOCUMENTED, "since the start"),
    Field("source", UINT8, "", DOCUMENTED, f"{SOURCE_SAFETY} safety, {SOURCE_CONTROLLER} controller"),
    Field("kind", UINT8, "", DOCUMENTED),
)

TEXT: Final = MessageKind(
    "text",
    0,
    ASSUMED,
    "`textmsg`; lines that clients add to the log; advice on a line of a program, with `warning: ` in front",
    (),
    ("text",),
)
POPUP: Final = MessageKind(
    "popup",
    2,
    ASSUMED,
    "`popup`",
    (
        Field("request", UINT32, "", ASSUMED, "always 0"),
        Field("requested type", UINT8, "", ASSUMED, "always 0"),
        Field("is warning", BOOL, "", ASSUMED),
        Field("is error", BOOL, "", ASSUMED),
        Field("is blocking", BOOL, "", ASSUMED),
    ),
    ("title", "text"),
)
VERSION: Final = MessageKind(
    "version",
    3,
    ASSUMED,
    "after accept, if it is switched on: real controllers are not known to send it",
    (
        Field("name length", UINT8, "byte", ASSUMED),
        Field("name", WireType("text", "B", len(_PROJECT)), "", ASSUMED),
        Field("major", UINT8, "", ASSUMED),
        Field("minor", UINT8, "", ASSUMED),
        Field("bug fix", INT32, "", ASSUMED),
        Field("build", INT32, "", ASSUMED),
    ),
    ("build date",),
)
ROBOT_ERROR: Final = MessageKind(
    "robot error",
    6,
    DOCUMENTED,
    "stops of the safety system; as warnings: commands that are refused, exceptions of secondary programs, bytes that "
    "are not UTF-8, whatever else the log warns of without a line of a program",
    (
        Field("code", INT32, "", DOCUMENTED, "always 0"),
        Field("sub-code", INT32, "", DOCUMENTED, "always 0"),
        Field("level", INT32, "", DOCUMENTED, "0 info, 1 warning, 2 error, 3 fatal"),
        Field("data type", UINT32, "", DOCUMENTED, f"always {TEXT_DATA}, text"),
    ),
    ("text",),
)
KEY: Final = MessageKind(
    "key",
    7,
    ASSUMED,
    "a program starts, pauses or stops; the title says which, the text is its name",
    (
        Field("code", INT32, "", ASSUMED, "always 0"),
        Field("argument", INT32, "", ASSUMED, "always 0"),
    ),
    ("title", "text"),
)
SCRIPT_EXCEPTION: Final = MessageKind(
    "script exception",
    10,
    DOCUMENTED,
    "a program cannot start or stops with an alarm; a program without its end",
    (
        Field("line", INT32, "", DOCUMENTED, "from 1 at the unit's first line; 0 unknown"),
        Field("column", INT32, "", DOCUMENTED, "from 1; 0 unknown"),
    ),
    ("text",),
)

KINDS: Final[tuple[MessageKind, ...]] = (TEXT, POPUP, VERSION, ROBOT_ERROR, KEY, SCRIPT_EXCEPTION)


@record
class RobotMessage:
    """A packed robot message for clients."""

    data: bytes
    is_vital: bool
    """Whether it is an error, start or end, for which a client's queue has more room."""


class RobotMessageQueue:
    """Robot messages that wait for one client, in order; a text in the place of dropped ones has their number.

    Args:
        terminator: end of the texts of messages.

    Attributes:
        left_out: number of dropped messages.
    """

    __slots__ = ("_terminator", "_waiting", "left_out")

    def __init__(self, terminator: bytes = TERMINATOR) -> None:
        self._terminator = terminator
        self._waiting: deque[RobotMessage | _Gap] = deque()
        self.left_out = 0

    def __len__(self) -> int:
        return len(self._waiting)

    def put(self, message: RobotMessage, tick: int) -> None:
        """Add a message; without room, count it as missing here."""
        waiting = self._waiting
        if len(waiting) < (VITAL_MAX if message.is_vital else WAITING_MAX):
            waiting.append(message)
            return
        self.left_out += 1
        last = waiting[-1]
        if isinstance(last, _Gap):
            last.count += 1
        else:
            waiting.append(_Gap(tick))

    def take(self) -> bytes:
        """Return the next message; there must be one."""
        found = self._waiting.popleft()
        if isinstance(found, RobotMessage):
            return found.data
        text = f"warning: {found.count} robot messages are missing here: they came faster than they can be sent"
        return TEXT.pack(found.tick, (), text, terminator=self._terminator)


class _Gap:
    """A place where messages were dropped."""

    __slots__ = ("count", "tick")

    def __init__(self, tick: int) -> None:
        self.count = 1
        self.tick = tick
        """Of the first of them."""


def exception_message(tick: int, line: int, column: int, text: str, terminator: bytes = TERMINATOR) -> RobotMessage:
    """Return a script exception; the text begins with the name of its class."""
    return RobotMessage(SCRIPT_EXCEPTION.pack(tick, (line, column), text, terminator=terminator), is_vital=True)


def error_message(
    tick: int,
    level: int,
    text: str,
    source: int = SOURCE_CONTROLLER,
    terminator: bytes = TERMINATOR,
    *,
    is_vital: bool = True,
) -> RobotMessage:
    """Return a robot error with a text."""
    data = ROBOT_ERROR.pack(tick, (0, 0, level, TEXT_DATA), text, source=source, terminator=terminator)
    return RobotMessage(data, is_vital)


def version_message(tick: int, description: RobotDescription, terminator: bytes = TERMINATOR) -> RobotMessage:
    """Return the version of the controller."""
    values = (len(_PROJECT), tuple(_PROJECT), *description.version)
    return RobotMessage(VERSION.pack(tick, values, "", terminator=terminator), is_vital=False)


def message_of(event: Event, terminator: bytes = TERMINATOR) -> RobotMessage | None:
    """Return the message about an event; None if it has none."""
    translate = _TRANSLATIONS.get(type(event))
    return None if translate is None else translate(event, terminator)


def _alarm(event: Alarm, terminator: bytes) -> RobotMessage:
    return exception_message(event.tick, event.line, event.column, f"{event.class_name}: {event.text}", terminator)


def _warned(event: Warned, terminator: bytes) -> RobotMessage:
    """Return a text for advice on a line of a program, because a robot error would show as a fault of the robot."""
    if event.is_exception or not (event.line or event.thread or event.code):
        return error_message(event.tick, WARNING, event.text, terminator=terminator, is_vital=event.is_exception)
    place = f"line {event.line}: " if event.line else ""
    text = str(event) if event.code else f"warning: {place}{event.text}"
    return RobotMessage(TEXT.pack(event.tick, (), text, terminator=terminator), is_vital=False)


def _text_message(event: TextMessage, terminator: bytes) -> RobotMessage:
    return RobotMessage(TEXT.pack(event.tick, (), event.text, terminator=terminator), is_vital=False)


def _popup(event: Popup, terminator: bytes) -> RobotMessage:
    values = (0, 0, event.level == "warning", event.level == "error", event.is_blocking)
    return RobotMessage(POPUP.pack(event.tick, values, event.title, event.text, terminator=terminator), is_vital=False)


_KEY_TITLES: Final = {
    TaskState.PLAYING: "PROGRAM_XXX_STARTED",
    TaskState.PAUSED: "PROGRAM_XXX_PAUSED",
    TaskState.STOPPED: "PROGRAM_XXX_STOPPED",
}


def _task_state(event: TaskStateChanged, terminator: bytes) -> RobotMessage | None:
    title = _KEY_TITLES.get(event.state)
    if title is None:
        return None
    return RobotMessage(KEY.pack(event.tick, (0, 0), title, event.name, terminator=terminator), is_vital=True)


_SAFETY_LEVELS: Final = {
    SafetyMode.PROTECTIVE_STOP: ERROR,
    SafetyMode.SAFEGUARD_STOP: WARNING,
    SafetyMode.SYSTEM_EMERGENCY_STOP: ERROR,
    SafetyMode.ROBOT_EMERGENCY_STOP: ERROR,
    SafetyMode.VIOLATION: FATAL,
    SafetyMode.FAULT: FATAL,
    SafetyMode.AUTOMATIC_MODE_SAFEGUARD_STOP: WARNING,
    SafetyMode.SYSTEM_THREE_POSITION_ENABLING_STOP: WARNING,
    SafetyMode.TP_THREE_POSITION_ENABLING_STOP: WARNING,
}


def _safety_mode(event: SafetyModeChanged, terminator: bytes) -> RobotMessage | None:
    level = _SAFETY_LEVELS.get(event.mode)
    if level is None:
        return None
    text = event.mode.name.replace("_", " ").capitalize()
    if event.reason:
        text = f"{text}: {event.reason}"
    return error_message(event.tick, level, text, SOURCE_SAFETY, terminator)


_TRANSLATIONS: Final[dict[type, Callable[[Any, bytes], RobotMessage | None]]] = {
    Alarm: _alarm,
    Warned: _warned,
    TextMessage: _text_message,
    Popup: _popup,
    TaskStateChanged: _task_state,
    SafetyModeChanged: _safety_mode,
}


def _cut(text: str, limit: int) -> bytes:
    """Return UTF-8 of at most `limit` bytes, whole characters; a cut text ends in dots."""
    data = text_bytes(text)
    if len(data) <= limit:
        return data
    return data[: limit - 3].decode("utf-8", "ignore").encode() + b"..."
