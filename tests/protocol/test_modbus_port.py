"""The controller's own Modbus TCP server, with a kernel behind it."""

from __future__ import annotations

import random
from typing import Any

import pytest

from elitescript.messages.enums import RunstateChoice
from elitescript.messages.events import Alarm, Warned
from elitescript.messages.inputs import Do, SetRemote
from elitescript.messages.machine import SetRunstateChoice, WritePortRegisters
from elitescript.messages.outcomes import Done, RegistersRead, SessionState, ShownValue
from elitescript.messages.outputs import Reply
from elitescript.protocol.connection import RESTARTED, ProtocolError
from elitescript.protocol.modbus_port import REQUESTS_OF_ALL, REQUESTS_PER_TICK
from tests.protocol import modbus_client as client
from tests.protocol.line_peer import picture
from tests.protocol.modbus_site import Peer, Site


@pytest.fixture
def site() -> Site:
    return Site()


@pytest.fixture
def peer(site: Site) -> Peer:
    return site.connect()


def test_reads_are_answered_at_once(peer: Peer) -> None:
    assert client.words(peer.ask(client.read(3, 63, 8), ticks=0)) == [2, 15, 0, 3, 0, 0, 0, 0]
    assert client.words(peer.ask(client.read(4, 63, 2), ticks=0)) == [2, 15]
    assert client.levels(peer.ask(client.read(1, 0, 128), ticks=0), 128) == [False] * 128
    assert client.levels(peer.ask(client.read(2, 60, 3), ticks=0), 3) == [False] * 3


def test_values_are_live() -> None:
    site = Site(power_on=True, signals=(("standard_digital_in[3]", True), ("general_register[4]", 77)))
    peer = site.connect()
    assert client.words(peer.ask(client.read(3, 0, 1))) == [8]
    assert client.words(peer.ask(client.read(3, 66, 2))) == [7, 1]
    assert client.words(peer.ask(client.read(3, 260, 1))) == [77]
    assert client.levels(peer.ask(client.read(2, 0, 8)), 8) == [index == 3 for index in range(8)]


@pytest.mark.parametrize(
    ("request_", "answer", "check", "found"),
    [
        (client.write(5, 33, 0xFF00), "050021ff00", client.read(3, 2, 1), [2]),
        (client.write(5, 33, 0), "0500210000", client.read(3, 2, 1), [0]),
        (client.write(6, 256, 0xABCD), "060100abcd", client.read(3, 256, 1), [0xABCD]),
        (client.write_coils(46, [True] * 4), "0f002e0004", client.read(3, 2, 2), [0xC000, 0x0003]),
        (client.write_registers(256, [1, 2, 3]), "1001000003", client.read(3, 255, 5), [0, 1, 2, 3, 0]),
        (client.write_registers(10, [12, 0]), "10000a0002", client.read(3, 10, 2), [12, 0]),
    ],
)
def test_writes_are_answered_by_the_robot(peer: Peer, request_: bytes, answer: str, check: bytes, found: Any) -> None:
    peer.send(client.frame(1, request_))
    assert peer.answers == []
    assert peer.connection.is_busy
    assert peer.connection.is_expecting
    peer.site.tick()
    assert peer.answers == [(1, 255, bytes.fromhex(answer))]
    assert not peer.connection.is_expecting
    assert client.words(peer.ask(check)) == found


def test_function_23_reads_what_it_wrote(peer: Peer) -> None:
    assert client.words(peer.ask(client.read_write(255, 4, 256, [7, 8]))) == [0, 7, 8, 0]


@pytest.mark.parametrize("unit", [0, 1, 17, 255])
def test_any_unit_is_answered(peer: Peer, unit: int) -> None:
    assert peer.ask(client.read(3, 63, 1), unit) == bytes.fromhex("03020002")


@pytest.mark.parametrize(
    ("request_", "code"),
    [
        (bytes([7]), 1),
        (bytes([43, 14, 1, 0]), 1),
        (client.read(3, 512, 1), 2),
        (client.read(3, 500, 13), 2),
        (client.read(1, 120, 9), 2),
        (client.read(3, 65535, 2), 2),
        (client.write(5, 0, 0xFF00), 2),
        (client.write(5, 31, 0xFF00), 2),
        (client.write(5, 128, 0xFF00), 2),
        (client.write(6, 0, 1), 2),
        (client.write(6, 17, 1), 2),
        (client.write(6, 73, 1), 2),
        (client.write_registers(383, [1, 1]), 2),
        (client.read_write(512, 1, 256, [1]), 2),
        (client.read_write(0, 1, 0, [1]), 2),
        (client.read(3, 0, 0), 3),
        (client.read(3, 0, 126), 3),
        (client.read(1, 0, 2001), 3),
        (client.write(5, 60, 1), 3),
        (client.write(6, 16, 13), 3),
        (client.write(6, 11, 2), 3),
        (client.write(6, 3, 0x1000), 3),
        (client.write(5, 59, 0xFF00), 3),
        (client.write(6, 10, 10001), 3),
        (client.read(3, 0, 1) + b"\0", 3),
        (client.write_registers(256, [1])[:-1], 3),
    ],
)
def test_wrong_requests_get_their_exception(peer: Peer, request_: bytes, code: int) -> None:
    before = peer.site.output.snapshot.signals
    assert peer.ask(request_) == bytes([request_[0] | 0x80, code])
    assert peer.site.output.snapshot.signals == before
    assert client.words(peer.ask(client.read(3, 63, 1))) == [2]


