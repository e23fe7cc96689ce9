"""A computer that controls the robot through a program on it: three servers, numbers in network order.

It speaks as the clients of the external-control programs do: commands of eight numbers with a mode on one connection,
points of 21 numbers on the second, commands of 26 numbers on the third. Everything is in virtual time.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence

from elitescript.devices.channels.network import DeviceLink, Peer, VirtualNetwork

REVERSE, TRAJECTORY, COMMANDS = 50001, 50003, 50004
STOPPED, IDLE, SERVOJ, SPEEDJ, TRAJECTORY_MODE, SPEEDL, POSE, FREEDRIVE = -2, 0, 1, 2, 3, 4, 5, 6
SERVOJ_QUEUE, POSE_QUEUE = 8, 9
MICRO = 1_000_000
ZEROS = (0.0,) * 6


class _Accepted(Peer):
    def __init__(self, link: DeviceLink, pc: Pc, port: int) -> None:
        super().__init__(link)
        self.pc = pc
        self.port = port

    def opened(self) -> None:
        self.pc.links[self.port] = self.link
        self.pc.accepted.append(self.port)

    def received(self, data: bytes) -> None:
        assert self.port == TRAJECTORY
        self.pc.results += struct.unpack(f">{len(data) // 4}i", data)

    def closed(self) -> None:
        self.pc.closed.append((self.port, self.link.time_s))


class Pc:
    """The computer.

    Attributes:
        channels: the network in which its servers are.
        links: the present connection of each port.
        accepted: ports in the order in which they were connected to.
        closed: which ports the robot has closed, and when.
        results: numbers that came back on the connection of the points.
    """

    def __init__(self) -> None:
        ports = (REVERSE, TRAJECTORY, COMMANDS)
        self.links: dict[int, DeviceLink] = {}
        self.accepted: list[int] = []
        self.closed: list[tuple[int, float]] = []
        self.results: list[int] = []
        self.channels = VirtualNetwork({port: self._server(port) for port in ports})

    def _server(self, port: int):
        return lambda link: _Accepted(link, self, port)

    def command(self, mode: int, values: Sequence[float] = ZEROS, timeout_ms: int = 0) -> None:
        """A command with six values in SI units."""
        self._send(REVERSE, [timeout_ms, *(round(value * MICRO) for value in values), mode])

    def action(self, mode: int, action: int, count: int = 0, timeout_ms: int = 0) -> None:
        """A command with an action: -1 end, 0 nothing, 1 begin; and a number of points."""
        self._send(REVERSE, [timeout_ms, action, count, 0, 0, 0, 0, mode])

    def point(self, values: Sequence[float], time_s: float, radius: float = 0.0, *, is_cartesian: bool = False) -> None:
        """A point of a trajectory: joints or a pose."""
        numbers = [round(value * MICRO) for value in values] + [0] * 12
        self._send(TRAJECTORY, [*numbers, round(time_s * 1000), round(radius * MICRO), int(is_cartesian)])

    def script_command(self, number: int, values: Sequence[float] = ()) -> None:
        """A command for the arm's equipment; the values fill up to 25 numbers."""
        numbers = [int(value * MICRO) for value in values]
        self._send(COMMANDS, [number, *numbers, *[0] * (25 - len(numbers))])

    def force_mode(
        self,
        frame: Sequence[float],
        selection: Sequence[float],
        wrench: Sequence[float],
        kind: int,
        limits: Sequence[float],
    ) -> None:
        """Begin force control."""
        before = [int(value * MICRO) for value in (*frame, *selection, *wrench)]
        self._send(COMMANDS, [3, *before, kind, *(int(value * MICRO) for value in limits)])

    def stop(self) -> None:
        """End the program; what its client leaves in the six values is rubbish."""
        self._send(REVERSE, [0, 12345, -1, 1 << 30, -(1 << 31), 7, 8, STOPPED])

    def _send(self, port: int, numbers: Sequence[int]) -> None:
        self.links[port].send(struct.pack(f">{len(numbers)}i", *numbers))
