"""Serial ports of this computer, with pseudo-terminals in their place."""

from __future__ import annotations

import os
import socket
import sys
from contextlib import suppress
from threading import Thread

import pytest

from elitescript import extras
from elitescript.environment import serial_channel
from elitescript.environment.local_channels import LocalChannels
from elitescript.environment.memory import MemoryEnvironment
from elitescript.environment.serial_channel import SerialChannel
from elitescript.errors import UsageError
from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelOpened
from elitescript.messages.line import LineSettings
from elitescript.messages.outputs import CHANNEL_WINDOW
from elitescript.modbus.frames import pdu
from elitescript.modbus.frames.rtu import RtuSplitter, rtu_frame
from elitescript.robot import VirtualRobot
from tests.environment.terminal import Terminal
from tests.runtime.line_bench import program

pytest.importorskip("serial")
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="there are no pseudo-terminals")

SETTINGS = LineSettings(115200, 0, 1, 8)


@pytest.fixture
def terminal():
    terminal = Terminal()
    yield terminal
    terminal.close()


@pytest.fixture
def channel(terminal):
    channel = SerialChannel(7, terminal.name, SETTINGS)
    yield channel
    channel.close()


def polled(channel, is_enough):
    """What happens until it is enough."""
    events = []
    for _ in range(100_000):
        events += channel.poll()
        if is_enough(events):
            return events
    raise AssertionError(events)


def test_it_is_open_at_once(channel):
    assert channel.poll() == [ChannelOpened(7, True)]
    assert channel.poll() == []


def test_bytes_go_out_as_they_are(channel, terminal):
    channel.poll()
    data = bytes(range(256))
    channel.send(data)
    assert polled(channel, bool) == [ChannelCredit(7, 256)]
    assert terminal.read(256) == data


@pytest.mark.parametrize("settings", [SETTINGS, LineSettings(2400, 1, 2, 7), LineSettings(2_000_000, 2, 1, 8)])
def test_bytes_come_in_as_they_are(terminal, settings):
    channel = SerialChannel(7, terminal.name, settings)
    channel.poll()
    data = bytes(range(256))
    terminal.write(data)
    events = polled(channel, lambda events: sum(len(event.data) for event in events) == 256)
    assert b"".join(event.data for event in events) == data
    channel.close()


def test_no_more_comes_than_there_is_room_for(channel, terminal):
    channel.poll()
    channel.room = 3
    terminal.write(b"abcdef")
    assert polled(channel, bool) == [ChannelData(7, b"abc")]
    assert channel.poll() == []
    channel.room += 3
    assert polled(channel, bool) == [ChannelData(7, b"def")]


def test_what_the_system_does_not_take_waits(channel, terminal):
    channel.poll()
    data = bytes(1000) * 60
    channel.send(data)
    assert 0 < channel.unsent < len(data)
    received = b""
    events = []
    while len(received) < len(data):
        received += terminal.read(min(1000, len(data) - len(received)))
        events += channel.poll()
    assert (received, channel.unsent) == (data, 0)
    events += channel.poll()
    assert sum(event.size for event in events) == len(data)


def test_closing_waits_until_what_was_sent_has_left(channel, terminal):
    channel.poll()
    data = bytes(1000) * 30
    channel.send(data)
    assert channel.unsent
    assert not channel.has_left
    received = []
    channel.close()
    assert not channel.is_over
    reader = Thread(target=lambda: received.append(terminal.read(len(data))))
    reader.start()
    while not channel.is_over:
        channel.leave()
    reader.join(10)
    assert received == [data]
    assert channel.lost == 0


def test_closing_does_not_wait_for_ever(channel, terminal, monkeypatch):
    monkeypatch.setattr(serial_channel, "CLOSING_S", 0.0)
    channel.poll()
    channel.send(bytes(100_000))
    channel.close()
    assert channel.is_over
    assert channel.has_left


def test_a_device_that_goes_closes_the_channel(channel, terminal):
    channel.poll()
    terminal.hang_up()
    (event,) = polled(channel, bool)
    assert isinstance(event, ChannelClosed)
    assert event.reason
    assert channel.is_over


def test_sending_to_one_that_has_gone_is_no_crash(channel, terminal):
    channel.poll()
    terminal.hang_up()
    channel.send(b"x")
    assert isinstance(polled(channel, bool)[-1], ChannelClosed)


@pytest.mark.parametrize(
    ("device", "settings", "reason"),
    [
        ("/dev/there-is-none", SETTINGS, "No such file or directory"),
        ("/tmp", SETTINGS, "directory"),
        ("/dev/null", SETTINGS, ""),
    ],
)
def test_a_device_that_cannot_be_opened_says_why(device, settings, reason):
    channel = SerialChannel(7, device, settings)
    (event,) = channel.poll()
    assert (event.channel, event.is_open) == (7, False)
    assert event.reason
    assert reason in event.reason
    assert channel.is_over
    channel.close()


def test_two_cannot_have_one_port(channel, terminal):
    other = SerialChannel(8, terminal.name, SETTINGS)
    (event,) = other.poll()
    assert not event.is_open
    assert "lock" in event.reason
    channel.close()
    other = SerialChannel(9, terminal.name, SETTINGS)
    assert other.poll() == [ChannelOpened(9, True)]
    other.close()


