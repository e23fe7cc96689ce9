"""Connections of this computer, with real servers on a port of the system's choice."""

from __future__ import annotations

import socket
import sys
import threading
import time
from contextlib import suppress

import pytest

from elitescript.environment import local_channels as real_channels
from elitescript.environment import tcp_channel
from elitescript.environment.local_channels import HOPE_TICKS, LocalChannels
from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelOpened
from elitescript.messages.outputs import CHANNEL_WINDOW
from elitescript.robot import VirtualRobot

PATIENCE_TICKS = 2500
"""Far more than a computer under load needs."""


@pytest.fixture
def server():
    with socket.create_server(("127.0.0.1", 0)) as listening:
        listening.settimeout(10)
        yield listening


def port_of(listening):
    return listening.getsockname()[1]


class Bench:
    """Channels, and the tick that comes next."""

    def __init__(self):
        self.said = []
        self.channels = LocalChannels(network="all", say=self.said.append)
        self.tick = 0
        self.port = 0

    def until(self, is_enough):
        """Everything that happens until it is enough."""
        events = []
        for _ in range(PATIENCE_TICKS):
            events += self.channels.arrivals(self.tick)
            self.tick += 1
            if is_enough(events):
                return events
        raise AssertionError(f"only {events}")

    def opened(self, listening, address="127.0.0.1"):
        self.port = port_of(listening)
        channel = self.channels.open(address, self.port, 2.0)
        assert self.until(bool) == [ChannelOpened(channel, True)]
        peer, _ = listening.accept()
        peer.settimeout(10)
        return channel, peer


@pytest.fixture
def bench():
    bench = Bench()
    yield bench
    for channel in range(1, 10):
        bench.channels.close(channel)
    bench.channels.give_up()


@pytest.mark.parametrize("address", ["127.0.0.1", "localhost"])
def test_bytes_go_both_ways(bench, server, address):
    channel, peer = bench.opened(server, address)
    with peer:
        bench.channels.send(channel, b"hello")
        assert peer.recv(100) == b"hello"
        assert bench.until(bool) == [ChannelCredit(channel, 5)]
        peer.sendall(b"world")
        assert bench.until(bool) == [ChannelData(channel, b"world")]
        assert bench.channels.is_real
        bench.channels.close(channel)
        assert peer.recv(100) == b""
    assert not bench.channels.is_real


def test_the_end_of_the_peer_comes_after_its_last_bytes(bench, server):
    channel, peer = bench.opened(server)
    peer.sendall(b"last")
    peer.close()
    events = bench.until(lambda events: any(isinstance(event, ChannelClosed) for event in events))
    assert events == [ChannelData(channel, b"last"), ChannelClosed(channel)]


@pytest.mark.parametrize(
    ("address", "reason", "number"),
    [
        ("127.0.0.1", "connection refused", 111),
        ("", "not known", 113),
        ("a..b", "not known", 113),
        ("a\0b", "not known", 113),
        pytest.param(
            "224.0.0.1", "unreachable", 101, marks=pytest.mark.skipif(sys.platform != "linux", reason="its words")
        ),
    ],
)
def test_what_cannot_be_reached_says_why(bench, server, address, reason, number):
    port = port_of(server)
    server.close()
    channel = bench.channels.open(address, port, 2.0)
    (event,) = bench.until(bool)
    assert (event.channel, event.is_open) == (channel, False)
    assert reason in event.reason
    assert event.error == number
    assert not bench.channels.is_real


def test_no_more_is_read_than_there_is_room_for(bench, server):
    channel, peer = bench.opened(server)
    with peer:
        peer.setblocking(False)
        with suppress(BlockingIOError):
            while True:
                peer.send(bytes(65536))

        def size(events):
            return sum(len(event.data) for event in events)

        bench.until(lambda events: size(events) >= CHANNEL_WINDOW)
        assert size(bench.channels.arrivals(bench.tick)) == 0
        bench.channels.credit(channel, 10)
        assert size(bench.until(bool)) == 10


def test_credit_comes_only_for_what_has_left(bench, server):
    channel, peer = bench.opened(server)
    with peer:
        total = 0
        while True:
            bench.channels.send(channel, bytes(1 << 20))
            total += 1 << 20
            credited = sum(event.size for event in bench.channels.arrivals(bench.tick))
            bench.tick += 1
            if credited < 1 << 20:
                break
        received = 0
        peer.setblocking(False)
        left = 0
        while received < total:
            with suppress(BlockingIOError):
                received += len(peer.recv(1 << 20))
            left += sum(event.size for event in bench.channels.arrivals(bench.tick))
            bench.tick += 1
        assert left > 0


