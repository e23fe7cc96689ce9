"""Faults of channels: what there is, on what it makes sense, and one fault as it is asked for.

`TABLE` is the one place that says which fault a TCP connection or a serial line can have; what is refused, what the
documentation prints and what `faulty_channels` does follow it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Final, NamedTuple

from elitescript.errors import UsageError
from elitescript.messages.timing import ticks_for
from elitescript.worlds.line_bindings import PORTS

TCP: Final = "tcp"
LINE: Final = "line"

MODBUS: Final = "MODBUS"
XML_RPC: Final = "XML-RPC"


class Effect(NamedTuple):
    """What a fault does to a channel of one kind, or why there is no such thing."""

    text: str
    is_possible: bool = True


class Kind(NamedTuple):
    """One row: a kind of fault."""

    name: str
    tcp: Effect
    line: Effect
    takes: tuple[str, ...] = ()
    """Settings that it has besides those of all faults."""
    directions: bool = True
    """Whether it can be limited to one direction, and to certain messages."""


_ROWS: Final = (
    Kind(
        "refuse",
        Effect("new connections are refused; those that stand go on"),
        Effect("a serial line cannot refuse: opening it needs nobody at the other end. Take silence", False),
        directions=False,
    ),
    Kind(
        "silence",
        Effect("attempts to connect are not answered; bytes are lost, the connection stands"),
        Effect("bytes are lost"),
    ),
    Kind("drop", Effect("the message is lost"), Effect("the message is lost")),
    Kind(
        "delay",
        Effect("the message comes delay_s later; nothing overtakes it"),
        Effect("the message comes delay_s later; nothing overtakes it"),
        ("delay_s",),
    ),
    Kind("duplicate", Effect("the message comes twice"), Effect("the message comes twice")),
    Kind(
        "corrupt",
        Effect("one bit in each eight bytes of the message is wrong, and one at least"),
        Effect("one bit in each eight bytes of the message is wrong, and one at least"),
    ),
    Kind(
        "trickle",
        Effect("the message comes with chunk bytes in each control period"),
        Effect("the message comes with chunk bytes in each control period"),
        ("chunk",),
    ),
    Kind(
        "wrong_reply",
        Effect("what the device sends is replaced, see form"),
        Effect("what the device sends is replaced, see form"),
        ("form", "reply", "code"),
    ),
    Kind(
        "disconnect",
        Effect("connections break; new ones are refused until reconnect, or until for_s is over"),
        Effect("the plug is out: bytes are lost until reconnect, or until for_s is over"),
        directions=False,
    ),
    Kind(
        "reconnect",
        Effect("connecting is possible again after a disconnect"),
        Effect("the plug is in again after a disconnect"),
        directions=False,
    ),
)

TABLE: Final[dict[str, Kind]] = {row.name: row for row in _ROWS}
"""All kinds by name."""


class Form(NamedTuple):
    """One row: what a wrong reply is."""

    name: str
    tcp: Effect
    line: Effect
    takes: tuple[str, ...] = ()
    protocol: str = ""
    """What the device must speak for it to mean anything."""


_FORM_ROWS: Final = (
    Form("text", Effect("the bytes of reply"), Effect("the bytes of reply"), ("reply",)),
    Form(
        "exception",
        Effect("a MODBUS exception with the number code"),
        Effect("a MODBUS exception with the number code"),
        ("code",),
        protocol=MODBUS,
    ),
    Form(
        "transaction",
        Effect("a MODBUS answer to another transaction"),
        Effect("frames of MODBUS RTU have no transaction", False),
        protocol=MODBUS,
    ),
    Form(
        "unit",
        Effect("a MODBUS answer of another unit"),
        Effect("a MODBUS answer of another unit"),
        protocol=MODBUS,
    ),
    Form(
        "checksum",
        Effect("frames of MODBUS TCP have no checksum", False),
        Effect("a MODBUS answer with a wrong checksum"),
        protocol=MODBUS,
    ),
    Form(
        "fault",
        Effect("an XML-RPC fault with the number code and the text reply"),
        Effect("XML-RPC does not go over a serial line", False),
        ("code", "reply"),
        protocol=XML_RPC,
    ),
    Form(
        "http",
        Effect("an HTTP answer with the status code"),
        Effect("HTTP does not go over a serial line", False),
        ("code",),
        protocol=XML_RPC,
    ),
)

FORMS: Final[dict[str, Form]] = {row.name: row for row in _FORM_ROWS}
"""All forms of a wrong reply by name."""

BOTH: Final = "both"
TO_ROBOT: Final = "to_robot"
TO_DEVICE: Final = "to_device"
DIRECTIONS: Final = (BOTH, TO_ROBOT, TO_DEVICE)

DELAY_MAX_S: Final = 3600.0


@dataclass(frozen=True, slots=True)
class Fault:
    """Something that goes wrong on a channel.

    A message is what a program sends with one command, or what arrives from the device in one control period; what
    comes over a serial line without a pause is one message.

    Attributes:
        kind: see `TABLE`.
        on: a TCP port such as `5000`, an address and port such as `"192.168.1.20:5000"`, or a serial line such as
            `"tool"`.
        at_s: from then on, in the robot's time.
        for_s: for so long; to the end if None.
        nth: the first message that it meets, counted from `at_s`; the first one is 1.
        count: how many messages it meets; all if None.
        direction: `to_robot`, `to_device` or `both`.
        share: of these messages it meets this share, drawn at random.
        delay_s: of `delay`.
        chunk: of `trickle`, bytes.
        form: of `wrong_reply`, see `FORMS`.
        reply: of `wrong_reply`.
        code: of `wrong_reply`.

    Raises:
        UsageError: there is no such fault, it makes no sense on that channel, or its settings do not go together.

    Example:
        >>> from elitescript.testing.world import Fault, ModbusDevice, SerialDevice, TcpServer, World
        >>> devices = [TcpServer(port=5000), ModbusDevice(port=502), SerialDevice(line="tool")]
        >>> world = World(devices, faults=[
        ...     Fault("refuse", on=5000, for_s=2.0),
        ...     Fault("delay", on=5000, delay_s=0.5, at_s=10.0, direction="to_robot"),
        ...     Fault("corrupt", on="tool", nth=3, count=1),
        ...     Fault("wrong_reply", on=502, form="exception", code=6, nth=2, count=1),
        ... ])
    """

    kind: str
    on: int | str
    at_s: float = 0.0
    for_s: float | None = None
    nth: int = 1
    count: int | None = None
    direction: str = BOTH
    share: float = 1.0
    delay_s: float = 0.0
    chunk: int = 1
    form: str = ""
    reply: str | bytes | None = None
    code: int | None = None

    def __post_init__(self) -> None:
        kind: Any = self.kind
        row = TABLE.get(kind) if isinstance(kind, str) else None
        if row is None:
            raise UsageError(f"kind: there is no fault {self.kind!r}; there are {', '.join(TABLE)}")
        channel, _, _ = place_of(self.on)
        effect = row.tcp if channel == TCP else row.line
        if not effect.is_possible:
            raise UsageError(f"kind: {self.kind} on {self.on!r}: {effect.text}")
        _check_number("at_s", self.at_s, 0.0, 1e12, "s")
        if self.for_s is not None:
            _check_number("for_s", self.for_s, 0.0, 1e12, "s")
            if ticks_for(self.for_s) < 1:
                raise UsageError(f"for_s: must be one control period at least, got {self.for_s!r} s")
        _check_whole("nth", self.nth, 1, 10**9)
        if self.count is not None:
            _check_whole("count", self.count, 1, 10**9)
        _check_number("share", self.share, 0.0, 1.0, "")
        if self.direction not in DIRECTIONS:
            raise UsageError(f"direction: must be one of {', '.join(DIRECTIONS)}, got {self.direction!r}")
        self._check_settings(row, channel)

    def _check_settings(self, row: Kind, channel: str) -> None:
        defaults = {"delay_s": 0.0, "chunk": 1, "form": "", "reply": None, "code": None}
        for name, default in defaults.items():
            if getattr(self, name) != default and name not in row.takes:
                owners = ", ".join(other.name for other in TABLE.values() if name in other.takes)
                raise UsageError(f"{name}: {self.kind} has no such setting; {owners} has")
        if not row.directions:
            for name, plain in (("direction", BOTH), ("nth", 1), ("count", None), ("share", 1.0)):
                if getattr(self, name) != plain:
                    raise UsageError(f"{name}: {self.kind} is about the whole channel, not about messages")
        if self.kind == "reconnect" and self.for_s is not None:
            raise UsageError("for_s: reconnect happens at a moment; give disconnect a for_s instead")
        if self.kind == "delay":
            _check_number("delay_s", self.delay_s, 0.0, DELAY_MAX_S, "s")
            if ticks_for(self.delay_s) < 1:
                raise UsageError(f"delay_s: must be one control period at least, got {self.delay_s!r} s")
        _check_whole("chunk", self.chunk, 1, 65536)
        if self.kind == "wrong_reply":
            self._check_reply(channel)

    def _check_reply(self, channel: str) -> None:
        form = FORMS.get(self.form or "text")
        if form is None:
            raise UsageError(f"form: there is no {self.form!r}; there are {', '.join(FORMS)}")
        effect = form.tcp if channel == TCP else form.line
        if not effect.is_possible:
            raise UsageError(f"form: {form.name} on {self.on!r}: {effect.text}")
        if self.direction == TO_DEVICE:
            raise UsageError("direction: a wrong reply goes to_robot")
        for name in ("reply", "code"):
            is_given = getattr(self, name) is not None
            if is_given is not (name in form.takes):
                text = "needs it" if not is_given else "has no such setting"
                raise UsageError(f"{name}: a wrong reply of the form {form.name} {text}")
        if self.reply is not None and not isinstance(self.reply, str | bytes):
            raise UsageError(f"reply: must be a text or bytes, got {self.reply!r}")
        if self.code is not None:
            low, high = {"exception": (1, 255), "http": (100, 599)}.get(form.name, (-(2**31), 2**31 - 1))
            _check_whole("code", self.code, low, high)

    def __str__(self) -> str:
        return f"{self.kind} on {'port ' if isinstance(self.on, int) else ''}{self.on}"


def fault_text(fault: Fault) -> str:
    """A fault as one line of text, for `fault_of`.

    Raises:
        UsageError: its reply is bytes, which a text cannot hold.
    """
    import json

    if isinstance(fault.reply, bytes):
        raise UsageError("reply: must be a text to be sent to a served robot")
    settings = {field.name: getattr(fault, field.name) for field in fields(Fault)}
    return json.dumps({name: value for name, value in settings.items() if value is not None})


def fault_of(text: str) -> Fault:
    """The fault that a text says, see `fault_text`.

    Raises:
        UsageError: it says none.
    """
    import json

    try:
        settings = json.loads(text)
    except ValueError as error:
        raise UsageError(f"{text[:200]!r} is no fault: {error}") from None
    if not isinstance(settings, dict):
        raise UsageError(f"{text[:200]!r} is no fault: it must be an object")
    return fault_from(settings)


def fault_from(settings: Mapping[str, Any]) -> Fault:
    """A fault from its settings by name.

    Raises:
        UsageError: one is not known, is missing or makes no sense.
    """
    known = [field.name for field in fields(Fault)]
    for key in settings:
        if key not in known:
            raise UsageError(f"{key}: is not known; there are {', '.join(known)}")
    for key in ("kind", "on"):
        if key not in settings:
            raise UsageError(f"{key}: is missing")
    return Fault(**settings)


def check_together(faults: list[Fault]) -> None:
    """Refuse faults that make no sense beside each other.

    Raises:
        UsageError: a reconnect without a disconnect before; the text begins with the number of the fault, from 1.
    """
    for number, fault in enumerate(faults, 1):
        if fault.kind == "reconnect" and not any(
            other.kind == "disconnect" and place_of(other.on) == place_of(fault.on) and other.at_s < fault.at_s
            for other in faults
        ):
            raise UsageError(f"{number}: kind: reconnect on {fault.on!r} has no disconnect before it, at that place")


def check_protocol(fault: Fault, devices: Mapping[str, str]) -> None:
    """Refuse a wrong reply of a protocol that no device at its place speaks.

    Args:
        fault: anything that goes wrong.
        devices: for each device at its place, by its title, the protocol that it speaks; nothing refuses if there is
            none, as nobody knows then who is there.

    Raises:
        UsageError: it makes no sense there.
    """
    wanted = FORMS[fault.form or "text"].protocol if fault.kind == "wrong_reply" else ""
    if wanted and devices and wanted not in devices.values():
        titles = ", ".join(devices)
        raise UsageError(f"form: {fault.form} on {fault.on!r}: {titles} there speaks no {wanted}")


def place_of(on: object) -> tuple[str, str, int]:
    """What `on` means: kind of channel, address or line (empty for any address), port (0 for a line).

    Raises:
        UsageError: nothing.
    """
    if isinstance(on, int) and not isinstance(on, bool):
        address, port = "", on
    elif isinstance(on, str) and on.strip():
        head, colon, tail = on.strip().rpartition(":")
        if not tail.isdecimal() or (head and not colon):
            if on.strip() not in PORTS:
                raise UsageError(f"on: the robot has no serial port {on!r}; its ports: {', '.join(PORTS)}")
            return LINE, PORTS[on.strip()], 0
        address, port = head, int(tail)
    else:
        raise UsageError(f"on: write a port, such as 5000 or '192.168.1.20:5000', or a serial line, not {on!r}")
    if not 1 <= port <= 65535:
        raise UsageError(f"on: a port must be in [1, 65535], got {port}")
    return TCP, address, port


def _check_number(name: str, value: object, low: float, high: float, unit: str) -> None:
    limits = f"in [{low:g}, {high:g}] {unit}".rstrip()
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise UsageError(f"{name}: must be a number {limits}, got {value!r}")


def _check_whole(name: str, value: object, low: int, high: int) -> None:
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise UsageError(f"{name}: must be a whole number in [{low}, {high}], got {value!r}")
