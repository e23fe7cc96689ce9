"""Faults of channels and inputs: what there is, on what it makes sense, and one fault as it is asked for.

`TABLE` is the one place for which fault a TCP connection, a serial line, a digital or an analog input can have;
what is refused, what the documentation prints, and what `faulty_channels` and
`controller.signals.input_faults` do follow it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Final

from elitescript.environment.line_bindings import PORTS
from elitescript.errors import UsageError, did_you_mean
from elitescript.messages.signals import ANALOG_VOLTAGE_V, SIGNALS, parse_signal_name
from elitescript.messages.timing import PERIOD_S, TICKS_PER_S, ticks_for
from elitescript.records import NamedTuple, fields_of, record

TCP: Final = "tcp"
LINE: Final = "line"
DIGITAL: Final = "digital"
ANALOG: Final = "analog"
DEVICE: Final = "device"
"""Kinds of places; what the name of a device means is known in a world only."""

INPUTS: Final = {
    **dict.fromkeys(("standard_digital_in", "configurable_digital_in", "tool_digital_in"), DIGITAL),
    **dict.fromkeys(("standard_analog_in", "tool_analog_in"), ANALOG),
}
"""Families of signals that a wire leads to, each with its kind of place."""

MODBUS: Final = "MODBUS"
XML_RPC: Final = "XML-RPC"


class FaultEffect(NamedTuple):
    """What a fault does to a channel of one kind, or why there is no such thing."""

    text: str
    is_possible: bool = True


_OF_INPUTS: Final = "it is a fault of inputs. Take drop, delay, corrupt"
_OF_CHANNELS: Final = "it is a fault of connections and serial lines. Take stuck, bouncing, open_wire, noisy, late"
_NO_CHANNEL: Final = FaultEffect(_OF_INPUTS, False)
_NO_INPUT: Final = FaultEffect(_OF_CHANNELS, False)


class FaultKind(NamedTuple):
    """One row: a kind of fault."""

    name: str
    tcp: FaultEffect = _NO_CHANNEL
    line: FaultEffect = _NO_CHANNEL
    takes: tuple[str, ...] = ()
    """Settings that it has besides those of all faults."""
    directions: bool = True
    """Whether it can be limited to one direction, and to certain messages."""
    digital: FaultEffect = _NO_INPUT
    analog: FaultEffect = _NO_INPUT

    @property
    def is_of_inputs(self) -> bool:
        """Whether inputs can have it; then channels cannot."""
        return self.digital.is_possible or self.analog.is_possible

    def effect(self, channel: str) -> FaultEffect:
        """Return what it does at a place of one kind."""
        return {TCP: self.tcp, LINE: self.line, DIGITAL: self.digital, ANALOG: self.analog}[channel]


def _of_inputs(name: str, digital: FaultEffect, analog: FaultEffect, takes: tuple[str, ...] = ()) -> FaultKind:
    return FaultKind(name, takes=takes, directions=False, digital=digital, analog=analog)


_ROWS: Final = (
    FaultKind(
        "refuse",
        FaultEffect("new connections are refused; those that stand go on"),
        FaultEffect("a serial line cannot refuse: opening it needs no peer. Take silence", False),
        directions=False,
    ),
    FaultKind(
        "silence",
        FaultEffect("attempts to connect are not answered; bytes are lost, the connection stands"),
        FaultEffect("bytes are lost"),
    ),
    FaultKind("drop", FaultEffect("the message is lost"), FaultEffect("the message is lost")),
    FaultKind(
        "delay",
        FaultEffect("the message comes delay_s later; nothing overtakes it"),
        FaultEffect("the message comes delay_s later; nothing overtakes it"),
        ("delay_s",),
        digital=FaultEffect("it is a fault of connections and serial lines. Take late", False),
        analog=FaultEffect("it is a fault of connections and serial lines. Take late", False),
    ),
    FaultKind("duplicate", FaultEffect("the message comes twice"), FaultEffect("the message comes twice")),
    FaultKind(
        "corrupt",
        FaultEffect("one bit in each eight bytes of the message is wrong, and one at least"),
        FaultEffect("one bit in each eight bytes of the message is wrong, and one at least"),
    ),
    FaultKind(
        "trickle",
        FaultEffect("the message comes with chunk bytes in each control period"),
        FaultEffect("the message comes with chunk bytes in each control period"),
        ("chunk",),
    ),
    FaultKind(
        "wrong_reply",
        FaultEffect("what the device sends is replaced, see form"),
        FaultEffect("what the device sends is replaced, see form"),
        ("form", "reply", "code"),
    ),
    FaultKind(
        "disconnect",
        FaultEffect("connections break; new ones are refused until reconnect, or until for_s is over"),
        FaultEffect("the plug is out: bytes are lost until reconnect, or until for_s is over"),
        directions=False,
    ),
    FaultKind(
        "reconnect",
        FaultEffect("connecting is possible again after a disconnect"),
        FaultEffect("the plug is in again after a disconnect"),
        directions=False,
    ),
    _of_inputs(
        "stuck",
        FaultEffect("reads value all the time, or the level that it had"),
        FaultEffect("reads value all the time, or the level that it had"),
        ("value",),
    ),
    _of_inputs(
        "inverted",
        FaultEffect("reads the opposite"),
        FaultEffect("an analog level has no opposite", False),
    ),
    _of_inputs(
        "bouncing",
        FaultEffect("after each edge the level goes bounces times to and fro within settle_s, at ticks that are drawn"),
        FaultEffect("an analog input has no edges. Take noisy", False),
        ("settle_s", "bounces", "seed"),
    ),
    _of_inputs(
        "open_wire",
        FaultEffect("reads low, or value"),
        FaultEffect("reads 0 V, or 0 A, which is below the 4 mA of a sensor; or value"),
        ("value",),
    ),
    _of_inputs(
        "drifting",
        FaultEffect("a digital input has two levels only. Take noisy", False),
        FaultEffect("goes away from what is applied by per_s in a second, by bound at most, in steps every every_s"),
        ("per_s", "bound", "every_s"),
    ),
    _of_inputs(
        "noisy",
        FaultEffect(
            "reads the opposite for one control period, rate_hz times a second on average, at ticks that are drawn"
        ),
        FaultEffect(
            "a normally distributed deviation with the standard deviation sigma is added, a new one every every_s"
        ),
        ("sigma", "rate_hz", "every_s", "seed"),
    ),
    _of_inputs(
        "late",
        FaultEffect("every change is read delay_s later"),
        FaultEffect("every change is read delay_s later"),
        ("delay_s",),
    ),
)

TABLE: Final[dict[str, FaultKind]] = {row.name: row for row in _ROWS}
"""All kinds by name."""


class WrongReplyKind(NamedTuple):
    """One row: what a wrong reply is."""

    name: str
    tcp: FaultEffect
    line: FaultEffect
    takes: tuple[str, ...] = ()
    protocol: str = ""
    """What the device must speak for it to mean anything."""


_FORM_ROWS: Final = (
    WrongReplyKind("text", FaultEffect("the bytes of reply"), FaultEffect("the bytes of reply"), ("reply",)),
    WrongReplyKind(
        "exception",
        FaultEffect("a MODBUS exception with the number code"),
        FaultEffect("a MODBUS exception with the number code"),
        ("code",),
        protocol=MODBUS,
    ),
    WrongReplyKind(
        "transaction",
        FaultEffect("a MODBUS answer to another transaction"),
        FaultEffect("frames of MODBUS RTU have no transaction", False),
        protocol=MODBUS,
    ),
    WrongReplyKind(
        "unit",
        FaultEffect("a MODBUS answer of another unit"),
        FaultEffect("a MODBUS answer of another unit"),
        protocol=MODBUS,
    ),
    WrongReplyKind(
        "checksum",
        FaultEffect("frames of MODBUS TCP have no checksum", False),
        FaultEffect("a MODBUS answer with a wrong checksum"),
        protocol=MODBUS,
    ),
    WrongReplyKind(
        "fault",
        FaultEffect("an XML-RPC fault with the number code and the text reply"),
        FaultEffect("XML-RPC does not go over a serial line", False),
        ("code", "reply"),
        protocol=XML_RPC,
    ),
    WrongReplyKind(
        "http",
        FaultEffect("an HTTP answer with the status code"),
        FaultEffect("HTTP does not go over a serial line", False),
        ("code",),
        protocol=XML_RPC,
    ),
)

FORMS: Final[dict[str, WrongReplyKind]] = {row.name: row for row in _FORM_ROWS}
"""All forms of a wrong reply by name."""

BOTH: Final = "both"
TO_ROBOT: Final = "to_robot"
TO_DEVICE: Final = "to_device"
DIRECTIONS: Final = (BOTH, TO_ROBOT, TO_DEVICE)

DELAY_MAX_S: Final = 3600.0
SETTLE_MAX_S: Final = 60.0


@record
class Fault:
    """Something that goes wrong on a channel or at an input.

    A message is what a program sends with one command, or what arrives from the device in one control period; what
    comes over a serial line without a pause is one message.

    Attributes:
        kind: see `TABLE`.
        on: a TCP port such as `5000`, an address and port such as `"192.168.1.20:5000"`, a serial line such as
            `"tool"`, an input such as `"standard_digital_in[3]"`; or the name of a device of the world, for its port,
            its line or the input that it sets.
        at_s: from then on, in the robot's time.
        for_s: for so long; to the end if None.
        nth: the first message that it meets, counted from `at_s`; the first one is 1.
        count: how many messages it meets; all if None.
        direction: `to_robot`, `to_device` or `both`.
        share: of these messages it meets this share, drawn at random.
        delay_s: of `delay` and `late`.
        chunk: of `trickle`, bytes.
        form: of `wrong_reply`, see `FORMS`.
        reply: of `wrong_reply`.
        code: of `wrong_reply`.
        value: of `stuck` and `open_wire`, what is read: true or false, V or A.
        settle_s: of `bouncing`, two control periods for each bounce at least.
        bounces: of `bouncing`, how often the level goes to and fro after an edge.
        per_s: of `drifting`, V/s or A/s.
        bound: of `drifting`, V or A; to the end of the range if None.
        sigma: of `noisy` at an analog input, V or A.
        rate_hz: of `noisy` at a digital input, 250 at most.
        every_s: of `drifting` and `noisy`, how often an analog level changes.
        seed: of what `bouncing` and `noisy` draw; that of the world if None.

    Raises:
        UsageError: there is no such fault, it makes no sense at that place, or its settings do not go together.

    Example:
        >>> from elitescript.testing.world import Fault, ModbusDevice, SerialDevice, TcpServer, World
        >>> devices = [TcpServer(port=5000), ModbusDevice(port=502), SerialDevice(line="tool")]
        >>> world = World(devices, faults=[
        ...     Fault("refuse", on=5000, for_s=2.0),
        ...     Fault("delay", on=5000, delay_s=0.5, at_s=10.0, direction="to_robot"),
        ...     Fault("corrupt", on="tool", nth=3, count=1),
        ...     Fault("wrong_reply", on=502, form="exception", code=6, nth=2, count=1),
        ...     Fault("bouncing", on="standard_digital_in[3]", settle_s=0.04),
        ...     Fault("noisy", on="standard_analog_in[0]", sigma=0.02, at_s=5.0, for_s=10.0),
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
    value: bool | float | None = None
    settle_s: float = 0.02
    bounces: int = 2
    per_s: float = 0.0
    bound: float | None = None
    sigma: float = 0.0
    rate_hz: float = 0.0
    every_s: float = PERIOD_S
    seed: int | None = None

    def __post_init__(self) -> None:
        kind: Any = self.kind
        row = TABLE.get(kind) if isinstance(kind, str) else None
        if row is None:
            near = did_you_mean(kind, TABLE) if isinstance(kind, str) else ""
            raise UsageError(f"kind: there is no fault {self.kind!r}; there are {', '.join(TABLE)}{near}")
        channel, _, _ = place_of(self.on)
        if channel != DEVICE:
            effect = row.effect(channel)
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

    def _check_settings(self, row: FaultKind, channel: str) -> None:
        for name, default in _DEFAULTS.items():
            # Not `!=`: a list, or a number that is not a number, is no default either.
            if name not in row.takes and getattr(self, name) is not default and getattr(self, name) != default:
                owners = ", ".join(other.name for other in TABLE.values() if name in other.takes)
                raise UsageError(f"{name}: {self.kind} has no such setting; {owners} has")
        if not row.directions:
            for name, plain in (("direction", BOTH), ("nth", 1), ("count", None), ("share", 1.0)):
                if getattr(self, name) != plain:
                    what = "an input" if row.is_of_inputs else "the whole channel"
                    raise UsageError(f"{name}: {self.kind} is about {what}, not about messages")
        if self.kind == "reconnect" and self.for_s is not None:
            raise UsageError("for_s: reconnect happens at a moment; give disconnect a for_s instead")
        if "delay_s" in row.takes:
            _check_number("delay_s", self.delay_s, 0.0, DELAY_MAX_S, "s")
            if ticks_for(self.delay_s) < 1:
                raise UsageError(f"delay_s: must be one control period at least, got {self.delay_s!r} s")
        _check_whole("chunk", self.chunk, 1, 65536)
        if self.kind == "wrong_reply":
            self._check_reply(channel)
        if row.is_of_inputs:
            self._check_input(channel)

    def _check_input(self, channel: str) -> None:
        """Look at the settings of a fault of an input; which kind of input it is, is not known of a device's name."""
        if self.value is not None:
            if channel == DIGITAL and not isinstance(self.value, bool):
                raise UsageError(f"value: {self.on} reads true or false, not {self.value!r}")
            if channel == ANALOG:
                _check_number("value", self.value, *ANALOG_VOLTAGE_V, "V or A")
            elif channel == DEVICE and not isinstance(self.value, bool | int | float):
                raise UsageError(f"value: must be a level, true or false, V or A, got {self.value!r}")
        if self.seed is not None:
            _check_whole("seed", self.seed, -(2**63), 2**63 - 1)
        if self.kind == "bouncing":
            _check_whole("bounces", self.bounces, 1, 1000)
            _check_number("settle_s", self.settle_s, 0.0, SETTLE_MAX_S, "s")
            if ticks_for(self.settle_s) < 2 * self.bounces:
                least = 2 * self.bounces * PERIOD_S
                raise UsageError(
                    f"settle_s: {self.bounces} bounces need two control periods each, {least:g} s, "
                    f"got {self.settle_s:g} s"
                )
        if self.kind in ("drifting", "noisy"):
            _check_number("every_s", self.every_s, PERIOD_S, DELAY_MAX_S, "s")
        if self.kind == "drifting":
            _check_number("per_s", self.per_s, -1e6, 1e6, "V/s or A/s")
            if not self.per_s:
                raise UsageError("per_s: is missing; drifting needs V/s or A/s, such as 0.1")
            if self.bound is not None:
                _check_number("bound", self.bound, 0.0, 1e6, "V or A")
        if self.kind == "noisy":
            self._check_noise(channel)

    def _check_noise(self, channel: str) -> None:
        _check_number("rate_hz", self.rate_hz, 0.0, TICKS_PER_S, "1/s")
        _check_number("sigma", self.sigma, 0.0, 1e6, "V or A")
        if channel == DIGITAL and (self.sigma or self.every_s != PERIOD_S):
            raise UsageError(f"{'sigma' if self.sigma else 'every_s'}: a digital input has rate_hz")
        if channel == ANALOG and self.rate_hz:
            raise UsageError("rate_hz: an analog input has sigma")
        if not self.rate_hz and channel in (DIGITAL, DEVICE) and not self.sigma:
            raise UsageError("rate_hz: is missing; noisy needs flips a second, such as 5")
        if not self.sigma and channel == ANALOG:
            raise UsageError("sigma: is missing; noisy needs a standard deviation in V or A, such as 0.02")

    def _check_reply(self, channel: str) -> None:
        given: Any = self.form
        form = FORMS.get(given or "text") if isinstance(given, str) else None
        if form is None:
            near = did_you_mean(given, FORMS) if isinstance(given, str) else ""
            raise UsageError(f"form: there is no {self.form!r}; there are {', '.join(FORMS)}{near}")
        effect = form.line if channel == LINE else form.tcp
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
        return title_of(self.kind, self.on)


def title_of(kind: str, on: int | str) -> str:
    """Return a fault in words, such as `drop on port 5000`."""
    return f"{kind} on {'port ' if isinstance(on, int) else ''}{on}"


_DEFAULTS: Final[dict[str, Any]] = {
    name: field.default for name, field in fields_of(Fault).items() if any(name in row.takes for row in TABLE.values())
}
"""Settings of certain kinds only."""


def fault_from(settings: Mapping[str, Any]) -> Fault:
    """Return a fault from its settings by name.

    Raises:
        UsageError: one is not known, is missing or makes no sense.
    """
    known = list(fields_of(Fault))
    for key in settings:
        if key not in known:
            near = did_you_mean(str(key), known)
            raise UsageError(f"{key}: is not known; there are {', '.join(known)}{near}")
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
            none, as it is not known then which are there.

    Raises:
        UsageError: it makes no sense there.
    """
    wanted = FORMS[fault.form or "text"].protocol if fault.kind == "wrong_reply" else ""
    if wanted and devices and wanted not in devices.values():
        titles = ", ".join(devices)
        raise UsageError(f"form: {fault.form} on {fault.on!r}: {titles} there speaks no {wanted}")


def place_of(on: object) -> tuple[str, str, int]:
    """Return what `on` means.

    Returns:
        `TCP`, address (empty for any) and port; `LINE`, device and 0; `DIGITAL` or `ANALOG`, family and index of an
        input; `DEVICE`, name and 0 for what may be the name of a device.

    Raises:
        UsageError: nothing.
    """
    if isinstance(on, int) and not isinstance(on, bool):
        address, port = "", on
    elif isinstance(on, str) and on.strip():
        head, colon, tail = on.strip().rpartition(":")
        if not tail.isdecimal() or (head and not colon):
            return _named_place(on.strip())
        address, port = head, int(tail)
    else:
        raise UsageError(
            "on: write a port, such as 5000 or '192.168.1.20:5000', a serial line, an input or the name of a device, "
            f"not {on!r}"
        )
    if not 1 <= port <= 65535:
        raise UsageError(f"on: a port must be in [1, 65535], got {port}")
    return TCP, address, port


def _named_place(name: str) -> tuple[str, str, int]:
    if name in PORTS:
        return LINE, PORTS[name], 0
    if name.partition("[")[0].strip() not in SIGNALS and "[" not in name:
        return DEVICE, name, 0
    try:
        row, index = parse_signal_name(name)
    except UsageError as error:
        raise UsageError(f"on: {error}") from None
    if row.name not in INPUTS:
        what = "an output" if not row.is_input else "no digital or analog input"
        raise UsageError(f"on: {name} is {what}; inputs that can be disturbed are {', '.join(INPUTS)}")
    return INPUTS[row.name], row.name, index


def is_of_input(fault: Fault) -> bool:
    """Return whether it is about an input."""
    return TABLE[fault.kind].is_of_inputs


def nowhere(on: object, names: Iterable[str]) -> UsageError:
    """Return the error for a place that no device, line or signal has.

    Args:
        on: what was written.
        names: of the devices that there are.
    """
    known = list(names)
    near = did_you_mean(str(on), [*known, *PORTS, *INPUTS])
    devices = f"; devices are {', '.join(known)}" if known else ""
    return UsageError(
        f"on: there is no device, serial port or input {on!r}{near}; serial ports are {', '.join(PORTS)}{devices}"
    )


def _check_number(name: str, value: object, low: float, high: float, unit: str) -> None:
    limits = f"in [{low:g}, {high:g}] {unit}".rstrip()
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise UsageError(f"{name}: must be a number {limits}, got {value!r}")


def _check_whole(name: str, value: object, low: int, high: int) -> None:
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise UsageError(f"{name}: must be a whole number in [{low}, {high}], got {value!r}")
