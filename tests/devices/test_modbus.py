"""MODBUS devices of a test, over TCP and RTU."""

from __future__ import annotations

import pytest

from elitescript.errors import UsageError
from elitescript.messages.inputs import ChannelData
from elitescript.modbus.frames.pdu import read, write_coil, write_register, write_registers
from elitescript.modbus.frames.tcp import TcpSplitter, tcp_frame
from elitescript.testing.world import DeviceError, ModbusDevice, World
from tests.devices.programs import run

TOOL = "tool_serial_config(True, 115200, 0, 1, 8, True)\n"


class Asker:
    """A TCP client of a world without a robot: requests in, answers out."""

    def __init__(self, *devices, port=502):
        self.network = World(devices=devices).network
        self.channel = self.network.open("h", port, 2.0)
        self.play(1)

    def play(self, ticks):
        events = []
        for tick in range(self.network.tick + 1, self.network.tick + ticks + 1):
            events += self.network.arrivals(tick)
        return events

    def ask(self, pdu, unit=1):
        self.network.send(self.channel, tcp_frame(7, unit, pdu))
        data = b"".join(event.data for event in self.play(3) if isinstance(event, ChannelData))
        return [(frame.unit, frame.pdu) for frame in TcpSplitter().feed(data)]


def test_tables_are_read_and_written():
    device = ModbusDevice(port=502, holding_registers=[10, 20, 30], input_registers={5: 7}, coils=3)
    asker = Asker(device)
    assert asker.ask(read(3, 0, 3)) == [(1, b"\x03\x06\x00\x0a\x00\x14\x00\x1e")]
    assert asker.ask(read(4, 5, 1)) == [(1, b"\x04\x02\x00\x07")]
    asker.ask(write_register(1, 99))
    asker.ask(write_coil(2, True))
    assert (device.holding_registers[1], device.coils[2], device.requests) == (99, 1, 4)


def test_an_address_that_is_not_there_is_refused_and_nothing_is_written():
    device = ModbusDevice(port=502, holding_registers=2)
    asker = Asker(device)
    assert asker.ask(read(3, 1, 2)) == [(1, b"\x83\x02")]
    assert asker.ask(write_registers(1, [5, 6])) == [(1, b"\x90\x02")]
    assert device.holding_registers[1] == 0


def test_without_tables_every_address_exists():
    assert Asker(ModbusDevice(port=502)).ask(read(3, 65535, 1)) == [(1, b"\x03\x02\x00\x00")]


def test_several_units_share_a_port_and_one_that_is_not_there_is_refused():
    asker = Asker(ModbusDevice(port=502, unit=1, coils=[1]), ModbusDevice(port=502, unit=2, coils=[0]))
    assert asker.ask(read(1, 0, 1), unit=1) == [(1, b"\x01\x01\x01")]
    assert asker.ask(read(1, 0, 1), unit=2) == [(2, b"\x01\x01\x00")]
    assert asker.ask(read(1, 0, 1), unit=3) == [(3, b"\x81\x0b")]


def test_a_device_refuses_with_a_code_and_hears_who_reads():
    class Busy(ModbusDevice):
        port = 502

        def reading(self, table, address, count):
            if table == "input_registers":
                self.refuse(6)
            self.holding_registers[0] = address + count

    asker = Asker(Busy())
    assert asker.ask(read(4, 0, 1)) == [(1, b"\x84\x06")]
    assert asker.ask(read(3, 0, 4)) == [(1, b"\x03\x08\x00\x04" + bytes(6))]


def test_bytes_that_are_no_modbus_end_the_connection():
    asker = Asker(ModbusDevice(port=502))
    asker.network.send(asker.channel, b"GET / HTTP/1.1\r\n")
    asker.play(3)
    assert asker.network.open_channels == 0


class Gripper(ModbusDevice):
    line = "tool"
    unit = 9

    def register_written(self, address, value):
        self.after(0.4, self.finish, value)

    def finish(self, value):
        self.input_registers[0] = -value


def test_a_gripper_on_the_tool_answers_in_its_time():
    body = """
textmsg(tool_modbus_write_single_register(9, 0, 5))
textmsg(tool_modbus_read_input_registers(9, 0, 1))
sleep(0.5)
textmsg(tool_modbus_read_input_registers(9, 0, 1))
"""
    log = run(TOOL + body, Gripper()).log
    assert log[1:] == ["[0]", "[65531]"]


def test_a_unit_that_is_not_on_the_line_does_not_answer():
    found = run(TOOL + "textmsg(tool_modbus_read_registers(8, 0, 1, 0.5))", Gripper())
    assert found.log == ["[]"]
    assert found.time_s >= 0.5


def test_two_devices_share_a_line():
    other = ModbusDevice(line="tool", unit=3, holding_registers=[42])
    assert run(TOOL + "textmsg(tool_modbus_read_registers(3, 0, 1, 0.5))", Gripper(), other).log == ["[42]"]


def test_a_failing_device_of_a_bus_is_named():
    class Broken(Gripper):
        def register_written(self, address, value):
            raise KeyError(address)

    with pytest.raises(DeviceError, match=r"test_modbus\.py:\d+: device Broken: KeyError: 4"):
        run(TOOL + "tool_modbus_write_single_register(9, 4, 5)", Gripper(unit=1), Broken())


@pytest.mark.parametrize(
    "settings, words",
    [
        ({"line": "", "port": 0}, "port: give either a port, for MODBUS TCP, or a line"),
        ({"line": "tool", "port": 502}, "port: give either a port"),
        ({"unit": 0}, r"unit: must be in \[1, 247\], got 0"),
        ({"line": "", "port": 502, "unit": 300}, r"unit: must be in \[0, 255\], got 300"),
        ({"line": "", "port": 502, "baud": 9600}, "baud: goes with line"),
        ({"address": "10.0.0.1"}, "address: goes with port"),
        ({"coils": [2]}, r"coils: the value at address 0 must be in \[0, 1\], got 2"),
        ({"holding_registers": {70000: 1}}, "holding_registers: an address must be in"),
        ({"input_registers": "many"}, "input_registers: write a list of values"),
    ],
)
def test_a_setting_that_makes_no_sense_is_named(settings, words):
    with pytest.raises(UsageError, match=words):
        Gripper(**settings)


def test_a_unit_is_there_once():
    with pytest.raises(UsageError, match="unit: 9 is taken by another device"):
        World(devices=[Gripper(), Gripper()])
    with pytest.raises(UsageError, match="unit: every unit is taken by another device"):
        World(devices=[ModbusDevice(port=502, unit=1), ModbusDevice(port=502)])