def test_closing_sends_what_waits_and_does_not_lose_it_for_unread_bytes(bench, server):
    channel, peer = bench.opened(server)
    with peer:
        peer.sendall(b"nobody reads this")
        bench.channels.send(channel, b"goodbye")
        bench.channels.close(channel)
        assert peer.recv(100) == b"goodbye"
        assert peer.recv(100) == b""


def test_a_free_run_is_held_back_to_the_wall_clock_while_a_connection_is_open(server):
    program = f"""
def main():
  socket_open("127.0.0.1", {port_of(server)})
  sleep(0.06)
  socket_close()
  sleep(3600)
  textmsg("done")
end
"""
    start_s = time.perf_counter()
    run = VirtualRobot().run(program)
    taken_s = time.perf_counter() - start_s
    assert run.log == ["done"]
    assert run.is_paced
    assert 0.05 < taken_s < 30


def test_a_run_that_connects_to_nobody_is_not_paced():
    run = VirtualRobot().run('def main():\n  socket_read_string("none")\n  sleep(60)\nend\n')
    assert not run.is_paced


@pytest.fixture
def no_waiting(monkeypatch):
    monkeypatch.setattr(real_channels, "sleep", lambda seconds: None)


def test_time_is_held_back_for_a_while_after_a_connection_was_lost(bench, server, no_waiting):
    _, peer = bench.opened(server)
    peer.close()
    bench.until(lambda events: any(isinstance(event, ChannelClosed) for event in events))
    lost = bench.tick - 1
    assert bench.channels.next_tick(lost) == lost + 1
    bench.channels.arrivals(lost + HOPE_TICKS - 1)
    assert bench.channels.is_real
    assert not bench.channels.arrivals(lost + HOPE_TICKS)
    assert not bench.channels.is_real
    assert bench.channels.next_tick(lost + HOPE_TICKS) is None


def test_a_try_to_connect_again_holds_it_back_longer(bench, server, no_waiting):
    _, peer = bench.opened(server)
    peer.close()
    server.close()
    bench.until(lambda events: any(isinstance(event, ChannelClosed) for event in events))
    bench.tick += HOPE_TICKS // 2
    bench.channels.open("127.0.0.1", bench.port, 2.0)
    bench.until(lambda events: any(isinstance(event, ChannelOpened) for event in events))
    bench.channels.arrivals(bench.tick + HOPE_TICKS - 2)
    assert bench.channels.is_real


def test_a_program_that_was_never_answered_is_not_held_back(bench, server, no_waiting):
    port = port_of(server)
    server.close()
    bench.channels.open("127.0.0.1", port, 2.0)
    bench.until(bool)
    assert not bench.channels.is_real


def test_a_program_finds_a_server_that_comes_back(server):
    port = port_of(server)

    def serve():
        first, _ = server.accept()
        first.recv(1)
        server.close()
        first.close()
        time.sleep(0.3)
        with socket.create_server(("127.0.0.1", port)) as again:
            again.settimeout(10)
            second, _ = again.accept()
            with second:
                second.recv(1)
                second.sendall(b"back\n")

    thread = threading.Thread(target=serve)
    thread.start()
    program = f"""
def main():
  for n in range(50):
    if socket_open("127.0.0.1", {port}):
      socket_send_byte(65)
      text = socket_read_string("socket_0", "", "\\n")
      if text != "":
        textmsg(text)
        break
      end
    end
    sleep(0.1)
  end
end
"""
    run = VirtualRobot().run(program)
    thread.join()
    assert run.log == ["back"]


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux says what is not confirmed")
def test_the_end_of_a_half_that_is_not_confirmed_is_no_byte_that_was_lost(server, monkeypatch):
    monkeypatch.setattr(tcp_channel, "_unacknowledged", lambda connection: 1)
    channels = LocalChannels()
    number = channels.open(*server.getsockname()[:2], 2.0)
    while not channels.arrivals(0):
        pass
    assert channels.pending() == (f"1 byte to 127.0.0.1:{port_of(server)}",)
    channels.close(number)
    assert channels.pending() == () and channels.give_up() == ()
