"""Servers in memory: what they do comes a tick later, in order."""

from __future__ import annotations

import pytest

from elitescript.devices.agenda import DeviceError
from elitescript.devices.channels.network import UNSENT_MAX, Peer, VirtualNetwork
from elitescript.messages.enums import ChannelError
from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelOpened
from elitescript.messages.line import LineSettings
from elitescript.messages.outputs import CHANNEL_WINDOW


class Echo(Peer):
    def received(self, data):
        self.link.send(data)


@pytest.fixture
def channels():
    return VirtualNetwork({7: Echo, 8: Peer})


def opened(channels, port):
    channel = channels.open("h", port, 2.0)
    assert channels.arrivals(channels.tick + 1) == [ChannelOpened(channel, True)]
    return channel


def test_a_port_without_a_server_refuses(channels):
    assert channels.open("h", 9, 2.0) == 1
    assert channels.next_tick(0) == 1
    assert channels.arrivals(1) == [ChannelOpened(1, False, "connection refused", ChannelError.REFUSED)]
    assert channels.next_tick(1) is None


def test_an_answer_takes_a_tick_there_and_one_back(channels):
    channel = opened(channels, 7)
    channels.send(channel, b"abc")
    assert channels.arrivals(2) == [ChannelCredit(channel, 3)]
    assert channels.arrivals(3) == [ChannelData(channel, b"abc")]


def test_numbers_do_not_return(channels):
    first = opened(channels, 8)
    channels.close(first)
    assert opened(channels, 8) == first + 1


def test_a_server_sends_no_more_than_there_is_room_for(channels):
    channel = opened(channels, 7)
    channels.send(channel, bytes(CHANNEL_WINDOW))
    channels.send(channel, b"more")
    channels.arrivals(2)
    assert channels.arrivals(3) == [ChannelData(channel, bytes(CHANNEL_WINDOW))]
    channels.credit(channel, 3)
    assert channels.arrivals(4) == [ChannelData(channel, b"mor")]


def test_a_server_that_closes_is_heard_and_forgets_what_it_had_in_mind():
    class Server(Peer):
        def opened(self):
            self.link.later(1.0, lambda: self.link.send(b"never"))
            self.link.send(b"last")
            self.link.close()

    channels = VirtualNetwork({7: Server})
    channel = opened(channels, 7)
    assert channels.arrivals(2) == [ChannelData(channel, b"last"), ChannelClosed(channel)]
    channels.send(channel, b"into the void")
    channels.credit(channel, 1)
    channels.close(channel)
    assert channels.arrivals(1000) == []


def test_what_was_sent_before_a_close_arrives():
    seen = []

    class Server(Peer):
        def received(self, data):
            seen.append(data)

        def closed(self):
            seen.append("closed")

    channels = VirtualNetwork({7: Server})
    channel = opened(channels, 7)
    channels.send(channel, b"bye")
    channels.close(channel)
    assert channels.arrivals(2) == []  # nobody hears of the channel any more
    assert seen == [b"bye", "closed"]


LINE = LineSettings(9600, 0, 1, 8)
"""A character takes 1.0417 ms, 0.26 ticks."""


class Heard(Peer):
    def __init__(self, link, log):
        super().__init__(link)
        self.log = log

    def opened(self):
        self.log.append(("opened", self.link.time_s))

    def received(self, data):
        self.log.append((data, self.link.time_s))

    def closed(self):
        self.log.append(("closed", self.link.time_s))


@pytest.fixture
def line():
    log = []
    channels = VirtualNetwork(lines={"tool": lambda link: Heard(link, log)})
    return channels, channels.open_line("tool", LINE), log


def play(channels, until):
    """Every event up to a tick, with its tick."""
    events = []
    tick = channels.tick
    while (due := channels.next_tick(tick)) is not None and due <= until:
        tick = due
        events += [(tick, event) for event in channels.arrivals(tick)]
    return events


def test_a_line_takes_as_long_as_its_characters_and_carries_fractions_over(line):
    channels, channel, log = line
    play(channels, 1)
    channels.send(channel, bytes(960))
    events = play(channels, 10_000)
    assert sum(len(data) for data, _ in log[1:]) == 960
    # 960 characters of 10 bits at 9600 bit/s are one second, from tick 1 on.
    assert log[-1][1] == pytest.approx(1.004)
    assert sum(event.size for _, event in events) == 960
    assert {len(data) for data, _ in log[1:]} <= {3, 4}


def test_a_slow_line_is_not_looked_at_in_every_tick(line):
    channels, _, log = line
    slow = channels.open_line("tool", LineSettings(100, 0, 1, 8))
    play(channels, 1)
    channels.send(slow, b"ab")
    assert [tick for tick, _ in play(channels, 1000)] == [26, 51]
    assert log[-2:] == [(b"a", 0.104), (b"b", 0.204)]


def test_what_is_sent_later_waits_behind_what_is_on_the_line(line):
    channels, channel, log = line
    play(channels, 1)
    channels.send(channel, bytes(8))
    play(channels, 2)
    channels.send(channel, b"x")
    play(channels, 100)
    assert log[-1] == (b"\0x", 0.016) or log[-1][0].endswith(b"x")


def test_a_line_that_is_opened_again_is_taken_from_the_one_before(line):
    channels, first, log = line
    play(channels, 1)
    second = channels.open_line("tool", LINE)
    assert [event.channel for _, event in play(channels, 5)] == [second]
    assert log[1][0] == "closed"
    channels.send(first, b"lost")
    assert play(channels, 100) == []


def test_a_name_without_a_line_is_no_line():
    assert VirtualNetwork().open_line("tool", LINE) == 0


def test_bytes_of_the_device_come_in_chunks_and_late():
    class Server(Peer):
        def __init__(self, link):
            super().__init__(link)
            link.shape(latency_s=0.04, chunk=2)

        def opened(self):
            self.link.send(b"abcde")
            self.link.close()

    channels = VirtualNetwork({7: Server})
    channel = channels.open("h", 7, 2.0)
    assert play(channels, 100) == [
        (1, ChannelOpened(channel, True)),
        (11, ChannelData(channel, b"ab")),
        (12, ChannelData(channel, b"cd")),
        (13, ChannelData(channel, b"e")),
        (13, ChannelClosed(channel)),
    ]


def test_an_address_has_servers_of_its_own():
    channels = VirtualNetwork({7: Echo})
    channels.servers["10.0.0.9", 8] = Echo
    assert channels.server("10.0.0.9", 8) is Echo
    assert channels.server("10.0.0.1", 8) is None
    assert channels.server("10.0.0.1", 7) is Echo


def test_what_is_not_there_is_looked_for_outside():
    outside = VirtualNetwork({9: Echo})
    channels = VirtualNetwork({7: Echo}, outside=outside)
    here, there = channels.open("h", 7, 2.0), channels.open("h", 9, 2.0)
    assert [event for _, event in play(channels, 1)] == [ChannelOpened(here, True), ChannelOpened(there, True)]
    channels.send(there, b"hi")
    assert [event for _, event in play(channels, 3)] == [ChannelCredit(there, 2), ChannelData(there, b"hi")]
    channels.close(there)
    channels.send(there, b"lost")
    assert play(channels, 10) == []
    assert outside.open_channels == 0


def test_a_device_cannot_send_without_bound():
    class Server(Peer):
        def opened(self):
            self.link.send(bytes(UNSENT_MAX + CHANNEL_WINDOW + 1))

    channels = VirtualNetwork({7: Server})
    channels.open("h", 7, 2.0)
    with pytest.raises(DeviceError, match="that the program does not read"):
        channels.arrivals(1)
