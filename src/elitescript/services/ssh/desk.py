"""The SSH side of a robot: its SSH port, the files behind it, its log, and bridges to its serial ports."""

from __future__ import annotations

from typing import Final

from elitescript.messages.events import Event
from elitescript.messages.snapshot import RobotDescription
from elitescript.protocol.connection import Connection
from elitescript.protocol.ports import Service
from elitescript.services.clients.binding import bind_one
from elitescript.services.clients.listener import Listener
from elitescript.services.clients.tcp import Hub
from elitescript.services.log import SSH as LOG_KIND
from elitescript.services.log import ServerLog
from elitescript.services.port_numbers import SSH
from elitescript.services.ssh.commands import DATA_PATH
from elitescript.services.ssh.connection import SshConnection
from elitescript.services.ssh.controller_history import ControllerHistory
from elitescript.services.ssh.files import RobotFiles
from elitescript.services.ssh.line_taps import LineTaps
from elitescript.services.ssh.serial_bridges import SerialBridges
from elitescript.services.ssh.server import SshPort

ACCEPTS_PER_TICK: Final = 1
"""A client that logs in at once has done so before many others have come that never do."""
LOG_PATH: Final = DATA_PATH + "log/log_history.csv"


class SshDesk:
    """Keeps the SSH side of one robot together.

    Args:
        log: takes lines about problems.
        password: that clients log in with.

    Attributes:
        taps: what passes to and from the serial lines of the robot goes through them.
        listener: of the port; None before `bind`.
    """

    __slots__ = ("_bridges", "_history", "_log", "_password", "_port", "listener", "taps")

    def __init__(self, log: ServerLog, password: str) -> None:
        self._log = log
        self._password = password
        self._history = ControllerHistory()
        self._bridges: SerialBridges | None = None
        self._port: SshPort | None = None
        self.taps = LineTaps(self._warn)
        self.listener: Listener | None = None

    @property
    def number(self) -> int:
        """Of the port; 0 before `bind`."""
        return 0 if self.listener is None else self.listener.number

    @property
    def fingerprint(self) -> str:
        """Of the host key; empty before `open`."""
        return "" if self._port is None else self._port.fingerprint

    def take_event(self, event: Event) -> None:
        """Write an event of the robot into the log file that clients download."""
        self._history.take(event)

    def bind(self, host: str, number: int, spare: int | None, hub: Hub, description: RobotDescription) -> None:
        """Take the port.

        Args:
            host: address to listen at.
            number: of the port.
            spare: what to take instead of a number that this user may not have.
            hub: the robot.
            description: of the robot.

        Raises:
            UsageError: it cannot be had.
        """
        bound, note = bind_one(SSH.name, host, number, spare)
        if note:
            self._log.note("spare_port", note, is_problem=True, port=SSH.name, number=bound.getsockname()[1])
        self._bridges = SerialBridges(host, self.taps)
        port = SshPort(self._password, RobotFiles({LOG_PATH: self._history.text}), self._bridges, self._warn)
        self._port = port

        def connect(origin: str) -> Connection:
            return SshConnection(origin, description, hub.shares, hub.make_due, port.make_protocol)

        service = Service(SSH.name, SSH.number, SSH.summary, SSH.evidence, lambda _: connect)
        self.listener = Listener(service, hub, connect, bound, accepts_per_tick=ACCEPTS_PER_TICK)

    def release(self) -> None:
        """Give the port back: another one cannot be had."""
        if self.listener is not None:
            self.listener.release()

    async def open(self) -> None:
        """Accept clients."""
        assert self._port is not None and self.listener is not None
        await self._port.open()
        await self.listener.open()

    async def close(self) -> None:
        """Let clients go, end every bridge."""
        if self.listener is not None:
            await self.listener.close()
        if self._bridges is not None:
            self._bridges.close_all()

    def _warn(self, text: str) -> None:
        self._log.note(LOG_KIND, text, is_problem=True)
