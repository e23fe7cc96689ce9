"""Other people's MODBUS clients ask our devices on real ports and pseudo-terminals."""

from __future__ import annotations

import asyncio
import os

import pytest

from elitescript.testing.world import ModbusDevice, World
from tests.services.test_device_server import run, serving

pytestmark = pytest.mark.peers

client = pytest.importorskip("pymodbus.client")


class Gripper(ModbusDevice):
    def register_written(self, address, value):
        self.input_registers[address] = value * 2


def talk(peer, unit):
    """What pymodbus reads and writes."""
    assert peer.connect()
    try:
        assert peer.read_holding_registers(0, count=3, device_id=unit).registers == [1, 2, 3]
        assert not peer.write_register(1, 500, device_id=unit).isError()
        assert peer.read_input_registers(1, count=1, device_id=unit).registers == [1000]
        assert not peer.write_registers(0, [7, 8], device_id=unit).isError()
        assert peer.read_holding_registers(0, count=3, device_id=unit).registers == [7, 8, 3]
        assert not peer.write_coils(2, [True, False, True], device_id=unit).isError()
        assert peer.read_coils(2, count=3, device_id=unit).bits[:3] == [True, False, True]
        assert peer.readwrite_registers(
            read_address=0, read_count=2, write_address=0, values=[9], device_id=unit
        ).registers == [9, 8]
        refused = peer.read_holding_registers(2, count=5, device_id=unit)
        assert refused.isError() and refused.exception_code == 2
    finally:
        peer.close()


def test_pymodbus_over_tcp():
    async def test():
        device = Gripper(port=502, holding_registers=[1, 2, 3], coils=8)
        async with serving(World(devices=[device])) as ((port,), _):
            await asyncio.to_thread(talk, client.ModbusTcpClient("127.0.0.1", port=int(port)), 1)

    run(test)


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="pseudo-terminals")
def test_pymodbus_over_a_pseudo_terminal():
    pytest.importorskip("serial")

    async def test():
        device = Gripper(line="tool", unit=5, holding_registers=[1, 2, 3], coils=8)
        async with serving(World(devices=[device])) as ((path,), _):
            await asyncio.to_thread(talk, client.ModbusSerialClient(path, baudrate=115200), 5)

    run(test)
