"""Devices that connect to the robot's own ports."""

from __future__ import annotations

import pytest

from elitescript.errors import UsageError
from elitescript.testing.world import DeviceError, ModbusClient, TcpClient, World
from tests.devices.programs import run
from tests.protocol import rtsi_client


class Watcher(TcpClient):
    """Streams the time and sets an input when it has seen enough."""

    service = "rtsi"
    heard = b""
    _kept = ("heard", "kinds")
    kinds = ()

    def opened(self):
        return rtsi_client.message("V", b"\0\1")

    def received(self, data):
        self.heard += data
        return


def test_a_client_of_rtsi_is_answered_in_virtual_time():
    watcher = Watcher(connect_at_s=0.1)
    found = run("sleep(0.3)", watcher)
    assert watcher.heard.endswith(b"V\1")
    assert watcher.is_connected
    assert found.state == "finished"


def test_leaps_cannot_be_told_from_steps_with_a_client():
    leaps, steps = Watcher(connect_at_s=0.1), Watcher(connect_at_s=0.1)
    assert run("sleep(0.3)", leaps).events == run("sleep(0.3)", steps, steps=True).events
    assert leaps.heard == steps.heard


def test_bytes_that_the_port_cannot_read_end_the_connection():
    class Loud(TcpClient):
        service = "rtsi"

        def opened(self):
            return b"\0\1V"  # shorter than any message says it is

        def closed(self):
            self.log("closed")

    found = run("sleep(0.3)", Loud())
    assert "sent what the rtsi port of the robot cannot read" in found.warnings[0]


def test_a_port_that_is_not_there_is_said():
    with pytest.raises(DeviceError, match=r"has the ports dashboard, primary, .*, modbus, not 'telnet'"):
        run("sleep(0.3)", TcpClient(service="telnet"))


@pytest.mark.parametrize(
    "settings, words",
    [
        ({"service": ""}, "service: is missing"),
        ({"service": 5}, "service: must be a text"),
        ({"connect_at_s": "x"}, "connect_at_s: must be a number"),
        ({"line_end": 5}, "line_end: must be a text"),
    ],
)
def test_a_setting_that_makes_no_sense_is_named(settings, words):
    with pytest.raises(UsageError, match=words):
        Watcher(**settings)


def test_before_there_is_a_robot_there_is_nothing_to_connect_to():
    watcher = Watcher()
    World(devices=[watcher])
    with pytest.raises(UsageError, match="there is no robot yet to connect to"):
        watcher.connect()


def test_a_plc_shakes_hands_with_a_program_over_the_robots_own_registers():
    class Plc(ModbusClient):
        def opened(self):
            self.every(0.1, self.read_registers, 256, 1, self.look)

        def look(self, values):
            if values[0] == 7:
                self.write_register(257, 8)

    body = """
write_port_register(256, 7)
while read_port_register(257) != 8:
  sync()
end
textmsg("done")
"""
    plc = Plc()
    found = run(body, plc, until_s=5)
    assert found.log == ["done"]
    assert found.time_s < 0.2


def test_what_the_robot_refuses_is_a_warning_of_the_plc():
    class Plc(ModbusClient):
        def opened(self):
            self.write_register(0, 1)
            self.write_coil(400, True)

    warnings = run("sleep(0.2)", Plc()).warnings
    assert [text.partition(": ")[2].rpartition(": exception ")[2] for text in warnings] == [
        "2: illegal data address"
    ] * len(warnings)
    assert warnings
