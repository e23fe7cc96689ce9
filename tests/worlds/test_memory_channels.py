"""Servers in memory: what they do comes a tick later, in order."""

from __future__ import annotations

import pytest

from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelOpened
from elitescript.messages.outputs import CHANNEL_WINDOW
from elitescript.worlds.memory_channels import MemoryChannels, Peer


class Echo(Peer):
    def received(self, data):
        self.link.send(data)


@pytest.fixture
def channels():
    return MemoryChannels({7: Echo, 8: Peer})


def opened(channels, port):
    channel = channels.open("h", port, 2.0)
    assert channels.arrivals(channels.tick + 1) == [ChannelOpened(channel, True)]
    return channel


def test_a_port_without_a_server_refuses(channels):
    assert channels.open("h", 9, 2.0) == 1
    assert channels.next_tick(0) == 1
    assert channels.arrivals(1) == [ChannelOpened(1, False, "connection refused")]
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

    channels = MemoryChannels({7: Server})
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

    channels = MemoryChannels({7: Server})
    channel = opened(channels, 7)
    channels.send(channel, b"bye")
    channels.close(channel)
    assert channels.arrivals(2) == [ChannelCredit(channel, 3)]
    assert seen == [b"bye", "closed"]
