"""The SSH side of a robot: its SSH port, the files behind it, its log, and bridges to its serial ports."""

from __future__ import annotations

import socket
from typing import Final

from elitescript.messages.events import Event
from elitescript.services.clients.binding import bind_one
from elitescript.services.log import SSH as LOG_KIND
from elitescript.services.log import ServerLog
from elitescript.services.port_numbers import SSH
from elitescript.services.ssh.commands import DATA_PATH
from elitescript.services.ssh.controller_history import ControllerHistory
from elitescript.services.ssh.files import RobotFiles
from elitescript.services.ssh.line_taps import LineTaps
from elitescript.services.ssh.serial_bridges import SerialBridges
from elitescript.services.ssh.server import SshPort

LOG_PATH: Final = DATA_PATH + "log/log_history.csv"


class SshDesk:
    """Keeps the SSH side of one robot together.

    Args:
        log: takes lines about problems.
        password: that clients log in with.

    Attributes:
        taps: what passes to and from the serial lines of the robot goes through them.
    """

    __slots__ = ("_bound", "_bridges", "_history", "_log", "_password", "_port", "number", "taps")

    def __init__(self, log: ServerLog, password: str) -> None:
        self._log = log
        self._password = password
        self._history = ControllerHistory()
        self._bound: socket.socket | None = None
        self._bridges: SerialBridges | None = None
        self._port: SshPort | None = None
        self.taps = LineTaps(self._warn)
        self.number = 0
        """Of the port; 0 before `bind`."""

    @property
    def fingerprint(self) -> str:
        """Of the host key; empty before `open`."""
        return "" if self._port is None else self._port.fingerprint

    def take_event(self, event: Event) -> None:
        """Write an event of the robot into the log file that clients download."""
        self._history.take(event)

    def bind(self, host: str, number: int, spare: int | None) -> None:
        """Take the port.

        Raises:
            UsageError: it cannot be had.
        """
        self._bound, note = bind_one(SSH.name, host, number, spare)
        self.number = self._bound.getsockname()[1]
        if note:
            self._log.note("spare_port", note, is_problem=True, port=SSH.name, number=self.number)
        self._bridges = SerialBridges(host, self.taps)
        self._port = SshPort(self._password, RobotFiles({LOG_PATH: self._history.text}), self._bridges, self._warn)

    def release(self) -> None:
        """Give the port back: another one cannot be had."""
        if self._bound is not None:
            self._bound.close()
            self._bound = None

    async def open(self) -> None:
        """Accept clients."""
        assert self._port is not None and self._bound is not None
        await self._port.open(self._bound)

    async def close(self) -> None:
        """Let clients go, end every bridge."""
        if self._port is not None:
            await self._port.close()
        if self._bridges is not None:
            self._bridges.close_all()
        self.release()

    def _warn(self, text: str) -> None:
        self._log.note(LOG_KIND, text, is_problem=True)
