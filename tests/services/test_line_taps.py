"""Serial lines shared between programs and bridges."""

from __future__ import annotations

import pytest

from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelOpened
from elitescript.messages.line import LineSettings
from elitescript.messages.outputs import (
    CHANNEL_WINDOW,
    NOT_CONNECTED,
    CloseChannel,
    CreditChannel,
    OpenLine,
    SendChannel,
)
from elitescript.services.ssh.line_taps import GRACE_TICKS, LineTaps

OPEN = OpenLine(7, "tool", LineSettings(115200, 0, 1, 8))


class Client:
    def __init__(self) -> None:
        self.got = b""
        self.is_behind = False
        self.resumed = 0

    def receive(self, data: bytes) -> None:
        self.got += data

    def go_on(self) -> None:
        self.resumed += 1


@pytest.fixture
def said() -> list[str]:
    return []


@pytest.fixture
def taps(said: list[str]) -> LineTaps:
    return LineTaps(said.append)


def opened(taps: LineTaps) -> LineTaps:
    assert taps.outgoing([OPEN]) == [OPEN]
    assert taps.incoming([ChannelOpened(7, True)]) == [ChannelOpened(7, True)]
    return taps


def test_without_a_client_everything_passes(taps: LineTaps) -> None:
    opened(taps)
    inputs = [ChannelData(7, b"x"), ChannelCredit(7, 3), ChannelData(8, b"y")]
    assert taps.incoming(inputs) == inputs
    requests = [SendChannel(7, b"abc"), CreditChannel(7, 1)]
    assert taps.outgoing(requests) is requests


def test_a_client_gets_what_arrives_and_the_line_gets_credit_for_it(taps: LineTaps) -> None:
    opened(taps)
    one, two = Client(), Client()
    taps.join("tool", one)
    taps.join("tool", two)
    assert taps.incoming([ChannelData(7, b"abc"), ChannelData(8, b"other")]) == [ChannelData(8, b"other")]
    assert one.got == two.got == b"abc"
    assert taps.outgoing([]) == (CreditChannel(7, 3),)
    assert taps.outgoing([]) == []
    taps.leave("tool", one)
    taps.leave("tool", two)
    assert taps.incoming([ChannelData(7, b"x")]) == [ChannelData(7, b"x")]


def test_a_client_that_does_not_read_stops_the_line(taps: LineTaps) -> None:
    opened(taps)
    client = Client()
    taps.join("tool", client)
    client.is_behind = True
    taps.incoming([ChannelData(7, b"abc")])
    assert taps.outgoing([]) == []
    taps.leave("tool", client)
    assert taps.outgoing([]) == (CreditChannel(7, 3),)


def test_what_a_client_sends_goes_out_in_the_next_tick_and_its_credit_is_not_the_programs(taps: LineTaps) -> None:
    opened(taps)
    taps.join("tool", Client())
    assert taps.send("tool", b"hello")
    program = SendChannel(7, b"program")
    assert taps.outgoing([program]) == (program, SendChannel(7, b"hello"))
    assert taps.incoming([ChannelCredit(7, 3)]) == []
    assert taps.incoming([ChannelCredit(7, 9)]) == [ChannelCredit(7, 7)]


def test_no_more_than_the_window_is_on_its_way(taps: LineTaps) -> None:
    opened(taps)
    client = Client()
    taps.join("tool", client)
    assert not taps.send("tool", bytes(CHANNEL_WINDOW + 10))
    (first,) = taps.outgoing([])
    assert isinstance(first, SendChannel) and len(first.data) == CHANNEL_WINDOW
    assert taps.outgoing([]) == []
    assert client.resumed == 2
    taps.incoming([ChannelCredit(7, 4)])
    assert taps.outgoing([]) == (SendChannel(7, bytes(4)),)


