"""The version that a controller shows: the same on every port and to its programs."""

from __future__ import annotations

import struct

import pytest

from elitescript import VirtualRobot
from elitescript.errors import UsageError


def shown(robot: VirtualRobot) -> list[tuple[int, ...] | str]:
    """Versions on RTSI, the dashboard's greeting and `version`, Modbus TCP, and to a program."""
    rtsi, dashboard, modbus = map(robot.connect, ("rtsi", "dashboard", "modbus"))
    dashboard.expect(b"version ")
    greeting = dashboard.expect(b".\r\n").decode().removesuffix(".\r\n")
    dashboard.receive()
    rtsi.send(b"\x00\x03v")
    dashboard.send(b"version\n")
    modbus.send(struct.pack(">HHHBBHH", 1, 0, 6, 1, 3, 63, 3))
    run = robot.run("textmsg([read_port_register(n) for n in (63, 64, 65)])")
    return [
        struct.unpack(">3x4I", rtsi.receive()),
        greeting,
        dashboard.expect(b"\n").decode().strip(),
        struct.unpack(">9x3H", modbus.receive()),
        run.log[0],
    ]


@pytest.mark.parametrize(
    ("options", "version"),
    [
        ({}, (2, 15, 0, 0)),
        ({"firmware": "2.10"}, (2, 10, 0, 0)),
        ({"controller_version": "2.14.5.3"}, (2, 14, 5, 3)),
        ({"controller_version": "2.13"}, (2, 13, 0, 0)),
        ({"firmware": "2.10", "controller_version": "2.16.1"}, (2, 16, 1, 0)),
    ],
)
def test_it_is_the_same_on_every_port(options, version):
    text = ".".join(map(str, version))
    assert shown(VirtualRobot(**options)) == [version, text, text, version[:3], str(list(version[:3]))]


def test_what_the_robot_can_do_stays_that_of_the_firmware():
    old = VirtualRobot(firmware="2.10", controller_version="2.15.0.0")
    with pytest.raises(UsageError, match="the robot has the ports"):
        old.connect("query")
    assert VirtualRobot(controller_version="2.10.0.0").connect("query").receive() == b""
