"""`serve`: several robots in one process, opened and closed as one."""

from __future__ import annotations

import asyncio
import contextlib
import gc
from collections.abc import Mapping, Sequence

from elitescript.services.control.channel import ControlChannel, address_of
from elitescript.services.robot_server import RobotServer


class ServeSession:
    """Opens, runs and closes all robots of one `serve`.

    Args:
        servers: the robots.
        hosts: address that each robot is served at.
        numbers: of each robot, its port for each service; 0 takes a free one.
        instance: of the first robot; the control channel of each is found by its instance.
        spares: of each robot, what stands in for ports that this user may not have; nothing if there are none.
    """

    __slots__ = ("_controls", "_instance", "_numbers", "_spares", "hosts", "servers")

    def __init__(
        self,
        servers: Sequence[RobotServer],
        hosts: tuple[str, ...],
        numbers: Sequence[Mapping[str, int]],
        instance: int,
        spares: Sequence[Mapping[str, int]] = (),
    ) -> None:
        self.servers = tuple(servers)
        for server in self.servers:
            server.shares.robots = len(self.servers)
        self.hosts = hosts
        self._numbers = tuple(numbers)
        self._spares = tuple(spares) or ({},) * len(self._numbers)
        self._instance = instance
        self._controls: list[ControlChannel] = []

    async def open(self) -> None:
        """Bring the robots up, take every port, then accept clients on all of them.

        Raises:
            UsageError: a port cannot be had. Then nothing is open.
        """
        try:
            for server in self.servers:
                await server.boot()
            places = zip(self.servers, self.hosts, self._numbers, self._spares, strict=True)
            for server, host, numbers, spares in places:
                server.bind(host, numbers, spares)
            for index, server in enumerate(self.servers):
                control = ControlChannel(server, self._instance + index)
                await control.open()
                self._controls.append(control)
            own = {number for server in self.servers for number in server.ports.values()}
            own.update(control.port for control in self._controls if control.port)
            for server in self.servers:
                server.broker.policy.own_ports |= own
            # What is there now stays; the collector need not look at it in every round.
            gc.collect()
            gc.freeze()
            for server in self.servers:
                await server.open()
        except BaseException:
            await self.close()
            raise

    @property
    def control_addresses(self) -> tuple[str, ...]:
        """Where `ctl` finds each robot."""
        return tuple(control.address for control in self._controls)

    @property
    def usual_addresses(self) -> tuple[str, ...]:
        """Where `ctl` looks for each robot by its instance."""
        return tuple(str(address_of(self._instance + index)) for index in range(len(self._controls)))

    async def run(self, stop: asyncio.Event) -> None:
        """Serve until `stop` is set.

        Raises:
            Exception: what has ended a robot's time.
        """
        stopped = asyncio.get_running_loop().create_task(stop.wait())
        try:
            done, _ = await asyncio.wait(
                [stopped, *(server.task for server in self.servers)], return_when=asyncio.FIRST_COMPLETED
            )
            for task in done:
                await task
        finally:
            stopped.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await stopped

    async def close(self) -> None:
        """Close every port, let every client and robot go; also what is only half open."""
        for control in self._controls:
            await control.close()
        for server in self.servers:
            await server.close()
