"""Serial devices beside the robot: on the tool's RS-485, or on a line of the control box."""

from __future__ import annotations

from typing import Final

from elitescript.devices.channels.network import DeviceLink, Peer
from elitescript.devices.device import Device, DeviceContext, TakenError, check_number, check_text
from elitescript.devices.kinds.lines import Answer, LineBuffer, check_lines, encoded
from elitescript.devices.kinds.tcp import INCOMPLETE_S, LATENCY_MAX_S
from elitescript.environment.line_bindings import PORTS
from elitescript.errors import UsageError
from elitescript.messages.line import LineSettings
from elitescript.said import said

BAUD_MAX: Final = 10_000_000


def line_device(key: str, line: str) -> str:
    """Return the device that the name of a line means.

    Raises:
        UsageError: the robot has no such line; the text begins with the name of the setting.
    """
    if line not in PORTS:
        raise UsageError(f"{key}: the robot has no serial port {line!r}; its ports: {', '.join(PORTS)}")
    return PORTS[line]


class LineDevice(Device):
    """What every device on a serial line is.

    Attributes:
        line: name of the line: `tool`, `box`, or a device of the control box such as `/dev/ttyS2`.
        baud: bits per second that it understands, or 0 for any. At another speed both sides get rubbish.
        latency_s: time that it thinks before what it sends goes out.
        settings: of the line while a program has it open, else None.
    """

    line: str = ""
    baud: int = 0
    latency_s: float = 0.0

    _link: DeviceLink | None = None

    def check(self) -> None:
        check_text("line", self.line)
        self.line = line_device("line", self.line)
        check_number("baud", self.baud, 0, BAUD_MAX, "bit/s", is_whole=True)
        check_number("latency_s", self.latency_s, 0.0, LATENCY_MAX_S, "s")

    def line_opened(self) -> None:
        """Act on a program that has opened the line."""

    def bytes_received(self, data: bytes) -> None:
        """Take bytes of the line, as far as they can be understood."""

    def line_closed(self) -> None:
        """Act on the end: the program has closed the line, or has ended."""

    @property
    def settings(self) -> LineSettings | None:
        """Of the line while a program has it open."""
        return None if self._link is None else self._link.settings

    def send_bytes(self, data: bytes) -> None:
        """Send over the line; lost while no program has it open."""
        if data and self._link is not None:
            self._link.send(self.understood(data))

    # ---------------------------------------------------------------- called by the world

    def join(self, context: DeviceContext) -> None:
        super().join(context)
        taken = context.network.lines.get(self.line)
        if taken is not None:
            other = getattr(taken, "__self__", None)
            text = said(
                "line: {line} is taken by {owner} already",
                line=self.line,
                owner=getattr(other, "title", "another device"),
            )
            raise TakenError(text, other)
        context.network.lines[self.line] = self.accept

    def accept(self, link: DeviceLink) -> Peer | None:
        """Accept a program that opens the line."""
        link.shape(latency_s=self.latency_s, owner=self)
        return _LinePeer(self, link)

    def hold(self, link: DeviceLink) -> None:
        """Note that the line is open."""
        self._link = link

    def let_go(self, link: DeviceLink) -> None:
        """Note that the line is closed, unless another program has opened it by now."""
        if self._link is link:
            self._link = None

    def understood(self, data: bytes) -> bytes:
        """Return the bytes as the other side understands them."""
        settings = self.settings
        if settings is None or not self.baud or settings.baud == self.baud:
            return data
        return self.random.randbytes(len(data))


class SerialDevice(LineDevice):
    r"""A device on a serial line, such as a weighing cell.

    Override `line_received`, or `received` for what is not made of lines. A text that `opened`, `received` or
    `line_received` returns is sent as a line, bytes are sent as they are, and None sends nothing. Bytes take as long as
    at the settings of the line, in both directions.

    Attributes:
        line: name of the line: `tool`, or a device of the control box such as `/dev/ttymxc0`.
        baud: bits per second that it understands, or 0 for any. At another speed both sides get rubbish.
        latency_s: time that it thinks before what it sends goes out.
        line_end: ends the lines of both sides. If empty, whatever arrives in one control period counts as a line.
        encoding: of texts.

    Example:
        >>> from elitescript.testing.world import SerialDevice, World
        >>> class Scale(SerialDevice):
        ...     line = "/dev/ttymxc0"
        ...     line_end = "\r\n"
        ...     def line_received(self, line):
        ...         if line == "W":
        ...             return f"{self.random.gauss(1.250, 0.001):.3f} kg"
        >>> world = World(devices=[Scale()])
    """

    line_end: str = "\n"
    encoding: str = "ascii"

    _lines: LineBuffer | None = None
    _has_complained = False

    def opened(self) -> Answer:
        """Act on a program that has opened the line."""
        return None

    def received(self, data: bytes) -> Answer:
        """Take bytes; without an override they are cut into lines for `line_received`."""
        if self._lines is None:
            self._lines = LineBuffer(self.line_end, self.encoding)
        lines = self._lines
        for line in lines.receive(data):
            self.send(self.line_received(line))
        if (rest := lines.rest) and not self._has_complained:
            self.after(INCOMPLETE_S, lambda: self._complain(lines, rest))
        return None

    def _complain(self, lines: LineBuffer, rest: bytes) -> None:
        if rest and lines is self._lines and lines.rest == rest and not self._has_complained:
            self._has_complained = True
            self.warn(
                said(
                    "waits for the end of the line {rest!r}: its line_end is {line_end!r}; a device with "
                    'line_end = "" takes whatever arrives together',
                    rest=rest[:60],
                    line_end=self.line_end,
                )
            )

    def line_received(self, line: str) -> Answer:
        """Take a line, without its end."""
        self.miss_method("line_received(self, line)", line)
        return None

    def closed(self) -> None:
        """Act on the end: the program has closed the line, or has ended."""

    def send(self, answer: Answer) -> None:
        """Send a text as a line, or bytes as they are; lost while no program has the line open."""
        if answer is not None:
            self.send_bytes(encoded(answer, self.line_end, self.encoding))

    # ---------------------------------------------------------------- called by the world

    def check(self) -> None:
        super().check()
        check_lines(self.line_end, self.encoding)

    def line_opened(self) -> None:
        self._lines = None
        self.send(self.opened())

    def bytes_received(self, data: bytes) -> None:
        self.send(self.received(data))

    def line_closed(self) -> None:
        self.run_ended()
        self.closed()

    def run_ended(self) -> None:
        if self._lines is not None:
            self._complain(self._lines, self._lines.rest)


class _LinePeer(Peer):
    """The line, open."""

    def __init__(self, device: LineDevice, link: DeviceLink) -> None:
        super().__init__(link)
        self._device = device

    def opened(self) -> None:
        self._device.hold(self.link)
        self._device.line_opened()

    def received(self, data: bytes) -> None:
        self._device.bytes_received(self._device.understood(data))

    def closed(self) -> None:
        self._device.let_go(self.link)
        self._device.line_closed()
