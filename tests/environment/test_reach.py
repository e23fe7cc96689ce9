"""What the option `network` lets through, for each way to write an address; nothing here asks a name server."""

from __future__ import annotations

import socket
import sys

import pytest

from elitescript.environment import tcp_channel
from elitescript.environment.local_channels import PEERS_MAX, LocalChannels
from elitescript.environment.network_option import COMMAND_LINE, COMMENT, LAUNCH, MARKER, PYTHON, STUDIO, WORLD_FILE
from elitescript.environment.reach import Reach, numeric
from elitescript.errors import UsageError
from elitescript.messages.enums import ChannelError
from elitescript.messages.inputs import ChannelOpened

PORT = 502

LOOPBACK = ["127.0.0.1", "127.9.8.7", "::1", "::ffff:127.0.0.1", "localhost", "LocalHost", "localhost."]
if sys.platform == "linux":
    # Elsewhere some of these are names, which is as good: they are not looked up.
    LOOPBACK += ["127.1", "2130706433", "0x7f000001", "0177.0.0.1"]
REAL = [
    "192.168.1.5",
    "10.0.0.1",
    "8.8.8.8",
    "3232235781",
    "0xc0a80105",
    "192.168.261",
    "0300.0250.1.5",
    "::ffff:192.168.1.5",
    "2001:db8::5",
    "fd00::5",
    "fe80::1",
    "64:ff9b::7f00:1",
    "2002:7f00:1::",
    "::127.0.0.1",
    "169.254.169.254",
    "224.0.0.1",
    "ff02::1",
    "255.255.255.255",
    "0.0.0.0",
    "0",
    "::",
    "::ffff:0.0.0.0",
    "128.0.0.1",
    "126.255.255.255",
]
NAMES = [
    "plc.factory",
    "localhost.plc.factory",
    "x.localhost",
    "localhost.localdomain",
    "",
    "a b",
    "ü.de",
    "a\0b",
    "x" * 300,
]


@pytest.fixture(autouse=True)
def no_name_server(monkeypatch):
    """Fail on every query of a name; numbers of addresses are no query."""
    asked = []
    inner = socket.getaddrinfo

    def getaddrinfo(host, port, *args, flags=0, **more):
        if not flags & socket.AI_NUMERICHOST:
            asked.append(host)
            raise AssertionError(f"{host!r} is looked up")
        return inner(host, port, *args, flags=flags, **more)

    monkeypatch.setattr(socket, "getaddrinfo", getaddrinfo)
    return asked


def is_let_through(value: str, address: str, port: int = PORT) -> bool:
    decision = Reach(value).decide(address, port)
    assert bool(decision.why_not) != bool(decision.rows or decision.is_name)
    return not decision.why_not


@pytest.mark.parametrize("address", LOOPBACK)
def test_loopback_addresses_are_local(address):
    assert is_let_through("local", address)
    assert is_let_through("192.168.1.5", address)
    assert is_let_through("all", address)
    assert not is_let_through("none", address)


@pytest.mark.parametrize("address", REAL)
def test_any_other_address_is_not_reached_unless_it_is_named(address):
    decision = Reach("local").decide(address, PORT)
    assert not decision.rows and not decision.is_name
    assert decision.why_not.startswith(f"not connected to {f'[{address}]' if ':' in address else address}:502: it is ")
    assert not is_let_through("none", address)
    assert is_let_through("all", address)
    # The message has the value that allows it, and no more.
    value = decision.why_not.split("`--network ")[1].split("`")[0]
    assert is_let_through(value, address)
    assert not is_let_through(value, address, 503)
    assert not is_let_through(value, "192.168.1.77")


@pytest.mark.parametrize("name", NAMES)
def test_no_name_is_looked_up_that_the_option_does_not_name(name):
    for value in ("none", "local", "192.168.1.0/24", "plc.other", "plc.factory:80"):
        decision = Reach(value).decide(name, PORT)
        assert decision.why_not and not decision.is_name


def test_a_name_is_looked_up_that_the_option_names():
    for value in ("plc.factory", "PLC.factory.:502", "10.0.0.1,plc.factory", "all"):
        assert Reach(value).decide("plc.factory", PORT) == ([], True, "", "", "")


def rows_of(*addresses: str) -> list:
    return [row for address in addresses for row in numeric(address, PORT)]


