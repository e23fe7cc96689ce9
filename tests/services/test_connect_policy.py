"""What programs of a served robot reach."""

from __future__ import annotations

import asyncio
import socket

import pytest

from elitescript.errors import UsageError
from elitescript.messages.inputs import ChannelOpened
from elitescript.messages.outputs import OpenChannel
from elitescript.services.channels import connect_policy
from elitescript.services.channels.broker import Broker
from elitescript.services.channels.connect_policy import ConnectPolicy

OWN = 29999


def refusal(texts: list[str], address: str, port: int = 80, name: str = "") -> str:
    policy = ConnectPolicy(texts)
    policy.own_ports |= {OWN}
    return policy.refusal(name or address, address, port)


@pytest.mark.parametrize("address", ["127.0.0.1", "::1", "192.168.1.7", "10.0.0.1", "8.8.8.8", "2001:db8::1"])
def test_any_computer_is_reached_by_default(address):
    assert not refusal([], address)


@pytest.mark.parametrize(
    ("address", "kind"),
    [
        ("169.254.169.254", "a link-local address"),
        ("::ffff:169.254.169.254", "a link-local address"),
        ("64:ff9b::a9fe:a9fe", "a link-local address"),
        ("fe80::1", "a link-local address"),
        ("fe80::1%lo", "a link-local address"),
        ("0.0.0.0", "no address of a computer"),
        ("0.1.2.3", "no address of a computer"),
        ("::", "no address of a computer"),
        ("::ffff:0.0.0.0", "no address of a computer"),
        ("224.0.0.1", "a multicast address"),
        ("ff02::1", "a multicast address"),
        ("255.255.255.255", "the broadcast address"),
    ],
)
def test_special_addresses_are_refused_by_default_and_say_how_to_allow_them(address, kind):
    found = refusal([], address)
    assert f"is {kind}; `serve --allow-connect " in found
    assert not refusal([found.split("--allow-connect ")[1].split("`")[0]], address)
    assert not refusal(["any"], address)


@pytest.mark.parametrize("address", ["127.0.0.1", "127.9.9.9", "::1", "::ffff:127.0.0.1", "0.0.0.0", "::"])
@pytest.mark.parametrize(
    "texts", [[], ["127.0.0.0/8", "::1", "0.0.0.0", "::"], ["default", "127.0.0.1"], ["localhost"]]
)
def test_own_ports_are_refused_unless_they_are_named(texts, address):
    assert refusal(texts, address, OWN) == (
        "port 29999 of this computer is the robot's own; `serve --allow-connect own-ports` allows it"
    )
    assert not refusal([*texts, "own-ports"], address, OWN)
    assert not refusal(["any"], address, OWN)


def test_an_own_port_that_a_rule_names_is_allowed():
    assert not refusal(["127.0.0.1:29999"], "127.0.0.1", OWN)
    assert refusal(["127.0.0.1:29998"], "127.0.0.1", OWN)


def test_the_same_port_of_another_computer_is_not_the_own_one():
    assert not refusal([], "192.0.2.1", OWN)


def test_another_address_of_this_computer_is(monkeypatch):
    monkeypatch.setattr(connect_policy.socket, "socket", FakeSocket)
    assert refusal([], "192.168.1.7", OWN)
    assert not refusal([], "192.168.1.8", OWN)


class FakeSocket:
    """Of a computer with one address, from which everything is sent."""

    def __init__(self, family: int, kind: int) -> None:
        assert (family, kind) == (socket.AF_INET, socket.SOCK_DGRAM)

    def __enter__(self) -> FakeSocket:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def connect(self, address: tuple[str, int]) -> None:
        pass

    def getsockname(self) -> tuple[str, int]:
        return "192.168.1.7", 40000


