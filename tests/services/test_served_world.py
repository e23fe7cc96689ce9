"""Virtual devices beside a served robot: a real kernel, no sockets, no clock."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import replace

import pytest

from elitescript.coverage.probe import CoverageProbe
from elitescript.coverage.recording import Recorder, read_record
from elitescript.devices.channels.machine_faults import machine_fault
from elitescript.environment.request_channels import RequestChannels
from elitescript.errors import UsageError
from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.enums import ChannelError
from elitescript.messages.events import DeviceNoted, TextMessage
from elitescript.messages.inputs import (
    AddFault,
    ChannelClosed,
    ChannelCredit,
    ChannelData,
    ChannelOpened,
    EndFaults,
    RunUnit,
)
from elitescript.messages.line import LineSettings
from elitescript.messages.machine import DisturbInput
from elitescript.messages.outcomes import Done, Refused
from elitescript.messages.outputs import CloseChannel, OpenChannel, OpenLine, Reply, SendChannel
from elitescript.protocol.ports import SERVICES
from elitescript.runtime import probe as seam
from elitescript.services.control.verbs import VERBS, VerbRequest
from elitescript.services.log import ServerLog
from elitescript.services.served_devices import CHANNELS_MAX, UNSENT_MAX, ServedDevices
from elitescript.testing.world import Device, Fault, ModbusDevice, SerialDevice, TcpClient, TcpServer, Wire, World
from tests.devices.programs import robot_in


class Camera(TcpServer):
    port = 5000
    latency_s = 0.05

    def line_received(self, connection, line):
        self.log(f"asked {line}")
        return f"<{line}>"


class Scale(SerialDevice):
    line = "box"

    def line_received(self, line):
        return f"{self.random.random():.3f}"


def devices():
    return [
        Camera(),
        Scale(),
        ModbusDevice(line="tool", unit=1, holding_registers=[42]),
        Wire(when="standard_digital_out[0]", then="standard_digital_in[1]", after_s=0.3),
    ]


PROGRAM = """
def main():
  socket_open("h", 5000)
  socket_send_line("where?")
  textmsg(socket_read_string("socket_0", "", "\\n"))
  serial_config(True, 9600, 0, 1)
  serial_write("W\\n")
  textmsg(serial_read(6, False, 0.5))
  tool_serial_config(True, 115200, 0, 1, 8, True)
  textmsg(tool_modbus_read_registers(1, 0, 1))
  set_standard_digital_out(0, True)
  while not get_standard_digital_in(1):
    sync()
  end
  textmsg("closed")
end
"""


class Bench:
    """A kernel with a world beside it, ticked as a server does."""

    def __init__(self, world, **config):
        self.kernel = Kernel(RobotOptions(power_on=True, **config))
        self.said = []
        self.others = []
        log = ServerLog("CS66", lambda _, line: self.said.append((line.text, line.is_problem)))
        self.world = ServedDevices(world, log)
        self.output = self.kernel.tick_and_snapshot()
        self.world.begin(self.output, self.connect)
        self.events = []
        self.replies = []

    def connect(self, service, origin):
        row = next(row for row in SERVICES if row.name == service)
        return row.open(self.kernel.description)(origin)

    def run(self, ticks, *inputs):
        for _ in range(ticks):
            self.output = self.kernel.tick_and_snapshot([*inputs, *self.world.inputs(self.output.tick + 1)])
            inputs = ()
            self.others += self.world.take(self.output)
            self.events += self.output.events
            self.replies += self.output.replies

    @property
    def log(self):
        return [(event.tick, event.text) for event in self.events if isinstance(event, TextMessage)]


def test_a_program_meets_the_same_devices_as_in_virtual_time():
    bench = Bench(World(devices=devices()))
    bench.run(400, RunUnit("test", "program", PROGRAM))
    found = robot_in(World(devices=devices())).run(PROGRAM)
    # The kernel has run one tick before.
    assert bench.log == [(event.tick + 1, event.text) for event in found.events if isinstance(event, TextMessage)]
    assert bench.said == [("Camera: asked where?", False)]
    assert bench.others == []


@pytest.mark.parametrize("is_listening", [True, False])
def test_a_connection_that_a_device_ends_or_refuses_is_forgotten(is_listening):
    class Rude(TcpServer):
        port = 5000

        def opened(self, connection):
            connection.after(0.1, connection.close)

    bench = Bench(World(devices=[Rude(is_listening=is_listening)]))
    body = '  for n in range(3):\n    socket_open("h", 5000)\n    sleep(0.3)\n  end\n  textmsg("done")'
    bench.run(300, RunUnit("test", "program", f"def main():\n{body}\nend\n"))
    assert [text for _, text in bench.log] == ["done"]
    assert bench.world._leads == {}
    assert bench.others == []


def test_what_no_device_has_is_left_to_others():
    world = World(devices=[Camera()], network="real")
    bench = Bench(world)
    requests = RequestChannels()
    camera, other = requests.open("h", 5000, 2.0), requests.open("h", 5001, 2.0)
    requests.open_line("tool", LineSettings(9600, 0, 1, 8))
    for channel in (camera, other):
        requests.send(channel, b"x")
        requests.close(channel)
    rest = bench.world.take(replace(bench.output, requests=requests.take()))
    assert [(type(request), request.channel) for request in rest] == [
        (OpenChannel, other),
        (OpenLine, other + 1),
        (SendChannel, other),
        (CloseChannel, other),
    ]


def test_a_world_without_another_network_refuses_the_rest():
    bench = Bench(World(devices=[Camera()], network="virtual"))
    text = 'def main():\n  textmsg(socket_open("h", 5001))\nend\n'
    bench.run(5, RunUnit("test", "program", text))
    assert [text for _, text in bench.log] == ["False"]


def test_a_device_that_fails_is_disconnected_and_the_robot_goes_on():
    class Broken(Camera):
        def line_received(self, connection, line):
            return 1 / 0

    class Early(Device):
        def started(self):
            raise ValueError("no")

    bench = Bench(World(devices=[Broken(), Early()]))
    text = """
