"""The connection of one SSH client: bytes go to the SSH library and come from it, at the expense of the client's share.

The library is an asyncio protocol that does what a packet asks for as soon as it has it, and starts tasks for the rest.
It is given few bytes at a time: when they have started a task, or have taken the client's share of the tick, the others
wait for the next tick. Its tasks are charged to the client too (`Turns`). To the library this object is a transport.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Coroutine
from typing import Any, Final

from elitescript.messages.inputs import Input
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot import RobotDescription
from elitescript.protocol.connection import Connection
from elitescript.services.clients.shares import Shares
from elitescript.services.clients.turns import Turns

PIECE: Final = 512
"""Bytes that the library is given at once: some twenty packets at most."""


class SshConnection(Connection):
    """One client of the SSH port.

    Args:
        origin: names the client in the log.
        description: the robot.
        shares: of the robot.
        make_due: lets the next tick run.
        make_protocol: makes the library's end of the connection.

    Attributes:
        turns: of the tasks that carry out requests of the client.
        stage: how far it has come on its way to log in; `ADMITTED` once it has.
    """

    __slots__ = ("_has_made", "_is_lost", "_login", "_protocol", "_raw", "_size", "stage", "turns")

    ADMITTED: Final = 3

    def __init__(
        self,
        origin: str,
        description: RobotDescription,
        shares: Shares,
        make_due: Callable[[], object],
        make_protocol: Callable[[SshConnection], Any],
    ) -> None:
        super().__init__(origin, description)
        self.turns = Turns(shares, make_due, lambda: self.is_behind)
        self.stage = 0
        self._raw = bytearray()
        self._size = 0
        """Bytes that came since the last tick."""
        self._is_lost = self._has_made = False
        self._login: Any = None
        """The task that works on a packet of a client that has not logged in; None if there is none."""
        self._protocol = make_protocol(self)
        self._protocol.create_task = self._measured(self._protocol.create_task)
        self._protocol.connection_made(self)

    def _measured(self, create: Callable[..., Any]) -> Callable[..., Any]:
        """Return the library's way to create tasks with a count of what they cost."""

        def create_task(work: Coroutine[Any, Any, None], logger: Any = None) -> Any:
            self._has_made = True
            task = create(self.turns.measured(work), logger)
            if not self.is_admitted:
                self._login = task
            return task

        return create_task

    # ---------------------------------------------------------------- called by the pump

    @property
    def is_admitted(self) -> bool:
        return self.stage >= self.ADMITTED

    @property
    def progress(self) -> int:
        return self.stage

    @property
    def is_busy(self) -> bool:
        return bool(self._raw)

    def receive(self, data: bytes, output: Output) -> list[Input]:
        self.stage = max(self.stage, 1)
        self._raw += data
        self._size += len(data)
        self.turns.is_light = self._size < PIECE and not self.turns.is_waiting
        self._hand_on()
        return []

    def publish(self, output: Output) -> None:
        self._size = 0
        self._hand_on()

    def read_on(self, output: Output) -> list[Input]:
        self._hand_on()
        return []

    def closed(self) -> list[Input]:
        self._raw.clear()
        if not self._is_lost:
            self._is_lost = True
            self._protocol.connection_lost(None)
        return []

    def _hand_on(self) -> None:
        """Give the library what waits, as much as the share of this tick allows."""
        began_ns = time.thread_time_ns()
        if self._login is not None and self._login.done():
            self._login = None
        # While a password is looked at, the library would keep whatever comes, and work on all of it afterwards.
        if self._login is not None:
            return
        while self._raw and not self.is_over and not self.is_behind and not self.turns.is_used_up:
            piece = bytes(self._raw[:PIECE])
            del self._raw[:PIECE]
            self._has_made = False
            self._protocol.data_received(piece)
            now_ns = time.thread_time_ns()
            self.turns.spend(now_ns - began_ns)
            began_ns = now_ns
            if self._has_made:
                # Until the task has run, the library keeps further bytes, and would work on all of them at once then.
                break

    # ---------------------------------------------------------------- called by the library

    def write(self, data: bytes) -> None:
        """Send bytes."""
        self.send(bytes(data))
        self.attend()

    def close(self) -> None:
        """End the connection once what waits has been sent."""
        self.is_over = True
        self.attend()

    def abort(self) -> None:
        """End the connection."""
        self.close()

    def is_closing(self) -> bool:
        """Return whether it is to end."""
        return self.is_over

    def get_extra_info(self, name: str, default: Any = None) -> Any:
        """Return nothing: the address of a client is no matter of the library."""
        return default
