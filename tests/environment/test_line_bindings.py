from __future__ import annotations

import sys

import pytest

from elitescript.environment.line_bindings import bridge_address, check_bindings, parse_bindings
from elitescript.errors import UsageError


def test_ports_have_short_names():
    texts = ["tool=/dev/ttyUSB0", "box = socket://127.0.0.1:7000 ", "/dev/ttyS2=COM3"]
    found = {"tool": "/dev/ttyUSB0", "/dev/ttymxc0": "socket://127.0.0.1:7000", "/dev/ttyS2": "COM3"}
    assert parse_bindings(texts) == found
    assert check_bindings({"tool": "/dev/ttyUSB0", "box": "socket://127.0.0.1:7000", "/dev/ttyS2": "COM3"}) == found
    assert check_bindings(found) == found
    assert parse_bindings([]) == {}


@pytest.mark.parametrize(
    ("texts", "message"),
    [
        (["tool"], "--serial tool: write PORT=DEVICE"),
        (["tool="], "--serial tool=: write PORT=DEVICE"),
        (["=x"], "the robot has no serial port ''; its ports: tool, box, /dev/ttymxc0, /dev/ttyS2"),
        (["arm=/dev/ttyUSB0"], "the robot has no serial port 'arm'"),
        (["box=/dev/a", "/dev/ttymxc0=/dev/b"], "the serial port /dev/ttymxc0 is bound to /dev/a and to /dev/b"),
        (["tool=/dev/a", "box=/dev/a"], "/dev/a is bound to two serial ports"),
        (["tool=socket://7000"], "socket://7000: write socket://HOST:PORT"),
        (["tool=socket://h:0"], "the port from 1 to 65535"),
        (["tool=socket://h:65536"], "the port from 1 to 65535"),
        (["tool=socket://h:x"], "the port from 1 to 65535"),
    ],
)
def test_what_makes_no_sense_is_refused(texts, message):
    with pytest.raises(UsageError) as caught:
        parse_bindings(texts)
    assert message in str(caught.value)


def test_addresses():
    assert bridge_address("socket://localhost:7000") == ("localhost", 7000)
    assert bridge_address("socket://[::1]:7000") == ("::1", 7000)
    assert bridge_address("/dev/ttyUSB0") is None


def test_without_pyserial_a_port_of_this_computer_names_the_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "serial", None)
    with pytest.raises(UsageError, match=r"tool=/dev/ttyUSB0 needs .* pip install 'elitescript\[serial\]'"):
        parse_bindings(["tool=/dev/ttyUSB0"])
    assert parse_bindings(["tool=socket://h:1"]) == {"tool": "socket://h:1"}
