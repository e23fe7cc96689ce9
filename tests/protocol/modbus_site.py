"""A kernel with its Modbus clients, without sockets."""

from __future__ import annotations

from typing import Any

from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.inputs import Input
from elitescript.protocol.modbus_port import ModbusConnection, ModbusPort
from tests.protocol import modbus_client as client


class Site:
    """One robot and its clients."""

    def __init__(self, **config: Any) -> None:
        self.kernel = Kernel(RobotOptions(**config))
        self.port = ModbusPort(self.kernel.description)
        self.output = self.kernel.tick_and_snapshot()
        self.waiting: list[Input] = []
        self.peers: list[Peer] = []

    def connect(self) -> Peer:
        self.peers.append(Peer(self, f"modbus#{len(self.peers) + 1}"))
        return self.peers[-1]

    def tick(self, *inputs: Input) -> None:
        taken, self.waiting = [*inputs, *self.waiting], []
        self.output = self.kernel.tick_and_snapshot(taken)
        for peer in self.peers:
            peer.connection.publish(self.output)
            self.waiting += peer.connection.due()
            peer.collect()


class Peer:
    """One client."""

    def __init__(self, site: Site, origin: str) -> None:
        self.site = site
        self.connection = ModbusConnection(origin, site.kernel.description, site.port)
        self.answers: list[tuple[int, int, bytes]] = []

    def send(self, data: bytes) -> None:
        self.site.waiting += self.connection.receive(data, self.site.output)
        self.collect()

    def collect(self) -> None:
        for message in self.connection.take():
            self.answers += client.frames(message)

    def ask(self, pdu: bytes, unit: int = 255, ticks: int = 1) -> bytes:
        """Send one request; return its answer."""
        self.answers.clear()
        self.send(client.frame(7, pdu, unit))
        for _ in range(ticks):
            if not self.answers:
                self.site.tick()
        assert [answer[:2] for answer in self.answers] == [(7, unit)]
        return self.answers[0][2]
