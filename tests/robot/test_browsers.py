"""A web browser's request to a port in memory: the same door as that of `serve`."""

from __future__ import annotations

import pytest

from elitescript import VirtualRobot
from elitescript.protocol.ports import SERVICES

HEAD = b"POST / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"
BODY = b"def f():\n  set_standard_digital_out(0, True)\nend\nrobotControl -on\r\n"


@pytest.mark.parametrize("service", [row.name for row in SERVICES])
@pytest.mark.parametrize("pieces", [(HEAD + BODY,), (HEAD[:4], HEAD[4:9], HEAD[9:], BODY)])
def test_it_is_closed_and_nothing_of_it_counts(service: str, pieces: tuple[bytes, ...]) -> None:
    robot = VirtualRobot("CS66")
    client = robot.connect(service)
    robot.advance(0.1)
    client.receive()
    for piece in pieces:
        if client.is_open:
            client.send(piece)
        robot.advance(0.004)
    robot.advance(0.1)
    assert not client.is_open
    if service != "modbus" or len(pieces) == 1:
        # Four bytes are no header of Modbus, whatever comes then.
        assert client.error == "it sent a web request (POST), as a web browser does"
    assert not robot.signals["standard_digital_out[0]"]
    assert b"Failed" not in client.receive()