def main():
  socket_open("h", 5000)
  socket_send_line("x")
  sleep(0.1)
  textmsg(socket_is_connected())
end
"""
    bench.run(100, RunUnit("test", "program", text))
    assert [text for _, text in bench.log] == ["False"]
    problems = [text for text, is_problem in bench.said if is_problem]
    assert "device Early: ValueError: no; the device is disconnected" in problems[0]
    assert "device Broken: ZeroDivisionError" in problems[1]


ASK = """
def main():
  socket_open("h", 5000)
  for n in range(3):
    socket_send_line("x")
    textmsg(socket_read_string("socket_0", "", "\\n", 0.2))
  end
end
"""


def test_faults_of_a_configuration_act_in_the_kernel():
    fault = machine_fault(Fault("drop", 5000, direction="to_robot", nth=2, count=1))
    bench = Bench(World(devices=[Camera(latency_s=0)]), faults=(fault,))
    bench.run(200, RunUnit("test", "program", ASK))
    assert [text for _, text in bench.log] == ["<x>", "", "<x>"]
    assert [event.text for event in bench.events if isinstance(event, DeviceNoted)] == ["drop on port 5000 acts"]


def test_a_disturbance_of_a_protocol_that_a_device_does_not_speak_is_refused():
    bench = Bench(World(devices=[Camera(), ModbusDevice(port=502)]))
    disturb = VERBS["disturb"].order

    def disturbed(on):
        words = ("wrong_reply", f"on={on}", "form=exception", "code=2")
        return disturb(VerbRequest("ctl#1/1", words, {}, bench.output.snapshot, bench.kernel.description, bench.world))

    with pytest.raises(UsageError, match="form: exception on 5000: Camera there speaks no MODBUS"):
        disturbed(5000)
    assert len(disturbed(502).inputs) == 1


def test_coverage_learns_what_can_have_faults_and_which_there_were(monkeypatch):
    block = bytearray(4096)
    probe = CoverageProbe(Recorder(memoryview(block), nullcontext()), str)
    monkeypatch.setattr(seam, "_default", [lambda: probe])
    bench = Bench(World(devices=[Camera(name="camera")], faults=[Fault("silence", 5000, at_s=1.0)]))
    bench.world.check_fault(Fault("refuse", "camera"))
    assert read_record(block).facts >= {
        ("place", "5000", "tcp", "camera"),
        ("fault", "5000", "silence"),
        ("fault", "5000", "refuse"),
    }


def test_faults_come_and_go_by_inputs():
    bench = Bench(World(devices=[Camera()]))
    bench.run(1, AddFault("ctl#1", machine_fault(Fault("refuse", 5000))))
    bench.run(10, RunUnit("test", "program", 'def main():\n  textmsg(socket_open("h", 5000))\nend\n'))
    bench.run(1, EndFaults("ctl#2"))
    bench.run(10, RunUnit("test", "program", 'def main():\n  textmsg(socket_open("h", 5000))\nend\n'))
    assert [text for _, text in bench.log] == ["False", "True"]
    assert bench.replies == [Reply("ctl#1", Done()), Reply("ctl#2", Done())]


@pytest.mark.parametrize(
    ("fault", "why"),
    [
        (machine_fault(Fault("reconnect", 5000)), "kind: reconnect on 5000 has no disconnect before it, at that place"),
        (DisturbInput("inverted", "standard_digital_in", 99), "there is no signal standard_digital_in[99]"),
    ],
)
def test_a_fault_that_makes_no_sense_is_refused(fault, why):
    bench = Bench(World())
    bench.run(1, AddFault("ctl#1", fault))
    assert bench.replies == [Reply("ctl#1", Refused(why))]


def test_the_end_of_the_service_closes_what_is_open():
    closed = []

    class Server(Camera):
        def closed(self, connection):
            closed.append(connection.number)

    world = World(devices=[Server()])
    bench = Bench(world)
    bench.run(5, RunUnit("test", "program", 'def main():\n  socket_open("h", 5000)\n  sleep(10)\nend\n'))
    bench.world.close_all()
    world.network.arrivals(bench.output.tick + 5)
    assert closed == [1]


class Hasty(TcpServer):
    """Answers once, and closes."""

    port = 5000

    def line_received(self, connection, line):
        connection.send_line(f"<{line}>")
        connection.close()


def asked(bench, *requests, ticks=3):
    """What the robot hears in the ticks after its requests, whatever it is."""
    bench.world.take(replace(bench.output, requests=requests))
    heard = []
    for _ in range(ticks):
        bench.output = replace(bench.output, tick=bench.output.tick + 1)
        heard += bench.world.inputs(bench.output.tick)
    return heard


def test_a_robot_that_begins_anew_has_nothing_to_do_with_channels_that_devices_have_closed():
    bench = Bench(World(devices=[Hasty()]))
    # Each robot that begins anew counts its channels from 1.
    for _ in range(2):
        assert asked(bench, OpenChannel(1, "tcp", "h", 5000, 2.0)) == [ChannelOpened(1, True)]
        assert asked(bench, SendChannel(1, b"x\n")) == [
            ChannelCredit(1, 2),
            ChannelData(1, b"<x>\n"),
            ChannelClosed(1, ""),
        ]


def test_channels_to_devices_are_bounded():
    bench = Bench(World(devices=[Camera()], network="virtual"))
    requests = [OpenChannel(number, "tcp", "h", 5001 if number % 2 else 5000, 2.0) for number in range(1, 201)]
    heard = asked(bench, *requests)
    reasons = [item.reason for item in heard if isinstance(item, ChannelOpened) and not item.is_open]
    assert reasons.count(f"{CHANNELS_MAX} connections are open") == 200 - CHANNELS_MAX
    assert bench.world._world.network.open_channels == CHANNELS_MAX // 2
    again = asked(bench, OpenChannel(2, "tcp", "h", 5000, 2.0))
    assert again == [ChannelOpened(2, False, "channel 2 is in use")]
    # Those that were refused have left room.
    assert asked(bench, OpenChannel(201, "tcp", "h", 5000, 2.0)) == [ChannelOpened(201, True)]


def test_what_waits_for_a_slow_line_is_bounded():
    bench = Bench(World(devices=[Scale()]))
    asked(bench, OpenLine(1, "/dev/ttymxc0", LineSettings(2400, 0, 1, 8)))
    heard = asked(bench, *[SendChannel(1, bytes(32_768))] * 20)
    assert [item for item in heard if not isinstance(item, ChannelCredit)] == [
        ChannelClosed(1, f"{UNSENT_MAX} bytes wait for a device that is not so quick", ChannelError.OTHER)
    ]
    assert bench.world._world.network.open_channels == 0


def test_a_device_is_a_client_of_any_port_of_a_served_robot():
    heard = []

    class Panel(TcpClient):
        service = "dashboard"

        def line_received(self, line):
            heard.append(line)
            return "robotMode" if len(heard) == 1 else None

    bench = Bench(World(devices=[Panel()]))
    bench.run(10)
    assert heard[0].startswith("EliRobot dashboard shell")
    assert any("RUNNING" in line for line in heard[1:])
