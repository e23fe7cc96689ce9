"""What is hardly meant in the settings of devices is told once, at the start of a run."""

from __future__ import annotations

import pytest

from elitescript.devices.kinds.replies import DeclaredModbus, DeclaredTcp
from elitescript.testing.world import Fault, Schedule, TcpServer, Wire
from tests.devices.programs import run

OUT, OTHER, IN = "standard_digital_out[0]", "standard_digital_out[2]", "standard_digital_in[0]"


def told(*devices, faults=()):
    found = run("sync()", *devices, faults=faults).findings
    return [f"{one.code} {one.severity}: {one.text} ({one.hint})" for one in found if one.source == "device"]


@pytest.mark.parametrize(
    ("device", "words"),
    [
        (
            TcpServer(port=1, latency_s=50, name="t"),
            "W293 warning: t: latency_s is 50, in seconds (50 ms are latency_s = 0.05)",
        ),
        (
            Wire(when=OUT, then=IN, after_s=500, name="w"),
            "N290 note: w: after_s is 500, in seconds (500 ms are after_s = 0.5)",
        ),
        (
            Wire(when=OUT, then=IN, pulse_s=200, name="w"),
            "N290 note: w: pulse_s is 200, in seconds (200 ms are pulse_s = 0.2)",
        ),
        (
            DeclaredTcp(port=1, name="cam", replies=[{"to": "x", "send": "y", "after_s": 300}]),
            "N290 note: cam: after_s is 300, in seconds (300 ms are after_s = 0.3)",
        ),
        (
            Wire(when=OUT, then=OTHER),
            f"W293 warning: wire to {OTHER}: then is {OTHER}, which the robot sets "
            "(name an input: is standard_digital_in[2] meant?)",
        ),
        (
            Schedule(signal="output_int_register[3]", at=[(0.5, 3)], name="s"),
            "W293 warning: s: signal is output_int_register[3], which the robot sets "
            "(name an input: is input_int_register[3] meant?)",
        ),
    ],
    ids=str,
)
def test_a_setting_that_is_hardly_meant_is_told(device, words):
    assert told(device) == [words]


@pytest.mark.parametrize(
    "device",
    [
        TcpServer(port=1, latency_s=5),
        Wire(when=OUT, then=IN, after_s=60),
        Schedule(signal=IN, at=[(500.0, True)]),
        Schedule(signal="general_register[3]", at=[(0.5, 3)]),
        DeclaredTcp(port=1, replies=[{"to": "x", "send": "y", "after_s": 3}]),
    ],
    ids=str,
)
def test_what_may_be_meant_is_not_told(device):
    assert told(device) == []


def test_two_wires_that_follow_into_one_input_are_told():
    wires = [Wire(when=OUT, then=IN, name="a"), Wire(when=OTHER, then="standard_digital_in[ 0 ]", name="b")]
    (words,) = told(*wires)
    assert words.startswith(f"W293 warning: b: {IN} follows another wire already, a")


def test_wires_that_set_and_reset_one_input_are_not_told():
    assert told(Wire(when=OUT, then=IN, edge="rising"), Wire(when=OTHER, then=IN, edge="falling")) == []


def test_a_fault_of_milliseconds_is_told():
    (words,) = told(TcpServer(port=5000), faults=[Fault("delay", on=5000, delay_s=500)])
    assert words == "W293 warning: delay on 5000: delay_s is 500, in seconds (500 ms are delay_s = 0.5)"


def test_negative_values_are_those_of_signed_registers():
    device = DeclaredModbus(port=502, input_registers=[-100, 65535], holding_registers={3: -32768})
    assert (device.input_registers[0], device.input_registers[1], device.holding_registers[3]) == (65436, 65535, 32768)


class Deaf(TcpServer):
    port = 5000

    def on_line(self, connection, line):
        return "x"


class Sink(TcpServer):
    port = 5000


SEND = 'socket_open("h", 5000)\nsocket_send_line("where?")\nsocket_send_line("here?")'


def test_a_device_that_takes_no_line_and_has_methods_is_told_of():
    assert run(SEND, Deaf(), until_s=0.1).warnings == [
        "Deaf: got 'where?', and has no line_received(self, connection, line) that takes it; nothing calls on_line()"
    ]


def test_a_device_without_methods_takes_lines_in_silence():
    assert run(SEND, Sink()).warnings == []
