"""Programs and the serial lines that they use, in virtual time."""

from __future__ import annotations

from typing import Any

import pytest

from elitescript.devices.channels.network import DeviceLink, Peer, VirtualNetwork
from elitescript.devices.memory import MemoryEnvironment
from elitescript.modbus.frames import pdu
from elitescript.modbus.frames.rtu import RtuSplitter, rtu_frame
from tests.runtime.machine import Bench

TOOL = "tool_serial_config(True, 115200, 0, 1)"
TOOL_RTU = "tool_serial_config(True, 115200, 0, 1, 8, True)"
BOX = "/dev/ttymxc0"
BOX_RTU = "serial_config(True, 115200, 0, 1, 8, True)"

KINDS = [
    ("read_registers", "1, 2, 3", pdu.read(3, 2, 3), pdu.registers_read(3, [7, 0, 65535]), [7, 0, 65535]),
    ("read_bits", "1, 2, 10", pdu.read(1, 2, 10), pdu.bits_read(1, [1, 0] * 5), [1, 0] * 5),
    ("read_input_registers", "1, 2, 1", pdu.read(4, 2, 1), pdu.registers_read(4, [9]), [9]),
    ("read_input_bits", "1, 0, 3", pdu.read(2, 0, 3), pdu.bits_read(2, [0, 1, 1]), [0, 1, 1]),
    ("write_registers", "1, 2, [5, 6]", pdu.write_registers(2, [5, 6]), pdu.write_registers(2, [5, 6])[:5], 2),
    ("write_registers", "1, 2, 5", pdu.write_registers(2, [5]), pdu.write_registers(2, [5])[:5], 1),
    ("write_bits", "1, 2, [1, False, 7]", pdu.write_coils(2, [1, 0, 1]), pdu.write_coils(2, [1, 0, 1])[:5], 3),
    ("write_bits", "1, 2, True", pdu.write_coils(2, [1]), pdu.write_coils(2, [1])[:5], 1),
    ("write_single_bit", "1, 2, 1", pdu.write_coil(2, 1), pdu.write_coil(2, 1), 1),
    ("write_single_bit", "1, 2, 0", pdu.write_coil(2, 0), pdu.write_coil(2, 0), 1),
    ("write_single_bit", "1, 2, -3", pdu.write_coil(2, 1), pdu.write_coil(2, 1), 1),
    ("write_single_register", "1, 2, 300", pdu.write_register(2, 300), pdu.write_register(2, 300), 1),
]
"""Command without its prefix, arguments, request, answer, result."""

PORTS = [("tool_modbus_", "tool", TOOL_RTU), ("serial_modbus_", BOX, BOX_RTU)]

ports = pytest.mark.parametrize(("prefix", "name", "config"), PORTS, ids=["tool", "box"])
kinds = pytest.mark.parametrize(
    ("kind", "args", "request_pdu", "answer", "result"), KINDS, ids=[f"{row[0]}({row[1]})" for row in KINDS]
)


def shown(prefix: str, kind: str, result: Any) -> str:
    """A result as `textmsg` writes it: for several values the tool says whether, the box how many."""
    return str(bool(result)) if prefix == "tool_modbus_" and kind in ("write_registers", "write_bits") else str(result)


def failure(prefix: str, kind: str) -> str:
    """What a command returns when it fails."""
    return shown(prefix, kind, [] if kind.startswith("read") else 0)


class Device(Peer):
    """What hangs on a line. A class of its own for each test; `log` holds what it heard and when."""

    log: list[tuple[Any, float]]

    def __init_subclass__(cls) -> None:
        cls.log = []

    def received(self, data: bytes) -> None:
        self.log.append((data, self.link.time_s))

    def closed(self) -> None:
        self.log.append(("closed", self.link.time_s))

    @classmethod
    def bytes(cls) -> bytes:
        return b"".join(what for what, _ in cls.log if isinstance(what, bytes))


class Slave(Device):
    """A MODBUS slave that answers each request with what `answers` holds: bytes, or nothing."""

    answers: tuple[bytes, ...] = ()

    def __init__(self, link: DeviceLink) -> None:
        super().__init__(link)
        self.splitter = RtuSplitter(is_slave=True)
        self.left = list(self.answers)

    def received(self, data: bytes) -> None:
        for frame in self.splitter.feed(data):
            self.log.append((frame.pdu, self.link.time_s))
            if self.left:
                self.reply(self.left.pop(0))

    def reply(self, answer: bytes) -> None:
        self.link.send(answer)


def slave(*answers: bytes | tuple[int, bytes]) -> type[Slave]:
    """A slave that gives these answers, one after the other; a pair is framed with the number of the slave."""

    class Given(Slave):
        pass

    Given.answers = tuple(answer if isinstance(answer, bytes) else rtu_frame(*answer) for answer in answers)
    return Given


def program(body: str) -> str:
    """A program, from its body."""
    rows = body.strip("\n").split("\n")
    margin = min(len(row) - len(row.lstrip()) for row in rows if row.strip())
    return "def main():\n" + "".join(f"  {row[margin:]}\n" for row in rows) + "end\n"


def bench(device: Any = None, *, name: str = "tool", **options: Any) -> Bench:
    """A host with a device on a line."""
    network = VirtualNetwork(lines={} if device is None else {name: device})
    return Bench(world=MemoryEnvironment(channels=network), **options)


def run(body: str, device: Any = None, *, name: str = "tool", until: int = 25_000, **options: Any) -> Bench:
    """Run a program with a device on a line."""
    return bench(device, name=name, **options).start(program(body)).run(until)