def test_bytes_for_a_line_that_no_program_has_enabled_are_lost_and_the_log_says_so_once(
    taps: LineTaps, said: list[str]
) -> None:
    client = Client()
    taps.join("tool", client)
    assert taps.send("tool", b"x")
    assert not taps.send("tool", bytes(CHANNEL_WINDOW))
    for _ in range(GRACE_TICKS):
        taps.outgoing([])
    assert said == [] and client.resumed == 0
    taps.outgoing([])
    assert client.resumed == 1
    assert not taps.send("tool", b"y")
    taps.outgoing([])
    assert client.resumed == 2
    assert said == [
        "a client bridges the serial port tool, and its bytes go nowhere: no program has enabled it "
        "(tool_serial_config, masterboard_serial_config)"
    ]
    opened(taps)
    assert taps.outgoing([]) == []


def test_what_a_client_sends_while_the_line_opens_waits_for_it(taps: LineTaps, said: list[str]) -> None:
    taps.join("tool", Client())
    taps.send("tool", b"early, ")
    assert taps.outgoing([OPEN]) == [OPEN]
    taps.send("tool", b"less early")
    assert taps.outgoing([]) == []
    taps.incoming([ChannelOpened(7, True)])
    assert taps.outgoing([]) == (SendChannel(7, b"early, less early"),)
    assert said == []


def test_the_next_client_waits_again(taps: LineTaps, said: list[str]) -> None:
    first, second = Client(), Client()
    taps.join("tool", first)
    for _ in range(GRACE_TICKS + 1):
        taps.outgoing([])
    taps.leave("tool", first)
    taps.join("tool", first)
    taps.send("tool", b"of one that has gone")
    taps.leave("tool", first)
    taps.join("tool", second)
    taps.send("tool", b"x")
    opened(taps)
    assert taps.outgoing([]) == (SendChannel(7, b"x"),)
    assert len(said) == 1


def test_nothing_bound_is_said_once(taps: LineTaps, said: list[str]) -> None:
    taps.outgoing([OPEN])
    refusal = ChannelOpened(7, False, NOT_CONNECTED)
    assert taps.incoming([refusal]) == [refusal]
    taps.join("tool", Client())
    taps.send("tool", b"x")
    assert said == ["a client bridges the serial port tool, and its bytes go nowhere: nothing is connected"]


@pytest.mark.parametrize("ends_by", ["program", "device"])
def test_a_line_that_ends_while_a_client_waits_lets_it_go_on(taps: LineTaps, said: list[str], ends_by: str) -> None:
    opened(taps)
    client = Client()
    taps.join("tool", client)
    taps.send("tool", bytes(CHANNEL_WINDOW))
    if ends_by == "program":
        taps.outgoing([CloseChannel(7)])
    else:
        assert taps.incoming([ChannelClosed(7, "unplugged")]) == [ChannelClosed(7, "unplugged")]
    assert client.resumed == 1
    for _ in range(GRACE_TICKS + 1):
        taps.send("tool", b"x")
        taps.outgoing([])
    assert len(said) == 1
    assert taps.incoming([ChannelData(7, b"late")]) == [ChannelData(7, b"late")]


def test_a_line_that_is_configured_anew_has_another_channel(taps: LineTaps) -> None:
    opened(taps)
    client = Client()
    taps.join("tool", client)
    taps.outgoing([CloseChannel(7), OpenLine(9, "tool", OPEN.settings)])
    taps.incoming([ChannelOpened(9, True), ChannelData(9, b"new")])
    taps.send("tool", b"x")
    assert client.got == b"new"
    assert taps.outgoing([]) == (SendChannel(9, b"x"), CreditChannel(9, 3))


def test_a_line_without_a_name_is_left_alone(taps: LineTaps) -> None:
    taps.outgoing([OpenLine(3, "/dev/ttyS2", OPEN.settings)])
    assert taps.incoming([ChannelOpened(3, True), ChannelData(3, b"x")]) == [
        ChannelOpened(3, True),
        ChannelData(3, b"x"),
    ]
