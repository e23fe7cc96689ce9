"""Servers of specification pages."""

from __future__ import annotations

import pytest

from elitescript.errors import UsageError
from elitescript.messages.inputs import ChannelClosed, ChannelData
from elitescript.messages.line import LineSettings
from tests.specification.pages import parse_page
from tests.specification.servers import PageServer, network, written


def talk(text, *sent):
    """What a server of these lines says, with the tick; the program sends a text in each of the first ticks."""
    server = PageServer(1, text)
    channels = network([server], [5000])
    channel = channels.open("h", 5000, 2.0)
    heard = []
    for tick in range(1, 400):
        for event in channels.arrivals(tick):
            if isinstance(event, ChannelData | ChannelClosed):
                heard.append((tick, getattr(event, "data", "closed")))
        if tick <= len(sent):
            channels.send(channel, sent[tick - 1])
    return heard, server.received


def test_it_speaks_and_closes_at_its_times():
    text = 'after 0 send "a\\x00"\n\nafter 0.5 send "b"\nafter 1 close\nafter 1.1 send "never"\n'
    assert talk(text)[0] == [(2, b"a\0"), (127, b"b"), (252, "closed")]


def test_it_answers_questions_however_they_are_cut():
    heard, received = talk('on "ab" send "1"\non "c" send "2"\n', b"xa", b"b", b"abc")
    assert heard == [(4, b"1"), (5, b"1"), (5, b"2")]
    assert written(received) == "xababc"


@pytest.mark.parametrize(
    "row", ["hello", "after x close", 'after 1 shout "a"', "on a send b", 'on "" send "b"', "after 1 send"]
)
def test_what_makes_no_sense_is_told_with_its_line(row):
    with pytest.raises(UsageError, match=r"line 8: .* is nothing that a server does"):
        PageServer(7, f"after 1 close\n{row}\n")


def test_a_case_has_its_servers_and_the_next_one_has_none():
    page = """# T
## One
```server 5000
after 0 send "a"
```
```elite
x
```
```expect
sent: b
```
## Two
```elite
x
```
```expect
out: b
```
"""
    one, two = parse_page(page)
    assert one.servers == ((5000, 4, 'after 0 send "a"\n'),)
    assert two.servers == ()


def test_a_server_needs_a_port():
    with pytest.raises(UsageError, match="line 1: a server needs a port"):
        parse_page("```server\n```\n")


def test_a_serial_device_is_written_in_the_same_way():
    page = '# Page\n\n```line tool\non "a" send "b"\n```\n```elite\ndef p():\nend\n```\n```expect\n```\n'
    (case,) = parse_page(page)
    assert case.servers == (("tool", 4, 'on "a" send "b"\n'),)
    server = PageServer(4, case.servers[0][2])
    channels = network([server], ["tool"])
    channel = channels.open_line("tool", LineSettings(2_000_000, 0, 1, 8))
    assert channels.open_line("/dev/ttymxc0", LineSettings(2_000_000, 0, 1, 8)) == 0
    list(channels.arrivals(1))
    channels.send(channel, b"a")
    heard = [event for tick in range(2, 5) for event in channels.arrivals(tick) if isinstance(event, ChannelData)]
    assert (heard, server.received) == ([ChannelData(channel, b"b")], b"a")


def test_a_serial_device_needs_a_port():
    with pytest.raises(UsageError, match="line 1: a serial line needs a port of the robot"):
        parse_page("```line\n```\n")