@pytest.mark.parametrize(
    ("texts", "name", "address", "port", "is_allowed"),
    [
        (["192.168.1.0/24"], "", "192.168.1.7", 80, True),
        (["192.168.1.0/24"], "", "192.168.2.7", 80, False),
        (["192.168.1.0/24:502"], "", "192.168.1.7", 502, True),
        (["192.168.1.0/24:502"], "", "192.168.1.7", 503, False),
        (["10.0.0.1", "10.0.0.2:5"], "", "10.0.0.2", 5, True),
        (["10.0.0.1", "10.0.0.2:5"], "", "10.0.0.2", 6, False),
        (["10.0.0.1"], "", "127.0.0.1", 80, False),
        (["::1"], "", "::1", 80, True),
        (["[::1]:80"], "", "::1", 80, True),
        (["[::1]:80"], "", "::1", 81, False),
        (["fd00::/8"], "", "fd12::1", 81, True),
        (["camera.local"], "Camera.Local.", "192.168.1.7", 80, True),
        (["camera.local:80"], "camera.local", "192.168.1.7", 81, False),
        (["camera.local"], "other.local", "192.168.1.7", 80, False),
        (["camera.local"], "camera.local", "169.254.169.254", 80, False),
        (["localhost"], "127.0.0.1", "127.0.0.1", 80, True),
        (["none"], "", "127.0.0.1", 80, False),
        (["none"], "", "192.168.1.7", 80, False),
        (["own-ports"], "", "192.168.1.7", 80, True),
        (["default", "169.254.1.1"], "", "169.254.1.1", 80, True),
        (["default", "169.254.1.1"], "", "169.254.1.2", 80, False),
        (["default", "169.254.1.1"], "", "10.0.0.1", 80, True),
    ],
)
def test_rules_take_the_place_of_the_default(texts, name, address, port, is_allowed):
    assert (not refusal(texts, address, port, name)) is is_allowed


@pytest.mark.parametrize(
    "texts",
    [
        ["10.0.0.1:0"],
        ["10.0.0.1:65536"],
        ["10.0.0.1:x"],
        ["10.0.0.0/33"],
        ["a b"],
        [""],
        ["x" * 254],
        ["none", "any"],
        ["999.1.1.1"],
        ["127.1"],
        ["0x7f000001"],
    ],
)
def test_rules_without_sense_are_refused(texts):
    with pytest.raises(UsageError, match="--allow-connect"):
        ConnectPolicy(texts)


def test_says_in_words_what_is_reached():
    default = "every address except link-local ones and the ports of this serve's robots"
    assert ConnectPolicy().text == default
    assert ConnectPolicy(["any"]).text == "every address"
    assert ConnectPolicy(["own-ports"]).text == "every address except link-local ones"
    assert ConnectPolicy(["none"]).text == "none"
    assert ConnectPolicy(["10.0.0.1", "own-ports"]).text == "10.0.0.1 and the ports of this serve's robots"


def tried(policy: ConnectPolicy, address: str, port: int) -> str:
    """What the robot hears of an attempt to connect."""
    heard: list[ChannelOpened] = []

    async def attempt() -> None:
        broker = Broker(heard.extend, policy=policy)
        broker.carry_out([OpenChannel(1, "tcp", address, port, 2.0)])
        while not heard:
            await asyncio.sleep(0)
        broker.close_all()

    asyncio.run(asyncio.wait_for(attempt(), 5.0))
    return "" if heard[0].is_open else heard[0].reason


class TestBroker:
    @pytest.mark.parametrize(
        "address", ["127.0.0.1", "localhost", "0", "0.0.0.0", "0x7f000001", "2130706433", "0177.0.0.1", "127.1"]
    )
    def test_decides_on_what_an_address_stands_for(self, address):
        with socket.create_server(("127.0.0.1", 0)) as server:
            port = server.getsockname()[1]
            policy = ConnectPolicy()
            policy.own_ports |= {port}
            assert tried(policy, address, port).startswith(f"refused: port {port} of this computer is the robot's own")
            assert not tried(ConnectPolicy(["own-ports", "any"]), address, port)

    def test_connects_to_the_address_that_was_looked_at(self, monkeypatch):
        answers = iter([[(socket.AF_INET, 1, 6, "", ("169.254.169.254", 80))]])
        real = socket.getaddrinfo

        def look_up(name, port, **options):
            return (
                next(answers) if name == "rebind.example" and not options.get("flags") else real(name, port, **options)
            )

        monkeypatch.setattr(socket, "getaddrinfo", look_up)
        assert "169.254.169.254 is a link-local address" in tried(ConnectPolicy(), "rebind.example", 80)

    def test_a_name_that_is_too_long_is_not_looked_up(self, monkeypatch):
        monkeypatch.setattr(socket, "getaddrinfo", None)
        found = tried(ConnectPolicy(), "a" * 200_000, 80)
        assert found == "the address has 200000 characters; a host name has 253 at most"

    def test_not_a_number_is_no_time(self):
        heard: list[ChannelOpened] = []

        async def attempt() -> None:
            broker = Broker(heard.extend)
            broker.carry_out([OpenChannel(1, "tcp", "127.0.0.1", 1, float("nan"))])
            await asyncio.sleep(0.01)
            broker.close_all()

        asyncio.run(attempt())
        assert not heard[0].is_open