@pytest.mark.parametrize(
    ("value", "found", "reached"),
    [
        ("plc.factory", ["10.0.0.9"], ["10.0.0.9"]),
        ("plc.factory", ["2001:db8::9", "10.0.0.9"], ["10.0.0.9", "2001:db8::9"]),
        ("plc.factory", ["127.0.0.1"], ["127.0.0.1"]),
        # What a name server answers may be anything.
        ("plc.factory", ["169.254.169.254"], []),
        ("plc.factory", ["::ffff:169.254.169.254"], []),
        ("plc.factory", ["0.0.0.0"], []),
        ("plc.factory", ["224.0.0.1"], []),
        ("plc.factory", ["169.254.169.254", "10.0.0.9"], ["10.0.0.9"]),
        ("plc.factory,169.254.169.254", ["169.254.169.254"], ["169.254.169.254"]),
        ("all", ["169.254.169.254"], ["169.254.169.254"]),
    ],
)
def test_what_a_name_stands_for_is_decided_on_and_nothing_else_is_connected(value, found, reached):
    decision = Reach(value).among(rows_of(*found), "plc.factory", PORT)
    assert [row[4][0] for row in decision.rows] == reached
    assert bool(decision.why_not) is not bool(reached)


@pytest.mark.parametrize(
    ("value", "address", "port", "reached"),
    [
        ("192.168.1.5:502", "192.168.1.5", 502, True),
        ("192.168.1.5:502", "192.168.1.5", 503, False),
        ("192.168.1.5:502", "::ffff:192.168.1.5", 502, True),
        ("192.168.1.0/24", "192.168.1.77", 1, True),
        ("192.168.1.0/24:502", "192.168.1.77", 1, False),
        ("[fd00::5]:502", "fd00::5", 502, True),
        ("[fd00::5]:502", "fd00:0:0::5", 502, True),
        ("[fd00::5]:502", "fd00::6", 502, False),
        ("fd00::/8", "fd12::6", 9, True),
        (" 10.0.0.1 , 10.0.0.2:80 ", "10.0.0.2", 80, True),
        ("local,10.0.0.1", "10.0.0.1", 80, True),
        ("192.168.1.5", "64:ff9b::c0a8:105", 80, False),
    ],
)
def test_a_value_is_a_list_of_addresses_networks_and_ports(value, address, port, reached):
    assert is_let_through(value, address, port) is reached


@pytest.mark.parametrize(
    "value",
    [
        "",
        " ",
        "a,,b",
        "none,all",
        "none,10.0.0.1",
        "10.0.0.1:0",
        "10.0.0.1:65536",
        "10.0.0.0/33",
        "a b",
        "127.1",
        "999.1.1.1",
        "fe80::1%eth0",
        "http://10.0.0.1",
        "x" * 254,
    ],
)
def test_a_value_without_sense_is_refused(value):
    with pytest.raises(UsageError, match="--network"):
        Reach(value)


def test_the_option_that_is_proposed_keeps_what_was_allowed():
    decision = Reach("10.0.0.1,plc.factory").decide("10.0.0.2", 80)
    assert decision.why_not.endswith("; `--network 10.0.0.1,plc.factory,10.0.0.2:80` allows it")


# ---------------------------------------------------------------- channels


class Never(socket.socket):
    """A socket that fails the test when something is connected."""

    def connect_ex(self, address):
        raise AssertionError(f"connected to {address}")

    connect = connect_ex


def test_what_is_not_let_through_costs_no_time_and_no_socket(monkeypatch):
    monkeypatch.setattr(tcp_channel.socket, "socket", Never)
    said = []
    channels = LocalChannels(say=said.append)
    numbers = [channels.open(address, PORT, 2.0) for address in (*REAL, *NAMES)]
    assert numbers == [*range(1, len(numbers) + 1)]
    assert not channels.is_real
    assert channels.next_tick(7) == 8
    events = channels.arrivals(8)
    assert [event.channel for event in events] == numbers
    assert all(event == ChannelOpened(event.channel, False, event.reason, ChannelError.BARRED) for event in events)
    assert not channels.is_real and channels.next_tick(8) is None and not channels.arrivals(9)
    for number in numbers:
        channels.send(number, b"x")
        channels.close(number)
    assert not channels.pending() and not channels.give_up() and not said