def test_what_the_robot_refuses_is_in_its_log_too(peer: Peer) -> None:
    peer.ask(client.write(6, 16, 13))
    (warning,) = [event for event in peer.site.output.events if isinstance(event, Warned)]
    assert "the tool voltage is 0, 12 or 24 V, got 13" in warning.text


def test_pipelined_requests_are_answered_in_order(peer: Peer) -> None:
    numbers = range(100, 100 + 3 * REQUESTS_PER_TICK)
    data = b"".join(
        client.frame(number, client.write(6, 256, number) if number % 2 else client.read(3, 256, 1))
        for number in numbers
    )
    peer.send(data)
    for _ in numbers:
        peer.site.tick()
    assert [transaction for transaction, _, _ in peer.answers] == list(numbers)
    assert [client.words(pdu) for number, _, pdu in peer.answers if number % 2 == 0] == [
        [0 if number == 100 else number - 1] for number in numbers if number % 2 == 0
    ]


def test_a_client_that_floods_takes_so_much_of_a_tick_and_no_more(peer: Peer) -> None:
    peer.send(b"".join(client.frame(number, client.read(3, 0, 100)) for number in range(300)))
    assert len(peer.answers) == REQUESTS_PER_TICK
    assert peer.connection.is_busy
    peer.site.tick()
    assert len(peer.answers) == 2 * REQUESTS_PER_TICK
    for _ in range(300 // REQUESTS_PER_TICK):
        peer.site.tick()
    assert [transaction for transaction, _, _ in peer.answers] == list(range(300))
    assert not peer.connection.is_busy


def test_many_clients_share_a_tick(site: Site) -> None:
    peers = [site.connect() for _ in range(40)]
    for peer in peers:
        peer.send(b"".join(client.frame(number, client.read(3, 256, 1)) for number in range(30)))
    assert {len(peer.answers) for peer in peers} == {REQUESTS_OF_ALL // 40}
    for peer in peers[10:]:
        peer.connection.closed()
    site.peers = peers[:10]
    site.tick()
    assert {len(peer.answers) for peer in peers[:10]} == {REQUESTS_OF_ALL // 40 + REQUESTS_PER_TICK}


def test_while_no_tick_comes_reads_go_on_up_to_a_write(peer: Peer) -> None:
    requests = [client.read(3, 0, 1)] * (2 * REQUESTS_PER_TICK) + [client.write(6, 256, 1), client.read(3, 256, 1)]
    peer.send(b"".join(client.frame(number, pdu) for number, pdu in enumerate(requests)))
    for _ in range(5):
        peer.site.waiting += peer.connection.read_on(peer.site.output)
        peer.collect()
    assert len(peer.answers) == 2 * REQUESTS_PER_TICK
    peer.site.tick()
    assert client.words(peer.answers[-1][2]) == [1]


def test_a_stream_may_come_in_any_pieces() -> None:
    requests = [
        client.read(3, 60, 10),
        client.write_registers(256, [5, 6]),
        client.read(3, 256, 2),
        bytes([99]),
        client.write(5, 60, 0xFF00),
        client.read(1, 60, 1),
    ]
    data = b"".join(client.frame(number, pdu) for number, pdu in enumerate(requests))
    wanted = None
    for size in (1, 2, 3, 7, 11, len(data)):
        peer = Site().connect()
        for at in range(0, len(data), size):
            peer.send(data[at : at + size])
        for _ in requests:
            peer.site.tick()
        wanted = wanted or peer.answers
        assert len(peer.answers) == len(requests)
        assert peer.answers == wanted


def test_a_frame_of_another_protocol_is_left_out(peer: Peer) -> None:
    foreign = b"\0\1\0\5" + client.frame(1, client.read(3, 0, 1))[4:]
    peer.send(foreign + client.frame(2, client.read(3, 63, 1)))
    assert [transaction for transaction, _, _ in peer.answers] == [2]


@pytest.mark.parametrize(
    "request_bytes",
    [
        bytes([16, 1, 0, 0, 124, 248]) + bytes(248),
        bytes([16, 1, 0, 0, 127, 254]) + bytes(254),
        bytes([23, 0, 0, 0, 1, 1, 0, 0, 122, 244]) + bytes(244),
        bytes([23, 0, 0, 0, 1, 1, 0, 0, 127, 255]) + bytes(255),
    ],
)
def test_too_many_registers_are_an_exception_and_the_connection_stays(peer: Peer, request_bytes: bytes) -> None:
    assert peer.ask(request_bytes) == bytes([0x80 | request_bytes[0], 3])
    assert peer.ask(client.write(6, 256, 5)) == client.write(6, 256, 5)


@pytest.mark.parametrize("garbage", [b"GET / HTTP/1.1\r\n", b"\0\1\0\0\0\1\xff", b"\0\1\0\0\2\0\xff"])
def test_what_is_no_modbus_closes_the_connection_after_the_answers_due(peer: Peer, garbage: bytes) -> None:
    with pytest.raises(ProtocolError, match="this is no Modbus TCP"):
        peer.send(garbage)
    other = peer.site.connect()
    other.send(client.frame(1, client.write(6, 256, 5)) + garbage)
    assert other.answers == []
    with pytest.raises(ProtocolError, match="this is no Modbus TCP"):
        peer.site.tick()
    other.collect()
    assert other.answers == [(1, 255, client.write(6, 256, 5))]
    assert other.connection.is_over
    other.connection.publish(peer.site.output)


def test_random_bytes_are_answered_or_closed_and_nothing_else(site: Site) -> None:
    chance = random.Random(3)
    for _ in range(200):
        peer = site.connect()
        pdu = bytes([chance.choice([0, 1, 3, 5, 6, 15, 16, 23, chance.randrange(256)])]) + chance.randbytes(
            chance.randrange(20)
        )
        peer.send(client.frame(9, pdu))
        site.tick()
        assert [(transaction, unit) for transaction, unit, _ in peer.answers] == [(9, 255)]
        noise = site.connect()
        try:
            noise.send(chance.randbytes(chance.randrange(1, 300)))
            site.tick()
        except ProtocolError:
            assert noise.connection.is_over
        site.peers.clear()


def test_a_robot_that_is_started_anew_has_not_taken_what_waits(site: Site, peer: Peer) -> None:
    peer.send(client.frame(1, client.write(6, 256, 1)) + client.frame(2, client.read(3, 256, 1)))
    (asked,) = site.waiting
    assert asked == Do("modbus#1/1", WritePortRegisters(256, (1,)), is_answered=True)
    alarm = Alarm(1, RESTARTED, "Restarted", "", 0, 0, "", "")
    peer.connection.publish(picture(1, events=(alarm,)))
    peer.collect()
    assert [pdu for _, _, pdu in peer.answers] == [bytes([0x86, 4]), bytes.fromhex("03020000")]


def test_a_robot_that_shows_what_was_not_asked_for_has_failed(peer: Peer) -> None:
    others = (Done(), RegistersRead(()), RegistersRead((0, 0)), ShownValue("0000"), SessionState(True))
    for number, outcome in enumerate(others, 1):
        peer.answers.clear()
        peer.send(client.frame(1, client.read_write(256, 1, 256, [1])))
        peer.connection.publish(picture(1, replies=(Reply(f"modbus#1/{number}", outcome),)))
        peer.collect()
        assert peer.answers == [(1, 255, bytes([0x97, 4]))]


def test_an_answer_for_somebody_else_is_none(peer: Peer) -> None:
    peer.send(client.frame(1, client.write(6, 256, 1)))
    for origin in ("modbus#1", "modbus#1/2", "modbus#11/1"):
        peer.connection.publish(picture(1, replies=(Reply(origin, Done()),)))
    peer.collect()
    assert peer.answers == []


def test_local_control_makes_no_difference(peer: Peer) -> None:
    peer.site.tick(SetRemote("ctl", False))
    assert not peer.site.output.snapshot.is_remote
    assert peer.ask(client.write(5, 32, 0xFF00)) == client.write(5, 32, 0xFF00)


def test_an_output_that_is_tied_to_the_task_is_not_written(peer: Peer) -> None:
    site = peer.site
    site.tick(Do("ctl", SetRunstateChoice("standard_digital_out", 0, RunstateChoice.HIGH_WHEN_STOPPED)))
    assert peer.ask(client.write(5, 32, 0)) == client.write(5, 32, 0)
    assert client.words(peer.ask(client.read(3, 2, 1))) == [1]
    site.tick(Do("ctl", SetRunstateChoice("standard_digital_out", 0, RunstateChoice.KEEP)))
    assert client.words(peer.ask(client.read(3, 2, 1))) == [1]