@pytest.mark.parametrize("error", [ValueError("Invalid baud rate: 921600"), OSError("not supported")])
def test_a_speed_that_the_system_refuses_is_told(monkeypatch, error):
    class Refusing:
        @staticmethod
        def Serial(*args, **settings):
            raise error

    monkeypatch.setitem(sys.modules, "serial", Refusing)
    assert SerialChannel(7, "/dev/ttyUSB0", SETTINGS).poll() == [ChannelOpened(7, False, str(error))]


def test_without_pyserial_it_names_the_extra(monkeypatch):
    monkeypatch.setattr(extras, "installed_version", lambda package: None)
    monkeypatch.setitem(sys.modules, "serial", None)
    (opened,) = SerialChannel(7, "/dev/ttyUSB0", SETTINGS).poll()
    assert isinstance(opened, ChannelOpened) and not opened.is_open
    assert opened.reason == (
        "a serial port of this computer needs pyserial 3.5 or newer, which is not installed: "
        "pip install 'elitescript[serial]'; socket://HOST:PORT works without it"
    )


class TestChannels:
    def test_a_port_without_a_binding_has_no_channel(self):
        channels = LocalChannels({"tool": "/dev/there-is-none"})
        assert channels.open_line("/dev/ttymxc0", SETTINGS) == 0
        assert not channels.is_real

    def test_bindings_are_checked(self):
        with pytest.raises(UsageError, match="no serial port 'arm'"):
            LocalChannels({"arm": "x"})

    def test_a_robot_has_lines_or_a_world(self):
        with pytest.raises(UsageError, match="lines are ports of this computer"):
            VirtualRobot(lines={"tool": "socket://h:1"}, world=MemoryEnvironment())

    def test_a_port_holds_time_back(self, terminal):
        channels = LocalChannels({"tool": terminal.name})
        number = channels.open_line("tool", SETTINGS)
        assert channels.is_real
        assert list(channels.arrivals(0)) == [ChannelOpened(number, True)]
        channels.send(number, b"abc")
        assert terminal.read(3) == b"abc"
        channels.credit(number, CHANNEL_WINDOW)
        channels.close(number)
        assert not channels.is_real

    def test_a_bridge_needs_no_pyserial(self):
        with socket.create_server(("127.0.0.1", 0)) as server:
            channels = LocalChannels({"box": f"socket://127.0.0.1:{server.getsockname()[1]}"})
            number = channels.open_line("/dev/ttymxc0", SETTINGS)
            tick = 0
            while not (events := list(channels.arrivals(tick))):
                tick += 1
            assert events == [ChannelOpened(number, True)]
            peer, _ = server.accept()
            channels.send(number, b"abc")
            assert peer.recv(3, socket.MSG_WAITALL) == b"abc"
            peer.close()
            channels.close(number)


class TestPrograms:
    """Programs with a line of this computer; the far end is played by a thread of the test's process."""

    def said(self, terminal, body, answer):
        """What a program says; `answer` makes of each reading what the far end writes."""

        def play():
            with suppress(OSError):
                while data := os.read(far, 4096):
                    for reply in answer(data):
                        os.write(far, reply)

        far = terminal.far
        player = Thread(target=play, daemon=True)
        player.start()
        run = VirtualRobot(lines={"tool": terminal.name}).run(program(body), until_s=20)
        assert run.is_paced
        return run.log

    def test_plain_bytes(self, terminal):
        body = """
        textmsg(tool_serial_config(True, 115200, 0, 1))
        textmsg(tool_serial_write([1, 2, 255]))
        textmsg(tool_serial_read(3, True, 5))
        tool_serial_config(False, 115200, 0, 1)
        """
        assert self.said(terminal, body, lambda data: [data]) == ["True", "3", "[1, 2, 255]"]

    def test_a_modbus_slave(self, terminal):
        splitter = RtuSplitter(is_slave=True)

        def answer(data):
            for frame in splitter.feed(data):
                request = pdu.request_of(frame.pdu)
                yield rtu_frame(frame.unit, pdu.registers_read(request.function, [request.address] * request.quantity))

        body = """
        tool_serial_config(True, 115200, 0, 1, 8, True)
        for a in range(5):
          textmsg(tool_modbus_read_registers(1, a, 2))
        end
        tool_serial_config(False, 115200, 0, 1)
        """
        assert self.said(terminal, body, answer) == [f"[{a}, {a}]" for a in range(5)]

    def test_a_device_that_is_plugged_in_again(self, terminal, tmp_path):
        place, other = tmp_path / "port", Terminal()
        place.symlink_to(terminal.name)
        heard = []

        def play():
            heard.append(terminal.read(5))
            terminal.hang_up()
            place.unlink()
            place.symlink_to(other.name)
            heard.append(other.read(5))
            other.write(b"x")

        player = Thread(target=play)
        player.start()
        body = """
        tool_serial_config(True, 115200, 0, 1)
        tool_serial_write("first")
        textmsg(tool_serial_read(1, True, 0), tool_serial_is_open(), tool_serial_mode())
        while not tool_serial_config(True, 115200, 0, 1):
          sleep(0.02)
        end
        tool_serial_write("again")
        textmsg(tool_serial_read(1, True, 0))
        tool_serial_config(False, 115200, 0, 1)
        """
        run = VirtualRobot(lines={"tool": str(place)}).run(program(body), until_s=20)
        player.join(10)
        other.close()
        assert run.log == ["[]FalseCLOSE", "[120]"]
        assert heard == [b"first", b"again"]