def test_refused_connections_are_counted_by_peer_and_the_list_is_bounded():
    channels = LocalChannels()
    assert channels.take_refused() == ""
    for _ in range(3):
        channels.open("10.0.0.1", 80, 2.0)
    channels.open("plc", 502, 2.0)
    assert channels.take_refused() == (
        "--network local has refused 4 connections: 10.0.0.1:80 (3 times), plc:502; "
        "`--network 10.0.0.1:80,plc:502` allows them"
    )
    assert channels.take_refused() == ""
    for number in range(PEERS_MAX + 50):
        channels.open(f"10.0.1.{number % 256}", 80 + number, 2.0)
    assert "others (50 times)" in channels.take_refused()


def test_a_name_that_stands_for_something_else_is_refused_when_it_was_looked_up(monkeypatch):
    monkeypatch.setattr(tcp_channel.socket, "socket", Never)
    monkeypatch.setattr(tcp_channel, "Thread", Now)
    said = []
    channels = LocalChannels(network="plc.factory", say=said.append)

    def answer(host, port, flags=0, **_):
        if flags & socket.AI_NUMERICHOST:
            raise socket.gaierror(socket.EAI_NONAME, "a name")
        return [(socket.AF_INET, socket.SOCK_STREAM, 6, "", ("169.254.169.254", 502))]

    monkeypatch.setattr(socket, "getaddrinfo", answer)
    number = channels.open("plc.factory", PORT, 2.0)
    assert channels.is_real
    (event,) = channels.arrivals(0)
    assert (event.channel, event.is_open, event.error) == (number, False, ChannelError.BARRED)
    assert "it is 169.254.169.254, a link-local address" in event.reason
    assert channels.take_refused().startswith("--network plc.factory has refused 1 connection: plc.factory:502;")
    assert said == ["the program connects to plc.factory:502 (--network plc.factory)"]


class Now:
    """A thread that runs at once."""

    def __init__(self, target, **_):
        self.start = target


def test_each_peer_is_named_once_before_it_is_connected_to(monkeypatch):
    order = []

    class Noted(socket.socket):
        def connect_ex(self, address):
            order.append(address[:2])
            return 111

    monkeypatch.setattr(tcp_channel.socket, "socket", Noted)
    channels = LocalChannels(network="10.0.0.1", say=order.append)
    for tick in range(3):
        channels.open("10.0.0.1", PORT, 2.0)
        channels.arrivals(tick)
    peer = ("10.0.0.1", PORT)
    assert order == ["the program connects to 10.0.0.1:502 (--network 10.0.0.1)", peer, peer, peer]


@pytest.mark.parametrize(
    ("way", "hint", "count"),
    [
        (COMMAND_LINE, "`--network 10.0.0.1:80` allows it", "--network local has"),
        (PYTHON, '`network="10.0.0.1:80"` allows it', 'network="local" has'),
        (MARKER, '`@pytest.mark.elitescript(network="10.0.0.1:80")` allows it', 'network="local" has'),
        (COMMENT, "`# elitescript: network=10.0.0.1:80` allows it", "network=local has"),
        (LAUNCH, '`"network": "10.0.0.1:80"` allows it', '"network": "local" has'),
        (WORLD_FILE, '`[robot] network = "10.0.0.1:80"` allows it', 'network = "local" has'),
    ],
)
def test_the_option_is_named_as_users_write_it_there(way, hint, count):
    channels = LocalChannels()
    channels.way = way
    channels.open("10.0.0.1", 80, 2.0)
    (event,) = channels.arrivals(0)
    assert event.reason.endswith(hint)
    text = channels.take_refused()
    assert text.startswith(count) and text.endswith(hint)


def test_a_closed_run_of_the_studio_names_its_button():
    channels = LocalChannels(is_closed=True)
    channels.way = STUDIO
    channels.open("10.0.0.1", 80, 2.0)
    channels.open("plc", 80, 2.0)
    texts = [event.reason for event in channels.arrivals(0)]
    assert all(text.endswith("; `Allow connections` allows it") for text in texts)
    assert channels.take_refused().endswith(": 10.0.0.1:80, plc:80; `Allow connections` allows them")


@pytest.mark.parametrize("name", ["a b`; x`", "ü.factory", "a,all", "[::1]", "a\nb\x1b[31m"])
def test_no_value_is_proposed_for_what_no_value_can_name(name):
    channels = LocalChannels()
    channels.open(name, 80, 2.0)
    (event,) = channels.arrivals(0)
    text = channels.take_refused()
    assert "--network local does not look up" in event.reason and "allows" not in event.reason + text
    assert (event.reason + text).isprintable()
