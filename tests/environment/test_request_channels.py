"""Connections that somebody else holds."""

from __future__ import annotations

from elitescript.environment.request_channels import RequestEnvironment
from elitescript.messages.outputs import CloseChannel, CreditChannel, OpenChannel, SendChannel
from elitescript.runtime.environment import FilesRefused


def test_what_is_asked_for_is_collected_in_order_and_once():
    files = FilesRefused()
    world = RequestEnvironment(files)
    channels = world.channels
    assert channels.open("10.0.0.1", 80, 2.0) == 1
    channels.send(1, b"abc")
    channels.credit(1, 4)
    channels.close(1)
    assert channels.open("10.0.0.1", 80, 2.0) == 2
    assert channels.take() == (
        OpenChannel(1, "tcp", "10.0.0.1", 80, 2.0),
        SendChannel(1, b"abc"),
        CreditChannel(1, 4),
        CloseChannel(1),
        OpenChannel(2, "tcp", "10.0.0.1", 80, 2.0),
    )
    assert channels.take() == ()
    assert (world.files, channels.is_real, channels.next_tick(5), list(channels.arrivals(5))) == (
        files,
        False,
        None,
        [],
    )
